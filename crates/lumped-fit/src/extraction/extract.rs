//! Force-deflection curves read off motions.
//!
//! The extraction for given rate factors: linear in everything that is unknown.
//!
//! For every mass and sample `m a + Σ ±F = 0`, where an element's force is `Σ φ_j(d) F_j (1 + r w)` while it loads and
//! `Σ φ_j(d_turn) F_j - k_u (d_turn - d)` after, while that is positive: hat functions `φ_j` of the knots. Which sample
//! is where follows from the measured deflection and the permanent set, so it is solved a few times. Forces go through
//! the filter of the accelerations: left out, it puts a third of itself into the first knots. The idea is that
//! of SISAME (Mentzer, NHTSA 2006): force-deflection curves and masses in one constrained fit of test data.

use crumple_numerics::linalg::nonnegative_least_squares;
use nalgebra::{DMatrix, DVector};

use crate::extraction::problem::{AskedCurve, Extraction, ExtractionTest, MeasuredElement};

/// What an element does at a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Phase {
    /// On its curve.
    Loading,
    /// On its way out of, or back to, the deflection `turn_m`: force there less `k_u (turn - d)`.
    Elastic {
        /// Largest deflection before.
        turn_m: f64,
    },
    /// Without force.
    Open,
}

/// The phase of every sample.
///
/// `set_below`: permanent set below a turn, for a deflection at a turn; what is below it stands open. `None`: unknown
/// yet, then nothing after a turn counts as open until the deflection has come back by `first_guess_m`.
///
/// The turn lies between two samples, where the rate passes zero: a parabola of the rate by rates and accelerations
/// at both, and the deflection from there.
pub(super) fn phases(
    dt_s: f64,
    deflection_m: &[f64],
    rate_m_per_s: &[f64],
    second_m_per_s2: &[f64],
    set_below: impl Fn(f64) -> f64,
) -> Vec<Phase> {
    let mut phases = Vec::with_capacity(deflection_m.len());
    let mut turn: Option<f64> = None;
    for (k, &d) in deflection_m.iter().enumerate() {
        let left = k > 0 && rate_m_per_s[k] < 0.0 && rate_m_per_s[k - 1] >= 0.0;
        let loading_before = matches!(phases.last(), None | Some(Phase::Loading));
        if left && loading_before && d > 0.0 {
            let at = |j: usize| (deflection_m[j], rate_m_per_s[j], second_m_per_s2[j]);
            turn = Some(turning_point(dt_s, at(k - 1), at(k)));
        }
        phases.push(match turn {
            _ if d <= 0.0 => Phase::Open,
            Some(turn_m) if d < turn_m => {
                if d <= set_below(turn_m) {
                    Phase::Open
                } else {
                    Phase::Elastic { turn_m }
                }
            }
            _ => Phase::Loading,
        });
    }
    phases
}

/// The largest value between two samples of which value, first and second derivative are known: of the polynomial of
/// the fifth degree through both, where its slope is zero.
fn turning_point(h: f64, (x0, v0, a0): (f64, f64, f64), (x1, v1, a1): (f64, f64, f64)) -> f64 {
    let (c3, c4, c5) = {
        // Of x1 - x0 - v0 h - a0 h²/2 and its derivatives at the end.
        let p = x1 - x0 - v0 * h - 0.5 * a0 * h * h;
        let q = (v1 - v0 - a0 * h) * h;
        let r = (a1 - a0) * h * h;
        (10.0 * p - 4.0 * q + 0.5 * r, -15.0 * p + 7.0 * q - r, 6.0 * p - 3.0 * q + 0.5 * r)
    };
    let slope = |s: f64| v0 * h + s * (a0 * h * h + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5)));
    let (mut low, mut high) = (0.0, 1.0);
    // Halved to the last bit of the place.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if slope(middle) > 0.0 { low = middle } else { high = middle }
    }
    let s = 0.5 * (low + high);
    x0 + s * (v0 * h + s * (0.5 * a0 * h * h + s * (c3 + s * (c4 + s * c5))))
}

/// Rounds of solving and finding the sets anew at most.
const ROUNDS: usize = 12;

