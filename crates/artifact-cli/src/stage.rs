//! The program: commands and their options, files in and out, exit code.

use std::cmp::Reverse;
use std::fs;
use std::io::IsTerminal;
use std::path::{Component, Path, PathBuf};

use crate::explain::explain;
use crate::new_stage::{Language, new_stage};
use crate::{
    CurveError, CurveFormat, PlainError, PlainProvenance, PlainWave, SampleForm, ShowOptions, StageNotes, Wanted,
    assemble, check, parse_lines, plain_records, plain_waves, static_curves, text, write_json, write_text,
};
use anyhow::Context;
use crumple_artifact::records::{EventsV1, RemarkV1};
use crumple_artifact::{
    Artifact, ArtifactBuilder, Compression, OutputKind, SCHEMAS, Wave, refuse_named_pipe, write_atomically,
};
use crumple_signal::display::sentence;
use crumple_signal::value::Length;
use crumple_stage::joints::contradictions;
use crumple_stage::{
    Call, DisplayFlag, ExitStatus, Pipeline, Program, Refused, Usage, artifacts_of_a_run, chain, columns, is_no_result,
    keep_budget, kinds, labelled, load_artifacts, nearest, printable, program, refuse_a_mixture, refuse_to_overwrite,
    remarks_of, results_of_an_earlier_run, run_tool, say, to_stdout,
};
use serde::de::DeserializeOwned;

/// Shows and checks artifacts (the *.mcap files of a run), unpacks them into plain files and packs plain files into an
/// artifact; writes kits of stages in other languages.
#[derive(Debug, clap::Parser)]
#[command(
    name = "crumple-artifact",
    version,
    after_help = "Exit codes: 0 done, 1 unforeseen failure, 2 usage, 3 a file was refused."
)]
struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, clap::Subcommand)]
enum Command {
    /// Prints what an artifact holds: where it came from, its records as JSON, its waveforms as a line each.
    Show {
        /// The artifact.
        file: PathBuf,
        /// Only topics that match, e.g. "/parameters/*"; `*` is any text, `?` one character. May be repeated.
        #[arg(long, value_name = "PATTERN")]
        topic: Vec<String>,
        /// Print the samples of waveforms too, time in s and value in the SI unit.
        #[arg(long)]
        samples: bool,
        /// Print one JSON object a line: topic, schema, data. With --samples each waveform is one, too.
        #[arg(long)]
        json: bool,
    },
    /// Prints the notes of a run: warnings by their weight, then the other notes, each with its stage.
    Notes {
        /// The folder of a run, or artifacts.
        #[arg(required = true, value_name = "RUN|FILE")]
        paths: Vec<PathBuf>,
        #[command(flatten)]
        display: DisplayFlag,
    },
    /// Writes the static force-deflection curves of a candidate, for people and for other programs.
    Curve {
        /// The folder of a run, or its 5-parameter-solve.mcap.
        file: PathBuf,
        /// Candidate, e.g. "force-deflection/direct-fit/1" [default: the recommended].
        #[arg(long, value_name = "ID")]
        candidate: Option<String>,
        /// How it is written.
        #[arg(long, value_enum, default_value = "csv")]
        format: CurveFormat,
        /// Deflection up to which it is written, e.g. 900mm [default: that of the last knot; without knots the crush
        /// of the test].
        #[arg(long, value_name = "LENGTH")]
        to: Option<Length>,
    },
    /// Reads artifacts whole and says whether they are sound: checksums, digest, every record and sample, and whether
    /// what they say contradicts itself, or each other in a run.
    Check {
        /// Folders of runs, or artifacts.
        #[arg(required_unless_present = "passport", value_name = "RUN|FILE")]
        files: Vec<PathBuf>,
        /// Run again what `crumple passport` wrote, and compare: exit code 0 equal, 1 not equal, 3 refused.
        #[arg(long, value_name = "FOLDER|FILE.zip", conflicts_with = "files")]
        passport: Option<PathBuf>,
        /// The record of the passport, where that does not hold it.
        #[arg(long, value_name = "RECORD", requires = "passport")]
        record: Option<PathBuf>,
        /// Program of a stage that the run of the passport has from elsewhere: `filter="python3 my.py"`. Several.
        #[arg(long, value_name = "STAGE=COMMAND", requires = "passport")]
        stage: Vec<String>,
    },
    /// Prints what the code behind a warning or an error means, such as CR203: what was found, how it is decided, what
    /// it means, what to do.
    Explain {
        /// Code, and before it the folder of a run for what was found there: `crumple explain RUN CR203`. A run alone:
        /// all that it holds.
        #[arg(required_unless_present = "markdown", num_args = 1..=2, value_name = "[RUN] [CODE]")]
        words: Vec<PathBuf>,
        /// As sections of a page of Markdown; without a code those of all.
        #[arg(long)]
        markdown: bool,
        #[command(flatten)]
        display: DisplayFlag,
    },
    /// Writes an artifact as plain files: records.ndjson, waves.ndjson with a file of samples each (little-endian f64,
    /// or text), provenance.json.
    Unpack {
        /// The artifact.
        file: PathBuf,
        /// Folder to write; must not exist or be empty.
        folder: PathBuf,
        /// Write waveforms as text, a number a line, for shells and spreadsheets.
        #[arg(long)]
        text: bool,
        /// Write into a folder that holds something.
        #[arg(long)]
        force: bool,
        /// No summary.
        #[arg(short, long)]
        quiet: bool,
    },
    /// Makes an artifact of plain files as `unpack` writes them, or of one file of records as `--json` prints them.
    Pack {
        /// The folder, or an .ndjson file of records.
        source: PathBuf,
        /// Artifact to write.
        file: PathBuf,
        /// Compress with Zstandard; the content and its digest stay the same.
        #[arg(long)]
        zstd: bool,
        /// No summary.
        #[arg(short, long)]
        quiet: bool,
    },
    /// Writes a working stage of your own to change: a program, its test, the contract of its place in the chain.
    NewStage {
        /// Stage that it takes the place of: filter, integrate, identify, parameter-solve, simulate, predict.
        stage: String,
        /// Language of the program.
        #[arg(short, long, value_enum)]
        language: Language,
        /// Folder for the files [default: my-STAGE].
        #[arg(short, long, value_name = "FOLDER")]
        output: Option<PathBuf>,
    },
}

