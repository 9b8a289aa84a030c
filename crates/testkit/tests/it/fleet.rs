//! A fleet of made cars through the whole pipeline, and what its tables say to other programs.

use std::collections::{BTreeMap, BTreeSet};
use std::os::unix::process::CommandExt;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use crumple_testkit::made_fleet::{FleetCar, write_fleet};
use crumple_testkit::programs::{binary, different_files, ended_runs, just_fleet, wait_for};
use crumple_testkit::workspace;

/// The cars of this test.
const SEED: u64 = 17;

/// A Python that has these packages from PyPI, in an environment of its own; `None` where they cannot be installed.
fn python_with(packages: &[&str]) -> Option<PathBuf> {
    let folder = binary("crumple-fleet").parent().unwrap().join("fleet-venv");
    let python = folder.join("bin/python");
    let imports = packages.iter().map(|package| format!("import {package}\n")).collect::<String>();
    let has_all = || Command::new(&python).args(["-c", &imports]).output().is_ok_and(|output| output.status.success());
    if !has_all() {
        let made = Command::new("python3").args(["-m", "venv"]).arg(&folder).output();
        let installed = Command::new(&python).args(["-m", "pip", "install", "--quiet"]).args(packages).output();
        if !has_all() {
            eprintln!("SKIPPED: {packages:?} cannot be installed: {made:?} {installed:?}");
            return None;
        }
    }
    Some(python)
}

