//! How far the uncertainty of the inputs moves motion, events and metrics: repetitions with perturbed inputs.

use crumple_metrics::{
    CrashEvents, Interval, Metric, Onset, Pulse, PulseImpact, centroid_time_from_crush, crash_events_within,
    definitions, pulse_metrics,
};
use crumple_numerics::estimation::random::EvenPoints;
use crumple_numerics::estimation::statistics::normal_deviate;
use crumple_signal::{
    Acceleration, Distribution, EndCondition, IntegrateError, IntegrationSettings, LateRecord, Motion,
    STANDARD_GRAVITY_M_PER_S2, Signal, Spread, integrate_from, without_drift,
};
use crumple_stage::records::QualityV1;
use rayon::prelude::*;
use serde::Serialize;

// What the uncertainty of the inputs makes of the results: the integration repeated with perturbed inputs.
//
// A quasi Monte Carlo propagation of independent errors of impact speed, zero level, gain and time zero. Not in it:
// misalignment and pitch of the sensor (5° are 0.4 % of the acceleration and 0.09 g), the mass, the filter class
// (0.2 mm of crush), and what another sensor would have read (2.4 % of crush over four channels of one real test).

/// Records with more samples than this are not repeated: the work grows with samples times replicates. 1,048,576
/// samples are 105 s at 10 kHz, far longer than any crash.
pub const MOST_SAMPLES: usize = 1 << 20;

/// An error of the zero level is a velocity after this time at most, s: contacts of vehicles last up to 0.2 s.
const LONGEST_CONTACT_S: f64 = 0.2;

/// Replicates worked on between two reports of progress.
const BLOCK: usize = 64;

/// Uncertainty of the inputs and how it is propagated. An input that is `None` is taken as exact, so an interval with
/// inputs missing is too narrow.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Uncertainty {
    /// Of the impact speed, m/s.
    pub impact_speed_m_per_s: Option<Spread>,
    /// Of the zero level, m/s².
    pub zero_level_m_per_s2: Option<Spread>,
    /// Of the gain, a share of it.
    pub gain: Option<Spread>,
    /// Of contact, s, as the test states it.
    #[serde(skip)]
    pub contact_s: Option<Spread>,
    /// How much earlier a soft front may have touched, s, as the test states it.
    #[serde(skip)]
    pub earlier_by_s: f64,
    /// Samples that may be lost, first and last instant, s, as ingest saw them.
    #[serde(skip)]
    pub lost_s: Option<[f64; 2]>,
    /// What the zero level may have moved by in the impact.
    #[serde(skip)]
    pub zero_shift: Option<ZeroShift>,
    /// Repetitions; a power of two spreads them most evenly.
    pub replicates: usize,
    /// Seed of their places.
    pub seed: u64,
}

/// A level that the record ends with, which the zero level before contact is not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ZeroShift {
    /// The level, m/s².
    pub level_m_per_s2: f64,
    /// When it has come at the latest, s: at the peak.
    pub until_s: f64,
}

/// The inputs of one repetition, as differences from the stated ones.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Perturbation {
    /// Added to the impact speed, m/s.
    pub impact_speed_m_per_s: f64,
    /// Subtracted from the acceleration, m/s².
    pub zero_level_m_per_s2: f64,
    /// The acceleration is multiplied by one more than this.
    pub gain: f64,
    /// How much later contact is, s.
    pub later_s: f64,
    /// Share of what lost samples lack of the line between their neighbours that is added.
    pub refilled: f64,
    /// Share of the shift of the zero level that is taken off.
    pub shifted: f64,
    /// Where the shift begins, a share of the time from contact to the peak.
    pub shifted_from: f64,
    /// How much later the end of the force is, in its standard deviations.
    pub end_of_force: f64,
    /// How much of what a filter can delay the end of the force by it did, a share.
    pub filter_delay: f64,
}

