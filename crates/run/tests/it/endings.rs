//! How stages end, and what is said of it.

use std::fs;
use std::fs::File;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Instant;

use crate::chain::{Chain, RESULTS, Stages, said};

/// Runs record `b` over a finished run of `a` with another command for identify.
fn over_a_finished_run(command: &str) -> (Chain, Option<i32>, String) {
    let mut chain = Chain::new(Stages::Foreign);
    assert!(chain.run("a").status().unwrap().success());
    chain.set("4-identify.mcap", command);
    let output = chain.run("b").output().unwrap();
    (chain, output.status.code(), said(&output))
}

#[test]
fn a_stage_that_breaks_the_contract_is_named_with_its_command() {
    for (command, words) in [
        ("sh -c 'exit 77'", "the stage identify ended with exit code 77"),
        ("sh -c 'kill -SEGV $$'", "the stage identify was ended by signal 11 (SIGSEGV)"),
        ("sh -c 'kill -KILL $$'", "as the system does when memory runs out"),
        ("true", "the stage identify says it is done, and has written nothing"),
        ("sh -c 'exit 4'", "the stage identify says it is done, and has written nothing"),
        ("sh -c 'while [ \"$1\" != -o ]; do shift; done; echo text > \"$2\"' x", "has written no artifact"),
        ("sh -c no-such-program", "a program was not found"),
    ] {
        let (chain, code, error) = over_a_finished_run(command);
        assert_eq!(code, Some(1), "{command}: {error}");
        for words in [words, &format!("  command: {command}"), "  expected: ", "  hint: run the command by itself"] {
            assert!(error.contains(words), "{command}: {words:?} is not in {error}");
        }
        // What came before is new; nothing of the other record is left, and nothing half done.
        assert_eq!(chain.names(), RESULTS[..3], "{command}");
        assert!(!error.contains("earlier run"), "{error}");
    }
}

#[test]
fn a_stage_that_says_why_it_failed_decides_the_exit_code() {
    for code in [1, 2, 3] {
        let command = format!("sh -c 'echo error: why >&2; exit {code}'");
        let (_, ended, error) = over_a_finished_run(&command);
        assert_eq!(ended, Some(code));
        let named = format!("error: why\nnote: the stage identify ended with exit code {code} (");
        assert!(error.contains(&named) && error.ends_with(&format!("): {command}\n")), "{error}");
    }
}

#[test]
fn every_output_of_a_stage_must_be_there() {
    let chain = Chain::new(Stages::Foreign);
    let alone = "sh -c 'while [ \"$1\" != -o ]; do shift; done; echo x > \"$2\"' x";
    for (command, missing) in [(alone, "summary.json beside report.html"), ("true", "report.html at the path")] {
        let chain = Chain::new(Stages::Foreign).with("report.html", command);
        let output = chain.run("a").output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{}", said(&output));
        assert!(said(&output).contains(&format!("  expected: {missing}")), "{}", said(&output));
        assert_eq!(chain.names(), RESULTS[..7]);
    }
    assert!(chain.run("a").status().unwrap().success());
}

#[test]
fn a_failed_stage_costs_nothing_of_the_same_record() {
    let mut chain = Chain::new(Stages::Foreign);
    assert!(chain.run("a").status().unwrap().success());
    chain.set("4-identify.mcap", "false");
    let output = chain.run("a").output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output).contains("is that of an earlier run"), "{}", said(&output));
    chain.assert_whole("a");
    // Who predicts with it is told.
    let again = chain.again(&chain.folder(), &[]).output().unwrap();
    assert!(said(&again).contains("failed: these are results of the one before"), "{}", said(&again));
}

