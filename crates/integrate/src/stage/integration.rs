//! Integration of one channel: its impact speed, its motion.

use std::cell::RefCell;

use crate::{Intervals, MOST_SAMPLES, Uncertainty, barrier_force, events_within, propagate};
use crumple_metrics::{CrashEvents, Interval, Metric, Pulse, pulse_metrics};
use crumple_signal::{
    About, Acceleration, Channel, Drift, EndCondition, IntegrateError, IntegrationSettings, IntegrationStart, KnownEnd,
    Motion, Notes, QuantityKind, STANDARD_GRAVITY_M_PER_S2, Sampled, Signal, TestDescription, Velocity, Weight,
    integrate_reporting, integrate_without_drift, remarks,
};
use crumple_stage::records::{ChannelFilterV1, QualityV1};
use crumple_stage::{Inputs, Output, RefuseExt, Refused, flag, option};

use crate::stage::options::StageSettings;

/// A channel that was integrated.
pub struct Integrated {
    pub motion: Motion,
    pub events: CrashEvents,
    pub metrics: Vec<Metric>,
    pub drift: Option<Drift>,
    /// What the intervals rest on; `None`: nothing is uncertain.
    pub uncertainty: Option<Uncertainty>,
    /// Of the events, in the order of [`EVENT_NAMES`](crate::EVENT_NAMES); empty if nothing is uncertain.
    pub event_intervals: Vec<Option<Interval>>,
    /// Why an event has none, in the same order.
    pub events_without: Vec<Option<String>>,
    /// Why a metric has none, in the order of the metrics.
    pub metrics_without: Vec<Option<String>>,
}

/// Impact speeds of test and channel that differ by more than this get a warning, m/s.
const SPEED_GAP_M_PER_S: f64 = 0.05;

/// The speed of the flag, else of the test; never the channel's own, which is only held against it.
pub fn impact_speed(
    settings: &StageSettings,
    test: &TestDescription,
    channel: &Channel,
    notes: &mut Notes,
) -> anyhow::Result<f64> {
    let speed = settings.impact_speed_m_per_s.or(test.impact_speed_m_per_s).ok_or_else(|| {
        Refused::new("the test description has no impact speed")
            .expected("the speed just before contact; the accelerometer cannot tell it")
            .hint(format!("state it: {}", option("ingest", "impact-speed", "35km/h")))
    })?;
    if let (Some(_), Some(of_test)) = (settings.impact_speed_m_per_s, test.impact_speed_m_per_s)
        && of_test != speed
    {
        notes.push(SpeedAsAsked { impact_speed_m_per_s: speed, of_test_m_per_s: of_test });
    }
    if let Some(of_channel) = channel.initial_velocity_m_per_s
        && (of_channel.abs() - speed).abs() > SPEED_GAP_M_PER_S
    {
        notes.push(SpeedOfChannelDiffers {
            channel: channel.id.clone(),
            of_channel_m_per_s: of_channel,
            impact_speed_m_per_s: speed,
        });
    }
    Ok(speed)
}

/// `start = auto` begins no earlier before contact, s: what the zero level is read from. A low-pass filter brings a
/// pulse 10 ms forward, and an error of the zero level would act on the velocity for as long as the record leads.
const LONGEST_LEAD_S: f64 = 0.05;

/// A drift larger than this is no drift, m/s² (0.5 g).
const LARGE_DRIFT_M_PER_S2: f64 = 0.5 * STANDARD_GRAVITY_M_PER_S2;

/// Integrates the channels of one test: what holds for all of them.
pub struct ChannelIntegration<'a> {
    pub settings: &'a StageSettings,
    pub input: &'a Inputs,
    pub test: &'a TestDescription,
    /// `None`: not known, or nothing has an impact; the velocity is then its change from time zero.
    pub impact_speed_m_per_s: Option<f64>,
    /// Of a change of velocity the velocity that it starts from, if that is known; 0 of an impact.
    pub change_from_m_per_s: Option<f64>,
    /// Replicates that the intervals of a channel are read from, at most.
    pub most_replicates: usize,
}

