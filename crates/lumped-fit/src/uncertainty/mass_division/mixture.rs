//! The assumed division of the mass, in the intervals of models of several masses.
//!
//! One accelerometer does not tell how the mass divides. Every share in front has its own parameters, which follow the
//! record alike; what is not known of the share is not known of them.

use std::collections::BTreeMap;

use crumple_estimation::statistics::normal_distribution;
use crumple_lumped::Model;

use crate::FitQuantity;
use crate::candidate::minimum::Minimum;
use crate::fit::as_measured::fit_nearby;
use crate::free::coordinates::Coordinates;
use crate::free::free_parameter::{FreeParameter, free_masses, masses_of};
use crate::record::observation::ObservedWave;
use crate::uncertainty::assessment::{Assessment, AssessmentOptions, Ends, Intervals, assess};
use crate::uncertainty::mass_division::transfer_posterior;
use crate::uncertainty::source_misfit::AtSource;

/// Shares on each side of the assumed one at which the fit is repeated, each from the one before.
const STEPS: i32 = 4;
/// Shares between which the mixture interpolates.
const SHARES: usize = 80;
/// Index of the compartment in a double model, and its springs and dampers.
const COMPARTMENT: usize = 1;
const SPRINGS_AND_DAMPERS: usize = 4;
/// Bisections of an end of the mixture.
const BISECTIONS: usize = 60;

