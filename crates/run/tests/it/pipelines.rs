//! What a run does with its pipeline: laid over the default, options set beside it, what changed against the run
//! before.

use std::fs;
use std::process::Output;

use crate::chain::{Chain, RESULTS, Stages, said};

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
