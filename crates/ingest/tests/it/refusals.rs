//! The binary's refusals: exit code, and the words people see.

use std::fs;
use std::path::Path;
use std::process::Command;

/// Runs the stage on a file with this content and returns exit code and stderr.
fn run(name: &str, content: &[u8], flags: &[&str]) -> (i32, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, content).unwrap();
    run_on(&path, flags)
}

fn run_on(path: &Path, flags: &[&str]) -> (i32, String) {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("1-ingest.mcap");
    let done = Command::new(env!("CARGO_BIN_EXE_crumple-ingest"))
        .arg(path)
        .arg("-o")
        .arg(&output)
        .args(flags)
        .output()
        .unwrap();
    let code = done.status.code().unwrap();
    assert_eq!(output.exists(), code == 0, "an artifact exists exactly if the stage succeeded");
    (code, String::from_utf8(done.stderr).unwrap())
}

fn rows(n: usize) -> String {
    (0..n).map(|k| format!("{:.4},{:.3}\n", k as f64 * 1e-4, -0.1 * k as f64)).collect()
}

const STATED: [&str; 4] = ["--mass", "873kg", "--impact-speed", "35km/h"];

#[track_caller]
fn refused(name: &str, content: impl AsRef<[u8]>, flags: &[&str], words: &[&str]) {
    let (code, text) = run(name, content.as_ref(), flags);
    assert_eq!(code, 3, "{text}");
    assert!(text.starts_with("error: ") && text.contains("  hint: "), "{text}");
    for word in words {
        assert!(text.contains(word), "{word:?} is not in\n{text}");
    }
}

#[test]
fn a_good_record_is_not_refused() {
    let (code, text) = run("a.csv", format!("time_s,accel_g\n{}", rows(300)).as_bytes(), &STATED);
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("mass 873 kg") && text.contains("300 samples at 10000 Hz"), "{text}");
}

#[test]
fn empty_files() {
    refused("a.csv", "", &[], &["a.csv: the file is empty"]);
    refused("a.csv", " \n\r\n\t", &[], &["nothing but blanks"]);
    refused("a.csv", "# only\n# comments\n", &[], &["nothing but comments"]);
}

#[test]
fn no_unit() {
    refused(
        "a.csv",
        format!("time_s,accel\n{}", rows(300)),
        &STATED,
        &["column 2 (accel): no unit is stated", "--unit g"],
    );
    refused("a.csv", format!("time_s,accel [xyz]\n{}", rows(300)), &STATED, &["unit \"xyz\" is not known"]);
}

#[test]
fn two_equal_times() {
    let text = format!("time_s,accel_g\n{}", rows(300)).replacen("0.0100,", "0.0099,", 1);
    refused("a.csv", text, &STATED, &["a.csv, line 102, column 1 (time_s): time 0.0099 again, as in line 101"]);
}

#[test]
fn a_gap_in_time() {
    let text = format!("time_s,accel_g\n{}", rows(300)).replacen("0.0100,-10.000\n", "", 1);
    refused("a.csv", text, &STATED, &["a.csv, line 102, column 1 (time_s): a step of 0.000200000 s", "resample"]);
}

#[test]
fn nan_inside() {
    let text = format!("time_s,accel_g\n{}", rows(300)).replacen("-10.000", "NaN", 1);
    refused("a.csv", text, &STATED, &["a.csv, line 102, column 2 (accel_g): \"NaN\" is not a finite number"]);
    let text = format!("time_s,accel_g\n{}", rows(300)).replacen("-10.000", "1e308", 1);
    refused("a.csv", text, &STATED, &["a.csv, line 102, column 2 (accel_g)", "inf"]);
}

#[test]
fn twenty_samples() {
    refused(
        "a.csv",
        format!("time_s,accel_g\n{}", rows(20)),
        &STATED,
        &["a.csv: too few samples: 20", "at least 50 samples"],
    );
}