/// Value at `d` of the hat functions of knots, the first (where the force is zero) left out; the last slope goes on.
pub fn hats(knots_m: &[f64], d: f64) -> Vec<f64> {
    let mut values = vec![0.0; knots_m.len()];
    let right = knots_m.partition_point(|knot| *knot <= d).clamp(1, knots_m.len() - 1);
    let share = (d - knots_m[right - 1]) / (knots_m[right] - knots_m[right - 1]);
    values[right - 1] = 1.0 - share;
    values[right] = share;
    values.remove(0);
    values
}

/// Places of the unknowns in a row: forces at the knots of every curve, its unloading stiffness, free masses.
struct Places {
    curves: Vec<usize>,
    masses: Vec<Vec<Option<usize>>>,
    unknowns: usize,
}

impl Places {
    fn new(tests: &[ExtractionTest], curves: &[AskedCurve]) -> Self {
        let mut unknowns = 0;
        let mut take = |count: usize| {
            unknowns += count;
            unknowns - count
        };
        // Of n knots n - 1 are free; one place more for the unloading.
        let curves = curves.iter().map(|curve| take(curve.knots_m.len())).collect();
        let masses = tests
            .iter()
            .map(|test| {
                let last = test.masses.iter().rposition(|mass| mass.mass_kg.is_none());
                let mass = |(i, mass): (usize, &super::problem::MeasuredMass)| {
                    // With a total the last free mass is the rest of it.
                    let rest = test.total_mass_kg.is_some() && Some(i) == last;
                    (mass.mass_kg.is_none() && !rest).then(|| take(1))
                };
                test.masses.iter().enumerate().map(mass).collect()
            })
            .collect();
        Self { curves, masses, unknowns }
    }
}

/// Forces, unloading stiffnesses and free masses that meet the equations of motion best, none of them negative.
///
/// `slope_change_weight`: `λ`, m²/N², on the sum of the squared changes of slope between pieces of a curve, N/m; zero
/// for none. `None` where a curve has fewer than two knots, a free mass has no scale (neither a given mass nor a total
/// nor a wall force in its
/// test), a sample is compared that is not there, or the motions are not finite.
pub fn extract(tests: &[ExtractionTest], curves: &[AskedCurve], slope_change_weight: f64) -> Option<Extraction> {
    let places = Places::new(tests, curves);
    let cut_short = |test: &ExtractionTest| {
        let through = test.through.iter().flat_map(|through| &through.compared);
        through.copied().any(|k| k >= samples(test))
    };
    if curves.iter().any(|curve| curve.knots_m.len() < 2) || tests.iter().any(|t| without_scale(t) || cut_short(t)) {
        return None;
    }
    let mut solution: Option<(DVector<f64>, Vec<bool>)> = None;
    let mut branches: Vec<Vec<Vec<Phase>>> = Vec::new();
    for _ in 0..ROUNDS {
        let now: Vec<Vec<Vec<Phase>>> =
            tests.iter().map(|test| phases_of(test, curves, &places, solution.as_ref().map(|s| &s.0))).collect();
        if now == branches {
            break;
        }
        branches = now;
        let (rows, right) = equations(tests, curves, &places, &branches, slope_change_weight);
        if rows.iter().chain(right.iter()).any(|value| !value.is_finite()) {
            return None;
        }
        solution = Some(nonnegative_least_squares(&rows, &right));
    }
    let (x, free) = solution?;
    let (rows, right) = equations(tests, curves, &places, &branches, slope_change_weight);
    Some(worded(tests, curves, &places, (&x, &free), (&rows, &right), slope_change_weight > 0.0))
}

/// Whether masses are free and nothing says how large all of them are.
fn without_scale(test: &ExtractionTest) -> bool {
    test.total_mass_kg.is_none() && test.wall.is_none() && test.masses.iter().all(|mass| mass.mass_kg.is_none())
}

