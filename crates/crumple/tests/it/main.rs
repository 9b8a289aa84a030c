//! `crumple`, every program in one: what each word does, what a wrong one is answered with, links of other names.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod newcomer;
mod units;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const CRUMPLE: &str = env!("CARGO_BIN_EXE_crumple");

/// Every word that stands for a program, and those behind one.
const WORDS: [&str; 37] = [
    "demo",
    "run",
    "together",
    "fleet",
    "watch",
    "study",
    "export",
    "view",
    "passport",
    "damage",
    "plan",
    "compare",
    "index",
    "diff",
    "accept",
    "check",
    "artifact",
    "artifact show",
    "artifact notes",
    "artifact curve",
    "artifact check",
    "artifact unpack",
    "artifact pack",
    "artifact new-stage",
    "ingest",
    "filter",
    "integrate",
    "identify",
    "parameter-solve",
    "simulate",
    "predict",
    "report",
    "show",
    "notes",
    "curve",
    "explain",
    "new-stage",
];

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The program alone on a machine, in a folder.
fn crumple(folder: &Path, words: &[&str]) -> Output {
    Command::new(CRUMPLE).args(words).current_dir(folder).env("PATH", "").output().unwrap()
}

fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn every_word_is_a_program_that_names_itself_as_it_was_typed() {
    let folder = tempfile::tempdir().unwrap();
    let all = stdout(&crumple(folder.path(), &["-h"]));
    assert!(all.lines().count() <= 40, "{all}");
    let all_in_lines = stdout(&crumple(folder.path(), &["--help"]));
    assert_eq!(stdout(&crumple(folder.path(), &["help"])), all_in_lines);
    let script = |shell: &str| stdout(&crumple(folder.path(), &["completions", shell]));
    let scripts = ["bash", "zsh", "fish"].map(script);
    for word in WORDS {
        let words: Vec<&str> = word.split(' ').collect();
        let with = |flags: &[&str]| crumple(folder.path(), &[&words, flags].concat());
        let help = with(&["-h"]);
        let text = stdout(&help);
        assert_eq!(help.status.code(), Some(0), "{word}");
        assert!(text.contains(&format!("Usage: crumple {word} ")), "{word}: {text}");
        assert!(text.lines().count() <= 40 && !text.contains("e.g\n"), "{word} -h: {text}");
        let whole = stdout(&crumple(folder.path(), &[&["help"], &words[..]].concat()));
        assert!(text.lines().count() <= whole.lines().count(), "{word}");
        let flags = text.split_whitespace().map(|word| word.trim_matches(['[', ']', ',', '<', '>']));
        assert!(flags.filter(|flag| flag.starts_with("--")).all(|flag| whole.contains(flag)), "{word}: {text}");
        let options = text.lines().map(str::trim_start).filter(|line| line.starts_with('-'));
        let is_part = |c: char| c.is_ascii_lowercase() || c == '-';
        for flag in options.filter_map(|line| line.split(|c| !is_part(c)).find_map(|part| part.strip_prefix("--"))) {
            assert!(scripts.iter().all(|script| script.contains(flag)), "{word}: --{flag}");
        }
        let is_line = |line: &str| line.trim_start().starts_with(&format!("{word} "));
        assert!(words.len() > 1 || all_in_lines.lines().any(is_line), "{word} in {all_in_lines}");
        assert!(words.len() > 1 || all.contains(word), "{word} in {all}");
        let link = format!("crumple-{}", word.replace(' ', "-"));
        let man = with(&["--generate", "man"]);
        let page = stdout(&man).replace('\\', "");
        assert!(page.contains(".SH SYNOPSIS") && page.contains(&format!("{link} - ")), "{word}: {}", stderr(&man));
        assert!(stdout(&with(&["--generate", "bash"])).contains(&link), "{word}");
        let wrong = with(&["--hepl"]);
        let told = stderr(&wrong);
        // Three commands take the flags of records, and ask for these first.
        let is_near =
            ["run", "together", "compare"].contains(&word) || told.contains("similar argument exists: '--help'");
        assert!(wrong.status.code() == Some(2) && is_near, "{word}: {told}");
        assert!(told.contains("crumple") && !told.contains("crumple-"), "{word}: {told}");
    }
    assert!(scripts.iter().all(|script| WORDS.iter().all(|word| word.split(' ').all(|word| script.contains(word)))));
}