#[test]
fn a_folder_says_that_its_results_are_of_an_earlier_run_and_a_run_that_works_takes_it_back() {
    let chain = Chain::new(Stages::Foreign);
    let failure = || crumple_stage::Pipeline::failure_in(&chain.folder());
    assert!(chain.run("a").status().unwrap().success());
    assert_eq!(failure(), None);
    let output = chain.run_with("a", &["--set", "filtre.cfc=180"]).output().unwrap();
    assert_eq!((output.status.code(), failure()), (Some(2), Some(2)), "{}", said(&output));
    chain.assert_whole("a");
    assert!(chain.run("a").status().unwrap().success());
    assert_eq!(failure(), None);
    let mut refusing = chain;
    refusing.set("1-ingest.mcap", "sh -c 'echo error: why >&2; exit 3'");
    assert_eq!(refusing.run("b").status().unwrap().code(), Some(3));
    assert_eq!(crumple_stage::Pipeline::failure_in(&refusing.folder()), Some(3));
    refusing.assert_whole("a");
}

#[test]
fn no_acceptable_result_does_not_stop_the_run_and_the_report_decides() {
    let chain = Chain::new(Stages::Foreign);
    let without = |command: &str| format!("sh -c '\"$@\"; exit 4' x {command}");
    let identify = without(chain.command("4-identify.mcap"));
    let chain = chain.with("4-identify.mcap", &identify);
    assert_eq!(chain.run("a").status().unwrap().code(), Some(0));
    let report = without(chain.command("report.html"));
    let chain = chain.with("report.html", &report);
    assert_eq!(chain.run("b").status().unwrap().code(), Some(4));
    chain.assert_whole("b");
}

#[test]
fn the_same_result_leaves_the_file_alone_and_all_that_was_made_from_it() {
    for stages in [Stages::Own, Stages::Foreign] {
        let mut chain = Chain::new(stages);
        assert!(chain.run("a").status().unwrap().success());
        let written = |chain: &Chain| fs::metadata(chain.folder().join("2-filter.mcap")).unwrap().modified().unwrap();
        let before = written(&chain);
        chain.set("3-integrate.mcap", "false");
        assert_eq!(chain.run("a").status().unwrap().code(), Some(1));
        if stages == Stages::Foreign {
            assert_eq!(written(&chain), before);
            chain.assert_whole("a");
        } else {
            // These stages of the project find nothing up to date.
            assert_eq!(chain.names(), RESULTS[..2]);
        }
    }
}

#[test]
fn a_program_that_does_not_exist_is_noticed_before_anything_runs() {
    let (chain, code, error) = over_a_finished_run("'no such/program' --flag");
    assert_eq!(code, Some(2), "{error}");
    assert!(error.contains("no such/program: no such program; nothing was run"), "{error}");
    chain.assert_whole("a");
    let (chain, code, error) = over_a_finished_run(" ");
    assert_eq!(code, Some(2), "{error}");
    assert!(error.contains("the command of the stage identify is empty"), "{error}");
    chain.assert_whole("a");
}

#[test]
fn a_command_of_several_is_one_of_a_shell_that_is_named() {
    let chain = Chain::new(Stages::Own);
    let own = chain.command("4-identify.mcap").to_owned();
    let chain = chain.with("4-identify.mcap", &format!("sh -c 'ulimit -c 0; exec \"$@\"' x {own}"));
    let output = chain.run("a").output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    chain.assert_whole("a");
    let (_, code, error) = over_a_finished_run(&format!("ulimit -c 0; {own}"));
    assert_eq!(code, Some(2), "{error}");
    assert!(error.contains("ulimit: no such program") && error.contains("sh -c '...'"), "{error}");
}

#[test]
fn a_stage_of_the_project_that_would_only_print_is_refused() {
    let mut chain = Chain::new(Stages::Own);
    assert!(chain.run("a").status().unwrap().success());
    let refused = |mut run: Command, place: &str| {
        let output = run.output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{}", said(&output));
        assert!(said(&output).contains(&format!("--version in {place}: crumple-")), "{}", said(&output));
    };
    let command = format!("{} --version", chain.command("4-identify.mcap"));
    refused(chain.run_with_flags("b", "-q --version"), "flags");
    chain.set("4-identify.mcap", &command);
    refused(chain.run("b"), "the command of the stage identify");
    chain.assert_whole("a");
}

