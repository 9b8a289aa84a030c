//! A record that is no crash goes from a table to a model on the command line: no mass, no speed, no pulse, any units.

use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use crumple_testkit::pipeline::{binary, code_and_error};
use crumple_testkit::shared;

/// Runs a stage and returns its records, one JSON object a line.
fn stage(name: &str, input: &Path, output: &Path, flags: &[&str]) -> Vec<serde_json::Value> {
    let mut command = Command::new(binary(name));
    command.arg(input).arg("-o").arg(output).args(flags).arg("--json");
    let run = command.output().unwrap();
    assert_eq!(run.status.code(), Some(0), "{name} {flags:?}: {}", String::from_utf8_lossy(&run.stderr));
    String::from_utf8(run.stdout).unwrap().lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn record<'a>(records: &'a [serde_json::Value], topic: &str) -> &'a serde_json::Value {
    let found = records.iter().find(|record| record["topic"] == topic);
    &found.unwrap_or_else(|| panic!("no {topic} among {records:#?}"))["data"]
}

#[test]
fn a_made_table_of_two_inputs_and_one_output_gives_its_model() {
    let folder = tempfile::tempdir().unwrap();
    // y[k] = 1.5 y[k-1] - 0.7 y[k-2] + 0.5 p[k-1] - 0.2 q[k-1]: poles 0.75 +- 0.3708i.
    let mut table = "p,q,y\n".to_owned();
    let (mut y1, mut y2, mut before) = (0.3, -0.1, (0.0, 0.0));
    for k in 0..500_i32 {
        let y = 1.5 * y1 - 0.7 * y2 + 0.5 * before.0 - 0.2 * before.1;
        before = (f64::from((k * k * 7 + k * 3) % 11) - 5.0, f64::from((k * k * 5 + k * 2) % 13) - 6.0);
        writeln!(table, "{},{},{y}", before.0, before.1).unwrap();
        (y2, y1) = (y1, y);
    }
    let input = folder.path().join("process.csv");
    std::fs::write(&input, table).unwrap();
    let ingested = folder.path().join("1-ingest.mcap");
    stage("crumple-ingest", &input, &ingested, &["--sample-time=2s", "--allow-missing"]);
    let output = folder.path().join("4-identify.mcap");
    let flags = ["--methods=n4sid,arx,output-error", "--orders=2", "--inputs=p,q", "--outputs=y"];
    let records = stage("crumple-identify", &ingested, &output, &flags);
    for id in ["n4sid-2", "arx-2", "output-error-2"] {
        let mode = &record(&records, &format!("/modes/{id}"))["modes"][0];
        let (re, im) = (mode["discrete_re"].as_f64().unwrap(), mode["discrete_im"].as_f64().unwrap().abs());
        // Clean data: rounding times the condition of each method.
        assert!((re - 0.75).abs() < 1e-7 && (im - 0.370_809_924).abs() < 1e-7, "{id}: {mode}");
        assert!(record(&records, &format!("/identification/{id}"))["fit_percent"].as_f64().unwrap() > 99.9999);
    }
    // Without the names of the waveforms there is nothing to take for a crash pulse, and that is said.
    let (code, error) = code_and_error(
        Command::new(binary("crumple-identify"))
            .arg(&ingested)
            .arg("-o")
            .arg(&output)
            .arg("--methods=arx")
            .arg("--force"),
    );
    assert_eq!(code, 3, "{error}");
}

#[test]
fn the_hair_dryer_is_identified_from_its_table() {
    let Some(input) = shared("data/sysid/hair-dryer/dryer.dat") else { return };
    let folder = tempfile::tempdir().unwrap();
    let ingested = folder.path().join("1-ingest.mcap");
    let records = stage("crumple-ingest", &input, &ingested, &["--sample-time=0.08s", "--allow-missing"]);
    let channels = record(&records, "/test")["channels"].as_array().unwrap();
    let ids: Vec<&str> = channels.iter().map(|channel| channel["id"].as_str().unwrap()).collect();
    assert_eq!(ids.len(), 2, "{ids:?}");
    let output = folder.path().join("4-identify.mcap");
    let (inputs, outputs) = (format!("--inputs={}", ids[0]), format!("--outputs={}", ids[1]));
    let flags = ["--methods=arx,n4sid,output-error", "--orders=4", &inputs, &outputs];
    let records = stage("crumple-identify", &ingested, &output, &flags);
    let fit = record(&records, "/identification/output-error-4")["fit_percent"].as_f64().unwrap();
    // Peers fit 89 to 90 % of the first half with centred signals; the constant level counts as motion here.
    assert!(fit > 80.0, "{fit}");
}