impl ChannelIntegration<'_> {
    /// Motion, events and metrics of a channel, with intervals where inputs are uncertain.
    pub fn integrate(
        &self,
        channel: &Channel,
        acceleration: &Signal<Acceleration>,
        out: &mut Output,
    ) -> anyhow::Result<Integrated> {
        let impact_speed_m_per_s = self.impact_speed_m_per_s.unwrap_or(0.0);
        let near = (self.settings.start == IntegrationStart::Auto && acceleration.t0_s() < -LONGEST_LEAD_S)
            .then(|| acceleration.slice(acceleration.index_at_or_after(-LONGEST_LEAD_S), acceleration.len()).into());
        let acceleration = near.as_ref().unwrap_or(acceleration);
        let settings = IntegrationSettings {
            rule: self.settings.rule,
            start: self.settings.start,
            impact_speed_m_per_s,
            low_pass_filtered: channel.cfc.is_some() || smoothed(self.input, &channel.id)?,
        };
        let end = self.end_condition(acceleration);
        let (motion, drift) = match end {
            None => {
                let progress = RefCell::new(out.progress("integrating", acceleration.len() as u64));
                let report = |amount| progress.borrow_mut().advance(amount);
                let motion = integrate_reporting(acceleration, &settings, report);
                let hint = motion.as_ref().err().map_or_else(String::new, hint);
                (motion.refuse_with_hint(hint)?, None)
            }
            Some(end) => {
                let (motion, drift) = integrate_without_drift(acceleration, &settings, end).refuse_with_hint(
                    format!("{} says when the velocity is the one known", flag("integrate", "end-time")),
                )?;
                let stated = self.settings.end_condition.unwrap_or(end).known;
                note_drift(&channel.id, &drift, stated, out.notes());
                (motion, Some(drift))
            }
        };
        let speed_error = self.settings.uncertainty.as_ref().map_or(0.0, Uncertainty::largest_speed_error_m_per_s);
        let events = events_within(&motion, impact_speed_m_per_s, speed_error)?;
        let mut metrics = pulse_metrics(&Pulse {
            acceleration: &motion.acceleration,
            velocity: &motion.velocity,
            displacement: &motion.displacement,
            events: &events,
            impact_speed_m_per_s: self.impact_speed_m_per_s,
            mass_kg: self.test.mass_kg,
        })?;
        let (mut event_intervals, mut events_without, mut metrics_without) = (Vec::new(), Vec::new(), Vec::new());
        let uncertainty = self.uncertainty(&channel.id, &events, acceleration.end_s())?;
        if let Some(intervals) = self.intervals(acceleration, &motion, &settings, uncertainty.as_ref(), out) {
            for (metric, interval) in metrics.iter_mut().zip(intervals.metrics) {
                metric.interval = metric.value.zip(interval).map(|(value, interval)| interval.holding(value));
            }
            event_intervals = intervals.events;
            let replicates = self.settings.uncertainty.as_ref().map_or(0, |uncertainty| uncertainty.replicates);
            let replicates = replicates.min(self.most_replicates);
            let reason = |without: usize| {
                (without > 0).then(|| {
                    format!("no interval: {without} of {replicates} replicates with perturbed inputs do not have it")
                })
            };
            events_without = intervals.without_event.into_iter().map(reason).collect();
            metrics_without = intervals.without_metric.into_iter().map(reason).collect();
        }
        Ok(Integrated { motion, events, metrics, drift, uncertainty, event_intervals, events_without, metrics_without })
    }

    /// What is known at the end, as the motion is integrated: of a change of velocity without what the speed at contact
    /// does.
    fn end_condition(&self, acceleration: &Signal<Acceleration>) -> Option<EndCondition> {
        let end = self.settings.end_condition?;
        let from = self.change_from_m_per_s.unwrap_or(0.0);
        let known = match end.known {
            KnownEnd::Velocity(velocity) => KnownEnd::Velocity(velocity - from),
            KnownEnd::Displacement(way) => {
                // At the sample that the condition is met at.
                let asked_s = end.time_s.unwrap_or(acceleration.end_s());
                let met_s = acceleration.time_s(acceleration.index_at_or_after(asked_s));
                KnownEnd::Displacement(way - from * met_s)
            }
        };
        Some(EndCondition { known, ..end })
    }

    /// The uncertainty of the inputs: that of the options, that of contact as the test states it, and what ingest saw
    /// of the channel. `None` where nothing is uncertain.
    fn uncertainty(&self, id: &str, events: &CrashEvents, end_s: f64) -> anyhow::Result<Option<Uncertainty>> {
        let Some(stated) = self.settings.uncertainty.clone() else { return Ok(None) };
        // A simulation has no sensor: contact alone is uncertain, between two of its states.
        let is_simulated = self.test.source.is_simulated();
        let stated =
            if is_simulated { Uncertainty { zero_level_m_per_s2: None, gain: None, ..stated } } else { stated };
        let contact = self.test.contact.as_ref();
        let contact_s = contact.and_then(|contact| contact.uncertainty_s);
        let earlier_by_s = contact.map_or(0.0, |contact| contact.earlier_by_s);
        // A change of velocity, from an unknown speed or from rest, has no speed to vary.
        let has_speed = self.impact_speed_m_per_s.is_some_and(|speed| speed > 0.0) && !is_simulated;
        let impact_speed_m_per_s = stated.impact_speed_m_per_s.filter(|_| has_speed);
        let stated = Uncertainty { impact_speed_m_per_s, contact_s, earlier_by_s, ..stated };
        let quality = self.input.record_if::<QualityV1>(&format!("/quality/{id}"))?;
        let all = match quality {
            Some(quality) if !is_simulated => stated.with_quality(&quality, events, end_s),
            _ => stated,
        };
        Ok(Some(all).filter(Uncertainty::is_any))
    }

    /// Intervals from repetitions with perturbed inputs, where inputs are uncertain.
    fn intervals(
        &self,
        acceleration: &Signal<Acceleration>,
        motion: &Motion,
        settings: &IntegrationSettings,
        uncertainty: Option<&Uncertainty>,
        out: &mut Output,
    ) -> Option<Intervals> {
        let stated = uncertainty?.clone();
        let uncertainty = &Uncertainty { replicates: stated.replicates.min(self.most_replicates), ..stated };
        if acceleration.len() > MOST_SAMPLES {
            out.notes().push(TooLongForIntervals { samples: acceleration.len(), most_samples: MOST_SAMPLES });
            return None;
        }
        let mut progress = out.progress("repeating with perturbed inputs", uncertainty.replicates as u64);
        let (end, mass_kg) = (self.end_condition(acceleration), self.test.mass_kg);
        Some(propagate(acceleration, motion, settings, end, mass_kg, uncertainty, |done| progress.advance(done)))
    }

    /// Writes force, velocity and displacement of a channel; of a change of velocity that, and velocity and
    /// displacement where the speed at contact is known.
    pub fn write(&self, id: &str, channel: Integrated, out: &mut Output) -> anyhow::Result<()> {
        if self.impact_speed_m_per_s.is_none_or(|speed| speed == 0.0) {
            if let Some((velocity, displacement)) = self.over_ground(&channel.motion)? {
                out.wave(&format!("{id}/velocity"), QuantityKind::Velocity, velocity.into_sampled())?;
                out.wave(&format!("{id}/displacement"), QuantityKind::Displacement, displacement)?;
            }
            let change = channel.motion.velocity.into_sampled();
            return out.wave(&format!("{id}/velocity_change"), QuantityKind::VelocityChange, change);
        }
        if let Some(mass_kg) = self.test.mass_kg {
            let force = barrier_force(&channel.motion.acceleration, mass_kg)
                .refuse_with_hint(format!("state the test mass: {}", option("ingest", "mass", "873kg")))?;
            out.wave(&format!("{id}/force"), QuantityKind::Force, force.into_sampled())?;
        }
        out.wave(&format!("{id}/velocity"), QuantityKind::Velocity, channel.motion.velocity.into_sampled())?;
        out.wave(&format!("{id}/displacement"), QuantityKind::Displacement, channel.motion.displacement.into_sampled())
    }
}

