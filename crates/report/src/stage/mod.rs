//! The program: options, the artifacts of a run in, the report and its summary out.

pub mod accept;
mod compare;
mod console;
pub mod diff;
mod gather;
mod index;
mod pictures;
mod results;
mod run_folders;
pub mod together;
mod validate;

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::thread;

use crate::{ComparedRun, Kind, Page, Ranking, Run, Summary, all_figures, first_screen, summary, write_shared_files};
use anyhow::Context;
use console::Screen;
use crumple_artifact::{OutputKind, replace_atomically, write_atomically};
use crumple_signal::Display;
use crumple_stage::{
    Call, DisplayFlag, ExitStatus, Pipeline, Program, Usage, artifacts_of_a_run, be_quiet, keep_budget, load_artifacts,
    pipeline_table, refuse_to_overwrite, results_of_an_earlier_run, run_tool, say, to_stdout,
};
use pictures::{Fonts, write_figures};

/// Writes the report of a run: report.html for people and summary.json for scripts; or a page of several runs.
#[derive(Debug, clap::Parser)]
#[command(
    name = "crumple-report",
    version,
    after_help = "What an input lacks is left out of the report and named in it.\n\
                  Exit codes: 0 done, 1 unforeseen failure, 2 usage, 3 input refused, \
                  4 not one candidate could be simulated (both files are written)."
)]
pub struct Cli {
    /// Artifacts of a run, 1-ingest.mcap to 7-predict.mcap or any of them, in any order, or its folder: then the report
    /// in it is written again; with --compare run folders, with --index run folders or lists of them (@list.txt), with
    /// --together one folder.
    #[arg(required = true, value_name = "INPUT")]
    pub inputs: Vec<PathBuf>,

    /// Page to write (one HTML file that needs no network) [default with --compare: compare.html, with --index:
    /// index.html, with --together: report.html in the folder].
    #[arg(short, long, value_name = "PAGE")]
    pub output: Option<PathBuf>,

    /// Compare run folders: curves over each other, numbers and settings side by side, differences marked.
    #[arg(long, conflicts_with_all = ["summary", "svg", "png", "pipeline", "pipeline_name", "json"])]
    pub compare: bool,

    /// Index of run folders: a sortable row a run, with its pulse, key numbers, recommended model and first warning.
    #[arg(long, conflicts_with_all = ["compare", "summary", "svg", "png", "markdown"])]
    #[arg(conflicts_with_all = ["pipeline", "pipeline_name", "json"])]
    pub index: bool,

    /// One model for several tests: the page of a folder that `just together` made, with each test predicted from the
    /// others.
    #[arg(long, conflicts_with_all = ["compare", "index", "summary", "svg", "png", "markdown", "json"])]
    pub together: bool,

    /// Markdown to write too, for a merge request: what the page says first.
    #[arg(long, value_name = "FILE")]
    pub markdown: Option<PathBuf>,

    /// Where the record lies, for the command in the Markdown that makes the run again [default: here, if a file of its
    /// name is].
    #[arg(long, value_name = "PATH", requires = "markdown")]
    pub record: Option<PathBuf>,

    /// Summary to write [default: summary.json beside the report].
    #[arg(long, value_name = "FILE")]
    pub summary: Option<PathBuf>,

    /// Folder to write each figure to, as an SVG file of its own.
    #[arg(long, value_name = "FOLDER")]
    pub svg: Option<PathBuf>,

    /// Folder to write each figure to, as a PNG file of its own; its text needs a font of the system.
    #[arg(long, value_name = "FOLDER")]
    pub png: Option<PathBuf>,

    /// Folder with style and scripts that many pages share, as seen from the page; missing files are written there
    /// [default: none, the page holds them].
    #[arg(long, value_name = "FOLDER", conflicts_with_all = ["compare", "index"])]
    pub shared: Option<String>,

    /// Pipeline file of the run; its name goes into the report and the summary.
    #[arg(short, long, value_name = "FILE")]
    pub pipeline: Option<PathBuf>,

