//! The table of channels of a record, without choosing a pulse.

use crumple_signal::SIMULATED;
use serde::Serialize;

use crate::files::open;
use crate::formats::reader::Bundle;
use crate::recording::content::ReadChannel;
use crate::recording::details::Details;
use crate::recording::settings::select;
use crate::{IngestSettings, Result, refuse_channel};

/// One line of the table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ListedChannel {
    /// Id of the channel.
    pub id: String,
    /// Channel code of ISO/TS 13499.
    pub code: Option<String>,
    /// Where the sensor sits.
    pub location: String,
    /// Where it is attached by the record's own code: `DSLF`, `VECG`.
    pub attachment: Option<String>,
    /// `x`, `y`, `z`, `resultant`.
    pub axis: Option<String>,
    /// What is measured.
    pub quantity: String,
    /// SI unit of the samples.
    pub unit: String,
    /// Sampling rate, Hz; `None` without data.
    pub rate_hz: Option<f64>,
    /// Number of samples.
    pub samples: usize,
    /// Channel frequency class.
    pub cfc: Option<u16>,
    /// What the laboratory says of the data; `not read` where the file is damaged, the comment has file, line and what
    /// is wrong.
    pub status: String,
    /// The laboratory's remark.
    pub comment: Option<String>,
}

impl ListedChannel {
    fn new(read: &ReadChannel) -> Self {
        let channel = &read.channel;
        Self {
            id: channel.id.clone(),
            code: channel.code.clone(),
            location: channel.location.clone(),
            attachment: read.attachment.clone(),
            axis: channel.axis.map(|a| a.to_string()),
            quantity: channel.quantity.to_string(),
            unit: channel.quantity.si_unit().to_owned(),
            rate_hz: read.wave.as_ref().map(|w| (w.rate_hz() * 1e6).round() / 1e6),
            samples: read.wave.as_ref().map_or(0, crumple_signal::Sampled::len),
            cfc: channel.cfc,
            status: {
                // Its file is here and damaged, which is another thing than a file that is not here; the comment says
                // how.
                let status = read.unread.as_ref().map_or_else(|| channel.status.to_string(), |_| "not read".to_owned());
                if channel.redundant { format!("{status}, redundant") } else { status }
            },
            comment: channel.comment.clone(),
        }
    }

    /// Whether it has samples.
    pub fn has_data(&self) -> bool {
        self.samples > 0
    }

    /// Whether a word stands in what the table says of it, in any case.
    pub fn mentions(&self, word: &str) -> bool {
        let texts = [&self.code, &self.axis, &self.attachment, &self.comment].into_iter().flatten();
        let mut texts = texts.chain([&self.id, &self.location, &self.quantity, &self.status]);
        texts.any(|text| text.to_lowercase().contains(&word.to_lowercase()))
    }
}

/// The channels of a record, those with data first, else in its order. What would stop a stage for want of a unit, a
/// mass or a pulse does not stop here.
pub fn list(bundle: &Bundle, flags: &IngestSettings) -> Result<Vec<ListedChannel>> {
    list_with_facts(bundle, flags).map(|(channels, _)| channels)
}

/// The same, with what a simulation says of itself: solver, version, folders and states, title.
pub fn list_with_facts(bundle: &Bundle, flags: &IngestSettings) -> Result<(Vec<ListedChannel>, Vec<String>)> {
    let stated_in_sidecar = open::settings(bundle)?.with_number_of_vehicle();
    let flags = &flags.with_number_of_vehicle();
    let mut choices = flags.over(&stated_in_sidecar);
    let wanted = choices.channel.take();
    choices.allow_missing = Some(true);
    choices.listing = true;
    let recording = bundle.read(&choices)?;
    let shown = match flags.channel.as_deref().and(wanted) {
        Some(wanted) => {
            let shown = select(&recording.channels, &wanted);
            if shown.is_empty() {
                return refuse_channel(
                    &bundle.name,
                    format!("--channel {wanted} means none of its {} channels", recording.channels.len()),
                    "an id, a code, another name or a pattern",
                    "leave --channel away to see them all",
                );
            }
            shown
        }
        None => (0..recording.channels.len()).collect(),
    };
    let mut listed: Vec<ListedChannel> =
        shown.into_iter().map(|k| ListedChannel::new(&recording.channels[k])).collect();
    // Stable: a test may list hundreds whose files are not here.
    listed.sort_by_key(|channel| !channel.has_data());
    let Details { mut facts, title, .. } = recording.details;
    facts.extend(title.map(|title| title.value));
    facts.retain(|_| SIMULATED.contains(&bundle.reader.format));
    Ok((listed, facts))
}
