//! Times ERA of order 4 on a 2501-sample record, the size of the crash paper: `cargo run --release --example era_time`.

use std::time::{Duration, Instant};

use crumple_identify::{Era, EraError, EraOptions, Order};

fn main() -> Result<(), EraError> {
    let wave = |t: f64| (-30.0 * t).exp() * (60.0 * t).sin() + 0.2 * (-12.0 * t).exp() * (400.0 * t).cos();
    for (name, noise) in [("clean", 0.0), ("1 % noise", 0.01)] {
        let record: Vec<f64> =
            (0..2501).map(|k| wave(f64::from(k) * 1e-4) + noise * (f64::from(k * k) * 0.37).sin()).collect();
        for order in [Order::Given(4), Order::Automatic] {
            let mut times: Vec<Duration> = Vec::new();
            let mut steps = None;
            for _ in 0..50 {
                let start = Instant::now();
                let model = Era::new(&record, EraOptions::new(1e-4), &[order])?.realize(order)?;
                times.push(start.elapsed());
                steps = Some((model.order(), model.singular_values.len(), model.decomposition));
            }
            times.sort();
            println!(
                "{name}, {order:?}: median {:?}, first to last {:?} to {:?}, {steps:?}",
                times[25], times[0], times[49]
            );
        }
    }
    Ok(())
}
