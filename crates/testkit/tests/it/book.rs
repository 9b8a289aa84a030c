//! The commands of the book run, and print what it shows.
//!
//! Blocks of `sh` are run in order, those of one page in one folder. A block of `text printed` holds parts of lines
//! that the block before it prints, and `...` for others. A second word behind `sh` says what a block needs: `v10146`
//! the files of that NHTSA test, any other word what no test has, such as a cluster.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Command;

use crumple_testkit::programs::binary;
use crumple_testkit::{shared, workspace};
use rayon::prelude::*;
use tempfile::TempDir;

/// Pages whose commands run, beside those in `how-to/`.
const PAGES: [&str; 9] =
    ["../README", "ci", "export", "first-crash", "fleet", "pipelines", "prediction", "together", "write-a-stage"];

/// Stands for lines that are printed and not shown.
const LEFT_OUT: &str = "...";

#[test]
fn the_commands_of_the_book_run_and_print_what_it_shows() {
    let docs = workspace().join("docs");
    let how_tos = fs::read_dir(docs.join("how-to")).unwrap().map(|entry| entry.unwrap().path());
    let pages: Vec<PathBuf> = PAGES.iter().map(|page| docs.join(format!("{page}.md"))).chain(how_tos).collect();
    let programs = binary("crumple").parent().unwrap().to_owned();
    let wrong: Vec<String> = pages.par_iter().flat_map_iter(|page| wrong(page, &programs)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

/// The blocks of a page that fail or print something else.
fn wrong(page: &Path, programs: &Path) -> Vec<String> {
    let (folder, record) = clone_with_records();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = std::env::join_paths([programs.to_owned()].into_iter().chain(std::env::split_paths(&path))).unwrap();
    let (mut wrong, mut printed) = (Vec::new(), None);
    let text = fs::read_to_string(page).unwrap();
    for block in text.split("```").skip(1).step_by(2) {
        let (fence, body) = block.split_once('\n').unwrap();
        match fence.split_once(' ').unwrap_or((fence, "")) {
            ("sh", needs) if needs.is_empty() || needs == "v10146" && record => {
                let mut shell = Command::new("sh");
                shell.args(["-euc", body]).env("PATH", &path).current_dir(folder.path());
                let output = shell.output().unwrap();
                let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
                let text = text.concat().replace(['\u{a0}', '\u{202f}'], " ");
                if !output.status.success() {
                    wrong.push(format!("{}: {}\n{body}{text}", page.display(), output.status));
                }
                printed = Some(text);
            }
            ("sh", needs) => {
                eprintln!("SKIPPED: commands of {} that need {needs}", page.display());
                printed = None;
            }
            ("text", "printed") => {
                let Some(printed) = &printed else { continue };
                let is_printed = |shown: &&str| printed.lines().any(|line| line.contains(shown));
                let missing = body.lines().filter(|shown| *shown != LEFT_OUT && !is_printed(shown));
                wrong.extend(missing.map(|shown| format!("{}: {shown}\nis not in\n{printed}", page.display())));
            }
            _ => (),
        }
    }
    wrong
}

/// What a reader has: a clone, a record `pulse.csv`, a folder `tests/` of records, and the NHTSA test if it is here.
fn clone_with_records() -> (TempDir, bool) {
    let folder = tempfile::tempdir().unwrap();
    let link = |from: PathBuf, to: &str| symlink(from, folder.path().join(to)).unwrap();
    let fixture = |name: &str| workspace().join("fixtures").join(name).join("crash.csv");
    for part in ["docs", "fixtures", "pipelines"] {
        link(workspace().join(part), part);
    }
    fs::create_dir(folder.path().join("tests")).unwrap();
    for (record, name) in [("pulse", "elastoplastic"), ("tests/a", "elastoplastic"), ("tests/b", "kelvin")] {
        link(fixture(name), &format!("{record}.csv"));
    }
    let record = shared("data/nhtsa-v10146-camry-frontal");
    for file in record.iter().flat_map(|record| fs::read_dir(record).unwrap()).map(|entry| entry.unwrap()) {
        link(file.path(), file.file_name().to_str().unwrap());
    }
    (folder, record.is_some())
}
