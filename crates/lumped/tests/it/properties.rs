//! What holds for every parameter set.

use crumple_lumped::{DoubleSpringMassDamper, Instants, Kelvin, Model, Nonlinear2};
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
    let force = r.barrier_force_n();
    assert!((force[700] - 3e5 * r.motions[0].displacement_m[700]).abs() < 1e-6, "{}", force[700]);
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
