//! What holds for every parameter set.

use std::collections::BTreeMap;

use crumple_lumped::{
    Chain, CrushedLoadPaths, CrushedStructure, DoubleSpringMassDamper, Instants, Kelvin, LoadPath, Model, ModelKind,
    Motion, Nonlinear2,
};
use proptest::prelude::*;

fn double() -> impl Strategy<Value = DoubleSpringMassDamper> {
    // Log-uniform around cars: masses within a factor 10, springs and dampers within 1000.
    let log = |low: f64, high: f64| (low.ln()..high.ln()).prop_map(f64::exp);
    (log(100.0, 1e3), log(100.0, 1e3), log(1e4, 1e7), log(1e4, 1e7), log(1e2, 1e5), log(1e2, 1e5)).prop_map(
        |(m1_kg, m2_kg, k1_n_per_m, k2_n_per_m, c1_n_s_per_m, c2_n_s_per_m)| DoubleSpringMassDamper {
            m1_kg,
            m2_kg,
            k1_n_per_m,
            k2_n_per_m,
            c1_n_s_per_m,
            c2_n_s_per_m,
        },
    )
}

/// Displacement and velocity of a mass at an instant.
fn at(model: &DoubleSpringMassDamper, mass: usize, t_s: f64) -> (f64, f64) {
    let instant = Instants { first_s: t_s, dt_s: 1e-4, samples: 1 };
    let motion = model.structure().unwrap().motions_at(12.0, &instant).unwrap().swap_remove(mass);
    (motion.displacement_m[0], motion.velocity_m_per_s[0])
}

proptest! {
    #[test]
    fn the_dual_moves_the_compartment_the_same_way(model in double()) {
        let dual = model.dual();
        let respond = |m| Model::DoubleSpringMassDamper(m).respond(12.0, 1e-4, 1001).unwrap();
        let (a, b) = (respond(model), respond(dual));
        let largest = a.compartment().displacement_m.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for (x, y) in a.compartment().displacement_m.iter().zip(&b.compartment().displacement_m) {
            // 1000 multiplications with matrices whose entries carry a few 1e-16 each.
            prop_assert!((x - y).abs() < 1e-12 * largest, "{x} {y}");
        }
        let back = dual.dual();
        // Four roundings there and back.
        prop_assert!((back.k1_n_per_m / model.k1_n_per_m - 1.0).abs() < 1e-15);
        prop_assert!((back.c2_n_s_per_m / model.c2_n_s_per_m - 1.0).abs() < 1e-15);
    }

    #[test]
    fn sampling_finer_gives_the_same_motion(model in double()) {
        let respond = |dt, n| Model::DoubleSpringMassDamper(model).respond(12.0, dt, n).unwrap();
        let (coarse, fine) = (respond(1e-3, 101), respond(1e-4, 1001));
        for k in 0..101 {
            let (a, b) = (coarse.compartment().velocity_m_per_s[k], fine.compartment().velocity_m_per_s[10 * k]);
            // No error of order dt: rounding of 1000 steps only, at 12 m/s.
            prop_assert!((a - b).abs() < 1e-11, "{a} {b}");
        }
    }

    #[test]
    fn events_are_zeros_of_the_motion(model in double()) {
        for (mass, events) in model.events(12.0).unwrap().into_iter().enumerate() {
            let t = events.time_of_dynamic_crush_s.unwrap();
            let (displacement_m, velocity_m_per_s) = at(&model, mass, t);
            // Rounding of velocity at 12 m/s, and of t times a deceleration below 1e5 m/s².
            prop_assert!(velocity_m_per_s.abs() < 1e-10, "{}", velocity_m_per_s);
            // The search marches there in up to some thousand steps, each a few 1e-16 of the crush: 3 m for soft
            // springs.
            let crush = events.dynamic_crush_m.unwrap();
            prop_assert!((displacement_m - crush).abs() < 1e-12 * crush.max(1.0));
            // The first zero: positive before.
            for k in 0..100 {
                let (_, before) = at(&model, mass, t * f64::from(k) * 0.0099);
                prop_assert!(before > 0.0, "{before} at {} of {t}", f64::from(k) * 0.0099);
            }
        }
    }

    #[test]
    fn energy_of_a_kelvin_model_goes_into_spring_and_damper(
        k in 1e4..1e6f64, c in 0.0..1e5f64, m in 500.0..2500.0f64,
    ) {
        let kelvin = Kelvin { mass_kg: m, stiffness_n_per_m: k, damping_n_s_per_m: c };
        let (dt, n) = (1e-5, 10_001);
        let r = Model::Kelvin(kelvin).respond(15.0, dt, n).unwrap();
        let motion = r.compartment();
        // Simpson's rule of c v² over 0.1 s; its error is far below 1e-9 of the energy for rates up to 200/s.
        let power = |i: usize| c * motion.velocity_m_per_s[i].powi(2);
        let weight = |i: usize| if i == 0 || i == n - 1 { 1.0 } else if i % 2 == 1 { 4.0 } else { 2.0 };
        let lost: f64 = (0..n).map(|i| weight(i) * power(i)).sum::<f64>() * dt / 3.0;
        let (x, v) = (motion.displacement_m[n - 1], motion.velocity_m_per_s[n - 1]);
        let balance = 0.5 * m * v * v + 0.5 * k * x * x + lost;
        let start = 0.5 * m * 15.0 * 15.0;
        prop_assert!((balance / start - 1.0).abs() < 1e-9, "{balance} {start}");
    }
}