/// Numbers that a perturbation is made of, each from 0 to 1.
const COORDINATES: usize = 10;

/// Shares of a loss or a shift that a replicate takes off: none of it and all of it lie inside the 5 % and 95 %
/// quantiles.
fn share_taken(u: f64) -> f64 {
    1.4 * u - 0.2
}
/// How far beside lost samples a filtered record is read, s: the response of CFC 60 has passed 98 % of a step there.
const BESIDE_S: f64 = 0.005;
/// How late the end of a force is found behind CFC 60 at most, s: made pulses of 60 and 100 ms that end in a jump
/// 3.2 ms, half sines, trapezoids and triangles 0.5 to 1.1, haversines 0.3.
const FILTER_DELAY_S: f64 = 0.0032;
/// So long after the impact a record shows whether the zero level moved: the 20 ms of its end and as many before, s.
const AFTER_IMPACT_S: f64 = 0.040;

impl Uncertainty {
    /// Whether an input is uncertain.
    pub fn is_any(&self) -> bool {
        let inputs = [self.impact_speed_m_per_s, self.zero_level_m_per_s2, self.gain, self.contact_s];
        inputs.into_iter().any(|input| input.is_some())
    }

    /// How far the impact speed may be off, m/s: the half width of a uniform error, two standard deviations of a normal
    /// one (95 %).
    pub fn largest_speed_error_m_per_s(&self) -> f64 {
        largest_error(self.impact_speed_m_per_s)
    }

    /// The inputs of replicate `index`, from a point of its own, so that a replicate does not depend on the others, nor
    /// an input on whether another is uncertain.
    ///
    /// The points are [`EvenPoints`], a coordinate for each input in the order of the fields. Uniform: `size·(2u - 1)`,
    /// so `size` is the half width. Normal: `size` times the deviate below which `u` lies, so `size` is the standard
    /// deviation.
    pub fn perturbation(&self, index: usize) -> Perturbation {
        let point = EvenPoints::seeded(self.seed, COORDINATES).point(index);
        let error = |spread: Option<Spread>, coordinate: usize| {
            let u = point[coordinate];
            spread.map_or(0.0, |Spread { size, distribution }| match distribution {
                Distribution::Uniform => size * (2.0 * u - 1.0),
                Distribution::Normal => size * normal_deviate(u),
            })
        };
        Perturbation {
            impact_speed_m_per_s: error(self.impact_speed_m_per_s, 0),
            zero_level_m_per_s2: error(self.zero_level_m_per_s2, 1),
            gain: error(self.gain, 2),
            later_s: error(self.contact_s, 3) - self.earlier_by_s * none_for_half(point[4]),
            refilled: share_taken(point[5]),
            shifted: share_taken(point[6]),
            shifted_from: none_for_half(point[7]),
            end_of_force: normal_deviate(point[8]),
            filter_delay: share_taken(point[9]),
        }
    }

    /// The same with what ingest saw of the channel: samples that may be lost, and the level at the end of a record
    /// that goes on after its only impact, where that is more than the stated error of the zero level. A drag after the
    /// impact reads like a shift: the intervals hold both.
    pub fn with_quality(self, quality: &QualityV1, events: &CrashEvents, end_s: f64) -> Self {
        // What falls or brakes before contact does so afterwards. A force of 1 g and more is an impact.
        let is_over = |impact: &PulseImpact| impact.is_whole && end_s - impact.end_s >= AFTER_IMPACT_S;
        let only = <&[PulseImpact; 1]>::try_from(events.impacts.as_slice()).ok().map(|[only]| only);
        let impact = only.filter(|impact| quality.rest_level.is_none() && is_over(impact));
        let stated = largest_error(self.zero_level_m_per_s2);
        let level = quality.end_level.filter(|level| (stated..STANDARD_GRAVITY_M_PER_S2).contains(&level.abs()));
        let zero_shift = level
            .zip(impact)
            .map(|(level_m_per_s2, impact)| ZeroShift { level_m_per_s2, until_s: impact.time_of_peak_s });
        Self { lost_s: quality.lost_s(), zero_shift, ..self }
    }

