//! Exponents that the fit of a sum of exponentials starts from.

use crumple_estimation::random::uniform_at;
use crumple_lti::Complex;

use crate::ExponentialOptions;
use crate::poles::pole_problem::scaled_poles;
use crate::poles::starts::{exponential_poles, random_poles};

/// Slowest and fastest decay of a start for a slow curve, in units of one over the record.
const SLOWEST: f64 = 0.1;
const FASTEST_OF_SLOW: f64 = 50.0;

/// Decays on the grid of those starts.
const DECAYS: usize = 8;

/// Ratio of neighbouring decays of one start on the grid.
const SPREADS: [f64; 2] = [1.0, 1.4];

/// Exponents to start from, in units of one over `duration_s`: those given, else the matrix pencil's and slow ones; and
/// random ones. `scaled` is the record in units of its root mean square, `dt` its interval in those of the duration.
///
/// Each start has as many exponents as the sum has terms, pairs conjugate; real ones for a sum of real exponentials.
/// Smooth curves (a displacement) need the slow starts: there the matrix pencil sees little but rounding.
pub(crate) fn starting_exponents(
    scaled: &[f64],
    dt: f64,
    duration_s: f64,
    options: &ExponentialOptions,
) -> Vec<Vec<Complex>> {
    let n = options.terms;
    let mut candidates: Vec<Vec<Complex>> = if options.given.is_empty() {
        exponential_poles(scaled, dt, n).into_iter().collect()
    } else {
        options.given.iter().map(|poles| scaled_poles(poles, duration_s)).collect()
    };
    candidates.extend((0..options.random_starts).map(|k| random_poles(k, n, 0.2 * std::f64::consts::PI / dt)));
    if options.given.is_empty() {
        candidates.extend(slow_starts(n, options));
    }
    if options.real {
        for poles in &mut candidates {
            for s in poles.iter_mut() {
                // The imaginary part spreads a pair.
                *s = Complex::new(s.re - s.im.abs() * if s.im > 0.0 { 0.5 } else { 0.25 }, 0.0);
            }
        }
    }
    candidates
}

/// Exponents for curves that are slow against the sampling, in scaled time: around one decay each, and, where random
/// starts are asked for, as many that are spread evenly in the logarithm.
fn slow_starts(terms: usize, options: &ExponentialOptions) -> Vec<Vec<Complex>> {
    let decay = |share: f64| SLOWEST * (FASTEST_OF_SLOW / SLOWEST).powf(share);
    let middle = (terms as f64 - 1.0) / 2.0;
    let mut starts: Vec<Vec<Complex>> = SPREADS
        .iter()
        .flat_map(|spread| (0..DECAYS).map(move |d| (spread, decay((d as f64 + 0.5) / DECAYS as f64))))
        .map(|(spread, r)| (0..terms).map(|i| Complex::new(-r * spread.powf(i as f64 - middle), 0.0)).collect())
        .collect();
    starts.extend((0..options.random_starts).map(|k| {
        // Streams of their own.
        let stream = 1000 + k;
        if options.real {
            (0..terms).map(|i| Complex::new(-decay(uniform_at(stream, i)), 0.0)).collect()
        } else {
            random_poles(stream, terms, FASTEST_OF_SLOW)
        }
    }));
    starts
}
