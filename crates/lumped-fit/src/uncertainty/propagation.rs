//! Uncertain mass, speed, zero level and time zero: the fit repeated with changed inputs.
//!
//! A Monte Carlo propagation after JCGM 101: draw the inputs, change the record as these errors would have, fit
//! again, take percentiles. The errors are those that are the same in the whole record, which no residual shows.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use crumple_lumped::{Model, Nonlinear1, Parameter, ParameterKind};
use crumple_numerics::estimation::random::RandomNumbers;
use crumple_signal::{BeforeEvent, Distribution, Measurement};
use rayon::prelude::*;

use crate::candidate::{Minimum, Propagation};
use crate::closed_form::{elastoplastic_of_record, kelvin_from_events, unloads_rigidly};
use crate::coordinates::Coordinates;
use crate::fit::as_measured::near;
use crate::fit::nonlinear::{descend_to_conditions, parts};
use crate::fit::problem::{Problem, SingleMassFitOptions};
use crate::parameters::FitParameter;
use crate::record::observation::{FEWEST, Observation, ObservedWave};
use crate::record::sensor::FitQuantity;
use crate::uncertainty::assessment::percentile;

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
    /// Of contact, s.
    pub contact_s: f64,
    /// Their distributions, in this order.
    pub distributions: [Distribution; 4],
}

impl InputUncertainty {
    /// Repetitions where no number is asked for: ten of 200 lie beyond each end of a 90 % interval.
    pub const REPETITIONS: usize = 200;

    /// Standard deviations of mass, impact speed, zero level and contact.
    pub fn deviations(&self) -> [f64; 4] {
        let sizes = [self.mass_kg, self.impact_speed_m_per_s, self.bias_m_per_s2, self.contact_s];
        std::array::from_fn(|k| self.distributions[k].deviation(sizes[k]))
    }

    /// Whether anything is uncertain.
    pub fn any(&self) -> bool {
        [self.mass_kg, self.impact_speed_m_per_s, self.bias_m_per_s2, self.contact_s].iter().any(|s| *s > 0.0)
    }
}

/// Seed of the generators; repetition `i` uses its stream `i`.
const SEED: u64 = 2;

/// A test with the errors of one repetition.
#[derive(Debug, Clone)]
pub struct Repetition {
    /// The record with another speed, zero level and time zero.
    pub observed: Observation,
    /// Mass over the mass stated.
    pub mass_ratio: f64,
}

impl Repetition {
    /// The inputs of repetition `index`: four numbers from its own stream of a fixed seed.
    ///
    /// Another impact speed adds `δv t` to the displacement `t` after contact, another zero level `δb (t - t_start)²/2`
    /// less what that is at contact, since the integration starts at `t_start`: at contact, or at the first sample;
    /// another time zero moves the label of contact, with the displacement made zero again there and, where the
    /// integration starts at contact, the velocity made the impact speed.
    pub fn drawn(observed: &Observation, inputs: &InputUncertainty, index: usize) -> Option<Self> {
        with_errors(observed, &drawn(inputs, index, observed.waves.len()))
    }

    /// The record with a mass ratio `1 + mass` (relative), `speed` faster, `bias` higher and its contact `late` later.
    ///
    /// `None` where the later contact leaves fewer than 12 samples of the window.
    pub fn perturbed(observed: &Observation, mass: f64, speed: f64, bias: f64, late: f64) -> Option<Self> {
        with_errors(observed, &Errors { mass, speed_m_per_s: speed, late_s: late, bias_m_per_s2: vec![bias] })
    }

