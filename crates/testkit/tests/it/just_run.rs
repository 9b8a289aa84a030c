//! What `just run` does around the stages: a run folder never mixes two records, and no mistake costs a finished run.

use std::fs::{self, File};
use std::os::unix::fs::symlink;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Instant;

use crumple_artifact::Artifact;
use crumple_artifact::records::TestV1;
use crumple_testkit::programs::{ARTIFACTS, binary, just, run};
use crumple_testkit::workspace;

fn fixture(name: &str) -> PathBuf {
    workspace().join("fixtures").join(name).join("crash.csv")
}

fn error(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Names in the folder, sorted.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn complete() -> Vec<String> {
    ["0-pipeline.toml"]
        .iter()
        .chain(ARTIFACTS.iter())
        .chain(&["report.html", "summary.json"])
        .map(ToString::to_string)
        .collect()
}

/// A folder with a finished run of the Kelvin fixture.
fn finished() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let output = run(&["flags=-q"], folder.path(), &fixture("kelvin"), &[]);
    assert!(output.status.success(), "{}", error(&output));
    assert_eq!(error(&output), "", "a first run replaces nothing");
    folder
}

#[test]
fn a_record_that_cannot_be_read_costs_nothing() {
    let folder = finished();
    let damaged = folder.path().with_extension("csv");
    fs::write(&damaged, "time_s,accel_g\n0,0\n").unwrap();
    for input in [Path::new("/nowhere/crash.csv"), &damaged] {
        let output = run(&["flags=-q"], folder.path(), input, &[]);
        assert_eq!(output.status.code(), Some(3), "{}", error(&output));
        assert_eq!(names(folder.path()), complete(), "{}", input.display());
        assert!(error(&output).contains("is that of an earlier run"), "{}", error(&output));
    }
    fs::remove_file(damaged).unwrap();
}

#[test]
fn a_stage_that_fails_leaves_no_results_of_another_record() {
    // A refusal, a crash of any other code, a death by signal.
    for identify in ["identify=bash -c 'exit 3'", "identify=bash -c 'exit 127'", "identify=bash -c 'kill -9 $$'"] {
        let folder = finished();
        let output = run(&["flags=-q", identify], folder.path(), &fixture("double"), &[]);
        assert!(!output.status.success(), "{identify}");
        let left: Vec<&str> = ["0-pipeline.toml"].into_iter().chain(ARTIFACTS.into_iter().take(3)).collect();
        assert_eq!(names(folder.path()), left, "{identify}: {}", error(&output));
    }
}

#[test]
fn a_stage_that_fails_leaves_the_results_of_the_same_record() {
    let folder = finished();
    let output = run(&["flags=-q", "identify=false"], folder.path(), &fixture("kelvin"), &[]);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(names(folder.path()), complete());
}

#[test]
fn a_program_that_does_not_exist_is_noticed_before_anything_runs() {
    let folder = finished();
    let output = run(&["flags=-q", "simulate=no-such-program --flag"], folder.path(), &fixture("double"), &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(error(&output).contains("no-such-program: no such program"), "{}", error(&output));
    assert_eq!(names(folder.path()), complete());
}

#[test]
fn another_record_of_the_same_name_says_what_it_replaces() {
    let folder = finished();
    let output = run(&["flags=-q"], folder.path(), &fixture("double"), &[]);
    assert!(output.status.success());
    assert!(error(&output).contains("replaces the run of crash.csv (csv, content "), "{}", error(&output));
    // The same again: nothing to say.
    assert_eq!(error(&run(&["flags=-q"], folder.path(), &fixture("double"), &[])), "");
}

#[test]
fn what_ingest_prints_about_itself_ends_the_run() {
    for (flag, words) in [("--help", "Usage: crumple-ingest"), ("--version", "crumple-ingest "), ("--list", "accel_g")]
    {
        let folder = tempfile::tempdir().unwrap();
        let output = run(&[], folder.path(), &fixture("kelvin"), &[flag]);
        assert!(output.status.success(), "{flag}: {}", error(&output));
        assert!(String::from_utf8_lossy(&output.stdout).contains(words), "{flag}");
        assert_eq!((error(&output), names(folder.path())), (String::new(), vec![]), "{flag}");
    }
}

#[test]
fn a_flag_of_another_stage_is_told_whose_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(&[], folder.path(), &fixture("kelvin"), &["--mass=873kg", "--cfc", "180"]);
    assert_eq!(output.status.code(), Some(2));
    let error = error(&output);
    assert!(error.contains("tip: --cfc is an option of filter: --set filter.cfc=VALUE"), "{error}");
    assert!(!error.contains("--mass is"), "{error}");
}

