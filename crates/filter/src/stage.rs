//! Reads the raw channels, filters them, writes them with the record of how.

use std::collections::BTreeMap;
use std::path::PathBuf;

use crumple_filter::{Filtered, filter, select};
use crumple_signal::{Note, Notes, Severity};
use crumple_stage::records::{ChannelFilterV1, TestV1};
use crumple_stage::{Inputs, Loaded, Outcome, Output, RefuseExt, Refused, Stage};

use crate::options::{Options, StageSettings};

/// The stage.
pub struct Filter;

impl Stage for Filter {
    const NAME: &'static str = "filter";
    const ABOUT: &'static str = "Removes the zero level of the acceleration channels \
         and filters them to a channel frequency class (ISO 6487, SAE J211-1).";
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
        let pulse = test.pulse_channel().ok().map(|channel| channel.id.clone());
        let selected: Vec<String> = select(&test, &settings.channels)
            .refuse_with_hint("name the channels to filter with --channels")?
            .into_iter()
            .map(|channel| channel.id.clone())
            .collect();

        let mut remarks = Remarks::default();
        let mut filtered_ids = Vec::new();
        for channel in test.channels.iter_mut().filter(|channel| selected.contains(&channel.id)) {
            let id = &channel.id;
            let wave = input.wave(id)?;
            let filtered = match filter(&wave.sampled, channel.cfc, &settings.filter) {
                Ok(filtered) => filtered,
                // A channel nobody asked for does not stop the others.
                Err(error) if settings.channels.is_empty() && pulse.as_ref() != Some(id) => {
                    remarks.add(id, Note { severity: Severity::Warning, text: format!("left out: {error}") });
                    continue;
                }
                Err(error) => {
                    return Err(Refused::new(format!("channel {id}: {error}"))
                        .hint("--cfc none leaves the signal as it is, --channels names the channels to filter")
                        .into());
                }
            };
            for note in filtered.notes.iter() {
                remarks.add(id, note.clone());
            }
            out.put(&format!("/filter/{id}"), &record(&filtered))?;
            if let Some(applied) = filtered.applied {
                channel.cfc = Some(applied.cfc.number());
            }
            if pulse.as_ref() == Some(id) {
                out.summary(pulse_line(id, channel.cfc, &filtered));
            }
            out.wave(id, wave.quantity, filtered.samples)?;
            filtered_ids.push(channel.id.as_str());
        }
        if filtered_ids.len() > 1 {
            out.summary(format!("{} channels: {}", filtered_ids.len(), filtered_ids.join(", ")));
        }
        out.notes().extend(remarks.into_notes());
        out.put("/test", &TestV1::from(&test))?;
        Ok(Outcome::Done)
    }
}

fn pulse_line(id: &str, cfc: Option<u16>, filtered: &Filtered) -> String {
    let class = cfc.map_or_else(|| "no class".to_owned(), |cfc| format!("cfc {cfc}"));
    let how = filtered
        .applied
        .map_or_else(|| "passed through".to_owned(), |applied| applied.coefficients.mode().name().to_owned());
    format!("pulse {id}: {class} ({how}), zero level {:+.4} m/s^2 removed", filtered.zero_level_removed)
}

fn record(filtered: &Filtered) -> ChannelFilterV1 {
    let applied = filtered.applied;
    ChannelFilterV1 {
        cfc: applied.map(|applied| applied.cfc.number()),
        mode: applied.map_or("none", |applied| applied.coefficients.mode().name()).to_owned(),
        frequency_factor: applied.map(|applied| applied.coefficients.mode().frequency_factor()),
        samples_added: applied.map_or(0, |applied| applied.samples_added as u64),
        coefficients: applied.map_or_else(Vec::new, |applied| applied.coefficients.to_array().to_vec()),
        gain_at_class_db: applied.map(|applied| applied.coefficients.two_pass_gain_db(applied.cfc.frequency_hz())),
        zero_level_removed: filtered.zero_level_removed,
        notes: filtered.notes.to_texts(),
    }
}

/// Notes of all channels; what holds for several is said once.
#[derive(Default)]
struct Remarks(BTreeMap<(Severity, String), Vec<String>>);

impl Remarks {
    fn add(&mut self, id: &str, note: Note) {
        self.0.entry((note.severity, note.text)).or_default().push(id.to_owned());
    }

    fn into_notes(self) -> Notes {
        let mut notes = Notes::new();
        for ((severity, text), ids) in self.0 {
            let text = format!("channel{} {}: {text}", if ids.len() > 1 { "s" } else { "" }, ids.join(", "));
            match severity {
                Severity::Info => notes.info(text),
                Severity::Warning => notes.warning(text),
            }
        }
        notes
    }
}
