//! Closed forms: exact inversion of exact events, and the published checks.

use crumple_lumped::{Elastoplastic, Kelvin};
use crumple_lumped_fit::{
    KelvinBranch, SolveError, centroid_to_crush_time_ratio, elastoplastic_from_events, kelvin_from_events,
};
use proptest::prelude::*;
use serde_json::Value;

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} in {value}"))
}

proptest! {
    #[test]
    fn exact_events_give_the_kelvin_model_back(
        m in 300.0..3000.0f64, k in 1e4..1e6f64, log_ratio in -12.0..2.0f64, v0 in 1.0..30.0f64,
    ) {
        let zeta = log_ratio.exp();
        let truth = Kelvin { mass_kg: m, stiffness_n_per_m: k, damping_n_s_per_m: 2.0 * zeta * (k * m).sqrt() };
        let events = truth.events(v0);
        let solution = kelvin_from_events(
            m, v0, events.time_of_dynamic_crush_s.unwrap(), events.dynamic_crush_m.unwrap(),
        ).unwrap();
        // Rounding of the ratio is amplified by at most 1/0.59 in zeta below 1 and by about zeta·ln zeta above: 1e-14.
        prop_assert!((solution.model.stiffness_n_per_m / k - 1.0).abs() < 1e-12 * (1.0 + zeta));
        let critical = 2.0 * (k * m).sqrt();
        let error = (solution.model.damping_n_s_per_m - truth.damping_n_s_per_m).abs();
        prop_assert!(error < 1e-12 * critical * (1.0 + zeta), "{error}");
    }

    #[test]
    fn exact_events_give_the_elastoplastic_model_back(
        m in 300.0..3000.0f64, k in 1e4..1e6f64, e in 0.01..1.0f64, v0 in 1.0..30.0f64,
    ) {
        let truth = Elastoplastic {
            mass_kg: m, loading_stiffness_n_per_m: k, unloading_stiffness_n_per_m: k / (e * e), release: true,
        };
        let events = truth.events(v0);
        let restitution = -events.rebound_velocity_m_per_s.unwrap() / v0;
        let found = elastoplastic_from_events(m, v0, events.dynamic_crush_m.unwrap(), restitution).unwrap();
        // A dozen roundings.
        prop_assert!((found.loading_stiffness_n_per_m / k - 1.0).abs() < 4e-15);
        prop_assert!((found.unloading_stiffness_n_per_m / truth.unloading_stiffness_n_per_m - 1.0).abs() < 4e-15);
    }
}

#[test]
fn the_time_ratio_falls_strictly() {
    let mut last = f64::INFINITY;
    for k in 0..400 {
        let ratio = centroid_to_crush_time_ratio(f64::from(k) * 0.01);
        assert!(ratio < last, "at {}", f64::from(k) * 0.01);
        last = ratio;
    }
    assert_eq!(centroid_to_crush_time_ratio(1.0), (-1.0_f64).exp());
    assert_eq!(centroid_to_crush_time_ratio(0.0), std::f64::consts::FRAC_2_PI);
}

#[test]
fn known_records_give_their_parameters() {
    for record in ["kelvin-undamped", "kelvin-underdamped"] {
        let Some(truth) = crumple_testkit::known_truth(record) else { return };
        let (p, expected) = (&truth["parameters"], &truth["expected"]);
        let solution =
            kelvin_from_events(number(p, "m"), number(p, "v0"), number(expected, "t_m"), number(expected, "C"))
                .unwrap();
        // Events given to the last digit: rounding amplified by 1/0.59 twice.
        assert!((solution.model.stiffness_n_per_m / number(p, "k") - 1.0).abs() < 1e-14);
        assert!((solution.model.damping_n_s_per_m - number(p, "c")).abs() < 1e-10);
    }
    let Some(truth) = crumple_testkit::known_truth("elastoplastic") else { return };
    let (p, expected) = (&truth["parameters"], &truth["expected"]);
    let e = -number(expected, "v_rebound") / number(p, "v0");
    let model = elastoplastic_from_events(number(p, "m"), number(p, "v0"), number(expected, "C"), e).unwrap();
    assert!((model.loading_stiffness_n_per_m / number(p, "k_E") - 1.0).abs() < 1e-14);
    assert!((model.unloading_stiffness_n_per_m / number(p, "k_P") - 1.0).abs() < 1e-14);
}

/// Every recomputed value of the single-mass paper that belongs here.
#[test]
fn the_recomputed_values_of_the_single_mass_paper() {
    let Some(path) = crumple_testkit::shared("reference/papers.json") else { return };
    let papers: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let mut seen = 0;
    for item in papers["items"].as_array().unwrap() {
        let (inputs, expected) = (&item["inputs"], &item["expected"]);
        let value = |key: &str| number(&expected[key], "value");
        let tolerance = || number(item, "tolerance_to_recomputed_relative");
        match item["kind"].as_str() {
            Some("kelvin_curve") => {
                let ratio = centroid_to_crush_time_ratio(number(inputs, "zeta"));
                assert!((ratio / value("ratio") - 1.0).abs() < tolerance(), "{item}");
            }
            Some("kelvin_invert") => {
                let ratio = number(inputs, "ratio");
                let solution = kelvin_from_events(1.0, 1.0, 1.0, ratio).unwrap();
                if expected["solvable"].as_bool().unwrap() {
                    assert!((solution.damping_ratio / value("zeta") - 1.0).abs() < tolerance(), "{item}");
                } else {
                    assert!(matches!(solution.branch, KelvinBranch::UndampedReduction { .. }), "{item}");
                }
            }
            Some("kelvin_identify") => {
                let n = |key| number(inputs, key);
                let solution = kelvin_from_events(n("m"), n("v0"), n("t_m"), n("C")).unwrap();
                assert!((solution.model.stiffness_n_per_m / value("k") - 1.0).abs() < tolerance(), "{item}");
                assert!((solution.natural_frequency_rad_per_s / value("omega_e") - 1.0).abs() < tolerance(), "{item}");
                if let KelvinBranch::UndampedReduction { model_time_of_dynamic_crush_s: t } = solution.branch {
                    assert!((t / value("t_m_used") - 1.0).abs() < tolerance(), "{item}");
                }
            }
            Some("elastoplastic") => {
                let n = |key| number(inputs, key);
                let model = elastoplastic_from_events(n("m"), n("v0"), n("C"), n("v_rebound") / n("v0")).unwrap();
                assert!((model.loading_stiffness_n_per_m / value("k_E") - 1.0).abs() < tolerance(), "{item}");
                assert!((model.unloading_stiffness_n_per_m / value("k_P") - 1.0).abs() < tolerance(), "{item}");
                assert!((model.permanent_set_m(n("v0")) / value("permanent_set") - 1.0).abs() < tolerance(), "{item}");
            }
            _ => continue,
        }
        seen += 1;
    }
    assert!(seen > 20, "only {seen} items were checked");
}

#[test]
fn senseless_events_are_refused_with_their_name() {
    let error = kelvin_from_events(900.0, 10.0, 0.0, 0.5).unwrap_err();
    assert_eq!(error.to_string(), "time_of_dynamic_crush_s is 0, expected a positive number");
    assert!(matches!(kelvin_from_events(900.0, 10.0, 1.0, 0.1), Err(SolveError::RatioTooSmall { .. })));
    assert!(elastoplastic_from_events(900.0, 10.0, 0.5, 1.2).is_err());
    assert!(elastoplastic_from_events(900.0, f64::NAN, 0.5, 0.1).is_err());
}
