//! Every parameter set with a given characteristic polynomial.

use crumple_lumped::{
    CoefficientMatch, CoefficientMatching, Complex, DoubleSpringMassDamper, LumpedError, Model, Reading, RealisedModel,
    matching_sensitivity,
};
use nalgebra::{Matrix4, RowVector4, Vector4};
use proptest::prelude::*;

/// The Honda Civic polynomial of the transfer-function paper, with the 35.7 of its equation 5.
const CIVIC: [f64; 4] = [35.7, 6024.0, 185_000.0, 414_600.0];

fn solve(polynomial: [f64; 4], m1: f64, m2: f64) -> CoefficientMatch {
    CoefficientMatching::new(polynomial, m1, m2, Reading::Decimal).unwrap().solve()
}

fn close(found: f64, wanted: f64) {
    // The wanted values are given with six decimals.
    assert!((found - wanted).abs() <= 5.1e-7 * (1.0 + wanted.abs() * 1e-8), "{found} {wanted}");
}

#[test]
fn both_mass_splits_of_the_civic_have_two_real_solutions_and_no_positive_one() {
    let chassis_fifth = solve(CIVIC, 284.4, 1137.6);
    let real: Vec<_> = chassis_fifth.solutions.iter().filter(|s| s.real).collect();
    assert_eq!((real.len(), chassis_fifth.solutions.len()), (2, 6));
    assert!(chassis_fifth.solutions.iter().all(|s| !s.physical));
    close(chassis_fifth.roots[0].zeta.re, -2067.424643);
    close(chassis_fifth.roots[1].zeta.re, 7057.712322);
    close(chassis_fifth.roots[1].zeta.im.abs(), 3737.960613);
    let stiff_rear = real[0];
    for (found, wanted) in [
        (stiff_rear.c1_n_s_per_m, 34434.205385),
        (stiff_rear.k1_n_per_m, 75328.293525),
        (stiff_rear.c2_n_s_per_m, -19424.900308),
        (stiff_rear.k2_n_per_m, 1780698.300028),
    ] {
        close(found.re, wanted);
    }
    let swapped = solve(CIVIC, 1137.6, 284.4);
    let real: Vec<_> = swapped.solutions.iter().filter(|s| s.real).collect();
    assert_eq!(real.len(), 2);
    close(real[0].k2_n_per_m.re, 1370163.708628);
    close(real[1].c1_n_s_per_m.re, -3115.807223);
    // The bound that makes any search for a positive set with these masses vain.
    let bound = swapped.largest_mass_ratio.unwrap();
    assert!((bound - 0.14703).abs() < 5e-6, "{bound}");
    assert!(284.4 / 1137.6 > bound);
    // Below the bound both real solutions are positive.
    let feasible = solve(CIVIC, 1300.0, 122.0);
    assert_eq!(feasible.solutions.iter().filter(|s| s.physical).count(), 2);
    close(feasible.solutions[0].c1_n_s_per_m.re, 44546.773747);
    close(feasible.solutions[1].k1_n_per_m.re, 7672943.708918);
}

#[test]
fn roots_are_certified() {
    let found = solve(CIVIC, 284.4, 1137.6);
    for root in &found.roots {
        let certificate = root.certificate.unwrap();
        // Double-double arithmetic: far below a rounding of the root itself.
        assert!(certificate.radius < 1e-20 * root.zeta.norm() && certificate.alpha < 0.1577, "{certificate:?}");
    }
}

#[test]
fn six_real_solutions_are_all_found() {
    let found = solve([132.0, 1660.0, 2184.0, 432.0], 500.0, 500.0);
    assert_eq!(found.solutions.iter().filter(|s| s.physical).count(), 6);
    let known = |s: &&crumple_lumped::MatchedSolution| (s.k1_n_per_m.re - 12000.0).abs() < 1e-9;
    let set = found.solutions.iter().find(known).unwrap();
    assert!((set.c2_n_s_per_m.re - 8000.0).abs() < 1e-11);
    assert!((found.solutions[set.dual].k1_n_per_m.re - 18000.0).abs() < 1e-11);
}

