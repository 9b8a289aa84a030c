//! What a record says of one mass on a spring and a damper with knots, where the noise of the sensor explains the
//! misfit: the 95 % intervals of its nonlinear models.
//!
//! Such a model has up to ten numbers, as many as a record has independent samples. Their likelihood has several
//! maxima, since a knot that crosses the motion elsewhere is another one, and no spring or damper is negative. An
//! ellipse around one minimum knows neither. But the motion itself is known, and on a known motion the force
//! `k(x) x + c(v) v` is linear in the curves: their values at a grid of nodes move the response by sensitivities that
//! are computed once, and every curve with its knots at nodes is a sum of them. So for each choice of knots the
//! likelihood of the values is normal and costs nothing, and the posterior is drawn from: knots in their order and
//! values of springs and dampers from zero on alike beforehand.

use std::collections::BTreeMap;

use crumple_lumped::{Chain, Model, ParameterKind, PiecewiseLinear};
use crumple_numerics::estimation::random::RandomNumbers;
use crumple_numerics::estimation::statistics::{quantile, student_95};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rayon::prelude::*;

use crate::candidate::Minimum;
use crate::coordinates::Coordinates;
use crate::parameters::{FitParameter, Map};
use crate::record::sensor_noise::SensorNoise;
use crate::uncertainty::acceleration_likelihood::{AccelerationLikelihood, Ends};

/// Pieces between the nodes of a curve.
const PIECES: usize = 32;
/// Least distance of a knot from the next and from the ends, in pieces: a tenth of the range. Through CFC 60 a crash of
/// 70 ms shows no more than some ten pieces.
const NEAREST: usize = 3;
/// Largest spring, in `m (v0/C)²`, and damper, in `m v0/C`: five times what stops the mass alone over its crush, and a
/// damper that alone lets it decay five times over in the time `C/v0`.
const LARGEST: f64 = 5.0;
/// Most draws, those inside all bounds that are enough, and below which there is no interval.
const DRAWS: usize = 30_000;
const ENOUGH: usize = 5_000;
const FEWEST: usize = 300;
/// Choices of knots whose likelihood is below the best by more than this, in `ln L`, are not drawn.
const FAR: f64 = 15.0;
/// Density at the end of a range, over the largest, from which an interval is open there: `exp(-3.84/2)`, the fall of
/// the likelihood that ends a 95 % interval.
const OPEN: f64 = 0.146_6;
/// Bins of a range in which densities are compared.
const BINS: usize = 16;
/// Relative difference of widths that draws do not tell.
const OF_WIDTH: f64 = 0.01;
/// Share of the draws in an interval.
const HELD: f64 = 0.95;

/// A curve of a model: names of its values at its knots, and of the knots between zero and the last one.
struct Curve {
    values: Vec<&'static str>,
    knots: Vec<&'static str>,
}

/// Spring and damper of a nonlinear model.
fn curves_of(model: &Model) -> Option<[Curve; 2]> {
    let named = |kind: ParameterKind| -> Vec<&'static str> {
        model.kind().parameters().iter().filter(|p| p.kind == kind && !p.of_the_test).map(|p| p.name).collect()
    };
    matches!(model, Model::Nonlinear1(_) | Model::Nonlinear2(_)).then(|| {
        let spring = Curve { values: named(ParameterKind::Stiffness), knots: named(ParameterKind::Length) };
        [spring, Curve { values: named(ParameterKind::Damping), knots: named(ParameterKind::Rate) }]
    })
}

/// The 95 % intervals of all free numbers of a nonlinear model, where the noise of the sensor explains the misfit and
/// enough draws are inside the bounds; else of its knots alone, open. `None` for other models, and where the noise is
/// not known.
///
/// An interval is the shortest that holds 95 % of the draws and the fitted value; it is open at the end of the range of
/// its number where the density there is not below 0.147 of the largest; zero ends that of a spring or damper. Knots of
/// a curve that has two are left open.
pub(crate) fn curve_intervals(minimum: &Minimum) -> Option<BTreeMap<String, Ends>> {
    let curves = curves_of(&minimum.model)?;
    let count = curves.iter().map(|curve| curve.values.len() + curve.knots.len()).sum::<usize>();
    let [wave] = &minimum.observed.waves[..] else { return None };
    if minimum.free.len() != count {
        return None;
    }
    SensorNoise::of(wave)?;
    let knots = curves.iter().flat_map(|curve| &curve.knots).map(|name| ((*name).to_owned(), (None, None)));
    let mut intervals: BTreeMap<String, Ends> = knots.collect();
    intervals.extend(of_draws(minimum, &curves).unwrap_or_default());
    Some(intervals)
}