/// Deflection, its rate and second derivative of an element at every sample.
fn deflection(test: &ExtractionTest, element: &MeasuredElement) -> [Vec<f64>; 3] {
    let rear = &test.masses[element.rear];
    let less = |rear: &[f64], front: Option<&[f64]>, gap: f64| -> Vec<f64> {
        let front = |k: usize| front.map_or(0.0, |front| front[k]);
        rear.iter().enumerate().map(|(k, rear)| rear - front(k) - gap).collect()
    };
    let front = element.front.map(|i| &test.masses[i]);
    [
        less(&rear.displacement_m, front.map(|m| m.displacement_m.as_slice()), element.gap_m),
        less(&rear.velocity_m_per_s, front.map(|m| m.velocity_m_per_s.as_slice()), 0.0),
        less(&rear.acceleration_m_per_s2, front.map(|m| m.acceleration_m_per_s2.as_slice()), 0.0),
    ]
}

/// Where every element of a test is at every sample, by the curves so far.
fn phases_of(
    test: &ExtractionTest,
    curves: &[AskedCurve],
    places: &Places,
    solution: Option<&DVector<f64>>,
) -> Vec<Vec<Phase>> {
    let of = |element: &MeasuredElement| {
        let (knots, at) = (&curves[element.curve].knots_m, places.curves[element.curve]);
        // Before anything is known: all that comes back within a fiftieth of the turn is elastic.
        let set_below = |turn: f64| {
            let known = solution.filter(|x| x[at + knots.len() - 1] > 0.0);
            known.map_or(0.98 * turn, |x| {
                let force: f64 = hats(knots, turn).iter().enumerate().map(|(j, hat)| hat * x[at + j]).sum();
                turn - force / x[at + knots.len() - 1]
            })
        };
        let [d, w, second] = deflection(test, element);
        phases(test.dt_s, &d, &w, &second, set_below)
    };
    test.elements.iter().map(of).collect()
}

/// Rows and right sides: the equations of motion over their noise, then the changes of slope.
fn equations(
    tests: &[ExtractionTest],
    curves: &[AskedCurve],
    places: &Places,
    branches: &[Vec<Vec<Phase>>],
    slope_change_weight: f64,
) -> (DMatrix<f64>, DVector<f64>) {
    let smoothing: usize = if slope_change_weight > 0.0 { curves.iter().map(|c| c.knots_m.len() - 2).sum() } else { 0 };
    let blocks = |test: &ExtractionTest| test.masses.len() + usize::from(test.wall.is_some());
    let compared = |test: &ExtractionTest| match &test.through {
        Some(through) => through.compared.clone(),
        None => (0..samples(test)).collect(),
    };
    let rows: usize = tests.iter().map(|test| blocks(test) * compared(test).len()).sum::<usize>() + smoothing;
    let mut a = DMatrix::zeros(rows, places.unknowns);
    let mut b = DVector::zeros(rows);
    let mut first = 0;
    for (t, test) in tests.iter().enumerate() {
        let (n, compared) = (samples(test), compared(test));
        let row = |block: usize, k: usize| block * n + k;
        let mut all = DMatrix::zeros(blocks(test) * n, places.unknowns);
        let mut right = DVector::zeros(blocks(test) * n);
        element_terms(test, curves, places, &branches[t], &mut all);
        if let Some(filter) = test.through.as_ref().and_then(|through| through.filter) {
            for column in 0..places.unknowns {
                for block in 0..blocks(test) {
                    let mut wave = all.view_mut((row(block, 0), column), (n, 1));
                    if wave.iter().any(|value| *value != 0.0) {
                        let filtered = filter.filtered(wave.clone_owned().as_slice());
                        wave.copy_from_slice(&filtered);
                    }
                }
            }
        }
        mass_terms(test, &places.masses[t], &row, (&mut all, &mut right));
        if let Some(wall) = &test.wall {
            let force = wall.force_n.iter().take(n).enumerate();
            force.for_each(|(k, force)| right[row(test.masses.len(), k)] = force / wall.noise_n);
        }
        for block in 0..blocks(test) {
            for k in &compared {
                a.row_mut(first).copy_from(&all.row(row(block, *k)));
                b[first] = right[row(block, *k)];
                first += 1;
            }
        }
    }
    if smoothing > 0 {
        changes_of_slope(curves, places, slope_change_weight.sqrt(), first, &mut a);
    }
    (a, b)
}