    /// Name of the pipeline, instead of the one that a run noted in the file or that its path has.
    #[arg(long, value_name = "NAME")]
    pub pipeline_name: Option<String>,

    /// Print the summary to stdout as well.
    #[arg(long)]
    pub json: bool,

    /// Check the options and end: nothing is read, nothing is written.
    #[arg(long, hide = true)]
    pub check_options: bool,

    /// Accepted so that the same flags fit every stage: both files are always replaced.
    #[arg(long, hide = true)]
    pub force: bool,

    /// Accepted for the same reason: neither file is an artifact.
    #[arg(long, hide = true, value_name = "KIND")]
    pub compress: Option<String>,

    /// The summary on stdout, not on stderr: `crumple run` answers with it.
    #[arg(long, hide = true)]
    pub answer: bool,

    /// The same of files that are written: nothing is written again.
    #[arg(long, hide = true)]
    pub answer_again: bool,

    #[command(flatten)]
    pub display: DisplayFlag,

    /// No summary on stderr.
    #[arg(short, long)]
    pub quiet: bool,
}

impl Cli {
    /// A run folder stands for its artifacts, its pipeline and its report.
    fn take_folder(&mut self) -> anyhow::Result<()> {
        let [folder] = &self.inputs[..] else { return Ok(()) };
        if self.together || !folder.is_dir() {
            return Ok(());
        }
        let own = Some(folder.join(Pipeline::OF_A_RUN)).filter(|own| own.is_file());
        self.pipeline = self.pipeline.take().or(own);
        self.output = self.output.take().or_else(|| Some(folder.join("report.html")));
        if let Some(problem) = results_of_an_earlier_run(folder) {
            say(format_args!("note: {problem}"));
        }
        self.inputs = artifacts_of_a_run(folder)?;
        Ok(())
    }
}

/// The program.
pub const PROGRAM: Program = Program {
    remarks: &[crate::findings::REMARKS],
    ..Program::of_tool::<Cli>("report", |call| run_tool(call, |cli| run(cli, call)))
};

/// Many run folders as a table on one page.
#[derive(Debug, clap::Parser)]
#[command(name = "crumple-index", version)]
pub struct IndexCli {
    /// Run folders, or lists of them (@list.txt).
    #[arg(required = true, value_name = "RUN")]
    inputs: Vec<PathBuf>,
    /// Page to write.
    #[arg(short, long, value_name = "PAGE", default_value = "index.html")]
    output: PathBuf,
    #[command(flatten)]
    display: DisplayFlag,
    /// No summary on stderr.
    #[arg(short, long)]
    quiet: bool,
}

/// Several runs on one page: curves over each other, numbers and settings side by side, differences marked; or
/// simulations against their test.
#[derive(Debug, clap::Parser)]
#[command(name = "crumple-compare", version, after_long_help = crate::validate::requirements::help())]
pub struct CompareCli {
    /// Run folders; with --validate records too, which are run first (into runs/).
    #[arg(required = true, value_name = "RUN")]
    pub inputs: Vec<PathBuf>,
    /// Page to write.
    #[arg(short, long, value_name = "PAGE", default_value = "compare.html")]
    output: PathBuf,
    /// Markdown to write too, for a merge request: what the page says first.
    #[arg(long, value_name = "FILE")]
    markdown: Option<PathBuf>,
    /// Simulations against their test.
    #[command(flatten)]
    pub validation: validate::ValidateArgs,
    #[command(flatten)]
    display: DisplayFlag,
    /// No summary on stderr.
    #[arg(short, long)]
    quiet: bool,
}

/// `crumple-report --index` by itself.
pub const INDEX: Program = Program::of_tool::<IndexCli>("index", |call| {
    run_tool(call, |cli: IndexCli| {
        cli.display.or_of(None)?.during(|| index::index(&cli.inputs, &cli.output, cli.quiet))
    })
});

/// `crumple-report --compare` by itself.
pub const COMPARE: Program =
    Program::of_tool::<CompareCli>("compare", |call| run_tool(call, |cli: CompareCli| compare_runs(&cli, call)));