/// Those that the draws give. `None` where the noise does not explain the misfit, and with too few draws.
fn of_draws(minimum: &Minimum, curves: &[Curve; 2]) -> Option<BTreeMap<String, Ends>> {
    let coordinates = minimum.coordinates();
    let source = AccelerationLikelihood::near_noise(&coordinates, &minimum.observed, &coordinates.start())?;
    let response = LinearResponse::at(&minimum.model, curves, &source)?;
    let sets = curves.each_ref().map(|curve| knots_at_nodes(curve.knots.len()));
    let likelihoods = Likelihoods::of(&response, &sets);
    let deviations = likelihoods.deviations(&source.noises[0].0)?;
    // The order of the values is a side condition of the first model.
    let draws = likelihoods.draws(deviations, matches!(minimum.model, Model::Nonlinear1(_)))?;
    let fitted = minimum.model.parameters();
    let value = |name: &str| fitted.get(name).copied();
    let mut intervals = BTreeMap::new();
    for (side, curve) in curves.iter().enumerate() {
        let (last, scale) = (response.last[side], response.scale[side]);
        if let [name] = curve.knots[..] {
            let all = draws.iter().filter_map(|draw| draw.knot[side]).collect();
            // A node stands for what is half a piece to both sides of it.
            let halves = |knots: &Vec<usize>| [4 * knots[0] - 1, 4 * knots[0] + 1].map(|at| at * BINS / (4 * PIECES));
            let at = |bin: usize| sets[side].iter().flat_map(halves).filter(|half| *half == bin).count();
            let fitted = value(name)? / last;
            let (low, high) = shortest(all, fitted, (1.0, true), &std::array::from_fn(at));
            intervals.insert(name.to_owned(), (low.map(|low| low * last), high.map(|high| high * last)));
        }
        for (j, name) in curve.values.iter().enumerate() {
            let all = draws.iter().map(|draw| draw.values[side][j]).collect();
            let (low, high) = shortest(all, value(name)? / scale, (LARGEST, false), &[1; BINS]);
            intervals.insert((*name).to_owned(), (low.map(|low| low * scale), high.map(|high| high * scale)));
        }
    }
    Some(intervals)
}

/// Every choice of so many knots at nodes between zero and the last, in rising order and not too near each other.
fn knots_at_nodes(count: usize) -> Vec<Vec<usize>> {
    let more = |chosen: Vec<Vec<usize>>| -> Vec<Vec<usize>> {
        let next = |knots: &Vec<usize>| {
            let (first, knots) = (knots.last().unwrap_or(&0) + NEAREST, knots.clone());
            (first..=PIECES - NEAREST).map(move |node| [knots.as_slice(), &[node]].concat())
        };
        chosen.iter().flat_map(next).collect()
    };
    (0..count).fold(vec![Vec::new()], |chosen, _| more(chosen))
}

/// What a curve through these knots has at the nodes, one column for the value at each knot.
fn at_nodes(knots: &[usize]) -> DMatrix<f64> {
    let all = [&[0], knots, &[PIECES]].concat();
    DMatrix::from_fn(PIECES + 1, all.len(), |node, j| {
        let between = |from: usize, to: usize| (node as f64 - from as f64) / (to as f64 - from as f64);
        match node {
            _ if node == all[j] => 1.0,
            _ if j > 0 && node < all[j] && node > all[j - 1] => between(all[j - 1], all[j]),
            _ if j + 1 < all.len() && node > all[j] && node < all[j + 1] => 1.0 - between(all[j], all[j + 1]),
            _ => 0.0,
        }
    })
}

/// One curve of each kind from the posterior: the knot of one that has a single knot, as a share of the last, and
/// values in their scale.
struct Draw {
    knot: [Option<f64>; 2],
    values: [Vec<f64>; 2],
}

