//! The program's realisations and subspace models of waveforms of any quantity, one and several together.

use std::path::{Path, PathBuf};

use crumple_artifact::Artifact;
use crumple_artifact::records::{
    EvidenceV1, IdentificationV1, ModesV2, NotesV1, ShapesV1, StabilizationV1, StateSpaceV1,
};
use crumple_signal::{Channel, QuantityKind};
use crumple_sysid::{EraOptions, Order, era};
use crumple_testkit::white_noise;

use crate::program::{Wave, identify, made, written};

const DT_S: f64 = 1e-3;
const POLES: [(f64, f64); 2] = [(-6.0, 50.0), (-9.0, 170.0)];

/// Free motion of two modes on a sensor that sees them with the given sizes.
fn decay(first: f64, second: f64, level: f64, stream: usize, samples: usize) -> Vec<f64> {
    let value = |k: usize| {
        let t = k as f64 * DT_S;
        first * (-6.0 * t).exp() * (50.0 * t).cos() + second * (-9.0 * t).exp() * (170.0 * t + 0.5).cos()
    };
    (0..samples).map(|k| value(k) + level * white_noise(stream, k)).collect()
}

fn artifact(folder: &Path, waves: &[Wave]) -> PathBuf {
    let channels = waves.iter().map(|(id, quantity, _)| Channel::new(*id, *quantity)).collect();
    written(&made(channels, 0.0, DT_S, waves), folder, "ingest")
}

fn run(input: &Path, flags: &[&str]) -> Artifact {
    let output = input.with_file_name("4-identify.mcap");
    let run = identify(input, &output, &[&["--force"], flags].concat());
    assert_eq!(run.code, Some(0), "{flags:?}: {}", run.said);
    Artifact::open(&output).unwrap()
}

/// Largest relative distance of a true pole to the nearest of the model.
fn worst(artifact: &Artifact, id: &str) -> f64 {
    let modes: ModesV2 = artifact.record(&format!("/modes/{id}")).unwrap().unwrap();
    let nearest = |(re, im): &(f64, f64)| {
        let distance = |m: &crumple_artifact::records::ModeV1| (m.re_per_s - re).hypot(m.im_rad_per_s - im);
        modes.modes.iter().map(distance).fold(f64::INFINITY, f64::min) / re.hypot(*im)
    };
    POLES.iter().map(nearest).fold(0.0, f64::max)
}

#[test]
fn any_quantity_is_realised_by_name_and_keeps_its_unit() {
    let folder = tempfile::tempdir().unwrap();
    let waves = [
        ("y", QuantityKind::Voltage, decay(3.0, 2.0, 0.0, 0, 501)),
        ("93/displacement", QuantityKind::Displacement, decay(0.4, -0.3, 0.0, 0, 501)),
    ];
    let input = artifact(folder.path(), &waves);
    for (flag, output) in [
        ("--channel=y", "voltage y, V"),
        ("--channels=y", "voltage y, V"),
        ("--outputs=y", "voltage y, V"),
        ("--outputs=93/displacement", "displacement 93/displacement, m"),
        ("--output-channel=93/displacement", "displacement 93/displacement, m"),
    ] {
        let result = run(&input, &["--methods=era", "--orders=4", flag]);
        let id = "era-4";
        // A clean record; correlations square the condition.
        assert!(worst(&result, id) < 1e-8, "{flag} {id}: {:e}", worst(&result, id));
        let model: StateSpaceV1 = result.record(&format!("/model/{id}/discrete")).unwrap().unwrap();
        assert_eq!(model.output, output, "{flag}");
    }
    let result = run(&input, &["--methods=n4sid", "--orders=4", "--inputs=none", "--outputs=y,93/displacement"]);
    let model: StateSpaceV1 = result.record("/model/n4sid-4/discrete").unwrap().unwrap();
    assert_eq!(model.output, "voltage y, V; displacement 93/displacement, m");
}

#[test]
fn a_record_without_a_pulse_is_asked_for_inputs_and_outputs() {
    let folder = tempfile::tempdir().unwrap();
    let silent = |id| (id, QuantityKind::Voltage, decay(1.0, 1.0, 0.0, 0, 301));
    let input = artifact(folder.path(), &[silent("a"), silent("b")]);
    for (method, named) in [("era", "--outputs"), ("okid", "--inputs"), ("n4sid", "--inputs")] {
        let refused = identify(&input, &input.with_file_name("4-identify.mcap"), &["--methods", method]);
        let told = refused.said;
        assert_eq!(refused.code, Some(3), "{told}");
        assert!(told.contains(named) && told.contains("--outputs") && !told.contains("--channel"), "{told}");
    }
}

