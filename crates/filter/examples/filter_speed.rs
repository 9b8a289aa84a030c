//! Prints how long the two passes of CFC 60 take on a record of a million samples. Run with `--release`.

use std::time::Instant;

use crumple_filter::{Cfc, Coefficients, Mode, Settings, filter, filter_both_ways};
use crumple_signal::Sampled;

fn main() {
    let dt_s = 1e-5;
    let samples: Vec<f64> = (0..1_000_000).map(|k| -200.0 * (1e-3 * f64::from(k)).sin()).collect();
    let coefficients = Coefficients::new(Cfc::Cfc60, Mode::Iso6487, dt_s);
    let passes = best_of(20, || filter_both_ways(&samples, 0.1, &coefficients).map(|y| y[500_000]));
    println!("two passes, 10^6 samples: {passes:.2} ms");

    let record = Sampled::new(-0.05, dt_s, samples).unwrap_or_else(|error| panic!("{error}"));
    let all = best_of(20, || filter(&record, None, &Settings::default()).map(|f| f.zero_level_removed));
    println!("zero level, two passes, checks: {all:.2} ms");

    // A pulse that ends in exact zeros decays into subnormal numbers, which some processors are slow at.
    let mut pulse = vec![0.0; 1_000_000];
    pulse[1000..20_000].fill(-200.0);
    let tail = best_of(20, || filter_both_ways(&pulse, 0.0, &coefficients).map(|y| y[500_000]));
    println!("two passes, long tail of zeros: {tail:.2} ms");
}

/// Shortest of some runs, ms; the result is used, so that the work is not left out.
fn best_of<E: std::fmt::Debug>(runs: usize, work: impl Fn() -> Result<f64, E>) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..runs {
        let start = Instant::now();
        std::hint::black_box(work().unwrap_or_else(|error| panic!("{error:?}")));
        best = best.min(start.elapsed().as_secs_f64() * 1e3);
    }
    best
}