/// The misfit in units of the noise before the event, as independent rows, by the values of both curves at their nodes.
struct LinearResponse {
    /// One column for each node.
    by_nodes: [DMatrix<f64>; 2],
    /// Where all values are zero.
    constant: DVector<f64>,
    last: [f64; 2],
    scale: [f64; 2],
}

/// One curve with its knots at nodes: what its values do to the misfit.
struct OfCurve {
    /// Its values at the nodes, one column for each value of the curve.
    at_nodes: DMatrix<f64>,
    /// Products of its columns of the response with each other and with the constant misfit.
    square: DMatrix<f64>,
    by_constant: DVector<f64>,
    /// Products of the columns at the nodes of the other curve with its own.
    by_other: DMatrix<f64>,
}

impl OfCurve {
    fn new(at_nodes: DMatrix<f64>, response: &LinearResponse, side: usize) -> Self {
        let columns = &response.by_nodes[side] * &at_nodes;
        let (square, by_constant) = (columns.tr_mul(&columns), columns.tr_mul(&response.constant));
        Self { at_nodes, square, by_constant, by_other: response.by_nodes[1 - side].tr_mul(&columns) }
    }
}

/// The likelihood of the values for one choice of knots.
struct Normal {
    place: (usize, usize),
    mean: DVector<f64>,
    root: Cholesky<f64, Dyn>,
    /// Sum of squares that the mean leaves.
    left: f64,
    /// `ln` of the root's determinant.
    determinant: f64,
}

impl Normal {
    /// `ln` of the likelihood over all values, up to a constant, with noise of so many deviations.
    fn weight(&self, deviations: f64) -> f64 {
        -0.5 * self.left / (deviations * deviations) - self.determinant
    }
}

impl LinearResponse {
    /// Linear around a model. `None` without a finite response.
    fn at(model: &Model, curves: &[Curve; 2], source: &AccelerationLikelihood<'_>) -> Option<Self> {
        let values = model.parameters();
        let number = |name: &str| values.get(name).copied();
        let (mass_kg, crush_m, v0) = (number("mass_kg")?, number("crush_m")?, number("v0_m_per_s")?);
        let (last, rate) = ([crush_m, v0], v0 / crush_m);
        let scale = [mass_kg * rate * rate, mass_kg * rate];
        let with_nodes = |side: usize| -> Option<PiecewiseLinear> {
            let Curve { values, knots } = &curves[side];
            let knots = [Some(0.0)].into_iter().chain(knots.iter().map(|name| number(name))).chain([Some(last[side])]);
            let points: Option<Vec<_>> = knots.zip(values).map(|(knot, name)| Some((knot?, number(name)?))).collect();
            let law = PiecewiseLinear::new(&points?).ok()?;
            let node = |i: usize| i as f64 / PIECES as f64 * last[side];
            PiecewiseLinear::new(&(0..=PIECES).map(|i| (node(i), law.at(node(i)))).collect::<Vec<_>>()).ok()
        };
        let chain = Chain::new(&[mass_kg], &[with_nodes(0)?], &[with_nodes(1)?]).ok()?;
        let nodes = PIECES + 1;
        let free = |k: usize| {
            let kind = if k < nodes { ParameterKind::Stiffness } else { ParameterKind::Damping };
            let (map, bounds) = (Map::Share(scale[k / nodes]), (0.0, LARGEST));
            FitParameter::of_search((1 + k, "".into(), kind), map, bounds, bounds)
        };
        let coordinates = Coordinates::new(Model::Chain(chain), (0..2 * nodes).map(free).collect());
        let theta = coordinates.start();
        let (misfit, by_nodes) = source.linear_of(&coordinates, &theta)?;
        let constant = DVector::from_vec(misfit) - &by_nodes * DVector::from_vec(theta);
        let mut all = by_nodes.insert_column(2 * nodes, 0.0);
        all.set_column(2 * nodes, &constant);
        let white = source.noises[0].0.whitened(&source.dense.waves[0], &all)?;
        let by_nodes = [0, 1].map(|side| white.columns(side * nodes, nodes).into_owned());
        Some(Self { by_nodes, constant: white.column(2 * nodes).into_owned(), last, scale })
    }
}

