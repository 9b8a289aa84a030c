//! The program: reads the filtered pulse, integrates it, writes motion, events and metrics.

pub mod channels;
mod collision;
mod criteria;
pub mod integration;
pub mod occupants_and_roadside;
mod options;
pub mod records;

use std::path::PathBuf;

use crumple_signal::{About, Channel, Sampled, TestDescription, Weight};
use crumple_stage::records::{MetricV1, MetricsV2, TestV1};
use crumple_stage::{Inputs, LeftOut, Loaded, Outcome, Output, RefuseExt, Refused, Stage, flag, option};

use crate::stage::channels::{ChannelAgreement, channels_named, other_channels};
use crate::stage::collision::{
    is_pushed, missing_for_motion, of_one_vehicle, other_vehicle, vehicles, without_impact, without_motion,
};
use crate::stage::criteria::recorded_changes;
use crate::stage::integration::{ChannelIntegration, acceleration, impact_speed};
use crate::stage::occupants_and_roadside::Criteria;
use crate::stage::options::{Options, StageSettings};
use crate::stage::records::{
    SpeedRule, events_record, metric_records, note_findings, note_impacts, note_warnings, summary,
    warn_unless_of_the_vehicle,
};

/// The stage.
pub struct Integrate;

impl Stage for Integrate {
    const NAME: &'static str = "integrate";
    const BUILD: &'static str = env!("CRUMPLE_BUILD");
    const ABOUT: &'static str = "Integrates the crash pulse to velocity and displacement, finds dynamic crush and \
        rebound, and computes crash metrics.";
    const LEFT_OUT: &'static [LeftOut] = options::LEFT_OUT;

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
        if speed.is_none_or(|speed| speed == 0.0) || is_pushed(settings, input, &test, (&channel, speed))? {
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
            most_replicates: usize::MAX,
        };
        let pulse = task.integrate(&channel, &samples, out)?;
        let vehicles = vehicles(input)?;
        // A partner that gives way leaves speed: the collision is assessed below.
        let is_as_read = settings.impact_speed_m_per_s.is_none() && settings.channel.is_none();
        let speed_rule = match vehicles.is_empty() {
            false => SpeedRule::Partner,
            true if test.exchange_asked && is_as_read => SpeedRule::AskedBefore,
            true => SpeedRule::New,
        };
        note_findings(&pulse, impact_speed_m_per_s, speed_rule, out.notes());
        note_impacts(&pulse.events.impacts, out);
        warn_unless_of_the_vehicle(&channel, out.notes());
        if let Some(uncertainty) = &pulse.uncertainty {
            out.notes().info(options::uncertainty_note(uncertainty, pulse.motion.start));
        }
        let mut metrics = metric_records(&channel.id, &pulse);
        let mut others = ChannelAgreement::new(&channel, &pulse);

        out.put("/test", &TestV1::from(&test))?;
        out.put("/events", &events_record(&channel.id, settings, &rule, &pulse, impact_speed_m_per_s))?;
        out.summary(summary(&channel.id, &pulse, impact_speed_m_per_s));