#[test]
fn mass_or_speed_missing_is_no_reason_to_refuse() {
    let text = format!("time_s,accel_g\n{}", rows(300));
    for (flags, words) in [
        (&STATED[2..], "mass unknown"),
        (&STATED[..2], "impact speed unknown"),
        (&[], "mass unknown, impact speed unknown"),
    ] {
        let (code, said) = run("a.csv", text.as_bytes(), flags);
        assert_eq!(code, 0, "{said}");
        assert!(said.contains(words), "{said}");
        // What follows from it, and how to state it.
        assert_eq!(said.contains("add --mass 1500kg"), words.contains("mass"), "{said}");
        assert_eq!(said.contains("add --impact-speed 50km/h"), words.contains("speed"), "{said}");
    }
}

#[test]
fn times_beyond_any_record_and_pipes_without_a_writer() {
    let huge: String = (1..80).map(|k| format!("{k}e300,{}\n", k % 7)).collect();
    refused("huge.csv", format!("time_s,accel_g\n{huge}"), &[], &["channel accel_g runs from 1e300 s to", "285 years"]);
    let ones = "1\n2\n".repeat(50);
    for interval in ["1e-320s", "1e300s"] {
        refused("interval.csv", format!("accel_g\n{ones}"), &["--sample-time", interval], &["correct the times"]);
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("crash.csv");
    assert!(Command::new("mkfifo").arg(&path).status().unwrap().success());
    let (code, said) = run_on(&path, &[]);
    assert!(code == 3 && said.contains("it is a pipe, not a file"), "{code}: {said}");
}

#[test]
fn nonsense_values() {
    let text = format!("time_s,accel_g\n{}", rows(300));
    refused("a.csv", &text, &["--mass=-5kg", "--impact-speed", "35km/h"], &["a usable mass", "flag gives -5"]);
    let (code, message) = run("a.csv", text.as_bytes(), &["--mass", "873"]);
    assert_eq!(code, 2, "{message}");
    assert!(message.contains("has no unit"), "{message}");
    for mass in ["873", "nan kg"] {
        let text = format!("# mass: {mass}\n{text}");
        refused("a.csv", &text, &["--impact-speed", "35km/h"], &[&format!("a.csv, line 1: \"{mass}\"")]);
        assert_eq!(run("a.csv", text.as_bytes(), &STATED).0, 0, "a flag stands for the line");
    }
    refused(
        "a.csv",
        &text,
        &["--mass", "873kg", "--impact-speed", "35km/h", "--unit", "parsec"],
        &["no unit of acceleration"],
    );
}

#[test]
fn several_accelerations() {
    let rows: String = (0..100).map(|k| format!("{:.4},{k},{k}\n", f64::from(k) * 1e-4)).collect();
    let text = format!("time_s,left_g,right_g\n{rows}");
    refused("a.csv", &text, &STATED, &["2 acceleration columns: left_g, right_g", "--channel left_g"]);
    refused(
        "a.csv",
        &text,
        &[&STATED[..], &["--channel", "middle"]].concat(),
        &["no column \"middle\"", "left_g, right_g"],
    );
}

#[test]
fn broken_decimal_commas() {
    let rows: String = (0..100).map(|k| format!("0,{k:04},-{k},5\n")).collect();
    refused("a.csv", format!("time_s,accel_g\n{rows}"), &STATED, &["decimal comma", "a.csv, line 2"]);
}

#[test]
fn foreign_formats() {
    refused("a.csv", "%PDF-1.7\n%\u{e2}\u{e3}\n", &[], &["a.csv is a PDF document, which is not read", "as CSV"]);
    refused("a.csv", b"TDSm\x0e\0\0\0\x69\x12\0\0", &[], &["TDMS"]);
    refused("a.csv", b"\x89MCAP0\r\n\0\0", &[], &["MCAP"]);
    refused(
        "a.csv",
        [0_u8, 1, 2, 3, 4, 250, 0, 9],
        &[],
        &["binary data of an unknown kind, starting with 00 01 02 03"],
    );
    refused("a.zip", b"PK\x03\x04 not really a zip", &[], &["zip archive cannot be read"]);
}

#[test]
fn missing_paths_and_folders() {
    let folder = tempfile::tempdir().unwrap();
    let (code, text) = run_on(&folder.path().join("no.csv"), &[]);
    assert!(code == 3 && text.contains("no.csv: no such file or folder"), "{text}");
    let (code, text) = run_on(folder.path(), &[]);
    assert!(code == 3 && text.contains("a folder without an .EV5 file"), "{text}");
}

#[test]
fn a_specification_whose_files_are_absent() {
    let ev5 = "----- EV5 -----\n----- TEST -----\nV5|T\n----- VEHICLE -----\n1|1\n----- INSTRUMENTATION -----\n\
               1|7|AC|NA|FLLR|XG|SEC|G'S|2800||||| 57.0|-500|2999|100|AM|P|FLOOR X\n----- END -----\n";
    refused("v1.EV5", ev5, &[], &["none of the 1 listed channels has its signal file here", "v1.007"]);
    refused("v1.EV5", "----- EV5 -----\n----- TEST -----\nV5|T\n", &[], &["no section ----- VEHICLE -----"]);
}

#[test]
fn a_sidecar_with_a_slip() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    fs::write(&path, format!("time_s,accel_g\n{}", rows(300))).unwrap();
    fs::write(folder.path().join("a.csv.toml"), "mas = \"873 kg\"\n").unwrap();
    let (code, text) = run_on(&path, &[]);
    assert!(
        code == 3 && text.contains("a.csv.toml: unknown key \"mas\"") && text.contains("did you mean \"mass\"?"),
        "{text}"
    );
}