/// The likelihoods of all choices of knots.
struct Likelihoods<'a> {
    response: &'a LinearResponse,
    sets: &'a [Vec<Vec<usize>>; 2],
    curves: [Vec<OfCurve>; 2],
    normals: Vec<Normal>,
}

impl<'a> Likelihoods<'a> {
    fn of(response: &'a LinearResponse, sets: &'a [Vec<Vec<usize>>; 2]) -> Self {
        let constant = response.constant.norm_squared();
        let curves: [Vec<OfCurve>; 2] = std::array::from_fn(|side| {
            let of_curve = |knots: &Vec<usize>| OfCurve::new(at_nodes(knots), response, side);
            sets[side].iter().map(of_curve).collect()
        });
        let normal = |(a, b): (usize, usize)| -> Option<Normal> {
            let (spring, damper) = (&curves[0][a], &curves[1][b]);
            let (springs, dampers) = (spring.by_constant.len(), damper.by_constant.len());
            let mut square = DMatrix::zeros(springs + dampers, springs + dampers);
            square.view_mut((0, 0), (springs, springs)).copy_from(&spring.square);
            square.view_mut((springs, springs), (dampers, dampers)).copy_from(&damper.square);
            damper.at_nodes.tr_mul_to(&spring.by_other, &mut square.view_mut((springs, 0), (dampers, springs)));
            let root = Cholesky::new(square)?;
            let gradient = spring.by_constant.iter().chain(damper.by_constant.iter()).map(|x| -x);
            let gradient = DVector::from_iterator(springs + dampers, gradient);
            let mean = root.solve(&gradient);
            let left = constant - gradient.dot(&mean);
            let determinant: f64 = root.l_dirty().diagonal().iter().map(|x| x.ln()).sum();
            let normal = Normal { place: (a, b), mean, root, left, determinant };
            Some(normal).filter(|normal| normal.weight(1.0).is_finite())
        };
        let choices = (0..sets[0].len()).into_par_iter().flat_map_iter(|a| (0..sets[1].len()).map(move |b| (a, b)));
        let normals = choices.filter_map(normal).collect();
        Self { response, sets, curves, normals }
    }

    /// Deviations of the noise before the event that count as one: its level is pooled with what the best choice leaves
    /// of the misfit, whose values and knots are fitted, and Student's distribution has more than the normal. `None`
    /// where the noise does not explain what is left.
    fn deviations(&self, noise: &SensorNoise) -> Option<f64> {
        let left = self.normals.iter().map(|normal| normal.left).reduce(f64::min)?;
        let fitted = self.normals[0].mean.len() + self.sets[0][0].len() + self.sets[1][0].len();
        let pooled = noise.pooled(left, self.response.constant.len().saturating_sub(fitted))?;
        Some((pooled.variance / noise.variance).sqrt() * student_95(pooled.freedom) / student_95(f64::INFINITY))
    }

    /// Draws inside the bounds, with noise of so many deviations.
    fn draws(&self, deviations: f64, ordered: bool) -> Option<Vec<Draw>> {
        let best = self.normals.iter().map(|normal| normal.weight(deviations)).reduce(f64::max)?;
        let near = |normal: &&Normal| normal.weight(deviations) > best - FAR;
        let normals: Vec<&Normal> = self.normals.iter().filter(near).collect();
        let mut sum = 0.0;
        let cumulated: Vec<f64> = normals
            .iter()
            .map(|normal| {
                sum += (normal.weight(deviations) - best).exp();
                sum
            })
            .collect();
        let mut random = RandomNumbers::seeded(1);
        let springs = self.curves[0][0].by_constant.len();
        let mut draws = Vec::new();
        for _ in 0..DRAWS {
            if draws.len() == ENOUGH {
                break;
            }
            let at = random.uniform() * sum;
            let Some(normal) = normals.get(cumulated.partition_point(|c| *c < at)) else { continue };
            let mut values = DVector::from_fn(normal.mean.len(), |_, _| deviations * random.normal());
            normal.root.l_dirty().tr_solve_lower_triangular_mut(&mut values);
            values += &normal.mean;
            let (k, c) = values.as_slice().split_at(springs);
            let in_order =
                !ordered || k.windows(2).all(|pair| pair[0] <= pair[1]) && c.windows(2).all(|pair| pair[0] >= pair[1]);
            if !in_order || values.iter().any(|value| !(0.0..=LARGEST).contains(value)) {
                continue;
            }
            // A node stands for what is nearer to it than to others.
            let mut share = |knots: &[usize]| match knots {
                [node] => Some((*node as f64 + random.uniform() - 0.5) / PIECES as f64),
                _ => None,
            };
            let knot = [share(&self.sets[0][normal.place.0]), share(&self.sets[1][normal.place.1])];
            draws.push(Draw { knot, values: [k.to_vec(), c.to_vec()] });
        }
        (draws.len() >= FEWEST).then_some(draws)
    }
}

