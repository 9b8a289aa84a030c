//! The program with the methods that go through Markov parameters.

use std::path::{Path, PathBuf};

use crumple_artifact::Artifact;
use crumple_artifact::records::{
    DiagnosisV1, EventsV1, EvidenceV1, IdentificationV1, ModesV2, NotesV1, ShapesV1, StateSpaceV1,
};
use crumple_signal::{Channel, QuantityKind};

use crate::program::{Wave, identify, made, written};

const DT_S: f64 = 1e-3;

/// Accelerations, sampled together from `t0_s` on, as an artifact; the first is the pulse.
fn artifact(folder: &Path, dt_s: f64, waves: &[Wave], events: Option<EventsV1>) -> PathBuf {
    let channels = waves.iter().map(|(id, quantity, _)| Channel::new(*id, *quantity)).collect();
    let mut builder = made(channels, 0.0, dt_s, waves);
    if let Some(events) = events {
        builder.put("/events", &events).unwrap();
    }
    written(&builder, folder, "integrate")
}

fn run(input: &Path, flags: &[&str]) -> Artifact {
    let output = input.with_file_name("4-identify.mcap");
    let mut all = vec!["--force"];
    all.extend(flags);
    let run = identify(input, &output, &all);
    assert_eq!(run.code, Some(0), "{}", run.said);
    Artifact::open(&output).unwrap()
}

fn poles(artifact: &Artifact, id: &str) -> Vec<(f64, f64)> {
    let modes: ModesV2 = artifact.record(&format!("/modes/{id}")).unwrap().unwrap();
    modes.modes.iter().map(|m| (m.re_per_s, m.im_rad_per_s)).collect()
}

fn assert_poles(estimated: &[(f64, f64)], exact: &[(f64, f64)], tolerance: f64) {
    for (re, im) in exact {
        let nearest = estimated.iter().map(|f| (f.0 - re).hypot(f.1 - im)).fold(f64::INFINITY, f64::min);
        assert!(nearest < tolerance * re.hypot(*im), "{re} {im}: {estimated:?}");
    }
}

/// Two modes with shapes (1, -0.5, 0.25) and (0.3, 1, -0.8).
fn sensors(level: f64) -> Vec<(&'static str, QuantityKind, Vec<f64>)> {
    let shapes = [("11", 1.0, 0.3), ("12", -0.5, 1.0), ("13", 0.25, -0.8)];
    let noise = |stream: usize, k: usize| ((k * k) as f64 * 0.37 + stream as f64).sin();
    shapes
        .iter()
        .enumerate()
        .map(|(stream, (id, first, second))| {
            let samples = (0..501)
                .map(|k| {
                    let t = k as f64 * DT_S;
                    100.0 * first * (-6.0 * t).exp() * (50.0 * t).cos()
                        + 80.0 * second * (-9.0 * t).exp() * (170.0 * t + 0.5).cos()
                        + level * noise(stream, k)
                })
                .collect();
            (*id, QuantityKind::Acceleration, samples)
        })
        .collect()
}

const SENSOR_POLES: [(f64, f64); 2] = [(-6.0, 50.0), (-9.0, 170.0)];

#[test]
fn several_channels_give_one_model_with_shapes() {
    let folder = tempfile::tempdir().unwrap();
    let input = artifact(folder.path(), DT_S, &sensors(0.0), None);
    let result = run(&input, &["--methods=era", "--channels=11,12,13", "--orders=4"]);
    let id = "era-4";
    assert_poles(&poles(&result, id), &SENSOR_POLES, 1e-9);
    let shapes: ShapesV1 = result.record(&format!("/shapes/{id}")).unwrap().unwrap();
    assert_eq!((shapes.channels.len(), shapes.shapes.len()), (3, 2));
    for (estimated, exact) in shapes.shapes.iter().zip([[1.0, -0.5, 0.25], [0.3, 1.0, -0.8]]) {
        for (entry, exact) in estimated.re.iter().zip(exact) {
            assert!((entry - exact).abs() < 1e-6, "{shapes:?}");
        }
        assert!(estimated.phase_collinearity.unwrap() > 1.0 - 1e-6);
    }
    assert!((shapes.modal_assurance[0][0] - 1.0).abs() < 1e-12 && shapes.modal_assurance[0][1] < 0.2);
    let identification: IdentificationV1 = result.record(&format!("/identification/{id}")).unwrap().unwrap();
    assert!(identification.fit_percent.unwrap() > 99.999 && identification.channel == "11, 12, 13");
    let model: StateSpaceV1 = result.record(&format!("/model/{id}/discrete")).unwrap().unwrap();
    assert_eq!((model.c.len(), model.b[0].len()), (3, 1));
}

