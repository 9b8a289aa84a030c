//! Benchmarks: how long something takes.

use std::hint::black_box;
use std::time::{Duration, Instant};

/// Longest time spent on repeating one measurement.
const PATIENCE: Duration = Duration::from_secs(1);
/// Most repetitions.
const MOST_RUNS: usize = 200;
/// Fewest repetitions.
const FEWEST_RUNS: usize = 5;

/// Shortest time of some runs of `work`, ms. What it returns is used, so that the work is not left out; whatever is
/// allocated or freed inside counts.
pub fn best_ms<T>(mut work: impl FnMut() -> T) -> f64 {
    let started = Instant::now();
    let mut best = f64::INFINITY;
    for run in 0..MOST_RUNS {
        if run >= FEWEST_RUNS && started.elapsed() > PATIENCE {
            break;
        }
        let start = Instant::now();
        let result = black_box(work());
        best = best.min(start.elapsed().as_secs_f64() * 1e3);
        drop(result);
    }
    best
}

/// The same for work of microseconds: as many calls in a row as take half a millisecond are one measurement, and the
/// shortest time of one call is given, µs. The shortest, because whatever else runs on the machine can only add to a
/// time.
pub fn best_us(mut work: impl FnMut()) -> f64 {
    let start = Instant::now();
    work();
    let calls = (5e-4 / start.elapsed().as_secs_f64()).clamp(1.0, 1e5) as u32;
    let best = best_ms(|| (0..calls).for_each(|_| work()));
    1e3 * best / f64::from(calls)
}

/// A plain memory pass over samples: each is read and written to a buffer that is there already, ms.
pub fn memory_pass_ms(samples: &[f64]) -> f64 {
    let mut copy = samples.to_vec();
    best_ms(|| {
        copy.copy_from_slice(black_box(samples));
        black_box(copy[samples.len() / 2])
    })
}

/// Prints one measurement: what, its time, its time over that of the memory pass.
pub fn print_line(what: &str, ms: f64, pass_ms: f64) {
    println!("{what:<58} {ms:>10.3} ms {:>8.1} x memory pass ({pass_ms:.3} ms)", ms / pass_ms);
}