/// What is asked of a passport: its crate, the record, the programs that stand for stages.
#[derive(Debug, Clone)]
pub struct PassportCheck {
    /// Folder, or zip archive.
    pub passport: PathBuf,
    /// The record, where it is not in the crate.
    pub record: Option<PathBuf>,
    /// `filter=python3 my.py`.
    pub stages: Vec<String>,
}

/// Runs a passport again.
pub type CheckPassport = fn(&PassportCheck) -> anyhow::Result<ExitStatus>;

/// The program.
pub const PROGRAM: Program = Program::of_tool::<Args>("artifact", |call| artifact(call, None));

/// The program, with what can run the chain again.
pub fn artifact(call: &Call, check_passport: Option<CheckPassport>) -> ExitStatus {
    run_tool(call, |args| run(args, check_passport))
}

fn run(args: Args, check_passport: Option<CheckPassport>) -> anyhow::Result<ExitStatus> {
    match args.command {
        Command::Show { file, topic, samples, json } => {
            show(&file, &ShowOptions { topics: Wanted(topic), samples }, json)
        }
        Command::Notes { paths, display } => notes(&paths, display),
        Command::Curve { file, candidate, format, to } => curve(&file, candidate.as_deref(), format, to),
        Command::Check { passport: Some(passport), record, stage, .. } => {
            let problem = "--passport runs the chain, which this program alone cannot";
            let check = check_passport.ok_or_else(|| Usage::new(problem).hint("crumple check --passport FILE.zip"))?;
            check(&PassportCheck { passport, record, stages: stage })
        }
        Command::Check { files, .. } => check_files(&files),
        Command::Explain { words, markdown, display } => {
            let pipeline = words.first().and_then(|run| pipeline_of(run));
            let display = display.or_of(pipeline.as_ref())?;
            explain(&words, markdown, display, &remarks_of_a_run)
        }
        Command::Unpack { file, folder, text, force, quiet } => {
            let form = if text { SampleForm::Text } else { SampleForm::Bytes };
            unpack(&file, &folder, form, force, quiet)
        }
        Command::Pack { source, file, zstd, quiet } => pack(&source, &file, zstd, quiet),
        Command::NewStage { stage, language, output } => new_stage(&stage, language, output),
    }
}

fn open(path: &Path) -> Result<Artifact, Refused> {
    keep_budget(&[path.to_owned()], ExitStatus::Refused);
    Artifact::open(path).map_err(Refused::from)
}