impl ChannelIntegration<'_> {
    /// Velocity and displacement of what was integrated as a change, where the speed at contact is known.
    pub fn over_ground(&self, motion: &Motion) -> anyhow::Result<Option<(Signal<Velocity>, Sampled)>> {
        let Some(from) = self.change_from_m_per_s else { return Ok(None) };
        let (v, x) = (&motion.velocity, &motion.displacement);
        let velocity = v.with_samples(v.samples().iter().map(|change| from + change).collect())?;
        let times = (0..x.len()).map(|k| x.time_s(k));
        let way = x.samples().iter().zip(times).map(|(way, t)| way + from * t).collect();
        Ok(Some((velocity, Sampled::new(x.t0_s(), x.dt_s(), way)?)))
    }
}

/// The one thing to do about a channel that cannot be integrated.
fn hint(error: &IntegrateError) -> String {
    match error {
        IntegrateError::ImpactSpeed(_) => {
            format!("{} is right for a motion from rest", option("integrate", "impact-speed", "0m/s"))
        }
        _ => format!("{} says where on the file's time axis first contact is", flag("ingest", "time-zero")),
    }
}

/// The samples of an accelerometer.
pub fn acceleration(input: &Inputs, channel: &Channel) -> anyhow::Result<Signal<Acceleration>> {
    input.wave(&channel.id)?.signal::<Acceleration>().refuse_with_hint(format!(
        "channel {} is no accelerometer: name one with {}",
        channel.id,
        flag("integrate", "channel")
    ))
}