#[test]
fn a_wrong_word_is_answered_with_the_nearest() {
    let folder = tempfile::tempdir().unwrap();
    for (word, meant) in
        [("filtre", "filter"), ("predcit", "predict"), ("rum", "run"), ("nots", "notes"), ("acept", "accept")]
    {
        let answer = crumple(folder.path(), &[word]);
        let text = stderr(&answer);
        assert!(
            answer.status.code() == Some(2) && text.contains(&format!("did you mean {meant:?}?")),
            "{word}: {text}"
        );
    }
    let nested = stderr(&crumple(folder.path(), &["artifact", "chek"]));
    assert!(nested.contains("'check'"), "{nested}");
    assert_eq!(crumple(folder.path(), &[]).status.code(), Some(2));
}

#[cfg(unix)]
#[test]
fn called_by_a_link_it_is_the_program_of_that_name() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("crumple-filter");
    std::os::unix::fs::symlink(CRUMPLE, &link).unwrap();
    let help = Command::new(&link).arg("-h").output().unwrap();
    assert!(stdout(&help).contains("Usage: crumple-filter "), "{}", stdout(&help));
    let link = folder.path().join("crumple-notes");
    std::os::unix::fs::symlink(CRUMPLE, &link).unwrap();
    let help = Command::new(&link).arg("-h").output().unwrap();
    assert!(stdout(&help).contains("Usage: crumple notes "), "{}", stdout(&help));
}

/// A folder with nothing but the record of a fixture.
fn with_record(fixture: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let record = workspace().join("fixtures").join(fixture).join("crash.csv");
    std::fs::copy(record, folder.path().join("crash.csv")).unwrap();
    folder
}

/// Files of a run that hold results, but for its pipeline, which names places and programs.
fn results(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let files = std::fs::read_dir(folder).unwrap().map(Result::unwrap);
    let named = files.map(|file| (file.file_name().into_string().unwrap(), std::fs::read(file.path()).unwrap()));
    named.filter(|(name, _)| name != "0-pipeline.toml").collect()
}

#[test]
fn a_run_needs_the_record_alone_and_its_bytes_are_those_of_the_separate_programs() {
    for fixture in ["elastoplastic", "noisy"] {
        let folder = with_record(fixture);
        let run = crumple(folder.path(), &["run", "crash.csv"]);
        let (answer, rest) = (stdout(&run), stderr(&run));
        assert_eq!(run.status.code(), Some(0), "{answer}{rest}");
        let made = folder.path().join("runs/crash/default");
        let separate = tempfile::tempdir().unwrap();
        let mut just = Command::new("just");
        just.arg("--justfile").arg(workspace().join("justfile")).arg(format!("out={}", separate.path().display()));
        let by_just = just.arg("run").arg(folder.path().join("crash.csv")).output().unwrap();
        assert!(by_just.status.success(), "{}", stderr(&by_just));
        // What `just run` says on standard error, warnings of the stages and all; the answer stands alone.
        let said = stderr(&by_just).replace(separate.path().to_str().unwrap(), "./runs/crash/default");
        let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        let said = words(&said).replace("just notes", "crumple notes").replace("just curve", "crumple curve");
        assert!(answer.lines().count() > 3 && said.ends_with(&words(&answer)), "{said}\n{answer}");
        assert!(!words(&rest).contains(&words(answer.lines().next().unwrap())), "{rest}");
        let (own, other) = (results(&made), results(separate.path()));
        assert!(own.keys().eq(other.keys()) && own.len() == 9, "{:?}", own.keys());
        for (name, bytes) in &own {
            assert!(*bytes == other[name], "{fixture}: {name} differs");
        }

        let again = crumple(folder.path(), &["run", "crash.csv"]);
        assert_eq!(stdout(&again), answer, "{}", stderr(&again));
        assert!(stderr(&again).contains("up to date"), "{}", stderr(&again));
        assert!(results(&made) == own);
    }
}

