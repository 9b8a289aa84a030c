//! The program with the methods that take an input and an output.

use std::path::{Path, PathBuf};
use std::process::Command;

use crumple_artifact::Artifact;
use crumple_artifact::records::{
    EvidenceV1, ExponentialSumV1, IdentificationV1, ModesV2, NotesV1, StateSpaceV1, TransferFunctionV1,
};
use crumple_signal::{Channel, QuantityKind};

use crate::program::{identify, made, written};

const DT_S: f64 = 5e-4;

/// A pulse, and as "displacement" the answer of an oscillator (6 Hz, damping ratio 0.2) to it that starts at 10 m/s.
fn artifact(folder: &Path, noise_m: f64) -> PathBuf {
    let (w, zeta) = (2.0 * std::f64::consts::PI * 6.0, 0.2);
    let mut channel = Channel::new("93", QuantityKind::Acceleration);
    channel.cfc = Some(60);
    let pulse = |t: f64| if (0.0..0.1).contains(&t) { -250.0 * (std::f64::consts::PI * t / 0.1).sin() } else { 0.0 };
    let (mut x, mut v) = (0.0, 10.0);
    let (mut a, mut s, mut r) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..501 {
        let t = f64::from(k) * DT_S;
        a.push(pulse(t));
        s.push(x + noise_m * (f64::from(k * k) * 0.37).sin());
        r.push(v);
        // Fourth-order Runge-Kutta, eight steps a sample.
        for step in 0..8 {
            let h = DT_S / 8.0;
            let f = |t: f64, x: f64, v: f64| (v, -2.0 * zeta * w * v - w * w * x + pulse(t));
            let t = t + f64::from(step) * h;
            let (x1, v1) = f(t, x, v);
            let (x2, v2) = f(t + h / 2.0, x + h / 2.0 * x1, v + h / 2.0 * v1);
            let (x3, v3) = f(t + h / 2.0, x + h / 2.0 * x2, v + h / 2.0 * v2);
            let (x4, v4) = f(t + h, x + h * x3, v + h * v3);
            x += h / 6.0 * (x1 + 2.0 * x2 + 2.0 * x3 + x4);
            v += h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
        }
    }
    let waves = [
        ("93", QuantityKind::Acceleration, a),
        ("93/displacement", QuantityKind::Displacement, s),
        ("93/velocity", QuantityKind::Velocity, r),
    ];
    written(&made(vec![channel], 0.0, DT_S, &waves), folder, "integrate")
}

#[test]
fn tfest_gives_the_oscillator_with_deviations_and_evidence() {
    let folder = tempfile::tempdir().unwrap();
    let input = artifact(folder.path(), 1e-4);
    let output = folder.path().join("4.mcap");
    let run = identify(&input, &output, &["--methods", "tfest", "--poles", "2", "--zeros", "0"]);
    assert_eq!(run.code, Some(0), "{}", run.said);
    let result = Artifact::open(&output).unwrap();
    let tf: TransferFunctionV1 = result.record("/model/tfest-2-0/transfer-function").unwrap().unwrap();
    let modes: ModesV2 = result.record("/modes/tfest-2-0").unwrap().unwrap();
    let evidence: EvidenceV1 = result.record("/evidence/tfest-2-0").unwrap().unwrap();
    let identification: IdentificationV1 = result.record("/identification/tfest-2-0").unwrap().unwrap();
    let frequency = modes.modes[0].natural_frequency_rad_per_s;
    let deviation = evidence.frequency_deviations[0].unwrap();
    // Four deviations, and what straight lines between samples of a half sine leave.
    assert!((frequency - 37.699).abs() < 4.0 * deviation + 1e-3, "{frequency} +- {deviation}");
    assert!((modes.modes[0].damping_ratio.unwrap() - 0.2).abs() < 4.0 * evidence.damping_deviations[0].unwrap() + 1e-4);
    assert!((tf.numerator[0] - 1.0).abs() < 4.0 * evidence.numerator_deviations[0] + 1e-3, "{tf:?}");
    assert!(tf.input.contains("acceleration 93") && tf.output.contains("displacement 93/displacement"), "{tf:?}");
    assert!(identification.fit_percent.unwrap() > 99.9 && identification.treated_as == "input-output");
    assert_eq!(evidence.hold.as_deref(), Some("first-order"));
    assert!(evidence.stop_reason.is_some() && evidence.effective_samples.unwrap() > 100.0);
}

