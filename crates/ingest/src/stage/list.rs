//! `--list`: the table of channels of a record, without choosing a pulse and without writing anything.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;

use crumple_stage::{ExitStatus, Usage};
use serde::Serialize;

use crate::files::sidecar;
use crate::recording::channel_selection::select;
use crate::recording::read_channel::Found;
use crate::stage::ingest::{refused, show_progress};
use crate::{Bundle, IngestError, Settings};

/// Command line of the listing.
#[derive(Debug, clap::Parser)]
#[command(
    version,
    bin_name = "crumple-ingest",
    display_name = "crumple-ingest",
    about = "Prints the table of channels of a record and writes nothing.",
    after_help = "Values are in SI units, as they would be written. --channel prints only the channels it means: an id, a code, a pattern such as '1?VEHC*X?'."
)]
pub struct Cli {
    /// The record as you have it.
    #[arg(value_name = "INPUT")]
    input: PathBuf,
    /// Print the table of channels.
    #[arg(long, required = true)]
    list: bool,
    /// One JSON object a line instead of a table.
    #[arg(long)]
    json: bool,
    /// Taken and not used: nothing is written.
    #[arg(short, long, hide = true)]
    output: Option<PathBuf>,
    /// Taken and not used.
    #[arg(short, long, hide = true)]
    quiet: bool,
    #[command(flatten)]
    settings: Settings,
}

/// One line of the table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Line {
    /// Id of the channel.
    pub id: String,
    /// Channel code of ISO/TS 13499.
    pub code: Option<String>,
    /// Where the sensor sits.
    pub location: String,
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
    /// What the laboratory says of the data; `not read` where the file is damaged, the comment has file, line and what is wrong.
    pub status: String,
    /// The laboratory's remark.
    pub comment: Option<String>,
}

impl Line {
    fn new(found: &Found) -> Self {
        let channel = &found.channel;
        Self {
            id: channel.id.clone(),
            code: channel.code.clone(),
            location: channel.location.clone(),
            axis: channel.axis.map(|a| a.to_string()),
            quantity: channel.quantity.to_string(),
            unit: channel.quantity.si_unit().to_owned(),
            rate_hz: found.wave.as_ref().map(|w| (w.rate_hz() * 1e6).round() / 1e6),
            samples: found.wave.as_ref().map_or(0, crumple_signal::Sampled::len),
            cfc: channel.cfc,
            status: {
                // Its file is here and damaged, which is another thing than a file that is not here; the comment says how.
                let status = found.unread().map_or_else(|| channel.status.to_string(), |_| "not read".to_owned());
                if channel.redundant { format!("{status}, redundant") } else { status }
            },
            comment: channel.comment.clone(),
        }
    }

    fn cells(&self) -> [String; 11] {
        let dash = |text: Option<String>| text.filter(|t| !t.is_empty()).unwrap_or_else(|| "-".to_owned());
        [
            self.id.clone(),
            dash(self.code.clone()),
            dash(Some(self.location.clone())),
            dash(self.axis.clone()),
            self.quantity.clone(),
            self.unit.clone(),
            dash(self.rate_hz.map(|r| r.to_string())),
            self.samples.to_string(),
            dash(self.cfc.map(|c| c.to_string())),
            self.status.clone(),
            dash(self.comment.clone()),
        ]
    }
}

/// Head of the table.
const HEAD: [&str; 11] =
    ["id", "code", "location", "axis", "quantity", "unit", "rate_hz", "samples", "cfc", "status", "comment"];

/// The channels of a record, in its order. What would stop a stage for want of a unit, a mass or a pulse does not stop here.
pub fn list(bundle: &Bundle, flags: &Settings) -> Result<Vec<Line>, IngestError> {
    let beside = match &bundle.sidecar {
        Some(sidecar) => sidecar::parse(&sidecar.name, &sidecar.bytes)?,
        None => Settings::default(),
    };
    let mut choices = flags.over(&beside);
    let wanted = choices.channel.take();
    choices.allow_missing = Some(true);
    choices.listing = true;
    let recording = bundle.reader.read(bundle, &choices)?;
    let shown = match flags.channel.as_deref().and(wanted) {
        Some(wanted) => {
            let shown = select(&recording.channels, &wanted);
            if shown.is_empty() {
                return Err(IngestError::channel(
                    &bundle.name,
                    format!("--channel {wanted} means none of its {} channels", recording.channels.len()),
                    "an id, a code, another name or a pattern",
                    "leave --channel away to see them all",
                ));
            }
            shown
        }
        None => (0..recording.channels.len()).collect(),
    };
    Ok(shown.into_iter().map(|k| Line::new(&recording.channels[k])).collect())
}

/// Reads the record and prints its channels.
pub fn run(cli: Cli) -> anyhow::Result<ExitStatus> {
    let Cli { input, json, settings, .. } = cli;
    if input.as_os_str().is_empty() {
        return Err(Usage::new("no input").hint("give one file, or the folder of one test").into());
    }
    let bundle = Bundle::open_with_progress(&input, show_progress).map_err(refused)?;
    let lines = list(&bundle, &settings).map_err(refused)?;
    let text = if json {
        let mut text = String::new();
        for line in &lines {
            text.push_str(&serde_json::to_string(line)?);
            text.push('\n');
        }
        text
    } else {
        table(&lines)
    };
    // A reader that has seen enough closes the pipe; that is not an error.
    let _ = std::io::stdout().lock().write_all(text.as_bytes());
    Ok(ExitStatus::Done)
}

/// Columns as wide as their widest cell, two blanks between; the last is open.
fn table(lines: &[Line]) -> String {
    let rows: Vec<[String; 11]> =
        std::iter::once(HEAD.map(str::to_owned)).chain(lines.iter().map(Line::cells)).collect();
    let width = |c: usize| rows.iter().map(|row| row[c].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..HEAD.len()).map(width).collect();
    let mut text = String::new();
    for row in &rows {
        let mut line = String::new();
        for (cell, width) in row.iter().zip(&widths) {
            let _ = write!(line, "{cell:<width$}  ");
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}
