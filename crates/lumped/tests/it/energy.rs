//! Where the energy goes: the balance closes for every model under every drive it takes.

use crumple_lumped::{
    DoubleSpringMassDamper, Drive, Elastoplastic, Kelvin, Maxwell, Model, Nonlinear1, Nonlinear2,
    TripleSpringMassDamper,
};
use proptest::prelude::*;

/// Every kind, with parameters scaled by five numbers near 1.
fn models([a, b, c, d, e]: [f64; 5]) -> Vec<Model> {
    let mass_kg = 900.0;
    let elastoplastic = |release| {
        Model::Elastoplastic(Elastoplastic {
            mass_kg,
            loading_stiffness_n_per_m: a * 3e5,
            unloading_stiffness_n_per_m: b * 6e6,
            release,
        })
    };
    let kelvin = |damping_n_s_per_m| Model::Kelvin(Kelvin { mass_kg, stiffness_n_per_m: a * 3e5, damping_n_s_per_m });
    let maxwell =
        |damping_n_s_per_m| Model::Maxwell(Maxwell { mass_kg, stiffness_n_per_m: a * 3e6, damping_n_s_per_m });
    vec![
        kelvin(0.0),
        kelvin(c * 3e3),
        kelvin(c * 9e4),
        elastoplastic(true),
        elastoplastic(false),
        // Complex and real roots: critical at sqrt(k m)/2 = 2.6e4.
        maxwell(c * 8e4),
        maxwell(c * 4e3),
        Model::Nonlinear1(Nonlinear1 {
            mass_kg,
            k1_n_per_m: a * 2e4,
            k2_n_per_m: b * 4e5,
            c1_n_s_per_m: c * 5e4,
            c2_n_s_per_m: d * 1e4,
            c3_n_s_per_m: e * 2e3,
            v_thresh_m_per_s: 3.0,
            crush_m: 0.5,
            v0_m_per_s: 12.0,
        }),
        Model::Nonlinear2(Nonlinear2 {
            mass_kg,
            k1_n_per_m: a * 8e4,
            k2_n_per_m: 4.0,
            k3_n_per_m: b * 2e5,
            x1_m: 0.4,
            c1_n_s_per_m: c * 8e4,
            c2_n_s_per_m: 8e4,
            c3_n_s_per_m: d * 2e4,
            c4_n_s_per_m: e * 80.0,
            v1_m_per_s: 2.5,
            v2_m_per_s: 7.2,
            crush_m: 0.5,
            v0_m_per_s: 12.0,
        }),
        Model::DoubleSpringMassDamper(DoubleSpringMassDamper {
            m1_kg: 291.0,
            m2_kg: 582.0,
            k1_n_per_m: a * 3e5,
            k2_n_per_m: b * 4e5,
            c1_n_s_per_m: c * 4e3,
            c2_n_s_per_m: d * 6e3,
        }),
        Model::TripleSpringMassDamper(TripleSpringMassDamper {
            masses_kg: [200.0, 350.0, 900.0],
            springs_n_per_m: [a * 4e5, b * 6e5, 9e5],
            dampers_n_s_per_m: [c * 8e3, d * 5e3, e * 1.2e4],
        }),
    ]
}

proptest! {
    #[test]
    fn the_balance_closes_after_an_impact(factors in prop::array::uniform5(0.3..3.0f64), dt in 1e-4..2e-3f64) {
        for model in models(factors) {
            let found = model.dynamics(&Drive::Impact(12.0), dt, 400).unwrap();
            // Heat by exact integrals: 400 steps of 1e-15 for the linear models, the rest of the series (1e-17 of the
            // displacement, some 1e-14 of the power) for the nonlinear ones. The asked-for limit is 1e-9.
            let closure = found.energy_closure().unwrap();
            prop_assert!(closure < 1e-11, "{:?}: {closure:e}", model.kind());
            prop_assert_eq!(&found.response, &model.respond(12.0, dt, 400).unwrap());
            for pair in found.energy.windows(2) {
                prop_assert!(pair[1].dissipated_j >= pair[0].dissipated_j - 1e-9, "{:?} cools", model.kind());
            }
        }
    }
}

/// A pulse and a sled, both over before the end, in samples of 0.1 ms.
fn drives() -> [Drive; 3] {
    let pulse: Vec<f64> = (0..500).map(|k| 2e5 * (f64::from(k) * 0.01).sin().powi(2)).collect();
    let sled = (0..800).map(|k| 200.0 * (f64::from(k) * 0.006).sin()).collect();
    [
        Drive::Force { mass: 0, samples: pulse.clone() },
        Drive::BaseAcceleration(sled),
        Drive::ImpactAndForce { speed_m_per_s: 9.0, mass: 0, samples: pulse },
    ]
}

