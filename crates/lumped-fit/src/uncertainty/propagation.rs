//! Uncertain mass, speed, zero level and time zero: the fit repeated with changed inputs.
//!
//! A Monte Carlo propagation after JCGM 101: draw the inputs, change the record as these errors would have, fit
//! again, take percentiles. The errors are those that are the same in the whole record, which no residual shows.

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use crumple_lumped::{Model, Parameter, ParameterKind};
use crumple_numerics::estimation::random::RandomNumbers;
use crumple_signal::Distribution;

use crate::fit::as_measured::near;
use crate::free::coordinates::Coordinates;
use crate::record::observation::{FEWEST, Observation, ObservedWave};
use crate::uncertainty::block_bootstrap::percentile;
use crate::{FitQuantity, FreeParameter, Measurement};

/// Largest error that a repetition can draw, in units of its size. One normal deviate in 5e8 is larger, and cut to it.
pub const fn largest_draw(distribution: Distribution) -> f64 {
    match distribution {
        Distribution::Normal => 6.0,
        Distribution::Uniform => 1.0,
    }
}

/// Sizes of the errors of what a test is told and what is not seen on the pulse; independent of each other. A size is
/// a standard deviation or a half width, by its distribution.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct InputUncertainty {
    /// Of the test mass, kg.
    pub mass_kg: f64,
    /// Of the impact speed, m/s.
    pub impact_speed_m_per_s: f64,
    /// Of the zero level of the accelerometer, m/s².
    pub bias_m_per_s2: f64,
    /// Of time zero, s.
    pub time_zero_s: f64,
    /// Their distributions, in this order.
    pub distributions: [Distribution; 4],
}

impl InputUncertainty {
    /// Whether anything is uncertain.
    pub fn any(&self) -> bool {
        [self.mass_kg, self.impact_speed_m_per_s, self.bias_m_per_s2, self.time_zero_s].iter().any(|s| *s > 0.0)
    }
}

/// Repetitions where no number is asked for: ten of 200 lie beyond each end of a 90 % interval.
pub const REPETITIONS: usize = 200;
/// Seed of the generators; repetition `i` uses its stream `i`.
const SEED: u64 = 2;

/// Percentiles over the repetitions.
#[derive(Debug, Clone, PartialEq)]
pub struct Propagation {
    /// Repetitions that led to a result.
    pub repetitions: usize,
    /// 5th and 95th percentile by name: the parameters, and `dynamic_crush_m` of the model.
    pub interval_90: BTreeMap<String, (f64, f64)>,
    /// Standard deviation by name.
    pub standard_deviation: BTreeMap<String, f64>,
}

/// A test with the errors of one repetition.
#[derive(Debug, Clone)]
pub struct Repetition {
    /// The record with another speed, zero level and time zero.
    pub observed: Observation,
    /// Mass over the mass stated.
    pub mass_ratio: f64,
}

/// The inputs of repetition `index`: four numbers from its own stream of a fixed seed.
///
/// Another impact speed adds `δv t` to the displacement `t` after contact, another zero level `δb (t - t_start)²/2`
/// less what that is at contact, since the integration starts at `t_start`: at contact, or at the first sample; another
/// time zero moves the label of contact, with the displacement made zero again there and, where the integration starts
/// at contact, the velocity made the impact speed.
pub fn repetition(observed: &Observation, inputs: &InputUncertainty, index: usize) -> Option<Repetition> {
    with_errors(observed, &drawn(inputs, index, observed.waves.len()))
}

/// The errors of one repetition.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Errors {
    /// Of the mass, relative.
    pub mass: f64,
    /// Of the impact speed, m/s.
    pub speed_m_per_s: f64,
    /// Of time zero, s.
    pub late_s: f64,
    /// Of the zero level of every sensor, m/s²; the last one holds for further ones.
    pub bias_m_per_s2: Vec<f64>,
}

