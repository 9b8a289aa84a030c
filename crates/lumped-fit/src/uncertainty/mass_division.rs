//! The assumed division of the mass, in the intervals of models of several masses.
//!
//! One accelerometer does not tell how the mass divides. Every share in front has its own parameters, which follow the
//! record alike; what is not known of the share is not known of them.

use crumple_lumped::Model;
use crumple_numerics::estimation::minimise::levenberg_marquardt::{Bounds, Response, descend};
use crumple_numerics::estimation::statistics::{NORMAL_95, normal_distribution};
use rayon::prelude::*;

use crate::candidate::{Assessment, Intervals, Minimum, Profile};
use crate::coordinates::Coordinates;
use crate::fit::as_measured::near;
use crate::fit::problem::Problem;
use crate::parameters::{FitParameter, free_masses, masses_of};
use crate::record::observation::{Observation, ObservedWave};
use crate::record::sensor::FitQuantity;
use crate::uncertainty::acceleration_likelihood::{AccelerationLikelihood, Ends};
use crate::uncertainty::transfer_posterior;
use crate::uncertainty::uncertain_inputs::WithInputs;

/// Shares on each side of the assumed one at which the fit is repeated, each from the ones before.
const STEPS: usize = 4;
/// Most iterations of a repeated fit, and the relative decrease of its cost that is worth another: its start, on the
/// straight line through the two before, is off by a small share of the change between them.
const ITERATIONS: u32 = 8;
const WORTH_A_STEP: f64 = 1e-3;
/// Share of the resolution below which a repeated fit ends.
const BELOW_RESOLUTION: f64 = 0.1;
/// Shares between which the mixture interpolates.
const SHARES: usize = 80;
/// Index of the compartment in a double model, and its springs and dampers.
const COMPARTMENT: usize = 1;
const SPRINGS_AND_DAMPERS: usize = 4;
/// Share in front, on each side, over which the mass is free for the derivatives by it.
const LINEARISED: f64 = 0.01;
/// Bisections of an end of the mixture.
const BISECTIONS: usize = 60;

impl WithInputs {
    /// Widens the intervals of an assessment by a share of the mass in front of the last one that lies anywhere within
    /// `half_width` of that of the minimum.
    ///
    /// Of a double model whose misfit the noise before the event explains, they are those of its transfer function
    /// (`transfer_posterior`), with a share that is known (`half_width` 0) and with uncertain inputs too. All of them
    /// hold the fitted value.
    ///
    /// Else the fit is repeated at eight other shares, the masses in front in their proportion to each other and the
    /// total kept. The interval reaches from the 2.5th to the 97.5th percentile of the mixture of all shares: at each
    /// one a normal distribution, in logarithms where no end is zero, as wide as at the assumed share. Where the model
    /// follows the record below its resolution, shares at which it does so less count less, as in a profile of the
    /// likelihood. Shares without a fit and those beyond are left out; a parameter that is open at the assumed share is
    /// open. Standard deviation and correlation stay those at the share of the minimum. Nothing changes for one mass,
    /// where masses are fitted, or else with a share that is known.
    pub fn widen_by_mass_split(&self, assessment: &mut Assessment, half_width: f64) {
        let minimum = &self.minimum;
        let masses = masses_of(&minimum.model);
        let total: f64 = masses.iter().map(|(_, kg)| kg).sum();
        let Some((_, last)) = masses.last().filter(|_| masses.len() > 1) else { return };
        let front = 1.0 - last / total;
        let is_mass = |p: &FitParameter| masses.iter().any(|(name, _)| *name == p.name);
        if minimum.free.iter().any(is_mass) {
            return;
        }
        let values = minimum.model.parameters();
        // At one end of the shares that the record allows the fitted value is an end of the interval.
        let with_value = |name: &str, (low, high): Ends| {
            let value = values.get(name).copied();
            let min = |low: f64| value.map_or(low, |value| value.min(low));
            let max = |high: f64| value.map_or(high, |value| value.max(high));
            (low.map(min), high.map(max))
        };
        if let Some(intervals) = by_transfer_function(self, front, half_width) {
            for (name, ends) in &mut assessment.interval {
                if let Some(of_name) = intervals.get(name) {
                    *ends = with_value(name, *of_name);
                }
            }
            return;
        }
        if half_width <= 0.0 {
            return;
        }
        let (below, above) = rayon::join(
            || to_one_side(minimum, (front, -half_width), total),
            || to_one_side(minimum, (front, half_width), total),
        );
        let at_assumed = AtShare { model: minimum.model.clone(), cost: cost_of(minimum) };
        let fits: Vec<&AtShare> = below.iter().rev().chain([&at_assumed]).chain(&above).collect();
        let weights = weights(minimum, &fits, assessment.effective_samples);
        for (name, ends) in &mut assessment.interval {
            let (Some(value), (Some(low), Some(high))) = (values.get(name.as_str()), *ends) else { continue };
            let of_fits = fits.iter().filter_map(|fit| fit.model.parameters().get(name.as_str()).copied());
            let nodes: Vec<[f64; 3]> = of_fits.map(|there| as_wide_as([low, *value, high], there)).collect();
            *ends = with_value(name, not_negative(mixture(&nodes, &weights)));
        }
    }
}