/// Widens the intervals of an assessment by a share of the mass in front of the last one that lies anywhere within
/// `half_width` of that of the minimum.
///
/// Of a double model whose misfit the noise before the event explains, they are those of its transfer function, see
/// `transfer_posterior`. All of them hold the fitted value.
///
/// Else the fit is repeated at eight other shares, the masses in front in their proportion to each other and the total
/// kept.
/// The interval reaches from the 2.5th to the 97.5th percentile of the mixture of all shares: at each one a normal
/// distribution, in logarithms where no end is zero, of the width of the interval there. Shares
/// without a fit, or where the record leaves the parameter open, and those beyond, are left out; a parameter that is
/// open at the assumed share is open. Standard deviation and correlation stay those at the
/// share of the minimum. Nothing changes for one mass, or where masses are fitted.
pub fn widen_by_mass_split(minimum: &Minimum, assessment: &mut Assessment, half_width: f64) {
    let masses = masses_of(&minimum.model);
    let total: f64 = masses.iter().map(|(_, kg)| kg).sum();
    let Some((_, last)) = masses.last().filter(|_| masses.len() > 1) else { return };
    let front = 1.0 - last / total;
    let is_mass = |p: &FreeParameter| masses.iter().any(|(name, _)| *name == p.name);
    if half_width <= 0.0 || minimum.free.iter().any(is_mass) {
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
    if let Some(intervals) = by_transfer_function(minimum, front, half_width) {
        for (name, ends) in &mut assessment.interval {
            if let Some(of_name) = intervals.get(name) {
                *ends = with_value(name, *of_name);
            }
        }
        return;
    }
    // By share from the smallest on, each with the value and the interval of every parameter.
    let mut nodes: Vec<Option<BTreeMap<String, (f64, Ends)>>> = Vec::new();
    for direction in [-1.0, 1.0] {
        let mut before = Some(minimum.clone());
        let mut side = Vec::new();
        for step in 1..=STEPS {
            let share = front + direction * half_width * f64::from(step) / f64::from(STEPS);
            before = before.and_then(|before| at_share(&before, share, total));
            side.push(before.as_ref().and_then(intervals_at));
        }
        if direction < 0.0 {
            side.reverse();
            side.push(Some(with_values(minimum, assessment)));
        }
        nodes.extend(side);
    }
    for (name, ends) in &mut assessment.interval {
        let of_name: Vec<Option<[f64; 3]>> = nodes.iter().map(|node| closed(node.as_ref()?.get(name)?)).collect();
        *ends = with_value(name, mixture(around_the_assumed(&of_name, STEPS as usize).as_slice()));
    }
}

/// The intervals of a double model by its transfer function, where the noise before the event explains the misfit.
///
/// `None` for other models, for records whose misfit the noise does not explain, with a sensor in front or on the
/// wall, whose motion is not that of this function, and where a displacement is missed by less than its resolution:
/// then that, and not the noise, bounds what is known.
fn by_transfer_function(minimum: &Minimum, front: f64, half_width: f64) -> Option<Intervals> {
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
    let springs = minimum.free.iter().map(|p| p.described_at(p.value));
    let free: Vec<FreeParameter> = springs.chain(free_masses(&minimum.model, shares)).collect();
    let coordinates = Coordinates::near(minimum.model, &free);
    let kept: Vec<usize> = (0..free.len()).collect();
    let source = AtSource::of(&coordinates, &minimum.observed, &coordinates.start(), &kept);
    let intervals = transfer_posterior::intervals(&source.filter(AtSource::explains)?, &coordinates, model, shares)?;
    let names = ["k1_n_per_m", "k2_n_per_m", "c1_n_s_per_m", "c2_n_s_per_m"].into_iter();
    Some(names.map(str::to_owned).zip(intervals).collect())
}

/// The closed intervals from the assumed share on, both ways, up to the first that is not closed; none where that at
/// the assumed share is open.
fn around_the_assumed(nodes: &[Option<[f64; 3]>], assumed: usize) -> Vec<[f64; 3]> {
    let first = nodes[..=assumed].iter().rposition(Option::is_none).map_or(0, |open| open + 1);
    nodes[first..].iter().map_while(|node| *node).take(if first > assumed { 0 } else { nodes.len() }).collect()
}

/// Low end, value and high end of a closed interval.
fn closed((value, (low, high)): &(f64, Ends)) -> Option<[f64; 3]> {
    Some([(*low)?, *value, (*high)?])
}

/// The minimum near this one with another share in front; `None` for a share without masses, or without a fit.
fn at_share(minimum: &Minimum, share: f64, total_kg: f64) -> Option<Minimum> {
    if !(share > 0.0 && share < 1.0) {
        return None;
    }
    // Masses stand first.
    let mut values = minimum.model.values();
    let (last, others) = values[..masses_of(&minimum.model).len()].split_last_mut()?;
    let in_front: f64 = others.iter().sum();
    others.iter_mut().for_each(|kg| *kg *= share * total_kg / in_front);
    *last = (1.0 - share) * total_kg;
    let model = minimum.model.with_values(&values).ok()?;
    let free: Vec<FreeParameter> = minimum.free.iter().map(|p| p.described_at(p.value)).collect();
    fit_nearby(&model, &free, &minimum.observed)
}

fn intervals_at(minimum: &Minimum) -> Option<BTreeMap<String, (f64, Ends)>> {
    Some(with_values(minimum, &assess(minimum, None, AssessmentOptions::default())?))
}

/// The value of every parameter with its interval.
fn with_values(minimum: &Minimum, assessment: &Assessment) -> BTreeMap<String, (f64, Ends)> {
    let values = minimum.model.parameters();
    let with_value = |(name, ends): (&String, &Ends)| Some((name.clone(), (*values.get(name)?, *ends)));
    assessment.interval.iter().filter_map(with_value).collect()
}

/// The 95 % interval of the mixture over shares from one end to the other, of values and intervals at equal distances.
fn mixture(nodes: &[[f64; 3]]) -> Ends {
    match nodes {
        [] => return (None, None),
        [[low, _, high]] => return (Some(*low), Some(*high)),
        _ => {}
    }
    let logarithmic = nodes.iter().all(|[low, ..]| *low > 0.0);
    let coordinate = |x: f64| if logarithmic { x.ln() } else { x };
    let closed: Vec<[f64; 3]> = nodes.iter().map(|ends| ends.map(coordinate)).collect();
    let at = |k: usize| -> [f64; 3] {
        let place = (k as f64 + 0.5) / SHARES as f64 * (closed.len() - 1) as f64;
        let node = (place as usize).min(closed.len() - 2);
        let share = place - node as f64;
        std::array::from_fn(|end| closed[node][end] + share * (closed[node + 1][end] - closed[node][end]))
    };
    let shares: Vec<[f64; 3]> = (0..SHARES).map(at).collect();
    let below = |x: f64| {
        let one = |[low, value, high]: &[f64; 3]| {
            let half = if x < *value { value - low } else { high - value };
            normal_distribution(1.96 * (x - value) / half.max(f64::MIN_POSITIVE))
        };
        shares.iter().map(one).sum::<f64>() / SHARES as f64
    };
    let lowest = shares.iter().map(|[low, ..]| *low).fold(f64::INFINITY, f64::min);
    let highest = shares.iter().map(|[.., high]| *high).fold(f64::NEG_INFINITY, f64::max);
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

#[cfg(test)]
mod tests {
    use super::*;

    fn node(value: f64, half: f64) -> [f64; 3] {
        [value - half, value, value + half]
    }

    #[test]
    fn a_mixture_is_the_interval_where_the_share_does_nothing_and_the_share_where_noise_does_nothing() {
        // Not in logarithms, since an end is below zero: one interval, to the difference of 1.96 and the normal point.
        let (low, high) = mixture(&[node(1.0, 2.0); 9]);
        assert!((low.unwrap() + 1.0).abs() < 0.01 && (high.unwrap() - 3.0).abs() < 0.01, "{low:?} {high:?}");
        // Evenly spread from -4 to 4: 95 % of it, to half of the 80th part between two shares.
        let spread: Vec<_> = (-4..=4).map(|k| node(f64::from(k), 1e-6)).collect();
        let (low, high) = mixture(&spread);
        assert!((low.unwrap() + 3.8).abs() < 0.06 && (high.unwrap() - 3.8).abs() < 0.06, "{low:?} {high:?}");
    }

    #[test]
    fn shares_beyond_one_that_is_open_are_left_out() {
        let mut nodes: Vec<Option<[f64; 3]>> = (0..9).map(|k| Some(node(f64::from(k), 0.1))).collect();
        (nodes[2], nodes[7]) = (None, None);
        let values = |nodes: &[Option<[f64; 3]>]| -> Vec<f64> {
            around_the_assumed(nodes, 4).iter().map(|node| node[1]).collect()
        };
        assert_eq!(values(&nodes), [3.0, 4.0, 5.0, 6.0]);
        nodes[4] = None;
        assert_eq!(mixture(&around_the_assumed(&nodes, 4)), (None, None));
    }
}
