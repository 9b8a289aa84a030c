//! The unloading stiffness of a crushed structure from the restitution of several tests.

use crumple_lumped::CrushedStructure;

use crate::TestData;
use crate::solvers::crush_curves::assumptions::USUAL_RESTITUTION;

/// Least unloading stiffness over the steepest slope of the curve: below one, unloading would give back more than was
/// put in.
const STIFFER: f64 = 1.05;

/// The structure with the unloading stiffness `F(C)²/(m v0² e²)` of its tests, the geometric mean of them, at least
/// 1.05 times its steepest slope. `None`: no curve.
pub(crate) fn with_restitution(structure: &CrushedStructure, tests: &[&TestData<'_>]) -> Option<CrushedStructure> {
    let knots = structure.knots();
    let stiffness = |test: &&TestData<'_>, restitution: f64| -> Option<f64> {
        let force = force_at(&knots, test.dynamic_crush_m?)?;
        Some(force * force / (test.mass_kg * (test.impact_speed_m_per_s * restitution).powi(2)))
    };
    let shown = |test: &&TestData<'_>| test.coefficient_of_restitution.filter(|e| *e > 0.0);
    let mut each: Vec<f64> = tests.iter().filter_map(|test| stiffness(test, shown(test)?)).collect();
    if each.is_empty() {
        each = tests.iter().filter_map(|test| stiffness(test, USUAL_RESTITUTION)).collect();
    }
    let mean = (each.iter().map(|k| k.ln()).sum::<f64>() / each.len() as f64).exp();
    let slopes = knots.windows(2).map(|pair| (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0));
    let least = STIFFER * slopes.fold(0.0, f64::max);
    let unloading_stiffness_n_per_m = if mean.is_finite() { mean.max(least) } else { least };
    let mut unloading = *structure;
    unloading.unloading_stiffness_n_per_m = unloading_stiffness_n_per_m;
    Some(unloading).filter(|_| unloading_stiffness_n_per_m > 0.0)
}

/// The force at a deflection, N: straight between knots, the last piece goes on.
fn force_at(knots: &[(f64, f64)], deflection_m: f64) -> Option<f64> {
    let right = knots.partition_point(|(d, _)| *d <= deflection_m).clamp(1, knots.len().checked_sub(1)?);
    let (a, b) = (knots.get(right - 1)?, knots.get(right)?);
    Some(a.1 + (b.1 - a.1) * (deflection_m - a.0) / (b.0 - a.0)).filter(|force| *force > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn test(speed: f64, crush_m: f64, restitution: Option<f64>) -> TestData<'static> {
        TestData {
            mass_kg: 1000.0,
            impact_speed_m_per_s: speed,
            time_of_dynamic_crush_s: Some(0.07),
            dynamic_crush_m: Some(crush_m),
            coefficient_of_restitution: restitution,
            time_zero_s: 0.0,
            time_of_rebound_s: None,
            displacement: None,
            measurement: None,
            sensors: &[],
        }
    }

    #[test]
    fn it_is_the_mean_of_what_the_tests_show_and_never_below_the_curve() {
        // 300 kN from 0.1 m on.
        let curve = CrushedStructure::new(1000.0, &[(0.1, 3e5), (0.6, 3e5)], 1e8, 0.0).unwrap();
        let of = |tests: &[TestData<'_>]| {
            let tests: Vec<&TestData<'_>> = tests.iter().collect();
            with_restitution(&curve, &tests).unwrap().unloading_stiffness_n_per_m
        };
        let [fast, slow] = [test(15.0, 0.5, Some(0.1)), test(10.0, 0.3, Some(0.2))];
        // 9e10/(1000 1.5²) and 9e10/(1000 2²).
        assert!((of(&[fast]) - 4e7).abs() < 1.0 && (of(&[slow]) - 2.25e7).abs() < 1.0);
        assert!((of(&[fast, slow]) - 3e7).abs() < 1.0);
        // A test that shows none has no say; where none shows one, the usual one stands for it.
        assert_eq!(of(&[fast, test(10.0, 0.3, None)]), of(&[fast]));
        assert!((of(&[test(10.0, 0.3, None)]) - 4e7).abs() < 1.0);
        // 1.05 times 3 MN/m.
        assert!((of(&[test(15.0, 0.5, Some(0.9))]) - 3.15e6).abs() < 1.0);
    }
}
