//! Damaged artifacts are refused by the next stage; killed stages leave the old output or the new one.

use std::process::Command;
use std::time::Duration;

use crumple_artifact::Artifact;
use crumple_testkit::pipeline::{binary, code_and_error, run};
use crumple_testkit::workspace;

/// Every bit is flipped in the reader's own test; here the stage around it, at places all over a real artifact.
#[test]
fn the_next_stage_refuses_a_flipped_bit_and_names_the_record() {
    let folder = tempfile::tempdir().unwrap();
    assert!(run(&[], folder.path(), &workspace().join("fixtures/kelvin/crash.csv"), &[]).status.success());
    let good = std::fs::read(folder.path().join("2-filter.mcap")).unwrap();
    let bad = folder.path().join("bad.mcap");
    let out = folder.path().join("out.mcap");
    for k in 0..60 {
        let place = k * (good.len() - 1) / 59;
        let mut bytes = good.clone();
        bytes[place] ^= 1 << (k % 8);
        std::fs::write(&bad, &bytes).unwrap();
        let (code, error) = code_and_error(Command::new(binary("crumple-integrate")).arg(&bad).arg("-o").arg(&out));
        assert_eq!(code, 3, "byte {place}: {error}");
        assert!(error.contains("bad.mcap") && error.contains("hint:"), "byte {place}: {error}");
        assert!(!out.exists(), "byte {place}: an output was written");
    }
}

#[test]
fn a_killed_stage_leaves_the_old_output_or_the_new_one() {
    let folder = tempfile::tempdir().unwrap();
    let small = workspace().join("fixtures/kelvin/crash.csv");
    // A longer record, so that there is time to kill: 60 s at 10 kHz.
    let big = folder.path().join("big.csv");
    let mut text = String::from("# mass: 873 kg\n# impact speed: 35 km/h\ntime_s,accel_g\n");
    for k in 0..600_000 {
        let t = f64::from(k) * 1e-4 - 0.05;
        text.push_str(&format!("{t:.4},{}\n", if k < 500 { 0.0 } else { -(t * 9.0).sin() }));
    }
    std::fs::write(&big, text).unwrap();
    let out = folder.path().join("1-ingest.mcap");
    let ingest = |input: &std::path::Path| {
        let mut command = Command::new(binary("crumple-ingest"));
        command.arg(input).arg("-o").arg(&out).arg("-q");
        command
    };
    assert!(ingest(&big).status().unwrap().success());
    let new = Artifact::open(&out).unwrap().digest().to_owned();
    assert!(ingest(&small).status().unwrap().success());
    let old = Artifact::open(&out).unwrap().digest().to_owned();
    let mut killed = 0;
    for milliseconds in 0..60 {
        let mut child = ingest(&big).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(milliseconds * 3));
        killed += i32::from(child.try_wait().unwrap().is_none());
        child.kill().unwrap();
        child.wait().unwrap();
        let found = Artifact::open(&out).unwrap().digest().to_owned();
        assert!(found == old || found == new, "killed after {} ms", 3 * milliseconds);
        if found == new {
            assert!(ingest(&small).status().unwrap().success());
        }
    }
    assert!(killed > 0, "every process was done before it was killed: the test shows nothing");
}