fn show(path: &Path, options: &ShowOptions, json: bool) -> anyhow::Result<ExitStatus> {
    let artifact = open(path)?;
    let mut bytes = Vec::new();
    let written =
        if json { write_json(&artifact, options, &mut bytes) } else { write_text(&artifact, options, &mut bytes) };
    written.map_err(Refused::from)?.context("cannot print the artifact")?;
    if json {
        to_stdout(&bytes)?;
    } else {
        to_stdout(printable(&String::from_utf8_lossy(&bytes)).as_bytes())?;
    }
    Ok(ExitStatus::Done)
}

/// Columns of mark, weight and stage in front of a note.
const LABEL_OF_A_NOTE: usize = 28;

fn notes(paths: &[PathBuf], display: DisplayFlag) -> anyhow::Result<ExitStatus> {
    let pipeline = paths.first().and_then(|run| pipeline_of(run));
    let display = display.or_of(pipeline.as_ref())?;
    let mut files = Vec::new();
    let (mut ranked, mut allowed) = (None, Vec::new());
    for path in paths {
        if path.is_dir() {
            files.extend(artifacts_of_a_run(path)?);
            if let Some(problem) = results_of_an_earlier_run(path) {
                say(format_args!("note: {problem}"));
            }
            ranked = concerns_of_a_run(path).filter(|_| paths.len() == 1);
            allowed = pipeline_of(path).map_or(Vec::new(), |pipeline| pipeline.allowed().collect());
        } else {
            files.push(path.clone());
        }
    }
    keep_budget(&files, ExitStatus::Refused);
    // Those of one run, or nothing is said of them together.
    let loaded = load_artifacts(&files)?.input;
    let notes = StageNotes::of(loaded.artifacts()).map_err(Refused::from)?;
    let notes = match ranked {
        Some(concerns) => notes.ranked_as(concerns, &allowed),
        None => notes,
    };
    // A line each where a program reads them.
    let columns = if std::io::stdout().is_terminal() { columns() } else { usize::MAX };
    let shown = |text: &str| display.during(|| sentence(text).into_owned());
    let lines =
        notes.lines().into_iter().flat_map(|(label, text)| labelled(&label, LABEL_OF_A_NOTE, &shown(&text), columns));
    let text: String = lines.map(|line| line + "\n").collect();
    to_stdout(printable(&text).as_bytes())?;
    Ok(ExitStatus::Done)
}

/// The warnings of the summary of a run. One of an earlier version has no codes: a diagnosis is known by its severity.
fn concerns_of_a_run(folder: &Path) -> Option<Vec<RemarkV1>> {
    let rows: Vec<serde_json::Value> = in_summary(folder, "concerns")?;
    let is_code = |code: &&str| is_no_result(&RemarkV1 { code: (*code).to_owned(), ..RemarkV1::default() });
    let no_result = kinds().iter().map(|kind| kind.code).find(is_code);
    let remark = |mut row: serde_json::Value| {
        if row["severity"] == "no-result" {
            row["code"] = no_result.into();
        }
        serde_json::from_value(row).ok()
    };
    rows.into_iter().map(remark).collect()
}

/// A list of the summary of a run, if it has one.
fn in_summary<T: DeserializeOwned>(folder: &Path, key: &str) -> Option<Vec<T>> {
    let text = fs::read_to_string(folder.join("summary.json")).ok()?;
    let mut summary: serde_json::Value = serde_json::from_str(&text).ok()?;
    serde_json::from_value(summary.get_mut(key)?.take()).ok()
}