/// A fit with another share in front.
struct AtShare {
    model: Model,
    /// Sum of squares, in squared units of the problem.
    cost: f64,
}

/// The fits from the share of the minimum on to one that is `reach` away, up to the first share without a fit.
///
/// Each starts on the straight line through the two before.
fn to_one_side(minimum: &Minimum, (front, reach): (f64, f64), total_kg: f64) -> Vec<AtShare> {
    let masses = masses_of(&minimum.model).len();
    let mut found: Vec<AtShare> = Vec::new();
    for step in 1..=STEPS {
        let share = front + reach * step as f64 / STEPS as f64;
        let before = found.last().map_or(&minimum.model, |fit| &fit.model).values();
        let two_before = match found.len() {
            0 => before.clone(),
            1 => minimum.model.values(),
            n => found[n - 2].model.values(),
        };
        // Masses stand first.
        let mut start: Vec<f64> = before.iter().zip(&two_before).map(|(x, y)| 2.0 * x - y).collect();
        start.iter_mut().zip(&before).skip(masses).filter(|(x, y)| **x < 0.5 * **y).for_each(|(x, y)| *x = 0.5 * y);
        let (last, others) = before[..masses].split_last().unwrap_or((&0.0, &[]));
        let in_front = total_kg - last;
        start.iter_mut().zip(others).for_each(|(kg, before)| *kg = before / in_front * share * total_kg);
        start[masses - 1] = (1.0 - share) * total_kg;
        let Some(fit) = Some(start).filter(|_| share > 0.0 && share < 1.0).and_then(|start| fit_at(minimum, &start))
        else {
            break;
        };
        found.push(fit);
    }
    found
}

/// The fit from these values of all parameters, with those free that are free at the minimum.
fn fit_at(minimum: &Minimum, start: &[f64]) -> Option<AtShare> {
    let model = minimum.model.with_values(start).ok()?;
    let values = model.values();
    let free = minimum.free.iter().map(|p| p.described_at(values[p.index])).collect();
    let coordinates = Coordinates::near(model, free);
    let problem = near(&coordinates, &minimum.observed);
    let resolution = (minimum.observed.unresolved() / problem.rows() as f64).sqrt();
    let problem = Problem { exact: BELOW_RESOLUTION * resolution, ..problem.on_motion() };
    let bounds = Bounds { max_iterations: ITERATIONS, cost_tolerance: WORTH_A_STEP, ..problem.bounds() };
    let best = descend(&problem, &coordinates.start(), &bounds)?;
    Some(AtShare { model: coordinates.model(&best.theta)?, cost: best.cost })
}

/// Sum of squares of a minimum, in squared units of its problem.
fn cost_of(minimum: &Minimum) -> f64 {
    minimum.misfit_m.iter().map(|r| (r / minimum.observed.scale_m()).powi(2)).sum()
}