#[test]
fn a_first_stage_that_cannot_print_what_is_asked_is_named() {
    for (command, code, words) in [
        ("no-such-program", 2, "no-such-program: no such program"),
        ("false", 1, "the stage ingest ended with exit code 1 (failure): false"),
        ("sh -c 'exit 77'", 1, "the stage ingest ended with exit code 77"),
    ] {
        let chain = Chain::new(Stages::Foreign).with("1-ingest.mcap", command);
        let output = chain.run("a").arg("--list").output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{}", said(&output));
        assert!(said(&output).contains(words), "{}", said(&output));
    }
}

/// Moments at which a run is killed; `CRUMPLE_KILLS` states another number.
fn kills() -> u32 {
    std::env::var("CRUMPLE_KILLS").ok().and_then(|number| number.parse().ok()).unwrap_or(15)
}

/// Kills runs of `b` over a finished run of `a`, spread over the time that one takes.
fn kill_at_many_moments(stages: Stages, whole_group: bool) {
    let chain = Chain::new(stages);
    assert!(chain.run("a").status().unwrap().success());
    let started = Instant::now();
    assert!(chain.run("b").status().unwrap().success());
    let duration = started.elapsed();
    let mut unfinished = 0;
    for kill in 0..kills() {
        assert!(chain.run("a").status().unwrap().success());
        chain.assert_whole("a");
        let mut run = chain.run("b").stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        sleep(duration.mul_f64(f64::from(kill) / f64::from(kills())));
        if whole_group {
            let group = format!("kill -KILL -{}", run.id());
            Command::new("sh").args(["-c", &group]).stderr(Stdio::null()).status().unwrap();
        } else {
            run.kill().unwrap();
        }
        run.wait().unwrap();
        // A stage that still runs keeps the folder locked.
        File::open(chain.folder()).unwrap().lock().unwrap();
        chain.assert_unmixed(&format!("{stages:?}, group {whole_group}, kill {kill}"));
        unfinished += u32::from(RESULTS.iter().any(|name| !chain.folder().join(name).exists()));
    }
    assert!(unfinished > 0, "no run was killed on its way");
    assert!(chain.run("b").status().unwrap().success());
    chain.assert_whole("b");
}

#[test]
fn a_killed_run_leaves_no_mixture() {
    kill_at_many_moments(Stages::Own, false);
}

#[test]
fn a_run_killed_with_its_stages_leaves_no_mixture() {
    kill_at_many_moments(Stages::Own, true);
}

#[test]
fn a_killed_run_of_programs_from_elsewhere_leaves_no_mixture() {
    kill_at_many_moments(Stages::Foreign, false);
}

#[test]
fn a_run_killed_with_programs_from_elsewhere_leaves_no_mixture() {
    kill_at_many_moments(Stages::Foreign, true);
}

#[test]
fn a_folder_is_named_by_record_and_pipeline_and_made_only_for_a_result() {
    let chain = Chain::new(Stages::Foreign);
    let runs = chain.folder().with_file_name("runs");
    let mut refused = chain.run_into(Path::new(""), Path::new("/nowhere/x.csv"));
    assert!(!refused.status().unwrap().success());
    assert!(!runs.exists(), "nothing was read, and nothing is left");
    assert!(chain.run_into(Path::new(""), &chain.record("a")).status().unwrap().success());
    assert!(runs.join("a/default/report.html").exists());
}