#[test]
fn quantities_of_very_different_sizes_are_realised_together() {
    let folder = tempfile::tempdir().unwrap();
    // Accelerations of hundreds, a displacement of tenths of a millimetre that shows the second mode alone.
    let waves = [
        ("a", QuantityKind::Acceleration, decay(300.0, 0.0, 0.0, 0, 501)),
        ("x", QuantityKind::Displacement, decay(0.0, 1e-4, 0.0, 0, 501)),
    ];
    let input = artifact(folder.path(), &waves);
    let result = run(&input, &["--methods=era", "--outputs=a,x", "--orders=4"]);
    let id = "era-4";
    assert!(worst(&result, id) < 1e-8, "{id}: {:e}", worst(&result, id));
    let model: StateSpaceV1 = result.record(&format!("/model/{id}/discrete")).unwrap().unwrap();
    assert_eq!(model.output, "acceleration a, m/s^2; displacement x, m");
    let identification: IdentificationV1 = result.record(&format!("/identification/{id}")).unwrap().unwrap();
    assert!(identification.output_fits_percent.iter().all(|fit| fit.unwrap() > 99.9999), "{identification:?}");
    // Losses have units: each output has evidence of its own, of the model in its own unit.
    for (number, waves) in waves.iter().enumerate() {
        let evidence: EvidenceV1 = result.record(&format!("/evidence/{id}/{}", number + 1)).unwrap().unwrap();
        let square = waves.2.iter().map(|y| y * y).sum::<f64>() / 501.0;
        assert!(evidence.output == waves.0 && evidence.loss.unwrap() < 1e-12 * square, "{evidence:?}");
    }
}

/// Three sensors of two modes with shapes (1, -0.5, 0.25) and (0.3, 1, -0.8).
fn sensors(level: f64) -> Vec<(&'static str, QuantityKind, Vec<f64>)> {
    [("11", 1.0, 0.3), ("12", -0.5, 1.0), ("13", 0.25, -0.8)]
        .into_iter()
        .enumerate()
        .map(|(stream, (id, first, second))| {
            (id, QuantityKind::Acceleration, decay(100.0 * first, 80.0 * second, level, stream, 501))
        })
        .collect()
}

#[test]
fn several_channels_have_a_stabilisation_diagram() {
    let folder = tempfile::tempdir().unwrap();
    let input = artifact(folder.path(), &sensors(1.0));
    let method = "era";
    let flags = ["--methods", method, "--channels=11,12,13", "--orders=4", "--max-order=12", "--stabilisation"];
    let result = run(&input, &flags);
    let diagram: StabilizationV1 = result.record(&format!("/stabilisation/{method}")).unwrap().unwrap();
    assert!(diagram.shape_change.is_some() && diagram.channel == "11, 12, 13", "{diagram:?}");
    assert!(diagram.poles.iter().any(|pole| pole.stability == "all"), "{diagram:?}");
    for (re, im) in POLES {
        let frequency = re.hypot(im);
        let near = |w: f64| (w / frequency - 1.0).abs() < 0.01;
        assert!(diagram.clusters.iter().any(|c| near(c.natural_frequency_rad_per_s)), "{method}: {diagram:?}");
    }
}

/// One input, three outputs with noise: the response of the sensors' modes to a random force.
fn driven() -> Vec<(&'static str, QuantityKind, Vec<f64>)> {
    let samples = 801;
    let u: Vec<f64> = (0..samples).map(|k| white_noise(7, k / 2)).collect();
    let mut waves = vec![("u", QuantityKind::Force, u.clone())];
    for (stream, (id, _, markov)) in sensors(0.0).into_iter().enumerate() {
        let convolved = |k: usize| (1..=k.min(500)).map(|lag| markov[lag] * u[k - lag]).sum::<f64>();
        let y: Vec<f64> = (0..samples).map(convolved).collect();
        let size = (y.iter().map(|y| y * y).sum::<f64>() / samples as f64).sqrt();
        let noisy = y.iter().enumerate().map(|(k, y)| y + 0.02 * size * white_noise(20 + stream, k)).collect();
        waves.push((id, QuantityKind::Acceleration, noisy));
    }
    waves
}

