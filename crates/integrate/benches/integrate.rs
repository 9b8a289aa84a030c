//! Times of the double integration on one thread, beside a plain memory pass over the same record.

use crumple_signal::{IntegrationRule, integrate_twice, integrate_twice_into};
use crumple_testkit::benchmark::{best_ms, memory_pass_ms, print_line};

fn main() {
    for n in [10_000, 1_000_000, 10_000_000] {
        let samples: Vec<f64> = (0..n).map(|k| -200.0 * (1e-3 * f64::from(k)).sin()).collect();
        let pass_ms = memory_pass_ms(&samples);
        // What two results cost that are written without any computation: the system has to find and clear their pages.
        let ms = best_ms(|| [vec![1.0; samples.len()], vec![1.0; samples.len()]]);
        print_line(&format!("two fresh results filled with ones, {n} samples"), ms, pass_ms);
        for rule in IntegrationRule::ALL {
            let (mut v, mut x) = (Vec::new(), Vec::new());
            let ms = best_ms(|| {
                integrate_twice_into(&samples, 1e-5, rule, [14.0, 0.0], (&mut v, &mut x), |_| ());
                x[x.len() / 2]
            });
            print_line(&format!("{}, {n} samples, buffers used again", rule.name()), ms, pass_ms);
            let ms = best_ms(|| integrate_twice(&samples, 1e-5, rule, 14.0, 0.0));
            print_line(&format!("{}, {n} samples, fresh memory", rule.name()), ms, pass_ms);
        }
    }
}
