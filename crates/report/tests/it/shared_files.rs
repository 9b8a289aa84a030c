//! Pages that share their style and their scripts.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::sample;
use crumple_testkit::browser::{Browser, Screen};

fn make(page: &Path, inputs: &[PathBuf], more: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_crumple-report"));
    let output = command.args(inputs).args(more).args(["-q", "-o"]).arg(page).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    fs::read_to_string(page).unwrap()
}

/// What a person sees of style and scripts.
const LOOK: &str = "const style = (selector) => getComputedStyle(document.querySelector(selector));
    return [style('body').fontSize, style('.card').borderTopWidth, style('h2').fontWeight,
            document.querySelectorAll('button').length, document.querySelectorAll('#what-if input').length,
            document.querySelector('#what-if') && document.querySelector('#what-if').hidden]";

#[test]
fn a_page_that_shares_looks_and_works_as_one_that_holds_everything() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("runs/a");
    fs::create_dir_all(&run).unwrap();
    let inputs = sample::write_artifacts(&run, true);
    let paths = ["whole.html", "report.html"].map(|name| run.join(name));
    let whole = make(&paths[0], &inputs, &[]);
    let sharing = make(&paths[1], &inputs, &["--shared", "../../page"]);
    let shared = folder.path().join("page");
    let mut names: Vec<String> =
        fs::read_dir(&shared).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    let stems: Vec<&str> = names.iter().map(|name| &name[..name.rfind('-').unwrap()]).collect();
    assert_eq!(stems, ["figures", "report", "what-if"]);
    assert!(names.iter().filter(|name| sharing.contains(&format!("\"../../page/{name}\""))).count() >= 2, "{names:?}");
    // Style and scripts are some 40 kB; everything else is the same.
    assert!(sharing.len() + 25_000 < whole.len(), "{} {}", sharing.len(), whole.len());
    let middle = |html: &str| html.split_once("<main>").unwrap().1.split("<script").next().unwrap().to_owned();
    assert_eq!(middle(&sharing), middle(&whole));

    // A second page leaves the files alone.
    let written = |name: &String| fs::metadata(shared.join(name)).unwrap().modified().unwrap();
    let before: Vec<_> = names.iter().map(written).collect();
    assert_eq!(make(&run.join("again.html"), &inputs, &["--shared", "../../page/"]), sharing);
    assert_eq!(names.iter().map(written).collect::<Vec<_>>(), before);

    let Some(browser) = Browser::start("pages that share their files") else { return };
    let [of_whole, of_sharing] = [&paths[0], &paths[1]].map(|path| {
        let page = browser.open(path, "", Screen::DESK);
        assert_eq!(page.console(), Vec::<String>::new());
        page.ask(LOOK)
    });
    assert_eq!(of_whole, of_sharing);
    let is_told = |path: &Path| {
        let page = browser.open(path, "", Screen::DESK);
        page.ask("return getComputedStyle(document.querySelector('.beside')).display !== 'none'")
    };
    assert_eq!(is_told(&paths[1]), false);
    fs::remove_dir_all(&shared).unwrap();
    assert_eq!(is_told(&paths[1]), true, "a page without its files says what is missing");
}
