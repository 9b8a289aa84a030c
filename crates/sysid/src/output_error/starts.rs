//! Starting points of output-error models.
//!
//! The loss of an output-error model has local minima, the more the higher the order. Starts come from regressions
//! that are biased by noise in different ways, cut to the order asked for; from subspace methods; from continuous
//! transfer functions; and from random poles near the unit circle.

use crumple_numerics::estimation::random::uniform_at;
use crumple_numerics::lti::Complex;
use rayon::prelude::*;

use crate::arx;
use crate::output_error::options::OutputErrorOptions;
use crate::poles::starts::{Start, StartProblem};
use crate::subspace::balanced_truncation;
use crate::{ArxOrder, Hold, IoData, Subspace, SubspaceOptions, Weighting};

/// Continuous transfer functions are starts up to this order: above, their coefficients have lost the digits.
const MOST_CONTINUOUS: usize = 10;

/// Poles of candidate models, as unknowns.
///
/// One vector of `order` unknowns per start, in the reflection coefficients of the cascade. What a method cannot give
/// on this record is left out; the random starts are always there.
pub(crate) fn starts(data: &IoData, options: OutputErrorOptions) -> Vec<Vec<f64>> {
    let n = options.order;
    let first_tap = options.delay + usize::from(!options.direct);
    let mut poles: Vec<Vec<Complex>> = Vec::new();
    // Of several outputs each alone; they share the poles.
    for output in data.outputs() {
        let Ok(single) = IoData::new(data.inputs().to_vec(), vec![output.clone()], data.sample_time_s()) else {
            continue;
        };
        for taps in [n, 4 * n] {
            let order = ArxOrder { na: taps, nb: taps + usize::from(options.direct), nk: first_tap };
            let Ok(model) = arx(&single, order).and_then(|model| model.state_space()) else { continue };
            let Ok(mut model_poles) = model.poles() else { continue };
            // What matters most of many taps: the start for a poor signal-to-noise ratio.
            poles.extend(balanced_truncation(&model, n).and_then(|(reduced, _)| reduced.poles().ok()));
            // The least damped ones, pairs kept together; poles at zero are those of the delay.
            model_poles.sort_by(|a, b| b.norm().total_cmp(&a.norm()).then(b.im.abs().total_cmp(&a.im.abs())));
            poles.push(model_poles);
        }
    }
    for weighting in Weighting::ALL {
        for block_rows in [(n + 2).max(10), 3 * n + 2] {
            let options = SubspaceOptions { weighting, block_rows, direct: options.direct };
            let Ok(realized) = Subspace::new(data, options).and_then(|s| s.realize(n)) else { continue };
            poles.extend(realized.model.poles());
        }
    }
    poles.extend(continuous_starts(data, options));
    let mut starts: Vec<Vec<f64>> = poles.iter().map(|poles| unknowns(poles, n)).collect();
    for start in 0..options.random_starts {
        let random: Vec<Complex> = (0..n.div_ceil(2))
            .flat_map(|k| {
                let (radius, angle) = (uniform_at(start, 2 * k), uniform_at(start, 2 * k + 1));
                let z = Complex::from_polar(0.7 + 0.299 * radius, std::f64::consts::PI * angle);
                [z, z.conj()]
            })
            .collect();
        starts.push(unknowns(&random, n));
    }
    starts
}

/// Sampled poles of continuous transfer functions between every input and output, by refined instrumental variables
/// behind filters of several bandwidths: a regression over one step sees little but noise where poles crowd at 1. None
/// above [`MOST_CONTINUOUS`].
fn continuous_starts(data: &IoData, options: OutputErrorOptions) -> Vec<Vec<Complex>> {
    if options.order > MOST_CONTINUOUS {
        return Vec::new();
    }
    let late = data.delayed(options.delay);
    let pairs: Vec<(&Vec<f64>, &Vec<f64>)> =
        late.inputs().iter().flat_map(|u| late.outputs().iter().map(move |y| (u, y))).collect();
    pairs
        .into_par_iter()
        .flat_map_iter(|(input, output)| {
            let problem = StartProblem {
                input,
                output,
                hold: Hold::First,
                poles: options.order,
                numerator: options.order + usize::from(options.direct),
                free: true,
            };
            let dt = 1.0 / output.len() as f64;
            let sampled = move |poles: Vec<Complex>| poles.into_iter().map(|s| (s * dt).exp()).collect::<Vec<_>>();
            let kinds = [Start::Iv, Start::N4sid];
            kinds.into_iter().flat_map(|start| problem.poles_by(start, 0)).map(sampled).collect::<Vec<_>>()
        })
        .collect()
}

/// The leading `n` poles as unknowns of [`CascadeFilter`]: pairs first, real ones two by two, at most one alone.
///
/// Poles on or outside the unit circle are mirrored into it first; where fewer than `n` are given the rest is filled
/// with 0.5.
pub(crate) fn unknowns(poles: &[Complex], n: usize) -> Vec<f64> {
    let inside = |z: Complex| {
        let radius = z.norm();
        if radius >= 1.0 { z / (radius * radius) * 0.999 } else { z }
    };
    let poles: Vec<Complex> = poles.iter().map(|z| inside(*z)).collect();
    let mut theta = Vec::with_capacity(n);
    let mut real: Vec<f64> = Vec::new();
    let mut taken = 0;
    for z in &poles {
        if z.im > 0.0 && taken + 2 <= n {
            theta.extend(reflection(-2.0 * z.re, z.norm_sqr()));
            taken += 2;
        } else if z.im == 0.0 && taken < n {
            real.push(z.re);
            taken += 1;
        }
    }
    while taken < n {
        real.push(0.5);
        taken += 1;
    }
    for pair in real.chunks(2) {
        match *pair {
            [a, b] => theta.extend(reflection(-(a + b), a * b)),
            [a] => theta.push((-a).clamp(-1.0 + 1e-9, 1.0 - 1e-9).atanh()),
            _ => {}
        }
    }
    theta
}

/// `z² + a1 z + a0` with both roots inside the unit circle, as two unknowns.
///
/// `[atanh(a1/(1 + a0)), atanh(a0)]`, both cut to magnitudes below `1 - 1e-9`.
fn reflection(a1: f64, a0: f64) -> [f64; 2] {
    let cut = |x: f64| x.clamp(-1.0 + 1e-9, 1.0 - 1e-9).atanh();
    [cut(a1 / (1.0 + a0)), cut(a0)]
}
