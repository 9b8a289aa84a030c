//! A chain of eight stages that copy a record, and what a run folder holds after it.

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

/// What a finished run leaves.
pub const RESULTS: [&str; 9] = [
    "1-ingest.mcap",
    "2-filter.mcap",
    "3-integrate.mcap",
    "4-identify.mcap",
    "5-parameter-solve.mcap",
    "6-simulate.mcap",
    "7-predict.mcap",
    "report.html",
    "summary.json",
];

/// Whether the stages pass for those of the project, which write into the run folder themselves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stages {
    /// Programs of the project: `crumple-<stage>` beside `crumple-run`.
    Own,
    /// Programs from elsewhere.
    Foreign,
}

/// The chain, two records and a run folder.
pub struct Chain {
    root: TempDir,
    program: PathBuf,
    commands: Vec<String>,
}

impl Chain {
    pub fn new(stages: Stages) -> Self {
        // Beside the program, so that it can be linked.
        let root = tempfile::Builder::new().prefix("run '$x ").tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/fake-stage.sh");
        let program = root.path().join("crumple-run");
        fs::hard_link(env!("CARGO_BIN_EXE_crumple-run"), &program).unwrap();
        let names = RESULTS[..8].iter().map(|output| output.trim_end_matches(".mcap").trim_end_matches(".html"));
        let commands = names.map(|name| {
            let own =
                root.path().join(format!("crumple-{}", name.trim_start_matches(|c: char| !c.is_ascii_lowercase())));
            std::os::unix::fs::symlink(&script, &own).unwrap();
            match stages {
                Stages::Own => quoted(&own),
                Stages::Foreign => format!("sh {}", quoted(&script)),
            }
        });
        let commands = commands.collect();
        fs::create_dir(root.path().join("pipelines")).unwrap();
        fs::write(root.path().join("pipelines/default.toml"), "base = \"none\"\n[predict]\n").unwrap();
        for record in ["a", "b"] {
            fs::write(
                root.path().join(record),
                format!("\u{89}MCAP {record}").chars().map(|c| c as u8).collect::<Vec<_>>(),
            )
            .unwrap();
        }
        Self { root, program, commands }
    }

    /// The same with another command for the stage of this output.
    pub fn with(mut self, output: &str, command: &str) -> Self {
        self.set(output, command);
        self
    }

    pub fn set(&mut self, output: &str, command: &str) {
        let number = RESULTS.iter().position(|name| *name == output).unwrap();
        self.commands[number] = command.to_owned();
    }

    pub fn command(&self, output: &str) -> &str {
        &self.commands[RESULTS.iter().position(|name| *name == output).unwrap()]
    }

    /// The record `a` or `b`.
    pub fn record(&self, name: &str) -> PathBuf {
        self.root.path().join(name)
    }

    pub fn folder(&self) -> PathBuf {
        self.root.path().join("out folder")
    }

    /// A run of a record into the folder, in a process group of its own.
    pub fn run(&self, record: &str) -> Command {
        self.run_into(&self.folder(), &self.record(record))
    }

    /// The same with flags for every stage.
    pub fn run_with_flags(&self, record: &str, flags: &str) -> Command {
        self.run_with(record, &["--flags", flags])
    }

    pub fn run_into(&self, folder: &Path, record: &Path) -> Command {
        let mut command = self.start();
        command.process_group(0).arg("--out").arg(folder).arg("--").arg(record);
        command
    }

