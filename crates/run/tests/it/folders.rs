//! Names of folders and records, and what an earlier run left in them.

use std::fs;
use std::path::Path;

use crate::chain::{Chain, Stages, said};

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
