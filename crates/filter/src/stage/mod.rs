//! The program: reads the raw channels, filters them, writes them with the record of how.

mod channels_to_filter;
mod filtering;
mod options;

use std::path::PathBuf;

use crumple_signal::{
    Applied, Channel, Coefficients, DERIVATIVE_REMARKS, FILTER_REMARKS, Kind, QuantityKind, Resampling,
    TestDescription, keep_every, kept, resample, samples_added,
};
use crumple_stage::records::{DamageV1, QualityV1, TestV1, VehiclesV1};
use crumple_stage::{Inputs, Loaded, Outcome, Output, RefuseExt, Stage, option, program};

use crate::stage::channels_to_filter::{channels_to_filter, resolve_ids};
use crate::stage::filtering::{
    FilteredChannel, HandedOn, Remarks, Resampled, Thinned, derived, filter_channels, first_of, pulse_line, record,
};
use crate::stage::options::{KeptRate, Options, StageSettings};

/// The stage.
pub struct Filter;

impl Stage for Filter {
    const NAME: &'static str = "filter";
    const BUILD: &'static str = env!("CRUMPLE_BUILD");
    const ABOUT: &'static str = "Filters the acceleration channels to a channel frequency class \
         (ISO 6487, SAE J211-1) and removes their zero level.";
    const REMARKS: &'static [&'static [&'static Kind]] =
        &[filtering::REMARKS, channels_to_filter::REMARKS, FILTER_REMARKS, DERIVATIVE_REMARKS];
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
        let mut pulse = test.pulse_channel().ok().map(|channel| channel.id.clone());
        let mut pass = resolve_ids(&test, &settings.pass)
            .refuse_with_hint(format!("{} lists the channels of an artifact", program("artifact show")))?;
        let mut remarks = Remarks::default();
        // A list of channels means those alone.
        let by_default = settings.channels.is_empty();
        let mut with_derived = test.clone();
        let derived =
            if by_default { derived(&settings.filter, input, &mut with_derived, &mut remarks)? } else { None };
        if by_default {
            // What a recorder kept says its largest change by itself.
            let change = |channel: &&Channel| {
                channel.quantity == QuantityKind::VelocityChange
                    && input.wave_if(&channel.id).is_some()
                    && !pass.contains(&channel.id)
            };
            let changes: Vec<String> = test.channels.iter().filter(change).map(|channel| channel.id.clone()).collect();
            pass.extend(changes);
        }
        let selected = channels_to_filter(settings, &pass, input, &test, derived.is_some(), &mut remarks)?;
        let mut channels = filter_channels(&selected, !by_default, pulse.as_deref(), &mut remarks, out)?;
        drop(selected);
        channels.extend(derived);
        test = with_derived;
        pulse = test.pulse.clone().or(pulse);
        match settings.resample {
            Some(to) => resample_all(&mut channels, to, &mut remarks)?,
            None => keep_what_is_needed(&mut channels, settings.rate, &mut remarks)?,
        }

        let ids: Vec<String> = channels.iter().map(|channel| channel.id.clone()).collect();
        for channel in channels {
            write_channel(channel, &mut test, pulse.as_deref(), out)?;
        }
        for id in pass.iter().filter(|id| !ids.contains(id)) {
            let wave = input.wave(id)?;
            out.wave(id, wave.quantity, wave.sampled.clone())?;
            remarks.add(id, HandedOn {});
        }
        if ids.len() > 1 {
            out.summary(format!("{} channels: {}", ids.len(), first_of(&ids)));
        }
        out.notes().extend(remarks.into_notes());
        out.put("/test", &TestV1::from(&test))?;
        // What ingest found of the pulse widens the intervals of its motion.
        for topic in pulse.iter().map(|id| format!("/quality/{id}")) {
            if let Some(quality) = input.record_if::<QualityV1>(&topic)? {
                out.put(&topic, &quality)?;
            }
        }
        if let Some(damage) = input.record_if::<DamageV1>("/damage")? {
            out.put("/damage", &damage)?;
        }
        if let Some(vehicles) = input.record_if::<VehiclesV1>("/vehicles")? {
            out.put("/vehicles", &vehicles)?;
        }
        Ok(Outcome::Done)
    }
}

/// Brings all channels to one sampling rate.
fn resample_all(channels: &mut [FilteredChannel], to: Resampling, remarks: &mut Remarks) -> anyhow::Result<()> {
    for channel in channels {
        let from_hz = channel.filtered.samples.rate_hz();
        channel.filtered.samples = resample(&channel.filtered.samples, to).refuse_with_hint(format!(
            "give a rate, such as {}; leave it out to keep the record's own",
            option("filter", "resample", "10kHz")
        ))?;
        channel.extra.resampled_to_hz = Some(to.rate_hz);
        let interpolation = to.interpolation.name().to_owned();
        remarks.add(&channel.id, Resampled { from_hz, to_hz: to.rate_hz, interpolation });
    }
    Ok(())
}

/// Leaves out the samples of channels filtered to a class that say nothing more.
fn keep_what_is_needed(channels: &mut [FilteredChannel], rate: KeptRate, remarks: &mut Remarks) -> anyhow::Result<()> {
    let lowest_hz = match rate {
        KeptRate::Full => return Ok(()),
        KeptRate::Auto => 0.0,
        KeptRate::AtLeast(rate_hz) => rate_hz,
    };
    for channel in channels {
        let Some(Applied::Class { cfc, coefficients, .. }) = &channel.filtered.applied else { continue };
        let from_hz = channel.filtered.samples.rate_hz();
        let every = keep_every(from_hz, cfc.frequency_hz() / 0.6, lowest_hz);
        if every == 1 {
            continue;
        }
        let samples = kept(&channel.filtered.samples, every).refuse()?;
        let at_rate = Coefficients::new(*cfc, coefficients.mode(), samples.dt_s());
        channel.extra.as_kept = Some((at_rate, samples_added(samples.len(), &at_rate)));
        let to_hz = samples.rate_hz();
        channel.filtered.notes.push(Thinned { from_hz, every, to_hz });
        remarks.add(&channel.id, Thinned { from_hz, every, to_hz });
        channel.filtered.samples = samples;
    }
    Ok(())
}

/// Writes a channel with the record of how it was filtered; its class goes into the test description.
fn write_channel(
    FilteredChannel { id, quantity, filtered, extra, .. }: FilteredChannel,
    test: &mut TestDescription,
    pulse: Option<&str>,
    out: &mut Output,
) -> anyhow::Result<()> {
    let channel = test.channels.iter_mut().find(|channel| channel.id == id);
    let cfc = channel.and_then(|channel| {
        // A channel smoothed further by another filter keeps its class.
        if let Some(Applied::Class { cfc, .. }) = &filtered.applied {
            channel.cfc = Some(cfc.number());
        }
        channel.cfc
    });
    if pulse == Some(&id) {
        out.summary(pulse_line(&id, cfc, &filtered));
    }
    out.put(&format!("/filter/{id}"), &record(&filtered, &extra))?;
    out.wave(&id, quantity, filtered.samples)
}
