//! Reads the filtered pulse, integrates it, writes motion, events and metrics.

use std::path::PathBuf;

use crumple_integrate::{Motion, Settings, barrier_force, findings, integrate};
use crumple_metrics::{CrashEvents, Metric, Pulse, centroid_time_from_crush, crash_events, pulse_metrics};
use crumple_signal::{Acceleration, Channel, Notes, QuantityKind, TestDescription};
use crumple_stage::records::{EventsV1, MetricV1, MetricsV1, TestV1};
use crumple_stage::{Inputs, Loaded, Outcome, Output, RefuseExt, Refused, Stage};

use crate::options::{Options, StageSettings};

/// Impact speeds of test and channel further apart than this are worth a word, m/s.
const SPEED_GAP_M_PER_S: f64 = 0.05;

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
        Ok(options.into())
    }

    fn load(paths: &[PathBuf], _: &StageSettings) -> anyhow::Result<Loaded<Inputs>> {
        crumple_stage::load_artifacts(paths)
    }

    fn run(settings: &StageSettings, input: &Inputs, out: &mut Output) -> anyhow::Result<Outcome> {
        let mut test = input.test()?;
        if let Some(id) = &settings.channel {
            if test.channel(id).is_none() {
                return Err(Refused::new(format!("the test has no channel {id:?}"))
                    .hint("crumple-artifact show lists the channels of an artifact")
                    .into());
            }
            test.pulse = Some(id.clone());
        }
        let channel = test.pulse_channel().refuse_with_hint("name the pulse with --channel")?.clone();
        let impact_speed_m_per_s = impact_speed(settings, &test, &channel, out.notes())?;
        // What follows works with the speed the motion was made with.
        test.impact_speed_m_per_s = Some(impact_speed_m_per_s);

        let acceleration = input
            .wave(&channel.id)?
            .signal::<Acceleration>()
            .refuse_with_hint(format!("channel {} is no accelerometer: name one with --channel", channel.id))?;
        let time_zero_s = settings.time_zero_s.unwrap_or(0.0);
        let motion = integrate(
            &acceleration,
            &Settings {
                rule: settings.rule,
                start: settings.start,
                time_zero_s,
                impact_speed_m_per_s,
                low_pass_filtered: channel.cfc.is_some(),
            },
        )
        .refuse_with_hint("--time-zero says where on the record's time axis first contact is")?;
        let events = crash_events(&motion.velocity, &motion.displacement, time_zero_s)?;
        let metrics = pulse_metrics(&Pulse {
            acceleration: &motion.acceleration,
            velocity: &motion.velocity,
            displacement: &motion.displacement,
            events: &events,
            impact_speed_m_per_s,
            mass_kg: test.mass_kg,
            time_zero_s,
        })?;
        out.notes().extend(findings(&motion, &events, time_zero_s, impact_speed_m_per_s));

        out.put("/test", &TestV1::from(&test))?;
        out.put("/events", &events_record(&channel.id, settings, &motion, &events, impact_speed_m_per_s))?;
        out.put("/metrics", &metrics_record(&channel.id, metrics))?;
        out.summary(summary(&channel.id, &events));
        match test.mass_kg {
            Some(mass_kg) => {
                let force = barrier_force(&motion.acceleration, mass_kg)
                    .refuse_with_hint("give the test mass to ingest with --mass")?;
                out.wave(&format!("{}/force", channel.id), QuantityKind::Force, force.into_sampled())?;
            }
            None => out
                .notes()
                .info("the mass is not known: no force, stiffness and energy (give it to ingest with --mass)"),
        }
        out.wave(&format!("{}/velocity", channel.id), QuantityKind::Velocity, motion.velocity.into_sampled())?;
        out.wave(
            &format!("{}/displacement", channel.id),
            QuantityKind::Displacement,
            motion.displacement.into_sampled(),
        )?;
        Ok(Outcome::Done)
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

fn events_record(
    channel: &str,
    settings: &StageSettings,
    motion: &Motion,
    events: &CrashEvents,
    impact_speed_m_per_s: f64,
) -> EventsV1 {
    EventsV1 {
        channel: channel.to_owned(),
        time_zero_s: settings.time_zero_s.unwrap_or(0.0),
        time_zero_rule: if settings.time_zero_s.is_some() { "flag" } else { "file" }.to_owned(),
        dynamic_crush_m: events.crush.map(|crush| crush.displacement_m),
        time_of_dynamic_crush_s: events.crush.map(|crush| crush.time_s),
        centroid_time_s: events.crush.map(|c| centroid_time_from_crush(c.displacement_m, impact_speed_m_per_s)),
        rebound_velocity_m_per_s: events.rebound.map(|rebound| rebound.velocity_m_per_s),
        coefficient_of_restitution: events.restitution(impact_speed_m_per_s),
        delta_v_m_per_s: events.delta_v_m_per_s(impact_speed_m_per_s),
        time_of_rebound_s: events.rebound.map(|rebound| rebound.time_s),
        impact_speed_m_per_s: Some(impact_speed_m_per_s),
        rule: Some(settings.rule.name().to_owned()),
        start: Some(motion.start.name().to_owned()),
    }
}

fn metrics_record(channel: &str, metrics: Vec<Metric>) -> MetricsV1 {
    let record = |metric: Metric| MetricV1 {
        name: metric.name.to_owned(),
        value: metric.value,
        unit: metric.unit.to_owned(),
        channel: channel.to_owned(),
        definition: metric.definition,
    };
    MetricsV1(metrics.into_iter().map(record).collect())
}

fn summary(channel: &str, events: &CrashEvents) -> String {
    match (events.crush, events.rebound) {
        (Some(crush), Some(rebound)) => format!(
            "pulse {channel}: dynamic crush {:.4} m at {:.2} ms, rebound {:.3} m/s",
            crush.displacement_m,
            1e3 * crush.time_s,
            rebound.velocity_m_per_s
        ),
        _ => format!(
            "pulse {channel}: the velocity never reaches zero, {:.3} m/s at the end",
            events.end_velocity_m_per_s
        ),
    }
}
