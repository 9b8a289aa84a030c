//! `crumple diff A B` of two runs that differ in one thing: the exit code, and the cause by its name.

use std::path::Path;
use std::process::Command;

use crumple_testkit::programs::binary;
use crumple_testkit::workspace;
use rayon::prelude::*;
use serde_json::Value;

/// What the scripts below share. `a` is a run of the record; `b` starts as a copy of it.
const PRELUDE: &str = r#"set -e
models="--set parameter-solve.models=kelvin,elastoplastic -q"
again() { rm -rf b; crumple run crash.csv $models -o b "$@"; }
edit() {
    crumple artifact unpack -q a/$1.mcap plain
    sed -i "$2" plain/records.ndjson
    sed -i "${3:-;}" plain/provenance.json
    crumple artifact pack -q plain b/$1.mcap
}
"#;

/// A pair: what is done, how `diff a b` ends, and the causes that it names.
type Pair = (&'static str, &'static str, i32, &'static [&'static str]);

const PAIRS: [Pair; 47] = [
    // The test.
    ("mass", "again --mass 1500kg", 1, &["test.mass_kg"]),
    ("speed", "again --impact-speed 58km/h", 1, &["test.impact_speed_m_per_s"]),
    ("speed set", "again --set 'ingest.impact_speed=58 km/h'", 1, &["test.impact_speed_m_per_s"]),
    ("time zero", "again --time-zero=2ms", 1, &["test.time_zero_s"]),
    ("mass beside the record", "echo 'mass = \"1450 kg\"' > crash.csv.toml; again", 1, &["test.mass_kg"]),
    ("the same mass beside the record", "echo 'mass = \"1400 kg\"' > crash.csv.toml; again", 0, &[]),
    ("mass in the record", "sed -i 's/mass: 1400/mass: 1450/' crash.csv; again", 1, &["test.mass_kg", "record"]),
    // Options.
    ("filter class", "again --set filter.cfc=180", 1, &["filter.cfc"]),
    ("another class", "again --set filter.cfc=1000", 1, &["filter.cfc"]),
    ("how a filter begins", "again --set filter.mode=sae_reflect", 1, &["filter.mode"]),
    ("zero level of a record without one", "again --set filter.zero_level=none", 0, &["filter.zero_level"]),
    ("rule of integration", "again --set integrate.rule=simpson", 1, &["integrate.rule"]),
    ("uncertainty", "again --set 'integrate.gain_uncertainty=2 % uniform'", 1, &["integrate.gain_uncertainty"]),
    ("order of models", "again --set parameter-solve.models=elastoplastic,kelvin", 0, &["parameter-solve.models"]),
    ("a model more", "again --set parameter-solve.models=kelvin,elastoplastic,maxwell", 1, &["parameter-solve.models"]),
    ("order of the identified model", "again --set identify.orders=6", 1, &["identify.orders"]),
    ("speeds", "again --set 'predict.speeds=40 km/h,50 km/h'", 1, &["predict.speeds"]),
    ("no predictions", "again --set predict=false", 1, &["predict"]),
    // Programs.
    ("threads", "RAYON_NUM_THREADS=1 again", 0, &[]),
    ("twice", "again", 0, &[]),
    ("a filter of one's own", "again --stage \"filter=python3 $OWN filter:wide\"", 1, &["filter"]),
    ("the same by a program of one's own", "again --stage \"simulate=python3 $OWN simulate:copy\"", 0, &["simulate"]),
    (
        "a program with another remark",
        "cp $OWN own.py; own=\"filter=python3 own.py filter:wide\"
         crumple run crash.csv $models --stage \"$own\" -o a --force
         echo '# a remark' >> own.py; again --stage \"$own\"",
        0,
        &["filter"],
    ),
    ("version", "edit 2-filter ';' 's/\"stage_version\": *\"[^\"]*\"/\"stage_version\":\"0.1.0\"/'", 0, &["filter"]),
    // The record.
    ("one sample by 14 g", "sed -i '1000s/.*/0.0494,-40/' crash.csv; again", 1, &["record"]),
    ("last digit of a sample", "sed -i '1000s/.$/1/' crash.csv; again", 0, &["record"]),
    (
        "noise",
        "awk -F, -v OFS=, '/^[-0-9]/{$2+=((NR*7919)%13-6)*0.01}1' crash.csv > n; mv n crash.csv; again",
        1,
        &["record"],
    ),
    (
        "half of the samples",
        "awk '!/^[-0-9]/||NR%2' crash.csv > n; mv n crash.csv; again",
        1,
        &["test.sample_rate_hz", "record"],
    ),
    ("20 ms less", "head -n 2300 crash.csv > n; mv n crash.csv; again", 1, &["record"]),
    ("channel renamed", "sed -i 's/accel_g/sill_g/' crash.csv; again", 1, &["test.channel", "record"]),
    (
        "sensor added",
        "awk -F, -v OFS=, '/^time/{print $0,\"tunnel_g\";next} /^[-0-9]/{print $0,$2*1.01;next} 1' crash.csv > n
         mv n crash.csv; again --channel accel_g",
        1,
        &["record"],
    ),
    ("title", "sed -i 's/title: synthetic/title: another/' crash.csv; again", 1, &["record"]),
    ("ends of lines", "sed -i 's/$/\\r/' crash.csv; again", 0, &["record"]),
    ("name of the file", "mv crash.csv other.csv; crumple run other.csv $models -o b", 0, &[]),
    // What stands in artifacts and summary.
    ("order of candidates", "edit 5-parameter-solve '1!G;h;$!d'", 0, &["parameter-solve"]),
    (
        "a parameter to zero",
        "edit 5-parameter-solve '/closed-form\\/1\"/s/\"unloading_stiffness_n_per_m\":[0-9.]*/\
         \"unloading_stiffness_n_per_m\":0.0/'",
        1,
        &["parameter-solve"],
    ),
    (
        "a deviation by 1000",
        "edit 5-parameter-solve \
         '/plastic\\/closed-form\\/1\"/s/\"standard_deviation\":{\"loading_stiffness_n_per_m\":/&999/'",
        1,
        &["parameter-solve"],
    ),
    (
        "an interval",
        "edit 5-parameter-solve \
         '/plastic\\/closed-form\\/1\"/s/\\(\"interval_low\":{\"loading_stiffness_n_per_m\":\\)[0-9.]*/\\1100000.0/'",
        1,
        &["parameter-solve"],
    ),
    ("unit of a channel", "edit 2-filter 's/\"unit\":\"m\\/s^2\"/\"unit\":\"g\"/'", 1, &["filter"]),
    ("minus zero", "edit 3-integrate 's/:0\\.0\\([,}]\\)/:-0.0\\1/g'", 0, &["integrate"]),
    (
        "recommendation",
        "edit 5-parameter-solve \
         '/recommendation\"/s#\"recommended\":\"[^\"]*\"#\"recommended\":\"kelvin/direct-fit/1\"#'",
        1,
        &["parameter-solve"],
    ),
    (
        "compression",
        "crumple artifact unpack -q a/2-filter.mcap plain; crumple artifact pack -q --zstd plain b/2-filter.mcap",
        0,
        &[],
    ),
    ("status", "sed -i 's/\"status\": \"usable\"/\"status\": \"do-not-use\"/' b/summary.json", 1, &[]),
    ("an artifact is gone", "rm b/6-simulate.mcap", 1, &[]),
    (
        "an artifact of another run",
        "crumple run crash.csv --mass 1500kg $models -o c; cp c/3-integrate.mcap b/",
        1,
        &[],
    ),
    // No result to compare.
    ("half an artifact", "head -c 3000 a/3-integrate.mcap > b/3-integrate.mcap", 2, &[]),
    ("a refused record", "echo nonsense > crash.csv; crumple run crash.csv $models -o b || true", 2, &[]),
];