#[test]
fn a_double_root_loses_no_solution_and_no_digit() {
    // Four equal poles: p = (s + 2)^4, any mass.
    let found = solve([8.0, 24.0, 32.0, 16.0], 3.0, 1.0);
    assert_eq!(found.solutions.iter().map(|s| s.multiplicity).sum::<usize>(), 6);
    for s in &found.solutions {
        assert!(s.residual < 1e-14, "{s:?}");
    }
    // Masses on the bound: zeta = 0 is a root, one damper vanishes.
    let polynomial = [3.0, 4.0, 3.0, 1.0];
    let bound = CoefficientMatching::new(polynomial, 1.0, 1.0, Reading::Binary).unwrap().largest_mass_ratio().unwrap();
    let found = solve(polynomial, 3.0, 3.0 * bound);
    // At the bound one damper of the real solutions is zero, and they are physical still.
    for s in &found.solutions {
        assert_eq!(s.physical, s.real && s.c1_n_s_per_m.re * s.c2_n_s_per_m.re == 0.0, "{found:?}");
    }
    assert_eq!(found.solutions.iter().map(|s| s.multiplicity).sum::<usize>(), 6);
    // A self-dual model: its two mirror images coincide, and its zeta is a double root.
    let (m1, m2) = (2.0, 2.0);
    let one = DoubleSpringMassDamper {
        m1_kg: m1,
        m2_kg: m2,
        k1_n_per_m: 8.0,
        k2_n_per_m: 4.0,
        c1_n_s_per_m: 2.0,
        c2_n_s_per_m: 1.0,
    };
    assert_eq!(one.dual(), one);
    let [_, t, u, v, w] = one.characteristic_polynomial();
    let found = solve([t, u, v, w], m1, m2);
    let itself = found.solutions.iter().find(|s| s.multiplicity == 4).unwrap();
    assert_eq!((itself.k1_n_per_m.re, itself.c2_n_s_per_m.re, itself.real), (8.0, 1.0, true));
    assert_eq!(found.solutions.iter().map(|s| s.multiplicity).sum::<usize>(), 6);
}

#[test]
fn poles_and_polynomial_give_the_same() {
    let poles =
        [Complex::new(-2.0, 76.0), Complex::new(-2.0, -76.0), Complex::new(-2.5, 0.0), Complex::new(-29.0, 0.0)];
    let by_poles = CoefficientMatching::from_poles(&poles, 1300.0, 122.0, Reading::Binary).unwrap();
    let by_coefficients = CoefficientMatching::new(by_poles.polynomial(), 1300.0, 122.0, Reading::Binary).unwrap();
    assert_eq!(by_poles.solve().solutions[0].k1_n_per_m, by_coefficients.solve().solutions[0].k1_n_per_m);
    let mut odd = poles;
    odd[0].im = 75.0;
    assert!(CoefficientMatching::from_poles(&odd, 1.0, 1.0, Reading::Binary).is_err());
    assert!(CoefficientMatching::new(CIVIC, -1.0, 1.0, Reading::Binary).is_err());
}

#[test]
fn the_sweep_moves_without_jumps() {
    let matching = CoefficientMatching::new(CIVIC, 284.4, 1137.6, Reading::Binary).unwrap();
    let fractions: Vec<f64> = (1..=99).map(|k| f64::from(k) / 100.0).collect();
    let sweep = matching.mass_split_sweep(&fractions).unwrap();
    let bound = matching.largest_mass_ratio().unwrap();
    for pair in sweep.windows(2) {
        let [a, b] = pair else { unreachable!() };
        let (x, y) = (a.solutions[0].c1_n_s_per_m.re, b.solutions[0].c1_n_s_per_m.re);
        // c1 goes with m1, hence with the fraction; no jump beyond a fifth of its range.
        assert!((x - y).abs() < 1e4, "{x} {y} at {}", a.m1_kg);
    }
    for at in &sweep {
        let physical = at.solutions.iter().any(|s| s.physical);
        assert_eq!(physical, at.m2_kg / at.m1_kg < bound, "{} {}", at.m1_kg, at.m2_kg);
    }
}