    /// What the losses and the shift of a replicate add to the samples, m/s².
    fn repaired(&self, acceleration: &Signal<Acceleration>, by: &Perturbation) -> Option<Vec<f64>> {
        if self.lost_s.is_none() && self.zero_shift.is_none() {
            return None;
        }
        let mut samples = acceleration.samples().to_vec();
        if let Some([from_s, to_s]) = self.lost_s {
            // A filter has spread the hole to both sides.
            let beside = [from_s - BESIDE_S, to_s + BESIDE_S];
            if let [Some(before), Some(after)] = beside.map(|time_s| acceleration.at(time_s)) {
                let [first, end] = beside.map(|time_s| acceleration.index_at_or_after(time_s));
                for (k, sample) in samples.iter_mut().enumerate().take(end).skip(first) {
                    let part = (acceleration.time_s(k) - beside[0]) / (beside[1] - beside[0]);
                    *sample += by.refilled * (before + part * (after - before) - *sample);
                }
            }
        }
        if let Some(ZeroShift { level_m_per_s2, until_s }) = self.zero_shift {
            let from = acceleration.index_at_or_after(by.shifted_from * until_s);
            samples.iter_mut().skip(from).for_each(|sample| *sample -= by.shifted * level_m_per_s2);
        }
        Some(samples)
    }
}

/// The half width of a uniform error, two standard deviations of a normal one (95 %); 0 where nothing is stated.
fn largest_error(spread: Option<Spread>) -> f64 {
    spread.map_or(0.0, |Spread { size, distribution }| match distribution {
        Distribution::Uniform => size,
        Distribution::Normal => 2.0 * size,
    })
}

/// A share that is none for half of the draws, else any: of the largest lead of a soft front (none: a sensor on what
/// was hit, a stiff front), of the time to the peak after which the zero level moves (none: it moves at contact).
fn none_for_half(u: f64) -> f64 {
    (2.0 * u - 1.0).max(0.0)
}

/// The motion with perturbed inputs: impact speed `v0 + δv0`, acceleration `(1 + δg)·a - δb`, contact δt later. A
/// drift correction (`end`) is made again, so a stated end velocity takes an error of the zero level out.
///
/// Zero level and gain act on the acceleration as it is given: a filter of gain 1 at 0 Hz changes neither. `start` of
/// `settings` must be resolved ([`Motion::start`]), so that a replicate does not begin elsewhere because its time zero
/// leaves the record. A time zero before the record holds the speed until the first sample.
///
/// An error δ of time zero, to first order:
/// - integrated from time zero, the record is cut there: the crush loses v0·δ, and the velocity what the pulse does in
///   δ (nothing for a record at rest before contact, if δ < 0);
/// - integrated from the start of the record, only the label moves for the velocity: rebound, restitution and delta-v
///   stay as they are. The crush counts from the label and loses v0·δ, times lose δ.
///
/// # Errors
/// As of the integration, and where an end condition does not lie in the perturbed motion.
pub fn perturbed(
    acceleration: &Signal<Acceleration>,
    settings: &IntegrationSettings,
    end: Option<EndCondition>,
    by: &Perturbation,
) -> Result<Motion, IntegrateError> {
    let settings = IntegrationSettings {
        impact_speed_m_per_s: settings.impact_speed_m_per_s + by.impact_speed_m_per_s,
        ..*settings
    };
    let shifted = acceleration.starting_at(acceleration.t0_s() - by.later_s)?.into();
    let changed;
    let acceleration: &Signal<Acceleration> = if by.gain == 0.0 && by.zero_level_m_per_s2 == 0.0 {
        &shifted
    } else {
        let (gain, zero_level) = (1.0 + by.gain, by.zero_level_m_per_s2);
        changed = shifted.with_samples(shifted.samples().iter().map(|a| gain * a - zero_level).collect())?;
        &changed
    };
    let integrate = |a: &Signal<Acceleration>| integrate_from(a, &settings, LateRecord::Held, |_| ());
    match end {
        None => integrate(acceleration),
        Some(end) => without_drift(acceleration, &settings, end, integrate).map(|(motion, _)| motion),
    }
}

