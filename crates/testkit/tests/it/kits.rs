//! Kits of stages in the languages that this machine has: each takes the place of its stage in a run.

use std::fs;
use std::path::Path;
use std::process::Command;

use crumple_testkit::programs::binary;
use crumple_testkit::workspace;
use rayon::prelude::*;

/// Languages and what starts their programs. Python has its own test, `python/tests/test_documents.py`.
const LANGUAGES: [(&str, &str); 4] = [("shell", "sh"), ("octave", "octave-cli"), ("r", "Rscript"), ("julia", "julia")];

const STAGES: [&str; 6] = ["filter", "integrate", "identify", "parameter-solve", "simulate", "predict"];

#[test]
fn a_kit_takes_the_place_of_its_stage() {
    let paths = std::env::var_os("PATH").unwrap_or_default();
    let is_there = |program: &str| std::env::split_paths(&paths).any(|folder| folder.join(program).is_file());
    let mut kits = Vec::new();
    for (language, program) in LANGUAGES {
        if is_there(program) {
            kits.extend(STAGES.map(|stage| (stage, language)));
        } else {
            eprintln!("SKIPPED: kits in {language}: there is no {program}");
        }
    }
    let programs = binary("crumple").parent().unwrap().to_owned();
    let path = std::env::join_paths([programs].into_iter().chain(std::env::split_paths(&paths))).unwrap();
    let wrong: Vec<String> = kits.par_iter().filter_map(|(stage, language)| problem(stage, language, &path)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

/// What is wrong with a kit: its test fails, or the crush of the record is another one.
fn problem(stage: &str, language: &str, path: &std::ffi::OsStr) -> Option<String> {
    let folder = tempfile::tempdir().unwrap();
    let done = |program: &str, words: &[&str]| -> Result<(), String> {
        let output = Command::new(program).args(words).env("PATH", path).current_dir(folder.path()).output().unwrap();
        let said = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
        if output.status.success() { Ok(()) } else { Err(format!("{language}, {stage}: {}\n{said}", output.status)) }
    };
    let crumple = binary("crumple").display().to_string();
    let record = workspace().join("fixtures/elastoplastic/crash.csv").display().to_string();
    let tested = done(&crumple, &["new-stage", stage, "--language", language, "-o", "my kit"])
        .and_then(|()| done("sh", &["my kit/test.sh", &record]));
    if let Err(problem) = tested {
        return Some(problem);
    }
    // 1 % is more than an honest stage changes: the moving average takes 0.04 % away.
    let crush_m = crush_m(&folder.path().join("my kit/run"));
    (!(0.689..=0.702).contains(&crush_m)).then(|| format!("{language}, {stage}: crush of {crush_m} m"))
}

fn crush_m(run: &Path) -> f64 {
    let summary: serde_json::Value = serde_json::from_slice(&fs::read(run.join("summary.json")).unwrap()).unwrap();
    summary["events"]["dynamic_crush_m"].as_f64().unwrap()
}
