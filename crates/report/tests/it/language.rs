//! The pages in German: no text of the English page is left in them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::sample;
use crumple_browser::{Browser, Screen};
use crumple_report::Language;
use crumple_testkit::SAME_IN_GERMAN;

/// Names of the sample: its title, stages, models, candidates, parameters, runs, quantities of a rating.
fn is_name(text: &str) -> bool {
    let of_the_sample = ["Frontal <b>impact", "era-", "Kelvin, ", "Maxwell, ", "Double spring-mass-damper, ", "accel"];
    let stages = ["ingest", "filter", "integrate", "identify", "parameter-solve", "simulate", "predict", "report"];
    let is_symbol = text.len() <= 2 && text.starts_with(['k', 'c', 'm']);
    let is_parameter = ["k1, kN/m", "k2, kN/m", "c1, kN·s/m", "c2, kN·s/m", "m1, kg", "m2, kg"].contains(&text);
    is_symbol
        || is_parameter
        || of_the_sample.iter().any(|start| text.starts_with(start))
        || stages.contains(&text)
        || ["+", "−", "a", "b", "k loading", "k unloading", "filter.version"].contains(&text)
}

fn make(page: &Path, inputs: &[PathBuf], more: &[&str]) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_crumple-report"));
    let output = command.args(inputs).args(more).args(["-q", "-o"]).arg(page).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Labels of a page that stand in both languages and are no names.
fn left_in_english(browser: &Browser, folder: &Path, inputs: &[PathBuf], kind: &[&str]) -> BTreeSet<String> {
    let labels = |code: &str| {
        let page = folder.join(format!("{code}.html"));
        make(&page, inputs, &[kind, &["--language", code]].concat());
        let open = browser.open(&page, "", Screen::DESK);
        assert_eq!((open.console(), open.ask("return document.documentElement.lang")), (vec![], code.into()));
        open.labels()
    };
    let (english, german) = (labels("en"), labels("de"));
    assert!(english.len() > 10 && german.len() > 10, "{english:?}");
    let same = english.intersection(&german);
    same.filter(|text| !SAME_IN_GERMAN.contains(&text.as_str()) && !is_name(text)).cloned().collect()
}

#[test]
fn a_german_page_has_no_label_of_the_english_one() {
    let Some(browser) = Browser::start("the German pages") else { return };
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("runs/a/default");
    std::fs::create_dir_all(&run).unwrap();
    let artifacts = sample::write_artifacts(&run, true);
    assert_eq!(left_in_english(&browser, folder.path(), &artifacts, &[]), BTreeSet::new(), "the report");
    let other = folder.path().join("runs/b/default");
    std::fs::create_dir_all(&other).unwrap();
    sample::write_with_longer_crush(&other, true, 3e-3);
    for folder in [&run, &other] {
        make(&folder.join("report.html"), &sample::write_artifacts(folder, true), &[]);
    }
    for kind in ["--compare", "--index"] {
        let left = left_in_english(&browser, folder.path(), &[run.clone(), other.clone()], &[kind]);
        assert_eq!(left, BTreeSet::new(), "{kind}");
    }
}

#[test]
fn a_german_page_writes_its_numbers_with_a_comma() {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("r.html");
    make(&page, &sample::write_artifacts(folder.path(), true), &["--language", "de"]);
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains("447,7\u{a0}<small>mm</small>") && page.contains("dynamische Eindrückung"));
    // Texts of the page, without drawings, scripts and what stages have written.
    let body = page.split("<main>").nth(1).unwrap();
    let cells: Vec<&str> = body.split("<td class=\"n\">").skip(1).map(|rest| rest.split('<').next().unwrap()).collect();
    let english: Vec<&&str> = cells
        .iter()
        .filter(|cell| {
            let bytes = cell.as_bytes();
            bytes.windows(3).any(|w| w[0].is_ascii_digit() && w[1] == b'.' && w[2].is_ascii_digit())
        })
        .collect();
    assert!(cells.len() > 100 && english.is_empty(), "{english:?}");
}

#[test]
fn every_definition_of_a_metric_has_a_german_text() {
    let known: BTreeSet<&str> =
        crumple_metrics::definitions::CATALOGUE.iter().map(|definition| definition.id).collect();
    let said: BTreeSet<&str> = crumple_phrases::names::definitions::DEFINITIONS.iter().map(|(key, _)| *key).collect();
    assert_eq!(known, said);
    let of_hic = |words: &str| Language::German.definition(Some("hic15-fmvss208"), words);
    assert!(of_hic("head injury criterion").starts_with("Kopfverletzungskriterium"));
    for of_this_record in ["absent: no head sensor", "head injury criterion: lower bound"] {
        assert_eq!(of_hic(of_this_record), of_this_record);
    }
}
