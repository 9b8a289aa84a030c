//! `--list`: the table of channels on stdout, nothing written.

use std::fs;
use std::process::Command;

fn list(content: &str, flags: &[&str]) -> (i32, String, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    fs::write(&path, content).unwrap();
    let done =
        Command::new(env!("CARGO_BIN_EXE_crumple-ingest")).arg("--list").arg(&path).args(flags).output().unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is written");
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (done.status.code().unwrap(), text(done.stdout), text(done.stderr))
}

fn table() -> String {
    let rows: String = (0..100).map(|k| format!("{:.4},{k},{k},{k}\n", f64::from(k) * 1e-4)).collect();
    format!("time_s,accel_x_cfc60_g,force [kN],note\n{rows}")
}

#[test]
fn the_table_has_a_line_a_channel() {
    let (code, text, _) = list(&table(), &[]);
    assert_eq!(code, 0);
    let cells: Vec<Vec<&str>> = text.lines().map(|line| line.split_whitespace().collect()).collect();
    let head = "id code location attached axis quantity unit rate_hz samples cfc status comment";
    let head: Vec<&str> = head.split(' ').collect();
    assert_eq!(cells[0], head);
    assert_eq!(
        cells[1],
        ["accel_x_cfc60_g", "-", "-", "-", "x", "acceleration", "m/s^2", "10000", "100", "60", "valid", "-"]
    );
    assert_eq!(cells[2], ["force", "-", "-", "-", "-", "force", "N", "10000", "100", "-", "valid", "-"]);
    assert_eq!(cells[3][5], "other");
    let (_, text, _) = list(&table(), &["--search", "FORCE", "--with-data"]);
    assert_eq!(text.lines().count(), 2, "{text}");
    assert_eq!(cells.len(), 4);
}

#[test]
fn as_json_each_line_is_an_object() {
    let (code, text, _) = list(&table(), &["--json", "--channel", "f*"]);
    assert_eq!((code, text.lines().count()), (0, 1));
    let line: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(
        (line["id"].as_str(), line["samples"].as_u64(), line["cfc"].is_null()),
        (Some("force"), Some(100), true)
    );
}

#[test]
fn refusals_and_slips_have_their_exit_codes() {
    let (code, _, text) = list(&table(), &["--channel", "zzz*"]);
    assert!(code == 3 && text.contains("--channel zzz* means none of its 3 channels"), "{text}");
    let (code, _, text) = list("%PDF-1.7\n", &[]);
    assert!(code == 3 && text.contains("PDF"), "{text}");
    let (code, ..) = list(&table(), &["--no-such-flag"]);
    assert_eq!(code, 2);
}

#[test]
fn a_damaged_signal_file_is_listed_as_not_read_and_one_that_is_not_here_as_absent() {
    let folder = tempfile::tempdir().unwrap();
    let line = |curve: u32| format!("1|{curve}|AC|NA|FLLR|XG|SEC|G'S|2800||||| 57.0|-100|299|100|AM|P|FLOOR X\n");
    let ev5 = format!(
        "----- EV5 -----\n----- TEST -----\nV5|T\n----- VEHICLE -----\n1|1\n----- INSTRUMENTATION -----\n{}{}{}\
         ----- END -----\n",
        line(7),
        line(8),
        line(9)
    );
    let rows: String = (-100..300).map(|k| format!("{:.6}\t0.5\n", f64::from(k) * 1e-4)).collect();
    fs::write(folder.path().join("v1.EV5"), ev5).unwrap();
    fs::write(folder.path().join("v1.007"), &rows).unwrap();
    fs::write(folder.path().join("v1.008"), rows.replacen("0.5", "what", 1)).unwrap();
    let done = Command::new(env!("CARGO_BIN_EXE_crumple-ingest"))
        .args(["--list", "--json"])
        .arg(folder.path().join("v1.EV5"))
        .output()
        .unwrap();
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    let lines: Vec<serde_json::Value> =
        String::from_utf8(done.stdout).unwrap().lines().map(|l| serde_json::from_str(l).unwrap()).collect();
    let status: Vec<_> = lines.iter().map(|l| l["status"].as_str().unwrap()).collect();
    assert_eq!(status, ["valid", "not read", "absent"]);
    let comment = lines[1]["comment"].as_str().unwrap();
    assert!(comment.contains("v1.008, line 1") && comment.contains("what"), "{comment}");
}