#[test]
fn energy_of_a_double_model_is_kept_without_dampers() {
    let model = DoubleSpringMassDamper {
        m1_kg: 291.0,
        m2_kg: 582.0,
        k1_n_per_m: 3e5,
        k2_n_per_m: 4e5,
        c1_n_s_per_m: 0.0,
        c2_n_s_per_m: 0.0,
    };
    let r = Model::DoubleSpringMassDamper(model).respond(10.0, 1e-4, 10_001).unwrap();
    let start = 0.5 * 873.0 * 100.0;
    for k in 0..10_001 {
        let (x1, x2) = (r.motions[0].displacement_m[k], r.motions[1].displacement_m[k]);
        let (v1, v2) = (r.motions[0].velocity_m_per_s[k], r.motions[1].velocity_m_per_s[k]);
        let energy = 0.5 * (291.0 * v1 * v1 + 582.0 * v2 * v2 + 3e5 * x1 * x1 + 4e5 * (x2 - x1).powi(2));
        // 10,000 multiplications by a matrix with entries right to 1e-16: at worst 1e-12 and growing linearly.
        assert!((energy / start - 1.0).abs() < 1e-11, "{k}: {energy}");
    }
    // The barrier feels what the first spring carries.
    let [a1, a2] = [0, 1].map(|mass: usize| r.motions[mass].acceleration_m_per_s2[700]);
    let force = -(291.0 * a1 + 582.0 * a2);
    assert!((force - 3e5 * r.motions[0].displacement_m[700]).abs() < 1e-6, "{force}");
}

#[test]
fn a_double_model_without_the_barrier_spring_never_stops() {
    let model = DoubleSpringMassDamper {
        m1_kg: 300.0,
        m2_kg: 900.0,
        k1_n_per_m: 0.0,
        k2_n_per_m: 4e5,
        c1_n_s_per_m: 2e3,
        c2_n_s_per_m: 1e3,
    };
    assert_eq!(model.events(10.0).unwrap()[1].dynamic_crush_m, None);
}

#[test]
fn a_diverging_response_is_an_error_with_its_time() {
    let model = Kelvin { mass_kg: 1.0, stiffness_n_per_m: 1.0, damping_n_s_per_m: -1e6 };
    let error = Model::Kelvin(model).respond(10.0, 1e-3, 10).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the response of the kelvin model is not finite from t = 0.001 s on: it diverges or is too stiff"
    );
}

proptest! {
    #[test]
    fn a_nonlinear_mass_loses_energy_and_moves_the_same_at_any_rate(
        k in prop::array::uniform3(0.0..3e5f64), c in prop::array::uniform4(0.0..9e4f64),
        x1 in 0.05..0.95f64, v1 in 0.05..0.5f64, v2 in 0.5..0.95f64, zero in 0..8usize,
    ) {
        let (mut k, mut c) = (k, c);
        // Coefficients on the border of what a fit may try.
        if zero < 3 { k[zero] = 0.0 } else if zero < 7 { c[zero - 3] = 0.0 }
        let model = Nonlinear2 {
            mass_kg: 873.0,
            k1_n_per_m: k[0],
            k2_n_per_m: k[1],
            k3_n_per_m: k[2],
            x1_m: 0.5 * x1,
            c1_n_s_per_m: c[0],
            c2_n_s_per_m: c[1],
            c3_n_s_per_m: c[2],
            c4_n_s_per_m: c[3],
            v1_m_per_s: 10.0 * v1,
            v2_m_per_s: 10.0 * v2,
            crush_m: 0.5,
            v0_m_per_s: 10.0,
        };
        let respond = |dt_s, samples| Model::Nonlinear2(model).respond(10.0, dt_s, samples).unwrap();
        let (coarse, fine) = (respond(5e-3, 41), respond(1e-4, 2001));
        let (coarse, fine) = (coarse.compartment(), fine.compartment());
        for i in 0..41 {
            // The same series, evaluated at the same instants: rounding of positions near 1 m.
            prop_assert!((coarse.displacement_m[i] - fine.displacement_m[50 * i]).abs() < 1e-13);
        }
        for w in fine.velocity_m_per_s.windows(2) {
            prop_assert!(w[0].abs() <= 10.0 + 1e-12 && w[1].is_finite());
        }
        // Newton's law between the samples: a mean over two intervals lies within the change over them.
        for i in 1..2000 {
            let rate = (fine.velocity_m_per_s[i + 1] - fine.velocity_m_per_s[i - 1]) / 2e-4;
            let a = &fine.acceleration_m_per_s2;
            let change = (a[i + 1] - a[i]).abs().max((a[i] - a[i - 1]).abs());
            prop_assert!((rate - a[i]).abs() < 2.0 * change + 1e-2, "{} {}", rate, a[i]);
        }
    }
}