fn curve(path: &Path, candidate: Option<&str>, format: CurveFormat, to: Option<Length>) -> anyhow::Result<ExitStatus> {
    let to_m = to.map(Length::si);
    if to_m.is_some_and(|to| !(to > 0.0 && to.is_finite())) {
        return Err(Usage::new("--to must be above zero").hint("--to 900mm").into());
    }
    let solved = path.join("5-parameter-solve.mcap");
    if path.is_dir() {
        artifacts_of_a_run(path)?;
    }
    let path = if path.is_dir() { &solved } else { path };
    // Of a run the motion stands beside its candidates.
    let motion = Some(path.with_file_name("3-integrate.mcap")).filter(|motion| motion.is_file());
    let events =
        motion.map(|motion| open(&motion)?.record::<EventsV1>("/events").map_err(Refused::from)).transpose()?;
    let crush_m = events.flatten().and_then(|events| events.dynamic_crush_m).filter(|crush| *crush > 0.0);
    let curves = static_curves(&open(path)?, candidate, to_m, crush_m).map_err(|error| {
        let hint = match &error {
            CurveError::NoCandidates => "give 5-parameter-solve.mcap of a run, or its folder",
            CurveError::NoneRecommended { .. } | CurveError::NoCandidate { .. } => "name one with --candidate",
            CurveError::NoEnd { .. } => "say up to which deflection: --to 900mm",
            CurveError::NoStaticForce { .. } => {
                "take a candidate with a spring or a force-deflection curve: --candidate"
            }
            CurveError::Model(_) | CurveError::Read(_) => "the command check says what is wrong with the artifact",
        };
        Refused::new(format!("{}: {error}", path.display())).hint(hint)
    })?;
    to_stdout(text(&curves, format).as_bytes())?;
    Ok(ExitStatus::Done)
}

/// Checks files by themselves, and the artifacts of a run folder against each other too.
fn check_files(paths: &[PathBuf]) -> anyhow::Result<ExitStatus> {
    let mut status = ExitStatus::Done;
    for path in paths {
        let files = if path.is_dir() { artifacts_of_a_run(path)? } else { vec![path.clone()] };
        keep_budget(&files, ExitStatus::Refused);
        let (mut artifacts, mut is_sound) = (Vec::new(), true);
        for file in files {
            let (faults, line) = match Artifact::open(&file) {
                Err(error) => (vec![error.to_string()], None),
                Ok(artifact) => {
                    let checked = check(&artifact);
                    artifacts.push(artifact);
                    match checked {
                        Err(faults) => (faults, None),
                        Ok(ok) => (Vec::new(), Some(ok.line(&file))),
                    }
                }
            };
            if let Some(line) = line {
                to_stdout(printable(&line).as_bytes())?;
            } else {
                status = ExitStatus::Refused;
                is_sound = false;
            }
            let name = file.display().to_string();
            for fault in faults {
                // Errors of the reader name the file themselves.
                let fault = if fault.contains(&name) { fault } else { format!("{name}: {fault}") };
                say(format_args!("error: {fault}"));
            }
        }
        let run = path.is_dir().then_some(path.as_path());
        if let Some(earlier) = run.and_then(results_of_an_earlier_run) {
            status = ExitStatus::Refused;
            say(format_args!("error: {earlier}"));
        }
        let faults = if is_sound { faults_together(&artifacts, run) } else { Vec::new() };
        for fault in &faults {
            status = ExitStatus::Refused;
            say(format_args!("error: {fault}"));
        }
        if !faults.is_empty() {
            continue;
        }
        for found in contradictions(&artifacts, pipeline_of(path).as_ref()) {
            if found.ends_the_run {
                status = ExitStatus::Refused;
            }
            say(found.in_lines(&artifacts));
        }
    }
    Ok(status)
}

/// Why artifacts are not those of one run: each that a folder lacks, results that were not made from each other. What
/// such artifacts contradict each other in is not a fault of who wrote them.
fn faults_together(artifacts: &[Artifact], run: Option<&Path>) -> Vec<String> {
    let name = |artifact: &Artifact| artifact.path().display().to_string();
    let missing: Vec<String> = match run {
        None => Vec::new(),
        Some(_) => artifacts.iter().filter_map(|artifact| missing_input(artifact, artifacts)).collect(),
    };
    let gone = run.filter(|_| missing.is_empty()).and_then(missing_output);
    let mixture = refuse_a_mixture(artifacts, name).err().map(|mixture| mixture.to_string());
    missing.into_iter().chain(gone).chain(mixture).collect()
}

/// What a run folder does not hold, and its whole run made.
fn missing_output(run: &Path) -> Option<String> {
    let pipeline =
        pipeline_of(run).filter(|pipeline| pipeline.end().is_some() && Pipeline::failure_in(run).is_none())?;
    // Of several tests with one model the folder has no motion of its own.
    let made = chain().filter(|stage| !stage.is_optional || pipeline.table(stage.name).is_some());
    let is_of_one = run.join("1-ingest.mcap").is_file();
    let gone = made.filter(|_| is_of_one).flat_map(|stage| stage.outputs).find(|name| !run.join(name).is_file())?;
    Some(format!("{}: there is no {gone}, which the run made", run.display()))
}

