//! From a state space in any basis back to masses, springs and dampers.

use crumple_lumped::{CoefficientMatching, DoubleSpringMassDamper, LumpedError, Reading, RealisedModel};
use nalgebra::{Matrix4, RowVector4, Vector4};
use proptest::prelude::*;

/// Six real solutions: see the matching of the same model.
const MODEL: DoubleSpringMassDamper = DoubleSpringMassDamper {
    m1_kg: 500.0,
    m2_kg: 500.0,
    k1_n_per_m: 12_000.0,
    k2_n_per_m: 9_000.0,
    c1_n_s_per_m: 50_000.0,
    c2_n_s_per_m: 8_000.0,
};

/// The model in the basis `z = S (x1, x2, v1, v2)`, its outputs of the given derivative.
fn realised(model: &DoubleSpringMassDamper, s: Matrix4<f64>, derivative: usize, both: bool) -> RealisedModel {
    let a = model.state_matrix();
    let back = s.try_inverse().unwrap();
    let row = |i: usize| {
        let mut row = RowVector4::zeros();
        row[i] = 1.0;
        (0..derivative).fold(row, |row, _| row * a) * back
    };
    RealisedModel {
        a: s * a * back,
        compartment: row(1),
        chassis: both.then(|| row(0)),
        derivative,
        start: Some(s * Vector4::new(0.0, 0.0, 12.0, 12.0)),
    }
}

#[test]
fn every_solution_of_the_matching_has_its_transformation_and_the_second_sensor_decides() {
    let s = Matrix4::new(1.0, 2.0, 0.1, 0.0, 0.5, -1.0, 0.0, 0.02, 3.0, 0.0, 0.05, 0.1, 0.0, 1.0, -0.1, 0.2);
    let identified = realised(&MODEL, s, 2, true);
    let [_, t, u, v, w] = MODEL.characteristic_polynomial();
    let found = CoefficientMatching::new([t, u, v, w], 500.0, 500.0, Reading::Binary).unwrap().solve();
    let mut right = 0;
    for solution in found.solutions.iter().filter(|s| s.real) {
        let model = solution.model(500.0, 500.0).unwrap();
        let p = identified.coordinates(&model).unwrap();
        // Rounding of A in the other basis, times the conditions of T and of c2 A + k2, up to 1e3 each.
        assert!(p.residual < 1e-9 && p.condition > 1.0, "{:e} {:e}", p.residual, p.condition);
        let start = p.start.unwrap();
        assert!(start[1].abs() < 1e-9 && (start[3] - 12.0).abs() < 1e-8, "the compartment's own: {start:?}");
        let mismatch = p.chassis_mismatch.unwrap();
        if (model.k1_n_per_m - 12_000.0).abs() < 1e-3 {
            right += 1;
            // That, and twice through the inverse of A, which is four natural frequencies from its slowest pole.
            assert!(mismatch < 1e-8, "{mismatch:e}");
            assert_eq!(p.stiffness_n_per_m[(0, 1)], -model.k2_n_per_m);
            assert!(start[0].abs() < 1e-9 && (start[2] - 12.0).abs() < 1e-8, "{start:?}");
        } else {
            assert!(mismatch > 1e-2, "{model:?}: {mismatch:e}");
        }
    }
    assert_eq!(right, 1);
    // The start tells the root, c1 c2/(m1 m2) = 1600.
    assert!((identified.zeta_of_the_start().unwrap() - 1600.0).abs() < 1e-6);
}

#[test]
fn a_sensor_that_moves_like_the_other_or_a_pole_at_zero_is_refused() {
    let mut alike = realised(&MODEL, Matrix4::identity(), 2, true);
    alike.chassis = Some(alike.compartment);
    assert!(matches!(alike.from_both_masses(1000.0), Err(LumpedError::Value { .. })));
    let free = DoubleSpringMassDamper { k1_n_per_m: 0.0, c1_n_s_per_m: 0.0, ..MODEL };
    assert!(realised(&free, Matrix4::identity(), 0, false).coordinates(&free).is_err());
    assert_eq!(realised(&MODEL, Matrix4::identity(), 2, false).from_both_masses(1000.0).unwrap(), None);
}

proptest! {
    #[test]
    fn both_sensors_give_masses_springs_and_dampers(
        logs in prop::array::uniform6(0.0..1.0f64), basis in prop::array::uniform16(-1.0..1.0f64),
        derivative in 0..3usize,
    ) {
        let log = |x: f64, low: f64, high: f64| low * (high / low).powf(x);
        let model = DoubleSpringMassDamper {
            m1_kg: log(logs[0], 100.0, 1e3),
            m2_kg: log(logs[1], 100.0, 1e3),
            k1_n_per_m: log(logs[2], 1e5, 1e6),
            k2_n_per_m: log(logs[3], 1e5, 1e6),
            c1_n_s_per_m: log(logs[4], 1e3, 3e4),
            c2_n_s_per_m: log(logs[5], 1e3, 3e4),
        };
        // Near the identity in scaled coordinates: well conditioned, but mixed.
        let scale = Matrix4::from_diagonal(&Vector4::new(1.0, 1.0, 0.05, 0.05));
        let s = (Matrix4::identity() * 4.0 + Matrix4::from_row_slice(&basis)) * scale;
        let identified = realised(&model, s, derivative, true);
        let (found, residual) = identified.from_both_masses(model.m1_kg + model.m2_kg).unwrap().unwrap();
        // A few hundred roundings of entries up to 1e3 apart, twice through a transformation.
        prop_assert!(residual < 1e-10, "{residual:e}");
        for (x, y) in [
            (found.m1_kg, model.m1_kg),
            (found.k1_n_per_m, model.k1_n_per_m),
            (found.k2_n_per_m, model.k2_n_per_m),
            (found.c1_n_s_per_m, model.c1_n_s_per_m),
            (found.c2_n_s_per_m, model.c2_n_s_per_m),
        ] {
            prop_assert!((x / y - 1.0).abs() < 1e-8, "{x} {y}");
        }
    }
}