    /// The parameters and the model's crush of one repetition.
    pub fn fit(&self, model: &Model, free: &[FitParameter]) -> Option<BTreeMap<String, f64>> {
        let v0 = self.observed.impact_speed_m_per_s;
        // The last knot of a nonlinear damper is the impact speed.
        let mut values = model.values();
        let is_last_knot = |p: &Parameter| p.of_the_test && p.kind == ParameterKind::Rate;
        if let Some(knot) = model.kind().parameters().iter().position(is_last_knot) {
            values[knot] = v0;
        }
        let coordinates = Coordinates::near(model.with_values(&values).ok()?, free.to_vec());
        let optimum = near(&coordinates, &self.observed).follow(&coordinates.start())?;
        let fitted = coordinates.model(&optimum.theta)?;
        let mut result: BTreeMap<String, f64> = BTreeMap::new();
        for (number, x) in coordinates.free.iter().zip(&optimum.theta) {
            let by_mass =
                matches!(number.kind, ParameterKind::Mass | ParameterKind::Stiffness | ParameterKind::Damping);
            let ratio = if by_mass { self.mass_ratio } else { 1.0 };
            result.insert(number.name.to_string(), number.value(*x) * ratio);
        }
        result.extend(coordinates.free_rest(&optimum.theta).map(|(rest, kg)| (rest, kg * self.mass_ratio)));
        if let Some(crush) = fitted.events(v0).ok().and_then(|events| events.dynamic_crush_m) {
            result.insert("dynamic_crush_m".to_owned(), crush);
        }
        Some(result)
    }
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
            Distribution::Normal => random.normal().clamp(-distribution.largest(), distribution.largest()),
            Distribution::Uniform => 2.0 * random.uniform() - 1.0,
        }
    };
    let [of_mass, of_speed, of_bias, of_zero] = inputs.distributions;
    let mass = draw(inputs.mass_kg, of_mass);
    let speed_m_per_s = draw(inputs.impact_speed_m_per_s, of_speed);
    let bias = draw(inputs.bias_m_per_s2, of_bias);
    let late_s = draw(inputs.contact_s, of_zero);
    let others = (1..sensors).map(|_| draw(inputs.bias_m_per_s2, of_bias));
    let bias_m_per_s2 = std::iter::once(bias).chain(others).collect();
    Errors { mass, speed_m_per_s, late_s, bias_m_per_s2 }
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
    // Value at a time of the old axis.
    let moved: Box<dyn Fn(f64, f64) -> f64> = match wave.quantity {
        FitQuantity::Acceleration => Box::new(|_, a| a + bias),
        // Load cells have a zero level of their own, which is taken off before the filter.
        FitQuantity::Force => Box::new(|_, force| force),
        FitQuantity::Velocity => {
            let lost = if m.from_contact { at_contact((v0, 0.0)).0 - v0 } else { 0.0 };
            Box::new(move |t, v| v - lost + speed + bias * (t - start_s))
        }
        FitQuantity::Displacement => {
            // Another speed moves the vehicle from contact on, another zero level what is integrated.
            let bent = move |t: f64| 0.5 * bias * (t - start_s) * (t - start_s);
            let (origin, velocity) = at_contact((0.0, v0));
            let lost = if m.from_contact { velocity - v0 } else { 0.0 };
            let at_contact = origin + bent(late.max(start_s));
            Box::new(move |t, x| x + (speed - lost) * (t - late) + bent(t) - at_contact)
        }
    };
    let samples = x.iter().enumerate().map(|(k, x)| moved(m.time_s(first + k * wave.stride), *x)).collect();
    let record = Arc::new(wave.record.moved(late, moved));
    let before_event = m.before_event.map(|quiet| BeforeEvent { from_s: quiet.from_s - late, ..quiet });
    let measurement = Measurement { first_s: m.first_s - late, before_event, ..m };
    ObservedWave { measurement, first, samples, record, ..wave.clone() }
}

/// Repeats the fit of `model` with inputs drawn again, each from the values found, and reads the percentiles.
///
/// Springs and dampers are proportional to the mass, since a displacement knows only their ratio to it. Without a fit
/// the repetition is left out and not counted. `mass_kg`: the mass that `inputs` speak of. `None` with fewer than 20
/// results.
pub fn propagate(
    model: &Model,
    free: &[FitParameter],
    observed: &Observation,
    mass_kg: f64,
    inputs: &InputUncertainty,
    repetitions: usize,
) -> Option<Propagation> {
    over_repetitions(mass_kg, inputs, (repetitions, observed.waves.len()), |errors| {
        with_errors(observed, errors)?.fit(model, free)
    })
}

