//! The fleet with a stand-in for the run of a record, so that what is tested is the fleet alone.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command};
use std::thread::sleep;
use std::time::Duration;

use crate::chain::{Chain, Stages, said};
use crate::stand_in::Fleet;

/// Names of the files that a fleet must write the same every time.
const RESULTS: [&str; 9] = [
    "tests.parquet",
    "tests.csv",
    "candidates.parquet",
    "candidates.csv",
    "metrics.parquet",
    "metrics.csv",
    "predictions.parquet",
    "predictions.csv",
    "fleet.html",
];

fn assert_same_results(a: &Fleet, b: &Fleet) {
    for name in RESULTS {
        let read = |fleet: &Fleet| fs::read(fleet.out().join(name)).unwrap();
        assert!(read(a) == read(b), "{name} differs");
    }
}

#[test]
fn a_record_that_fails_is_a_row_and_what_is_up_to_date_is_not_run_again() {
    let fleet = Fleet::new();
    fleet.record("a.csv", "1.5");
    fleet.record("b/a.csv", "2.5");
    fleet.record("refused.csv", "refuse");
    fleet.record("killed.csv", "kill");
    let output = fleet.run(&[]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(fleet.count_of_runs(), 4);
    let row = |record: &str| fleet.row("tests", record);
    assert_eq!([&row("a.csv")["status"], &row("a.csv")["mass_kg"]], ["done", "1.5"]);
    assert_eq!(row("b/a.csv")["mass_kg"], "2.5");
    assert_ne!(row("a.csv")["run_folder"], row("b/a.csv")["run_folder"]);
    let refused = row("refused.csv");
    assert_eq!([&refused["status"], &refused["exit_code"]], ["refused", "3"]);
    assert_eq!(refused["error"], "error: refused.csv is refused");
    assert_eq!(row("killed.csv")["exit_code"], "137");
    // What was ended by a signal may succeed the next time; all else stands.
    fleet.run(&[]);
    assert_eq!(fleet.count_of_runs(), 5);
    fleet.record("a.csv", "3.5");
    fleet.run(&[]);
    assert_eq!(fleet.count_of_runs(), 7);
    assert_eq!(fleet.row("tests", "a.csv")["mass_kg"], "3.5");
    // A result that was removed is made again.
    fs::remove_file(fleet.out().join(&row("b/a.csv")["run_folder"]).join("summary.json")).unwrap();
    fleet.run(&[]);
    assert_eq!((fleet.count_of_runs(), &*fleet.row("tests", "b/a.csv")["mass_kg"]), (9, "2.5"));
    // Asked to, it runs all again, each time; what it made stands for the next.
    for (flags, runs) in [(&["--force"][..], 13), (&["--force", "--force"], 17), (&[], 18)] {
        assert!(fleet.run(flags).status.success());
        assert_eq!(fleet.count_of_runs(), runs, "{flags:?}");
    }
    let page = fs::read_to_string(fleet.out().join("fleet.html")).unwrap();
    assert!(
        page.contains("<summary>1 × refused</summary>")
            && page.contains("refused.csv: refused.csv is refused")
            && page.contains("/report.html\">a.csv</a>"),
        "{page}"
    );
}

#[test]
fn a_fleet_that_is_killed_goes_on_and_ends_with_the_same_bytes() {
    let [whole, killed] = [(); 2].map(|()| {
        let fleet = Fleet::new();
        (0..12).for_each(|k| fleet.record(&format!("{k}.csv"), &format!("1.{k}")));
        fleet.record("broken.csv", "refuse");
        fleet
    });
    assert!(whole.run(&["-j", "3"]).status.success());
    let mut child = killed.command(&["-j", "2"]).env("STAND_IN_PAUSE", "0.1").spawn().unwrap();
    while killed.count_of_runs() < 5 {
        sleep(Duration::from_millis(10));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!killed.out().join("tests.csv").exists());
    // The run that was under way ends by itself.
    sleep(Duration::from_millis(500));
    let before = killed.count_of_runs();
    assert!(before < 13, "the fleet was done before it was killed");
    assert!(killed.run(&[]).status.success());
    // At most the two under way were run again.
    assert!((13..=15).contains(&killed.count_of_runs()), "{} {before}", killed.count_of_runs());
    assert_same_results(&whole, &killed);
}

#[test]
fn two_fleets_at_once_end_with_the_tables_of_one() {
    let [one, two] = [(); 2].map(|()| {
        let fleet = Fleet::new();
        (0..8).for_each(|k| fleet.record(&format!("{k}.csv"), &format!("1.{k}")));
        fleet
    });
    assert!(one.run(&["-q", "--quiet"]).status.success());
    let mut first = two.command(&["-j", "2"]).env("STAND_IN_PAUSE", "0.1").spawn().unwrap();
    let second = two.run(&["-j", "2"]);
    assert!(first.wait().unwrap().success() && second.status.success());
    assert_eq!(two.count_of_runs(), 8);
    assert_same_results(&one, &two);
}

#[test]
fn a_fleet_in_which_nothing_was_done_says_so_and_no_cell_is_a_formula() {
    let fleet = Fleet::new();
    ["=1+1.csv", "+a.csv", "-1+1.csv", "@b.csv"].iter().for_each(|name| fleet.record(name, "refuse"));
    let output = fleet.run(&[]);
    assert_eq!(output.status.code(), Some(3), "{}", String::from_utf8_lossy(&output.stderr));
    let table = fs::read(fleet.out().join("tests.csv")).unwrap();
    let mut reader = csv::Reader::from_reader(table.as_slice());
    let cells: Vec<String> =
        reader.records().flat_map(|row| row.unwrap().iter().map(str::to_owned).collect::<Vec<_>>()).collect();
    assert!(cells.iter().any(|cell| cell == "'=1+1.csv"), "{cells:?}");
    assert!(
        cells.iter().all(|cell| !cell.starts_with(['=', '+', '-', '@']) || cell.parse::<f64>().is_ok()),
        "{cells:?}"
    );
}

#[test]
fn parts_of_a_fleet_and_their_tables_are_those_of_the_whole() {
    let [whole, parts] = [(); 2].map(|()| {
        let fleet = Fleet::new();
        (0..10).for_each(|k| fleet.record(&format!("{k}.csv"), &format!("1.{k}")));
        fleet
    });
    assert!(whole.run(&[]).status.success());
    for part in ["1/3", "2/3", "3/3"] {
        assert!(parts.run(&["--batch", part]).status.success());
    }
    assert!(!parts.out().join("tests.csv").exists());
    assert!(parts.run(&["--tables-only"]).status.success());
    assert_eq!(parts.count_of_runs(), 10);
    assert_same_results(&whole, &parts);
}

#[test]
fn pipelines_and_values_of_an_option_have_runs_of_their_own() {
    let fleet = Fleet::new();
    fleet.record("a.csv", "1.5");
    let set = "parameter-solve.front_mass_fraction=0.15,0.25";
    assert!(fleet.run(&["--pipelines", "one,two", "--set", set]).status.success());
    let rows = fleet.rows("tests");
    let of = |column: &str| rows.iter().map(|row| row[column].clone()).collect::<Vec<_>>();
    assert_eq!(of("pipeline"), ["one", "one", "two", "two"]);
    let [low, high] = ["0.15", "0.25"].map(|value| format!("parameter-solve.front_mass_fraction={value}"));
    assert_eq!(of("settings"), [low.clone(), high.clone(), low.clone(), high]);
    assert_eq!(rows[0]["run_folder"], format!("runs/a/one,{low}"));
    let said = fs::read_to_string(fleet.out().join(&rows[0]["run_folder"]).join("arguments")).unwrap();
    assert!(said.contains(&format!("--set {low} -- ")), "{said}");
}

#[test]
fn a_folder_without_records_and_a_pipeline_that_is_not_there_are_named() {
    let fleet = Fleet::new();
    let said = |args: &[&str]| {
        let output = fleet.run(args);
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, error) = said(&[]);
    assert!(code == Some(3) && error.contains("no record in"), "{error}");
    fleet.record("a.csv", "1.5");
    let (code, error) = said(&["--pipelines", "none"]);
    assert!(code == Some(2) && error.contains("none.toml"), "{error}");
    let (code, error) = said(&["--set", "cfc=60"]);
    assert!(code == Some(2) && error.contains("names no stage"), "{error}");
    let help = Command::new(env!("CARGO_BIN_EXE_crumple-fleet")).arg("--help").output().unwrap();
    assert!(String::from_utf8_lossy(&help.stdout).contains("Exit codes"));
}

/// A run whose identify says by a file that it works, and waits until it is let go.
fn held_in_identify() -> Chain {
    let chain = Chain::new(Stages::Foreign);
    // The folder of the records has a name that a shell takes apart.
    let quoted = |name: &str| format!("'{}'", beside(&chain, name).display().to_string().replace('\'', "'\\''"));
    let (at_work, let_go) = (quoted("at-work"), quoted("let-go"));
    let wait = format!("touch {at_work}\nwhile [ ! -e {let_go} ]; do sleep 0.05; done\nexec \"$@\"\n");
    fs::write(beside(&chain, "wait.sh"), wait).unwrap();
    let command = format!("sh {} {}", quoted("wait.sh"), chain.command("4-identify.mcap"));
    chain.with("4-identify.mcap", &command)
}

/// A file beside the records.
fn beside(chain: &Chain, name: &str) -> PathBuf {
    chain.record("a").with_file_name(name)
}

/// Until identify itself works: the files of the stage before it are there while nothing holds the lock but the run.
fn wait_for_identify(chain: &Chain, run: &mut Child) {
    while !beside(chain, "at-work").exists() {
        if let Some(status) = run.try_wait().unwrap() {
            panic!("the run has ended ({status}): {}", first_line(run));
        }
        sleep(Duration::from_millis(5));
    }
}

/// The first line that a run says.
fn first_line(run: &mut Child) -> String {
    let mut line = String::new();
    BufReader::new(run.stderr.take().unwrap()).read_line(&mut line).unwrap();
    line
}

#[test]
fn ten_pairs_of_simultaneous_runs_end_well_and_unmixed() {
    for pair in 0..10 {
        let chain = Chain::new(if pair % 2 == 0 { Stages::Own } else { Stages::Foreign });
        let [a, b] = ["a", "b"].map(|record| chain.run(record).spawn().unwrap());
        for run in [a, b] {
            let output = run.wait_with_output().unwrap();
            assert!(output.status.success(), "pair {pair}: {}", said(&output));
        }
        let last = if chain.contents()["report.html"].ends_with('a') { "a" } else { "b" };
        chain.assert_whole(last);
    }
}

#[test]
fn the_second_run_says_for_whom_it_waits_and_goes_on_after_it() {
    let chain = held_in_identify();
    let mut first = chain.run("a").spawn().unwrap();
    wait_for_identify(&chain, &mut first);
    let mut second = chain.run("b").spawn().unwrap();
    let line = first_line(&mut second);
    let expected = format!("waiting for process {}, which runs {}", first.id(), chain.record("a").display());
    assert!(line.starts_with(&expected), "{line}");
    fs::write(beside(&chain, "let-go"), "").unwrap();
    assert!(second.wait().unwrap().success());
    assert!(first.wait().unwrap().success(), "the first was not disturbed");
    chain.assert_whole("b");
}

#[test]
fn a_lock_dies_with_its_last_holder() {
    let chain = held_in_identify();
    let mut first = chain.run("a").spawn().unwrap();
    wait_for_identify(&chain, &mut first);
    first.kill().unwrap();
    first.wait().unwrap();
    // The stage of the killed run still works: nobody else may write.
    let fast = Chain::new(Stages::Foreign);
    let mut second = fast.run_into(&chain.folder(), &chain.record("b")).spawn().unwrap();
    let line = first_line(&mut second);
    assert!(
        line.starts_with("waiting for process ") && line.contains("left over from a run that was killed"),
        "{line}"
    );
    let group = format!("kill -KILL -{}", first.id());
    assert!(Command::new("sh").args(["-c", &group]).status().unwrap().success());
    assert!(second.wait().unwrap().success());
    chain.assert_whole("b");
}
