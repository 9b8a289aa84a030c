//! The program: artifact in, artifact out.

use std::path::{Path, PathBuf};
use std::process::Command;

use crumple_artifact::Artifact;
use crumple_artifact::records::{DiagnosisV1, IdentificationV1, ModesV2, NotesV1, StateSpaceV1, TransferFunctionV1};
use crumple_signal::{Channel, QuantityKind};

use crate::program::{identify, made, written};

const DT_S: f64 = 1e-4;

/// A filtered test with one acceleration channel, 20 ms before contact and 250 ms after, written as an artifact.
fn artifact(folder: &Path, cfc: Option<u16>, acceleration: impl Fn(f64) -> f64) -> PathBuf {
    let mut channel = Channel::new("93", QuantityKind::Acceleration);
    channel.cfc = cfc;
    let samples = (-200..=2500).map(|k| if k < 0 { 0.0 } else { acceleration(f64::from(k) * DT_S) }).collect();
    let waves = [("93", QuantityKind::Acceleration, samples)];
    written(&made(vec![channel], -0.02, DT_S, &waves), folder, "filter")
}

fn two_modes(t: f64) -> f64 {
    -90.0 * (-15.0 * t).exp() * (120.0 * t + 0.3).cos() + 30.0 * (-40.0 * t).exp() * (420.0 * t).cos()
}

#[test]
fn writes_matrices_modes_and_evidence_of_every_order() {
    let folder = tempfile::tempdir().unwrap();
    let input = artifact(folder.path(), Some(60), two_modes);
    let output = folder.path().join("4-identify.mcap");
    let run = identify(&input, &output, &["--orders", "2,4,auto"]);
    assert_eq!(run.code, Some(0), "{}", run.said);

    let result = Artifact::open(&output).unwrap();
    let topics: Vec<&str> = result.records().iter().map(|r| r.topic.as_str()).collect();
    for order in ["era-2", "era-4"] {
        for topic in
            ["/model/*/discrete", "/model/*/continuous", "/model/*/transfer-function", "/modes/*", "/identification/*"]
        {
            let topic = topic.replace('*', order);
            assert!(topics.contains(&topic.as_str()), "{topic} is not in {topics:?}");
        }
    }
    assert!(topics.contains(&"/test"));

    let modes: ModesV2 = result.record("/modes/era-4").unwrap().unwrap();
    let poles: Vec<(f64, f64)> = modes.modes.iter().map(|m| (m.re_per_s, m.im_rad_per_s)).collect();
    for (estimated, exact) in poles.iter().zip([(-15.0, 120.0), (-15.0, -120.0), (-40.0, 420.0), (-40.0, -420.0)]) {
        // A clean record: rounding over the sampling interval.
        assert!((estimated.0 - exact.0).abs() < 1e-8 && (estimated.1 - exact.1).abs() < 1e-8, "{poles:?}");
    }
    let transfer: TransferFunctionV1 = result.record("/model/era-4/transfer-function").unwrap().unwrap();
    // (s^2 + 30 s + 14625)(s^2 + 80 s + 178000)
    for (estimated, exact) in transfer.denominator.iter().zip([1.0, 110.0, 195_025.0, 6_510_000.0, 2_603_250_000.0]) {
        assert!((estimated / exact - 1.0).abs() < 1e-8, "{:?}", transfer.denominator);
    }
    let evidence: IdentificationV1 = result.record("/identification/era-4").unwrap().unwrap();
    assert_eq!((evidence.samples, evidence.from_s, evidence.hankel_rows), (2501, 0.0, Some(1250)));
    assert!(evidence.to_s > 0.249_99 && evidence.fit_percent.unwrap() > 99.999_999);
    let discrete: StateSpaceV1 = result.record("/model/era-4/discrete").unwrap().unwrap();
    assert_eq!((discrete.sample_time_s, discrete.d[0][0]), (DT_S, two_modes(0.0)));
    // 420 rad/s is 66.8 Hz: within a factor two of the 100 Hz edge of CFC 60; 120 rad/s is not.
    let notes: NotesV1 = result.record("/notes").unwrap().unwrap();
    let of_the_filter: Vec<&String> = notes.notes.iter().filter(|n| n.contains("edge of the CFC 60")).collect();
    assert!(of_the_filter.iter().any(|n| n.contains("era-4:") && n.contains("67.")), "{:?}", notes.notes);
}

