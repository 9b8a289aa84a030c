//! A stage without a table in the pipeline is left out; stages of a run that was made run again in its folder.

use std::fs;

use crate::chain::{Chain, RESULTS, Stages, said};

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