impl Minimum {
    /// As [`propagate`] for a chain as it was stated, where not all springs and dampers need to be free.
    ///
    /// An uncertain mass is that of the test: where a mass is the rest of the total, the rest takes the difference;
    /// where none is, all masses change by the same share. Numbers that are given stay, so springs are proportional to
    /// the mass only where all of them are free. The weights of the waves stay those of the fit.
    pub fn propagate_chain(&self, mass_kg: f64, inputs: &InputUncertainty, repetitions: usize) -> Option<Propagation> {
        let (coordinates, observed) = (self.coordinates(), &self.observed);
        let theta = coordinates.start();
        over_repetitions(mass_kg, inputs, (repetitions, observed.waves.len()), |errors: &Errors| {
            let Repetition { observed, mass_ratio } = with_errors(observed, errors)?;
            repeat_chain(&coordinates.of_mass(mass_ratio), &observed, &theta, mass_ratio)
        })
    }
}

/// Fits one repetition, from the minimum scaled to the mass drawn.
///
/// Gives the value of every free number, in its unit, and `dynamic_crush_m` of the compartment where the chain stops.
/// `None` without a finite response.
fn repeat_chain(
    coordinates: &Coordinates,
    waves: &Observation,
    theta: &[f64],
    mass_ratio: f64,
) -> Option<BTreeMap<String, f64>> {
    // Without a rest everything is a share of the mass; with one the free masses alone, so that something is
    // left for it.
    let of_mass = |i: usize| coordinates.rest.is_none() || coordinates.free[i].kind == ParameterKind::Mass;
    let by = |i: usize| if of_mass(i) { mass_ratio.ln() } else { 0.0 };
    let start: Vec<f64> = theta.iter().enumerate().map(|(i, x)| x + by(i)).collect();
    let minimum = near(coordinates, waves).follow(&start)?;
    let free =
        coordinates.free.iter().zip(&minimum.theta).map(|(number, x)| (number.name.to_string(), number.value(*x)));
    let mut values: BTreeMap<String, f64> = free.chain(coordinates.free_rest(&minimum.theta)).collect();
    let events = coordinates.model(&minimum.theta)?.events(waves.impact_speed_m_per_s).ok();
    if let Some(crush) = events.and_then(|events| events.dynamic_crush_m) {
        values.insert("dynamic_crush_m".to_owned(), crush);
    }
    Some(values)
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

/// The events that a closed form follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FollowedEvents {
    /// Time of dynamic crush, s after contact.
    pub time_of_dynamic_crush_s: f64,
    /// Dynamic crush, m.
    pub dynamic_crush_m: f64,
    /// Coefficient of restitution; 0 without rebound.
    pub coefficient_of_restitution: f64,
}

impl FollowedEvents {
    /// The events of a displacement that is compared at every sample from contact to its end; `None` if it never stops.
    ///
    /// Velocities are differences between samples, which for a displacement summed by trapezoids are means of two
    /// samples of the velocity; their first zero and their minimum after it. Off by `O(dt²)`: only changes of the
    /// events are taken from here.
    pub fn of(record: &Observation) -> Option<Self> {
        let wave = record.waves.first()?;
        let dt = wave.measurement.dt_s * wave.stride as f64;
        let x = &wave.samples;
        let speed = |k: usize| (x[k + 1] - x[k]) / dt;
        let stop = (1..x.len().checked_sub(1)?).find(|&k| speed(k) <= 0.0 && speed(k - 1) > 0.0)?;
        let (before, after) = (speed(stop - 1), speed(stop));
        // From the middle before sample `stop` to the middle after it.
        let share = before / (before - after);
        let time_of_dynamic_crush_s = wave.time_s(stop) + (share - 0.5) * dt;
        // The parabola through the three samples.
        let mean = 0.5 * (before + after);
        let dynamic_crush_m = x[stop] + 0.5 * mean * mean * dt / (before - after);
        let lowest = (stop..x.len() - 1).map(speed).fold(after, f64::min);
        Some(Self {
            time_of_dynamic_crush_s,
            dynamic_crush_m,
            coefficient_of_restitution: -lowest / record.impact_speed_m_per_s,
        })
    }

