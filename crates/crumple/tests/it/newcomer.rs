//! What a newcomer meets: a sample record and its run, examples, a report that opens, completion.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::{CRUMPLE, crumple, stderr, stdout};

const RUN: &str = "runs/crumple-demo/default";

#[test]
fn the_demo_is_a_sound_record_and_a_usable_run_and_leaves_files_of_others_alone() {
    let folder = tempfile::tempdir().unwrap();
    let demo = || crumple(folder.path(), &["demo"]);
    let first = demo();
    assert_eq!(first.status.code(), Some(0), "{}{}", stdout(&first), stderr(&first));
    let run = folder.path().join(RUN);
    let summary: serde_json::Value = serde_json::from_slice(&fs::read(run.join("summary.json")).unwrap()).unwrap();
    let verdict = &summary["verdict"];
    assert_eq!((verdict["record"].as_str(), verdict["status"].as_str()), (Some("sound"), Some("usable")), "{verdict}");
    let restitution = summary["events"]["coefficient_of_restitution"].as_f64().unwrap();
    assert!((0.1..0.2).contains(&restitution), "{restitution}");
    assert!(run.join("report.html").is_file());
    let record = fs::read_to_string(folder.path().join("crumple-demo.csv")).unwrap();
    assert!(record.lines().next().unwrap().contains("not measured"));

    let again = demo();
    assert_eq!((again.status.code(), stdout(&again)), (Some(0), stdout(&first)), "{}", stderr(&again));
    assert!(stderr(&again).contains("up to date"), "{}", stderr(&again));
    fs::write(folder.path().join("crumple-demo.csv"), "mine").unwrap();
    let refused = demo();
    assert_eq!(refused.status.code(), Some(2), "{}", stderr(&refused));
    assert!(stderr(&refused).contains("crumple-demo.csv in") && stderr(&refused).contains("hint: move it"));
    assert_eq!(fs::read_to_string(folder.path().join("crumple-demo.csv")).unwrap(), "mine");
}

/// What stands behind the help of a command: its examples, without `crumple`.
fn examples(folder: &Path, command: &str) -> Vec<String> {
    let words: Vec<&str> = ["help"].into_iter().chain(command.split(' ')).collect();
    let help = stdout(&crumple(folder, &words));
    let (_, examples) = help.split_once("\nExamples").unwrap_or_else(|| panic!("{command}: {help}"));
    examples.lines().filter_map(|line| line.strip_prefix("  crumple ")).map(str::to_owned).collect()
}

#[test]
fn help_ends_with_three_examples_and_the_short_help_has_none() {
    let folder = tempfile::tempdir().unwrap();
    for command in crate::WORDS {
        assert_eq!(examples(folder.path(), command).len(), 3, "{command}");
        let words: Vec<&str> = command.split(' ').collect();
        let long = stdout(&crumple(folder.path(), &[&words, &["--help"][..]].concat()));
        assert!(long.trim_end().lines().last().unwrap().starts_with("  crumple "), "{command}");
        let short = stdout(&crumple(folder.path(), &[&words, &["-h"][..]].concat()));
        assert!(!short.contains("\nExamples"), "{command}");
        let page = stdout(&crumple(folder.path(), &[&words, &["--generate", "man"][..]].concat()));
        assert_eq!(page.matches("\ncrumple ").count(), 3, "{command}");
    }
}

/// Commands whose examples are typed one after another: each finds what the earlier ones made. Those of `study` need a
/// file of classes.
const IN_ORDER: [&str; 29] = [
    "demo",
    "run",
    "predict",
    "notes",
    "explain",
    "curve",
    "damage",
    "plan",
    "compare",
    "index",
    "accept",
    "diff",
    "passport",
    "check",
    "fleet",
    "together",
    "export",
    "view",
    "ingest",
    "filter",
    "integrate",
    "identify",
    "parameter-solve",
    "simulate",
    "report",
    "artifact",
    "artifact unpack",
    "artifact pack",
    "new-stage",
];

#[cfg(unix)]
#[test]
fn examples_work_as_they_are_typed() {
    let folder = tempfile::tempdir().unwrap();
    let tests = folder.path().join("tests");
    fs::create_dir(&tests).unwrap();
    for command in IN_ORDER {
        for example in examples(folder.path(), command) {
            let words = shell_words::split(&example).unwrap();
            let mut typed = Command::new(CRUMPLE);
            let done = typed.args(&words).current_dir(folder.path()).env("BROWSER", "true").output().unwrap();
            // `diff` finds a difference.
            let codes = if command == "diff" { [Some(0), Some(1)] } else { [Some(0), Some(0)] };
            assert!(codes.contains(&done.status.code()), "crumple {example}: {}{}", stdout(&done), stderr(&done));
        }
        if command == "demo" {
            let record = fs::read_to_string(folder.path().join("crumple-demo.csv")).unwrap();
            fs::write(tests.join("a.csv"), &record).unwrap();
            fs::write(tests.join("b.csv"), record.trim_end().rsplit_once('\n').unwrap().0).unwrap();
        }
    }
}

#[cfg(unix)]
#[test]
fn a_run_opens_its_report_in_the_browser_that_is_named_and_says_where_none_is() {
    use std::os::unix::fs::PermissionsExt;

    let folder = crate::with_record("elastoplastic");
    let browser = folder.path().join("browser");
    fs::write(&browser, "#!/bin/sh\necho \"$1\" > opened\n").unwrap();
    fs::set_permissions(&browser, fs::Permissions::from_mode(0o755)).unwrap();
    let run = |browser: &str| {
        let mut command = Command::new(CRUMPLE);
        command.args(["run", "crash.csv", "--open", "-q"]).current_dir(folder.path());
        command.env("PATH", "").env("BROWSER", browser).output().unwrap()
    };
    let page = "runs/crash/default/report.html";
    let opened = run(&format!("no-such-browser:{}", browser.display()));
    assert_eq!((opened.status.code(), stderr(&opened).as_str()), (Some(0), ""));
    let shown = fs::read_to_string(folder.path().join("opened")).unwrap();
    assert!(shown.trim_end().ends_with(page), "{shown}");
    let none = run("");
    let said = stderr(&none);
    assert_eq!(none.status.code(), Some(0), "{said}");
    assert!(said.contains("the report was not opened") && said.contains(page), "{said}");
}