#[test]
fn options_of_the_realisation_reach_it() {
    let folder = tempfile::tempdir().unwrap();
    let input = artifact(folder.path(), DT_S, &sensors(0.5), None);
    let mut all = Vec::new();
    for flags in [
        &["--methods=era"][..],
        &["--methods=era", "--rows=60"],
        &["--methods=era", "--rows=60", "--columns=80"],
        &["--methods=era", "--hankel-size=twice-order"],
    ] {
        let mut flags = flags.to_vec();
        flags.push("--channel=11");
        let result = run(&input, &flags);
        let estimated = poles(&result, "era-4");
        if !flags[1].starts_with("--hankel-size") {
            // Noise of half a percent of the first mode; the second is four times weaker here.
            assert_poles(&estimated, &SENSOR_POLES, 0.03);
        }
        all.push(estimated);
    }
    for (i, a) in all.iter().enumerate() {
        assert!(all[..i].iter().all(|b| b != a), "the options of run {i} change nothing");
    }
    let result = run(&input, &["--methods=era", "--hankel-size=twice-order", "--orders=2,4", "--channel=11"]);
    for (id, rows) in [("era-2", 4), ("era-4", 8)] {
        let record: IdentificationV1 = result.record(&format!("/identification/{id}")).unwrap().unwrap();
        assert_eq!((record.hankel_rows, record.hankel_columns), (Some(rows), Some(rows)));
    }
}

/// A pulse of 80 ms, and the answer of an oscillator (-8 +- 60i) to it, which goes on alone. Both as accelerations.
fn driven() -> Vec<(&'static str, QuantityKind, Vec<f64>)> {
    let pulse = |t: f64| if t < 0.08 { -200.0 * (std::f64::consts::PI * t / 0.08).sin() } else { 0.0 };
    let (w2, d) = (60.0_f64.powi(2) + 64.0, 16.0);
    let (mut x, mut v) = (0.0, 0.0);
    let (mut drive, mut answer) = (Vec::new(), Vec::new());
    for k in 0..601 {
        let t = f64::from(k) * DT_S;
        drive.push(pulse(t));
        answer.push(-d * v - w2 * x + pulse(t));
        // Fourth-order Runge-Kutta, eight steps a sample.
        for step in 0..8 {
            let h = DT_S / 8.0;
            let f = |t: f64, x: f64, v: f64| (v, -d * v - w2 * x + pulse(t));
            let t = t + f64::from(step) * h;
            let (x1, v1) = f(t, x, v);
            let (x2, v2) = f(t + h / 2.0, x + h / 2.0 * x1, v + h / 2.0 * v1);
            let (x3, v3) = f(t + h / 2.0, x + h / 2.0 * x2, v + h / 2.0 * v2);
            let (x4, v4) = f(t + h, x + h * x3, v + h * v3);
            x += h / 6.0 * (x1 + 2.0 * x2 + 2.0 * x3 + x4);
            v += h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
        }
    }
    vec![("93", QuantityKind::Acceleration, drive), ("95", QuantityKind::Acceleration, answer)]
}

#[test]
fn a_free_decay_is_identified_after_the_contact() {
    let folder = tempfile::tempdir().unwrap();
    let events = EventsV1 {
        channel: "93".to_owned(),
        time_zero_rule: "file".to_owned(),
        time_of_rebound_s: Some(0.08),
        ..EventsV1::default()
    };
    let input = artifact(folder.path(), DT_S, &driven(), Some(events));
    let exact = [(-8.0, 60.0)];
    for (flag, from_s) in [("--free-decay=separation", 0.08), ("--free-decay=1e-9%", 0.08), ("--free-decay=20%", 0.075)]
    {
        let result = run(&input, &["--channel=95", "--orders=2", flag]);
        let record: IdentificationV1 = result.record("/identification/era-2").unwrap().unwrap();
        assert!((record.from_s - from_s).abs() < 1.01 * DT_S, "{flag}: {}", record.from_s);
        assert_eq!(record.treated_as, "free-decay");
        // Free from the first sample on, an exponential to the accuracy of the integration; else 5 ms are still driven.
        assert_poles(&poles(&result, "era-2"), &exact, if from_s == 0.08 { 1e-5 } else { 0.02 });
        let notes: NotesV1 = result.record("/notes").unwrap().unwrap();
        assert!(notes.notes.iter().any(|n| n.contains("free decay from 0.0")), "{:?}", notes.notes);
    }
    // From time zero on the pulse is taken for part of the motion.
    let whole = poles(&run(&input, &["--channel=95", "--orders=2"]), "era-2");
    assert!((whole[0].0 + 8.0).hypot(whole[0].1.abs() - 60.0) > 3.0, "{whole:?}");
    let other = tempfile::tempdir().unwrap();
    let without = artifact(other.path(), DT_S, &driven(), None);
    let refused = identify(&without, &folder.path().join("x.mcap"), &["--free-decay=separation"]);
    assert_eq!(refused.code, Some(3), "{}", refused.said);
}

