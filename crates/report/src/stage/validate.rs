//! `compare TEST SIM --validate`: simulations against their test.

use std::path::{Path, PathBuf};

use crumple_artifact::OutputKind;
use crumple_signal::{
    Acceleration, IntegrationRule, IntegrationSettings, IntegrationStart, QuantityKind, Sampled, Signal, integrate,
};
use crumple_stage::{Call, ExitStatus, Inputs, Usage, columns, refuse_to_overwrite, say, to_stdout, wrapped};

use super::compare::{as_typed, read_run, refuse_one_run, write};
use crate::compare::document::Said;
use crate::compare::first_screen::shell_word;
use crate::compare::review_files::junit;
use crate::validate::checks::ModelRecords;
use crate::validate::figures::figures;
use crate::validate::requirements::Requirement;
use crate::validate::tables::{broken_lines, sections, suites, to_json};
use crate::validate::validation::{NoComparison, Side, Validation};
use crate::{ComparedRun, RunComparison};

/// What is asked of a validation, and what it writes.
#[derive(Debug, Clone, clap::Args)]
pub struct ValidateArgs {
    /// The first run is a test, or all in front of the first simulation; the others are simulations: which is stiffer,
    /// where, and what forbids trust.
    #[arg(long)]
    pub validate: bool,
    /// A limit that a simulation must keep, such as crush<=20mm or velocity-iso>=0.9; several. Else exit code 1.
    #[arg(long, value_name = "NAME<=VALUE", requires = "validate", value_parser = requirement)]
    require: Vec<Requirement>,
    /// A file with such limits, one a line; they stand in place of those that checks have by themselves.
    #[arg(long, value_name = "FILE", requires = "validate")]
    limits: Option<PathBuf>,
    /// All numbers of the validation as JSON, to a file or to stdout.
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true, default_missing_value = "-")]
    #[arg(requires = "validate")]
    json: Option<PathBuf>,
    /// The requirements as tests of JUnit.
    #[arg(long, value_name = "FILE", requires = "validate")]
    junit: Option<PathBuf>,
}

fn requirement(text: &str) -> Result<Requirement, String> {
    Requirement::read(text, "--require")
}

impl ValidateArgs {
    fn requirements(&self) -> anyhow::Result<Vec<Requirement>> {
        let mut all = Vec::new();
        if let Some(path) = &self.limits {
            let name = path.display().to_string();
            let cannot = |error: std::io::Error| Usage::new(format!("cannot read {name}: {error}"));
            let text = std::fs::read_to_string(path).map_err(cannot)?;
            let hint = "one limit a line, such as crush<=20mm; crumple compare --help lists the names";
            all = Requirement::read_file(&text, &name).map_err(|problem| Usage::new(problem).hint(hint))?;
        }
        all.extend(self.require.iter().cloned());
        Ok(all)
    }
}

/// What a run holds beside what a report shows.
struct Beside {
    model: ModelRecords,
    engine: Option<Sampled>,
}

impl Beside {
    fn new(inputs: &Inputs, run: &ComparedRun) -> Self {
        let records =
            inputs.waves().filter_map(|(id, wave)| Some((id.strip_prefix("model.")?.to_owned(), wave.sampled.clone())));
        Self { model: ModelRecords(records.collect()), engine: engine(inputs, run) }
    }
}

/// Travel of the engine: the first acceleration along the line of driving of a channel whose name, place or code says
/// engine, integrated as the pulse is.
fn engine(inputs: &Inputs, run: &ComparedRun) -> Option<Sampled> {
    let test = &run.run.test;
    let is_engine = |text: &str| ["engine", "engn"].iter().any(|word| text.to_ascii_lowercase().contains(word));
    let channel = test.channels.iter().find(|channel| {
        let texts = [Some(channel.id.as_str()), Some(channel.location.as_str()), channel.code.as_deref()];
        let is_along = channel.axis.is_none_or(|axis| axis == crumple_signal::Axis::X);
        channel.quantity == QuantityKind::Acceleration && is_along && texts.into_iter().flatten().any(is_engine)
    })?;
    let settings = IntegrationSettings {
        rule: IntegrationRule::Trapezoid,
        start: IntegrationStart::Auto,
        impact_speed_m_per_s: test.impact_speed_m_per_s?,
        low_pass_filtered: true,
    };
    let acceleration: Signal<Acceleration> = inputs.wave_if(&channel.id)?.sampled.clone().into();
    integrate(&acceleration, &settings).ok().map(|motion| motion.displacement.into_sampled())
}