#[test]
fn discrete_methods_and_exponentials_write_their_models() {
    let folder = tempfile::tempdir().unwrap();
    let input = artifact(folder.path(), 0.0);
    let output = folder.path().join("4.mcap");
    let flags =
        ["--methods=era,arx,exponentials", "--orders=2", "--terms=2", "--conditions=position,velocity", "--from=0.1s"];
    let run = identify(&input, &output, &flags);
    assert_eq!(run.code, Some(0), "{}", run.said);
    let result = Artifact::open(&output).unwrap();
    let sum: ExponentialSumV1 = result.record("/model/exponentials-2").unwrap().unwrap();
    // Without an input that moves arx has nothing to go by, which takes nothing from the others.
    let notes: NotesV1 = result.record("/notes").unwrap().unwrap();
    assert!(notes.notes.iter().any(|n| n.contains("arx gave no model: ")), "{:?}", notes.notes);
    // After the pulse the oscillator is free: -7.54 +- 36.94i.
    assert!((sum.terms[0].re_per_s + 0.2 * 37.699).abs() < 1e-2, "{sum:?}");
    let run = identify(
        &input,
        &output,
        &["--methods=n4sid,moesp,cva,arx,output-error", "--orders=2", "--block-rows=20", "--force"],
    );
    assert_eq!(run.code, Some(0), "{}", run.said);
    let result = Artifact::open(&output).unwrap();
    for method in ["moesp-2", "output-error-2"] {
        let model: StateSpaceV1 = result.record(&format!("/model/{method}/discrete")).unwrap().unwrap();
        assert_eq!((model.a.len(), model.sample_time_s), (2, DT_S));
        let identification: IdentificationV1 = result.record(&format!("/identification/{method}")).unwrap().unwrap();
        // A held input is not what drove it: half a sample of delay is left, of a pulse of 200 samples.
        assert!(identification.fit_percent.unwrap() > 99.0, "{method}: {:?}", identification.fit_percent);
    }
    let evidence: EvidenceV1 = result.record("/evidence/arx-2").unwrap().unwrap();
    assert!(evidence.prediction_fit_percent.unwrap() > 99.0);
}

#[test]
fn acceleration_to_displacement_of_one_body_is_called_what_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let a: Vec<f64> = (0..400).map(|k| -200.0 * (f64::from(k) * 0.012).sin().max(0.0)).collect();
    let (mut v, mut x, mut s) = (15.0, 0.0, vec![0.0]);
    for pair in a.windows(2) {
        x += DT_S * v + DT_S * DT_S * (pair[0] / 3.0 + pair[1] / 6.0);
        v += DT_S * 0.5 * (pair[0] + pair[1]);
        s.push(x);
    }
    let waves = [("93", QuantityKind::Acceleration, a), ("93/displacement", QuantityKind::Displacement, s)];
    let channel = Channel::new("93", QuantityKind::Acceleration);
    let path = written(&made(vec![channel], 0.0, DT_S, &waves), folder.path(), "integrate");
    let output = folder.path().join("4.mcap");
    let run = identify(&path, &output, &["--methods=tfest", "--poles=2", "--zeros=0"]);
    assert_eq!(run.code, Some(0), "{}", run.said);
    let notes: NotesV1 = Artifact::open(&output).unwrap().record("/notes").unwrap().unwrap();
    assert!(notes.notes.iter().any(|n| n.contains("true of any body")), "{:?}", notes.notes);
    // Noise parts the two poles; which of them grows says nothing.
    assert!(!notes.notes.iter().any(|n| n.contains("grows")), "{:?}", notes.notes);
}

#[test]
fn bytes_do_not_depend_on_the_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let input = artifact(folder.path(), 1e-4);
    let bytes = |threads: &str| {
        let output = folder.path().join(format!("{threads}.mcap"));
        let run = Command::new(env!("CARGO_BIN_EXE_crumple-identify"))
            .arg(&input)
            .args(["-o".as_ref(), output.as_os_str()])
            .args(["--methods=tfest,exponentials,n4sid,output-error", "--orders=2,4", "--poles=3"])
            .env("RAYON_NUM_THREADS", threads)
            .output()
            .unwrap();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        std::fs::read(output).unwrap()
    };
    let one = bytes("1");
    assert!(one == bytes("2") && one == bytes("4"));
}

#[test]
fn what_cannot_be_done_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let input = artifact(folder.path(), 0.0);
    let output = folder.path().join("4.mcap");
    for (flags, code, text) in [
        (vec!["--methods=tfest", "--zeros=5"], 3, "5 zeros and 4 poles"),
        (vec!["--methods=tfest", "--hold=second"], 2, "invalid value 'second' for '--hold"),
        (vec!["--methods=tfest", "--starts=svff"], 2, "invalid value 'svff' for '--starts"),
        (vec!["--methods=tfest", "--output-channel=94/displacement"], 3, "there is no waveform \"94/displacement\""),
        (vec!["--methods=exponentials", "--conditions=velocity"], 2, "stands before \"position\""),
        (vec!["--methods=n4sid", "--samples=30"], 3, "n4sid needs"),
    ] {
        let run = identify(&input, &output, &flags);
        assert_eq!(run.code, Some(code), "{flags:?}: {}", run.said);
        assert!(run.said.contains(text), "{flags:?}: {}", run.said);
    }
}
