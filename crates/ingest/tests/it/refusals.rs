//! The binary's refusals: exit code, and the words people see.

use std::path::Path;
use std::process::Command;

use crate::{program, write, zipped};

/// Runs the stage on a file with this content and returns exit code and stderr.
fn run(name: &str, content: &[u8], flags: &[&str]) -> (i32, String) {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &[(name, content)]);
    run_on(&folder.path().join(name), flags)
}

fn run_on(path: &Path, flags: &[&str]) -> (i32, String) {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("1-ingest.mcap");
    let (code, _, said) = program(path, &[&["-o", output.to_str().unwrap()], flags].concat());
    assert_eq!(output.exists(), code == 0, "an artifact exists exactly if the stage succeeded");
    (code, said)
}

fn rows(n: usize) -> String {
    (0..n).map(|k| format!("{:.4},{:.3}\n", k as f64 * 1e-4, -0.1 * k as f64)).collect()
}

const STATED: [&str; 4] = ["--mass", "873kg", "--impact-speed", "35km/h"];

#[track_caller]
fn refused(name: &str, content: impl AsRef<[u8]>, flags: &[&str], words: &[&str]) {
    let (code, text) = run(name, content.as_ref(), flags);
    assert_eq!(code, 3, "{text}");
    assert!(text.starts_with("error: ") && text.contains("  expected: ") && text.contains("  hint: "), "{text}");
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

/// A good table, one text in it replaced.
fn table_but(from: &str, to: &str) -> String {
    format!("time_s,accel_g\n{}", rows(300)).replacen(from, to, 1)
}

#[test]
fn what_is_wrong_in_a_table_is_named() {
    let good = table_but("", "");
    let several: String = (0..100).map(|k| format!("{:.4},{k},{k}\n", f64::from(k) * 1e-4)).collect();
    let several = format!("time_s,left_g,right_g\n{several}");
    let commas: String = (0..100).map(|k| format!("0,{k:04},-{k},5\n")).collect();
    let cases: [(String, &[&str], &[&str]); 19] = [
        // Empty files.
        (String::new(), &[], &["a.csv: the file is empty"]),
        (" \n\r\n\t".to_owned(), &[], &["nothing but blanks"]),
        ("# only\n# comments\n".to_owned(), &[], &["nothing but comments"]),
        // No unit, one that is none, a bare number.
        (table_but("accel_g", "accel"), &STATED, &["column 2 (accel): no unit is stated", "--unit g"]),
        (table_but("accel_g", "accel [xyz]"), &STATED, &["unit \"xyz\" is not known"]),
        (good.clone(), &["--unit", "parsec"], &["no unit of acceleration"]),
        (format!("# mass: 873\n{good}"), &["--impact-speed", "35km/h"], &["a.csv, line 1: \"873\" has no unit"]),
        (good.clone(), &["--mass=-5kg"], &["a usable mass", "flag gives -5"]),
        // Two equal times, a gap in time.
        (
            table_but("0.0100,", "0.0099,"),
            &STATED,
            &["a.csv, line 102, column 1 (time_s): time 0.0099 again, as in line 101"],
        ),
        (
            table_but("0.0100,-10.000\n", ""),
            &STATED,
            &["a.csv, line 102, column 1 (time_s): a step of 0.000200000 s", "resample"],
        ),
        // No finite number, a word.
        (
            table_but("-10.000", "NaN"),
            &STATED,
            &["a.csv, line 102, column 2 (accel_g): \"NaN\" is not a finite number"],
        ),
        (table_but("-10.000", "1e308"), &STATED, &["a.csv, line 102, column 2 (accel_g)", "inf"]),
        (
            table_but("-10.000", "overload"),
            &[],
            &["a.csv, line 102, column 2 (accel_g): \"overload\" is not a finite number"],
        ),
        (format!("time_s,accel_g\n{}", rows(20)), &STATED, &["a.csv: too few samples: 20", "at least 50 samples"]),
        // Several accelerations.
        (several.clone(), &STATED, &["2 acceleration columns: left_g, right_g", "--channel left_g"]),
        (several, &["--channel", "middle"], &["no column \"middle\"", "left_g, right_g"]),
        (format!("time_s,accel_g\n{commas}"), &STATED, &["decimal comma", "a.csv, line 2"]),
        (format!("{}{good}", "# x\n".repeat(10_001)), &STATED, &["line 10001", "10000 lines of comments and blanks"]),
        // Uneven times with their jitter: every tenth step is a fifth longer.
        (uneven(), &STATED, &["jitter", ": 0.200)", "--resample 10000Hz"]),
    ];
    for (text, flags, words) in cases {
        refused("a.csv", text, flags, words);
    }
}

fn uneven() -> String {
    let time = |k: usize| k as f64 * 1e-4 + if k % 10 == 5 { 2e-5 } else { 0.0 };
    let rows = (0..400).map(|k| format!("{:.6},{:.3}\n", time(k), -0.1 * k as f64));
    format!("time_s,accel_g\n{}", rows.collect::<String>())
}

#[test]
fn uneven_times_are_resampled_on_request() {
    let (code, said) = run("a.csv", uneven().as_bytes(), &[&STATED[..], &["--resample", "10kHz"]].concat());
    assert_eq!(code, 0, "{said}");
    assert!(said.contains("are resampled to"), "{said}");
}

#[test]
fn mass_or_speed_missing_is_no_reason_to_refuse() {
    let text = table_but("", "");
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
fn a_bare_number_in_a_flag_is_a_slip() {
    let (code, message) = run("a.csv", table_but("", "").as_bytes(), &["--mass", "873"]);
    assert!(code == 2 && message.contains("has no unit"), "{message}");

    for mass in ["873", "nan kg"] {
        let text = format!("# mass: {mass}\n{}", table_but("", ""));
        assert_eq!(run("a.csv", text.as_bytes(), &STATED).0, 0, "a flag stands for the line");
    }
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
    let nodes =
        " sled\n                         ls-dyna mpp      date 03/14/2024\n\n n o d a l   p r i n t   o u t   f o r\n";
    refused("nodout", nodes, &[], &["an output text of LS-DYNA without a state"]);
    refused("a.npz", zipped(&[("t.npy", "x"), ("a.npy", "x")]), &[], &["an archive of NumPy (.npz)", "numpy.savetxt"]);
    let octave = "# Created by Octave 7.3.0\n# name: t\n# type: matrix\n# rows: 2\n# columns: 1\n 1\n 2\n";
    refused("pulse.mat", octave, &["--unit", "g"], &["a text file of Octave", "save -v7"]);
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
    write(folder.path(), &[("a.csv", table_but("", "")), ("a.csv.toml", "mas = \"873 kg\"\n".to_owned())]);
    let (code, text) = run_on(&folder.path().join("a.csv"), &[]);
    assert!(
        code == 3 && text.contains("a.csv.toml: unknown key \"mas\"") && text.contains("did you mean \"mass\"?"),
        "{text}"
    );
}

#[test]
fn a_closed_stderr_changes_nothing() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_crumple-ingest"))
        .args(["no-such-file.csv", "-o", "no-such-output.mcap"])
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    // The process has yet to start when its reader goes.
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(3));
}

