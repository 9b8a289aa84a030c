//! Tables of numbers: CSV, TSV, semicolons or blanks, as instruments and spreadsheets write them.

mod columns;
mod event_data_recorder;
mod header;
mod one_table;
mod rows;
mod section;
mod time_axis;

use std::borrow::Cow;

use crumple_signal::QuantityKind;

use crate::formats::iso13499;
use crate::formats::reader::{Bundle, Reader};
use crate::formats::table::event_data_recorder::report;
use crate::formats::table::one_table::{OneTable, TextAbove, one_table};
use crate::formats::text::lines::{is_text, without_mark};
use crate::recording::content::Recording;
use crate::{IngestError, IngestSettings, Place, Profile};

/// Reader of tables: whatever is text and nothing else.
pub struct Table;

impl Reader for Table {
    fn format(&self) -> &'static str {
        "csv"
    }

    fn recognises(&self, head: &[u8]) -> bool {
        is_text(head)
    }

    /// UTF-16 and old Macintosh line ends are converted as a whole, so such files must fit into memory.
    fn streams(&self, head: &[u8]) -> bool {
        !matches!(without_mark(head), Cow::Owned(_))
    }

    fn relevant_flags(&self) -> &'static [&'static str] {
        &["--unit", "--time-unit", "--sample-time", "--profile", "--skip-to", "--vehicle-number", "--resample"]
    }

    fn has_comments(&self) -> bool {
        true
    }

    fn read(&self, bundle: &Bundle, settings: &IngestSettings) -> Result<Recording, IngestError> {
        read(&bundle.main.name, &bundle.main.bytes, bundle, settings)
    }
}

/// Reads a table from its bytes, or from the file of which these are the start. `file` names it in messages.
fn read(file: &str, bytes: &[u8], bundle: &Bundle, settings: &IngestSettings) -> Result<Recording, IngestError> {
    let edr = settings.profile == Some(Profile::Edr);
    let mut text = without_mark(bytes);
    if edr
        && bundle.large.is_none()
        && let Some(recording) = report::read(file, &text, bundle, settings)?
    {
        return Ok(recording);
    }
    if let Some(title) = &settings.skip_to {
        if bundle.large.is_some() {
            return Err(IngestError::TooLarge {
                place: Place::file(file),
                found: "--skip-to in a table that is read piece by piece".to_owned(),
                limit: "one table to a file of this length".to_owned(),
            });
        }
        text = Cow::Owned(section::cut(&text, title, file)?);
    }
    let OneTable { mut channels, mut details, mut notes } =
        match one_table(file, bytes, &text, bundle, settings, TextAbove::Unused) {
            Err(error) if !edr && bundle.large.is_none() => return Err(report::with_profile_hint(file, &text, error)),
            table => table?,
        };
    if edr {
        report::edr_notes(&channels, &mut details, &mut notes);
    }
    // A table of velocities has no acceleration to take as the pulse.
    let has = |quantity| channels.iter().any(|read| read.channel.quantity == quantity);
    details.no_pulse |= has(QuantityKind::Velocity) && !has(QuantityKind::Acceleration) && !has(QuantityKind::Other);
    let pulse_rule = iso13499::pulse_rule(&mut channels, settings, &mut notes);
    Ok(Recording { details, channels, pulse_rule, contact_at_zero: false, notes })
}