/// Intervals of everything that is read off a pulse. All four lists are empty where no replicate could be integrated.
#[derive(Debug, Clone, PartialEq)]
pub struct Intervals {
    /// Of the events, in the order of [`EVENT_NAMES`].
    pub events: Vec<Option<Interval>>,
    /// Of the metrics, in the order of [`pulse_metrics`].
    pub metrics: Vec<Option<Interval>>,
    /// How many replicates do not have an event.
    pub without_event: Vec<usize>,
    /// How many replicates do not have a metric.
    pub without_metric: Vec<usize>,
}

/// Events with an interval, as they are called in the record.
pub const EVENT_NAMES: [&str; 7] = [
    "dynamic_crush_m",
    "time_of_dynamic_crush_s",
    "centroid_time_s",
    "rebound_velocity_m_per_s",
    "coefficient_of_restitution",
    "delta_v_m_per_s",
    "time_of_rebound_s",
];

/// The events in the order of [`EVENT_NAMES`], from the impact speed `v0`, m/s: C in m, t_m in s, t_c = C/v0 in s, the
/// rebound velocity v_s in m/s, the restitution -v_s/v0, delta-v = v0 - v_s in m/s and the time of v_s in s, each from
/// time zero. An event that the motion does not show is `None`.
pub fn event_values(events: &CrashEvents, v0: f64) -> [Option<f64>; EVENT_NAMES.len()] {
    [
        events.crush.map(|crush| crush.displacement_m),
        events.crush.map(|crush| crush.time_s),
        events.crush.map(|crush| centroid_time_from_crush(crush.displacement_m, v0)),
        events.rebound.map(|rebound| rebound.velocity_m_per_s),
        events.restitution(v0),
        events.delta_v_m_per_s(v0),
        events.rebound.map(|rebound| rebound.time_s),
    ]
}