/// Samples of the motions.
fn samples(test: &ExtractionTest) -> usize {
    test.masses.first().map_or(0, |mass| mass.acceleration_m_per_s2.len())
}

/// The forces of the elements on masses and wall, by the unknowns: one block of samples a mass, the wall's after them.
fn element_terms(
    test: &ExtractionTest,
    curves: &[AskedCurve],
    places: &Places,
    branches: &[Vec<Phase>],
    a: &mut DMatrix<f64>,
) {
    let n = samples(test);
    for (element, phases) in test.elements.iter().zip(branches) {
        let curve = &curves[element.curve];
        let at = places.curves[element.curve];
        let [d, w, _] = deflection(test, element);
        for k in 0..n {
            let mut add = |column: usize, value: f64| {
                a[(element.rear * n + k, column)] += value / test.masses[element.rear].noise_n;
                match (element.front, &test.wall) {
                    (Some(front), _) => a[(front * n + k, column)] -= value / test.masses[front].noise_n,
                    (None, Some(wall)) => a[(test.masses.len() * n + k, column)] += value / wall.noise_n,
                    (None, None) => {}
                }
            };
            let (place, factor) = match phases[k] {
                Phase::Loading => (d[k], 1.0 + curve.rate_s_per_m * w[k].max(0.0)),
                Phase::Elastic { turn_m } => (turn_m, 1.0),
                Phase::Open => continue,
            };
            for (j, hat) in hats(&curve.knots_m, place).iter().enumerate().filter(|(_, hat)| **hat != 0.0) {
                add(at + j, hat * factor);
            }
            if let Phase::Elastic { turn_m } = phases[k] {
                add(at + curve.knots_m.len() - 1, d[k] - turn_m);
            }
        }
    }
}

/// `m a` of every mass: to the right where it is given, a column where it is free, the total less the others for the
/// last of them.
fn mass_terms(
    test: &ExtractionTest,
    columns: &[Option<usize>],
    row: &dyn Fn(usize, usize) -> usize,
    (a, b): (&mut DMatrix<f64>, &mut DVector<f64>),
) {
    let given: f64 = test.masses.iter().filter_map(|mass| mass.mass_kg).sum();
    for (i, mass) in test.masses.iter().enumerate() {
        for (k, acceleration) in mass.acceleration_m_per_s2.iter().enumerate() {
            let acceleration = acceleration / mass.noise_n;
            match (mass.mass_kg, columns[i], test.total_mass_kg) {
                (Some(kg), _, _) => b[row(i, k)] -= kg * acceleration,
                (None, Some(column), _) => a[(row(i, k), column)] += acceleration,
                (None, None, Some(total)) => {
                    b[row(i, k)] -= (total - given) * acceleration;
                    for column in columns.iter().flatten() {
                        a[(row(i, k), *column)] -= acceleration;
                    }
                }
                (None, None, None) => {}
            }
        }
    }
}

/// Weighted changes of slope at the inner knots of every curve, from row `first` on.
fn changes_of_slope(curves: &[AskedCurve], places: &Places, weight: f64, first: usize, a: &mut DMatrix<f64>) {
    let mut row = first;
    for (curve, at) in curves.iter().zip(&places.curves) {
        for (j, knots) in curve.knots_m.windows(3).enumerate() {
            let (before, after) = (weight / (knots[1] - knots[0]), weight / (knots[2] - knots[1]));
            // Knot j + 1 stands in column j; the first has none.
            if j > 0 {
                a[(row, at + j - 1)] += before;
            }
            a[(row, at + j)] -= before + after;
            a[(row, at + j + 1)] += after;
            row += 1;
        }
    }
}

