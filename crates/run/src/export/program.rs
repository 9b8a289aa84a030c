//! `crumple-export`: the results of a run, a joint run or a fleet as tables for other programs.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use crumple_artifact::records::{CandidateV1, MetricsV2, PredictionV1, RecommendationV1, RemarkV1, TestV1};
use crumple_artifact::{Artifact, OutputKind, ReadError, Record, write_atomically};
use crumple_lumped::{ParameterKind, parameter_kind};
use crumple_signal::Display;
use crumple_stage::{
    DisplayFlag, ExitStatus, Refused, Usage, artifacts_of_a_run, is_no_result, keep_budget, refuse_to_overwrite,
    remarks_of, say, unknown_name,
};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;

use super::modelica::modelica;
use super::us_units::in_us_units;
use super::waves::{wave_tables, waves_of};
use super::workbook::workbook;
use crate::fleet::tables::{METRICS, PREDICTIONS, metric_cells, prediction_row};
use crate::table::Kind::{Count, Flag, Number, Text};
use crate::table::{Cell, CsvForm, Kind, Table, columns, write_csv, write_parquet};

/// Writes the results of a run as tables for other programs (CSV, Parquet, a workbook), or a model as Modelica text.
///
/// Tables of a run: waves and simulated (a column a waveform, a table a sampling rate), parameters, metrics,
/// predictions, notes. A joint run has those of its model, a fleet has its own.
#[derive(Debug, clap::Parser)]
#[command(
    name = "crumple-export",
    version,
    after_help = "In CSV a ' stands in front of a text that begins with = + - @.\n\
                  Exit codes: 0 done, 1 unforeseen failure, 2 usage, 3 input refused."
)]
pub struct ExportOptions {
    /// Folder of a run, of a joint run or of a fleet.
    #[arg(value_name = "RUN")]
    run: PathBuf,

    /// csv and parquet: a file a table, in a folder; xlsx: a sheet a table, in a workbook; modelica: a model.
    #[arg(long, value_enum, value_name = "FORMAT")]
    to: Format,

    /// Folder, workbook or model to write [default: export, export.xlsx, model.mo].
    #[arg(short, long, value_name = "FOLDER|FILE")]
    output: Option<PathBuf>,

    /// Tables to write [default: all].
    #[arg(long, value_name = "TABLE", value_delimiter = ',')]
    what: Vec<String>,

    /// Of every N rows of waves those with the lowest and the highest sample of a waveform.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..))]
    decimate: Option<u32>,

    /// CSV for a spreadsheet that has a decimal comma: semicolons between cells.
    #[arg(long)]
    semicolon: bool,

    /// The model that `--to modelica` writes [default: the recommended one].
    #[arg(long, value_name = "ID")]
    candidate: Option<String>,

    #[command(flatten)]
    display: DisplayFlag,

    /// Replace files that are there.
    #[arg(long)]
    force: bool,

    /// No summary.
    #[arg(short, long)]
    quiet: bool,
}

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    /// Text.
    Csv,
    /// Parquet, with units in its metadata.
    Parquet,
    /// A workbook.
    Xlsx,
    /// A model for programs that simulate Modelica.
    Modelica,
}

/// Exports a run.
pub(crate) fn export(options: ExportOptions) -> anyhow::Result<ExitStatus> {
    if options.semicolon && options.to != Format::Csv {
        return Err(Usage::new("--semicolon is for CSV").hint("--to csv --semicolon").into());
    }
    keep_budget(std::slice::from_ref(&options.run), ExitStatus::Refused);
    if options.to == Format::Modelica {
        return export_model(&options);
    }
    if options.candidate.is_some() {
        return Err(Usage::new("--candidate is for a model").hint("--to modelica --candidate ID").into());
    }
    let all = tables_of(&options.run, options.decimate.map(|every| every as usize))?;
    let family = |table: &Table| table.name.split('-').next().unwrap_or_default().to_owned();
    for wanted in &options.what {
        if !all.iter().any(|table| family(table) == *wanted) {
            let mut names: Vec<String> = all.iter().map(family).collect();
            names.dedup();
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let problem = format!("{} has no table {wanted:?}", options.run.display());
            return Err(unknown_name(&problem, wanted, &names));
        }
    }
    let wanted = |table: &Table| options.what.is_empty() || options.what.contains(&family(table));
    let is_us = options.display.or_of(None)? == Display::Us;
    let tables: Vec<Table> =
        all.into_iter().filter(wanted).map(|table| if is_us { in_us_units(table) } else { table }).collect();
    let default = if options.to == Format::Xlsx { "export.xlsx" } else { "export" };
    let output = options.output.clone().unwrap_or_else(|| default.into());
    let written = if options.to == Format::Xlsx {
        let bytes = workbook(&tables)?;
        vec![options.write(&output, |file| Ok(file.write_all(&bytes)?))?]
    } else {
        if output.is_file() {
            let problem = format!("{} is a file; tables go to a folder", output.display());
            return Err(Usage::new(problem).hint("name a folder: -o FOLDER").into());
        }
        let one = |table: &Table| {
            if options.to == Format::Parquet {
                let path = output.join(format!("{}.parquet", table.name));
                return options.write(&path, |file| Ok(write_parquet(table, file)?));
            }
            let form = if options.semicolon { CsvForm::Semicolon } else { CsvForm::Sheet };
            options.write(&output.join(format!("{}.csv", table.name)), |file| Ok(write_csv(table, form, file)?))
        };
        tables.iter().map(one).collect::<anyhow::Result<_>>()?
    };
    if !options.quiet {
        let count = |table: &Table| format!("{} {} x {}", table.name, table.rows.len(), table.columns.len());
        say(format_args!("{} (rows x columns)", tables.iter().map(count).collect::<Vec<_>>().join(", ")));
        written.iter().for_each(|path| say(path.display()));
    }
    Ok(ExitStatus::Done)
}