proptest! {
    #[test]
    fn a_model_is_among_the_solutions_of_its_polynomial(
        logs in prop::array::uniform6(0.0..1.0f64),
    ) {
        let log = |x: f64, low: f64, high: f64| low * (high / low).powf(x);
        let [m1, m2, k1, k2, c1, c2] = logs;
        let model = DoubleSpringMassDamper {
            m1_kg: log(m1, 100.0, 1e3),
            m2_kg: log(m2, 100.0, 1e3),
            k1_n_per_m: log(k1, 1e4, 1e7),
            k2_n_per_m: log(k2, 1e4, 1e7),
            c1_n_s_per_m: log(c1, 1e2, 1e5),
            c2_n_s_per_m: log(c2, 1e2, 1e5),
        };
        let [_, t, u, v, w] = model.characteristic_polynomial();
        let found = CoefficientMatching::new([t, u, v, w], model.m1_kg, model.m2_kg, Reading::Binary).unwrap().solve();
        prop_assert_eq!(found.solutions.iter().map(|s| s.multiplicity).sum::<usize>(), 6);
        let real: usize = found.solutions.iter().filter(|s| s.real).map(|s| s.multiplicity).sum();
        prop_assert!(real == 2 || real == 4 || real == 6, "{}", real);
        let p = [model.k1_n_per_m, model.k2_n_per_m, model.c1_n_s_per_m, model.c2_n_s_per_m];
        let distance = |s: &crumple_lumped::MatchedSolution| {
            let q = [s.k1_n_per_m, s.k2_n_per_m, s.c1_n_s_per_m, s.c2_n_s_per_m];
            p.iter().zip(q).map(|(p, q)| (q - p).norm() / p).fold(0.0, f64::max)
        };
        let nearest = found.solutions.iter().map(distance).fold(f64::MAX, f64::min);
        // A few roundings of the coefficients, amplified as the implicit derivatives say; at a double root, by the
        // square root of a rounding.
        let gain = matching_sensitivity(&model).map_or(f64::MAX, |j| j.amax());
        prop_assert!(nearest < (4e-15 * gain).min(1e-6) + 1e-14, "{:e}, gain {:e}", nearest, gain);
        for s in &found.solutions {
            // Rounded parameters reproduce the coefficients: the acceptance limit is 1e-12.
            prop_assert!(s.residual < 1e-14, "{:e}", s.residual);
            let dual = found.solutions[s.dual];
            let mu = (model.m1_kg + model.m2_kg) / model.m2_kg;
            prop_assert!((dual.k1_n_per_m - s.k2_n_per_m * mu).norm() <= 1e-12 * dual.k1_n_per_m.norm());
            prop_assert!((dual.c2_n_s_per_m * mu - s.c1_n_s_per_m).norm() <= 1e-12 * s.c1_n_s_per_m.norm());
        }
        // A stable chain lies below its own bound, and then every real solution is positive.
        prop_assert!(model.m2_kg / model.m1_kg < found.largest_mass_ratio.unwrap());
        prop_assert!(found.solutions.iter().all(|s| s.physical == s.real));
    }

    #[test]
    fn no_polynomial_panics(
        t in -1e6..1e6f64, u in -1e12..1e12f64, v in -1e18..1e18f64, w in -1e24..1e24f64, ratio in 1e-3..1e3f64,
    ) {
        let found = CoefficientMatching::new([t, u, v, w], 1.0, ratio, Reading::Binary).unwrap().solve();
        prop_assert_eq!(found.solutions.iter().map(|s| s.multiplicity).sum::<usize>(), 6);
        prop_assert!(found.solutions.iter().all(|s| s.residual < 1e-12));
    }
}

