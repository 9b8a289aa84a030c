//! Reads the filtered pulse, integrates it, writes motion, events and metrics.

mod criteria;
mod options;
mod pulse;
mod without_motion;

use std::cell::RefCell;
use std::path::PathBuf;

use crumple_integrate::{
    Drift, IntegrateError, Intervals, MOST_SAMPLES, Motion, Settings, WRONG_SIGN, barrier_force, events_of, findings,
    integrate_reporting, integrate_without_drift, propagate, wrong_sign,
};
use crumple_metrics::{CrashEvents, Interval, Metric, Pulse, pulse_metrics};
use crumple_signal::{
    Acceleration, Channel, Notes, QuantityKind, STANDARD_GRAVITY_M_PER_S2, Severity, Signal, TestDescription, part_of,
};
use crumple_stage::records::{ChannelFilterV1, MetricsV1, TestV1};
use crumple_stage::{Inputs, Loaded, Outcome, Output, RefuseExt, Refused, Stage};

use crate::stage::criteria::load_cells;
use crate::stage::criteria::occupants_and_roadside::Criteria;
use crate::stage::criteria::recorder::recorded_changes;
use crate::stage::options::flags::{Options, StageSettings};
use crate::stage::options::uncertainty::uncertainty_note;
use crate::stage::pulse::channel_agreement::Redundant;
use crate::stage::pulse::other_channels::{further, meant};
use crate::stage::pulse::records::{events_record, metric_records};
use crate::stage::pulse::time_zero::time_zero;
use crate::stage::without_motion::{lacking, without_motion};

/// Impact speeds of test and channel further apart than this are worth a word, m/s.
const SPEED_GAP_M_PER_S: f64 = 0.05;
/// A drift larger than this is no drift, m/s² (0.5 g).
const LARGE_DRIFT_M_PER_S2: f64 = 0.5 * STANDARD_GRAVITY_M_PER_S2;

/// The stage.
pub struct Integrate;

impl Stage for Integrate {
    const NAME: &'static str = "integrate";
    const ABOUT: &'static str = "Integrates the crash pulse to velocity and displacement, finds dynamic crush and rebound, \
         and computes crash metrics.";
    type Options = Options;
    type Settings = StageSettings;
    type Input = Inputs;

    fn resolve(options: Options) -> anyhow::Result<StageSettings> {
        Ok(options.try_into()?)
    }

    fn load(paths: &[PathBuf], _: &StageSettings) -> anyhow::Result<Loaded<Inputs>> {
        crumple_stage::load_artifacts(paths)
    }