#[test]
fn the_balance_closes_under_force_and_base_motion_and_the_forces_are_those_that_move_the_masses() {
    let mut driven = 0;
    for model in models([1.0; 5]) {
        for drive in drives() {
            let found = model.dynamics(&drive, 1e-4, 2001).unwrap();
            driven += 1;
            // 2,000 quadratic forms, each right to about 1e-15 of the energy.
            // A barrier that goes away first leaves an elastoplastic mass that is not held where it was: no energy at
            // all.
            assert!(found.energy_closure().is_none_or(|gap| gap < 1e-11), "{:?}", model.kind());
            let push = |k: usize| match &drive {
                Drive::Force { samples, .. } | Drive::ImpactAndForce { samples, .. } => {
                    samples.get(k).copied().unwrap_or(0.0)
                }
                _ => 0.0,
            };
            for k in [1, 300, 700, 2000] {
                let inertia = found.response.masses_kg[0] * found.response.motions[0].acceleration_m_per_s2[k];
                let at = |name: &str| found.forces.iter().filter(|f| f.name == name).map(|f| f.force_n[k]).sum::<f64>();
                let front =
                    if model.kind().name() == "maxwell" { at("k") } else { at("k") + at("c") + at("k1") + at("c1") };
                let behind = at("k2") + at("c2");
                // Sums of forces near 1e6 N.
                assert!((inertia - (push(k) + behind - front)).abs() < 1e-7, "{:?} {k}", model.kind());
            }
        }
    }
    // Three Kelvin, two elastoplastic, two Maxwell, two nonlinear, two masses, three masses, under three drives each.
    assert_eq!(driven, 33);
}

#[test]
fn a_nonlinear_model_pushed_by_nothing_moves_as_after_an_impact() {
    for model in &models([1.0; 5])[7..9] {
        let drive = Drive::ImpactAndForce { speed_m_per_s: 9.0, mass: 0, samples: vec![0.0; 1000] };
        let driven = model.dynamics(&drive, 1e-4, 1000).unwrap();
        let free = model.dynamics(&Drive::Impact(9.0), 1e-4, 1000).unwrap();
        let pairs =
            driven.response.compartment().displacement_m.iter().zip(&free.response.compartment().displacement_m);
        let apart = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // Two series of 1e-15 a step, ending at the samples and at the knots.
        assert!(apart < 1e-12, "{:?}: {apart:e}", model.kind());
    }
}

#[test]
fn a_growing_motion_closes_beside_its_own_energy_and_is_said_to_diverge() {
    // A negative damper: a root at +96.5/s, the energy grows by e^(2 · 96.5/s · 2 s) = 1e167 over what the impact
    // brought in.
    let model = Model::Kelvin(Kelvin { mass_kg: 900.0, stiffness_n_per_m: 3e5, damping_n_s_per_m: -9e4 });
    let found = model.dynamics(&Drive::Impact(12.0), 1e-4, 20_001).unwrap();
    // 20,000 samples of 1e-15.
    assert!(found.energy_closure().unwrap() < 1e-11, "{:e}", found.energy_closure().unwrap());
    assert!(found.diverges());
    let passive = Model::Kelvin(Kelvin { mass_kg: 900.0, stiffness_n_per_m: 3e5, damping_n_s_per_m: 9e3 });
    assert!(!passive.dynamics(&Drive::Impact(12.0), 1e-4, 20_001).unwrap().diverges());
}

#[test]
fn a_force_on_a_mass_that_is_not_there_is_refused() {
    let far = Drive::Force { mass: 1, samples: vec![1.0] };
    for model in &models([1.0; 5])[3..6] {
        assert!(model.dynamics(&far, 1e-4, 10).is_err(), "{:?}", model.kind());
    }
}

#[test]
fn maxwell_on_a_sled_ends_where_the_sled_ends() {
    // One pulse of the sled that leaves it moving at 3 m/s: the mass is dragged along, the damper's give remains.
    let model = Maxwell { mass_kg: 900.0, stiffness_n_per_m: 3e6, damping_n_s_per_m: 3e4 };
    let sled: Vec<f64> = (0..=300).map(|k| if k < 300 { 100.0 } else { 0.0 }).collect();
    let found = Model::Maxwell(model).dynamics(&Drive::BaseAcceleration(sled), 1e-4, 20_001).unwrap();
    let motion = found.response.compartment();
    // The samples are joined by lines: 299.5 intervals of 100 m/s²; e^(-17/s · 2 s) of it is left.
    assert!((motion.velocity_m_per_s[20_000] - 2.995).abs() < 1e-9, "{}", motion.velocity_m_per_s[20_000]);
    // Momentum m dv passes through the damper: it is drawn out by m dv/c.
    let give = found.forces[1].deflection_m[20_000];
    assert!((give + 900.0 * 2.995 / 3e4).abs() < 1e-9, "{give}");
}