#[test]
fn models_of_several_outputs_have_shapes_and_standard_deviations() {
    let folder = tempfile::tempdir().unwrap();
    let free = artifact(folder.path(), &sensors(1.0));
    let check = |result: &Artifact, id: &str, evidence: &str| {
        let shapes: ShapesV1 = result.record(&format!("/shapes/{id}")).unwrap().unwrap();
        assert_eq!((shapes.channels.join(","), shapes.shapes.len()), ("11,12,13".to_owned(), 2), "{id}");
        for (estimated, exact) in shapes.shapes.iter().zip([[1.0, -0.5, 0.25], [0.3, 1.0, -0.8]]) {
            for (entry, exact) in estimated.re.iter().zip(exact) {
                // Noise of 1 to 2 % of the channels, averaged over hundreds of samples.
                assert!((entry - exact).abs() < 0.03, "{id}: {shapes:?}");
            }
        }
        let evidence: EvidenceV1 = result.record(&format!("/evidence/{evidence}")).unwrap().unwrap();
        assert_eq!(evidence.bootstrap_replicates, Some(20), "{id}");
        let modes: ModesV2 = result.record(&format!("/modes/{id}")).unwrap().unwrap();
        for (mode, spread) in modes.modes.iter().zip(&evidence.frequency_spreads) {
            let (frequency, spread) = (mode.natural_frequency_rad_per_s, spread.as_ref().unwrap());
            // The truth is within 5 standard deviations of the estimate; 20 replicates know theirs to 16 %.
            let exact =
                POLES.iter().map(|(re, im)| re.hypot(*im)).min_by_key(|w| (w - frequency).abs() as u64).unwrap();
            assert!(spread.deviation > 0.0 && spread.deviation < 0.01 * exact, "{id}: {spread:?}");
            assert!((frequency - exact).abs() < 5.0 * spread.deviation, "{id}: {frequency} {exact} {spread:?}");
        }
    };
    let flags = ["--methods=era", "--channels=11,12,13", "--orders=4", "--bootstrap=20"];
    let result = run(&free, &flags);
    for output in 1..=3 {
        check(&result, "era-4", &format!("era-4/{output}"));
    }
    let driven = artifact(folder.path(), &driven());
    let methods = "--methods=okid,n4sid,moesp,cva";
    let result = run(&driven, &[methods, "--inputs=u", "--outputs=11,12,13", "--orders=4", "--bootstrap=20"]);
    for method in ["okid", "n4sid", "moesp", "cva"] {
        let id = format!("{method}-4");
        for output in 1..=3 {
            check(&result, &id, &format!("{id}/{output}"));
        }
    }
    let notes: NotesV1 = result.record("/notes").unwrap().unwrap();
    assert!(!notes.notes.iter().any(|n| n.contains("no bootstrap")), "{:?}", notes.notes);
}

#[test]
fn the_horizon_of_a_subspace_model_is_chosen_and_told() {
    let folder = tempfile::tempdir().unwrap();
    let input = artifact(folder.path(), &driven());
    let of = |flags: &[&str]| {
        let mut all = vec!["--methods=n4sid", "--inputs=u", "--outputs=11,12", "--orders=4"];
        all.extend(flags);
        let identification: IdentificationV1 = run(&input, &all).record("/identification/n4sid-4").unwrap().unwrap();
        identification
    };
    let chosen = of(&[]);
    let rows = chosen.hankel_rows.unwrap() / 2;
    assert!(rows >= 10, "{chosen:?}");
    let told = format!("horizon of {rows} block rows");
    assert!(chosen.notes.iter().any(|note| note.contains(&told)), "{chosen:?}");
    let given = of(&["--block-rows=17"]);
    assert_eq!(given.hankel_rows, Some(34));
    assert!(!given.notes.iter().any(|note| note.contains("horizon of")), "{given:?}");
}

#[test]
fn missing_standard_deviations_have_a_reason() {
    let folder = tempfile::tempdir().unwrap();
    let input = artifact(folder.path(), &driven());
    let result = run(&input, &["--methods=okid,n4sid,cva,arx", "--inputs=u", "--outputs=11", "--orders=4"]);
    for method in ["okid", "n4sid", "cva"] {
        let identification: IdentificationV1 = result.record(&format!("/identification/{method}-4")).unwrap().unwrap();
        assert!(
            identification.notes.iter().any(|n| n.contains("no standard deviations") && n.contains("--bootstrap")),
            "{identification:?}"
        );
    }
    let identification: IdentificationV1 = result.record("/identification/arx-4").unwrap().unwrap();
    assert!(!identification.notes.iter().any(|n| n.contains("no standard deviations")), "{identification:?}");
}

#[test]
fn the_paper_s_realisations_are_those_of_its_samples() {
    let folder = tempfile::tempdir().unwrap();
    let record = decay(200.0, 120.0, 0.5, 3, 2600);
    let input = artifact(folder.path(), &[("93", QuantityKind::Acceleration, record.clone())]);
    let result = run(&input, &["--paper=era"]);
    for (order, samples) in [(2, 100), (2, 50), (4, 60), (4, 2501)] {
        let id = format!("era-{order}-n{samples}-paper");
        let identification: IdentificationV1 = result.record(&format!("/identification/{id}")).unwrap().unwrap();
        let half = (samples as u32 - 1) / 2;
        assert_eq!(
            (identification.samples, identification.hankel_rows, identification.hankel_columns),
            (samples as u64, Some(half), Some(half))
        );
        let exact =
            era(&record[..samples], EraOptions { order: Order::Given(order), ..EraOptions::new(DT_S) }).unwrap();
        let model: StateSpaceV1 = result.record(&format!("/model/{id}/discrete")).unwrap().unwrap();
        // The same computation.
        assert_eq!((model.d[0][0], model.a[0][0]), (record[0], exact.discrete.a[(0, 0)]), "{id}");
        let evidence: EvidenceV1 = result.record(&format!("/evidence/{id}")).unwrap().unwrap();
        assert_eq!(evidence.paper.as_deref(), Some("era"));
    }
    // Of a window shorter than two of the runs, one remains.
    let result = run(&input, &["--paper=era", "--to=39ms"]);
    let ids: Vec<String> =
        result.records().iter().map(|r| r.topic.clone()).filter(|t| t.starts_with("/identification/")).collect();
    assert_eq!(ids, ["/identification/era-2-n40-paper", "/identification/era-4-n40-paper"]);
}
