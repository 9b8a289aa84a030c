//! Records made from known models: crush and its time come back.

use crumple_metrics::{CrashEvents, DynamicCrush, crash_events};
use crumple_signal::{
    Acceleration, IntegrationRule, IntegrationSettings, IntegrationStart, Motion, Signal, UsedStart, integrate,
};
use crumple_testkit::reference_signals::{number, two_columns};
use serde_json::Value;

const RECORDS: [&str; 10] = [
    "double-mixed",
    "double-overdamped",
    "double-underdamped",
    "elastoplastic",
    "elastoplastic-release",
    "kelvin-undamped",
    "kelvin-underdamped",
    "maxwell",
    "nonlinear-1",
    "nonlinear-2",
];

/// The acceleration of a record and what is known of it.
fn record(id: &str) -> Option<(Signal<Acceleration>, Value)> {
    let folder = crumple_testkit::shared(&format!("reference/known-truth/{id}"))?;
    let truth = serde_json::from_str(&std::fs::read_to_string(folder.join("truth.json")).unwrap()).unwrap();
    Some((two_columns(&folder.join("accel.csv"), ',').into(), truth))
}

fn motion(a: &Signal<Acceleration>, v0: f64, rule: IntegrationRule, start: IntegrationStart) -> (Motion, CrashEvents) {
    let settings = IntegrationSettings {
        rule,
        start,
        time_zero_s: 0.0,
        impact_speed_m_per_s: v0,
        low_pass_filtered: start == IntegrationStart::Auto,
    };
    let motion = integrate(a, &settings).unwrap();
    let events = crash_events(&motion.velocity, &motion.displacement, 0.0).unwrap();
    (motion, events)
}

fn assert_near(what: &str, found: f64, expected: f64, limit: f64) {
    assert!((found - expected).abs() <= limit, "{what}: {found}, not {expected} within {limit:e}");
}

#[test]
fn both_rules_make_of_every_record_what_is_known_of_it() {
    for id in RECORDS {
        let Some((a, truth)) = record(id) else { return };
        for (rule, key) in [(IntegrationRule::Trapezoid, "trapezoid"), (IntegrationRule::ForwardEuler, "forward_euler")]
        {
            let (motion, events) = motion(&a, number(&truth["v0_m_s"]), rule, IntegrationStart::TimeZero);
            let known = &truth["integration_of_the_csv"][key];
            let (v, x) = (motion.velocity.samples(), motion.displacement.samples());
            // The same sums in another order of operations, 2500 roundings of numbers near 1: below 1e-12.
            let same = |what: &str, found: f64, key: &str| {
                assert_near(&format!("{id} {} {what}", rule.name()), found, number(&known[key]), 1e-12);
            };
            // The larger of the two samples around the zero; some of the records swing through a later, larger maximum.
            let after = events.crush.unwrap().index;
            same("crush", x[after - 1].max(x[after]), "C_max_sample");
            same("end", x[2500], "x_at_0.25");
            same("lowest velocity", v.iter().copied().fold(f64::MAX, f64::min), "v_min");
            same("time of crush", events.crush.unwrap().time_s, "t_m_interpolated");
        }
    }
}

#[test]
fn the_trapezoid_on_an_unfiltered_record_meets_the_true_crush_within_two_micrometres() {
    for id in RECORDS {
        let Some((a, truth)) = record(id) else { return };
        let (_, events) = motion(&a, number(&truth["v0_m_s"]), IntegrationRule::Trapezoid, IntegrationStart::TimeZero);
        let DynamicCrush { time_s, displacement_m, .. } = events.crush.unwrap();
        // Error of the rule at 10 kHz: up to 1.3e-6 m on these records. A microsecond is a hundredth of a sample.
        assert_near(&format!("{id} C"), displacement_m, number(&truth["expected"]["C"]), 2e-6);
        assert_near(&format!("{id} t_m"), time_s, number(&truth["expected"]["t_m"]), 1.3e-6);
    }
}