/// The shortest interval with 95 % of the draws of a number between zero and `range`, and its `fitted` value; open
/// above where the likelihood at the end of the range is not low, and below too where it `may_be_open` there.
/// `beforehand`: how the number was spread over the range, in bins: draws over it are the likelihood.
fn shortest(mut draws: Vec<f64>, fitted: f64, (range, may_be_open): (f64, bool), beforehand: &[usize; BINS]) -> Ends {
    draws.sort_by(f64::total_cmp);
    let mut likelihood = [0.0; BINS];
    for x in &draws {
        let bin = ((x / range * BINS as f64).max(0.0) as usize).min(BINS - 1);
        likelihood[bin] += 1.0 / beforehand[bin].max(1) as f64;
    }
    let most = likelihood.iter().copied().fold(0.0, f64::max);
    // The outermost bins that the number can be in.
    let first = beforehand.iter().position(|count| *count > 0).unwrap_or(0);
    let last = beforehand.iter().rposition(|count| *count > 0).unwrap_or(BINS - 1);
    let is_open = |bin: usize| likelihood[bin] > OPEN * most;
    let of = |share: f64| quantile(&draws, share);
    match (may_be_open && is_open(first), is_open(last)) {
        (true, true) => (None, None),
        (true, false) => (None, of(HELD)),
        (false, true) => (of(1.0 - HELD), None),
        (false, false) => {
            let inside = (HELD * draws.len() as f64).ceil() as usize;
            let ends = |from: usize| (draws[from].min(fitted), draws[from + inside - 1].max(fitted));
            let width = |(low, high): &(f64, f64)| high - low;
            let all = (0..=draws.len() - inside).map(ends);
            let (low, high) = all.min_by(|a, b| width(a).total_cmp(&width(b))).unwrap_or((0.0, range));
            // Where the interval from zero is as short, to what draws know of it, zero is the end.
            let from_zero = draws[inside - 1].max(fitted);
            let cut = !may_be_open && from_zero <= (1.0 + OF_WIDTH) * (high - low);
            let (low, high) = if cut { (0.0, from_zero) } else { (low, high) };
            (Some(low), Some(high))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::as_measured::fit_as_measured;
    use crate::parameters::free_parameters;
    use crate::uncertainty::acceleration_likelihood::tests::{CRUSH_M, IMPACT_SPEED_M_PER_S, holds, recorded};
    use crate::uncertainty::assessment::AssessmentOptions;
    use crumple_lumped::{Model, Nonlinear2};

    #[test]
    fn knots_rise_and_curves_go_through_their_values() {
        assert_eq!(knots_at_nodes(0), [Vec::<usize>::new()]);
        // Nodes 3 to 29, and their pairs at least three apart.
        assert_eq!((knots_at_nodes(1).len(), knots_at_nodes(2).len()), (27, 25 * 24 / 2));
        assert!(knots_at_nodes(2).iter().all(|knots| knots[0] + NEAREST <= knots[1] && knots[1] < PIECES));
        // A straight line is one whatever its knots.
        let line = |node: usize| 2.0 + 3.0 * node as f64;
        for knots in knots_at_nodes(2) {
            let values = DVector::from_vec(vec![line(0), line(knots[0]), line(knots[1]), line(PIECES)]);
            let curve = at_nodes(&knots) * values;
            assert!((0..=PIECES).all(|node| (curve[node] - line(node)).abs() < 1e-12));
        }
    }

    #[test]
    fn an_interval_ends_at_zero_and_is_open_where_the_range_ends_first() {
        let mut random = RandomNumbers::seeded(3);
        let mut normal = |mean: f64| (0..20_000).map(|_| mean + 0.2 * random.normal()).collect::<Vec<f64>>();
        let with = |fitted: f64, draws: Vec<f64>| {
            let inside = draws.into_iter().filter(|x| (0.0..=5.0).contains(x)).collect();
            shortest(inside, fitted, (5.0, false), &[1; BINS])
        };
        // A shortest interval is placed to some n^(-1/3) of a deviation (Chernoff 1964): three of 0.037 times 0.2.
        let near = |end: Option<f64>, value: f64| (end.unwrap() - value).abs() < 0.022;
        let (low, high) = with(1.0, normal(1.0));
        assert!(near(low, 1.0 - 0.392) && near(high, 1.0 + 0.392), "{low:?} {high:?}");
        // A fitted value far below is one end, and 5 % are above the other.
        let (low, high) = with(0.2, normal(1.0));
        assert!(low == Some(0.2) && near(high, 1.0 + 0.329), "{low:?} {high:?}");
        // Half a normal distribution: 95 % are within 1.96 deviations.
        let (low, high) = with(0.0, normal(0.0));
        assert!(low == Some(0.0) && near(high, 0.392), "{low:?} {high:?}");
        let (low, high) = with(5.0, normal(5.0));
        assert!(high.is_none() && near(low, 5.0 - 0.392), "{low:?}");
        // All that was possible beforehand is as likely: open.
        let triangle: Vec<f64> = (0..20_000).map(|_| random.uniform().max(random.uniform())).collect();
        let rising: [usize; BINS] = std::array::from_fn(|bin| 2 * bin + 1);
        assert_eq!(shortest(triangle.clone(), 0.6, (1.0, true), &rising), (None, None));
        assert!(shortest(triangle, 0.6, (1.0, true), &[1; BINS]).0.is_some());
    }

    #[test]
    fn intervals_of_ten_numbers_hold_the_truth_and_say_which_are_open() {
        let (k, c) = (1200.0 * (IMPACT_SPEED_M_PER_S / CRUSH_M).powi(2), 1200.0 * IMPACT_SPEED_M_PER_S / CRUSH_M);
        let truth = Model::Nonlinear2(Nonlinear2 {
            mass_kg: 1200.0,
            k1_n_per_m: 0.4 * k,
            k2_n_per_m: 0.7 * k,
            k3_n_per_m: 1.0 * k,
            x1_m: 0.5 * CRUSH_M,
            c1_n_s_per_m: 0.4 * c,
            c2_n_s_per_m: 0.2 * c,
            c3_n_s_per_m: 0.12 * c,
            c4_n_s_per_m: 0.06 * c,
            v1_m_per_s: 0.3 * IMPACT_SPEED_M_PER_S,
            v2_m_per_s: 0.65 * IMPACT_SPEED_M_PER_S,
            crush_m: CRUSH_M,
            v0_m_per_s: IMPACT_SPEED_M_PER_S,
        });
        let free = free_parameters(&truth, IMPACT_SPEED_M_PER_S, CRUSH_M);
        let (mut held, mut all, mut last_spring) = (0, 0, 0);
        for seed in 0..12 {
            let minimum = fit_as_measured(&truth, &free, &recorded(&truth, 2.0, seed)).unwrap();
            let own = curve_intervals(&minimum);
            let intervals = minimum.assess(None, AssessmentOptions::default()).unwrap().interval;
            let closed = |name: &&str| matches!(intervals[*name], (Some(_), Some(_)));
            let names: Vec<&str> = free.iter().map(|parameter| &*parameter.name).filter(closed).collect();
            held += names.iter().filter(|name| holds(&intervals, &truth, name)).count();
            all += names.len();
            let (low, high) = own.map(|own| own["k3_n_per_m"]).unwrap_or_default();
            last_spring += usize::from(high.zip(low).is_some_and(|(high, low)| high < 1.2 * low));
        }
        // The spring at dynamic crush is known to some percent from one record, by the noise of the sensor alone.
        assert!(last_spring >= 10, "{last_spring}");
        // At least four numbers of a record are closed; their errors hang together: three deviations of 12 records.
        assert!(all >= 48 && held as f64 >= 0.76 * all as f64, "{held} of {all}");
    }
}