/// Whether a channel without a class went through a phaseless low-pass all the same.
fn smoothed(input: &Inputs, id: &str) -> anyhow::Result<bool> {
    let filter: Option<ChannelFilterV1> = input.record_if(&format!("/filter/{id}"))?;
    Ok(filter.is_some_and(|filter| {
        filter.phase.as_deref() == Some("zero") && matches!(filter.mode.as_str(), "butterworth-low" | "moving-average")
    }))
}

fn note_drift(id: &str, drift: &Drift, stated: KnownEnd, notes: &mut Notes) {
    let (channel, shape, time_s, gap) = (id.to_owned(), drift.shape.name().to_owned(), drift.time_s, drift.gap);
    let drift_m_per_s2 = drift.acceleration_m_per_s2;
    let (velocity_m_per_s, displacement_m) = match stated {
        KnownEnd::Velocity(velocity) => (Some(velocity), None),
        KnownEnd::Displacement(way) => (None, Some(way)),
    };
    let velocity_gap_m_per_s = velocity_m_per_s.map(|_| gap);
    let displacement_gap_m = displacement_m.map(|_| gap);
    if drift_m_per_s2.abs() <= LARGE_DRIFT_M_PER_S2 {
        notes.push(DriftTakenOut {
            channel,
            drift_m_per_s2,
            shape,
            time_s,
            velocity_m_per_s,
            velocity_gap_m_per_s,
            displacement_m,
            displacement_gap_m,
        });
    } else {
        notes.push(LargeDrift {
            channel,
            drift_m_per_s2,
            shape,
            time_s,
            velocity_m_per_s,
            velocity_gap_m_per_s,
            displacement_m,
            displacement_gap_m,
        });
    }
}

/// A drift in words; `known` is the end that is stated, and by how much the motion with the drift differs from it.
fn drift_in_words(channel: &str, drift_m_per_s2: f64, shape: &str, known: &str) -> String {
    format!(
        "channel {channel}: drift of {drift_m_per_s2:+.4} m/s^2 ({:+.5} g, {shape}) taken out so that {known}",
        drift_m_per_s2 / STANDARD_GRAVITY_M_PER_S2
    )
}

/// What is known of the end: a velocity, m/s, or a displacement, m, each with the gap to it.
fn known_end(time_s: f64, velocity: Option<(f64, f64)>, displacement: Option<(f64, f64)>) -> String {
    let at_ms = 1e3 * time_s;
    match (velocity, displacement) {
        (Some((velocity, gap)), _) => {
            format!("the velocity at {at_ms:.1} ms is {velocity:.3} m/s as stated; without it {gap:+.3} m/s more")
        }
        (None, of_way) => {
            let (way, gap) = of_way.unwrap_or_default();
            format!(
                "the displacement at {at_ms:.1} ms is {:.1} mm as stated; without it {:+.1} mm more",
                1e3 * way,
                1e3 * gap
            )
        }
    }
}

