//! Stages by another hand: honest ones change nothing, what contradicts is refused or said first.

use std::path::Path;
use std::process::Command;

use crumple_testkit::programs::{binary, number};
use crumple_testkit::workspace;
use serde_json::Value;

/// How a run with a swapped stage has to end.
#[derive(Debug, Clone, Copy)]
enum End {
    /// With the numbers of the record, and nothing said against them.
    Right,
    /// Refused by the row of this code.
    Refused(&'static str),
    /// With the row of this code as the first warning.
    Warned(&'static str),
    /// Without a model that is recommended, for a reason that the console says.
    Without(&'static str),
    /// With an error that says this.
    Stopped(&'static str),
}

use End::{Refused, Right, Stopped, Warned, Without};

const FILTERS: [(&str, End); 42] = [
    ("honest", Right),
    ("butterworth", Right),
    ("raw", Right),
    ("rate", Right),
    ("rounded", Right),
    ("wide", Right),
    ("twice", Right),
    ("causal", Warned("CR203")),
    ("lag", Warned("CR203")),
    ("late 3", Warned("CR203")),
    ("early 3", Refused("CR201")),
    ("late 20", Warned("CR203")),
    ("early 20", Refused("CR201")),
    ("begins late", Refused("CR201")),
    ("begins at 10 ms", Refused("CR201")),
    ("tail", Warned("CR202")),
    ("sign", Refused("CR204")),
    ("g", Refused("CR204")),
    ("mm", Refused("CR204")),
    ("gain", Warned("CR207")),
    ("small gain", Warned("CR207")),
    ("offset", Warned("CR207")),
    ("clip", Warned("CR207")),
    ("reverse", Warned("CR203")),
    ("every second", Warned("CR207")),
    ("in ms", Refused("CR204")),
    ("zero", Refused("CR204")),
    ("velocity", Refused("CR204")),
    ("cut", Warned("CR202")),
    ("half", Warned("CR207")),
    ("absolute", Refused("CR204")),
    ("jerk", Refused("CR204")),
    ("failed", Warned("CR205")),
    ("mass", Refused("CR206")),
    ("speed", Refused("CR206")),
    ("other title", Stopped("describe different tests")),
    ("no pulse", Refused("CR209")),
    ("stated late", Warned("CR203")),
    ("stated early", Refused("CR201")),
    ("20 ms wide", Right),
    ("60 ms wide", Warned("CR208")),
    ("100 ms wide", Warned("CR208")),
];

const INTEGRATIONS: [(&str, End); 34] = [
    ("honest", Right),
    ("euler", Right),
    ("simpson", Right),
    ("rate", Right),
    ("no metrics", Right),
    ("no force", Right),
    ("displacement in mm", Refused("CR302")),
    ("both in mm", Refused("CR302")),
    ("velocity in km/h", Refused("CR30")),
    ("crush in mm", Refused("CR30")),
    ("time in ms", Refused("CR304")),
    ("crush x 1.3", Refused("CR304")),
    ("crush x 0.95", Refused("CR304")),
    ("restitution", Refused("CR305")),
    ("delta-v", Refused("CR305")),
    ("delta-v in km/h", Refused("CR305")),
    ("peak of another", Refused("CR305")),
    ("speed x 1.2", Refused("CR303")),
    ("without speed", Refused("CR30")),
    ("sign", Refused("CR301")),
    ("sign of displacement", Refused("CR302")),
    ("all signs", Stopped("expected at least 0")),
    ("displacement late", Refused("CR302")),
    ("all late", Refused("CR301")),
    ("force in kN", Refused("CR308")),
    ("force of another mass", Refused("CR308")),
    ("metric in km/h", Refused("CR307")),
    ("another crush", Refused("CR307")),
    ("outside", Refused("CR306")),
    ("metric outside", Refused("CR306")),
    ("of no kind", Stopped("ended with exit code 2")),
    ("no events", Refused("CR309")),
    ("small drift", Right),
    ("drift", Warned("CR310")),
];

const IDENTIFICATIONS: [(&str, End); 10] = [
    ("honest", Right),
    ("no modes", Right),
    ("two rows", Refused("CR401")),
    ("ragged", Refused("CR401")),
    ("of another", Refused("CR402")),
    ("sampled", Refused("CR402")),
    ("sign", Refused("CR40")),
    ("in Hz", Refused("CR403")),
    ("damping", Refused("CR403")),
    ("fit", Refused("CR404")),
];

const SOLUTIONS: [(&str, End); 16] = [
    ("honest", Right),
    ("recommended", Right),
    ("own, stiffer", Refused("CR604")),
    ("interval", Right),
    ("double mass", Warned("CR501")),
    ("recommended of double mass", Refused("CR603")),
    ("recommended in N/mm", Refused("CR603")),
    ("in N/mm", Without("crush")),
    ("three times as stiff", Without("crush")),
    ("outside", Refused("CR502")),
    ("nobody", Refused("CR503")),
    ("other names", Without("no parameter \"c\"")),
    ("of tomorrow", Without("of-tomorrow")),
    ("no mass", Without("needs the parameter mass_kg")),
    ("no damping", Without("needs the parameter damping_n_s_per_m")),
    ("negative", Without("crush")),
];

const ANSWERS: [(&str, &str, End); 16] = [
    ("simulate", "crush", Refused("CR601")),
    ("simulate", "nobody", Refused("CR602")),
    ("predict", "value", Refused("CR701")),
    ("predict", "interval", Refused("CR701")),
    ("predict", "more", Refused("CR703")),
    ("predict", "nobody", Refused("CR602")),
    ("predict", "no speed", Refused("CR702")),
    ("predict", "honest", Right),
    ("predict", "delta-v", Refused("CR704")),
    ("predict", "mass", Refused("CR704")),
    ("predict", "mass alone", Warned("CR706")),
    ("predict", "falls", Refused("CR70")),
    ("predict", "too far", Refused("CR70")),
    ("predict", "sure", Warned("CR705")),
    ("predict", "other speeds", Warned("CR706")),
    ("predict", "no predictions", Warned("CR706")),
];

/// Records that every stage is swapped for: a curve that unloads, a spring with a damper.
const FIXTURES: [&str; 2] = ["elastoplastic", "kelvin"];

/// What ends otherwise where the force is largest at contact, and the deceleration below 20 g: a delay moves change of
/// velocity out of the record, half of the pulse is more than half of it, and nothing is clipped.
const OF_KELVIN: [(&str, End); 6] = [
    ("late 20", Warned("CR207")),
    ("stated late", Warned("CR207")),
    ("clip", Right),
    ("half", Refused("CR204")),
    // What a wide average spreads of it before contact makes the pulse early.
    ("60 ms wide", Warned("CR203")),
    ("100 ms wide", Warned("CR207")),
];

/// Runs a fixture with a stage swapped and says in what its end differs from what it has to be.
fn difference(fixture: &str, (stage, mode, end): (&str, &str, End)) -> Option<String> {
    let other = OF_KELVIN.iter().find(|(other, _)| (fixture, stage, *other) == ("kelvin", "filter", mode));
    let end = other.map_or(end, |(_, other)| *other);
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/swapped_stages.py");
    let folder = tempfile::tempdir().unwrap();
    let programs = binary("crumple").parent().unwrap().to_owned();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let paths = std::env::join_paths(std::iter::once(programs.clone()).chain(std::env::split_paths(&path))).unwrap();
    let ended = Command::new(programs.join("crumple"))
        .arg("run")
        .arg(workspace().join("fixtures").join(fixture).join("crash.csv"))
        .arg("--project")
        .arg(workspace())
        .args(["--stage", &format!("{stage}=python3 '{}' '{stage}:{mode}'", script.display()), "--out"])
        .arg(folder.path())
        .env("PATH", paths)
        .output()
        .unwrap();
    let code = ended.status.code().unwrap_or(-1);
    let said = String::from_utf8_lossy(&ended.stderr) + String::from_utf8_lossy(&ended.stdout);
    let text = std::fs::read_to_string(folder.path().join("summary.json")).unwrap_or_default();
    let summary: Value = serde_json::from_str(&text).unwrap_or_default();
    let remarks = contradictions(&summary);
    let is_first = |code: &str| remarks.first().is_some_and(|remark| remark["code"] == code);
    // The console cuts a line.
    let is_said =
        |place: &str, text: &str| said.contains(&format!("{place}. {}", text.chars().take(40).collect::<String>()));
    let is_as_asked = match end {
        Right => {
            let golden = workspace().join("fixtures").join(fixture).join("golden/summary.json");
            let golden: Value = serde_json::from_str(&std::fs::read_to_string(golden).unwrap()).unwrap();
            let crush = number(&golden, &["events", "dynamic_crush_m"]);
            code == 0
                && remarks.is_empty()
                && (number(&summary, &["events", "dynamic_crush_m"]) / crush - 1.0).abs() < 0.02
        }
        Refused(row) => code == 3 && said.contains(&format!("[{row}")) && text.is_empty(),
        Warned(row) => [0, 4].contains(&code) && is_first(row) && is_said("1", remarks[0]["text"].as_str().unwrap()),
        Without(word) => [0, 4].contains(&code) && summary["recommended"].is_null() && said.contains(word),
        Stopped(word) => ![0, 4].contains(&code) && said.contains(word),
    };
    (!is_as_asked).then(|| format!("{fixture}: {stage} {mode}: {end:?}, exit {code}, {remarks:?}\n{said}\n"))
}

fn check(runs: impl IntoIterator<Item = (&'static str, &'static str, End)>) {
    use rayon::prelude::*;
    let runs = runs.into_iter().flat_map(|run| FIXTURES.map(|fixture| (fixture, run)));
    // No prediction is asked for at the speed of kelvin, and what is said of other speeds nobody can check.
    let runs: Vec<_> = runs.filter(|run| !matches!(run, ("kelvin", ("predict", "more", _)))).collect();
    let differ: Vec<String> = runs.par_iter().filter_map(|(fixture, run)| difference(fixture, *run)).collect();
    assert!(differ.is_empty(), "{} of {}\n{}", differ.len(), runs.len(), differ.join("\n"));
}

#[test]
fn filters() {
    check(FILTERS.map(|(mode, end)| ("filter", mode, end)));
}

#[test]
fn integrations() {
    check(INTEGRATIONS.map(|(mode, end)| ("integrate", mode, end)));
}

#[test]
fn identifications() {
    check(IDENTIFICATIONS.map(|(mode, end)| ("identify", mode, end)));
}

#[test]
fn solutions_and_answers() {
    check(SOLUTIONS.map(|(mode, end)| ("parameter-solve", mode, end)).into_iter().chain(ANSWERS));
}

#[test]
fn a_run_that_lacks_a_result_is_not_whole() {
    let folder = tempfile::tempdir().unwrap();
    let crumple = |words: &[&str]| {
        let ended = Command::new(binary("crumple")).args(words).current_dir(folder.path()).output().unwrap();
        (ended.status.code(), String::from_utf8_lossy(&ended.stderr).into_owned())
    };
    let record = workspace().join("fixtures/kelvin/crash.csv");
    let models = "parameter-solve.models=kelvin";
    assert_eq!(crumple(&["run", record.to_str().unwrap(), "-q", "--set", models, "-o", "o"]).0, Some(0));
    assert_eq!(crumple(&["check", "o"]), (Some(0), String::new()));
    for name in ["summary.json", "7-predict.mcap", "6-simulate.mcap"] {
        std::fs::remove_file(folder.path().join("o").join(name)).unwrap();
        let (code, said) = crumple(&["check", "o"]);
        assert!(code == Some(3) && said.contains(name), "{name}: {code:?} {said}");
    }
}

#[test]
fn what_a_recommended_candidate_may_miss_is_that_of_the_choice() {
    let limit = crumple_lumped_fit::SelectionRules::default().crush_limit_percent;
    assert!((100.0 * crumple_stage::joints::candidates::ADEQUATE - limit).abs() < 1e-12);
}

/// Records that end in the pulse, in the rebound and at rest, with ringing and without: nothing is said of the filter.
#[test]
fn the_stages_of_the_project_contradict_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let crumple = binary("crumple");
    let fixture = |name: &str| workspace().join("fixtures").join(name).join("crash.csv");
    let mut records: Vec<_> = ["kelvin", "double", "noisy", "elastoplastic"].map(fixture).to_vec();
    let text = std::fs::read_to_string(fixture("elastoplastic")).unwrap();
    for end_s in [0.065, 0.075, 0.080] {
        let is_inside =
            |line: &&str| line.split(',').next().and_then(|t| t.parse::<f64>().ok()).is_none_or(|t| t < end_s);
        let cut: Vec<&str> = text.lines().filter(is_inside).collect();
        let path = folder.path().join(format!("cut{:.0}.csv", 1e3 * end_s));
        std::fs::write(&path, cut.join("\n") + "\n").unwrap();
        records.push(path);
    }
    for (number, record) in records.iter().enumerate() {
        for cfc in ["60", "600"] {
            let out = folder.path().join(format!("{number}-{cfc}"));
            let mut run = Command::new(&crumple);
            run.arg("run").arg(record).arg("-q").args(["--set", &format!("filter.cfc={cfc}"), "--out"]).arg(&out);
            let ended = run.arg("--project").arg(workspace()).output().unwrap();
            let text = std::fs::read_to_string(out.join("summary.json"));
            let text = text.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&ended.stderr)));
            let summary: Value = serde_json::from_str(&text).unwrap();
            assert_eq!(contradictions(&summary), [Value::Null; 0], "{} at CFC {cfc}", record.display());
        }
    }
}

