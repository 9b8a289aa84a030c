//! A fleet of made cars through the whole pipeline, and what its tables say to other programs.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

use std::path::{Path, PathBuf};
use std::process::Command;

use crumple_testkit::made_fleet::{FleetCar, write_fleet};
use crumple_testkit::pipeline::{binary, just};
use crumple_testkit::workspace;

/// The cars of this test.
const SEED: u64 = 17;

fn just_fleet(recipe: &str, folder: &Path) -> Command {
    let mut command = just();
    command
        .arg(format!("out={}", folder.join("fleet").display()))
        .args([recipe, "-j", "2"])
        .arg(folder.join("records"));
    command
}

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
    let output = just_fleet("study", folder.path()).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    let fleet = folder.path().join("fleet");
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

    let again = just_fleet("fleet", folder.path()).output().unwrap();
    let said = String::from_utf8_lossy(&again.stderr);
    assert!(said.contains(&format!("{} up to date", 2 * cars + 1)), "{said}");

    let Some(python) = python_with(&["duckdb", "polars"]) else { return };
    let script = workspace().join("crates/testkit/tests/fleet_queries.py");
    let output = Command::new(python).arg(script).arg(workspace().join("docs/fleet.md")).arg(&fleet).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}
