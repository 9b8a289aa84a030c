//! `--list`: the table of channels of a record, without choosing a pulse and without writing anything.

use std::fmt::Write as _;
use std::path::PathBuf;

use crumple_ingest::{Bundle, IngestSettings, ListedChannel, list};
use crumple_stage::{ExitStatus, Usage, keep_budget, printable, to_stdout};

use crate::stage::process::{refused, show_progress};

/// Command line of the listing.
#[derive(Debug, clap::Parser)]
#[command(
    version,
    bin_name = "crumple-ingest",
    display_name = "crumple-ingest",
    about = "Prints the table of channels of a record and writes nothing.",
    after_help = "Values are in SI units, as they would be written. --channel prints only the channels it means: an \
        id, a code, a pattern such as '1?VEHC*X?'. Channels with data stand first."
)]
pub struct Cli {
    /// The record as you have it.
    #[arg(value_name = "INPUT")]
    input: PathBuf,
    /// Print the table of channels.
    #[arg(long, required = true)]
    list: bool,
    /// Only channels with data.
    #[arg(long)]
    with_data: bool,
    /// Only channels in whose id, code, location, quantity, status or comment this word stands: sill, engine, force.
    #[arg(long, value_name = "WORD")]
    search: Option<String>,
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
    settings: IngestSettings,
}

/// Reads the record and prints its channels.
pub fn run(cli: Cli) -> anyhow::Result<ExitStatus> {
    let Cli { input, json, settings, with_data, search, .. } = cli;
    if input.as_os_str().is_empty() {
        return Err(Usage::new("no input").hint("give one file, or the folder of one test").into());
    }
    keep_budget(std::slice::from_ref(&input), ExitStatus::Refused);
    let bundle = Bundle::open_with_progress(&input, show_progress).map_err(refused)?;
    let mut lines = list(&bundle, &settings).map_err(refused)?;
    let listed = lines.len();
    lines.retain(|line| (!with_data || line.has_data()) && search.as_ref().is_none_or(|word| line.mentions(word)));
    if lines.is_empty() {
        eprintln!("none of the {listed} channels is meant; leave --search and --with-data away to see them all");
    }
    let text = if json {
        let mut text = String::new();
        for line in &lines {
            text.push_str(&serde_json::to_string(line)?);
            text.push('\n');
        }
        text
    } else {
        printable(&table(&lines)).into_owned()
    };
    to_stdout(text.as_bytes())?;
    Ok(ExitStatus::Done)
}

/// Columns as wide as their widest cell, two blanks between; the last is open.
fn table(lines: &[ListedChannel]) -> String {
    let rows: Vec<[String; 12]> = std::iter::once(HEAD.map(str::to_owned)).chain(lines.iter().map(cells)).collect();
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

/// Head of the table.
const HEAD: [&str; 12] = [
    "id", "code", "location", "attached", "axis", "quantity", "unit", "rate_hz", "samples", "cfc", "status", "comment",
];

/// The texts of a row; a dash for what is not known.
fn cells(line: &ListedChannel) -> [String; 12] {
    let dash = |text: Option<String>| text.filter(|t| !t.is_empty()).unwrap_or_else(|| "-".to_owned());
    [
        line.id.clone(),
        dash(line.code.clone()),
        dash(Some(line.location.clone())),
        dash(line.attachment.clone()),
        dash(line.axis.clone()),
        line.quantity.clone(),
        line.unit.clone(),
        dash(line.rate_hz.map(|r| r.to_string())),
        line.samples.to_string(),
        dash(line.cfc.map(|c| c.to_string())),
        line.status.clone(),
        dash(line.comment.clone()),
    ]
}