    /// What uncertain inputs do to a model that follows these events: the first nonlinear model under its conditions at
    /// dynamic crush, Kelvin and elastoplastic model by their closed forms. `observed`: the samples compared; `whole`:
    /// every sample from contact to the end; `mass_kg`: the mass that the uncertainty of the mass refers to.
    ///
    /// `None` for another model, or with fewer than 20 results.
    pub fn propagate(
        &self,
        model: &Model,
        (observed, whole): (&Observation, &Observation),
        mass_kg: f64,
        inputs: &InputUncertainty,
        repetitions: usize,
    ) -> Option<Propagation> {
        match model {
            Model::Nonlinear1(model) => {
                propagate_conditioned(model, self, (observed, whole), mass_kg, inputs, repetitions)
            }
            _ => propagate_closed_form(model, self, whole, mass_kg, inputs, repetitions),
        }
    }

    /// These events moved as far as those of `record` moved to those of `moved`.
    pub fn moved(&self, record: &Observation, moved: &Observation) -> Option<Self> {
        let (from, to) = (Self::of(record)?, Self::of(moved)?);
        let restitution = to.coefficient_of_restitution - from.coefficient_of_restitution;
        Some(Self {
            time_of_dynamic_crush_s: self.time_of_dynamic_crush_s + to.time_of_dynamic_crush_s
                - from.time_of_dynamic_crush_s,
            dynamic_crush_m: self.dynamic_crush_m + to.dynamic_crush_m - from.dynamic_crush_m,
            coefficient_of_restitution: self.coefficient_of_restitution + restitution,
        })
    }
}

/// Applies the closed form of `model` to events that uncertain inputs change, many times, and takes percentiles.
///
/// Each repetition draws mass, speed, zero level and time zero, changes the record accordingly, reads its events and
/// solves by the same formula: Kelvin from crush and its time, elastoplastic from crush and restitution. Only the
/// change of the events is taken from the record, see [`FollowedEvents::moved`]. `events`: those of the test;
/// `whole`: every sample from contact to the end; `mass_kg`: the mass that the uncertainty of the mass refers to. A
/// repetition without a solution is not counted.
///
/// `None` for a model without a closed form, or with fewer than 20 results.
fn propagate_closed_form(
    model: &Model,
    events: &FollowedEvents,
    whole: &Observation,
    mass_kg: f64,
    inputs: &InputUncertainty,
    repetitions: usize,
) -> Option<Propagation> {
    over_repetitions(mass_kg, inputs, (repetitions, 1), |errors| {
        let repetition = with_errors(whole, errors)?;
        repeat_closed_form(model, &events.moved(whole, &repetition.observed)?, &repetition)
    })
}

/// The parameters and the model's crush that the closed form gives for these events.
fn repeat_closed_form(
    model: &Model,
    events: &FollowedEvents,
    repetition: &Repetition,
) -> Option<BTreeMap<String, f64>> {
    let v0 = repetition.observed.impact_speed_m_per_s;
    let crush = events.dynamic_crush_m;
    let solved = match model {
        Model::Kelvin(m) => {
            let mass = m.mass_kg * repetition.mass_ratio;
            Model::Kelvin(kelvin_from_events(mass, v0, events.time_of_dynamic_crush_s, crush).ok()?.model)
        }
        Model::Elastoplastic(m) => {
            let mass = m.mass_kg * repetition.mass_ratio;
            let restitution = events.coefficient_of_restitution;
            Model::Elastoplastic(elastoplastic_of_record(mass, v0, crush, restitution).ok()?.0)
        }
        _ => return None,
    };
    let values = solved.parameters();
    let but_masses = solved.kind().parameters().iter().filter(|p| p.kind != ParameterKind::Mass);
    let mut result: BTreeMap<String, f64> = but_masses.map(|p| (p.name.to_owned(), values[p.name])).collect();
    if matches!(model, Model::Elastoplastic(m) if unloads_rigidly(m)) {
        // A stand-in, and no number of the record.
        result.remove("unloading_stiffness_n_per_m");
    }
    if let Some(crush) = solved.events(v0).ok().and_then(|events| events.dynamic_crush_m) {
        result.insert("dynamic_crush_m".to_owned(), crush);
    }
    Some(result)
}