/// The pipeline of a run folder; `None` where there is none that can be read, which is no fault of its artifacts.
fn pipeline_of(folder: &Path) -> Option<Pipeline> {
    Pipeline::read(&folder.join(Pipeline::OF_A_RUN), None).ok()
}

/// What an artifact of a run folder was made from and is not there.
fn missing_input(artifact: &Artifact, all: &[Artifact]) -> Option<String> {
    let inputs = &artifact.provenance()?.inputs;
    let is_input = |kind: &str| inputs.iter().any(|input| input.kind == kind);
    let is_there = |kind: &str| all.iter().any(|other| other.stage() == Some(kind));
    let stages = chain().filter(|stage| is_input(stage.name) && !is_there(stage.name));
    let missing = stages.filter_map(|stage| stage.outputs.first().copied()).next()?;
    Some(format!("{} was made from {missing}, which is not in the folder", artifact.path().display()))
}

/// What every stage of a run remarks, what its artifacts contradict each other in, and what its report adds.
fn remarks_of_a_run(run: &Path) -> anyhow::Result<Vec<RemarkV1>> {
    let artifacts = artifacts_of_a_run(run)?.iter().map(|path| open(path)).collect::<Result<Vec<_>, _>>()?;
    if let Some(fault) = faults_together(&artifacts, Some(run)).into_iter().next() {
        let hint = format!("{} makes the run again", program("run"));
        return Err(Refused::new(fault).expected("the artifacts of one run").hint(hint).into());
    }
    if let Some(earlier) = results_of_an_earlier_run(run) {
        say(format_args!("note: {earlier}"));
    }
    let contradictions = contradictions(&artifacts, pipeline_of(run).as_ref());
    let mut all: Vec<RemarkV1> = contradictions.iter().map(|found| found.remark(None)).collect();
    for artifact in &artifacts {
        for remark in remarks_of(artifact).map_err(Refused::from)? {
            // A stage without anything to work on hands on what an earlier one said.
            if !all.contains(&remark) {
                all.push(remark);
            }
        }
    }
    let in_summary: Vec<RemarkV1> = in_summary(run, "remarks").unwrap_or_default();
    all.extend(
        in_summary.into_iter().filter(|remark| !all.iter().any(|known| known.text == remark.text)).collect::<Vec<_>>(),
    );
    all.sort_by_key(|remark| Reverse(remark.weight));
    Ok(all)
}

fn unpack(path: &Path, target: &Path, form: SampleForm, force: bool, quiet: bool) -> anyhow::Result<ExitStatus> {
    let artifact = open(path)?;
    write(&artifact, target, form, force)?;
    if !quiet {
        let (records, waves) = (artifact.records().len(), artifact.waves().len());
        say(format_args!("{records} records, {waves} waves -> {}", target.display()));
    }
    Ok(ExitStatus::Done)
}

fn pack(source: &Path, path: &Path, zstd: bool, quiet: bool) -> anyhow::Result<ExitStatus> {
    keep_budget(&[source.to_owned()], ExitStatus::Refused);
    refuse_to_overwrite(path, OutputKind::Artifact, &[source.to_owned()])?;
    let (builder, provenance) = read(source)?;
    let compression = if zstd { Compression::Zstd } else { Compression::None };
    let digest = builder.digest()?;
    builder.write(path, &provenance.of_packed(&digest), compression)?;
    if !quiet {
        say(format_args!("{} -> {}, digest {digest}", source.display(), path.display()));
    }
    Ok(ExitStatus::Done)
}

const RECORDS: &str = "records.ndjson";
const WAVES: &str = "waves.ndjson";
const PROVENANCE: &str = "provenance.json";