/// Runs a script in a folder; its exit code, and what it printed on both ways.
fn shell(folder: &Path, script: &str) -> (i32, String, String) {
    let programs = binary("crumple").parent().unwrap().to_owned();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let paths = std::env::join_paths(std::iter::once(programs).chain(std::env::split_paths(&path))).unwrap();
    let own = workspace().join("crates/testkit/tests/it/swapped_stages.py");
    let mut command = Command::new("sh");
    command.args(["-c", &format!("{PRELUDE}{script}")]).current_dir(folder).env("PATH", paths).env("OWN", own);
    let ended = command.output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (ended.status.code().unwrap_or(-1), text(&ended.stdout), text(&ended.stderr))
}

/// A folder with the record and a run of it, `a`.
fn with_a_run() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(workspace().join("fixtures/elastoplastic/crash.csv"), folder.path().join("crash.csv")).unwrap();
    let (code, _, said) = shell(folder.path(), "crumple run crash.csv $models -o a");
    assert_eq!(code, 0, "{said}");
    folder
}

/// What is wrong with a pair.
fn fault(base: &Path, (_, script, exit, causes): &Pair) -> Option<String> {
    let folder = tempfile::tempdir().unwrap();
    let copy = format!("cp -r {0}/a {0}/crash.csv . && cp -r a b", base.display());
    let (code, _, said) = shell(folder.path(), &format!("{copy}\n{script}"));
    if code != 0 {
        return Some(format!("the script ends with {code}: {said}"));
    }
    let (code, json, said) = shell(folder.path(), "crumple diff a b --json");
    if code != *exit {
        return Some(format!("exit {code} for {exit}: {said}{}", json.lines().take(60).collect::<String>()));
    }
    if code == 2 {
        // Trouble names the place and something to do.
        return (!(said.contains("b/") && said.contains("hint: ") || said.contains("into b"))).then_some(said);
    }
    let value: Value = serde_json::from_str(&json).unwrap();
    let found = value["summary"][0]["causes"].as_array().unwrap().iter().map(|cause| cause["name"].as_str().unwrap());
    let found: Vec<&str> = found.collect();
    (found != *causes).then(|| format!("causes {found:?} for {causes:?}"))
}