    /// The program with the project and the commands of the stages, and nothing else.
    fn start(&self) -> Command {
        let mut command = Command::new(&self.program);
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).arg("--project").arg(self.root.path());
        for (output, stage) in RESULTS.iter().zip(&self.commands) {
            let name = output.trim_start_matches(|c: char| !c.is_ascii_lowercase()).split('.').next().unwrap();
            command.env(format!("CRUMPLE_{}", name.to_uppercase().replace('-', "_")), stage);
        }
        command
    }

    /// The same with more options of the run itself.
    pub fn run_with(&self, record: &str, options: &[&str]) -> Command {
        let mut command = self.start();
        command.args(options).arg("--out").arg(self.folder()).arg("--").arg(self.record(record));
        command
    }

    /// Prediction and report again in a folder, with flags of the first.
    pub fn again(&self, folder: &Path, flags: &[&str]) -> Command {
        let mut command = self.start();
        command.arg("--again").arg(folder).arg("--").args(flags);
        command
    }

    /// Content of every file in the folder by name but the pipeline of the run, temporary files too.
    pub fn contents(&self) -> BTreeMap<String, String> {
        let mut contents = self.all_contents();
        contents.remove("0-pipeline.toml");
        contents
    }

    fn all_contents(&self) -> BTreeMap<String, String> {
        let entries = fs::read_dir(self.folder()).unwrap().map(|entry| entry.unwrap().path());
        let name = |path: &Path| path.file_name().unwrap().to_string_lossy().into_owned();
        let content =
            |path: &Path| fs::read(path).map_or_else(|_| "folder".into(), |b| String::from_utf8_lossy(&b).into());
        entries.map(|path| (name(&path), content(&path))).collect()
    }

    pub fn names(&self) -> Vec<String> {
        self.contents().into_keys().collect()
    }

    /// The folder holds a whole run of this record and nothing else.
    pub fn assert_whole(&self, record: &str) {
        let contents = self.contents();
        assert_eq!(contents.keys().map(String::as_str).collect::<Vec<_>>(), RESULTS);
        assert!(contents.values().all(|content| content.ends_with(record)), "not all of {record}: {contents:?}");
    }

    /// No result stands beside one of another record.
    pub fn assert_unmixed(&self, moment: &str) {
        let contents = self.contents();
        let mut results = RESULTS.iter().filter_map(|name| contents.get(*name));
        let first = results.next();
        assert!(results.all(|content| Some(content) == first), "{moment}: {contents:?}");
    }
}

/// A word for a shell.
pub fn quoted(path: &Path) -> String {
    format!("'{}'", path.to_str().unwrap().replace('\'', r"'\''"))
}

/// What a process said on stderr.
pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A run of the record `a` with words behind it.
fn run(chain: &Chain, options: &[&str], behind: &[&str]) -> Output {
    chain.run_with("a", options).args(behind).output().unwrap()
}

fn pipeline(chain: &Chain) -> String {
    fs::read_to_string(chain.folder().join("0-pipeline.toml")).unwrap()
}

#[test]
fn an_option_set_beside_the_pipeline_goes_to_the_stages_and_the_next_run_says_what_changed() {
    let chain = Chain::new(Stages::Own);
    let output = run(&chain, &[], &["--set", "filter.cfc=180", "--set=identify.methods=era,arx"]);
    assert!(output.status.success() && said(&output).is_empty(), "{}", said(&output));
    let first = pipeline(&chain);
    assert!(first.contains("cfc = 180") && first.contains("name = \"default\""), "{first}");
    let output = run(&chain, &["--set", "filter.cfc=60"], &["--mass", "900kg"]);
    assert_eq!(
        said(&output),
        "run              filter.cfc is 60, was 180 in the run before\n\
         run              flags of ingest is \"--mass 900kg\", was not given in the run before\n\
         run              identify.methods is not given, was [\"era\", \"arx\"] in the run before\n"
    );
    // The same again says nothing, and neither does a quiet run.
    assert_eq!(said(&run(&chain, &["--set", "filter.cfc=60"], &["--mass", "900kg"])), "");
    assert_eq!(said(&run(&chain, &["--flags", "-q"], &[])), "");
}

#[test]
fn a_pipeline_elsewhere_keeps_the_rest_of_the_default_unless_it_stands_alone() {
    let chain = Chain::new(Stages::Foreign);
    let own = chain.record("my own.toml");
    let run_with = |text: &str| {
        fs::write(&own, text).unwrap();
        let output = run(&chain, &["--pipeline", own.to_str().unwrap()], &[]);
        assert!(output.status.success(), "{}", said(&output));
        chain.names()
    };
    assert_eq!(run_with("[filter]\ncfc = 180\n"), RESULTS);
    assert!(pipeline(&chain).contains("name = \"my own\""), "{}", pipeline(&chain));
    let without: Vec<&str> = RESULTS.into_iter().filter(|name| *name != "7-predict.mcap").collect();
    assert_eq!(run_with("predict = false\n"), without);
    assert_eq!(run_with("base = \"none\"\n"), without);
}

