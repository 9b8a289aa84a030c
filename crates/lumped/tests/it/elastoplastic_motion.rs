//! The elastoplastic model under forces and base motion: against closed forms, itself on a finer grid, and the energy.

use std::f64::consts::PI;

use crumple_lumped::{Drive, Dynamics, Elastoplastic, Model};
use proptest::prelude::*;

const DT: f64 = 1e-4;

fn model(release: bool) -> Elastoplastic {
    Elastoplastic { mass_kg: 900.0, loading_stiffness_n_per_m: 3e5, unloading_stiffness_n_per_m: 6e6, release }
}

fn run(model: Elastoplastic, drive: &Drive, dt_s: f64, samples: usize) -> Dynamics {
    Model::Elastoplastic(model).dynamics(drive, dt_s, samples).unwrap()
}

fn displacement(found: &Dynamics) -> &[f64] {
    &found.response.compartment().displacement_m
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn without_a_force_it_moves_as_the_closed_form() {
    for release in [true, false] {
        let drive = Drive::ImpactAndForce { speed_m_per_s: 12.0, mass: 0, samples: vec![0.0; 3000] };
        let (driven, free) =
            (run(model(release), &drive, DT, 3000), run(model(release), &Drive::Impact(12.0), DT, 3000));
        // 3,000 steps of 1e-16 of 0.66 m, and the same of 12 m/s and 220 m/s² (attached: of 4.5 times that).
        let (a, b) = (driven.response.compartment(), free.response.compartment());
        assert!(apart(&a.displacement_m, &b.displacement_m) < 2e-13, "{release}");
        assert!(apart(&a.velocity_m_per_s, &b.velocity_m_per_s) < 2e-11, "{release}");
        assert!(apart(&a.acceleration_m_per_s2, &b.acceleration_m_per_s2) < 2e-9, "{release}");
        for (driven, free) in driven.energy.iter().zip(&free.energy) {
            // Of 65 kJ.
            assert!((driven.dissipated_j - free.dissipated_j).abs() < 1e-7);
            assert!((driven.stored_j - free.stored_j).abs() < 1e-7);
        }
    }
}

#[test]
fn a_constant_push_from_rest_crushes_twice_its_static_give_and_swings_on_the_unloading_line() {
    let push = 5e4;
    let m = model(true);
    let drive = Drive::Force { mass: 0, samples: vec![push; 4000] };
    let found = run(m, &drive, DT, 3000);
    let (w, q) = ((3e5_f64 / 900.0).sqrt(), (6e6_f64 / 900.0).sqrt());
    let (t_m, crush) = (PI / w, 2.0 * push / 3e5);
    let set = crush * (1.0 - 3e5 / 6e6);
    // At t_m the force in the spring is twice the push: the rest swings about the set and the static give of the stiff
    // line, by push/k_P, and never leaves it.
    let wanted: Vec<f64> = (0..3000)
        .map(|k| {
            let t = f64::from(k) * DT;
            if t <= t_m { push / 3e5 * (1.0 - (w * t).cos()) } else { set + push / 6e6 * (1.0 + (q * (t - t_m)).cos()) }
        })
        .collect();
    // 3,000 steps of 1e-16 of 0.33 m.
    assert!(apart(displacement(&found), &wanted) < 1e-13, "{:e}", apart(displacement(&found), &wanted));
}

#[test]
fn a_mass_pulled_off_comes_back_to_the_permanent_set_and_loads_beyond_the_old_crush() {
    // 9 m/s, then at rest of force until it has left; then a push back in that doubles the crush.
    let speed = 9.0;
    let m = model(true);
    let push = 4e5;
    let samples: Vec<f64> = (0..6000).map(|k| if k < 2000 { 0.0 } else { push }).collect();
    let found = run(m, &Drive::ImpactAndForce { speed_m_per_s: speed, mass: 0, samples }, DT, 5500);
    let first = m.events(speed).dynamic_crush_m.unwrap();
    let (x, force) = (displacement(&found), &found.forces[0].force_n);
    let set = first * (1.0 - 3e5 / 6e6);
    // On its way back: no force below the permanent set, the stiff line up to the old crush, the soft one beyond.
    let mut seen = [0; 3];
    let turned = (2000..5500).find(|&k| x[k] > x[k - 1] && force[k] == 0.0).unwrap();
    let highest = (turned..5500).find(|&k| x[k + 1] < x[k]).unwrap();
    for k in turned..highest {
        let (wanted, part) = if x[k] < set {
            (0.0, 0)
        } else if x[k] < first {
            (6e6 * (x[k] - set), 1)
        } else {
            (3e5 * x[k], 2)
        };
        seen[part] += 1;
        // Rounding of a crush near 1 m, times the stiffness.
        assert!((force[k] - wanted).abs() < 1e-7, "{k}: {} {wanted}", force[k]);
    }
    assert!(seen.iter().all(|n| *n > 3), "{seen:?}");
    assert!(x[highest] > 2.0 * first, "{} {first}", x[highest]);
    assert!(found.energy_closure().unwrap() < 1e-12);
}

#[test]
fn a_barrier_that_accelerates_is_a_force_seen_from_it() {
    let sled = -60.0;
    let (base, force) = (
        run(model(true), &Drive::BaseAcceleration(vec![sled; 3000]), DT, 2500),
        run(model(true), &Drive::Force { mass: 0, samples: vec![-900.0 * sled; 3000] }, DT, 2500),
    );
    // One rounding more a step, of 0.36 m and of 108 kN.
    assert!(apart(&base.forces[0].deflection_m, &force.forces[0].deflection_m) < 1e-12);
    assert!(apart(&base.forces[0].force_n, &force.forces[0].force_n) < 1e-5);
    let at = 2000;
    let t = at as f64 * DT;
    let absolute = displacement(&base)[at] - displacement(&force)[at];
    // Of 1.2 m.
    assert!((absolute - 0.5 * sled * t * t).abs() < 1e-12);
}

#[test]
fn a_sled_faster_than_the_mass_leaves_it_behind() {
    // The barrier goes away from the mass in the direction of crush: nothing touches it.
    let found = run(model(true), &Drive::BaseAcceleration(vec![100.0; 1000]), DT, 1000);
    assert!(displacement(&found).iter().all(|x| x.abs() < 1e-14));
    assert_eq!(found.forces[0].force_n[999], 0.0);
    // Held, it is drawn along.
    let held = run(model(false), &Drive::BaseAcceleration(vec![100.0; 1000]), DT, 1000);
    assert!(displacement(&held)[999] > 0.1);
}

/// Sines of three periods, joined by lines.
fn pulse([a, b, c]: [f64; 3], scale: f64, samples: usize) -> Vec<f64> {
    let wave = |t: f64| a * (70.0 * t).sin() + b * (190.0 * t).cos() + c * (17.0 * t).sin();
    (0..samples).map(|k| scale * wave(k as f64 * 1e-3)).collect()
}

proptest! {
    #[test]
    fn the_balance_closes_and_a_finer_grid_moves_the_same(
        factors in prop::array::uniform3(-1.0..1.0f64),
        speed in 0.0..15.0f64,
        ratio in 0.5..500.0f64,
        release: bool,
        by_base: bool,
    ) {
        let m = Elastoplastic { unloading_stiffness_n_per_m: 3e5 * ratio, ..model(release) };
        let coarse = pulse(factors, if by_base { 300.0 } else { 2e5 }, 300);
        // The same lines, ten points on each.
        let fine: Vec<f64> = (0..3000)
            .map(|k| {
                let (from, part) = (k / 10, (k % 10) as f64 / 10.0);
                let next = coarse.get(from + 1).copied().unwrap_or(0.0);
                coarse[from] * (1.0 - part) + next * part
            })
            .collect();
        let drive = |samples| if by_base {
            Drive::BaseAcceleration(samples)
        } else {
            Drive::ImpactAndForce { speed_m_per_s: speed, mass: 0, samples }
        };
        let (slow, quick) = (run(m, &drive(coarse), 1e-3, 400), run(m, &drive(fine), 1e-4, 4000));
        for found in [&slow, &quick] {
            // 4,000 steps, each right to 1e-15 of the energy of a mass that moves with the barrier, some 1e5 J: a touch
            // brings in less.
            let given = found.energy.iter().map(|e| e.input_j.abs()).fold(0.0, f64::max);
            let gap = found.energy.iter().map(|e| e.gap_j().abs()).fold(0.0, f64::max);
            prop_assert!(gap < 1e-11 * given.max(1e4), "{gap:e} of {given:e}");
            for pair in found.energy.windows(2) {
                prop_assert!(ratio < 1.0 || pair[1].dissipated_j >= pair[0].dissipated_j, "cools");
            }
        }
        let every_tenth: Vec<f64> = displacement(&quick).iter().step_by(10).copied().collect();
        // Rounding of metres, some 1e-13, grows with the number of contacts and the stiffness met: a hundred times a
        // contact at most.
        let size = every_tenth.iter().fold(1.0, |m: f64, x| m.max(x.abs()));
        let gap = apart(displacement(&slow), &every_tenth);
        prop_assert!(gap < 1e-9 * size, "{gap:e}");
    }
}

#[test]
fn a_rigid_unloading_line_is_followed_or_given_up_without_an_end() {
    let m = Elastoplastic { unloading_stiffness_n_per_m: 1e34, ..model(true) };
    let drive = Drive::ImpactAndForce { speed_m_per_s: 12.0, mass: 0, samples: pulse([1.0, -1.0, 0.5], 1e5, 100) };
    if let Ok(found) = Model::Elastoplastic(m).dynamics(&drive, 1e-3, 200) {
        assert!(displacement(&found).iter().all(|x| x.is_finite()));
    }
    let endless = Drive::Force { mass: 0, samples: vec![f64::NAN; 4] };
    assert!(Model::Elastoplastic(model(true)).dynamics(&endless, 1e-3, 10).is_err());
}