/// The likelihood of every share where the minimum is below the resolution of the record; else all count the same.
fn weights(minimum: &Minimum, fits: &[&AtShare], effective_samples: f64) -> Vec<f64> {
    let (least, floor) = (cost_of(minimum), minimum.observed.unresolved());
    let rise = |fit: &&AtShare| {
        let ratio = if least <= floor { (fit.cost + floor) / (least + floor) } else { 1.0 };
        effective_samples * ratio.max(1.0).ln()
    };
    fits.iter().map(|fit| (-0.5 * rise(fit)).exp()).collect()
}

/// An interval of a spring or damper that reaches below zero begins at zero.
fn not_negative((low, high): Ends) -> Ends {
    (low.map(|low| low.max(0.0)), high)
}

/// Low end, value and high end around another value, at the same distances: of logarithms where the low end has one.
fn as_wide_as([low, value, high]: [f64; 3], there: f64) -> [f64; 3] {
    if low > 0.0 {
        [low, value, high].map(|x| x / value * there)
    } else {
        [low, value, high].map(|x| x - value + there)
    }
}

/// The intervals of a double model by its transfer function, where the noise before the event explains the misfit.
///
/// `None` for other models, for records whose misfit the noise does not explain, with a sensor in front or on the
/// wall, whose motion is not that of this function, and where a displacement is missed by less than its resolution:
/// then that, and not the noise, bounds what is known.
fn by_transfer_function(with: &WithInputs, front: f64, half_width: f64) -> Option<Intervals> {
    let minimum = &with.minimum;
    let Model::DoubleSpringMassDamper(model) = &minimum.model else { return None };
    let shares = (front - half_width, front + half_width);
    let of_compartment = |wave: &ObservedWave| {
        wave.mass.is_none_or(|mass| mass == COMPARTMENT)
            && wave.quantity == FitQuantity::Displacement
            && minimum.rmse_m() > wave.resolution
    };
    let of_compartment = minimum.observed.waves.iter().all(of_compartment);
    if minimum.free.len() < SPRINGS_AND_DAMPERS || !of_compartment || shares.0 <= 0.0 || shares.1 >= 1.0 {
        return None;
    }
    let linearised_in = (shares.0.min(front - LINEARISED), shares.1.max(front + LINEARISED));
    let masses = free_masses(&minimum.model, linearised_in);
    let free: Vec<FitParameter> = minimum.redescribed().into_iter().chain(masses).collect();
    let kept: Vec<usize> = (0..free.len()).collect();
    let coordinates = Coordinates::near(minimum.model.clone(), free);
    let source = AccelerationLikelihood::of(&coordinates, &minimum.observed, &coordinates.start(), &kept);
    let source = source.filter(AccelerationLikelihood::explains)?;
    let misfit = |observed: &Observation| source.of_record(observed)?.by_waves(&source.theta);
    let intervals = transfer_posterior::intervals((&source, &with.change_of(misfit)?), &coordinates, model, shares)?;
    let names = ["k1_n_per_m", "k2_n_per_m", "c1_n_s_per_m", "c2_n_s_per_m"].into_iter();
    Some(names.map(str::to_owned).zip(intervals).collect())
}

/// The 95 % interval of the mixture over shares from one end to the other, of intervals around values and their weights
/// at equal distances.
fn mixture(nodes: &[[f64; 3]], weights: &[f64]) -> Ends {
    match nodes {
        [] => return (None, None),
        [[low, _, high]] => return (Some(*low), Some(*high)),
        _ => {}
    }
    let logarithmic = nodes.iter().all(|[low, ..]| *low > 0.0);
    let coordinate = |x: f64| if logarithmic { x.ln() } else { x };
    let closed: Vec<[f64; 3]> = nodes.iter().map(|ends| ends.map(coordinate)).collect();
    let at = |k: usize| -> ([f64; 3], f64) {
        let place = (k as f64 + 0.5) / SHARES as f64 * (closed.len() - 1) as f64;
        let node = (place as usize).min(closed.len() - 2);
        let share = place - node as f64;
        let between = |a: f64, b: f64| a + share * (b - a);
        let ends = std::array::from_fn(|end| between(closed[node][end], closed[node + 1][end]));
        (ends, between(weights[node], weights[node + 1]))
    };
    let shares: Vec<([f64; 3], f64)> = (0..SHARES).map(at).collect();
    let sum: f64 = shares.iter().map(|(_, weight)| weight).sum();
    let below = |x: f64| {
        let one = |([low, value, high], weight): &([f64; 3], f64)| {
            let half = if x < *value { value - low } else { high - value };
            weight * normal_distribution(NORMAL_95 * (x - value) / half.max(f64::MIN_POSITIVE))
        };
        shares.iter().map(one).sum::<f64>() / sum
    };
    let lowest = shares.iter().map(|([low, ..], _)| *low).fold(f64::INFINITY, f64::min);
    let highest = shares.iter().map(|([.., high], _)| *high).fold(f64::NEG_INFINITY, f64::max);
    let end = |level: f64| {
        let (mut low, mut high) = (lowest, highest);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if below(middle) < level { low = middle } else { high = middle }
        }
        let x = 0.5 * (low + high);
        if logarithmic { x.exp() } else { x }
    };
    (Some(end(0.025)), Some(end(0.975)))
}

