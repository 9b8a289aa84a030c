//! The program: options, the artifacts of a run in, the report and its summary out.
//! Uses the library and crumple-stage.

mod gather;

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::thread;

use anyhow::Context;
use crumple_artifact::{replace_atomically, write_atomically};
use crumple_report::numbers::{KM_PER_H_PER_M_PER_S, MILLI, decimals};
use crumple_report::{Page, Ranking, Run, all_figures, summary};
use crumple_signal::Severity;
use crumple_stage::{ExitStatus, Usage, be_quiet, check_pipeline, load_artifacts, say};

/// Writes report.html, which a person looks at, and summary.json, which a script reads.
#[derive(Debug, clap::Parser)]
#[command(
    name = "crumple-report",
    version,
    after_help = "What an input lacks is left out of the report and named in it.\n\
                  Exit codes: 0 done, 1 unforeseen failure, 2 usage, 3 input refused, \
                  4 not one candidate could be simulated (both files are written)."
)]
pub struct Cli {
    /// Artifacts of a run, 1-ingest.mcap to 7-predict.mcap or any of them, in any order.
    #[arg(required = true, value_name = "INPUT")]
    pub inputs: Vec<PathBuf>,

    /// Report to write (one HTML file that needs no network).
    #[arg(short, long, value_name = "REPORT")]
    pub output: PathBuf,

    /// Summary to write [default: summary.json beside the report].
    #[arg(long, value_name = "FILE")]
    pub summary: Option<PathBuf>,

    /// Folder to write each figure to, as an SVG file of its own.
    #[arg(long, value_name = "FOLDER")]
    pub svg: Option<PathBuf>,

    /// Pipeline file of the run; its name goes into the report and the summary.
    #[arg(short, long, value_name = "FILE")]
    pub pipeline: Option<PathBuf>,

    /// Name of the pipeline, instead of the one taken from the pipeline file's path.
    #[arg(long, value_name = "NAME")]
    pub pipeline_name: Option<String>,

    /// Print the summary to stdout as well.
    #[arg(long)]
    pub json: bool,

    /// Accepted so that the same flags fit every stage: both files are always replaced.
    #[arg(long, hide = true)]
    pub force: bool,

    /// No summary on stderr.
    #[arg(short, long)]
    pub quiet: bool,
}

/// Reads the artifacts and writes both files.
///
/// Errors carry their exit status: a pipeline file that is not there is a usage error, a damaged artifact a refusal.
pub fn run(cli: Cli) -> anyhow::Result<ExitStatus> {
    let pipeline = match (&cli.pipeline_name, &cli.pipeline) {
        (Some(name), _) => Some(name.clone()),
        (None, Some(path)) => Some(pipeline_name(path)),
        (None, None) => None,
    };
    if let Some(path) = &cli.pipeline {
        // The table has no keys yet: whatever stands in it is a mistake.
        check_pipeline("report", path, &[])?;
    }
    let summary_path = cli.summary.clone().unwrap_or_else(|| cli.output.with_file_name("summary.json"));
    if summary_path == cli.output {
        return Err(Usage::new("report and summary are the same file").hint("give --summary another name").into());
    }
    for output in [&cli.output, &summary_path] {
        refuse_to_overwrite_an_input(output, &cli.inputs)?;
    }
    if cli.quiet {
        be_quiet();
    }
    let mut run = gather::gather(&load_artifacts(&cli.inputs)?.input)?;
    run.pipeline = pipeline;
    let ranking = Ranking::of_run(&run);
    let json = summary(&run, &ranking).to_json()?;
    write_both(&cli.output, &summary_path, &json, || Page::new(&run, &ranking))
        .with_context(|| format!("cannot write {} and {}", cli.output.display(), summary_path.display()))?;
    if let Some(folder) = &cli.svg {
        write_figures(folder, &run, &ranking)
            .with_context(|| format!("cannot write the figures into {}", folder.display()))?;
    }
    if cli.json {
        // A reader that has seen enough closes the pipe; that is not an error.
        let _ = std::io::stdout().lock().write_all(json.as_bytes());
    }
    if !cli.quiet {
        for line in lines(&run, &ranking) {
            say(format_args!("{:<16} {line}", "report"));
        }
        say(format_args!("{:<16} {}", "report", cli.output.display()));
    }
    if run.no_candidate_simulated() && run.without.is_none() {
        say(format_args!("{:<16} no acceptable result: not one candidate could be simulated", "report"));
        return Ok(ExitStatus::NoAcceptableResult);
    }
    Ok(ExitStatus::Done)
}

/// Writes both files so that a process killed at any moment never leaves two of different runs: both are written whole
/// beside their targets, then the old ones go, then the new ones appear.
fn write_both(report: &Path, summary: &Path, json: &str, lay_out: impl FnOnce() -> Page) -> anyhow::Result<()> {
    // A link stays a link: what it points at is replaced.
    let old = [report, summary].map(|path| fs::canonicalize(path).unwrap_or_else(|_| path.to_owned()));
    write_atomically(summary, |summary| {
        summary.write_all(json.as_bytes())?;
        summary.flush()?;
        let summary: &File = summary.get_ref();
        // Half of the time goes into waiting for the disk: the summary gets there while the page is laid out.
        thread::scope(|scope| {
            let on_disk = scope.spawn(|| summary.sync_data());
            let page = lay_out();
            replace_atomically(report, &old, |file| page.write_to(file))?;
            Ok(on_disk.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?)
        })
    })
}