/// A shock of 2 ms that begins with the record, and CFC 60: the filter is not called a program from elsewhere.
#[test]
fn a_shock_too_short_for_its_class_is_a_warning_that_names_another_class() {
    let folder = tempfile::tempdir().unwrap();
    let shock = |t: f64| if t < 2e-3 { -100.0 * (std::f64::consts::PI * t / 2e-3).sin() } else { 0.0 };
    let rows: String = (0..2000).map(|k| 5e-5 * f64::from(k)).map(|t| format!("{t:.5},{:.4}\n", shock(t))).collect();
    let record = folder.path().join("shock.csv");
    std::fs::write(&record, format!("time [s],acceleration [g]\n{rows}")).unwrap();
    for (cfc, expected) in [("60", true), ("1000", false)] {
        let out = folder.path().join(cfc);
        let mut run = Command::new(binary("crumple"));
        run.arg("run").arg(&record).arg("-q").args(["--set", &format!("filter.cfc={cfc}"), "--out"]).arg(&out);
        let ended = run.arg("--project").arg(workspace()).output().unwrap();
        let said = String::from_utf8_lossy(&ended.stderr);
        assert_ne!(ended.status.code(), Some(3), "{said}");
        let summary: Value = serde_json::from_str(&std::fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
        let found = contradictions(&summary);
        let codes: Vec<&str> = found.iter().filter_map(|remark| remark["code"].as_str()).collect();
        assert_eq!(codes, if expected { vec!["CR226"] } else { Vec::new() }, "CFC {cfc}: {said}");
        assert!(found.iter().all(|remark| remark["remedy"].as_str().unwrap().contains("--set filter.cfc=1000")));
    }
}

/// The remarks of a summary that say what contradicts, in their order.
fn contradictions(summary: &Value) -> Vec<Value> {
    let is_one = |remark: &&Value| crumple_stage::joints::invariants().any(|row| remark["code"] == row.kind.code);
    summary["remarks"].as_array().into_iter().flatten().filter(is_one).cloned().collect()
}

/// Marks around the codes of docs/remarks.md.
const BEGIN: &str = "<!-- codes -->\n";
const END: &str = "<!-- end of codes -->\n";

/// The sections of the page, as the program that holds every stage prints them.
fn codes() -> String {
    let explained = Command::new(binary("crumple")).args(["explain", "--markdown"]).output().unwrap();
    assert!(explained.status.success(), "{}", String::from_utf8_lossy(&explained.stderr));
    String::from_utf8(explained.stdout).unwrap()
}

/// `CRUMPLE_WRITE_DOCS=1` writes the codes.
#[test]
fn the_page_lists_every_code() {
    let path = workspace().join("docs/remarks.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let (before, rest) = page.split_once(BEGIN).unwrap();
    let (found, after) = rest.split_once(END).unwrap();
    if std::env::var_os("CRUMPLE_WRITE_DOCS").is_some() {
        std::fs::write(&path, format!("{before}{BEGIN}{}{END}{after}", codes())).unwrap();
        return;
    }
    assert_eq!(found, codes(), "docs/remarks.md and the rows differ: run with CRUMPLE_WRITE_DOCS=1");
}
