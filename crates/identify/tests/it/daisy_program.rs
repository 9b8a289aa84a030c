//! The program on the measured records of `tests/it/daisy.rs`, with the flags that the documentation prints.

use std::path::{Path, PathBuf};

use crumple_artifact::Artifact;
use crumple_artifact::records::EvidenceV1;
use crumple_signal::{Channel, QuantityKind};

use crate::program::{Wave, identify, made, written};

/// The columns of a text file as waveforms of these names.
fn artifact(folder: &Path, path: &str, names: &[&str], dt_s: f64) -> Option<PathBuf> {
    let text = std::fs::read_to_string(crumple_testkit::shared(path)?).unwrap();
    let rows: Vec<Vec<f64>> = text
        .lines()
        .map(|line| line.split([',', ' ', '\t']).filter_map(|field| field.trim().parse().ok()).collect::<Vec<f64>>())
        .filter(|row| row.len() == names.len())
        .collect();
    let channels = names.iter().map(|name| Channel::new(*name, QuantityKind::Voltage)).collect();
    let column = |j: usize| rows.iter().map(|row| row[j]).collect();
    let waves: Vec<Wave> =
        names.iter().enumerate().map(|(j, name)| (*name, QuantityKind::Voltage, column(j))).collect();
    Some(written(&made(channels, 0.0, dt_s, &waves), folder, "ingest"))
}

/// Runs the program and returns the fit of the second part, state fitted to it, of every evidence asked for.
fn fits(input: &Path, flags: &str, evidence: &[&str]) -> Vec<f64> {
    let output = input.with_file_name("4.mcap");
    let flags: Vec<&str> = flags.split_whitespace().chain(["--force"]).collect();
    let run = identify(input, &output, &flags);
    assert_eq!(run.code, Some(0), "{}", run.said);
    println!("{}", run.said);
    let result = Artifact::open(&output).unwrap();
    let fit = |id: &&str| {
        let record: EvidenceV1 = result.record(&format!("/evidence/{id}")).unwrap().unwrap();
        record.validation_restarted_fit_percent.unwrap()
    };
    evidence.iter().map(fit).collect()
}

#[test]
fn the_robot_arm_is_simulated_at_96_4_percent() {
    let folder = tempfile::tempdir().unwrap();
    let path = "data/sysid/flexible-robot-arm/robot_arm.dat";
    let Some(input) = artifact(folder.path(), path, &["column_1", "column_2"], 1.0) else { return };
    let flags = "--methods n4sid,moesp,cva,arx,output-error,tfest --orders 4 --poles 4 --zeros 4 --hold zero-order \
        --block-rows 12 --inputs column_1 --outputs column_2 --remove-mean --validate-from 512s";
    let estimated = fits(&input, flags, &["moesp-4", "output-error-4", "tfest-4-4"]);
    // The aim is the best that other toolboxes reach, 96.44.
    assert!(estimated.iter().all(|fit| *fit >= 96.4), "{estimated:?}");
}

#[test]
fn the_hair_dryer_is_simulated_at_85_9_percent() {
    let folder = tempfile::tempdir().unwrap();
    let path = "data/sysid/hair-dryer/dryer.dat";
    let Some(input) = artifact(folder.path(), path, &["column_1", "column_2"], 0.08) else { return };
    let common = "--inputs column_1 --outputs column_2 --remove-mean --hold zero-order --validate-from 40s";
    let estimated = fits(&input, &format!("--methods output-error --orders 3 --delay 2 {common}"), &["output-error-3"]);
    assert!(estimated[0] >= 85.9, "{estimated:?}");
    let estimated = fits(&input, &format!("--methods arx --arx-orders 2,2,3 --arx-scan {common}"), &["arx-2-2-3"]);
    // The published figure of this structure.
    assert!((estimated[0] - 85.50).abs() < 0.1, "{estimated:?}");
}

#[test]
fn the_steel_subframe_is_simulated_at_92_percent_on_five_of_six_outputs() {
    let folder = tempfile::tempdir().unwrap();
    let names = ["u1", "u2", "y01", "y02", "y03", "y04", "y05", "y06"];
    let path = "data/sysid/steel-subframe-a/steel_subframe_u1u2_y01-y06.csv";
    let Some(input) = artifact(folder.path(), path, &names, 1.0 / 1024.0) else { return };
    let flags = "--methods n4sid,moesp,cva --orders 30 --block-rows 25 --hold zero-order --inputs u1,u2 --outputs \
        y01,y02,y03,y04,y05,y06 --remove-mean --validate-from 4s";
    let outputs: Vec<String> = (1..=6).map(|k| format!("n4sid-30/{k}")).collect();
    let estimated = fits(&input, flags, &outputs.iter().map(String::as_str).collect::<Vec<_>>());
    // The third output is the worst of every toolbox: 84.2 elsewhere.
    assert!(estimated.iter().enumerate().all(|(k, fit)| *fit >= if k == 2 { 80.0 } else { 92.0 }), "{estimated:?}");
}
