//! The report in a real browser: every figure is drawn and the console stays silent.

#![allow(clippy::unwrap_used, reason = "a failure here is the test's failure")]

mod sample;

use std::path::{Path, PathBuf};
use std::process::Command;

/// The browser, or `None` where it is left out on purpose. Its absence is a failure otherwise: a report nobody has
/// looked at is not tested.
fn browser() -> Option<PathBuf> {
    if let Ok(reason) = std::env::var("CRUMPLE_NO_BROWSER") {
        eprintln!("SKIPPED: the report is not looked at in a browser (CRUMPLE_NO_BROWSER={reason})");
        return None;
    }
    if let Some(path) = std::env::var_os("CRUMPLE_BROWSER") {
        return Some(path.into());
    }
    let path = std::env::var_os("PATH").unwrap_or_default();
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let browser =
        std::env::split_paths(&path).flat_map(|folder| names.map(|name| folder.join(name))).find(|p| p.is_file());
    assert!(
        browser.is_some(),
        "no {} in PATH: install one (apt-get install chromium), name it in CRUMPLE_BROWSER, or set \
         CRUMPLE_NO_BROWSER=1",
        names.join(", ")
    );
    browser
}

/// The document after its scripts have run, and what the browser wrote to its log.
fn load(browser: &Path, page: &Path) -> (String, String) {
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"])
        .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
        .args(["--enable-logging=stderr", "--log-level=0", "--window-size=1400,1000"])
        // Virtual time: the browser goes on as soon as the page has nothing left to do.
        .arg("--virtual-time-budget=20000")
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg("--dump-dom")
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    (String::from_utf8_lossy(&output.stdout).into_owned(), String::from_utf8_lossy(&output.stderr).into_owned())
}

fn make(folder: &Path, inputs: &[PathBuf]) -> PathBuf {
    let page = folder.join("report.html");
    let output = Command::new(env!("CARGO_BIN_EXE_crumple-report"))
        .args(inputs)
        .arg("-q")
        .arg("-o")
        .arg(&page)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    page
}

/// Lines of the log that come from the page: errors, warnings, refused loads.
fn console(log: &str) -> Vec<&str> {
    log.lines().filter(|line| line.contains("CONSOLE")).collect()
}

#[test]
fn every_figure_is_drawn_and_the_console_is_silent() {
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    let inputs = sample::write_artifacts(folder.path(), true);
    let (dom, log) = load(&browser, &make(folder.path(), &inputs));
    assert_eq!(console(&log), Vec::<&str>::new());
    let root = &dom[..dom.find("<head").unwrap()];
    assert!(root.contains("data-drawn=\"9\"") && root.contains("data-failed=\"0\""), "{root}");
    // plotly draws a figure in three layers of class main-svg.
    assert_eq!(dom.matches("class=\"main-svg\"").count(), 27);
    // The curves are there: the raw and filtered acceleration, v and s, and four models in four panels with the test in
    // three.
    assert!(dom.matches("class=\"js-line\"").count() >= 4 + 3 + 16, "{}", dom.matches("class=\"js-line\"").count());
    assert!(dom.contains("and its dual: same record"));
}

#[test]
fn a_report_of_one_artifact_is_drawn_too() {
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    let inputs = sample::write_artifacts(folder.path(), true);
    let (dom, log) = load(&browser, &make(folder.path(), &inputs[..1]));
    assert_eq!(console(&log), Vec::<&str>::new());
    assert!(dom.contains("data-drawn=\"1\"") && dom.contains("data-failed=\"0\""));
}

#[test]
fn a_broken_figure_is_noticed() {
    // The check above can fail: a figure without its data is counted and reported.
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    let inputs = sample::write_artifacts(folder.path(), true);
    let page = make(folder.path(), &inputs[..1]);
    let html = std::fs::read_to_string(&page).unwrap().replace("id=\"motion-data\"", "id=\"lost\"");
    std::fs::write(&page, html).unwrap();
    let (dom, log) = load(&browser, &page);
    assert!(dom.contains("data-drawn=\"0\"") && dom.contains("data-failed=\"1\""));
    assert_eq!(console(&log).len(), 1, "{log}");
}
