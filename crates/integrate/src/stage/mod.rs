//! The program: reads the filtered pulse, integrates it, writes motion, events and metrics.

pub mod channels;
mod collision;
mod criteria;
pub mod integration;
pub mod occupants_and_roadside;
mod options;
mod pulse_shape;
pub mod records;
mod without_impact;

use std::path::PathBuf;

use crumple_metrics::{Measured, first_event};
use crumple_signal::{
    About, Channel, Kind, Overlap, QuantityKind, TestDescription, Weight, is_mass_of_a_vehicle, remarks,
};
use crumple_stage::records::MetricsV2;
use crumple_stage::{Inputs, LeftOut, Loaded, Outcome, Output, RefuseExt, Refused, Stage, flag, option};

use crate::events;
use crate::stage::channels::{ChannelAgreement, channels_named, integrate_others};
use crate::stage::collision::{missing_for_motion, of_one_vehicle, other_vehicle, vehicles, without_motion};
use crate::stage::criteria::recorded_changes;
use crate::stage::integration::{ChannelIntegration, acceleration, impact_speed};
use crate::stage::occupants_and_roadside::Criteria;
use crate::stage::options::{Options, StageSettings};
use crate::stage::pulse_shape::{pulse_shape, sled_pulse};
use crate::stage::records::{
    SpeedRule, events_record, metric_records, note_findings, note_impacts, summary, warn_unless_of_the_vehicle,
};
use crate::stage::without_impact::{is_pushed, without_impact};

/// The stage.
pub struct Integrate;

impl Stage for Integrate {
    const NAME: &'static str = "integrate";
    const BUILD: &'static str = env!("CRUMPLE_BUILD");
    const ABOUT: &'static str = "Integrates the crash pulse to velocity and displacement, finds dynamic crush and \
        rebound, and computes crash metrics.";
    const LEFT_OUT: &'static [LeftOut] = options::LEFT_OUT;
    const REMARKS: &'static [&'static [&'static Kind]] = &[
        events::REMARKS,
        pulse_shape::REMARKS,
        options::REMARKS,
        criteria::remarks::REMARKS,
        channels::REMARKS,
        integration::REMARKS,
        occupants_and_roadside::remarks::REMARKS,
        records::REMARKS,
        REMARKS,
        collision::REMARKS,
    ];

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
        if let Some(name) = &settings.channel {
            test.pulse = Some(pulse_named(name, &test, input)?);
        }
        let channel = test
            .pulse_channel()
            .refuse_with_hint(format!("name the pulse with {}", flag("ingest", "channel")))?
            .clone();
        let speed = settings.impact_speed_m_per_s.or(test.impact_speed_m_per_s);
        if let Some(missing) = missing_for_motion(input, &test, &channel, speed) {
            return without_motion(settings, input, &test, &channel, missing, out);
        }
        refuse_left_out(&channel, input)?;
        let is_of_a_structure = speed.is_some_and(|speed| speed != 0.0) && test.has_structure();
        if !is_of_a_structure || is_pushed(input, &test, (&channel, speed))? {
            return without_impact(settings, input, &test, (&channel, speed), out);
        }
        let impact_speed_m_per_s = impact_speed(settings, &test, &channel, out.notes())?;
        // What follows works with the speed the motion was made with.
        test.impact_speed_m_per_s = Some(impact_speed_m_per_s);