#[test]
fn a_model_that_is_its_own_dual_is_listed_once_with_its_multiplicity() {
    // Numbers whose coefficients are exact: (k1, k2, c1, c2) = (2e5, 1e5, 2000, 1000), mu = 2.
    let found = solve([40.0, 4200.0, 40_000.0, 2e6], 100.0, 100.0);
    let own: Vec<_> = found.solutions.iter().enumerate().filter(|(place, s)| s.dual == *place).collect();
    assert_eq!(own.len(), 1);
    let own = own[0].1;
    // All of T1's P² - 4q, S² - 4DW and PS - 2DG vanish there, so the root of the cubic is double too: two pairs in
    // one.
    assert!(own.real && own.physical && own.multiplicity == 4 && found.roots[own.root].multiplicity == 2);
    assert_eq!((own.k1_n_per_m.re, own.k2_n_per_m.re), (2e5, 1e5));
    assert_eq!((own.c1_n_s_per_m.re, own.c2_n_s_per_m.re), (2000.0, 1000.0));
    assert_eq!(found.solutions.iter().map(|s| s.multiplicity).sum::<usize>(), 6);
}

/// Every solution as often as it counts.
fn counted(found: &CoefficientMatch) -> Vec<[Complex; 4]> {
    let parameters = |s: &crumple_lumped::MatchedSolution| [s.k1_n_per_m, s.k2_n_per_m, s.c1_n_s_per_m, s.c2_n_s_per_m];
    found.solutions.iter().flat_map(|s| std::iter::repeat_n(parameters(s), s.multiplicity)).collect()
}

/// Largest distance of a solution of one match from its partner in the other, relative to the largest parameter.
fn moved(from: &CoefficientMatch, to: &CoefficientMatch) -> f64 {
    let (from, mut left) = (counted(from), counted(to));
    let size: Vec<f64> = (0..4).map(|i| from.iter().map(|p| p[i].norm()).fold(0.0, f64::max)).collect();
    let mut farthest = 0.0_f64;
    for p in &from {
        let distance = |q: &[Complex; 4]| (0..4).map(|i| (q[i] - p[i]).norm() / size[i]).fold(0.0, f64::max);
        let nearest = (0..left.len()).min_by(|&a, &b| distance(&left[a]).total_cmp(&distance(&left[b]))).unwrap();
        farthest = farthest.max(distance(&left.remove(nearest)));
    }
    farthest
}

/// `k1 = mu k2`, `c1 = mu c2` with `mu = (m1 + m2)/m2`: a model that is its own dual; mu and what its polynomial gives
/// back.
fn own_dual_solved(m1: f64, m2: f64, k2: f64, c2: f64) -> (f64, CoefficientMatch) {
    let mu = (m1 + m2) / m2;
    let model = DoubleSpringMassDamper {
        m1_kg: m1,
        m2_kg: m2,
        k1_n_per_m: mu * k2,
        k2_n_per_m: k2,
        c1_n_s_per_m: mu * c2,
        c2_n_s_per_m: c2,
    };
    let [_, t, u, v, w] = model.characteristic_polynomial();
    (mu, CoefficientMatching::new([t, u, v, w], m1, m2, Reading::Binary).unwrap().solve())
}

#[test]
fn a_model_that_is_its_own_dual_at_an_almost_triple_root_is_among_its_solutions() {
    let (m1, m2, k2, c2) = (742.3742401942137, 620.9862746850353, 104_672.412_810_573_27, 16_121.864_349_323_625);
    let (_, found) = own_dual_solved(m1, m2, k2, c2);
    assert_eq!(found.solutions.iter().map(|s| s.multiplicity).sum::<usize>(), 6);
    let own: Vec<_> = found.solutions.iter().filter(|s| s.real).collect();
    assert_eq!(own.len(), 1);
    // The root is known to the square root of the rounding of the coefficients, 2e-8, over its distance from the third,
    // 2e-4.
    assert!((own[0].k2_n_per_m.re / k2 - 1.0).abs() < 1e-4 && own[0].physical);
}

