//! The program: the stage `ingest`, the listing of channels, how progress and refusals are shown.

use std::fmt::Write as _;
use std::path::PathBuf;

use crate::checks::{channel_quality, exchanges};
use crate::recording::{content, details, preamble, scale, settings};
use crate::time::{SAMPLE_REMARKS, UNIT_REMARKS};
use crate::{
    Bundle, IngestError, IngestSettings, Ingested, ListedChannel, RecordDigests, Refusal, contact, formats, impact,
    ingest, kind, listing, pulse, wall,
};
use crumple_artifact::InputDigest;
use crumple_artifact::records::{TestV1, VehiclesV1};
use crumple_signal::Kind;
use crumple_stage::{
    ExitStatus, Loaded, Outcome, Output, Program, Progress, Refused, Stage, Usage, keep_budget, nearest, printable,
    program, run_stage, run_tool, to_stdout,
};

/// The program. It lists the channels if `--list` is given, else runs the stage: a listing writes no artifact and has
/// no life of a stage.
pub const PROGRAM: Program = Program {
    run: |call| match call.has("--list") {
        true => run_tool::<Cli>(call, run),
        false => run_stage::<Ingest>(call),
    },
    ..Program::of_stage::<Ingest>()
};

// The stage: files in, `/test`, `/wave/<id>` and `/quality/<id>` out.

/// The stage `ingest`.
pub struct Ingest;

impl Stage for Ingest {
    const NAME: &'static str = "ingest";
    const BUILD: &'static str = env!("CRUMPLE_BUILD");
    const ABOUT: &'static str = "Reads a crash record as you have it (a table such as CSV, an NHTSA EV5 or ISO-MME \
        test, its folder, or a zip of one) and writes it in SI units: \
        every channel, the test's mass and impact speed, the crash pulse. Asks for what the record does not say; \
        corrects nothing. With --list it prints the table of channels and writes nothing.";

    const NAMES_ITS_INPUTS: bool = true;

    const REMARKS: &'static [&'static [&'static Kind]] = &[
        formats::remarks::REMARKS,
        formats::ev5::REMARKS,
        formats::iso13499::REMARKS,
        formats::iso_mme::channel::REMARKS,
        formats::iso_mme::REMARKS,
        formats::lvm::REMARKS,
        formats::mcap::REMARKS,
        formats::messages::REMARKS,
        formats::simulation::remarks::REMARKS,
        formats::table::remarks::REMARKS,
        formats::tdm::REMARKS,
        formats::waveform::channel::REMARKS,
        formats::waveform::clock::REMARKS,
        formats::waveform::conversion::REMARKS,
        formats::workbook::REMARKS,
        content::REMARKS,
        details::REMARKS,
        preamble::REMARKS,
        scale::REMARKS,
        settings::REMARKS,
        SAMPLE_REMARKS,
        UNIT_REMARKS,
        wall::REMARKS,
        pulse::REMARKS,
        contact::REMARKS,
        impact::REMARKS,
        kind::REMARKS,
        ingest::REMARKS,
        channel_quality::REMARKS,
        exchanges::REMARKS,
    ];
    type Options = IngestSettings;
    type Settings = IngestSettings;
    type Input = Bundle;

    fn other_flags() -> Vec<clap::Arg> {
        let list = clap::Arg::new("list").long("list").action(clap::ArgAction::SetTrue).help_heading(None);
        vec![list.help("Print the table of channels and write nothing")]
    }

    fn resolve(options: IngestSettings) -> anyhow::Result<IngestSettings> {
        Ok(options)
    }

    fn load(paths: &[PathBuf], _: &IngestSettings) -> anyhow::Result<Loaded<Bundle>> {
        let [path] = paths else {
            return Err(Usage::new(format!("{} inputs, one record is read at a time", paths.len()))
                .hint(format!("give one file, or the folder of one test; several records: {}", program("fleet")))
                .into());
        };
        let bundle = Bundle::open_with_progress(path, show_progress).map_err(refused)?;
        let digests = input_digests(bundle.digests());
        Ok(Loaded::new(bundle, digests))
    }