/// 5-95 % intervals of events and metrics, from the integration repeated with perturbed inputs.
///
/// Replicates run in parallel and are collected by index: the same intervals for any number of threads. A value that a
/// replicate does not have (no dynamic crush, say) has no interval, and `energy_closure`, a check of the arithmetic,
/// has none. `report` is told how many replicates are done. A quantile of 128 replicates is itself uncertain by less
/// than 0.11 standard deviations of the value, which takes 400 random ones.
///
/// The quantiles are linear between order statistics (type 7 of Hyndman & Fan 1996). The start that the motion used is
/// kept for every replicate. Where a value is linear in one input, a normal distribution of standard deviation σ gives
/// ±1.645·σ and a uniform one of half width h gives ±0.9·h, each times the effect of the input. Cost: one integration
/// with events and metrics for each replicate.
pub fn propagate(
    acceleration: &Signal<Acceleration>,
    motion: &Motion,
    settings: &IntegrationSettings,
    end: Option<EndCondition>,
    mass_kg: Option<f64>,
    uncertainty: &Uncertainty,
    mut report: impl FnMut(u64),
) -> Intervals {
    let settings = IntegrationSettings { start: motion.start.into(), ..*settings };
    let replicate = |index: usize| -> Option<Vec<Option<f64>>> {
        let by = uncertainty.perturbation(index);
        let repaired = uncertainty.repaired(acceleration, &by).map(|samples| acceleration.with_samples(samples));
        let repaired = repaired.transpose().ok()?;
        let last = acceleration.index_at_or_after(LONGEST_CONTACT_S);
        let added_m_per_s = repaired.as_ref().map_or(0.0, |repaired| {
            let pairs = repaired.samples()[..last].iter().zip(acceleration.samples());
            (acceleration.dt_s() * pairs.map(|(with, without)| with - without).sum::<f64>()).abs()
        });
        let motion = perturbed(repaired.as_ref().unwrap_or(acceleration), &settings, end, &by).ok()?;
        let v0 = settings.impact_speed_m_per_s + by.impact_speed_m_per_s;
        // A vehicle that stops without a rebound stops in every replicate: what the errors leave of its velocity, or
        // take off it, is none.
        let lasted_s = motion.velocity.end_s().min(LONGEST_CONTACT_S);
        let left = uncertainty.largest_speed_error_m_per_s()
            + by.impact_speed_m_per_s.abs()
            + by.gain.abs() * v0
            + added_m_per_s
            + by.zero_level_m_per_s2.abs() * lasted_s.max(0.0);
        let events = crash_events_within(&motion.velocity, &motion.displacement, left).ok()?;
        let metrics = pulse_metrics(&Pulse {
            acceleration: &motion.acceleration,
            velocity: &motion.velocity,
            displacement: &motion.displacement,
            events: &events,
            impact_speed_m_per_s: Some(v0),
            mass_kg,
        })
        .ok()?;
        Some(event_values(&events, v0).into_iter().chain(metrics.iter().map(of_metric)).collect())
    };
    let mut replicates: Vec<Option<Vec<Option<f64>>>> = Vec::with_capacity(uncertainty.replicates);
    for first in (0..uncertainty.replicates).step_by(BLOCK) {
        let last = (first + BLOCK).min(uncertainty.replicates);
        replicates.par_extend((first..last).into_par_iter().map(replicate));
        report((last - first) as u64);
    }
    let quantities = replicates.iter().flatten().map(Vec::len).next().unwrap_or(0);
    let interval_of = |quantity: usize| {
        let values: Option<Vec<f64>> = replicates.iter().map(|values| values.as_ref()?[quantity]).collect();
        Interval::of_replicates(values?)
    };
    let mut events: Vec<Option<Interval>> = (0..quantities).map(interval_of).collect();
    let metrics = events.split_off(EVENT_NAMES.len().min(quantities));
    let without = |quantity: usize| {
        replicates.iter().filter(|values| values.as_ref().is_none_or(|values| values[quantity].is_none())).count()
    };
    let mut without_event: Vec<usize> = (0..quantities).map(without).collect();
    let without_metric = without_event.split_off(EVENT_NAMES.len().min(quantities));
    Intervals { events, metrics, without_event, without_metric }
}

/// 5-95 % interval of the way from contact to the end of the force, m: of a motion that starts with the speed of
/// `settings`, over ground. Replicates as in [`propagate`]; the end of the force varies with its own deviation, and is
/// as much earlier as a filter may have moved it. `None` where a replicate does not reach it.
pub fn stroke_interval(
    acceleration: &Signal<Acceleration>,
    settings: &IntegrationSettings,
    end: Option<EndCondition>,
    uncertainty: &Uncertainty,
    end_of_force: &Onset,
) -> Option<Interval> {
    let stroke = |index: usize| -> Option<f64> {
        let by = uncertainty.perturbation(index);
        let motion = perturbed(acceleration, settings, end, &by).ok()?;
        let later_s = by.end_of_force * end_of_force.deviation_s - by.filter_delay * FILTER_DELAY_S - by.later_s;
        motion.displacement.at(end_of_force.time_s + later_s).map(f64::abs)
    };
    let strokes: Option<Vec<f64>> = (0..uncertainty.replicates).into_par_iter().map(stroke).collect();
    Interval::of_replicates(strokes?)
}

/// The value of a metric that gets an interval; the closure of the energy balance checks the arithmetic, not the test.
fn of_metric(metric: &Metric) -> Option<f64> {
    metric.value.filter(|_| metric.id != definitions::CLOSURE.id)
}