/// Rise of `2 ln L` that ends a 95 % interval of one parameter: chi-square with one degree of freedom.
pub(crate) const RISE_95: f64 = 3.841_459;
/// Grid points on each side at most.
const POINTS: usize = 24;
/// The first step as a share of the half-width that the linearisation expects.
const FIRST_SHARE: f64 = 0.25;
/// Factor from one step to the next.
const GROWTH: f64 = 1.35;
/// Smallest and largest first step in a coordinate of size one.
const PROFILE_STEPS: (f64, f64) = (1e-6, 0.25);
/// Bisections between the last point inside and the first outside: 1/64 of a grid step.
const PROFILE_BISECTIONS: usize = 6;

/// Fits the other parameters with one fixed: which one, its coordinate, start coordinates of the others. Gives the
/// coordinates of the minimum and its sum of squares.
pub(crate) type Refit<'a> = &'a (dyn Fn(usize, f64, &[f64]) -> Option<(Vec<f64>, f64)> + Sync);

/// A minimum whose parameters can be fixed one at a time.
pub(crate) struct Profiled<'a> {
    /// Names of the parameters, in the order of the coordinates.
    pub names: &'a [String],
    /// Coordinates of the minimum.
    pub at: &'a [f64],
    /// Smallest and largest coordinates.
    pub bounds: &'a [(f64, f64)],
    /// The value of a parameter at a coordinate.
    pub value: &'a (dyn Fn(usize, f64) -> f64 + Sync),
    /// Whether a coordinate of zero is a value of zero, which ends an interval.
    pub ends_at_zero: &'a (dyn Fn(usize) -> bool + Sync),
    /// How the others are fitted again.
    pub refit: Refit<'a>,
    /// The rise of `2 ln L` above the minimum at a sum of squares.
    pub rise: &'a (dyn Fn(f64) -> f64 + Sync),
    /// Half-width of the linear interval of each coordinate, where there is one; it sets the first step.
    pub expected: &'a [Option<f64>],
}

impl Profiled<'_> {
    /// Sets each free parameter to values away from the minimum, fits all others again from the neighbouring value, and
    /// ends the interval where `2 ln L` has fallen by 3.84: chi-square, one degree of freedom, 95 %.
    ///
    /// Up to 24 values on each side with growing steps, then six bisections. A side that does not rise so far, or ends
    /// at a bound of the search, is open: the parameter is not identifiable. Where zero is reached first, zero is the
    /// end.
    pub fn profiles(&self) -> Vec<Profile> {
        (0..self.at.len()).into_par_iter().map(|i| self.profile(i)).collect()
    }

    /// The profile of one parameter.
    pub fn profile(&self, i: usize) -> Profile {
        let side = Side::new(self, i);
        let (low, mut points) = side.walk(-1.0);
        let (high, above) = side.walk(1.0);
        points.reverse();
        points.push(((self.value)(i, self.at[i]), 0.0));
        points.extend(above);
        Profile { parameter: self.names[i].clone(), low, high, points }
    }
}

/// What both sides of the profile of one parameter share.
struct Side<'a> {
    /// The minimum, and which of its parameters is fixed.
    of: &'a Profiled<'a>,
    fixed: usize,
    /// First step of the coordinate.
    first_step: f64,
}