    fn run(settings: &StageSettings, input: &Inputs, out: &mut Output) -> anyhow::Result<Outcome> {
        let mut test = input.test()?;
        if let Some(id) = &settings.channel {
            let pulse = match meant(&test, id, "channel", input)?.as_slice() {
                [one] => one.clone(),
                several => {
                    return Err(Refused::new(format!("channel {id:?} means several channels: {}", several.join(", ")))
                        .expected("one channel as the crash pulse")
                        .hint("give the id of one of them")
                        .into());
                }
            };
            test.pulse = Some(pulse);
        }
        let channel = test.pulse_channel().refuse_with_hint("name the pulse with --channel")?.clone();
        let speed = settings.impact_speed_m_per_s.or(test.impact_speed_m_per_s);
        if let Some(lacking) = lacking(input, &test, &channel, speed) {
            return without_motion(settings, input, &test, &channel, lacking, out);
        }
        if input.wave_if(&channel.id).is_none() && input.artifacts().iter().any(|a| a.stage() == Some("filter")) {
            return Err(Refused::new(format!("the filtered record does not hold the pulse, channel {}", channel.id))
                .hint(format!(
                    "crumple-filter --channels leaves out what it does not name: name {} there too, or another pulse with --channel here",
                    channel.id
                ))
                .into());
        }
        let impact_speed_m_per_s = impact_speed(settings, &test, &channel, out.notes())?;
        // What follows works with the speed the motion was made with.
        test.impact_speed_m_per_s = Some(impact_speed_m_per_s);

        let acceleration = acceleration(input, &channel)?;
        let zero = time_zero(settings, input, &test, &channel, &acceleration, impact_speed_m_per_s, out.notes())?;
        let task = Task { settings, input, test: &test, impact_speed_m_per_s, time_zero_s: zero.time_s };
        let pulse = task.motion(&channel, &acceleration, out)?;
        let found = findings(&pulse.motion, &pulse.events, zero.time_s, impact_speed_m_per_s);
        if wrong_sign(&pulse.motion.velocity, zero.time_s, impact_speed_m_per_s) {
            // First, because most of what else is said follows from it.
            let before = std::mem::replace(out.notes(), found);
            out.notes().extend(before);
        } else {
            out.notes().extend(found);
        }
        not_of_the_vehicle(&channel, out.notes());
        if let Some(uncertainty) = &settings.uncertainty {
            out.notes().info(uncertainty_note(uncertainty, pulse.motion.start));
        }
        let mut metrics = metric_records(&channel.id, &pulse, zero.time_s);
        let mut redundant = Redundant::new(&channel, &pulse, zero.time_s);

        out.put("/test", &TestV1::from(&test))?;
        out.put("/events", &events_record(&channel.id, settings, &zero, &pulse, impact_speed_m_per_s))?;
        out.summary(summary(&channel.id, &pulse, zero.time_s, impact_speed_m_per_s));

        for other in further(&settings.channels, &test, &channel.id, input, out.notes())? {
            let motion = task.motion(other, &self::acceleration(input, other)?, out)?;
            // Taken with all the others, of a place that nobody names: that it moves with the vehicle must show.
            let unnamed =
                !settings.channels.iter().any(|name| test.channels_meant(name).iter().any(|c| c.id == other.id));
            if unnamed && unplaced(other) && !redundant.agrees(&motion) {
                out.notes().warning(format!(
                    "channel {} does not move as the pulse does, and nothing says where it sits: not held against the vehicle (if it \
                     is of the compartment, name it: crumple-integrate --channels all,{})",
                    other.id, other.id
                ));
                continue;
            }
            for note in findings(&motion.motion, &motion.events, zero.time_s, impact_speed_m_per_s).iter() {
                if note.severity == Severity::Warning {
                    out.notes().warning(format!("channel {}: {}", other.id, note.text));
                }
            }
            metrics.extend(metric_records(&other.id, &motion, zero.time_s));
            not_of_the_vehicle(other, out.notes());
            redundant.compare(other, &motion, out.notes());
            task.write(&other.id, motion, out)?;
        }
        metrics.extend(redundant.spread(out));
        let against = load_cells::Pulse {
            id: &channel.id,
            motion: &pulse.motion,
            time_zero_s: zero.time_s,
            separation_s: pulse.events.rebound.map(|rebound| zero.time_s + rebound.time_s),
        };
        metrics.extend(load_cells::barrier(settings.barrier_cells, input, &test, &against, out)?);
        let criteria = Criteria {
            settings,
            input,
            test: &test,
            pulse: &channel,
            time_zero_s: zero.time_s,
            impact_speed_m_per_s: Some(impact_speed_m_per_s),
        };
        metrics.extend(criteria.records(out)?);
        metrics.extend(recorded_changes(input, &test, zero.time_s, out));
        out.put("/metrics", &MetricsV1(metrics))?;
        if test.mass_kg.is_none() {
            out.notes().info("the mass is not known: no force, stiffness and energy (give it to ingest with --mass)");
        }
        task.write(&channel.id, pulse, out)?;
        Ok(Outcome::Done)
    }
}

/// What holds for all channels of a test.
struct Task<'a> {
    settings: &'a StageSettings,
    input: &'a Inputs,
    test: &'a TestDescription,
    impact_speed_m_per_s: f64,
    time_zero_s: f64,
}

/// What came of a channel.
pub struct Integrated {
    pub motion: Motion,
    pub events: CrashEvents,
    pub metrics: Vec<Metric>,
    pub drift: Option<Drift>,
    /// Of the events, in the order of [`EVENT_NAMES`](crumple_integrate::EVENT_NAMES); empty if nothing is uncertain.
    pub event_intervals: Vec<Option<Interval>>,
    /// Why an event has none, in the same order.
    pub events_without: Vec<Option<String>>,
    /// Why a metric has none, in the order of the metrics.
    pub metrics_without: Vec<Option<String>>,
}