const V0: f64 = 9.7222;

fn model(kind: ModelKind) -> Model {
    if kind == ModelKind::ForceDeflection {
        let knots = [(0.05, 9e4), (0.12, 8e4), (0.3, 1.6e5), (0.5, 2.2e5)];
        return Model::ForceDeflection(CrushedStructure::new(873.0, &knots, 9e6, 0.012).unwrap());
    }
    if kind == ModelKind::LoadPaths {
        let path = |knots: &[(f64, f64)], unloading| Some(LoadPath::new(knots, unloading, 0.012).unwrap());
        let front = path(&[(0.06, 7e4), (0.2, 9e4), (0.4, 1.2e5)], 8e6);
        let rear = path(&[(0.03, 5e4), (0.2, 1.1e5)], 9e6);
        let parallel = path(&[(0.1, 4e4), (0.3, 5e4), (0.5, 9e4)], 7e6);
        return Model::LoadPaths(CrushedLoadPaths { m1_kg: 200.0, m2_kg: 673.0, paths: [front, rear, parallel] });
    }
    let values: &[f64] = match kind {
        ModelKind::Kelvin => &[873.0, 3.2e5, 6e3],
        ModelKind::Elastoplastic => &[873.0, 3.2e5, 9e6],
        ModelKind::Maxwell => &[873.0, 2.3e6, 3.4e4],
        ModelKind::Nonlinear1 => &[873.0, 23_700.0, 253_440.0, 56_816.0, 19_956.0, 1_795.0, 2.8, 0.5063, V0],
        ModelKind::Nonlinear2 => {
            &[873.0, 82_357.0, 40_000.0, 197_519.0, 0.4, 86_585.0, 50_056.0, 18_721.0, 2_000.0, 2.55, 7.23, 0.5063, V0]
        }
        ModelKind::DoubleSpringMassDamper => &[300.0, 900.0, 5e5, 7e5, 6e3, 9e3],
        ModelKind::TripleSpringMassDamper => &[150.0, 200.0, 900.0, 6e5, 5e5, 7e5, 6e3, 4e3, 9e3],
        ModelKind::ForceDeflection | ModelKind::LoadPaths | ModelKind::Chain | ModelKind::Own => &[],
    };
    let named: BTreeMap<String, f64> =
        kind.parameter_names().iter().map(|n| (*n).to_owned()).zip(values.iter().copied()).collect();
    Model::from_parameters(kind, &named).unwrap()
}

fn moved(of: &Model, name: &str, by: f64) -> Model {
    let mut named = of.parameters();
    *named.get_mut(name).unwrap() *= 1.0 + by;
    Model::from_parameters(of.kind(), &named).unwrap()
}

fn parts(motion: &Motion) -> [&Vec<f64>; 3] {
    [&motion.displacement_m, &motion.velocity_m_per_s, &motion.acceleration_m_per_s2]
}