impl<'a> Side<'a> {
    fn new(of: &'a Profiled<'a>, fixed: usize) -> Self {
        let expected = of.expected.get(fixed).copied().flatten();
        let first_step = (FIRST_SHARE * expected.unwrap_or(1.0)).clamp(PROFILE_STEPS.0, PROFILE_STEPS.1);
        Self { of, fixed, first_step }
    }

    /// The rise of `2 ln L` with the parameter at `coordinate`, and the coordinates of the others there.
    fn rise(&self, coordinate: f64, start: &[f64]) -> Option<(Vec<f64>, f64)> {
        let (theta, cost) = (self.of.refit)(self.fixed, coordinate, start)?;
        let rise = (self.of.rise)(cost);
        rise.is_finite().then_some((theta, rise))
    }

    /// One side, `direction` -1 or 1: the end of the interval and the points on the way.
    fn walk(&self, direction: f64) -> (Option<f64>, Vec<(f64, f64)>) {
        let value = |coordinate: f64| (self.of.value)(self.fixed, coordinate);
        let (lower, upper) = self.of.bounds[self.fixed];
        let mut theta: Vec<f64> =
            self.of.at.iter().enumerate().filter(|(i, _)| *i != self.fixed).map(|(_, x)| *x).collect();
        let mut inside = self.of.at[self.fixed];
        let mut step = self.first_step;
        let mut points = Vec::new();
        let zero = |coordinate: f64| {
            (direction < 0.0 && (self.of.ends_at_zero)(self.fixed) && coordinate <= 0.0).then_some(0.0)
        };
        for _ in 0..POINTS {
            let next = (inside + direction * step).clamp(lower, upper);
            if next == inside {
                return (zero(inside), points);
            }
            let Some((refitted, rise)) = self.rise(next, &theta) else { return (None, points) };
            points.push((value(next), rise));
            if rise > RISE_95 {
                let (mut good, mut bad) = (inside, next);
                for _ in 0..PROFILE_BISECTIONS {
                    let middle = 0.5 * (good + bad);
                    match self.rise(middle, &theta) {
                        Some((refitted, rise)) if rise <= RISE_95 => {
                            good = middle;
                            theta = refitted;
                        }
                        _ => bad = middle,
                    }
                }
                return (Some(value(0.5 * (good + bad))), points);
            }
            (theta, inside) = (refitted, next);
            step *= GROWTH;
        }
        (None, points)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_lumped::DoubleSpringMassDamper;
    use crumple_numerics::estimation::random::RandomNumbers;

    use crate::fit::as_measured::{fit_as_measured, is_own_dual};
    use crate::parameters::free_parameters;
    use crate::uncertainty::acceleration_likelihood::tests::{CRUSH_M, IMPACT_SPEED_M_PER_S, holds, recorded};
    use crate::uncertainty::assessment::AssessmentOptions;
    use crate::uncertainty::propagation::InputUncertainty;

    /// A car of 1500 kg, near its own dual, with this share of its mass in front.
    fn double(random: &mut RandomNumbers, share: f64) -> DoubleSpringMassDamper {
        let mut between = |low: f64, high: f64| low + (high - low) * random.uniform();
        let k1_n_per_m = between(1.1e6, 2.2e6);
        DoubleSpringMassDamper {
            m1_kg: 1500.0 * share,
            m2_kg: 1500.0 * (1.0 - share),
            k1_n_per_m,
            k2_n_per_m: (1.0 - share) * k1_n_per_m * between(0.75, 1.33),
            c1_n_s_per_m: between(3e3, 1.2e4),
            c2_n_s_per_m: between(3e3, 1.2e4),
        }
    }

    #[test]
    fn a_candidate_that_is_its_own_dual_holds_truths_on_both_sides() {
        let mut random = RandomNumbers::seeded(3);
        let (mut held, mut records) = (0, 0);
        for seed in 0..120 {
            let share = 0.15 + 0.2 * random.uniform();
            let truth = double(&mut random, share);
            // A fit that starts as its own dual stays so: it moves both duals alike.
            let half = |of_front: f64, of_rear: f64| 0.5 * (of_front + of_rear / (1.0 - share));
            let (k1_n_per_m, c1_n_s_per_m) =
                (half(truth.k1_n_per_m, truth.k2_n_per_m), half(truth.c1_n_s_per_m, truth.c2_n_s_per_m));
            let start = Model::DoubleSpringMassDamper(DoubleSpringMassDamper {
                m1_kg: 375.0,
                m2_kg: 1125.0,
                k1_n_per_m,
                k2_n_per_m: 0.75 * k1_n_per_m,
                c1_n_s_per_m,
                c2_n_s_per_m: 0.75 * c1_n_s_per_m,
            });
            let truth = Model::DoubleSpringMassDamper(truth);
            let observed = recorded(&truth, 1.0, seed);
            let minimum = fit_as_measured(&start, &free_parameters(&start, IMPACT_SPEED_M_PER_S, CRUSH_M), &observed);
            let exact = minimum.map(|minimum| minimum.with_inputs(&InputUncertainty::default()));
            let exact = exact.filter(|m| is_own_dual(&m.minimum.model) && by_transfer_function(m, 0.25, 0.1).is_some());
            let Some(exact) = exact else { continue };
            let mut assessment = exact.minimum.assess(None, AssessmentOptions::default()).unwrap();
            exact.widen_by_mass_split(&mut assessment, 0.1);
            records += 1;
            let springs = ["k1_n_per_m", "k2_n_per_m"];
            held += springs.iter().filter(|name| holds(&assessment.interval, &truth, name)).count();
        }
        // Two springs a record, held alike: a share of 95 % of 30 records is known to 4 points, three of them allowed.
        assert!(records >= 20 && held as f64 >= 0.83 * 2.0 * f64::from(records), "{held} of 2 times {records}");
    }

    fn node(value: f64, half: f64) -> [f64; 3] {
        [value - half, value, value + half]
    }

    #[test]
    fn a_mixture_is_the_interval_where_the_share_does_nothing_and_the_share_where_noise_does_nothing() {
        // Not in logarithms, since an end is below zero: one interval, to the difference of 1.96 and the normal point.
        let (low, high) = mixture(&[node(1.0, 2.0); 9], &[1.0; 9]);
        assert!((low.unwrap() + 1.0).abs() < 0.01 && (high.unwrap() - 3.0).abs() < 0.01, "{low:?} {high:?}");
        // Evenly spread from -4 to 4: 95 % of it, to half of the 80th part between two shares.
        let spread: Vec<_> = (-4..=4).map(|k| node(f64::from(k), 1e-6)).collect();
        let (low, high) = mixture(&spread, &[1.0; 9]);
        assert!((low.unwrap() + 3.8).abs() < 0.06 && (high.unwrap() - 3.8).abs() < 0.06, "{low:?} {high:?}");
    }

    #[test]
    fn the_interval_of_a_damper_near_zero_begins_at_zero_at_every_share() {
        // 0 to 3 around 1, moved to shares at which the damper is less.
        let nodes = [1.0, 0.5, 0.1].map(|there| as_wide_as([0.0, 1.0, 3.0], there));
        assert!(mixture(&nodes, &[1.0; 3]).0.unwrap() < 0.0);
        let (low, high) = not_negative(mixture(&nodes, &[1.0; 3]));
        assert!(low == Some(0.0) && high.unwrap() > 2.0, "{low:?} {high:?}");
    }

    #[test]
    fn a_share_counts_as_much_as_its_weight() {
        let spread: Vec<_> = (-4..=4).map(|k| node(f64::from(k), 1e-6)).collect();
        // A weight that falls in a straight line from 1 at 0 to 0 at one step: 95 % of a triangle of this half width.
        let weights: Vec<f64> = (0..9).map(|k| if k == 4 { 1.0 } else { 0.0 }).collect();
        let (low, high) = mixture(&spread, &weights);
        let expected = 1.0 - 0.05_f64.sqrt();
        assert!((low.unwrap() + expected).abs() < 0.06 && (high.unwrap() - expected).abs() < 0.06, "{low:?} {high:?}");
    }
}