impl Task<'_> {
    fn motion(
        &self,
        channel: &Channel,
        acceleration: &Signal<Acceleration>,
        out: &mut Output,
    ) -> anyhow::Result<Integrated> {
        let settings = Settings {
            rule: self.settings.rule,
            start: self.settings.start,
            time_zero_s: self.time_zero_s,
            impact_speed_m_per_s: self.impact_speed_m_per_s,
            low_pass_filtered: channel.cfc.is_some() || smoothed(self.input, &channel.id)?,
        };
        let (motion, drift) = match self.settings.end_condition {
            None => {
                let progress = RefCell::new(out.progress("integrating", acceleration.len() as u64));
                let report = |amount| progress.borrow_mut().advance(amount);
                let motion = integrate_reporting(acceleration, &settings, report);
                let hint = motion.as_ref().err().map_or("", hint);
                (motion.refuse_with_hint(hint)?, None)
            }
            Some(end) => {
                let (motion, drift) = integrate_without_drift(acceleration, &settings, end)
                    .refuse_with_hint("--end-time says when the velocity is the one known")?;
                note_drift(&channel.id, &drift, end.velocity_m_per_s, out.notes());
                (motion, Some(drift))
            }
        };
        let events = events_of(&motion, self.time_zero_s, self.impact_speed_m_per_s)?;
        let mut metrics = pulse_metrics(&Pulse {
            acceleration: &motion.acceleration,
            velocity: &motion.velocity,
            displacement: &motion.displacement,
            events: &events,
            impact_speed_m_per_s: self.impact_speed_m_per_s,
            mass_kg: self.test.mass_kg,
            time_zero_s: self.time_zero_s,
        })?;
        let (mut event_intervals, mut events_without, mut metrics_without) = (Vec::new(), Vec::new(), Vec::new());
        if let Some(intervals) = self.intervals(acceleration, &motion, &settings, out) {
            for (metric, interval) in metrics.iter_mut().zip(intervals.metrics) {
                metric.interval = interval.filter(|_| metric.value.is_some());
            }
            event_intervals = intervals.events;
            let of = self.settings.uncertainty.as_ref().map_or(0, |uncertainty| uncertainty.replicates);
            let reason = |without: usize| {
                (without > 0)
                    .then(|| format!("no interval: {without} of {of} replicates with perturbed inputs do not have it"))
            };
            events_without = intervals.without_event.into_iter().map(reason).collect();
            metrics_without = intervals.without_metric.into_iter().map(reason).collect();
        }
        Ok(Integrated { motion, events, metrics, drift, event_intervals, events_without, metrics_without })
    }

    /// Intervals from repetitions with perturbed inputs, where inputs are uncertain.
    fn intervals(
        &self,
        acceleration: &Signal<Acceleration>,
        motion: &Motion,
        settings: &Settings,
        out: &mut Output,
    ) -> Option<Intervals> {
        let uncertainty = self.settings.uncertainty.as_ref()?;
        if acceleration.len() > MOST_SAMPLES {
            out.notes().warning(format!(
                "no intervals: {} samples, the integration is repeated for records of up to {MOST_SAMPLES}",
                acceleration.len()
            ));
            return None;
        }
        let mut progress = out.progress("repeating with perturbed inputs", uncertainty.replicates as u64);
        let (end, mass_kg) = (self.settings.end_condition, self.test.mass_kg);
        Some(propagate(acceleration, motion, settings, end, mass_kg, uncertainty, |done| progress.advance(done)))
    }

    fn write(&self, id: &str, of: Integrated, out: &mut Output) -> anyhow::Result<()> {
        if let Some(mass_kg) = self.test.mass_kg {
            let force = barrier_force(&of.motion.acceleration, mass_kg)
                .refuse_with_hint("give the test mass to ingest with --mass")?;
            out.wave(&format!("{id}/force"), QuantityKind::Force, force.into_sampled())?;
        }
        out.wave(&format!("{id}/velocity"), QuantityKind::Velocity, of.motion.velocity.into_sampled())?;
        out.wave(&format!("{id}/displacement"), QuantityKind::Displacement, of.motion.displacement.into_sampled())
    }
}

/// The one thing to do about a channel that cannot be integrated.
fn hint(error: &IntegrateError) -> &'static str {
    match error {
        IntegrateError::ImpactSpeed(_) => "--impact-speed is a speed, 0m/s for a motion from rest",
        _ => "--time-zero says where on the record's time axis first contact is",
    }
}

/// Warns of vehicle metrics of what is no part of the vehicle.
fn not_of_the_vehicle(channel: &Channel, notes: &mut Notes) {
    if !channel.may_be_on_vehicle() || part_of(channel).is_some() {
        let location = if channel.location.is_empty() { "an occupant" } else { &channel.location };
        notes.warning(format!(
            "channel {} is not of the vehicle ({location}): its dynamic crush, restitution, energies and pulse indices are \
             those of the sensor, not of the vehicle",
            channel.id
        ));
    }
}

/// Whether neither a location nor a code says where a channel sits.
fn unplaced(channel: &Channel) -> bool {
    channel.location.trim().is_empty() && channel.code.is_none()
}

