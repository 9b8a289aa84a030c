//! The index of many runs: what a row says, which text cannot leave it, how large it is.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crumple_testkit::browser::{Browser, Screen};
use serde_json::{Value, json};

/// A run of a fixture: its summary and its filtered pulse.
const FIXTURES: [&str; 4] = ["double", "elastoplastic", "kelvin", "noisy"];

fn golden(fixture: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures").join(fixture).join("golden")
}

/// A run folder with the results of a fixture, and a report that links lead to.
fn run_folder(runs: &Path, name: &str, fixture: &str) -> PathBuf {
    let folder = runs.join(name);
    fs::create_dir_all(&folder).unwrap();
    for file in ["summary.json", "2-filter.mcap"] {
        fs::copy(golden(fixture).join(file), folder.join(file)).unwrap();
    }
    fs::write(folder.join("report.html"), "<!DOCTYPE html>").unwrap();
    folder
}

/// The same with another summary.
fn changed(folder: &Path, change: impl FnOnce(&mut Value)) {
    let path = folder.join("summary.json");
    let mut summary: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    change(&mut summary);
    fs::write(&path, summary.to_string()).unwrap();
}

fn index(folder: &Path, inputs: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_crumple-report"));
    command.current_dir(folder).arg("--index").args(inputs).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_row_has_the_numbers_the_model_how_sure_it_is_and_the_first_warning() {
    let folder = tempfile::tempdir().unwrap();
    run_folder(folder.path(), "runs/a b/default", "double");
    run_folder(folder.path(), "runs/c/default", "elastoplastic");
    let output = index(folder.path(), &["runs/c/default", "runs/a b/default"]);
    assert!(output.status.success(), "{}", said(&output));
    assert!(said(&output).contains("2 runs: "), "{}", said(&output));
    let page = fs::read_to_string(folder.path().join("index.html")).unwrap();
    let row = page.lines().find(|line| line.starts_with("<tr><th><a href=\"runs/a%20b/default/report.html\">a b</a>"));
    let row = row.unwrap_or_else(|| panic!("{page}"));
    // Speed, mass, C, time of it, delta-v, restitution of the fixture: 50 km/h, 1500 kg, 684.1 mm, 76.1 ms, 93.0 km/h.
    for cell in ["<td>50.0<td>1500<td>684<td>76.1<td>93.0<td>", "<td>0.861<td>", "<td>4 of 4 determined<td>"] {
        assert!(row.contains(cell), "{cell}: {row}");
    }
    // The status is a word; its reason and both answers are in its tooltip, which paper shows.
    let answers = "record: wrong: the impact speed; good for: measured quantities";
    let status =
        format!("<td class=bad title=\"do not use: the impact speed is in doubt, see warning 1.; {answers}\">");
    assert!(
        row.contains(&(status + "do not use<td>")) && row.contains("<td>none<td>") && row.contains("<svg class=s "),
        "{row}"
    );
    assert!(page.contains(">usable<td>") && page.contains("<td>Elastoplastic spring"), "{page}");
    // The status stands beside the name, and the head counts it.
    assert!(row.contains("a b</a><td class=bad ") && page.contains("<p>2 runs: 1 usable, 1 do not use."), "{row}");
    // The first warning stands whole, and a terminal has a line for each run.
    assert!(row.contains("<td>check the impact speed (50.0 km/h)") && row.contains("[CR323]"), "{row}");
    let lines = said(&output);
    assert!(
        lines.lines().any(|line| line.starts_with("c ") && line.contains(" 696 ") && line.contains("  usable: ")),
        "{lines}"
    );
    // In the order of the names, whatever the order of the command line.
    let before = page.find("a%20b/default").unwrap();
    assert!(before < page.find("runs/c/default").unwrap());
    index(folder.path(), &["runs/a b/default", "runs/c/default", "./runs/c/default/", "-o", "again.html"]);
    assert_eq!(page, fs::read_to_string(folder.path().join("again.html")).unwrap());
}

#[test]
fn text_of_a_test_stays_text() {
    let folder = tempfile::tempdir().unwrap();
    let name = "runs/<img src=x onerror=alert(1)>";
    let run = run_folder(folder.path(), name, "kelvin");
    changed(&run, |summary| {
        summary["test"]["vehicle"] = json!("</table><script>alert(1)</script>");
        summary["test"]["title"] = json!("\"><script>alert(2)</script>");
        summary["concerns"][0]["text"] = json!("<b onclick='alert(3)'>&");
        summary["recommended"] = json!("<i>/direct-fit/1");
    });
    let other = run_folder(folder.path(), "runs/b", "kelvin");
    changed(&other, |summary| {
        summary["verdict"]["standing"] = json!("no-result");
        summary["verdict"]["reason"] = json!("<script>alert(4)</script>");
    });
    let output = index(folder.path(), &[name, "runs/b"]);
    assert!(output.status.success(), "{}", said(&output));
    let page = fs::read_to_string(folder.path().join("index.html")).unwrap();
    assert_eq!(page.matches("<script").count(), 1, "the page's own");
    assert!(!page.contains("<img") && !page.contains("<b onclick") && !page.contains("<i>"), "{page}");
    assert!(page.contains("&lt;script&gt;alert(4)") && page.contains("default-src 'none'"));
}

#[test]
fn a_run_without_a_result_is_a_row_and_its_reason_is_named() {
    let folder = tempfile::tempdir().unwrap();
    run_folder(folder.path(), "runs/good", "elastoplastic");
    for number in 1..=3 {
        let run = run_folder(folder.path(), &format!("runs/bad {number}"), "noisy");
        changed(&run, |summary| {
            summary["verdict"]["standing"] = json!("no-result");
            summary["verdict"]["reason"] = json!(format!("candidate {number} follows {number}0 % of the record"));
            summary["recommended"] = Value::Null;
        });
    }
    let output = index(folder.path(), &["runs/good", "runs/bad 1", "runs/bad 2", "runs/bad 3"]);
    assert!(output.status.success() && said(&output).contains("4 runs: 1 usable, 3 without a result"));
    let page = fs::read_to_string(folder.path().join("index.html")).unwrap();
    let first = "<summary>3 × no acceptable result</summary><ul>\n<li>";
    assert!(page.contains(first) && page.matches(": candidate ").count() == 3, "{page}");
    assert!(page.contains("<td><b>no acceptable result</b>"), "{page}");
    assert!(page.contains("<td>candidate 2 follows 20 % of the record"), "{page}");
}

#[test]
fn a_run_that_was_refused_is_a_row_with_the_stage_it_ended_at() {
    let folder = tempfile::tempdir().unwrap();
    run_folder(folder.path(), "runs/good", "elastoplastic");
    for (run, code) in [("refused", 3), ("earlier", 1)] {
        let run = run_folder(folder.path(), &format!("runs/{run}"), "kelvin");
        fs::copy(golden("kelvin").join("1-ingest.mcap"), run.join("1-ingest.mcap")).unwrap();
        let noted = format!("base = 'none'\n[run]\nname = 'default'\nstate = 'failed'\nexit_code = {code}\n");
        fs::write(run.join("0-pipeline.toml"), noted).unwrap();
    }
    for file in ["summary.json", "report.html"] {
        fs::remove_file(folder.path().join("runs/refused").join(file)).unwrap();
    }
    let output = index(folder.path(), &["runs/good", "runs/refused", "runs/earlier"]);
    assert!(output.status.success() && said(&output).contains("2 without a result"), "{}", said(&output));
    let page = fs::read_to_string(folder.path().join("index.html")).unwrap();
    let row = |name: &str| page.lines().find(|line| line.starts_with("<tr>") && line.contains(name)).unwrap();
    assert!(row("refused").contains("<td><b>refused</b>"), "{}", row("refused"));
    assert!(row("refused").contains("<td>the run ended at integrate, before its report"), "{}", row("refused"));
    assert!(row("earlier").contains("<td><b>failed</b>") && row("earlier").contains("<td>the last run ended"));
}

#[test]
fn a_folder_without_a_summary_is_named_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    run_folder(folder.path(), "runs/good", "kelvin");
    fs::create_dir(folder.path().join("runs/empty")).unwrap();
    let output = index(folder.path(), &["runs/good", "runs/empty"]);
    let error = said(&output);
    assert_eq!(output.status.code(), Some(3), "{error}");
    assert!(error.contains("runs/empty holds no results of a run") && error.contains("just run RECORD"), "{error}");
    assert!(!folder.path().join("index.html").exists());
    fs::write(folder.path().join("runs/empty/summary.json"), "{}").unwrap();
    let output = index(folder.path(), &["runs/empty"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(said(&output).contains("runs/empty/summary.json is no summary of a run"), "{}", said(&output));
    fs::write(folder.path().join("runs/empty/summary.json"), r#"{"schema": "crumple.together.v1"}"#).unwrap();
    let output = index(folder.path(), &["runs/empty"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(said(&output).contains("runs/empty is a model of several tests, not a run"), "{}", said(&output));
    let output = index(folder.path(), &["@none.txt"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("cannot read the list none.txt"), "{}", said(&output));
    fs::write(folder.path().join("mine.html"), "<title>mine</title>").unwrap();
    let output = index(folder.path(), &["runs/good", "-o", "mine.html"]);
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert_eq!(fs::read_to_string(folder.path().join("mine.html")).unwrap(), "<title>mine</title>");
}

#[test]
fn five_hundred_runs_of_a_list_are_a_page_below_half_a_megabyte() {
    let folder = tempfile::tempdir().unwrap();
    let mut list = "# made\n\n".to_owned();
    for number in 0..500 {
        let name = format!("runs/{number:05}-{}km/default", 40 + number % 3 * 8);
        let run = run_folder(folder.path(), &name, FIXTURES[number % 4]);
        changed(&run, |summary| summary["test"]["vehicle"] = json!(format!("2014 MADE SEDAN {number:05}")));
        list.push_str(&format!("{name}\n"));
    }
    fs::write(folder.path().join("list.txt"), list).unwrap();
    let output = index(folder.path(), &["@list.txt"]);
    assert!(output.status.success(), "{}", said(&output));
    let page = fs::read_to_string(folder.path().join("index.html")).unwrap();
    assert_eq!(page.matches("<tr><th><a href=").count(), 500);
    assert_eq!(page.matches("<svg class=s ").count(), 500);
    eprintln!("index of 500 runs: {} bytes", page.len());
    assert!(page.len() < 500_000, "{}", page.len());
}

#[test]
fn heads_sort_by_key_and_a_telephone_scrolls_the_table_alone() {
    let Some(browser) = Browser::start("the index") else { return };
    let folder = tempfile::tempdir().unwrap();
    for (number, fixture) in FIXTURES.into_iter().enumerate() {
        let run = run_folder(folder.path(), &format!("runs/{number}"), fixture);
        changed(&run, |summary| {
            summary["test"]["mass_kg"] = [json!(900.0), Value::Null, json!(1200.0), json!(80.0)][number].clone();
        });
    }
    assert!(index(folder.path(), &["runs/0", "runs/1", "runs/2", "runs/3"]).status.success());
    let script = "
        const head = document.querySelectorAll('.index thead th')[4];
        const button = head.querySelector('button');
        const masses = () => [...document.querySelectorAll('.index tbody tr')].map((r) => r.cells[4].textContent);
        button.focus();
        const seen = () => [masses(), head.getAttribute('aria-sort')];";
    for screen in [Screen::PHONE, Screen::DESK] {
        let page = browser.open(&folder.path().join("index.html"), "", screen);
        let seen = || page.ask(&format!("{script} return seen();"));
        seen();
        page.press("Enter");
        assert_eq!(seen(), json!([["80.0", "900", "1200", ""], "ascending"]));
        page.press("Enter");
        assert_eq!(seen(), json!([["1200", "900", "80.0", ""], "descending"]));
        assert_eq!(page.ask("return document.querySelectorAll('.index thead button').length"), 15);
        assert_eq!((page.console(), page.requests()), (vec![], vec![]));
        let wide = page.ask("return document.documentElement.scrollWidth").as_u64().unwrap();
        assert!(wide <= u64::from(screen.width), "{wide} on {screen:?}");
    }
}