#[test]
fn derivatives_agree_with_central_differences() {
    let at = Instants { first_s: 0.0031, dt_s: 1.7e-3, samples: 70 };
    let h = 1e-6;
    for kind in ModelKind::ALL {
        let centre = model(kind);
        let (names, given) = (kind.parameter_names(), centre.parameters());
        let all: Vec<usize> = (0..names.len()).filter(|p| given.contains_key(names[*p])).collect();
        let found = centre.sensitivity(V0, &at, &all).unwrap();
        for (p, name) in all.iter().map(|p| names[*p]).enumerate() {
            // The motion begins on the last knot of the damper, a kink: differences to the side it moves to.
            let one_sided = name == "v0_m_per_s";
            let (a, b) = if one_sided { (2.0 * h, h) } else { (h, -h) };
            let up = moved(&centre, name, a).sensitivity(V0, &at, &[]).unwrap();
            let down = moved(&centre, name, b).sensitivity(V0, &at, &[]).unwrap();
            let value = given[name];
            for mass in 0..found.motions.len() {
                // Acceleration jumps or kinks in models with knots and plastic ones: a difference across is none.
                let smooth = matches!(
                    kind,
                    ModelKind::Kelvin
                        | ModelKind::Maxwell
                        | ModelKind::DoubleSpringMassDamper
                        | ModelKind::TripleSpringMassDamper
                );
                for part in 0..if smooth { 3 } else { 2 } {
                    let (up, down) = (parts(&up.motions[mass])[part], parts(&down.motions[mass])[part]);
                    let derivative = parts(&found.derivatives[p][mass])[part];
                    let size = parts(&found.motions[mass])[part].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
                    for k in 0..at.samples {
                        let here = parts(&found.motions[mass])[part][k];
                        let difference = if one_sided {
                            (4.0 * down[k] - up[k] - 3.0 * here) / (2.0 * h)
                        } else {
                            (up[k] - down[k]) / (2.0 * h)
                        };
                        // Relative change by relative change. h² of the third derivative is 1e-11 here, rounding over h
                        // 1e-9; where a knot moves, the second derivative jumps: h of it.
                        let limit = if smooth { 1e-7 } else { 10.0 * h } * size;
                        let gap = (derivative[k] * value - difference).abs();
                        assert!(gap < limit, "{kind} {name} mass {mass} part {part} sample {k}: {gap:e} {limit:e}");
                    }
                }
            }
        }
    }
}

#[test]
fn motions_are_those_of_the_response() {
    for kind in ModelKind::ALL {
        let model = model(kind);
        let whole = model.respond(V0, 1e-3, 120).unwrap();
        let at = Instants { first_s: 0.01, dt_s: 2e-3, samples: 50 };
        let found = model.sensitivity(V0, &at, &[]).unwrap();
        for (a, b) in found.motions.iter().zip(&whole.motions) {
            for k in 0..at.samples {
                let i = 10 + 2 * k;
                // Two exact methods: rounding of 120 steps.
                assert!((a.displacement_m[k] - b.displacement_m[i]).abs() < 1e-13, "{kind} {k}");
                assert!((a.acceleration_m_per_s2[k] - b.acceleration_m_per_s2[i]).abs() < 1e-9, "{kind} {k}");
            }
        }
    }
}

#[test]
fn derivatives_of_a_chain_of_any_length_agree_with_central_differences() {
    let (masses, springs, dampers) = ([150.0, 200.0, 120.0, 900.0], [6e5, 5e5, 9e5, 7e5], [6e3, 4e3, 2e3, 9e3]);
    let at = Instants { first_s: 0.0031, dt_s: 1.7e-3, samples: 60 };
    let all: Vec<usize> = (0..12).collect();
    let found = Chain::with_constants(&masses, &springs, &dampers).unwrap().sensitivity(V0, &at, &all).unwrap();
    let h = 1e-6;
    for place in all {
        let moved = |by: f64| {
            let mut values = [masses, springs, dampers].concat();
            values[place] *= 1.0 + by;
            let chain = Chain::with_constants(&values[..4], &values[4..8], &values[8..]).unwrap();
            (chain.sensitivity(V0, &at, &[]).unwrap().motions, values[place])
        };
        let ((up, _), (down, _), (_, value)) = (moved(h), moved(-h), moved(0.0));
        for mass in 0..4 {
            for part in 0..3 {
                let size = parts(&up[mass])[part].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
                for k in 0..at.samples {
                    let difference = (parts(&up[mass])[part][k] - parts(&down[mass])[part][k]) / (2.0 * h);
                    let own = parts(&found.derivatives[place][mass])[part][k] * value;
                    // h² of the third derivative 1e-11, rounding over h 1e-9.
                    assert!((own - difference).abs() < 1e-7 * size, "{place} {mass} {part} {k}");
                }
            }
        }
    }
    let error = Chain::with_constants(&masses, &springs, &dampers).unwrap().sensitivity(V0, &at, &[12]).unwrap_err();
    assert_eq!(error.to_string(), "parameter is 12, expected the place of a mass, spring or damper of the chain");
}