#[test]
fn a_closed_stderr_changes_nothing() {
    use std::process::{Command, Stdio};
    let mut child = Command::new(env!("CARGO_BIN_EXE_crumple-ingest"))
        .args(["no-such-file.csv", "-o", "no-such-output.mcap"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The process has yet to start when its reader goes.
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(3));
}

#[test]
fn uneven_times_are_refused_with_their_jitter_and_resampled_on_request() {
    // Every tenth step is a fifth longer.
    let text: String = (0..400)
        .map(|k| format!("{:.6},{:.3}\n", k as f64 * 1e-4 + f64::from(u8::from(k % 10 == 5)) * 2e-5, -0.1 * k as f64))
        .collect();
    let text = format!("time_s,accel_g\n{text}");
    refused("a.csv", &text, &STATED, &["jitter", ": 0.200)", "--resample 10000Hz"]);
    let (code, said) = run("a.csv", text.as_bytes(), &[&STATED[..], &["--resample", "10kHz"]].concat());
    assert_eq!(code, 0, "{said}");
    assert!(
        said.contains("resampled to 10000 Hz by linear interpolation") || said.contains("are resampled to"),
        "{said}"
    );
}

#[test]
fn what_cannot_be_read_is_called_by_its_name() {
    let comments = format!("{}time_s,accel_g\n{}", "# x\n".repeat(10_001), rows(300));
    refused("a.csv", comments, &STATED, &["line 10001", "10000 lines of comments and blanks"]);
    refused("a.tdx", [0_u8, 0, 1, 200, 3, 0, 0, 63].repeat(20), &[], &["TDX", ".TDM"]);

    use std::io::{Cursor, Write};
    let zipped = |name: &str, content: &[u8]| {
        let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
        for name in [name, "other.bin"] {
            zip.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
            zip.write_all(content).unwrap();
        }
        zip.finish().unwrap().into_inner()
    };
    let outer = zipped("inner.zip", &zipped("a.csv", b"0,1\n"));
    refused("a.zip", outer, &[], &["an archive inside the archive: inner.zip"]);
}
