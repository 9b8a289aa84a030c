//! Polynomials of the double model with equal solutions, and those next to them: none is lost to a rounding.
//!
//! With `a = c1/m1, b = c2/mr`, `alpha = k1/m1, beta = k2/mr`, `mr = m1 m2/(m1 + m2)` and `kappa = 1 + m2/m1` the cubic
//! of the coefficient matching has the root `zeta = a b/kappa`. Its slope there is zero, the root double, where
//! `alpha = x (a - kappa x)` and `beta = x (b - kappa x)` for some `x`; its curvature is zero too, the root triple,
//! where `x` is `a/(2 kappa)` or `b/(2 kappa)`.

use crumple_lumped::{CoefficientMatch, CoefficientMatching, DoubleSpringMassDamper, Reading};
use proptest::prelude::*;

/// A double root is known to the square root of a rounding, 2e-8; where the third root is near, to its cube root, 8e-6;
/// times the gain of the coefficients.
const NEAR_TRIPLE: f64 = 1e-4;
/// Where four or six solutions meet, their differences are the square roots of such numbers: the fourth or sixth root
/// of a rounding.
const NEAR_OWN_DUAL: f64 = 1e-3;

/// What `x` is a share of: of a double root half the largest with positive springs, `min(a, b)/kappa`, gives a triple.
#[derive(Debug, Clone, Copy)]
struct Coincidence {
    m1: f64,
    m2: f64,
    a: f64,
    b: f64,
    share: f64,
}

impl Coincidence {
    /// The model, with a stiffness larger by a factor: 1 at the coincidence.
    fn model(&self, factor: f64) -> DoubleSpringMassDamper {
        let Self { m1, m2, a, b, share } = *self;
        let kappa = 1.0 + m2 / m1;
        let x = share * a.min(b) / kappa;
        let per_mass = |rate: f64| x * (rate - kappa * x);
        let reduced = m1 * m2 / (m1 + m2);
        DoubleSpringMassDamper {
            m1_kg: m1,
            m2_kg: m2,
            k1_n_per_m: m1 * factor * per_mass(a),
            k2_n_per_m: reduced * per_mass(b),
            c1_n_s_per_m: m1 * a,
            c2_n_s_per_m: reduced * b,
        }
    }
}

/// Masses of 100 to 1000 kg, dampers that halve a speed in 2 to 700 ms, no two of them within a tenth.
fn coincidence(logs: [f64; 4], share: f64) -> Coincidence {
    let log = |x: f64, low: f64, high: f64| low * (high / low).powf(x);
    let [m1, m2] = [logs[0], logs[1]].map(|x| log(x, 100.0, 1e3));
    let a = log(logs[2], 1.0, 300.0);
    let ratio = log(logs[3], 1.1, 30.0);
    Coincidence { m1, m2, a, b: if logs[0] < logs[1] { a * ratio } else { a / ratio }, share }
}

fn solve(model: &DoubleSpringMassDamper) -> CoefficientMatch {
    let [_, t, u, v, w] = model.characteristic_polynomial();
    CoefficientMatching::new([t, u, v, w], model.m1_kg, model.m2_kg, Reading::Binary).unwrap().solve()
}

/// How often real solutions count that are a model within a tolerance, relative to the larger parameter of each kind.
fn times_within(tolerance: f64, found: &CoefficientMatch, model: &DoubleSpringMassDamper) -> usize {
    let mu = (model.m1_kg + model.m2_kg) / model.m2_kg;
    let stiffest = model.k1_n_per_m.max(mu * model.k2_n_per_m);
    let strongest = model.c1_n_s_per_m.max(mu * model.c2_n_s_per_m);
    let near = |s: &&crumple_lumped::MatchedSolution| {
        let distances = [
            (s.k1_n_per_m.re - model.k1_n_per_m) / stiffest,
            mu * (s.k2_n_per_m.re - model.k2_n_per_m) / stiffest,
            (s.c1_n_s_per_m.re - model.c1_n_s_per_m) / strongest,
            mu * (s.c2_n_s_per_m.re - model.c2_n_s_per_m) / strongest,
        ];
        s.real && distances.iter().all(|d| d.abs() <= tolerance)
    };
    found.solutions.iter().filter(near).map(|s| s.multiplicity).sum()
}

