//! Every bad input: a clear error, exit code 3, nothing written.

use std::path::{Path, PathBuf};

use crumple_testkit::pipeline::run;
use crumple_testkit::shared;

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
fn an_ev5_without_its_signal_files_is_refused() {
    let Some(ev5) = shared("data/nhtsa-v10146-camry-frontal/v10146.EV5") else { return };
    let folder = tempfile::tempdir().unwrap();
    let lone: PathBuf = folder.path().join("v10146.EV5");
    std::fs::copy(ev5, &lone).unwrap();
    assert_refused(&lone, &["v10146", ".001"], &folder.path().join("out"));
}