    fn digests(paths: &[PathBuf]) -> Option<Vec<InputDigest>> {
        let [path] = paths else { return None };
        Bundle::digests_at(path).map(input_digests)
    }

    fn run(settings: &IngestSettings, bundle: &Bundle, out: &mut Output) -> anyhow::Result<Outcome> {
        let ingested = ingest(bundle, settings).map_err(refused)?;
        for line in summary(&ingested) {
            out.summary(line);
        }
        out.put("/test", &TestV1::from(&ingested.test))?;
        if let Some(damage) = &ingested.damage {
            out.put("/damage", damage)?;
        }
        if !ingested.vehicles.is_empty() {
            let Ingested { vehicles, closing_speed_m_per_s, .. } = ingested;
            out.put("/vehicles", &VehiclesV1 { vehicles, closing_speed_m_per_s })?;
        }
        for wave in ingested.waves {
            out.put(&format!("/quality/{}", wave.id), &wave.quality.record)?;
            out.wave(&wave.id, wave.quantity, wave.samples)?;
        }
        out.notes().extend(ingested.notes);
        Ok(Outcome::Done)
    }
}

fn input_digests(record: RecordDigests) -> Vec<InputDigest> {
    let sidecar = record.sidecar.map(|digest| InputDigest { kind: "sidecar".to_owned(), digest });
    let kind = format!("{} {}", record.format, record.name);
    std::iter::once(InputDigest { kind, digest: record.record }).chain(sidecar).collect()
}

fn summary(ingested: &Ingested) -> Vec<String> {
    let test = &ingested.test;
    let known = |value: Option<f64>, unit: &str| {
        value.map_or_else(|| "unknown".to_owned(), |x| format!("{} {unit}", (x * 1e4).round() / 1e4))
    };
    let (mass, speed) = (test.mass_kg, test.impact_speed_m_per_s);
    let of_a_crash = match (ingested.pulse(), mass, speed) {
        (None, None, None) => String::new(),
        _ => format!("; mass {}, impact speed {}", known(mass, "kg"), known(speed, "m/s")),
    };
    let mut lines = vec![format!(
        "{} ({}): {}; {} of {} channels with data{of_a_crash}",
        test.source.name,
        test.source.format,
        test.title,
        ingested.waves.len(),
        test.channels.len(),
    )];
    if let Some(pulse) = ingested.pulse() {
        let location = test.channel(&pulse.id).map(|c| c.location.as_str()).filter(|l| !l.is_empty());
        lines.push(format!(
            "pulse: channel {}{}, {} samples at {} Hz from {:.4} s to {:.4} s",
            pulse.id,
            location.map_or_else(String::new, |l| format!(" ({l})")),
            pulse.samples.len(),
            (pulse.samples.rate_hz() * 1e3).round() / 1e3,
            pulse.samples.t0_s(),
            pulse.samples.end_s(),
        ));
    }
    lines
}

// `--list`: the table of channels of a record, without choosing a pulse and without writing anything.

/// Command line of the listing.
#[derive(Debug, clap::Parser)]
#[command(
    version,
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
    let (mut lines, facts) = listing::list_with_facts(&bundle, &settings).map_err(refused)?;
    facts.iter().for_each(|fact| eprintln!("{}", printable(fact)));
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

// How the process shows progress and words a refusal.

/// Progress of reading, on a terminal or as log lines.
pub(crate) fn show_progress(what: String, total: u64) -> Box<dyn FnMut(u64)> {
    let mut progress = Progress::new(what, total);
    Box::new(move |bytes| progress.advance(bytes))
}

/// A refusal of the library as one of the process, with the nearest key of a sidecar for an unknown one.
pub(crate) fn refused(error: IngestError) -> anyhow::Error {
    let nearest_key = match &error.refusal {
        Refusal::UnknownKey(key) => nearest(key, IngestSettings::KEYS.iter().copied()),
        _ => None,
    };
    let hint = nearest_key.map_or_else(|| error.hint().to_owned(), |name| format!("did you mean {name:?}?"));
    let mut refused = Refused::new(error.to_string()).hint(hint);
    if let Some(expected) = error.expected() {
        refused = refused.expected(expected);
    }
    refused.into()
}