fn real(found: &CoefficientMatch) -> usize {
    found.solutions.iter().filter(|s| s.real).map(|s| s.multiplicity).sum()
}

#[test]
fn six_physical_solutions_of_a_printed_polynomial_one_pair_twice() {
    for reading in [Reading::Binary, Reading::Decimal] {
        let polynomial = [93.6, 1001.16, 3516.696, 3932.6634];
        let found = CoefficientMatching::new(polynomial, 500.0, 500.0, reading).unwrap().solve();
        let physical: Vec<usize> = found.solutions.iter().filter(|s| s.physical).map(|s| s.multiplicity).collect();
        assert_eq!((found.solutions.len(), physical.len(), physical.iter().sum::<usize>()), (4, 4, 6), "{found:?}");
        // The double root in exact fractions: 777.6, the other 447.12.
        let double = found.roots.iter().find(|root| root.multiplicity == 2).unwrap();
        assert!((double.zeta.re / 777.6 - 1.0).abs() < 1e-14 && double.zeta.im == 0.0, "{double:?}");
        assert!(found.solutions.iter().all(|s| s.residual < 1e-15), "{found:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn a_double_root_gives_its_pair_of_solutions_twice(
        logs in prop::array::uniform4(0.0..1.0f64), share in 0.02..0.98f64,
    ) {
        let model = coincidence(logs, share).model(1.0);
        let found = solve(&model);
        for solution in [model, model.dual()] {
            prop_assert!(times_within(NEAR_TRIPLE, &found, &solution) >= 2, "{:?}", found);
        }
        prop_assert!(matches!(real(&found), 4 | 6), "{:?}", found);
    }

    #[test]
    fn a_triple_root_gives_its_pair_of_solutions_three_times(logs in prop::array::uniform4(0.0..1.0f64)) {
        let model = coincidence(logs, 0.5).model(1.0);
        let found = solve(&model);
        for solution in [model, model.dual()] {
            prop_assert_eq!(times_within(NEAR_TRIPLE, &found, &solution), 3, "{:?}", found);
        }
    }

    #[test]
    fn next_to_a_multiple_root_the_model_of_the_polynomial_is_among_its_solutions(
        logs in prop::array::uniform4(0.0..1.0f64), share in 0.02..0.98f64, triple in prop::bool::ANY,
        distance in -16.0..-3.0f64, softer in prop::bool::ANY,
    ) {
        let away = 10f64.powf(distance);
        let place = coincidence(logs, if triple { 0.5 } else { share });
        let model = place.model(if softer { 1.0 - away } else { 1.0 + away });
        let found = solve(&model);
        for solution in [model, model.dual()] {
            prop_assert!(times_within(NEAR_TRIPLE, &found, &solution) >= 1, "{:?}", found);
        }
        prop_assert_eq!(found.solutions.iter().map(|s| s.multiplicity).sum::<usize>(), 6);
        // Rounding times the gain of the coefficients: with dampers 30 apart, u is a hundred times k1/m1 + k2/mr.
        prop_assert!(found.solutions.iter().all(|s| s.residual < 1e-12), "{:?}", found);
    }

    #[test]
    fn two_solutions_are_real_wherever_a_model_is_almost_its_own_dual(
        logs in prop::array::uniform4(0.0..1.0f64), share in 0.02..0.98f64, triple in prop::bool::ANY,
        distance in -16.0..-2.0f64,
    ) {
        let place = coincidence(logs, if triple { 0.5 } else { share });
        let model = Coincidence { b: place.a * (1.0 + 10f64.powf(distance)), ..place }.model(1.0);
        let found = solve(&model);
        prop_assert!(real(&found) >= 2, "{:?}", found);
        prop_assert!(times_within(NEAR_OWN_DUAL, &found, &model) >= 1, "{:?}", found);
    }
}