/// The errors of repetition `index`; that of the mass as a share of the mass that `inputs` refer to. Every sensor has
/// its own zero level.
fn drawn(inputs: &InputUncertainty, index: usize, sensors: usize) -> Errors {
    let mut random = RandomNumbers::of_stream(SEED, index);
    let mut draw = |size: f64, distribution: Distribution| {
        size * match distribution {
            Distribution::Normal => random.normal().clamp(-largest_draw(distribution), largest_draw(distribution)),
            Distribution::Uniform => 2.0 * random.uniform() - 1.0,
        }
    };
    let [of_mass, of_speed, of_bias, of_zero] = inputs.distributions;
    let mass = draw(inputs.mass_kg, of_mass);
    let speed_m_per_s = draw(inputs.impact_speed_m_per_s, of_speed);
    let bias = draw(inputs.bias_m_per_s2, of_bias);
    let late_s = draw(inputs.time_zero_s, of_zero);
    let others = (1..sensors).map(|_| draw(inputs.bias_m_per_s2, of_bias));
    let bias_m_per_s2 = std::iter::once(bias).chain(others).collect();
    Errors { mass, speed_m_per_s, late_s, bias_m_per_s2 }
}

/// The record with a mass ratio `1 + mass` (relative), `speed` faster, `bias` higher and its contact `late` later.
///
/// `None` where the later contact leaves fewer than 12 samples of the window.
pub fn perturbed(observed: &Observation, mass: f64, speed: f64, bias: f64, late: f64) -> Option<Repetition> {
    with_errors(observed, &Errors { mass, speed_m_per_s: speed, late_s: late, bias_m_per_s2: vec![bias] })
}

/// The record with these errors; `None` where fewer than 12 samples of a window are left.
pub(crate) fn with_errors(observed: &Observation, errors: &Errors) -> Option<Repetition> {
    let bias = |k: usize| errors.bias_m_per_s2.get(k).or(errors.bias_m_per_s2.last()).copied().unwrap_or(0.0);
    let waves = observed.waves.iter().enumerate();
    let observed = Observation {
        impact_speed_m_per_s: observed.impact_speed_m_per_s + errors.speed_m_per_s,
        waves: waves.map(|(k, wave)| shifted(wave, observed.impact_speed_m_per_s, errors, bias(k))).collect(),
    };
    let enough = observed.waves.iter().all(|wave| wave.samples.len() >= FEWEST);
    enough.then_some(Repetition { observed, mass_ratio: 1.0 + errors.mass })
}

/// One wave with these errors and its own zero level `bias` higher.
///
/// The new contact is looked up in the whole record, wherever the window starts: a displacement is zero there, and one
/// that is integrated from contact has the impact speed there too. Before the record's first sample nothing has slowed
/// the vehicle. The window starts as long after the new contact as it did after the old one, and ends with the same
/// sample.
fn shifted(wave: &ObservedWave, v0: f64, errors: &Errors, bias: f64) -> ObservedWave {
    let (speed, late) = (errors.speed_m_per_s, errors.late_s);
    let m = wave.measurement;
    let (first, x) = if late == 0.0 {
        (wave.first, wave.samples.clone())
    } else {
        let first = wave.first as f64 + (late / m.dt_s - 1e-6).ceil();
        wave.record.picked(&m, first, wave.last(), wave.stride)
    };
    // Where the integration starts: at the new contact, between two samples or at one, if the record has begun there.
    let start_s = if m.from_contact { late.max(m.first_s) } else { m.first_s };
    // Value and slope of what is integrated at the new contact, on the old axis.
    let at_contact = |before: (f64, f64)| match late {
        0.0 => before,
        late => wave.record.at(late).unwrap_or((before.0 + late * before.1, before.1)),
    };
    let timed = x.iter().enumerate().map(|(k, x)| (m.time_s(first + k * wave.stride), *x));
    let samples = match wave.quantity {
        FitQuantity::Acceleration => x.iter().map(|a| a + bias).collect(),
        // Load cells have a zero level of their own, which is taken off before the filter.
        FitQuantity::Force => x,
        FitQuantity::Velocity => {
            let lost = if m.from_contact { at_contact((v0, 0.0)).0 - v0 } else { 0.0 };
            timed.map(|(t, v)| v - lost + speed + bias * (t - start_s)).collect()
        }
        FitQuantity::Displacement => {
            // Another speed moves the vehicle from contact on, another zero level what is integrated.
            let bent = |t: f64| 0.5 * bias * (t - start_s) * (t - start_s);
            let (origin, velocity) = at_contact((0.0, v0));
            let lost = if m.from_contact { velocity - v0 } else { 0.0 };
            let at_contact = origin + bent(late.max(start_s));
            timed.map(|(t, x)| x + (speed - lost) * (t - late) + bent(t) - at_contact).collect()
        }
    };
    ObservedWave { measurement: Measurement { first_s: m.first_s - late, ..m }, first, samples, ..wave.clone() }
}