/// Writes a candidate as Modelica text.
fn export_model(options: &ExportOptions) -> anyhow::Result<ExitStatus> {
    if !options.what.is_empty() || options.decimate.is_some() {
        return Err(Usage::new("--what and --decimate are for tables").hint("leave them out").into());
    }
    let text = modelica(&opened(&options.run)?, options.candidate.as_deref())?;
    let output = options.output.clone().unwrap_or_else(|| "model.mo".into());
    let written = options.write(&output, |file| Ok(file.write_all(text.as_bytes())?))?;
    if !options.quiet {
        say(written.display());
    }
    Ok(ExitStatus::Done)
}

/// The artifacts of a run.
fn opened(folder: &Path) -> anyhow::Result<Vec<Artifact>> {
    let paths = artifacts_of_a_run(folder)?;
    Ok(paths.iter().map(|path| Artifact::open(path).map_err(Refused::from)).collect::<Result<_, _>>()?)
}

impl ExportOptions {
    /// Writes a file in one piece, where none is or --force says so.
    fn write(
        &self,
        path: &Path,
        content: impl FnOnce(&mut std::io::BufWriter<File>) -> anyhow::Result<()>,
    ) -> anyhow::Result<PathBuf> {
        if path.exists() && !self.force {
            return Err(Usage::new(format!("{} exists", path.display())).hint("name another by -o, or --force").into());
        }
        let artifacts = artifacts_of_a_run(&self.run).unwrap_or_default();
        refuse_to_overwrite(path, OutputKind::Export, &artifacts)?;
        write_atomically(path, OutputKind::Export, content)
            .with_context(|| format!("cannot write {}", path.display()))?;
        Ok(path.to_owned())
    }
}

// What there is to export.

/// The tables of a fleet, as `crumple-fleet` writes them.
const OF_FLEET: [&str; 4] = ["tests", "candidates", "metrics", "predictions"];

fn tables_of(folder: &Path, decimate: Option<usize>) -> anyhow::Result<Vec<Table>> {
    let of_fleet = OF_FLEET.map(|name| (name, folder.join(format!("{name}.parquet"))));
    if of_fleet.iter().all(|(_, path)| path.is_file()) {
        return of_fleet.iter().map(|(name, path)| read_parquet(name, path)).collect();
    }
    let artifacts = opened(folder)?;
    let found = |tables: Result<Table, ReadError>| tables.map_err(Refused::from);
    let mut tables = wave_tables(&waves_of(&artifacts), decimate);
    tables.push(found(parameters(&artifacts))?);
    tables.push(found(metrics(&artifacts))?);
    tables.push(found(predictions(&artifacts))?);
    tables.push(found(notes(&artifacts))?);
    tables.retain(|table| !table.rows.is_empty());
    Ok(tables)
}

/// Every record of a type under a topic, or below one that ends with `/`, with the rest of its topic.
pub(crate) fn records<R: Record>(artifacts: &[Artifact], below: &str) -> Result<Vec<(String, R)>, ReadError> {
    let mut found = Vec::new();
    for artifact in artifacts {
        for raw in artifact.records() {
            if let Some(rest) = raw.topic.strip_prefix(below).filter(|rest| rest.is_empty() || below.ends_with('/')) {
                found.push((rest.to_owned(), artifact.decode(raw)?));
            }
        }
    }
    Ok(found)
}