#[test]
fn help_of_a_run_has_the_flags_that_it_hands_to_ingest_as_ingest_has_them() {
    let folder = tempfile::tempdir().unwrap();
    let [run, ingest] = ["run", "ingest"].map(|command| stdout(&crumple(folder.path(), &["help", command])));
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    for flag in [
        "--mass <MASS> Test mass of the vehicle, with its unit: 873kg, 1.2t, 2000lb",
        "--impact-speed <SPEED> Speed just before contact, with its unit: 35km/h, 13.4m/s, 30mph",
        "--channel <CHANNEL> Channel to take as the crash pulse",
        "--unit <UNIT> Unit of acceleration columns",
        "--time-unit <UNIT> Unit of the time column",
        "--time-zero <TIME> First contact on the file's own time axis",
        "--sign <SIGN> Polarity of acceleration along x",
        "--overlap <OVERLAP> How the vehicle met what it hit",
    ] {
        assert!([&run, &ingest].iter().all(|help| words(help).contains(flag)), "{flag}: {run}");
    }
}

/// What bash completes of the last word.
fn completed(script: &Path, words: &[&str]) -> String {
    let last = words.len() - 1;
    let line = format!(
        "source {}; COMP_WORDS=({}); COMP_CWORD={last}; _crumple_without_blank crumple '{}' '{}' 2>/dev/null; \
         echo \"${{COMPREPLY[@]}}\"",
        script.display(),
        words.iter().map(|word| format!("'{word}'")).collect::<Vec<_>>().join(" "),
        words[last],
        words[last - 1],
    );
    stdout(&Command::new("bash").args(["-c", &line]).output().unwrap()).trim().to_owned()
}

#[cfg(unix)]
#[test]
fn completion_knows_flags_of_ingest_keys_of_stages_names_of_pipelines_and_commands() {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("crumple.bash");
    fs::write(&script, stdout(&crumple(folder.path(), &["completions", "bash"]))).unwrap();
    for (words, expected) in [
        (&["crumple", "run", "--impact-s"][..], "--impact-speed"),
        (&["crumple", "run", "--set", "filter.cf"], "filter.cfc="),
        (&["crumple", "fleet", "--set", "identify.meth"], "identify.methods="),
        (&["crumple", "run", "--pipeline", "unf"], "unfiltered"),
        (&["crumple", "help", "parameter"], "parameter-solve"),
        (&["crumple", "completions", "zs"], "zsh"),
    ] {
        assert_eq!(completed(&script, words), expected, "{words:?}");
    }
    for shell in ["zsh", "fish"] {
        let script = stdout(&crumple(folder.path(), &["completions", shell]));
        assert!(["impact-speed", "filter.cfc=", "unfiltered"].iter().all(|word| script.contains(word)), "{shell}");
    }
}

/// Ends a watcher whatever happens.
#[cfg(unix)]
struct Watcher(std::process::Child);

#[cfg(unix)]
impl Drop for Watcher {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[cfg(unix)]
#[test]
fn what_arrives_in_a_folder_is_run_a_bad_file_does_not_stop_it_and_an_interruption_does() {
    use std::os::unix::process::ExitStatusExt;
    use std::time::{Duration, Instant};

    let folder = crate::with_record("elastoplastic");
    let inbox = folder.path().join("inbox");
    fs::create_dir(&inbox).unwrap();
    fs::write(inbox.join("bad.csv"), "time_s,accel_g\n0,0\n1,abc\n2,0\n3,0\n").unwrap();
    let log = fs::File::create(folder.path().join("log")).unwrap();
    let mut command = Command::new(CRUMPLE);
    command.args(["watch", "inbox", "--every", "200ms"]).current_dir(folder.path()).stderr(log);
    let mut watcher = Watcher(command.stdout(std::process::Stdio::null()).spawn().unwrap());
    let said = || fs::read_to_string(folder.path().join("log")).unwrap();
    // Of a machine at work: a run takes a second or two.
    let until = |what: &str, is_there: &dyn Fn() -> bool| {
        let started = Instant::now();
        while !is_there() {
            assert!(started.elapsed() < Duration::from_secs(120), "no {what}: {}", said());
            std::thread::sleep(Duration::from_millis(50));
        }
    };
    until("refusal", &|| said().contains("bad.csv ended with exit code 3; watching goes on"));
    fs::copy(folder.path().join("crash.csv"), inbox.join("good.csv")).unwrap();
    let run = folder.path().join("runs/good/default");
    until("report", &|| run.join("report.html").is_file() && run.join("0-pipeline.toml").is_file());
    until("summary", &|| run.join("summary.json").is_file());
    // The next look: the run is over.
    std::thread::sleep(Duration::from_secs(1));
    let pid = watcher.0.id().to_string();
    assert!(Command::new("kill").args(["-INT", &pid]).status().unwrap().success());
    let ended = watcher.0.wait().unwrap();
    assert_eq!(ended.signal(), Some(2), "{ended:?}");
    let checked = crumple(folder.path(), &["run", "inbox/good.csv"]);
    assert!(stderr(&checked).contains("up to date"), "{}", stderr(&checked));
}
