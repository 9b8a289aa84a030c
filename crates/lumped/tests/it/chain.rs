//! Chains of masses: against the double model, energies, forces, drives.

use crumple_lumped::{Chain, DoubleSpringMassDamper, Drive, Model};

fn triple() -> Chain {
    Chain::with_constants(&[200.0, 350.0, 900.0], &[4e5, 6e5, 9e5], &[8e3, 5e3, 1.2e4]).unwrap()
}

#[test]
fn two_masses_are_the_double_model() {
    let double = DoubleSpringMassDamper {
        m1_kg: 291.0,
        m2_kg: 582.0,
        k1_n_per_m: 4e5,
        k2_n_per_m: 6e5,
        c1_n_s_per_m: 9e3,
        c2_n_s_per_m: 7e3,
    };
    let chain = Chain::with_constants(&[291.0, 582.0], &[4e5, 6e5], &[9e3, 7e3]).unwrap();
    for (a, b) in chain.characteristic_polynomial().iter().zip(double.characteristic_polynomial()) {
        // Sums of positive terms on both sides.
        assert!((a - b).abs() <= 4e-15 * b, "{a} {b}");
    }
    let one = chain.respond(&Drive::Impact(12.0), 1e-4, 1001).unwrap();
    let two = Model::DoubleSpringMassDamper(double).respond(12.0, 1e-4, 1001).unwrap();
    for (a, b) in one.motions[1].displacement_m.iter().zip(&two.motions[1].displacement_m) {
        // A thousand multiplications by matrices that differ by roundings.
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    }
    let (a, b) = (chain.events(12.0, 2.0).unwrap()[1], double.events(12.0).unwrap()[1]);
    assert!((a.dynamic_crush_m.unwrap() - b.dynamic_crush_m.unwrap()).abs() < 1e-13);
    assert!((a.time_of_rebound_s.unwrap() - b.time_of_rebound_s.unwrap()).abs() < 1e-12);
}

#[test]
fn energy_closes_for_every_drive() {
    let chain = triple();
    let pulse: Vec<f64> = (0..500).map(|k| 2e5 * (f64::from(k) * 0.01).sin().powi(2)).collect();
    let sled: Vec<f64> = (0..800).map(|k| 200.0 * (f64::from(k) * 0.006).sin()).collect();
    for drive in [Drive::Impact(15.0), Drive::Force { mass: 0, samples: pulse }, Drive::BaseAcceleration(sled)] {
        let response = chain.dynamics(&drive, 1e-4, 2001).unwrap();
        let largest = response.energy.iter().fold(0.0_f64, |m, e| m.max(e.input_j.abs()));
        assert!(largest > 1.0);
        for e in &response.energy {
            // 2,000 quadratic forms, each right to about 1e-15 of the energy.
            let gap = e.kinetic_j + e.stored_j + e.dissipated_j - e.input_j;
            assert!(gap.abs() < 1e-11 * largest, "{gap} of {largest}");
        }
    }
}

#[test]
fn forces_of_the_elements_move_the_masses() {
    let chain = triple();
    let r = chain.dynamics(&Drive::Impact(15.0), 1e-4, 1001).unwrap();
    for k in [0, 10, 400, 1000] {
        let force: Vec<f64> = (0..3).map(|i| r.forces[2 * i].force_n[k] + r.forces[2 * i + 1].force_n[k]).collect();
        for i in 0..3 {
            let behind = force.get(i + 1).copied().unwrap_or(0.0);
            let inertia = chain.masses_kg()[i] * r.response.motions[i].acceleration_m_per_s2[k];
            // Sums of forces near 1e6 N.
            assert!((inertia - (behind - force[i])).abs() < 1e-8, "{i} {k}");
        }
    }
}

#[test]
fn refuses_what_is_no_chain() {
    assert!(Chain::with_constants(&[], &[], &[]).is_err());
    assert!(Chain::with_constants(&[1.0], &[1.0, 2.0], &[1.0]).is_err());
    assert!(Chain::with_constants(&[-1.0], &[1.0], &[1.0]).is_err());
    let chain = Chain::with_constants(&[1.0], &[1.0], &[1.0]).unwrap();
    assert!(chain.respond(&Drive::Force { mass: 1, samples: vec![1.0] }, 1e-3, 3).is_err());
    assert!(chain.respond(&Drive::Impact(1.0), 0.0, 3).is_err());
}

#[test]
fn crush_and_rebound_within_one_step_are_both_found() {
    // The horizon bounds the step from below: 100 s / 400,000 = 0.25 ms, 0.6 of a swing of the front mass.
    let chain = Chain::with_constants(&[1.0, 1000.0], &[2.27e8, 1e6], &[0.0, 0.0]).unwrap();
    let found = chain.events(10.0, 100.0).unwrap()[0];
    let swing_s = 2.0 * std::f64::consts::PI * (1.0_f64 / 2.28e8).sqrt();
    // The compartment moves on and shifts the middle of the swing by less than 1e6/2.28e8 of it.
    assert!((found.time_of_dynamic_crush_s.unwrap() / (0.25 * swing_s) - 1.0).abs() < 0.01);
    assert!((found.time_of_rebound_s.unwrap() / (0.5 * swing_s) - 1.0).abs() < 0.01);
    assert!(chain.events(10.0, 0.0).is_err() && chain.events(10.0, f64::NAN).is_err());
}