#[test]
fn okid_writes_its_models() {
    let folder = tempfile::tempdir().unwrap();
    // A drive that excites: sums of products of sines of incommensurate rates are nearly white.
    let noise = |stream: f64, k: usize| ((k * k) as f64 * 0.37 + stream).sin();
    let u: Vec<f64> = (0..1500).map(|k| 100.0 * noise(0.0, k)).collect();
    let mut y = vec![0.0; 1500];
    for k in 2..1500 {
        y[k] = 1.7 * y[k - 1] - 0.8 * y[k - 2] + 0.1 * u[k - 1] + 0.05 * u[k - 2];
    }
    let measured = y.iter().enumerate().map(|(k, y)| y + 0.5 * noise(1.0, 3 * k + 7)).collect();
    let waves = [("93", QuantityKind::Acceleration, u), ("95", QuantityKind::Acceleration, measured)];
    let input = artifact(folder.path(), DT_S, &waves, None);
    let flags = ["--input-channel=93", "--output-channel=95", "--orders=2", "--methods=okid"];
    let result = run(&input, &flags);
    let id = "okid-2";
    let model: StateSpaceV1 = result.record(&format!("/model/{id}/discrete")).unwrap().unwrap();
    let estimated = nalgebra::dmatrix![model.a[0][0], model.a[0][1]; model.a[1][0], model.a[1][1]];
    // z^2 - 1.7 z + 0.8, in one percent of noise.
    assert!(
        (estimated.trace() - 1.7).abs() < 0.01 && (estimated.determinant() - 0.8).abs() < 0.01,
        "{id}: {estimated}"
    );
    let record: IdentificationV1 = result.record(&format!("/identification/{id}")).unwrap().unwrap();
    assert!(record.fit_percent.unwrap() > 90.0, "{id}: {:?}", record.fit_percent);
    println!("{id}: {:?} {:?}", record.fit_percent, record.notes);
    let predictor: StateSpaceV1 = result.record("/model/okid-2/predictor").unwrap().unwrap();
    assert_eq!(predictor.b[0].len(), 2);
    let evidence: EvidenceV1 = result.record("/evidence/okid-2").unwrap().unwrap();
    assert!(evidence.prediction_fit_percent.is_some());
}

#[test]
fn a_diverging_observer_is_a_diagnosis() {
    let folder = tempfile::tempdir().unwrap();
    let u: Vec<f64> = (0..300).map(|k| f64::from(k * k).sin()).collect();
    let mut y = vec![0.0; 300];
    for k in 1..300 {
        y[k] = 1.05 * y[k - 1] + u[k - 1];
    }
    let waves = [("93", QuantityKind::Acceleration, u), ("95", QuantityKind::Acceleration, y)];
    let input = artifact(folder.path(), DT_S, &waves, None);
    let output = folder.path().join("4.mcap");
    let flags = ["--methods=okid", "--lags=2", "--input-channel=93", "--output-channel=95", "--orders=1"];
    let run = identify(&input, &output, &flags);
    assert_eq!(run.code, Some(4), "{}", run.said);
    let result = Artifact::open(&output).unwrap();
    let diagnosis: DiagnosisV1 = result.record("/diagnosis").unwrap().unwrap();
    assert!(format!("{diagnosis:?}").contains("okid_diverged"), "{diagnosis:?}");
    assert!(result.records().iter().all(|record| !record.topic.starts_with("/model/")));
}

#[test]
fn the_sizes_of_the_papers_run_on_known_truth() {
    let Some(folder) = std::env::var_os("CRUMPLE_KNOWN_TRUTH")
        .map(PathBuf::from)
        .or_else(|| crumple_testkit::shared("reference/known-truth"))
    else {
        return;
    };
    // N of the papers, and what a record so short allows: two modes need their own time.
    for (name, order, samples, tolerance) in [
        ("era-2state", "2", "50", 1e-9),
        ("era-2state", "2", "60", 1e-9),
        ("era-2state", "2", "100", 1e-9),
        ("era-2state", "2", "2501", 1e-9),
        ("era-4state", "4", "50", 1e-9),
        ("era-4state", "4", "60", 1e-9),
        ("era-4state", "4", "100", 1e-9),
        ("era-4state", "4", "2501", 1e-9),
    ] {
        let csv = std::fs::read_to_string(folder.join(name).join("accel.csv")).unwrap();
        let record: Vec<f64> = csv
            .lines()
            .filter_map(|line| {
                let (time, a) = line.split_once(',')?;
                (time.parse::<f64>().ok()? > -5e-5).then(|| a.parse::<f64>().unwrap())
            })
            .collect();
        let truth = std::fs::read_to_string(folder.join(name).join("truth.json")).unwrap();
        let truth: serde_json::Value = serde_json::from_str(&truth).unwrap();
        let exact: Vec<(f64, f64)> = truth["expected"]["poles"]
            .as_array()
            .unwrap()
            .iter()
            .map(|p| (p["re"].as_f64().unwrap(), p["im"].as_f64().unwrap()))
            .collect();
        let temporary = tempfile::tempdir().unwrap();
        let input = artifact(temporary.path(), 1e-4, &[("93", QuantityKind::Acceleration, record)], None);
        let result = run(&input, &["--samples", samples, "--orders", order]);
        let record: IdentificationV1 = result.record(&format!("/identification/era-{order}")).unwrap().unwrap();
        assert_eq!(record.samples.to_string(), samples);
        assert_poles(&poles(&result, &format!("era-{order}")), &exact, tolerance);
    }
}
