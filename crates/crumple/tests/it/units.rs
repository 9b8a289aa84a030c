//! The units of the reader: every number that people see follows `--display us`, and nothing that a script reads does.

use std::fs;
use std::path::Path;

use crate::{crumple, stderr, stdout};

/// Units of metric pages. They stand behind a number, or at the end of the head of a column and the title of an axis.
/// Identified models stay in SI: m/s² is a unit of their equations.
const METRIC: [&str; 10] = ["km/h", "mm", "cm", "kg", "kN", "kN/m", "kN·s/m", "kJ", "N/m", "m/s"];

/// The text of a page, tags left out, with what stands in titles; no data of scripts, no style.
fn text(page: &str) -> String {
    let mut out = String::new();
    let mut rest = page;
    while let Some(at) = rest.find('<') {
        out.push_str(&rest[..at]);
        let tag = &rest[at..];
        let end = ["script", "style"].iter().find(|name| tag[1..].starts_with(**name));
        let (inside, behind) = match end {
            Some(name) => tag.split_once(&format!("</{name}>")).unwrap_or((tag, "")),
            None => tag.split_once('>').unwrap_or((tag, "")),
        };
        if end.is_none() {
            for title in inside.split(" title=\"").skip(1) {
                out.push_str(&format!("\n{}\n", title.split('"').next().unwrap_or_default()));
            }
        }
        out.push('\n');
        rest = behind;
    }
    out + rest
}

/// Stretches that end with a metric unit behind a number or as a head: `crush, mm`.
fn left_behind(text: &str) -> Vec<String> {
    let is_end = |c: Option<char>| c.is_none_or(|c| !(c.is_alphanumeric() || "/^·²*_-".contains(c)));
    let mut found = Vec::new();
    for unit in METRIC {
        for (at, _) in text.match_indices(unit) {
            let before = text[..at].trim_end_matches([' ', '\u{a0}']);
            let last = before.chars().next_back();
            let is_unit = last.is_some_and(|c| c.is_ascii_digit()) || before.ends_with(',') || before.ends_with('\n');
            if is_unit && is_end(text[at + unit.len()..].chars().next()) {
                let start = before.char_indices().rev().nth(60).map_or(0, |(at, _)| at);
                found.push(text[start..at + unit.len()].replace('\n', "|"));
            }
        }
    }
    found
}

fn assert_us(what: &str, text: &str) {
    let left = left_behind(text);
    assert!(left.is_empty(), "{what}: {} left:\n{}", left.len(), left.join("\n"));
    assert!(text.contains("mph") || text.contains(" in"), "{what} has no unit of the United States: {text}");
}

#[test]
fn what_is_left_in_metric_units_is_found() {
    assert_eq!(left_behind("crush 706 mm, 12\u{a0}km/h; at 30 mph; CFC 60, mm").len(), 3);
    assert_eq!(left_behind("27.8 in, mmHg, 5 kN·m, SAE J211"), [""; 0]);
}

/// Done, what it printed on both streams.
fn done(folder: &Path, words: &[&str]) -> String {
    let output = crumple(folder, words);
    assert_eq!(output.status.code(), Some(0), "{words:?}: {}{}", stdout(&output), stderr(&output));
    stdout(&output) + &stderr(&output)
}

#[test]
fn every_number_follows_the_units_of_the_reader_and_no_file_for_scripts_does() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let read = |path: &str| fs::read_to_string(at.join(path)).unwrap();
    let run = "runs/crumple-demo/default";
    done(at, &["demo"]);
    let metric = read(&format!("{run}/summary.json"));
    let before = fs::read(at.join(run).join("3-integrate.mcap")).unwrap();

    assert_us("console", &done(at, &["run", "crumple-demo.csv", "--display", "us"]));
    assert_eq!(read(&format!("{run}/summary.json")), metric);
    assert_eq!(fs::read(at.join(run).join("3-integrate.mcap")).unwrap(), before);
    let page = read(&format!("{run}/report.html"));
    assert_us("report", &text(&page));
    assert!(page.contains("\"mph\"") && !page.contains("\"km/h\""), "What if");
    assert!(read(&format!("{run}/0-pipeline.toml")).contains("display = \"us\""));

    // The report of a folder keeps the units of its pipeline; a flag is stronger.
    done(at, &["report", run]);
    assert_us("report again", &text(&read(&format!("{run}/report.html"))));
    done(at, &["report", run, "--display", "si"]);
    assert!(!left_behind(&text(&read(&format!("{run}/report.html")))).is_empty());

    assert_us("predict", &done(at, &["predict", run, "--speed", "30..40/5 mph", "--display", "us"]));
    assert_us("predict, page", &text(&read(&format!("{run}/report.html"))));
    assert_us("index, console", &done(at, &["index", run, "--display", "us"]));
    assert_us("index", &text(&read("index.html")));

    done(at, &["run", "crumple-demo.csv", "--mass", "1600kg", "-o", "runs/heavy"]);
    assert_us("compare, console", &done(at, &["compare", run, "runs/heavy", "--display", "us"]));
    assert_us("compare", &text(&read("compare.html")));
    fs::create_dir(at.join("tests")).unwrap();
    let record = read("crumple-demo.csv");
    // Another record: without its last sample.
    let shorter = record.trim_end().rsplit_once('\n').unwrap().0;
    fs::write(at.join("tests/a.csv"), &record).unwrap();
    fs::write(at.join("tests/b.csv"), shorter).unwrap();
    done(at, &["fleet", "tests", "--display", "us"]);
    assert_us("fleet", &text(&read("runs/fleet/tests/fleet.html")));
    let other = crumple(at, &["run", "crumple-demo.csv", "--set", "report.display=imperial"]);
    assert_eq!(other.status.code(), Some(2), "{}", stderr(&other));
    assert!(stderr(&other).contains("write si or us"), "{}", stderr(&other));
}
