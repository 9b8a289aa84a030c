//! How stages end, and what is said of it.

use std::fs;

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
    let refused = |mut run: std::process::Command, place: &str| {
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