#[test]
fn records_with_special_names_are_read() {
    let chain = Chain::new(Stages::Own);
    for name in ["two words", "it's", "$HOME", "\"x\"", "a;b", "ü"] {
        let record = chain.record(name);
        fs::copy(chain.record("a"), &record).unwrap();
        let folder = chain.folder().join("b").join(name);
        let output = chain.run_into(&folder, &record).output().unwrap();
        assert!(output.status.success(), "{name}: {}", said(&output));
        assert!(folder.join("report.html").exists(), "{name}");
    }
}

#[test]
fn a_record_does_not_begin_as_a_flag() {
    let chain = Chain::new(Stages::Foreign);
    let output = chain.run_into(&chain.folder(), Path::new("--list")).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("the record comes first: just run RECORD"), "{}", said(&output));
}

#[test]
fn a_folder_with_a_report_of_somebody_else_is_left_alone() {
    let chain = Chain::new(Stages::Own);
    fs::create_dir(chain.folder()).unwrap();
    fs::write(chain.folder().join("report.html"), "mine").unwrap();
    let output = chain.run("a").output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("just out=DIR run RECORD"), "{}", said(&output));
    assert_eq!(chain.contents().into_iter().collect::<Vec<_>>(), [("report.html".to_owned(), "mine".to_owned())]);
}

#[test]
fn what_a_killed_run_left_is_swept_and_nothing_else() {
    let chain = Chain::new(Stages::Foreign);
    let path = |name: &str| chain.folder().join(name);
    fs::create_dir_all(path(".crumple-run.new")).unwrap();
    for name in [".crumple-run.new/4-identify.mcap", ".report.html.x1.tmp", ".3-integrate.mcap.x2.tmp", "mine.txt"] {
        fs::write(path(name), "half").unwrap();
    }
    assert!(chain.run("a").status().unwrap().success());
    fs::remove_file(path("mine.txt")).unwrap();
    chain.assert_whole("a");
    // A file that no stage is known to write stays, and disturbs no run.
    fs::create_dir(path(".crumple-run.new")).unwrap();
    fs::write(path(".crumple-run.new/mine.txt"), "mine").unwrap();
    assert!(chain.run("b").status().unwrap().success());
    assert_eq!(fs::read_dir(path(".crumple-run.new")).unwrap().count(), 1);
    fs::remove_dir_all(path(".crumple-run.new")).unwrap();
    chain.assert_whole("b");
}

fn without_a_table(stages: Stages) {
    let chain = Chain::new(stages);
    let run = || {
        let output = chain.run("a").output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    };
    let pipeline = chain.record("pipelines/default.toml");
    run();
    chain.assert_whole("a");
    // What was written once goes, and the report is that of the others.
    fs::write(&pipeline, "base = 'none'\n[ingest]\n").unwrap();
    run();
    let left: Vec<&str> = RESULTS.into_iter().filter(|name| *name != "7-predict.mcap").collect();
    assert_eq!(chain.names(), left);
}

#[test]
fn a_stage_without_a_table_is_left_out_with_what_it_wrote_once() {
    without_a_table(Stages::Own);
    without_a_table(Stages::Foreign);
}

#[test]
fn stages_run_again_in_the_folder_of_a_run_and_nowhere_else() {
    for stages in [Stages::Own, Stages::Foreign] {
        let chain = Chain::new(stages);
        assert_eq!(chain.run("a").output().unwrap().status.code(), Some(0));
        fs::write(chain.folder().join("3-integrate.mcap"), b"\x89MCAP other").unwrap();
        let output = chain.again(&chain.folder(), &["--speed", "40km/h"]).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        let contents = chain.contents();
        assert!(contents["7-predict.mcap"].ends_with("other"), "{contents:?}");
        assert!(contents["report.html"].ends_with('a') && contents.len() == RESULTS.len());
        let elsewhere = chain.again(&chain.record("nowhere"), &[]).output().unwrap();
        assert_eq!(elsewhere.status.code(), Some(2));
        assert!(said(&elsewhere).contains("is no folder of a run"), "{}", said(&elsewhere));
        assert!(!chain.record("nowhere").exists());
    }
}