/// Relative decrease of the cost that is worth another step.
const COST_TOLERANCE: f64 = 1e-7;
/// Relative violation of the conditions on crush and speed at which they are met.
const MET: f64 = 1e-8;

/// Repeats the fit of the first nonlinear model under `k1 <= k2`, `c1 >= c2 >= c3`, `x(t_m) = C` and `v(t_m) = 0`
/// with uncertain inputs, and takes percentiles.
///
/// The estimator of [`SingleMassFitOptions::fit_nonlinear1`]: crush, its time and the last knots are those of each
/// repetition's record, and the displacement is compared without the filter. Every repetition descends from `model`.
/// With time zero more than 0.25 ms off, another start of the fit could win: the spread is then that of one minimum
/// and too small.
///
/// `events`, `whole`: as for [`propagate_closed_form`]; `observed`: the samples
/// compared. A repetition that cannot meet the conditions is not counted. `None` with fewer than 20 results.
fn propagate_conditioned(
    model: &Nonlinear1,
    events: &FollowedEvents,
    (observed, whole): (&Observation, &Observation),
    mass_kg: f64,
    inputs: &InputUncertainty,
    repetitions: usize,
) -> Option<Propagation> {
    over_repetitions(mass_kg, inputs, (repetitions, 1), |errors| {
        let moved = events.moved(whole, &with_errors(whole, errors)?.observed)?;
        repeat_conditioned(model, &moved, &with_errors(observed, errors)?)
    })
}

/// One repetition: the parameters scaled to the mass drawn, and the dynamic crush of the model, m. `None` where the
/// conditions are not met.
fn repeat_conditioned(
    model: &Nonlinear1,
    events: &FollowedEvents,
    repetition: &Repetition,
) -> Option<BTreeMap<String, f64>> {
    let record = repetition.observed.waves.first()?;
    let v0 = repetition.observed.impact_speed_m_per_s;
    let options = SingleMassFitOptions {
        mass_kg: model.mass_kg,
        impact_speed_m_per_s: v0,
        crush_m: events.dynamic_crush_m,
        time_of_dynamic_crush_s: events.time_of_dynamic_crush_s,
        from_s: record.time_s(0),
        to_s: None,
        samples: record.samples.len(),
    };
    let (coordinates, observed) = (parts(&options), repetition.observed.clone().exact());
    let start = coordinates.coordinates_of(&Model::Nonlinear1(*model));
    let problem = Problem { unit: options.crush_m, ..Problem::new(&coordinates, &observed, 0.0) };
    let (end, _, met) = descend_to_conditions(&problem, &options, &start, (COST_TOLERANCE, MET))?;
    let fitted = coordinates.model(&end.theta).filter(|_| met)?;
    let values = fitted.parameters();
    let free = fitted.kind().parameters().iter().filter(|p| !(p.of_the_test || p.kind == ParameterKind::Mass));
    let scaled = |p: &Parameter| {
        let ratio = if p.kind == ParameterKind::Rate { 1.0 } else { repetition.mass_ratio };
        (p.name.to_owned(), values[p.name] * ratio)
    };
    let mut result: BTreeMap<String, f64> = free.map(scaled).collect();
    if let Some(crush) = fitted.events(v0).ok().and_then(|events| events.dynamic_crush_m) {
        result.insert("dynamic_crush_m".to_owned(), crush);
    }
    Some(result)
}