/// Compares run folders as the call asks for.
pub fn compare_runs(cli: &CompareCli, call: &Call) -> anyhow::Result<ExitStatus> {
    let CompareCli { inputs, output, markdown, validation, display, quiet } = cli;
    display.or_of(None)?.during(|| match validation.validate {
        true => validate::validate(inputs, output, markdown.as_deref(), validation, *quiet, call),
        false => compare::compare(inputs, output, markdown.as_deref(), *quiet, call),
    })
}

/// Reads the artifacts and writes both files.
///
/// Errors carry their exit status: a pipeline file that is not there is a usage error, a damaged artifact a refusal.
fn run(mut cli: Cli, call: &Call) -> anyhow::Result<ExitStatus> {
    if cli.compare {
        let page = cli.output.as_deref().unwrap_or(Path::new("compare.html"));
        let compare = || compare::compare(&cli.inputs, page, cli.markdown.as_deref(), cli.quiet, call);
        return cli.display.or_of(None)?.during(compare);
    }
    if cli.index {
        let page = cli.output.as_deref().unwrap_or(Path::new("index.html"));
        return cli.display.or_of(None)?.during(|| index::index(&cli.inputs, page, cli.quiet));
    }
    cli.take_folder()?;
    let of_folder = cli.together.then(|| cli.inputs.first().map(|folder| folder.join("report.html"))).flatten();
    if cli.together && cli.inputs.len() != 1 {
        return Err(Usage::new("one page is of one folder").hint("name the folder that the joint run made").into());
    }
    let Some(output) = cli.output.as_ref().or(of_folder.as_ref()) else {
        return Err(Usage::new("no report to write is named").hint("add -o").into());
    };
    let file = cli.pipeline.as_deref().map(|path| Pipeline::read(path, None)).transpose()?;
    let stated = file.as_ref().and_then(|file| file.name().map(str::to_owned));
    let pipeline = cli.pipeline_name.clone().or(stated).or_else(|| cli.pipeline.as_deref().map(pipeline_name));
    if let Some(file) = &file {
        pipeline_table("report", file, &["display"])?;
    }
    let display = cli.display.or_of(file.as_ref())?;
    if cli.check_options {
        return Ok(ExitStatus::Done);
    }
    if let (true, [folder]) = (cli.together, &cli.inputs[..]) {
        return display.during(|| together::together(folder, output, pipeline, cli.quiet));
    }
    let summary_path = cli.summary.clone().unwrap_or_else(|| output.with_file_name("summary.json"));
    if summary_path == *output {
        return Err(Usage::new("report and summary are the same file").hint("give --summary another name").into());
    }
    refuse_to_overwrite(output, OutputKind::Report, &cli.inputs)?;
    refuse_to_overwrite(&summary_path, OutputKind::Summary, &cli.inputs)?;
    let fonts = cli.png.as_ref().map(|_| Fonts::of_system()).transpose()?;
    be_quiet(cli.quiet);
    keep_budget(&cli.inputs, ExitStatus::Refused);
    let mut run = gather::gather(&load_artifacts(&cli.inputs)?.input, file.as_ref())?;
    run.pipeline = pipeline;
    let ranking = Ranking::of_run(&run);
    let summary = summary(&run, &ranking);
    let status = status_of(&summary);
    let outcome = Outcome { run, ranking, summary };
    display.during(|| outcome.write(&cli, output, &summary_path, fonts.as_ref()))?;
    Ok(status)
}

/// What a run came to. The summary is metric, whatever is shown.
struct Outcome {
    run: Run,
    ranking: Ranking,
    summary: Summary,
}

