//! Every bad input: a clear error, exit code 3, nothing written.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use crumple_artifact::Artifact;
use crumple_testkit::fuzz::{Campaign, run_campaign};
use crumple_testkit::programs::{binary, code_and_error, run};
use crumple_testkit::{shared, workspace};

/// A half-sine pulse with a header; `edit` changes the lines.
fn table(rate_hz: f64, samples: usize, header: &[&str], edit: impl Fn(&mut Vec<String>)) -> String {
    let mut lines: Vec<String> = header.iter().map(ToString::to_string).collect();
    for k in 0..samples {
        let t = k as f64 / rate_hz - 0.05;
        let a = if (0.0..0.1).contains(&t) { -25.0 * (std::f64::consts::PI * t / 0.1).sin() } else { 0.0 };
        lines.push(format!("{t:.4},{a:.6}"));
    }
    edit(&mut lines);
    lines.join("\n") + "\n"
}

const FULL: [&str; 3] = ["# mass: 1200 kg", "# impact speed: 50 km/h", "time_s,accel_g"];

struct Case {
    name: &'static str,
    content: Vec<u8>,
    words: &'static [&'static str],
}

fn text_case(name: &'static str, content: String, words: &'static [&'static str]) -> Case {
    Case { name, content: content.into_bytes(), words }
}

fn assert_refused(input: &Path, words: &[&str], folder: &Path) {
    let output = run(&[], folder, input, &[]);
    let error = String::from_utf8_lossy(&output.stderr).to_lowercase();
    assert_eq!(output.status.code(), Some(3), "{}: {error}", input.display());
    assert!(error.contains("error:") && error.contains("hint:"), "{}: {error}", input.display());
    for word in words {
        assert!(error.contains(word), "{}: {word:?} is not in: {error}", input.display());
    }
    assert!(!folder.join("report.html").exists());
}

#[test]
fn bad_tables_are_refused_by_name() {
    let cases = [
        Case { name: "empty.csv", content: Vec::new(), words: &["empty.csv", "empty"] },
        text_case(
            "no-unit.csv",
            table(1e4, 2000, &["# mass: 1200 kg", "# impact speed: 50 km/h", "time_s,accel"], |_| {}),
            &["no-unit.csv", "unit", "accel"],
        ),
        text_case(
            "equal-times.csv",
            table(1e4, 2000, &FULL, |lines| lines[103] = lines[102].clone()),
            &["equal-times.csv", "104"],
        ),
        text_case(
            "nan.csv",
            table(1e4, 2000, &FULL, |lines| {
                let time = lines[500].split(',').next().unwrap_or_default().to_owned();
                lines[500] = format!("{time},NaN");
            }),
            &["nan.csv", "501", "nan"],
        ),
        text_case("short.csv", table(1e4, 20, &FULL, |_| {}), &["short.csv", "20"]),
        text_case("slow.csv", table(400.0, 200, &FULL, |_| {}), &["400", "600"]),
        Case {
            name: "report.csv",
            content: b"%PDF-1.7\n%\xe2\xe3\xcf\xd3\n1 0 obj\n".to_vec(),
            words: &["report.csv", "pdf"],
        },
    ];
    let folder = tempfile::tempdir().unwrap();
    for case in &cases {
        let input = folder.path().join(case.name);
        std::fs::write(&input, &case.content).unwrap();
        assert_refused(&input, case.words, &folder.path().join(format!("out-{}", case.name)));
    }
    assert_refused(&folder.path().join("nowhere.csv"), &["nowhere.csv"], &folder.path().join("out-nowhere"));
}

#[test]
fn a_line_end_in_the_name_of_a_file_is_spelled_out() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("a\nerror: b.csv");
    std::fs::write(&input, "time_s,accel_furlong\n0,1\n").unwrap();
    assert_refused(&input, &["a\\nerror: b.csv"], &folder.path().join("out"));
}

#[test]
fn an_ev5_without_its_signal_files_is_refused() {
    let Some(ev5) = shared("data/nhtsa-v10146-camry-frontal/v10146.EV5") else { return };
    let folder = tempfile::tempdir().unwrap();
    let lone: PathBuf = folder.path().join("v10146.EV5");
    std::fs::copy(ev5, &lone).unwrap();
    assert_refused(&lone, &["v10146", ".001"], &folder.path().join("out"));
}

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
    let ingest = |input: &Path| {
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

#[test]
fn programs_end_as_they_may_on_mutated_files_and_tampered_artifacts() {
    let folder = tempfile::tempdir().unwrap();
    let bin = binary("crumple-ingest").parent().unwrap().to_owned();
    let campaign = Campaign { bin, folder: folder.path().to_owned(), first: 0, files: 60 };
    let mut told = Vec::new();
    let tallies = run_campaign(&campaign, &mut |line| told.push(line)).unwrap();
    assert!(told.is_empty(), "{}", told.join("\n"));
    // Both ways out are taken, or nothing was tried.
    for tally in tallies {
        assert!(tally.0.len() >= 2, "{tally}");
    }
}