#[test]
fn a_study_of_made_cars_finds_their_stiffness_and_the_examples_of_the_page_work() {
    let folder = tempfile::tempdir().unwrap();
    let cars = 8;
    write_fleet(&folder.path().join("records"), 2 * cars, 1, SEED).unwrap();
    let (records, fleet) = (folder.path().join("records"), folder.path().join("fleet"));
    let output = just_fleet("study", &records, &fleet).args(["-j", "2"]).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    let read = |name: &str| std::fs::read_to_string(fleet.join(name)).unwrap();

    let vehicles = read("study/vehicles.csv");
    for number in 0..cars {
        let car = FleetCar::new(SEED, number);
        let row = vehicles.lines().find(|line| line.starts_with(&car.vehicle)).unwrap();
        let cells: Vec<&str> = row.split(',').collect();
        assert_eq!(cells[5], "joint fit", "{row}");
        let [stiffness, damping] = [6, 7].map(|cell: usize| cells[cell].parse::<f64>().unwrap());
        // Noise of 0.2 % of the peak, and the filter at the edge of the pulse, which the fit follows.
        assert!((stiffness / car.stiffness_n_per_m - 1.0).abs() < 0.01, "{row} {car:?}");
        assert!((damping / car.damping_n_s_per_m - 1.0).abs() < 0.03, "{row} {car:?}");
    }
    let study: serde_json::Value = serde_json::from_str(&read("study/study.json")).unwrap();
    assert_eq!(study["leave_one_test_out"]["tests"], 2 * cars);
    let error = study["leave_one_test_out"]["median_percent"].as_f64().unwrap();
    assert!(error < 2.0, "{error} %");
    assert!(read("tests.csv").contains("broken-1.csv,"));

    let again = just_fleet("fleet", &records, &fleet).output().unwrap();
    let said = String::from_utf8_lossy(&again.stderr);
    assert!(said.contains(&format!("{} up to date", 2 * cars + 1)), "{said}");

    let Some(python) = python_with(&["duckdb", "polars"]) else { return };
    let script = workspace().join("crates/testkit/tests/it/fleet_queries.py");
    let output = Command::new(python).arg(script).arg(workspace().join("docs/fleet.md")).arg(&fleet).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// `CRUMPLE_FLEET_RECORDS` states of how many records.
#[test]
fn a_fleet_killed_in_mid_run_goes_on_and_ends_as_if_nothing_had_been() {
    let records = std::env::var("CRUMPLE_FLEET_RECORDS").ok().and_then(|number| number.parse().ok()).unwrap_or(16);
    let folder = tempfile::tempdir().unwrap();
    let [made, undisturbed, killed] =
        ["records", "undisturbed/fleet", "killed/fleet"].map(|name| folder.path().join(name));
    write_fleet(&made, records, 1, SEED).unwrap();
    let journal = killed.join("journal/all.jsonl");
    for part in 1..=3 {
        let mut command = just_fleet("fleet", &made, &killed);
        let mut fleet = command.args(["-j", "2"]).process_group(0).stderr(Stdio::null()).spawn().unwrap();
        wait_for(&mut fleet, "runs that ended", || (ended_runs(&journal).len() >= part * records / 4).then_some(()));
        // just, crumple-fleet, and every run with its stages.
        Command::new("kill").args(["-KILL", "--", &format!("-{}", fleet.id())]).status().unwrap();
        fleet.wait().unwrap();
        assert!(!killed.join("tests.csv").exists(), "killed too late");
    }
    for fleet in [&killed, &undisturbed] {
        let output = just_fleet("fleet", &made, fleet).args(["-j", "2"]).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let [runs_of_killed, runs] = [&killed, &undisturbed].map(|fleet| ended_runs(&fleet.join("journal/all.jsonl")));
    assert_eq!(runs_of_killed.len(), runs.len(), "what was finished is not run again");
    assert_eq!(different_files(&killed, &undisturbed), Vec::<PathBuf>::new());
    let page = std::fs::read_to_string(killed.join("runs/00000-40/default/report.html")).unwrap();
    assert!(page.contains("<link rel=\"stylesheet\" href=\"../../../page/report-"), "pages share their style");
    assert_eq!(std::fs::read_dir(killed.join("page")).unwrap().count(), 3);
}

/// Records, those that hold none, and parts of the fleet.
const RECORDS: usize = 200;
const BROKEN: usize = 1;
const PARTS: usize = 9;
/// The cars of this test.
const SEED_OF_CLUSTER: u64 = 5;

/// What Slurm says of the jobs that run now: node and rule with its part, `rule_batch_wildcards_3`.
fn running_jobs() -> Vec<(String, String)> {
    let queue = Command::new("squeue").args(["--noheader", "--states=RUNNING", "--format=%N %k"]).output().unwrap();
    let queue = String::from_utf8_lossy(&queue.stdout).into_owned();
    queue.lines().filter_map(|line| line.split_once(' ')).map(|(node, job)| (node.into(), job.into())).collect()
}

#[test]
#[ignore = "needs a cluster: just ci-full starts one"]
fn a_fleet_outlives_a_node_that_dies() {
    let cluster = PathBuf::from(std::env::var_os("CRUMPLE_SLURM").expect("run inside scripts/local-slurm.sh"));
    let folder = tempfile::tempdir().unwrap();
    let [records, on_cluster, alone] = ["records", "cluster/fleet", "alone/fleet"].map(|name| folder.path().join(name));
    write_fleet(&records, RECORDS, BROKEN, SEED_OF_CLUSTER).unwrap();

    let mut command = just_fleet("fleet-slurm", &records, &on_cluster);
    command.arg(format!("batches={PARTS}")).args(["threads=1", "mem_mb=1000"]);
    command.args(["--slurm-init-seconds-before-status-checks", "5"]);
    let log = std::fs::File::create(folder.path().join("log")).unwrap();
    let mut fleet = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(log).spawn().unwrap();

    // A part that the second node is in the middle of.
    let (journal, before) = wait_for(&mut fleet, "part in the middle of its runs on node n2", || {
        running_jobs().into_iter().filter(|(node, _)| node == "n2").find_map(|(_, job)| {
            let journal = format!("journal/{}-of-{PARTS}.jsonl", job.strip_prefix("rule_batch_wildcards_")?);
            let ended = ended_runs(&on_cluster.join(&journal)).len();
            (3..10).contains(&ended).then_some((journal, ended))
        })
    });
    let node = std::fs::read_to_string(cluster.join("n2.pid")).unwrap();
    assert!(Command::new("kill").args(["-KILL", node.trim()]).status().unwrap().success());
    let status = fleet.wait().unwrap();
    let said = std::fs::read_to_string(folder.path().join("log")).unwrap();
    assert!(status.success(), "{said}");

    // Nodes of the jobs that ended well, and jobs that were lost with their node.
    let jobs = std::fs::read_to_string(cluster.join("log/jobs.txt")).unwrap();
    let field = |job: &str, name: &str| -> String {
        job.split(' ').find_map(|word| word.strip_prefix(name)?.strip_prefix('=')).unwrap_or_default().to_owned()
    };
    let mut nodes: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for job in jobs.lines() {
        nodes.entry(field(job, "JobState")).or_default().insert(field(job, "NodeList"));
    }
    assert!(nodes["COMPLETED"].len() >= 2, "{jobs}");
    assert!(nodes.iter().any(|(state, nodes)| state != "COMPLETED" && nodes.contains("n2")), "{jobs}");

    // The part was done by another node, from where it was left, and nothing was run twice.
    let ended = ended_runs(&on_cluster.join(&journal));
    assert!(ended.len() > before + 1, "{journal}: {before} runs before the node died, {} in all", ended.len());
    let parts = (1..=PARTS).map(|part| on_cluster.join(format!("journal/{part}-of-{PARTS}.jsonl")));
    let all: Vec<String> = parts.flat_map(|journal| ended_runs(&journal)).collect();
    assert_eq!(all.len(), RECORDS + BROKEN);
    assert_eq!(all.iter().collect::<BTreeSet<_>>().len(), RECORDS + BROKEN);

    // Tables, page and every file of every run, with no file beside them.
    let output = just_fleet("fleet", &records, &alone).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let different = different_files(&on_cluster, &alone);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(different.is_empty(), "{} files, for example {:?}; {said}", different.len(), &different[..1]);
    eprintln!(
        "{RECORDS} records, {BROKEN} broken, {PARTS} parts: {before} of {} runs of {journal} had ended when n2 died",
        ended.len()
    );
}