/// CFC 60 as the bare equation of SAE J211-1, forward and backward from rest.
///
/// The filter of the pipeline is another stage. The records begin at rest, and what the missing extension spoils at
/// their end is more than 100 ms after the dynamic crush, ten times what the filter remembers.
fn cfc_60(a: &Signal<Acceleration>) -> Signal<Acceleration> {
    let wa = (std::f64::consts::PI * 60.0 * 2.0775 * a.dt_s()).tan();
    let d = 1.0 + std::f64::consts::SQRT_2 * wa + wa * wa;
    let (a0, b1, b2) = (wa * wa / d, -2.0 * (wa * wa - 1.0) / d, (-1.0 + std::f64::consts::SQRT_2 * wa - wa * wa) / d);
    let pass = |x: &[f64]| {
        let mut y = vec![0.0; x.len()];
        for i in 2..x.len() {
            y[i] = a0 * (x[i] + 2.0 * x[i - 1] + x[i - 2]) + b1 * y[i - 1] + b2 * y[i - 2];
        }
        y.reverse();
        y
    };
    a.with_samples(pass(&pass(a.samples()))).unwrap()
}

/// Stiffness and damping of a Kelvin model from time and depth of its crush: the ratio t_c/t_m gives ζ by bisection,
/// t_m gives ω.
fn kelvin(crush: DynamicCrush, v0: f64, mass_kg: f64) -> (f64, f64) {
    let ratio = crush.displacement_m / v0 / crush.time_s;
    let shape = |zeta: f64| {
        let root = (1.0 - zeta * zeta).sqrt();
        let angle = root.atan2(zeta);
        (root / angle * (-zeta / root * angle).exp(), angle / root)
    };
    // The ratio falls from 2/π without damping to 1/e at the critical one.
    let (mut low, mut high) = (0.0, 1.0 - 1e-12);
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if shape(middle).0 > ratio { low = middle } else { high = middle }
    }
    let omega = shape(low).1 / crush.time_s;
    (mass_kg * omega * omega, 2.0 * low * omega * mass_kg)
}

#[test]
fn through_cfc_60_and_from_the_record_s_start_a_kelvin_model_is_recovered() {
    let Some((a, truth)) = record("kelvin-underdamped") else { return };
    let (v0, mass_kg) = (number(&truth["v0_m_s"]), number(&truth["mass_kg"]));
    let (k, c) = (number(&truth["parameters"]["k"]), number(&truth["parameters"]["c"]));
    let filtered = cfc_60(&a);

    // First that the closed form itself is right: on exact events it is exact.
    let exact = DynamicCrush {
        time_s: number(&truth["expected"]["t_m"]),
        displacement_m: number(&truth["expected"]["C"]),
        index: 0,
    };
    let (k_exact, c_exact) = kelvin(exact, v0, mass_kg);
    assert_near("k of exact events", k_exact / k, 1.0, 1e-9);
    assert_near("c of exact events", c_exact / c, 1.0, 1e-9);

    let (motion_found, events) = motion(&filtered, v0, IntegrationRule::Trapezoid, IntegrationStart::Auto);
    assert_eq!(motion_found.start, UsedStart::RecordStart);
    let found = events.crush.unwrap();
    let (k_found, c_found) = kelvin(found, v0, mass_kg);
    println!(
        "record-start: C {:+.3} mm, t_m {:+.1} us, k {:+.3} %, c {:+.3} %",
        1e3 * (found.displacement_m - exact.displacement_m),
        1e6 * (found.time_s - exact.time_s),
        1e2 * (k_found / k - 1.0),
        1e2 * (c_found / c - 1.0)
    );
    // At ζ = 0.22 the ratio t_c/t_m changes by -0.42 per unit of ζ: 3 % of damping is 0.5 % of the ratio, 0.5 % of
    // stiffness is 0.25 % of t_m and of C. The jump at contact, one sample wide and counted whole, costs c·v0/m·T/2 =
    // 5 mm/s, that is 0.07 % of C; the filter adds less.
    assert_near("k", k_found / k, 1.0, 5e-3);
    assert_near("c", c_found / c, 1.0, 3e-2);

    // Starting at time zero instead loses what the filter put before it, and shows in the damping.
    let (_, events) = motion(&filtered, v0, IntegrationRule::Trapezoid, IntegrationStart::TimeZero);
    let late = events.crush.unwrap();
    let (k_late, c_late) = kelvin(late, v0, mass_kg);
    println!("time-zero: k {:+.3} %, c {:+.3} %", 1e2 * (k_late / k - 1.0), 1e2 * (c_late / c - 1.0));
    assert!(
        (late.displacement_m - exact.displacement_m).abs() > 3.0 * (found.displacement_m - exact.displacement_m).abs()
    );
}
