//! Integrates the pulse and other channels and writes their motions.

use std::cell::RefCell;

use crumple_integrate::{Intervals, MOST_SAMPLES, barrier_force, events_of, propagate};
use crumple_metrics::{Pulse, pulse_metrics};
use crumple_signal::{
    About, Acceleration, Channel, Drift, IntegrateError, IntegrationSettings, Motion, Notes, QuantityKind,
    STANDARD_GRAVITY_M_PER_S2, Signal, TestDescription, Weight, integrate_reporting, integrate_without_drift,
};
use crumple_stage::records::ChannelFilterV1;
use crumple_stage::{Inputs, Output, RefuseExt};

use crate::stage::options::StageSettings;
use crate::stage::pulse::integrated::Integrated;

/// A drift larger than this is no drift, m/s² (0.5 g).
const LARGE_DRIFT_M_PER_S2: f64 = 0.5 * STANDARD_GRAVITY_M_PER_S2;

/// Integrates the channels of one test: what holds for all of them.
pub struct ChannelIntegration<'a> {
    pub settings: &'a StageSettings,
    pub input: &'a Inputs,
    pub test: &'a TestDescription,
    /// `None`: not known; the velocity is then its change from time zero.
    pub impact_speed_m_per_s: Option<f64>,
    pub time_zero_s: f64,
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
        let settings = IntegrationSettings {
            rule: self.settings.rule,
            start: self.settings.start,
            time_zero_s: self.time_zero_s,
            impact_speed_m_per_s,
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
        let events = events_of(&motion, self.time_zero_s, impact_speed_m_per_s)?;
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
            let replicates = self.settings.uncertainty.as_ref().map_or(0, |uncertainty| uncertainty.replicates);
            let reason = |without: usize| {
                (without > 0).then(|| {
                    format!("no interval: {without} of {replicates} replicates with perturbed inputs do not have it")
                })
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
        settings: &IntegrationSettings,
        out: &mut Output,
    ) -> Option<Intervals> {
        // An interval of a change of velocity from an unknown speed would have no speed to vary.
        let uncertainty = self.settings.uncertainty.as_ref().filter(|_| self.impact_speed_m_per_s.is_some())?;
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

    /// Writes force, velocity and displacement of a channel.
    pub fn write(&self, id: &str, channel: Integrated, out: &mut Output) -> anyhow::Result<()> {
        if let Some(mass_kg) = self.test.mass_kg {
            let force = barrier_force(&channel.motion.acceleration, mass_kg)
                .refuse_with_hint("give the test mass to ingest with --mass")?;
            out.wave(&format!("{id}/force"), QuantityKind::Force, force.into_sampled())?;
        }
        out.wave(&format!("{id}/velocity"), QuantityKind::Velocity, channel.motion.velocity.into_sampled())?;
        out.wave(&format!("{id}/displacement"), QuantityKind::Displacement, channel.motion.displacement.into_sampled())
    }
}

/// The one thing to do about a channel that cannot be integrated.
fn hint(error: &IntegrateError) -> &'static str {
    match error {
        IntegrateError::ImpactSpeed(_) => "--impact-speed is a speed, 0m/s for a motion from rest",
        _ => "--time-zero says where on the record's time axis first contact is",
    }
}

/// The samples of an accelerometer.
pub fn acceleration(input: &Inputs, channel: &Channel) -> anyhow::Result<Signal<Acceleration>> {
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
        notes.concern(
            About::ImpactSpeed,
            Weight::Decisive,
            format!("{text}: more than a sensor drifts, check impact speed, time zero and gain"),
        );
    }
}