proptest! {
    #[test]
    fn next_to_a_model_that_is_its_own_dual_no_solution_is_lost(
        m1 in 100.0..900.0f64, m2 in 100.0..900.0f64, k2 in 1e5..1e6f64, c2 in 1e3..3e4f64,
    ) {
        let (mu, found) = own_dual_solved(m1, m2, k2, c2);
        prop_assert_eq!(found.solutions.iter().map(|s| s.multiplicity).sum::<usize>(), 6);
        prop_assert!(found.solutions.iter().any(|s| s.real));
        // Four solutions meet there: the rounding of t, u, v, w, some 4e-16, moves them by its fourth root, 1.4e-4,
        // times the gain of the coefficients.
        let near = counted(&found).into_iter().filter(|p| {
            (p[1] / k2 - 1.0).norm() < 1e-2 && (p[3] / c2 - 1.0).norm() < 1e-2 && (p[0] / (mu * k2) - 1.0).norm() < 1e-2
        });
        // Others may be near too.
        prop_assert!(near.count() >= 4);
    }

    #[test]
    fn solutions_move_continuously_with_a_coefficient_also_through_double_roots(
        logs in prop::array::uniform6(0.0..1.0f64), stretch in 0.3..3.0f64,
    ) {
        let log = |x: f64, low: f64, high: f64| low * (high / low).powf(x);
        let model = DoubleSpringMassDamper {
            m1_kg: log(logs[0], 200.0, 800.0),
            m2_kg: log(logs[1], 200.0, 800.0),
            k1_n_per_m: log(logs[2], 1e4, 1e6),
            k2_n_per_m: log(logs[3], 1e4, 1e6),
            c1_n_s_per_m: log(logs[4], 1e3, 1e5),
            c2_n_s_per_m: log(logs[5], 1e3, 1e5),
        };
        let [_, t, u, v, w] = model.characteristic_polynomial();
        let at = |factor: f64| {
            let polynomial = [t, u, factor * v, w];
            CoefficientMatching::new(polynomial, model.m1_kg, model.m2_kg, Reading::Binary).unwrap().solve()
        };
        // Bisect to where the number of real solutions changes, if it does: a double root or a border lies there.
        let real = |m: &CoefficientMatch| m.solutions.iter().filter(|s| s.real).map(|s| s.multiplicity).sum::<usize>();
        let (mut low, mut high) = (1.0, stretch);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if real(&at(middle)) == real(&at(1.0)) { low = middle } else { high = middle }
        }
        for (gap, factor) in [(1e-6, low), (1e-10, low), (1e-6, 0.5 * (1.0 + low))] {
            let (before, after) = (at(factor * (1.0 - gap)), at(factor * (1.0 + gap)));
            prop_assert_eq!(counted(&before).len(), 6);
            // At a multiple solution the square root of the step, a cube root at worst; times how far this polynomial
            // is from one of size one. No solution jumps.
            let farthest = moved(&before, &after);
            prop_assert!(farthest < 30.0 * f64::cbrt(gap), "{farthest:e} for a step of {gap:e}");
        }
    }

    #[test]
    fn solved_parameters_reproduce_the_polynomial(
        t in 1.0..200.0f64, u in 100.0..1e5f64, v in 1e3..1e6f64, w in 1e4..1e8f64, fraction in 0.02..0.98f64,
    ) {
        let found = CoefficientMatching::new([t, u, v, w], fraction, 1.0 - fraction, Reading::Binary).unwrap().solve();
        for s in found.solutions.iter().filter(|s| s.real) {
            let model = s.model(fraction, 1.0 - fraction).unwrap();
            let [_, t1, u1, v1, w1] = model.characteristic_polynomial();
            let [m1, m2] = [model.m1_kg, model.m2_kg];
            let [k1, k2, c1, c2] = [model.k1_n_per_m, model.k2_n_per_m, model.c1_n_s_per_m, model.c2_n_s_per_m];
            // With negative parameters the sums cancel: each coefficient relative to the sum of its parts.
            let parts = [
                (m1 * c2).abs() + (m2 * c1).abs() + (m2 * c2).abs(),
                (m1 * k2).abs() + (m2 * k1).abs() + (m2 * k2).abs() + (c1 * c2).abs(),
                (c1 * k2).abs() + (c2 * k1).abs(),
                (k1 * k2).abs(),
            ];
            for ((x, y), size) in [(t1, t), (u1, u), (v1, v), (w1, w)].into_iter().zip(parts) {
                prop_assert!((x - y).abs() <= 1e-12 * size / (m1 * m2), "{x} {y}");
                if s.physical {
                    prop_assert!((x - y).abs() <= 1e-12 * y, "{x} {y}");
                }
            }
            let dual = &found.solutions[s.dual];
            let mu = (m1 + m2) / m2;
            prop_assert!((dual.k1_n_per_m.re - mu * k2).abs() <= 1e-12 * dual.k1_n_per_m.re.abs());
            prop_assert!((dual.c1_n_s_per_m.re - mu * c2).abs() <= 1e-12 * dual.c1_n_s_per_m.re.abs());
        }
    }
}