fn acceleration(input: &Inputs, channel: &Channel) -> anyhow::Result<Signal<Acceleration>> {
    input
        .wave(&channel.id)?
        .signal::<Acceleration>()
        .refuse_with_hint(format!("channel {} is no accelerometer: name one with --channel", channel.id))
}

/// Whether a channel without a class went through a phaseless low-pass all the same.
fn smoothed(input: &Inputs, id: &str) -> anyhow::Result<bool> {
    let filter: Option<ChannelFilterV1> = input.record_if(&format!("/filter/{id}"))?;
    Ok(filter.is_some_and(|filter| {
        filter.phase.as_deref() == Some("zero") && matches!(filter.mode.as_str(), "butterworth-low" | "moving-average")
    }))
}

fn note_drift(id: &str, drift: &Drift, stated_m_per_s: f64, notes: &mut Notes) {
    let text = format!(
        "channel {id}: drift of {:+.4} m/s^2 ({:+.5} g, {}) taken out so that the velocity at {:.1} ms is {:.3} m/s \
         as stated; without it {:+.3} m/s more",
        drift.acceleration_m_per_s2,
        drift.acceleration_m_per_s2 / STANDARD_GRAVITY_M_PER_S2,
        drift.shape.name(),
        1e3 * drift.time_s,
        stated_m_per_s,
        drift.velocity_gap_m_per_s
    );
    if drift.acceleration_m_per_s2.abs() <= LARGE_DRIFT_M_PER_S2 {
        notes.info(text);
    } else {
        notes.warning(format!("{text}: more than a sensor drifts, check impact speed, time zero and gain"));
    }
}

/// The speed of the flag, else of the test; never the channel's own, which is only held against it.
fn impact_speed(
    settings: &StageSettings,
    test: &TestDescription,
    channel: &Channel,
    notes: &mut Notes,
) -> anyhow::Result<f64> {
    let speed = settings.impact_speed_m_per_s.or(test.impact_speed_m_per_s).ok_or_else(|| {
        Refused::new("the test description has no impact speed")
            .expected("the speed just before contact; the accelerometer cannot tell it")
            .hint("give it with --impact-speed, e.g. --impact-speed 35km/h, here or to ingest")
    })?;
    if let (Some(_), Some(of_test)) = (settings.impact_speed_m_per_s, test.impact_speed_m_per_s)
        && of_test != speed
    {
        notes.info(format!("impact speed {speed} m/s as asked for, the test description says {of_test} m/s"));
    }
    if let Some(of_channel) = channel.initial_velocity_m_per_s
        && (of_channel.abs() - speed).abs() > SPEED_GAP_M_PER_S
    {
        notes.warning(format!(
            "channel {} states an initial velocity of {of_channel:.3} m/s, the impact speed is {speed:.3} m/s",
            channel.id
        ));
    }
    Ok(speed)
}

fn summary(channel: &str, pulse: &Integrated, time_zero_s: f64, impact_speed_m_per_s: f64) -> String {
    if impact_speed_m_per_s == 0.0 {
        let change = pulse.events.end_velocity_m_per_s;
        return format!("pulse {channel}: from rest, change of velocity {change:.3} m/s at the end, no crash events");
    }
    if wrong_sign(&pulse.motion.velocity, time_zero_s, impact_speed_m_per_s) {
        return format!("pulse {channel}: no crash events, {WRONG_SIGN}");
    }
    match (pulse.events.crush, pulse.events.rebound) {
        (Some(crush), Some(rebound)) => {
            let interval = pulse.event_intervals.first().copied().flatten();
            let interval = interval.map_or_else(String::new, |i| format!(" ({:.3} to {:.3} m)", i.low, i.high));
            format!(
                "pulse {channel}: dynamic crush {:.4} m{interval} at {:.2} ms, rebound {:.3} m/s",
                crush.displacement_m,
                1e3 * crush.time_s,
                rebound.velocity_m_per_s
            )
        }
        _ => {
            let end = pulse.events.end_velocity_m_per_s;
            let change = pulse.events.unstopped.map_or_else(String::new, |unstopped| {
                format!(
                    ", delta-v {:.3} m/s at {:.1} ms (event ends at {:.1} ms: {})",
                    impact_speed_m_per_s - unstopped.velocity_m_per_s,
                    1e3 * unstopped.time_s,
                    1e3 * unstopped.end_s,
                    unstopped.end.name()
                )
            });
            format!("pulse {channel}: the velocity never reaches zero, {end:.3} m/s at the end{change}")
        }
    }
}