        let own_test = of_one_vehicle(&test, &vehicles, &channel.id);
        let own_task = ChannelIntegration { test: &own_test, ..task };
        metrics.extend(integrate_others(&own_task, &channel, &mut others, out)?);
        metrics.extend(other_vehicle(&task, &vehicles, &channel, &pulse, out)?);
        metrics.extend(others.spread(out));
        let against = criteria::Pulse {
            id: &channel.id,
            motion: &pulse.motion,
            separation_s: pulse.events.rebound.map(|rebound| rebound.time_s),
        };
        metrics.extend(criteria::barrier(settings.barrier_cells, input, &test, &against, out)?);
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
            out.notes().info("the mass is not known: no force, stiffness and energy (give it to ingest with --mass)");
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

/// Channels beside the pulse that have all replicates asked for; more of them share those of so many.
const WITH_ALL_REPLICATES: usize = 60;
/// Replicates of each of them at least: a quantile of 50 is itself uncertain by a third of a standard deviation.
const LEAST_REPLICATES: usize = 50;

/// Replicates for each of so many channels beside the pulse, so that the work on them is bounded.
fn replicates_of_others(asked: usize, channels: usize) -> usize {
    let shared = asked.saturating_mul(WITH_ALL_REPLICATES) / channels.max(WITH_ALL_REPLICATES);
    shared.max(LEAST_REPLICATES).min(asked)
}

/// Integrates and writes the channels beside the pulse and compares them with it; returns their metrics.
fn integrate_others(
    task: &ChannelIntegration<'_>,
    pulse: &Channel,
    others: &mut ChannelAgreement<'_>,
    out: &mut Output,
) -> anyhow::Result<Vec<MetricV1>> {
    let ChannelIntegration { settings, input, test, .. } = *task;
    let impact_speed_m_per_s = task.impact_speed_m_per_s.unwrap_or(0.0);
    let mut metrics = Vec::new();
    let channels = other_channels(&settings.channels, test, &pulse.id, input, out.notes())?;
    let asked = settings.uncertainty.as_ref().map_or(0, |uncertainty| uncertainty.replicates);
    let most_replicates = replicates_of_others(asked, channels.len());
    if most_replicates < asked {
        out.notes().info(format!(
            "intervals of the {} channels beside the pulse are 5-95 % of {most_replicates} replicates each, not \
             {asked}: they are many",
            channels.len()
        ));
    }
    let task = &ChannelIntegration { most_replicates, ..*task };
    for other in channels {
        let samples = acceleration(input, other)?;
        if !covers(&samples) {
            out.notes().concern(
                About::Channel(other.id.clone()),
                Weight::Slight,
                format!(
                    "channel {} runs from {:.1} to {:.1} ms and does not contain contact: not integrated",
                    other.id,
                    1e3 * samples.t0_s(),
                    1e3 * samples.end_s()
                ),
            );
            continue;
        }
        let motion = task.integrate(other, &samples, out)?;
        // Taken with all the others, of a place that nobody names: that it moves with the vehicle must show.
        let unnamed =
            !settings.channels.iter().any(|name| test.resolve_channels(name).iter().any(|c| c.id == other.id));
        if unnamed && unplaced(other) && !others.agrees(&motion) {
            out.notes().concern(
                About::Channel(other.id.clone()),
                Weight::Slight,
                format!(
                    "channel {} does not move as the pulse does, and nothing says where it sits: not compared with the \
                 vehicle (if it is of the compartment, name it: --set integrate.channels=all,{})",
                    other.id, other.id
                ),
            );
            continue;
        }
        note_warnings(&other.id, &motion, impact_speed_m_per_s, out.notes());
        metrics.extend(metric_records(&other.id, &motion));
        warn_unless_of_the_vehicle(other, out.notes());
        others.compare(other, &motion, out.notes());
        task.write(&other.id, motion, out)?;
    }
    Ok(metrics)
}

/// Whether a channel starts no later than one interval after time zero and goes on after it: its speed there is known.
fn covers(samples: &Sampled) -> bool {
    samples.t0_s() <= samples.dt_s() && samples.index_at_or_after(0.0) + 2 <= samples.len()
}

/// Whether neither a location nor a code says where a channel sits.
fn unplaced(channel: &Channel) -> bool {
    channel.location.trim().is_empty() && channel.code.is_none()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_channels_share_the_replicates_of_sixty() {
        let of = |channels| replicates_of_others(400, channels);
        assert_eq!([0, 1, 60, 120, 299, 100_000].map(of), [400, 400, 400, 200, 80, 50]);
        assert_eq!([0, 20].map(|asked| replicates_of_others(asked, 1000)), [0, 20]);
    }
}