#[test]
fn springs_positive_and_dampers_not_negative_are_physical_at_the_bound_and_without_damping() {
    // Modes -10 four times: the bound is 4, and so is the ratio of the masses, exactly. One damper is zero there.
    let [t, u, v, w] = [40.0, 600.0, 4000.0, 10_000.0];
    let matching = CoefficientMatching::new([t, u, v, w], 284.4, 4.0 * 284.4, Reading::Binary).unwrap();
    assert_eq!(matching.largest_mass_ratio(), Some(4.0));
    let found = matching.solve();
    let physical: Vec<_> = found.solutions.iter().filter(|s| s.physical).collect();
    assert!(!physical.is_empty(), "{found:?}");
    for s in &found.solutions {
        assert_eq!(
            s.physical,
            s.model(284.4, 4.0 * 284.4).is_some_and(|m| Model::DoubleSpringMassDamper(m).is_physical())
        );
    }
    assert!(physical.iter().all(|s| s.c1_n_s_per_m.re == 0.0 || s.c2_n_s_per_m.re == 0.0), "{physical:?}");

    // No damping: k1 1400, k2 1050 N/m and its dual, whatever the units of the rest.
    let undamped = CoefficientMatching::new([0.0, 5000.0, 0.0, 3e6], 700.0, 700.0, Reading::Binary).unwrap();
    // u²/(4w) - 1.
    assert!((undamped.largest_mass_ratio().unwrap() - 13.0 / 12.0).abs() < 1e-15);
    let found = undamped.solve();
    let physical: Vec<_> = found.solutions.iter().filter(|s| s.physical).collect();
    assert_eq!(physical.len(), 2);
    for s in physical {
        assert_eq!((s.c1_n_s_per_m.re, s.c2_n_s_per_m.re), (0.0, 0.0));
        assert!(s.residual < 1e-15);
    }
    let above = undamped.with(700.0, 700.0 * 1.1).unwrap().solve();
    assert!(above.solutions.iter().all(|s| !s.physical));
    // Two equal frequencies are those of no chain, and neither is a negative square.
    for polynomial in [[0.0, 2.0, 0.0, 1.0], [0.0, 5.0, 0.0, -1.0], [0.0, -5.0, 0.0, 1.0]] {
        let matching = CoefficientMatching::new(polynomial, 1.0, 1.0, Reading::Binary).unwrap();
        assert_eq!(matching.largest_mass_ratio(), None);
    }
}

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