/// Writes an artifact as a folder of plain files.
pub fn write(artifact: &Artifact, folder: &Path, form: SampleForm, force: bool) -> anyhow::Result<()> {
    let records = plain_records(artifact).map_err(Refused::from)?;
    if !force && fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some()) {
        let problem = format!("{} exists and is not empty", folder.display());
        return Err(Usage::new(problem).hint("give a new folder, or --force").into());
    }
    let put = |name: &str, kind: OutputKind, bytes: &[u8]| {
        let path = folder.join(name);
        let inside = path.ancestors().take_while(|inner| *inner != folder);
        if let Some(link) = inside.into_iter().find(|inner| inner.is_symlink()) {
            return Err(Usage::new(format!("{} is a link", link.display()))
                .hint("remove it, or give a new folder")
                .into());
        }
        refuse_to_overwrite(&path, kind, &[artifact.path().to_owned()])?;
        write_atomically(&path, kind, |file| io_write(file, bytes))
            .with_context(|| format!("cannot write {}", path.display()))
    };
    let mut lines = String::new();
    let kind = match form {
        SampleForm::Bytes => OutputKind::Numbers,
        // No content tells numbers in text from other text; `--force` asks to replace them.
        SampleForm::Text => OutputKind::Export,
    };
    for (line, wave) in plain_waves(artifact, form).iter().zip(artifact.waves().values()) {
        put(&line.file, kind, &form.content(wave))?;
        lines += &serde_json::to_string(line)?;
        lines.push('\n');
    }
    put(WAVES, OutputKind::Lines, lines.as_bytes())?;
    if let Some(provenance) = artifact.provenance() {
        let text = serde_json::to_string_pretty(&PlainProvenance::of_content(provenance, artifact.digest()))?;
        put(PROVENANCE, OutputKind::Lines, format!("{text}\n").as_bytes())?;
    }
    put(RECORDS, OutputKind::Lines, records.as_bytes())
}

fn io_write(file: &mut impl std::io::Write, bytes: &[u8]) -> std::io::Result<()> {
    file.write_all(bytes)
}

/// Reads a folder of plain files, or a single file of records.
pub fn read(source: &Path) -> anyhow::Result<(ArtifactBuilder, PlainProvenance)> {
    let refuse = |error: PlainError| Refused::new(error.to_string()).hint("docs/format.md has the record types");
    if !source.is_dir() {
        let records = parse_lines(&source.display().to_string(), &text_of(source)?).map_err(refuse)?;
        return Ok((assemble(records, Vec::new(), &nearest_schema).map_err(refuse)?, PlainProvenance::default()));
    }
    let lines = |name: &str| -> anyhow::Result<Option<(String, String)>> {
        let path = source.join(name);
        if !path.exists() {
            return Ok(None);
        }
        Ok(Some((path.display().to_string(), text_of(&path)?)))
    };
    let (records, wave_lines) = (lines(RECORDS)?, lines(WAVES)?);
    if records.is_none() && wave_lines.is_none() {
        return Err(Refused::new(format!("{}: neither {RECORDS} nor {WAVES} is in it", source.display()))
            .hint(format!("{} shows what a folder looks like", program("artifact unpack FILE DIR")))
            .into());
    }
    let records = match records {
        None => Vec::new(),
        Some((name, text)) => parse_lines(&name, &text).map_err(refuse)?,
    };
    let mut waves = Vec::new();
    if let Some((name, text)) = wave_lines {
        for line in parse_lines::<PlainWave>(&name, &text).map_err(refuse)? {
            let wave = wave(source, &line, refuse)?;
            waves.push((line.id, wave));
        }
    }
    let provenance: PlainProvenance = match lines(PROVENANCE)? {
        None => PlainProvenance::default(),
        Some((name, text)) => serde_json::from_str(&text).map_err(|error| Refused::new(format!("{name}: {error}")))?,
    };
    Ok((assemble(records, waves, &nearest_schema).map_err(refuse)?, provenance))
}

fn wave(folder: &Path, line: &PlainWave, refuse: impl Fn(PlainError) -> Refused) -> anyhow::Result<Wave> {
    let inside =
        Path::new(&line.file).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if !inside {
        let problem = format!("file {:?} lies outside the folder", line.file);
        return Err(refuse(PlainError::Wave { id: line.id.clone(), problem }).into());
    }
    let path: PathBuf = folder.join(&line.file);
    let bytes = refuse_named_pipe(&path)
        .and_then(|()| fs::read(&path))
        .map_err(|error| Refused::new(format!("cannot read {}: {error}", path.display())))?;
    Ok(line.with_bytes(&bytes).map_err(refuse)?)
}

/// The schema that a mistyped name may mean.
fn nearest_schema(name: &str) -> Option<&'static str> {
    nearest(name, SCHEMAS.iter().copied())
}

fn text_of(path: &Path) -> anyhow::Result<String> {
    fs::read_to_string(path).map_err(|error| Refused::new(format!("cannot read {}: {error}", path.display())).into())
}