/// The solution by names.
fn worded(
    tests: &[ExtractionTest],
    curves: &[AskedCurve],
    places: &Places,
    (x, free): (&DVector<f64>, &[bool]),
    (rows, right): (&DMatrix<f64>, &DVector<f64>),
    smoothed: bool,
) -> Extraction {
    let knots = |c: usize| places.curves[c]..places.curves[c] + curves[c].knots_m.len() - 1;
    let unloading = |c: usize| places.curves[c] + curves[c].knots_m.len() - 1;
    let masses = tests.iter().zip(&places.masses).map(|(test, columns)| {
        let mut masses: Vec<Option<f64>> =
            test.masses.iter().zip(columns).map(|(mass, column)| mass.mass_kg.or(column.map(|c| x[c]))).collect();
        let sum: f64 = masses.iter().flatten().sum();
        if let Some(rest) = masses.iter_mut().find(|mass| mass.is_none()) {
            *rest = test.total_mass_kg.map(|total| total - sum);
        }
        masses.into_iter().flatten().collect()
    });
    let effective_unknowns = if smoothed {
        effective(rows, curves.iter().map(|c| c.knots_m.len() - 2).sum(), free)
    } else {
        free.iter().filter(|free| **free).count() as f64
    };
    Extraction {
        forces_n: (0..curves.len()).map(|c| std::iter::once(0.0).chain(knots(c).map(|i| x[i])).collect()).collect(),
        unloading_n_per_m: (0..curves.len()).map(|c| Some(x[unloading(c)]).filter(|k| *k > 0.0)).collect(),
        masses_kg: masses.collect(),
        objective: (rows * x - right).norm_squared(),
        knots_at_zero: (0..curves.len())
            .map(|c| {
                let held = knots(c).enumerate().filter(|(_, i)| !free[*i]).map(|(j, _)| j + 1);
                std::iter::once(0).chain(held).collect()
            })
            .collect(),
        effective_unknowns,
    }
}