#[test]
fn records_of_one_name_keep_apart_and_a_run_has_the_same_bytes_in_every_folder() {
    let run = || {
        let folder = tempfile::tempdir().unwrap();
        for (test, fixture) in [("a", "kelvin"), ("b", "elastoplastic")] {
            std::fs::create_dir(folder.path().join(test)).unwrap();
            let record = format!("{test}/crash.csv");
            let fixture = workspace().join("fixtures").join(fixture).join("crash.csv");
            std::fs::copy(fixture, folder.path().join(&record)).unwrap();
            let run = crumple(folder.path(), &["run", &record, "-q", "--set", "identify.methods=era"]);
            assert_eq!((run.status.code(), stderr(&run).as_str()), (Some(0), ""));
        }
        let read = |run: &str| std::fs::read(folder.path().join("runs").join(run)).unwrap();
        let files = ["crash", "b-crash"].map(|run| {
            ["0-pipeline.toml", "1-ingest.mcap", "summary.json"].map(|file| read(&format!("{run}/default/{file}")))
        });
        let pipeline = String::from_utf8(files[1][0].clone()).unwrap();
        assert!(pipeline.contains("record = \"b/crash.csv\"") && !pipeline.contains("\"/"), "{pipeline}");
        files
    };
    assert!(run() == run());
}

#[test]
fn what_is_set_typed_and_swapped_holds_as_for_just_run() {
    let folder = with_record("kelvin");
    let at = |words: &[&str]| crumple(folder.path(), words);
    let set = at(&["run", "--set", "filter.cfc=180", "crash.csv", "--mass", "900kg", "-o", "mine", "-q"]);
    assert_eq!((set.status.code(), stdout(&set).as_str(), stderr(&set).as_str()), (Some(0), "", ""));
    let pipeline = std::fs::read_to_string(folder.path().join("mine/0-pipeline.toml")).unwrap();
    assert!(pipeline.contains("filter.cfc=180") && pipeline.contains("--mass 900kg"), "{pipeline}");
    let civic = at(&["run", "crash.csv", "--pipeline", "unfiltered", "-q"]);
    assert!(civic.status.success() && folder.path().join("runs/crash/unfiltered/report.html").is_file());

    for (words, code, said) in [
        (&["run", "crash.csv", "--set", "filtre.cfc=180"][..], 2, "did you mean \"filter\"?"),
        (&["run", "crash.csv", "--set", "filter.cfc=181", "--out", "x"], 2, "--set filter.cfc=181"),
        (&["run", "crash.csv", "--pipeline", "unfiltred"], 2, "did you mean \"unfiltered\"?"),
        (&["run", "crash.csv", "--masss", "9kg"], 2, "--mass"),
        (&["run", "none.csv"], 3, "none.csv"),
        (&["run", "--mass", "9kg"], 2, "crumple run RECORD"),
    ] {
        let refused = at(words);
        let text = stderr(&refused);
        assert!(refused.status.code() == Some(code) && text.contains(said), "{words:?}: {text}");
        assert!(!text.contains("just ") && !text.contains("crumple-"), "{words:?}: {text}");
    }
    let record = std::fs::read_to_string(folder.path().join("crash.csv")).unwrap();
    let bare: Vec<&str> = record.lines().filter(|line| !line.starts_with("# mass")).collect();
    std::fs::write(folder.path().join("bare.csv"), bare.join("\n")).unwrap();
    let bare = at(&["run", "bare.csv"]);
    assert!(bare.status.success() && stdout(&bare).contains("add --mass 1500kg"), "{}{}", stdout(&bare), stderr(&bare));

    let mut swapped = Command::new(CRUMPLE);
    swapped.args(["run", "crash.csv", "-o", "swapped"]).current_dir(folder.path());
    let swapped = swapped.env("CRUMPLE_IDENTIFY", "sh -c 'exit 3'").output().unwrap();
    assert_eq!(swapped.status.code(), Some(3), "{}", stderr(&swapped));
    assert!(stderr(&swapped).contains("note: the stage identify ended with exit code 3"), "{}", stderr(&swapped));
}