/// Each figure as `<id>.svg`.
fn write_figures(folder: &Path, run: &Run, ranking: &Ranking) -> anyhow::Result<()> {
    fs::create_dir_all(folder)?;
    for figure in all_figures(run, ranking) {
        write_atomically(&folder.join(figure.id).with_extension("svg"), |file| {
            Ok::<_, anyhow::Error>(file.write_all(figure.to_svg().as_bytes())?)
        })?;
    }
    Ok(())
}

fn refuse_to_overwrite_an_input(output: &Path, inputs: &[PathBuf]) -> anyhow::Result<()> {
    let Ok(existing) = output.canonicalize() else { return Ok(()) };
    if existing.is_file() && !inputs.iter().any(|input| input.canonicalize().is_ok_and(|path| path == existing)) {
        return Ok(());
    }
    let problem = if existing.is_file() { "is an input too" } else { "exists and is no regular file" };
    Err(Usage::new(format!("{} {problem}", output.display())).hint("give it another name").into())
}

/// Name of a pipeline: its path below a folder `pipelines` without the ending, else the file's stem.
fn pipeline_name(path: &Path) -> String {
    let stem = path.with_extension("");
    let parts: Vec<String> = stem.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    let below = parts.iter().rposition(|part| part == "pipelines").map_or(parts.len().saturating_sub(1), |at| at + 1);
    parts[below.min(parts.len())..].join("/")
}

/// The result in a few lines for a terminal.
fn lines(run: &Run, ranking: &Ranking) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(events) = &run.events {
        match (events.dynamic_crush_m, events.time_of_dynamic_crush_s) {
            (Some(crush), Some(t_m)) => {
                let delta_v = events.delta_v_m_per_s.map_or_else(String::new, |v| {
                    format!(", change of velocity {} km/h", decimals(KM_PER_H_PER_M_PER_S * v, 1))
                });
                lines.push(format!(
                    "dynamic crush {} mm at {} ms{delta_v}",
                    decimals(MILLI * crush, 1),
                    decimals(MILLI * t_m, 1)
                ));
            }
            _ => {
                let change =
                    events.delta_v_m_per_s.zip(events.time_of_delta_v_s).map_or_else(String::new, |(v, t_s)| {
                        let (v, t_ms) = (decimals(KM_PER_H_PER_M_PER_S * v, 1), decimals(MILLI * t_s, 1));
                        format!(", change of velocity {v} km/h at {t_ms} ms")
                    });
                lines.push(format!("the velocity does not reach zero: no dynamic crush{change}"));
            }
        }
    }
    let of_name = |name: &str| {
        run.metrics.iter().filter(|m| m.name == name).filter_map(|m| Some((m, m.value?))).collect::<Vec<_>>()
    };
    for (metric, hic) in of_name("hic15") {
        lines.push(format!("{}: HIC15 {}", metric_place(run, &metric.channel), decimals(hic, 1)));
    }
    for (metric, change) in of_name("maximum_delta_v") {
        let change = decimals(KM_PER_H_PER_M_PER_S * change, 1);
        lines.push(format!("{}: maximum delta-v {change} km/h as recorded", metric.channel));
    }
    if let Some(best) = ranking.best.as_deref().and_then(|id| run.candidate(id)) {
        let fit = best.fit_percent().unwrap_or(f64::NAN);
        let open = best.undetermined_in_words().map_or_else(String::new, |open| format!("; {open}"));
        lines.push(format!(
            "recommended model: {}, displacement fit {} %{open}",
            best.name_with_dual(),
            decimals(fit, 2)
        ));
    }
    if let Some(reason) = ranking.no_best.as_deref().filter(|_| !ranking.order.is_empty()) {
        lines.push(format!("no recommended model: {reason}"));
    }
    let warnings = run.notes.iter().filter(|n| n.note.severity == Severity::Warning).count();
    if warnings > 0 {
        lines.push(format!("{warnings} warning{} in the report", if warnings == 1 { "" } else { "s" }));
    }
    lines.extend(run.missing.iter().map(|what| format!("not in the report: {what}")));
    lines
}

/// The location of the first of the channels of a metric, else their ids.
fn metric_place<'a>(run: &'a Run, channels: &'a str) -> &'a str {
    let first = channels.split('+').find_map(|id| run.test.channel(id));
    first.map(|channel| channel.location.as_str()).filter(|location| !location.is_empty()).unwrap_or(channels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pipeline_is_named_by_its_path_below_the_folder_of_pipelines() {
        assert_eq!(pipeline_name(Path::new("pipelines/default.toml")), "default");
        assert_eq!(pipeline_name(Path::new("/a/pipelines/papers/civic.toml")), "papers/civic");
        assert_eq!(pipeline_name(Path::new("../mine.toml")), "mine");
    }
}