#[test]
fn bytes_do_not_depend_on_the_run_or_the_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let noisy = |t: f64| two_modes(t) + 0.3 * (t * t * 3.7e7).sin();
    let input = artifact(folder.path(), None, noisy);
    let bytes = |threads: &str| {
        let output = folder.path().join(format!("{threads}.mcap"));
        let run = Command::new(env!("CARGO_BIN_EXE_crumple-identify"))
            .args([input.as_os_str(), "-o".as_ref(), output.as_os_str(), "--orders=4,auto".as_ref()])
            .env("RAYON_NUM_THREADS", threads)
            .output()
            .unwrap();
        assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
        std::fs::read(output).unwrap()
    };
    let first = bytes("1");
    assert_eq!(first, bytes("2"));
    assert_eq!(first, bytes("4"));
}

#[test]
fn clean_record_of_lower_rank_is_identified_at_its_rank_with_a_note() {
    let folder = tempfile::tempdir().unwrap();
    let input = artifact(folder.path(), None, |t| -90.0 * (-15.0 * t).exp() * (120.0 * t).cos());
    let output = folder.path().join("4.mcap");
    let run = identify(&input, &output, &[]);
    assert_eq!(run.code, Some(0), "{}", run.said);
    let result = Artifact::open(&output).unwrap();
    let evidence: IdentificationV1 = result.record("/identification/era-2").unwrap().unwrap();
    assert_eq!(evidence.order, 2);
    let notes: NotesV1 = result.record("/notes").unwrap().unwrap();
    assert!(notes.notes.iter().any(|n| n.contains("order 4 exceeds the numerical rank 2")), "{:?}", notes.notes);
}

#[test]
fn window_and_sample_count_are_honoured() {
    let folder = tempfile::tempdir().unwrap();
    let input = artifact(folder.path(), None, two_modes);
    let output = folder.path().join("4.mcap");
    let flags = ["--from", "5ms", "--to", "0.1s", "--samples", "61", "--rows", "25"];
    let run = identify(&input, &output, &flags);
    assert_eq!(run.code, Some(0), "{}", run.said);
    let evidence: IdentificationV1 = Artifact::open(&output).unwrap().record("/identification/era-4").unwrap().unwrap();
    assert!((evidence.from_s - 0.005).abs() < 1e-12 && (evidence.to_s - 0.011).abs() < 1e-12);
    assert_eq!((evidence.samples, evidence.hankel_rows, evidence.hankel_columns), (61, Some(25), Some(35)));
}

#[test]
fn what_cannot_be_done_has_its_own_exit_code_and_reason() {
    let folder = tempfile::tempdir().unwrap();
    let input = artifact(folder.path(), None, two_modes);
    let output = folder.path().join("4.mcap");
    let code = |flags: &[&str]| {
        let run = identify(&input, &output, flags);
        (run.code, run.said)
    };
    let (status, text) = code(&["--methods", "eraa"]);
    assert_eq!(status, Some(2), "{text}");
    assert!(text.contains("invalid value 'eraa'") && text.contains("'era'"), "{text}");
    let (status, text) = code(&["--rows", "2000", "--columns", "2000"]);
    assert_eq!(status, Some(3), "{text}");
    assert!(text.contains("2500 Markov parameters, but a 2000x2000 Hankel pair needs 4000"), "{text}");
    let (status, text) = code(&["--from", "3s"]);
    assert_eq!(status, Some(3), "{text}");
    assert!(text.contains("the record runs from -0.020000 s to 0.250000 s"), "{text}");
    let (status, text) = code(&["--samples", "5"]);
    assert_eq!(status, Some(3), "{text}");
    assert!(text.contains("order 4 needs at least 4 rows and columns"), "{text}");
    let (status, text) = code(&["--from", "20"]);
    assert_eq!(status, Some(2), "{text}");
    assert!(!output.exists());

    let silent = artifact(folder.path(), None, |_| 0.0);
    let run = identify(&silent, &output, &[]);
    assert_eq!(run.code, Some(4), "{}", run.said);
    let diagnosis: DiagnosisV1 = Artifact::open(&output).unwrap().record("/diagnosis").unwrap().unwrap();
    assert!(diagnosis.reason.contains("are zero"), "{}", diagnosis.reason);
}