/// The comment on a change of `filter.cfc` from 60 to 180 is that of docs/ci.md; `CRUMPLE_WRITE_COMMENT=1` writes it.
fn assert_comment_in_docs(name: &str, record: &Path) {
    let folder = tempfile::tempdir().unwrap();
    let done = |words: &[&str], code: i32| {
        let output = crumple(folder.path(), words);
        assert_eq!(output.status.code(), Some(code), "{words:?}: {}", stderr(&output));
    };
    let record = record.to_str().unwrap();
    done(&["run", record, "-q"], 0);
    done(&["accept", "runs"], 0);
    done(&["run", record, "-q", "--set", "filter.cfc=180"], 0);
    done(&["diff", "expected", "runs", "-q", "--markdown", "review.md"], 1);
    let made = std::fs::read_to_string(folder.path().join("review.md")).unwrap();
    let page = workspace().join("docs/ci.md");
    let text = std::fs::read_to_string(&page).unwrap();
    let fence = format!("```markdown {name}\n");
    let (before, rest) = text.split_once(&fence).unwrap();
    let (shown, after) = rest.split_once("```").unwrap();
    if std::env::var_os("CRUMPLE_WRITE_COMMENT").is_some() {
        std::fs::write(page, format!("{before}{fence}{made}```{after}")).unwrap();
        return;
    }
    assert_eq!(shown, made);
}

#[test]
fn the_comment_on_a_fixture_in_the_docs_is_as_made() {
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().join("noisy.csv");
    std::fs::copy(workspace().join("fixtures/noisy/crash.csv"), &record).unwrap();
    assert_comment_in_docs("noisy", &record);
}

#[test]
fn the_comment_on_a_public_test_in_the_docs_is_as_made() {
    let shared = std::env::var_os("CRUMPLE_SHARED").map(PathBuf::from).unwrap_or_default();
    let record = shared.join("data/nhtsa-v10146-camry-frontal/v10146.EV5");
    if record.is_file() {
        assert_comment_in_docs("v10146", &record);
    } else {
        eprintln!("SKIPPED the comment on NHTSA 10146: CRUMPLE_SHARED has no such record");
    }
}