#[test]
fn a_mistake_in_the_options_is_said_before_anything_runs() {
    let chain = Chain::new(Stages::Own);
    for (options, behind, expected) in [
        (vec!["--set", "filtr.cfc=180"], vec![], "did you mean \"filter\"?"),
        (vec!["--set", "cfc=180"], vec![], "expected STAGE.OPTION=VALUE"),
        (vec![], vec!["--set"], "--set needs STAGE.OPTION=VALUE"),
        (vec!["--pipeline", "none"], vec![], "pipelines/none.toml"),
        // What only the stages know, the stages are asked.
        (vec!["--flags", "--wrong", "--set", "filter.cfc=180"], vec![], "unexpected --wrong"),
    ] {
        let output = run(&chain, &options, &behind);
        assert_eq!(output.status.code(), Some(2), "{options:?}: {}", said(&output));
        assert!(said(&output).contains(expected), "{options:?}: {}", said(&output));
        assert!(!chain.folder().exists());
    }
}

#[test]
fn a_run_that_fails_leaves_the_pipeline_of_the_run_before() {
    let mut chain = Chain::new(Stages::Own);
    assert!(run(&chain, &[], &[]).status.success());
    let before = pipeline(&chain);
    chain.set("4-identify.mcap", "sh -c 'exit 3'");
    assert_eq!(run(&chain, &["--set", "filter.cfc=180"], &[]).status.code(), Some(3));
    // How the last run ended stands beside the options.
    let options = |text: &str| text.split_once("[run]").map(|(options, _)| options.to_owned());
    let after = pipeline(&chain);
    assert_eq!(options(&after), options(&before));
    assert!(after.contains("state = \"failed\""), "{after}");
    assert!(!chain.names().iter().any(|name| name.ends_with(".tmp")), "{:?}", chain.names());
}

#[test]
fn a_file_of_somebody_else_is_not_replaced() {
    let chain = Chain::new(Stages::Own);
    fs::create_dir(chain.folder()).unwrap();
    fs::write(chain.folder().join("0-pipeline.toml"), "[filter]\n").unwrap();
    let output = run(&chain, &[], &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("0-pipeline.toml is not that of a run"), "{}", said(&output));
    assert_eq!(pipeline(&chain), "[filter]\n");
}

#[test]
fn an_unchanged_run_starts_the_first_stage_alone_and_nothing_else_passes_for_one() {
    let chain = Chain::new(Stages::Own);
    let log = chain.record("started");
    let ran = |options: &[&str], behind: &[&str]| {
        fs::write(&log, "").unwrap();
        let output = chain.run_with("a", options).args(behind).env("STARTED", &log).output().unwrap();
        assert!(output.status.success(), "{}", said(&output));
        (fs::read_to_string(&log).unwrap().lines().count(), said(&output).contains("up to date"))
    };
    assert_eq!(ran(&[], &[]), (8, false));
    assert_eq!(ran(&[], &[]), (1, true));
    // One byte of a result, an option, --force, a result that is gone.
    fs::write(chain.folder().join("4-identify.mcap"), b"\x89MCAP b").unwrap();
    assert_eq!(ran(&[], &[]), (8, false));
    assert_eq!(ran(&[], &["--mass", "900kg"]), (8, false));
    assert_eq!(ran(&[], &["--mass", "900kg"]), (1, true));
    assert_eq!(ran(&["--flags", "--force"], &["--mass", "900kg"]), (8, false));
    assert_eq!(ran(&[], &["--mass", "900kg"]), (8, false));
    fs::remove_file(chain.folder().join("summary.json")).unwrap();
    assert_eq!(ran(&[], &["--mass", "900kg"]), (8, false));
    chain.assert_whole("a");
}

#[test]
fn stages_that_run_again_have_the_pipeline_of_the_run_or_that_of_its_name() {
    let chain = Chain::new(Stages::Own);
    assert!(run(&chain, &["--set", "filter.cfc=180"], &[]).status.success());
    let again = || {
        let output = chain.again(&chain.folder(), &[]).output().unwrap();
        assert!(output.status.success(), "{}", said(&output));
        pipeline(&chain)
    };
    assert!(again().contains("cfc = 180"));
    // A folder from before there was such a file.
    fs::remove_file(chain.folder().join("0-pipeline.toml")).unwrap();
    let made = again();
    assert!(made.contains("name = \"default\"") && !made.contains("cfc"), "{made}");
}
