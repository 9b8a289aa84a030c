//! Times of the double integration on one thread, beside a plain memory pass over the same record.

use crumple_signal::{IntegrationRule, integrate_twice, integrate_twice_into};
use crumple_testkit::benchmark::{Figure, best_s, memory_pass_s};

fn main() {
    for n in [10_000, 1_000_000, 10_000_000] {
        let samples: Vec<f64> = (0..n).map(|k| -200.0 * (1e-3 * f64::from(k)).sin()).collect();
        let pass_s = memory_pass_s(&samples);
        // What two results cost that are written without any computation: the system has to find and clear their pages.
        let s = best_s(|| [vec![1.0; samples.len()], vec![1.0; samples.len()]]);
        Figure::new(format!("two fresh results filled with ones, {n} samples"), s, pass_s).print();
        for rule in IntegrationRule::ALL {
            let (mut v, mut x) = (Vec::new(), Vec::new());
            let s = best_s(|| {
                integrate_twice_into(&samples, 1e-5, rule, [14.0, 0.0], (&mut v, &mut x), |_| ());
                x[x.len() / 2]
            });
            let name = format!("double integration, {}, {n} samples", rule.name());
            let figure = Figure::new(format!("{name}, buffers used again"), s, pass_s);
            if n == 1_000_000 { figure.aim(2e-3, "numpy 10 ms") } else { figure }.print();
            let s = best_s(|| integrate_twice(&samples, 1e-5, rule, 14.0, 0.0));
            Figure::new(format!("{name}, fresh memory"), s, pass_s).print();
        }
    }
}
