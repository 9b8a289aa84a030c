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