#[test]
fn every_command_works_on_runs_from_a_folder_without_a_project() {
    let folder = with_record("elastoplastic");
    std::fs::create_dir(folder.path().join("tests")).unwrap();
    let record = std::fs::read_to_string(folder.path().join("crash.csv")).unwrap();
    std::fs::write(folder.path().join("tests/a.csv"), &record).unwrap();
    let shorter = record.trim_end().rsplit_once('\n').unwrap().0;
    std::fs::write(folder.path().join("tests/b.csv"), shorter).unwrap();
    let done = |words: &[&str]| {
        let output = crumple(folder.path(), words);
        assert_eq!(output.status.code(), Some(0), "{words:?}: {}{}", stdout(&output), stderr(&output));
        assert!(!(stdout(&output) + &stderr(&output)).contains("just "), "{words:?}: {}", stderr(&output));
        stdout(&output) + &stderr(&output)
    };
    done(&["run", "crash.csv"]);
    let run = "runs/crash/default";
    let solved = &format!("{run}/5-parameter-solve.mcap");
    let predicted = done(&["predict", run, "--speed", "40km/h,64km/h"]);
    assert!([" 40.0 ", " 64.0 "].iter().all(|speed| predicted.contains(speed)), "{predicted}");
    let artifacts = [&format!("{run}/3-integrate.mcap"), solved];
    done(&["predict", artifacts[0], artifacts[1], "-o", "7.mcap", "--speed", "30km/h"]);
    done(&["report", run, "-q"]);
    done(&["notes", run]);
    done(&["curve", run, "--to", "900mm"]);
    done(&["export", run, "--to", "csv", "-o", "tables"]);
    done(&["view", run]);
    assert!(done(&["show", solved, "--topic", "/parameters/*"]).contains("/parameters/"));
    assert!(done(&["artifact", "check", solved]).contains("ok"));
    done(&["artifact", "unpack", solved, "plain", "-q"]);
    done(&["artifact", "pack", "plain", "packed.mcap", "-q"]);
    done(&["diff", solved, "packed.mcap", "-q"]);
    done(&["together", "tests/a.csv", "tests/b.csv", "--name", "both"]);
    done(&["fleet", "tests", "-q"]);
    done(&["export", "runs/together/both", "--to", "xlsx", "-o", "both.xlsx"]);
    done(&["export", "runs/fleet/tests", "--to", "parquet", "-o", "of-fleet"]);
    done(&["index", run, "runs/a/default", "-q"]);
    done(&["compare", run, "runs/b/default", "-q"]);
    for file in ["runs/together/both/report.html", "runs/fleet/tests/fleet.html", "index.html", "compare.html"] {
        assert!(folder.path().join(file).is_file(), "{file}");
    }
    let study = crumple(folder.path(), &["study", "tests", "-q"]);
    assert!([0, 4].map(Some).contains(&study.status.code()), "{}", stderr(&study));
}

/// Flags that start a line of the help of a stage.
fn flags_of(stage: &str, folder: &Path) -> BTreeSet<String> {
    let help = stdout(&crumple(folder, &["help", stage]));
    let first = help.lines().map(str::trim_start);
    let flags = first.filter_map(|line| line.strip_prefix("--"));
    flags.map(|line| line.split(['=', '[', ' ']).next().unwrap_or_default().to_owned()).collect()
}

#[test]
fn every_flag_of_a_stage_is_a_setting_of_a_run_by_the_same_name() {
    let folder = tempfile::tempdir().unwrap();
    let stages = ["filter", "integrate", "identify", "parameter-solve", "simulate"];
    let all = stages.map(|stage| flags_of(stage, folder.path()));
    let shared = all.iter().skip(1).fold(all[0].clone(), |known, flags| &known & flags);
    for (stage, flags) in stages.iter().zip(&all) {
        let own: Vec<&String> = flags.difference(&shared).collect();
        assert!(own.len() > 3, "{stage}: {own:?}");
        let keys: String = own.iter().map(|flag| format!("{} = \"?\"\n", flag.replace('-', "_"))).collect();
        std::fs::write(folder.path().join("p.toml"), format!("base = \"none\"\n[{stage}]\n{keys}")).unwrap();
        let said = stderr(&crumple(folder.path(), &[stage, "1.mcap", "--pipeline", "p.toml", "-o", "2.mcap"]));
        assert!(!said.contains("unknown key"), "{stage}: {said}");
    }
}

#[test]
fn a_refusal_behind_a_run_advises_what_a_run_takes() {
    let folder = with_record("kelvin");
    let refused = crumple(folder.path(), &["run", "crash.csv", "--set", "identify.from=90s"]);
    let said = stderr(&refused);
    assert_eq!(refused.status.code(), Some(3), "{said}");
    let advises = |flag: &str| said.split_whitespace().any(|word| word.trim_end_matches([',', ')']) == flag);
    assert!(advises("identify.from=...") && !advises("--from"), "{said}");
}