impl Outcome {
    /// Writes and prints what is asked for, in the units that are shown now.
    fn write(self, cli: &Cli, output: &Path, summary_path: &Path, fonts: Option<&Fonts>) -> anyhow::Result<()> {
        let Self { run, ranking, summary } = self;
        let json = summary.to_json()?;
        let (run, shown) = match Display::now() {
            Display::Si => (run, summary),
            Display::Us => {
                let run = run.with_sentences_shown();
                let shown = crate::summary(&run, &ranking);
                (run, shown)
            }
        };
        let screen = || Screen::of(&run, &ranking, &shown, output);
        if cli.answer_again {
            return answer(cli, &screen());
        }
        if let Some(folder) = &cli.shared {
            let folder = output.parent().unwrap_or(Path::new("")).join(folder);
            write_shared_files(&folder)
                .with_context(|| format!("cannot write the files that pages share into {}", folder.display()))?;
        }
        let page = || Page::of(&run, &ranking, (&shown, &json), cli.shared.as_deref());
        write_both(output, summary_path, &json, page)
            .with_context(|| format!("cannot write {} and {}", output.display(), summary_path.display()))?;
        if let Some(folder) = &cli.svg {
            write_figures(folder, "svg", &all_figures(&run, &ranking), |figure| Ok(figure.to_svg().into_bytes()))?;
        }
        if let (Some(folder), Some(fonts)) = (&cli.png, fonts) {
            write_figures(folder, "png", &all_figures(&run, &ranking), |figure| fonts.png(figure))?;
        }
        if cli.json {
            to_stdout(json.as_bytes())?;
        }
        if !cli.quiet {
            answer(cli, &screen())?;
        }
        match &cli.markdown {
            Some(path) => write_markdown(path, cli, output, run),
            None => Ok(()),
        }
    }
}

fn write_markdown(path: &Path, cli: &Cli, output: &Path, run: Run) -> anyhow::Result<()> {
    let own = output.with_file_name(Pipeline::OF_A_RUN);
    let own = own.is_file().then(|| own.display().to_string());
    let run = ComparedRun::new(String::new(), None, run);
    let here = Path::new(&run.run.test.source.name);
    let record =
        cli.record.as_deref().or_else(|| here.is_file().then_some(here)).map(|path| path.display().to_string());
    let text = first_screen(&run, own.as_deref(), record.as_deref());
    compare::write(path, OutputKind::Markdown, &text)
}

fn status_of(summary: &Summary) -> ExitStatus {
    if summary.verdict.kind == Kind::NoModel { ExitStatus::NoAcceptableResult } else { ExitStatus::Done }
}

/// Prints the lines of the summary.
fn answer(cli: &Cli, screen: &Screen) -> anyhow::Result<()> {
    if cli.answer || cli.answer_again {
        return screen.to_stdout();
    }
    screen.say();
    Ok(())
}

/// Writes both files so that a process killed at any moment never leaves two of different runs: both are written whole
/// beside their targets, then the old ones go, then the new ones appear.
fn write_both(report: &Path, summary: &Path, json: &str, lay_out: impl FnOnce() -> Page) -> anyhow::Result<()> {
    // A link stays a link: what it points at is replaced.
    let old = [report, summary].map(|path| fs::canonicalize(path).unwrap_or_else(|_| path.to_owned()));
    write_atomically(summary, OutputKind::Summary, |summary| {
        summary.write_all(json.as_bytes())?;
        summary.flush()?;
        let summary: &File = summary.get_ref();
        // Half of the time goes into waiting for the disk: the summary gets there while the page is laid out.
        thread::scope(|scope| {
            let sync = || summary.sync_data();
            let on_disk = thread::Builder::new().spawn_scoped(scope, sync);
            let page = lay_out();
            replace_atomically(report, OutputKind::Report, &old, |file| page.write_to(file))?;
            match on_disk {
                Ok(on_disk) => on_disk.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?,
                // A browser has no threads.
                Err(_) => sync()?,
            }
            Ok(())
        })
    })
}

/// Name of a pipeline: its path below a folder `pipelines` without the ending, else the file's stem.
fn pipeline_name(path: &Path) -> String {
    let stem = path.with_extension("");
    let parts: Vec<String> = stem.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    let below = parts.iter().rposition(|part| part == "pipelines").map_or(parts.len().saturating_sub(1), |at| at + 1);
    parts[below.min(parts.len())..].join("/")
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
