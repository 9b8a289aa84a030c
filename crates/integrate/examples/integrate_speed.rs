//! Prints how long the double integration of a million samples takes. Run with `--release`.

use std::time::Instant;

use crumple_integrate::{Rule, integrate_twice};

fn main() {
    let samples: Vec<f64> = (0..1_000_000).map(|k| -200.0 * (1e-3 * f64::from(k)).sin()).collect();
    for rule in [Rule::Trapezoid, Rule::ForwardEuler] {
        let mut best = f64::INFINITY;
        for _ in 0..20 {
            let start = Instant::now();
            std::hint::black_box(integrate_twice(&samples, 1e-5, rule, 14.0, 0.0));
            best = best.min(start.elapsed().as_secs_f64() * 1e3);
        }
        println!("{}, twice, 10^6 samples: {best:.2} ms", rule.name());
    }
}