/// Repeats the fit of `model` with inputs drawn again, each from the values found, and reads the percentiles.
///
/// Springs and dampers are proportional to the mass, since a displacement knows only their ratio to it. Without a fit
/// the repetition is left out and not counted. `mass_kg`: the mass that `inputs` speak of. `None` with fewer than 20
/// results.
pub fn propagate(
    model: &Model,
    free: &[FreeParameter],
    observed: &Observation,
    mass_kg: f64,
    inputs: &InputUncertainty,
    repetitions: usize,
) -> Option<Propagation> {
    over_repetitions(mass_kg, inputs, (repetitions, observed.waves.len()), |errors| {
        repeat(model, free, &with_errors(observed, errors)?)
    })
}

/// Fewest results of which percentiles are taken.
const LEAST_REPETITIONS: usize = 20;

/// Percentiles and standard deviations of what `one` gives for the errors of each repetition, in parallel; results do
/// not depend on the number of threads. The error of the mass is relative to `mass_kg`. A name with fewer than 20
/// values is left out.
pub(crate) fn over_repetitions(
    mass_kg: f64,
    inputs: &InputUncertainty,
    (repetitions, sensors): (usize, usize),
    one: impl Fn(&Errors) -> Option<BTreeMap<String, f64>> + Sync,
) -> Option<Propagation> {
    let relative = InputUncertainty { mass_kg: inputs.mass_kg / mass_kg, ..*inputs };
    let results: Vec<Option<BTreeMap<String, f64>>> =
        (0..repetitions).into_par_iter().map(|index| one(&drawn(&relative, index, sensors))).collect();
    let results: Vec<_> = results.into_iter().flatten().collect();
    if results.len() < LEAST_REPETITIONS {
        return None;
    }
    let mut interval_90 = BTreeMap::new();
    let mut standard_deviation = BTreeMap::new();
    // A repetition may lack what the others have, such as a crush.
    let names: BTreeSet<String> = results.iter().flat_map(|values| values.keys().cloned()).collect();
    for name in names {
        let mut values: Vec<f64> = results.iter().filter_map(|f| f.get(&name).copied()).collect();
        if values.len() < LEAST_REPETITIONS {
            continue;
        }
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let power: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        standard_deviation.insert(name.clone(), (power / (values.len() - 1) as f64).sqrt());
        interval_90.insert(name, (percentile(&mut values, 0.05)?, percentile(&mut values, 0.95)?));
    }
    Some(Propagation { repetitions: results.len(), interval_90, standard_deviation })
}

/// The parameters and the model's crush of one repetition.
pub fn repeat(model: &Model, free: &[FreeParameter], repetition: &Repetition) -> Option<BTreeMap<String, f64>> {
    let v0 = repetition.observed.impact_speed_m_per_s;
    // The last knot of a nonlinear damper is the impact speed.
    let mut values = model.values();
    let is_last_knot = |p: &Parameter| p.of_the_test && p.kind == ParameterKind::Rate;
    if let Some(knot) = model.kind().parameters().iter().position(is_last_knot) {
        values[knot] = v0;
    }
    let coordinates = Coordinates::near(model.with_values(&values).ok()?, free);
    let optimum = near(&coordinates, &repetition.observed).follow(&coordinates.start())?;
    let fitted = coordinates.model(&optimum.theta)?;
    let mut result: BTreeMap<String, f64> = BTreeMap::new();
    for (number, x) in coordinates.free.iter().zip(&optimum.theta) {
        let by_mass = matches!(number.kind, ParameterKind::Mass | ParameterKind::Stiffness | ParameterKind::Damping);
        let ratio = if by_mass { repetition.mass_ratio } else { 1.0 };
        result.insert(number.name.to_string(), number.value(*x) * ratio);
    }
    result.extend(coordinates.free_rest(&optimum.theta).map(|(rest, kg)| (rest, kg * repetition.mass_ratio)));
    if let Some(crush) = fitted.events(v0).ok().and_then(|events| events.dynamic_crush_m) {
        result.insert("dynamic_crush_m".to_owned(), crush);
    }
    Some(result)
}