/// Reads the runs, compares each simulation with the test, writes what was asked for.
pub fn validate(
    folders: &[PathBuf],
    page: &Path,
    markdown: Option<&Path>,
    args: &ValidateArgs,
    quiet: bool,
    call: &Call,
) -> anyhow::Result<ExitStatus> {
    refuse_one_run(folders)?;
    let requirements = args.requirements()?;
    let json_file = args.json.as_deref().filter(|path| *path != Path::new("-"));
    for (path, kind) in [(json_file, OutputKind::Summary), (args.junit.as_deref(), OutputKind::Junit)] {
        path.map_or(Ok(()), |path| refuse_to_overwrite(path, kind, folders))?;
    }
    let (mut runs, mut beside) = (Vec::new(), Vec::new());
    for (folder, name) in folders.iter().zip(crumple_stage::told_apart(folders)) {
        let (run, inputs) = read_run(folder, name, page)?;
        beside.push(Beside::new(&inputs, &run));
        runs.push(run);
    }
    let sides: Vec<Side<'_>> = runs
        .iter()
        .zip(&beside)
        .map(|(run, beside)| Side { run, model: &beside.model, engine: beside.engine.as_ref() })
        .collect();
    // Tests stand in front of the first simulation; where no run is one by its files, the first is the test.
    let tests = sides.iter().take_while(|side| !side.is_simulated()).count();
    if tests < sides.len() {
        in_order(&sides, folders)?;
    }
    let (tests, simulations) = sides.split_at(if tests == sides.len() { 1 } else { tests });
    let pairs: Vec<(&Side<'_>, &Side<'_>)> =
        simulations.iter().flat_map(|one| tests.iter().map(move |test| (test, one))).collect();
    let all: Result<Vec<Validation>, NoComparison> =
        pairs.iter().map(|(test, one)| Validation::new(test, one, tests.len() > 1, &requirements)).collect();
    let all = match all {
        Ok(all) => all,
        Err(NoComparison { problem, hint }) => {
            say(format_args!("error: nothing to compare: {problem}\n  hint: {hint}"));
            return Ok(ExitStatus::NoAcceptableResult);
        }
    };
    let of = |one: &Validation| Some(one.name.clone()).filter(|_| all.len() > 1);
    let said = all.iter().map(|one| Said { of: of(one), sentences: one.verdict.sentences() }).collect();
    let names = |sides: &[Side<'_>]| sides.iter().map(|side| side.run.name.clone()).collect::<Vec<_>>().join(", ");
    let title = format!("{} against {}", names(simulations), names(tests));
    let comparison = RunComparison::new(&runs)?.of_simulations(
        title,
        said,
        sections(&pairs, &all),
        figures(tests, simulations, &all),
    );
    write(page, OutputKind::Report, &comparison.to_html())?;
    if let Some(path) = markdown {
        write(path, OutputKind::Markdown, &comparison.to_markdown(&as_typed(call)))?;
    }
    if let Some(path) = &args.junit {
        write(path, OutputKind::Junit, &junit("crumple validate", "not-held", &suites(&all)))?;
    }
    let json = || Ok::<_, anyhow::Error>(serde_json::to_string_pretty(&to_json(&all))? + "\n");
    match (&args.json, json_file) {
        (Some(_), Some(path)) => write(path, OutputKind::Summary, &json()?)?,
        (Some(_), None) => to_stdout(json()?.as_bytes())?,
        (None, _) => {}
    }
    if !quiet {
        comparison.sentences().iter().flat_map(|text| wrapped(text, columns())).for_each(say);
        comparison.tables_as_lines().iter().for_each(say);
        say(page.display());
    }
    let broken = broken_lines(&all);
    broken.iter().for_each(|line| say(format_args!("error: {line}")));
    let is_compared = all.iter().all(|one| one.verdict.foreign_pulse.is_none());
    Ok(match (broken.is_empty(), is_compared) {
        (false, _) => ExitStatus::Failure,
        (true, false) => ExitStatus::NoAcceptableResult,
        (true, true) => ExitStatus::Done,
    })
}

/// Errors: a test stands behind a simulation, or no run is a test.
fn in_order(sides: &[Side<'_>], folders: &[PathBuf]) -> Result<(), Usage> {
    let named = |is_simulated: bool| {
        sides.iter().zip(folders).filter(move |(side, _)| side.is_simulated() == is_simulated).map(|(_, folder)| folder)
    };
    let Some(first_test) = named(false).next() else {
        let hint = "put the run of the test in front; without --validate any runs are compared";
        return Err(Usage::new("all runs are simulations, and none is a test").hint(hint));
    };
    if sides.is_sorted_by_key(Side::is_simulated) {
        return Ok(());
    }
    let late = named(true).next().unwrap_or(first_test);
    let words = named(false).chain(named(true)).map(|folder| shell_word(&folder.display().to_string()));
    let order = words.collect::<Vec<_>>().join(" ");
    let problem = format!("{} is a simulation and stands in front of a test", late.display());
    Err(Usage::new(problem).hint(format!("crumple compare {order} --validate")))
}