#[test]
fn one_change_is_seen_and_its_cause_named() {
    let base = with_a_run();
    let faults: Vec<String> = PAIRS
        .par_iter()
        .filter_map(|pair| fault(base.path(), pair).map(|fault| format!("{}: {fault}", pair.0)))
        .collect();
    assert!(faults.is_empty(), "{} of {}:\n{}", faults.len(), PAIRS.len(), faults.join("\n"));
}

#[test]
fn a_pipeline_states_within_which_limits_its_runs_are_the_same() {
    let folder = with_a_run();
    let of_limits = |limits: &str| {
        format!(
            "printf 'title = \"Mine\"\\n[parameter-solve]\\nmodels = [\"kelvin\"]\\n[diff]\\n{limits}\\n' > mine.toml
             rm -rf a b
             crumple run crash.csv --pipeline mine.toml -q -o a
             crumple run crash.csv --pipeline mine.toml -q -o b --impact-speed 56.3km/h"
        )
    };
    let told = |script: &str| {
        let (code, json, said) = shell(folder.path(), &format!("{script}\ncrumple diff a b --json"));
        let value: Value = serde_json::from_str(&json).unwrap_or_else(|_| panic!("{code} {said}"));
        let differs = |row: &&Value| row["name"] == "dynamic_crush" && row["differs"] == true;
        (code, value["summary"][0]["numbers"].as_array().unwrap().iter().filter(differs).count())
    };
    assert_eq!(told(&of_limits("\"/test\" = { ignore = true }")), (1, 1));
    assert_eq!(told(&of_limits("\"/metrics#[dynamic_crush].value\" = { abs = 0.02 }")), (1, 0));
    assert_eq!(told(&of_limits("\"*\" = { ignore = true }")), (0, 0));
    // The limits of what was accepted hold, and others are seen: a change does not widen its own.
    let script = format!(
        "{}\nmkdir -p runs/crash; cp -r a runs/crash/default; crumple accept runs --into expected >&2
         sed -i 's/abs = 0.02/abs = 0.2/' runs/crash/default/0-pipeline.toml
         crumple diff expected runs --json",
        of_limits("\"/metrics#[dynamic_crush].value\" = { abs = 0.02 }")
    );
    let (code, json, said) = shell(folder.path(), &script);
    let value: Value = serde_json::from_str(&json).unwrap_or_else(|_| panic!("{code} {said}"));
    let facts = value["summary"][0]["facts"].as_array().unwrap();
    let name = "limits./metrics#[dynamic_crush].value.abs";
    assert!(code == 1 && facts.len() == 1 && facts[0]["name"] == name, "{code} {facts:?}");
    let cause = &value["summary"][0]["causes"][0];
    assert_eq!(
        (&cause["name"], &cause["from"], &cause["to"]),
        (&name.into(), &"0.02".into(), &"0.2".into()),
        "{cause}"
    );
    assert!(cause["place"][0].as_str().unwrap().ends_with("0-pipeline.toml"), "{cause}");
    let (_, _, said) = shell(folder.path(), "crumple diff expected runs >&2 || true");
    assert!(said.contains("0.02 -> 0.2") && said.contains("; no option, record or program differs"), "{said}");
    // A comparison side by side has the same limits.
    let script = |limits: &str| format!("{}\ncrumple compare a b -o c.html", of_limits(limits));
    let (code, _, said) = shell(folder.path(), &script("\"/metrics#[dynamic_crush].value\" = { abs = 0.02 }"));
    let crush = said.lines().find(|line| line.starts_with("Dynamic crush")).unwrap_or_else(|| panic!("{said}"));
    let words = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(code == 0 && words.contains("pipeline states") && !crush.contains('≠'), "{code} {said}");
    let (_, _, said) = shell(folder.path(), &script("\"/notes\" = { ignore = true }"));
    assert!(said.lines().any(|line| line.starts_with("Dynamic crush") && line.contains('≠')), "{said}");
}