/// A row a parameter of a candidate, with its 95 % interval.
fn parameters(artifacts: &[Artifact]) -> Result<Table, ReadError> {
    let chosen = records::<RecommendationV1>(artifacts, "/recommendation")?;
    let recommended = chosen.into_iter().find_map(|(_, choice)| choice.recommended);
    let mut rows = Vec::new();
    for (id, candidate) in records::<CandidateV1>(artifacts, "/parameters/")? {
        for (name, value) in &candidate.parameters {
            let bounds = candidate.uncertainty.as_ref();
            let unit = parameter_kind(&candidate.model, name).map(ParameterKind::unit);
            rows.push(vec![
                (&id).into(),
                name.into(),
                (*value).into(),
                unit.into(),
                bounds.and_then(|known| *known.interval_low.get(name)?).into(),
                bounds.and_then(|known| *known.interval_high.get(name)?).into(),
                (recommended.as_ref() == Some(&id)).into(),
            ]);
        }
    }
    let heads = columns(&[
        ("candidate", Text),
        ("name", Text),
        ("value", Number),
        ("unit", Text),
        ("low", Number),
        ("high", Number),
        ("recommended", Flag),
    ]);
    Ok(Table::new("parameters", heads, rows))
}

/// A row a metric of a channel.
fn metrics(artifacts: &[Artifact]) -> Result<Table, ReadError> {
    let channels = records::<TestV1>(artifacts, "/test")?.into_iter().flat_map(|(_, test)| test.channels);
    let locations: BTreeMap<String, String> = channels.map(|one| (one.id, one.location)).collect();
    let mut rows = Vec::new();
    for (_, of_run) in records::<MetricsV2>(artifacts, "/metrics")? {
        rows.extend(of_run.metrics.iter().map(|metric| {
            let location = locations.get(&metric.channel).map(String::as_str);
            let of = (Some(metric.channel.as_str()), location);
            let numbers = (metric.value, metric.low, metric.high);
            metric_cells(&metric.name, of, numbers, &metric.unit, metric.definition_id.as_deref())
        }));
    }
    Ok(Table::new("metrics", columns(&METRICS), rows))
}

/// A row an impact that was not made.
fn predictions(artifacts: &[Artifact]) -> Result<Table, ReadError> {
    let all = records::<PredictionV1>(artifacts, "/prediction/")?;
    Ok(Table::new("predictions", columns(&PREDICTIONS), all.iter().map(|(_, made)| prediction_row(made)).collect()))
}

/// A row a remark, with its stage.
fn notes(artifacts: &[Artifact]) -> Result<Table, ReadError> {
    let mut rows = Vec::new();
    for artifact in artifacts {
        rows.extend(remarks_of(artifact)?.iter().filter(|remark| !is_no_result(remark)).map(|remark| {
            let severity = if remark.is_warning() { "warning" } else { "note" };
            let RemarkV1 { stage, text, code, about, .. } = remark;
            vec![stage.into(), severity.into(), text.into(), code.into(), about.into()]
        }));
    }
    let names = [("stage", Text), ("severity", Text), ("text", Text), ("code", Text), ("about", Text)];
    Ok(Table::new("notes", columns(&names), rows))
}

/// A table of a fleet.
fn read_parquet(name: &'static str, path: &Path) -> anyhow::Result<Table> {
    let damaged = |error: parquet::errors::ParquetError| {
        Refused::new(format!("{}: {error}", path.display())).hint("run the fleet again: it writes its tables")
    };
    let file = File::open(path).with_context(|| format!("cannot read {}", path.display()))?;
    let reader = SerializedFileReader::new(file).map_err(damaged)?;
    let (mut heads, mut rows) = (Vec::new(), Vec::new());
    for row in reader.get_row_iter(None).map_err(damaged)? {
        let cell = |field: &Field| match field {
            Field::Str(text) => (Text, Cell::Text(text.as_str().into())),
            Field::Double(number) => (Number, Cell::Number(*number)),
            Field::Long(number) => (Count, Cell::Count(*number)),
            Field::Bool(flag) => (Flag, Cell::Flag(*flag)),
            _ => (Text, Cell::Empty),
        };
        let cells: Vec<(String, (Kind, Cell))> =
            row.map_err(damaged)?.get_column_iter().map(|(name, field)| (name.clone(), cell(field))).collect();
        if heads.is_empty() {
            heads = cells.iter().map(|(name, (kind, _))| (name.clone(), *kind)).collect::<Vec<_>>();
        }
        // A column is of the kind of its first value.
        for (head, (_, (kind, cell))) in heads.iter_mut().zip(&cells) {
            if *cell != Cell::Empty {
                head.1 = *kind;
            }
        }
        rows.push(cells.into_iter().map(|(_, (_, cell))| cell).collect());
    }
    Ok(Table::new(name, heads, rows))
}
