//! An artifact in words: provenance, records as JSON, waveforms as a line each.

use std::io::{self, Write};

use crumple_artifact::{Artifact, JsonForm, RawRecord, ReadError, Wave};

use super::json::json_of;
use super::options::{ShowOptions, wanted_waves};

/// Writes for people. The outer error is the artifact's, the inner one the writer's.
pub fn write_text(
    artifact: &Artifact,
    options: &ShowOptions,
    out: &mut dyn Write,
) -> Result<io::Result<()>, ReadError> {
    let mut blocks = vec![head(artifact)];
    for raw in artifact.records().iter().filter(|raw| options.topics.takes(&raw.topic)) {
        blocks.push(format!("{}  {}\n{}", raw.topic, raw.schema, body(artifact, raw)?));
    }
    let waves = || wanted_waves(artifact, options).map(|(topic, wave)| format!("{topic}  {}", summary(wave)));
    if options.samples {
        return Ok(blocks.iter().try_for_each(|block| writeln!(out, "{block}\n")).and_then(|()| {
            wanted_waves(artifact, options).zip(waves()).try_for_each(|((_, wave), line)| {
                writeln!(out, "{line}\ntime_s\tvalue")?;
                write_samples(wave, out)?;
                writeln!(out)
            })
        }));
    }
    blocks.extend(Some(waves().collect::<Vec<_>>().join("\n")).filter(|lines| !lines.is_empty()));
    Ok(writeln!(out, "{}", blocks.join("\n\n")))
}

fn body(artifact: &Artifact, raw: &RawRecord) -> Result<String, ReadError> {
    let unread = || format!("{} bytes in encoding {:?}, which is not read", raw.payload.len(), raw.encoding);
    Ok(json_of(artifact, raw, JsonForm::Pretty)?.unwrap_or_else(unread))
}

fn head(artifact: &Artifact) -> String {
    let mut lines = Vec::new();
    match artifact.provenance() {
        None => lines.push("stage    not stated".to_owned()),
        Some(provenance) => {
            let stage = artifact.stage().unwrap_or("not stated");
            lines.push(format!("stage    {stage} {}", provenance.stage_version).trim_end().to_owned());
            if !provenance.made_by.is_empty() {
                lines.push(format!("made by  {}, of content that is not the stage's own", provenance.made_by));
            }
            lines.push(format!("config   {}", provenance.config_json));
            lines.extend(provenance.inputs.iter().map(|input| format!("input    {} {}", input.kind, input.digest)));
        }
    }
    lines.push(format!("content  {}", artifact.digest()));
    lines.join("\n")
}

fn summary(wave: &Wave) -> String {
    let sampled = &wave.sampled;
    let mut text = format!("{} in {}", wave.quantity, wave.quantity.si_unit());
    let samples = sampled.samples();
    let extreme = |better: fn(&f64, &f64) -> bool| {
        (0..samples.len()).reduce(|best, k| if better(&samples[k], &samples[best]) { k } else { best })
    };
    let (Some(low), Some(high)) = (extreme(|x, best| x < best), extreme(|x, best| x > best)) else {
        return format!("{text}, no samples");
    };
    let place = |k: usize| format!("{} at {} s", samples[k], seconds(sampled.time_s(k)));
    text += &format!(
        ", {} samples from {} s to {} s, every {} s ({} Hz); min {}, max {}",
        samples.len(),
        seconds(sampled.t0_s()),
        seconds(sampled.end_s()),
        sampled.dt_s(),
        seconds(sampled.rate_hz()),
        place(low),
        place(high)
    );
    text
}

/// To the nanosecond, in which times are stored.
fn seconds(t_s: f64) -> String {
    let text = format!("{t_s:.9}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

fn write_samples(wave: &Wave, out: &mut dyn Write) -> io::Result<()> {
    let samples = wave.sampled.samples().iter().zip(wave.sampled.times_s());
    samples.into_iter().try_for_each(|(value, time_s)| writeln!(out, "{}\t{value}", seconds(time_s)))
}