/// `tr(H (H'H + λD'D)^-1 H')` over the free unknowns; the last `smoothing` rows are `√λ D`.
fn effective(rows: &DMatrix<f64>, smoothing: usize, free: &[bool]) -> f64 {
    let set: Vec<usize> = (0..free.len()).filter(|i| free[*i]).collect();
    let all = rows.select_columns(&set);
    let q = all.qr().q();
    // Of an orthonormal basis of all rows, the part that lies in the rows of the measurement.
    q.rows(0, q.nrows() - smoothing).norm_squared()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::extraction::problem::MeasuredMass;

    #[test]
    fn a_swing_turns_where_its_cosine_does() {
        let (omega, dt) = (20.0_f64, 5e-4);
        let t = |k: usize| k as f64 * dt;
        let d: Vec<f64> = (0..300).map(|k| 0.6 * (omega * t(k)).sin()).collect();
        let w: Vec<f64> = (0..300).map(|k| 0.6 * omega * (omega * t(k)).cos()).collect();
        let a: Vec<f64> = d.iter().map(|d| -omega * omega * d).collect();
        let phases = phases(dt, &d, &w, &a, |turn| turn - 0.02);
        let turn = phases.iter().find_map(|p| match p {
            Phase::Elastic { turn_m } => Some(*turn_m),
            _ => None,
        });
        // The sixth derivative times h⁶/720/64: 1e-17.
        assert!((turn.unwrap() - 0.6).abs() < 1e-14);
        assert_eq!(phases[10], Phase::Loading);
        // Open from 0.58 m on, until the end: it does not come back.
        assert_eq!(phases[190], Phase::Open);
        assert_eq!(*phases.last().unwrap(), Phase::Open);
    }

    const DT_S: f64 = 1e-3;

    /// A mass that runs on at one speed, so that its deflection is known, and the acceleration that a force gives it.
    fn mass(kg: Option<f64>, d: &[f64], acceleration: impl Fn(usize) -> f64) -> MeasuredMass {
        MeasuredMass {
            mass_kg: kg,
            displacement_m: d.to_vec(),
            velocity_m_per_s: vec![(d[1] - d[0]) / DT_S; d.len()],
            acceleration_m_per_s2: (0..d.len()).map(acceleration).collect(),
            noise_n: 1.0,
        }
    }

    fn test(masses: Vec<MeasuredMass>, elements: Vec<MeasuredElement>, total_mass_kg: Option<f64>) -> ExtractionTest {
        ExtractionTest { dt_s: DT_S, masses, elements, total_mass_kg, wall: None, through: None }
    }

    const FRONT: MeasuredElement = MeasuredElement { front: None, rear: 0, curve: 0, gap_m: 0.0 };
    const KNOTS: [f64; 4] = [0.0, 0.1, 0.25, 0.5];

    /// Straight between knots, by hand: 0, 100, 60, 160 kN.
    fn force(d: f64) -> f64 {
        match d {
            d if d < 0.1 => 1e6 * d,
            d if d < 0.25 => 1e5 - 4e4 / 0.15 * (d - 0.1),
            d => 6e4 + 4e5 * (d - 0.25),
        }
    }

    fn near(found: &[f64], wanted: &[f64]) -> bool {
        // Rounding of inner products of some hundred terms.
        found.len() == wanted.len() && found.iter().zip(wanted).all(|(a, b)| (a - b).abs() <= 1e-10 * b.abs() + 1e-6)
    }

    #[test]
    fn a_curve_comes_back_with_the_rate_factor_that_it_was_made_with() {
        let d: Vec<f64> = (1..120).map(|k| 0.005 * f64::from(k)).collect();
        let (rate, w) = (0.02, 5.0);
        let car = mass(Some(1200.0), &d, |k| -force(d[k]) * (1.0 + rate * w) / 1200.0);
        let asked = AskedCurve { knots_m: KNOTS.to_vec(), rate_s_per_m: rate };
        let found = extract(&[test(vec![car], vec![FRONT], None)], &[asked], 0.0).unwrap();
        assert!(near(&found.forces_n[0], &[0.0, 1e5, 6e4, 1.6e5]), "{found:?}");
        assert_eq!((found.unloading_n_per_m[0], &found.knots_at_zero[0]), (None, &vec![0]));
        assert!((found.effective_unknowns - 3.0).abs() < 1e-12);
    }

    #[test]
    fn a_force_that_would_pull_is_held_at_zero_and_smoothing_takes_unknowns_away() {
        let d: Vec<f64> = (1..100).map(|k| 0.005 * f64::from(k)).collect();
        let pulling = |d: f64| if d < 0.2 { -2e4 } else { 3e5 * (d - 0.2) };
        let car = || mass(Some(1000.0), &d, |k| -pulling(d[k]) / 1000.0);
        let asked = [AskedCurve { knots_m: KNOTS.to_vec(), rate_s_per_m: 0.0 }];
        let of = |weight: f64| extract(&[test(vec![car()], vec![FRONT], None)], &asked, weight).unwrap();
        let found = of(0.0);
        assert_eq!(found.knots_at_zero[0][..2], [0, 1]);
        assert!(found.forces_n[0].iter().all(|force| *force >= 0.0));
        let smooth = of(1e-2);
        assert!(smooth.effective_unknowns < found.effective_unknowns && smooth.objective > found.objective);
    }

    #[test]
    fn the_division_of_a_total_follows_from_one_curve_of_the_front() {
        // The front mass is held by the wall through the curve and pushed by the rear mass, whose way swings: if it
        // followed that of the front, another curve would do for another division.
        let d: Vec<f64> = (1..100).map(|k| 0.004 * f64::from(k)).collect();
        let behind: Vec<f64> = d.iter().enumerate().map(|(k, d)| 1.25 * d + 2e-3 * (0.3 * k as f64).sin()).collect();
        let rear = |k: usize| 4e5 * (behind[k] - d[k]).max(0.0);
        let first = mass(None, &d, |k| (rear(k) - force(d[k])) / 300.0);
        let second = mass(None, &behind, |k| -rear(k) / 1100.0);
        let elements = vec![FRONT, MeasuredElement { front: Some(0), rear: 1, curve: 1, gap_m: 0.0 }];
        let curves = [
            AskedCurve { knots_m: KNOTS.to_vec(), rate_s_per_m: 0.0 },
            AskedCurve { knots_m: vec![0.0, 0.1], rate_s_per_m: 0.0 },
        ];
        let both = |total| extract(&[test(vec![first.clone(), second.clone()], elements.clone(), total)], &curves, 0.0);
        let found = both(Some(1400.0)).unwrap();
        assert!(near(&found.masses_kg[0], &[300.0, 1100.0]), "{found:?}");
        assert!(near(&found.forces_n[1], &[0.0, 4e4]), "{found:?}");
        // Motions alone know ratios only.
        assert_eq!(both(None), None);
    }
}
