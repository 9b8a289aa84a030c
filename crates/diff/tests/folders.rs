//! The program: run folders, and files that cannot be read.

#![expect(clippy::unwrap_used, reason = "a test stops where something unforeseen happens")]

mod program;

use std::fs;

use program::{Made, diff, pair};

#[test]
fn damage_and_absence_are_trouble_not_difference() {
    let folder = pair(&Made::default());
    let good = fs::read(folder.path().join("a.mcap")).unwrap();
    fs::write(folder.path().join("cut.mcap"), &good[..good.len() / 2]).unwrap();
    let mut bad = good.clone();
    let middle = bad.len() / 2;
    bad[middle] ^= 4;
    fs::write(folder.path().join("bad.mcap"), bad).unwrap();

    for (file, says) in [
        ("cut.mcap", "cut.mcap: truncated: the file ends at byte"),
        ("bad.mcap", "bad.mcap: corrupted: chunk 1 at byte"),
        ("none.mcap", "cannot read none.mcap"),
    ] {
        for args in [["a.mcap", file], [file, "a.mcap"]] {
            let found = diff(folder.path(), &args);
            assert_eq!(found.code, 2, "{file}");
            assert!(found.stderr.starts_with("error: ") && found.stderr.contains(says), "{}", found.stderr);
            assert!(found.stderr.contains("\n  hint: "), "{}", found.stderr);
            assert!(found.stderr.matches("os error").count() <= 1, "the cause is told twice: {}", found.stderr);
            assert_eq!(found.stdout, "");
        }
    }
    assert_eq!(diff(folder.path(), &["a.mcap", "."]).code, 2, "a file beside a folder");
    assert_eq!(diff(folder.path(), &["a.mcap"]).code, 2, "usage");
    assert_eq!(diff(folder.path(), &["a.mcap", "b.mcap", "--rel", "-1"]).code, 2, "usage");
    assert_eq!(diff(folder.path(), &["--help"]).code, 0);
}

/// Two run folders of two artifacts and a summary.
fn runs() -> tempfile::TempDir {
    let root = tempfile::tempdir().unwrap();
    for run in ["one", "two"] {
        let folder = root.path().join(run);
        fs::create_dir(&folder).unwrap();
        Made::default().write(&folder.join("2-filter.mcap"));
        Made::default().write(&folder.join("3-integrate.mcap"));
        fs::write(folder.join("summary.json"), r#"{"events": {"dynamic_crush_m": 0.75}}"#).unwrap();
        fs::write(folder.join("report.html"), run).unwrap();
    }
    root
}

#[test]
fn run_folders_are_compared_file_by_file() {
    let root = runs();
    let found = diff(root.path(), &["one", "two"]);
    assert_eq!(found.code, 0, "{}", found.stdout);
    let (one, two) = (root.path().join("one"), root.path().join("two"));

    let mut changed = Made::default();
    changed.samples[3] = 0.0;
    changed.write(&two.join("3-integrate.mcap"));
    fs::write(two.join("summary.json"), r#"{"events": {"dynamic_crush_m": 0.751}}"#).unwrap();
    fs::remove_file(two.join("2-filter.mcap")).unwrap();
    let found = diff(root.path(), &["one", "two"]);
    assert_eq!(found.code, 1);
    insta::assert_snapshot!(found.stdout, @"
    dynamic crush: 750.0 mm -> 751.0 mm
    2-filter.mcap: only in one
    3-integrate.mcap: /wave/93, sample 3 (t = -0.009700 s): -42.5  0.0  (abs 42.5, rel 0.85), the only one of 200 samples
    summary.json, events.dynamic_crush_m: 0.75  0.751  (abs 0.001, rel 0.001332)
    different: 2 of 4 topics in 3 files, 1 file on one side only
    ");

    fs::write(two.join("3-integrate.mcap"), &fs::read(one.join("3-integrate.mcap")).unwrap()[..99]).unwrap();
    assert_eq!(diff(root.path(), &["one", "two"]).code, 2, "damage goes before difference");
    fs::create_dir(root.path().join("empty")).unwrap();
    let found = diff(root.path(), &["one", "empty"]);
    assert_eq!(found.code, 2);
    assert!(found.stderr.starts_with("error: empty: no run folder"), "{}", found.stderr);
}