        let samples = acceleration(input, &channel)?;
        let rule = test.contact.as_ref().map_or_else(|| "file".to_owned(), |contact| contact.rule.clone());
        let task = ChannelIntegration {
            settings,
            input,
            test: &test,
            impact_speed_m_per_s: Some(impact_speed_m_per_s),
            change_from_m_per_s: Some(0.0),
            most_replicates: usize::MAX,
        };
        let pulse = task.integrate(&channel, &samples, out)?;
        let vehicles = vehicles(input)?;
        // A partner that gives way leaves speed: the collision is assessed below.
        let is_as_read = settings.impact_speed_m_per_s.is_none() && settings.channel.is_none();
        let is_a_vehicle = test.mass_kg.is_none_or(is_mass_of_a_vehicle);
        let is_recorder = test.channels.iter().any(|channel| channel.quantity == QuantityKind::VelocityChange);
        let speed_rule = match vehicles.is_empty() && is_a_vehicle {
            false => SpeedRule::None,
            // What a recorder's car met is not known to have stopped it.
            true if test.overlap == Some(Overlap::Glancing) || is_recorder => SpeedRule::MayBeLeft,
            true if test.exchange_asked && is_as_read => SpeedRule::AskedBefore,
            true => SpeedRule::New,
        };
        note_findings(&pulse, impact_speed_m_per_s, speed_rule, out.notes());
        note_impacts(&pulse.events.impacts, out);
        warn_unless_of_the_vehicle(&channel, out.notes());
        if let Some(uncertainty) = &pulse.uncertainty {
            out.notes().push(options::uncertainty_note(uncertainty, Some(pulse.motion.start)));
        }
        let mut metrics = metric_records(&channel.id, &pulse);
        metrics.extend(pulse_shape(&channel.id, &pulse, out));
        let impacts = &pulse.events.impacts;
        let measured = Measured {
            change_m_per_s: -pulse.events.delta_v_m_per_s(impact_speed_m_per_s).unwrap_or(impact_speed_m_per_s),
            is_whole: first_event(impacts).is_some_and(|k| impacts[k].is_whole),
            speed_m_per_s: Some(impact_speed_m_per_s),
            stroke_m: pulse.events.crush.map(|crush| crush.displacement_m),
        };
        metrics.extend(sled_pulse(settings.corridor, &channel, &pulse, measured, out));
        let mut others = ChannelAgreement::new(&channel, &pulse);

        out.put("/test", &input.test_with_samples(&test))?;
        out.put("/events", &events_record(&channel.id, settings, &rule, &pulse, impact_speed_m_per_s))?;
        out.summary(summary(&channel.id, &pulse, impact_speed_m_per_s));

        let own_test = of_one_vehicle(&test, &vehicles, &channel.id);
        let own_task = ChannelIntegration { test: &own_test, ..task };
        metrics.extend(integrate_others(&own_task, &channel, &mut others, out)?);
        metrics.extend(other_vehicle(&task, &vehicles, &channel, (impact_speed_m_per_s, &pulse.motion.velocity), out)?);
        metrics.extend(others.spread(out));
        let against = criteria::Pulse {
            id: &channel.id,
            motion: &pulse.motion,
            separation_s: pulse.events.rebound.map(|rebound| rebound.time_s),
        };
        metrics.extend(criteria::barrier(settings, input, &test, &against, out)?);
        metrics.extend(criteria::in_the_plane(input, &own_test, &channel, &against)?);
        let criteria = Criteria {
            settings,
            input,
            test: &test,
            pulse: &channel,
            impact_speed_m_per_s: Some(impact_speed_m_per_s),
        };
        metrics.extend(criteria.records(out)?);
        metrics.extend(criteria.crush_stiffness(out.notes())?);
        metrics.extend(recorded_changes(input, &test, out));
        out.put("/metrics", &MetricsV2 { metrics })?;
        if test.mass_kg.is_none() {
            out.notes().push(MassUnknown {});
        }
        task.write(&channel.id, pulse, out)?;
        Ok(Outcome::Done)
    }
}

/// The id of the one channel that `--channel` means.
fn pulse_named(name: &str, test: &TestDescription, input: &Inputs) -> anyhow::Result<String> {
    match channels_named(test, name, "channel", input)?.as_slice() {
        [id] => Ok(id.clone()),
        several => Err(Refused::new(format!("channel {name:?} means several channels: {}", several.join(", ")))
            .expected("one channel as the crash pulse")
            .hint("give the id of one of them")
            .into()),
    }
}

/// Refuses a pulse that the filter left out.
fn refuse_left_out(pulse: &Channel, input: &Inputs) -> anyhow::Result<()> {
    if input.wave_if(&pulse.id).is_some() || input.artifacts().iter().all(|a| a.stage() != Some("filter")) {
        return Ok(());
    }
    Err(Refused::new(format!("the filtered record does not hold the pulse, channel {}", pulse.id))
        .hint(format!(
            "{} leaves out what it does not name: name {} there too, or another pulse as channel of integrate",
            option("filter", "channels", "ID"),
            pulse.id
        ))
        .into())
}

remarks! {
    /// Remarks of the stage.
    REMARKS;

    /// The mass of the vehicle is not known.
    CR363 MassUnknown {}
    bears on (About::Mass, Weight::None)
    decided "Neither the file nor --mass at ingest states the mass."
    means "There is no force, no stiffness and no energy. Velocity, crush and restitution need no mass."
    remedy "state it: --mass 1200kg at ingest"
    says "the mass is not known: no force, stiffness and energy (give it to ingest with --mass)";
}