#[test]
fn a_limit_that_is_none_is_refused_when_the_pipeline_is_read() {
    let folder = with_a_run();
    for (line, found) in [
        ("\"*\" = { abs = -1.0 }", "\"*\": -1 is no tolerance, expected a number from 0"),
        ("\"*\" = { rel = nan }", "\"*\": NaN is no tolerance, expected a number from 0"),
        ("\"*\" = { rel = inf }", "\"*\": inf is no tolerance, expected a number from 0"),
        ("\"*\" = {}", "\"*\": no tolerance is given, expected abs, rel or ignore = true"),
        ("\"*\" = 0.1", "\"*\": invalid type: floating point `0.1`, expected a table such as"),
        ("\"*\" = { relative = 0.1 }", "\"*\": unknown field `relative`"),
        ("\"/metric#*\" = { rel = 0.1 }", "\"/metric#*\": no stage writes a topic \"/metric\""),
    ] {
        let mine =
            format!("printf '[diff]\n%s\n' '{line}' > mine.toml; crumple run crash.csv --pipeline mine.toml -o c");
        let accept =
            format!("rm -rf c; cp -r a c; printf '\n[diff]\n%s\n' '{line}' >> c/0-pipeline.toml; crumple accept c");
        for (script, file) in [(mine, "mine.toml, [diff]: "), (accept, "c/0-pipeline.toml, [diff]: ")] {
            let (code, _, said) = shell(folder.path(), &script);
            let text = format!("{file}{found}");
            assert!(code == 2 && said.contains(&text) && said.contains("hint: "), "{code} {said} for {text}");
            assert!(!folder.path().join("expected").exists());
        }
    }
}