#[test]
fn what_cannot_be_read_is_called_by_its_name() {
    refused("a.tdx", [0_u8, 0, 1, 200, 3, 0, 0, 63].repeat(20), &[], &["TDX", ".TDM"]);
    let inner = zipped(&[("a.csv", "0,1\n"), ("other.bin", "0,1\n")]);
    let outer = zipped(&[("inner.zip", &inner), ("other.bin", &inner)]);
    refused("a.zip", outer, &[], &["an archive inside the archive: inner.zip"]);
}

#[test]
fn every_refusal_names_file_place_expectation_and_remedy() {
    let rows: String = (0..100).map(|k| format!("{:.4},{k}\n", f64::from(k) * 1e-4)).collect();
    let cases: [(&str, Vec<u8>, &str); 8] = [
        (
            "c.001",
            b"Channel code :10VEHC000000ACX0\nUnit :g\nSampling interval :1e-4\n1\n2\nx\n".to_vec(),
            "c.001, line 6",
        ),
        ("d.001", b"Channel code :10VEHC000000ACX0\nUnit :g\n1\n2\n".to_vec(), "d.001: no sampling interval"),
        ("e.bag", b"#ROSBAG V2.0\n\x09\0\0\0".to_vec(), "e.bag: a record is cut short (byte 13)"),
        ("f.mcap", b"\x89MCAP0\r\n".to_vec(), "f.mcap: the MCAP file cannot be read"),
        ("g.001", rows.replace(',', "\t").into_bytes(), "g.001, column 2"),
        ("h.EV5", b"----- EV5 -----\n----- TEST -----\nV5|T\n".to_vec(), "h.EV5: no section ----- VEHICLE -----"),
        ("i.db3", b"SQLite format 3\0\0\0".to_vec(), "i.db3 is "),
        ("k.dat", vec![0; 100], "k.dat: binary data of an unknown kind"),
    ];
    for (name, content, place) in cases {
        refused(name, content, &["--allow-missing"], &[place, "expected: "]);
    }
}