remarks! {
    /// Remarks of the integration of a channel.
    pub REMARKS;

    /// The impact speed is another one than the test states.
    CR347 SpeedAsAsked { impact_speed_m_per_s: f64, of_test_m_per_s: f64 }
    bears on (About::ImpactSpeed, Weight::None)
    decided "integrate.impact_speed is given, and the test description has another speed."
    means "Velocity, crush, energy and every later stage use the speed that was asked for."
    remedy "nothing; leave integrate.impact_speed out to use the speed of the test"
    says format!(
        "impact speed {impact_speed_m_per_s} m/s as asked for, the test description says {of_test_m_per_s} m/s"
    );

    /// The channel states another initial velocity than the impact speed.
    CR348 SpeedOfChannelDiffers { channel: String, of_channel_m_per_s: f64, impact_speed_m_per_s: f64 }
    bears on (About::ImpactSpeed, Weight::Marked)
    decided "Both magnitudes are compared; more than 0.05 m/s apart is named. The speed of the channel is never used."
    means "One of the two is wrong: crush and energy change with the impact speed."
    remedy "look up which speed was measured, and state it: --impact-speed at ingest"
    says format!(
        "channel {channel} states an initial velocity of {of_channel_m_per_s:.3} m/s, the impact speed is \
         {impact_speed_m_per_s:.3} m/s"
    );

    /// The record is too long for intervals.
    CR349 TooLongForIntervals { samples: usize, most_samples: usize }
    bears on (About::Motion, Weight::Slight)
    decided "The integration is repeated for records of up to 1048576 samples: 105 s at 10 kHz, far longer than a \
             crash."
    means "Events and metrics have no intervals. The values are the same."
    remedy "cut the record to the crash, or bring it to a lower rate: filter.resample"
    says format!(
        "no intervals: {samples} samples, the integration is repeated for records of up to {most_samples}"
    );

    /// A drift was taken out, so that the motion ends as it is known to.
    CR350 DriftTakenOut {
        channel: String, drift_m_per_s2: f64, shape: String, time_s: f64, velocity_m_per_s: Option<f64>,
        velocity_gap_m_per_s: Option<f64>, displacement_m: Option<f64>, displacement_gap_m: Option<f64>
    }
    bears on (About::Motion, Weight::None)
    decided "integrate.end_velocity or integrate.end_displacement states the end. A constant zero level, or one that \
             grows, is what meets it; up to 0.5 g it counts as drift of a sensor."
    means "Velocity and crush are those without the drift. /metrics has it as drift_correction."
    remedy "nothing"
    says drift_in_words(
        channel,
        *drift_m_per_s2,
        shape,
        &known_end(*time_s, velocity_m_per_s.zip(*velocity_gap_m_per_s), displacement_m.zip(*displacement_gap_m)),
    );

    /// A drift was taken out that is larger than sensors have.
    CR351 LargeDrift {
        channel: String, drift_m_per_s2: f64, shape: String, time_s: f64, velocity_m_per_s: Option<f64>,
        velocity_gap_m_per_s: Option<f64>, displacement_m: Option<f64>, displacement_gap_m: Option<f64>
    }
    bears on (About::ImpactSpeed, Weight::Decisive)
    decided "The drift that meets the stated end is more than 0.5 g."
    means "Impact speed, time zero, gain or the stated end is wrong, and the correction hides it: do not use the crush."
    remedy "check impact speed, time zero, gain and the stated end"
    says {
        let known =
            known_end(*time_s, velocity_m_per_s.zip(*velocity_gap_m_per_s), displacement_m.zip(*displacement_gap_m));
        drift_in_words(channel, *drift_m_per_s2, shape, &known)
            + ": more than a sensor drifts, check impact speed, time zero and gain"
    };
}