#[test]
fn a_pipeline_may_lie_anywhere() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("component.toml");
    fs::write(&own, "[filter]\ncfc = \"180\"\n\n[parameter-solve]\nmodels = [\"kelvin\"]\n").unwrap();
    let out = folder.path().join("run");
    let output = run(&["flags=-q", &format!("pipeline={}", own.display())], &out, &fixture("kelvin"), &[]);
    assert!(output.status.success(), "{}", error(&output));
    let summary = fs::read_to_string(out.join("summary.json")).unwrap();
    assert!(summary.contains("kelvin") && !summary.contains("maxwell"), "only the models of that pipeline");
    // One that is not there is named.
    let missing = folder.path().join("none.toml");
    let output = run(&["flags=-q", &format!("pipeline={}", missing.display())], &out, &fixture("kelvin"), &[]);
    assert!(!output.status.success());
    assert!(error(&output).contains("none.toml"), "{}", error(&output));
}

/// `just run` of a fixture into a folder, not yet started.
fn quiet_run(name: &str, folder: &Path) -> Command {
    let mut command = just();
    command.args(["flags=-q", &format!("out={}", folder.display()), "run"]).arg(fixture(name));
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

/// All that stands in a run folder is of one record: artifacts by their `/test`, report and summary by what they say.
fn assert_unmixed(folder: &Path, moment: &str) {
    let artifacts = ARTIFACTS.iter().map(|name| folder.join(name)).filter(|path| path.exists());
    let tests: Vec<TestV1> =
        artifacts.map(|path| Artifact::open(&path).unwrap().record("/test").unwrap().unwrap()).collect();
    assert!(tests.iter().all(|test| test.source.digest == tests[0].source.digest), "{moment}: {:?}", names(folder));
    let read = |name: &str| fs::read_to_string(folder.join(name)).ok();
    if let Some(report) = read("report.html") {
        let digest = tests[0].source.digest.rsplit(':').next().unwrap();
        assert!(report.contains(&digest[..12]), "{moment}: the report is of another record");
    }
    if let Some(summary) = read("summary.json") {
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        assert_eq!(summary["test"]["mass_kg"].as_f64(), tests[0].mass_kg, "{moment}: summary of another record");
    }
}

/// Id of the `crumple-run` that works into a folder; empty where there is none (any more).
fn run_program_of(folder: &Path) -> String {
    let processes = fs::read_dir("/proc").unwrap().flatten().map(|entry| entry.path());
    let run = processes.filter(|path| path.join("cmdline").exists()).find(|path| {
        let line = fs::read(path.join("cmdline")).unwrap_or_default();
        let words: Vec<_> = line.split(|byte| *byte == 0).map(String::from_utf8_lossy).collect();
        words[0].ends_with("/crumple-run") && words.iter().any(|word| Path::new(word.as_ref()) == folder)
    });
    run.map_or_else(String::new, |path| path.file_name().unwrap().to_string_lossy().into_owned())
}

/// `CRUMPLE_KILLS` states at how many moments; each kind of kill takes half of them.
#[test]
fn a_run_killed_at_any_moment_leaves_no_mixture() {
    let kills = std::env::var("CRUMPLE_KILLS").ok().and_then(|number| number.parse().ok()).unwrap_or(16_u32);
    let folder = finished();
    let started = Instant::now();
    assert!(quiet_run("double", folder.path()).status().unwrap().success());
    let duration = started.elapsed();
    for kill in 0..kills {
        let moment = format!("kill {kill} of {kills}");
        assert!(quiet_run("kelvin", folder.path()).status().unwrap().success(), "{moment}");
        assert_eq!(names(folder.path()), complete(), "{moment}");
        let mut killed = quiet_run("double", folder.path()).process_group(0).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(duration.mul_f64(f64::from(kill) / f64::from(kills)));
        // All of them: just, crumple-run and the stage; or crumple-run alone, whose stage goes on.
        let target = if kill % 2 == 0 { format!("-{}", killed.id()) } else { run_program_of(folder.path()) };
        Command::new("kill").args(["-KILL", "--", &target]).stderr(Stdio::null()).status().unwrap();
        killed.wait().unwrap();
        // A stage that still runs keeps the folder locked.
        File::open(folder.path()).unwrap().lock().unwrap();
        assert_unmixed(folder.path(), &moment);
    }
    assert!(quiet_run("double", folder.path()).status().unwrap().success());
    assert_eq!(names(folder.path()), complete());
}

#[test]
fn two_runs_at_once_both_end_well() {
    for pair in 0..10 {
        let folder = tempfile::tempdir().unwrap();
        let runs = ["kelvin", "double"].map(|name| quiet_run(name, folder.path()).spawn().unwrap());
        for run in runs {
            let output = run.wait_with_output().unwrap();
            assert!(output.status.success(), "pair {pair}: {}", error(&output));
        }
        assert_eq!(names(folder.path()), complete());
        assert_unmixed(folder.path(), &format!("pair {pair}"));
    }
}

/// A copy of the project whose folder and programs have special names; a record, a pipeline and a caller elsewhere too.
#[test]
fn names_with_blanks_quotes_and_dollars_are_taken_as_they_are() {
    let root = tempfile::tempdir().unwrap();
    let (project, caller) = (root.path().join("my project's $HOME"), root.path().join("a caller"));
    for folder in [&project, &caller, &project.join("programs of \"mine\"")] {
        fs::create_dir(folder).unwrap();
    }
    let bin = project.join("programs of \"mine\"");
    let release = binary("crumple-run").parent().unwrap().to_owned();
    for stage in
        ["ingest", "filter", "integrate", "identify", "parameter-solve", "simulate", "predict", "report", "run"]
    {
        let name = format!("crumple-{stage}");
        fs::copy(release.join(&name), bin.join(&name)).unwrap();
    }
    for name in ["Cargo.toml", "Cargo.lock", "rust-toolchain.toml", "crates", "pipelines", "justfile"] {
        symlink(workspace().join(name), project.join(name)).unwrap();
    }
    // Newer than the links: nothing is to be built.
    fs::write(bin.join(".crumple-built"), "").unwrap();
    fs::copy(fixture("kelvin"), caller.join("a record's $x; it.csv")).unwrap();
    fs::write(caller.join("my own.toml"), "[parameter-solve]\nmodels = [\"kelvin\"]\n[predict]\n").unwrap();
    let run = |variables: &[&str]| {
        let output = Command::new("just")
            .current_dir(&caller)
            .arg("--justfile")
            .arg(project.join("justfile"))
            .arg("--working-directory")
            .arg(&project)
            .arg(format!("bin={}", bin.display()))
            .args(variables)
            .args(["run", "a record's $x; it.csv"])
            .output()
            .unwrap();
        assert!(output.status.success(), "{variables:?}: {}", error(&output));
    };
    run(&[]);
    assert_eq!(names(&project.join("runs/a record's $x; it/default")), complete());
    run(&["pipeline=./my own.toml", "out=-an out"]);
    assert_eq!(names(&caller.join("-an out")), complete());
}
