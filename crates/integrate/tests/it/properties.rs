//! Integration and differentiation undo each other.

use crumple_signal::{IntegrationRule, integrate_twice};
use proptest::prelude::*;

const DT_S: f64 = 1e-4;

fn any_rule() -> impl Strategy<Value = IntegrationRule> {
    prop::sample::select(vec![IntegrationRule::Trapezoid, IntegrationRule::ForwardEuler])
}

/// What a rule takes for the mean of a quantity over each interval.
fn means(values: &[f64], rule: IntegrationRule) -> Vec<f64> {
    match rule {
        IntegrationRule::Trapezoid => values.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0).collect(),
        IntegrationRule::ForwardEuler => values[..values.len() - 1].to_vec(),
        IntegrationRule::Simpson => panic!("the mean over an interval comes from three samples"),
    }
}

proptest! {
    #[test]
    fn differences_of_the_integral_are_the_means_of_the_integrand(
        a in prop::collection::vec(-1000.0..1000.0_f64, 1..500), v0 in -30.0..30.0_f64, x0 in -1.0..1.0_f64,
        rule in any_rule()
    ) {
        let (v, x) = integrate_twice(&a, DT_S, rule, v0, x0);
        prop_assert_eq!((v.len(), x.len(), v[0], x[0]), (a.len(), a.len(), v0, x0));
        // A difference of two numbers up to 80 loses 1e-14 absolute; divided by T that is 1e-10.
        for (slope, mean) in v.windows(2).map(|pair| (pair[1] - pair[0]) / DT_S).zip(means(&a, rule)) {
            prop_assert!((slope - mean).abs() < 1e-9, "{slope} {mean}");
        }
        for (slope, mean) in x.windows(2).map(|pair| (pair[1] - pair[0]) / DT_S).zip(means(&v, rule)) {
            prop_assert!((slope - mean).abs() < 1e-9, "{slope} {mean}");
        }
    }

    #[test]
    fn integrating_a_derivative_gives_the_function_back(
        steps in prop::collection::vec(-0.1..0.1_f64, 1..500), v0 in -30.0..30.0_f64
    ) {
        let mut v = vec![v0];
        for step in &steps {
            v.push(v[v.len() - 1] + step);
        }
        // The derivative by which forward Euler steps; the last one leads nowhere.
        let mut a: Vec<f64> = v.windows(2).map(|pair| (pair[1] - pair[0]) / DT_S).collect();
        a.push(0.0);
        let (found, _) = integrate_twice(&a, DT_S, IntegrationRule::ForwardEuler, v0, 0.0);
        // 500 roundings of numbers up to 80.
        for (found, v) in found.iter().zip(&v) {
            prop_assert!((found - v).abs() < 1e-10, "{found} {v}");
        }
    }

    #[test]
    fn simpson_gives_a_smooth_function_back_from_its_derivative(
        amplitude in 1.0..10.0_f64, omega in 1.0..60.0_f64, phase in 0.0..6.0_f64, n in 3..3000_i32
    ) {
        let at = |k: i32| omega * f64::from(k) * DT_S + phase;
        let a: Vec<f64> = (0..n).map(|k| amplitude * omega * at(k).cos()).collect();
        let (v, x) = integrate_twice(&a, DT_S, IntegrationRule::Simpson, amplitude * phase.sin(), 0.0);
        for k in 0..n {
            let (i, t) = (k as usize, f64::from(k) * DT_S);
            // T^4 times the third derivative of a over 24, 10*60^4*1e-16/24, and 3000 roundings of numbers up to 10.
            prop_assert!((v[i] - amplitude * at(k).sin()).abs() < 1e-9, "{k}");
            let exact = amplitude / omega * (phase.cos() - at(k).cos());
            prop_assert!((x[i] - exact).abs() < 1e-9 + 1e-9 * t, "{k}: {} {exact}", x[i]);
        }
    }

    #[test]
    fn the_trapezoid_is_exact_for_a_straight_acceleration(
        level in -500.0..500.0_f64, slope in -5000.0..5000.0_f64, v0 in 1.0..30.0_f64, n in 2..2000_i32
    ) {
        let a: Vec<f64> = (0..n).map(|k| level + slope * f64::from(k) * DT_S).collect();
        let (v, _) = integrate_twice(&a, DT_S, IntegrationRule::Trapezoid, v0, 0.0);
        let t = f64::from(n - 1) * DT_S;
        // 2000 roundings of numbers up to 250.
        prop_assert!((v[v.len() - 1] - (v0 + level * t + slope * t * t / 2.0)).abs() < 1e-9);
    }
}
