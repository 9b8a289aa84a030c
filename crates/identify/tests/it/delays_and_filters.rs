//! The program on records with a late input, a filter that is no class, and a level of their own.

use std::f64::consts::{PI, TAU};
use std::path::{Path, PathBuf};

use crumple_artifact::Artifact;
use crumple_artifact::records::{
    ChannelFilterV1, EvidenceV1, IdentificationV1, NotesV1, ResponseV1, StateSpaceV1, TransferFunctionV1,
};
use crumple_signal::{Channel, QuantityKind};
use crumple_testkit::uniform;

use crate::program::{Wave, identify, made, written};

const DT_S: f64 = 0.01;

fn artifact(folder: &Path, waves: &[Wave], filter: Option<&ChannelFilterV1>) -> PathBuf {
    let channels = waves.iter().map(|(id, quantity, _)| Channel::new(*id, *quantity)).collect();
    let mut builder = made(channels, 0.0, DT_S, waves);
    if let Some(filter) = filter {
        builder.put(&format!("/filter/{}", waves[0].0), filter).unwrap();
    }
    written(&builder, folder, "filter")
}

fn run(input: &Path, flags: &[&str]) -> Artifact {
    let run = identify(input, &input.with_file_name("4.mcap"), &[&["--force"], flags].concat());
    assert_eq!(run.code, Some(0), "{}", run.said);
    Artifact::open(&input.with_file_name("4.mcap")).unwrap()
}

fn random(k: usize) -> f64 {
    uniform(k as u64)
}

/// `y' = -5 y + 10 u(t - late)`, `u` in steps, both above a level.
fn lagged(late: usize, level: f64) -> Vec<(&'static str, QuantityKind, Vec<f64>)> {
    let decay = (-5.0 * DT_S).exp();
    let u: Vec<f64> = (0..800).map(random).collect();
    let mut y = vec![0.0; 800];
    for k in 1..800 {
        y[k] = decay * y[k - 1] + 2.0 * (1.0 - decay) * k.checked_sub(1 + late).map_or(0.0, |i| u[i]);
    }
    let lift = |s: Vec<f64>, by: f64| s.into_iter().map(|x| x + by).collect();
    vec![("u", QuantityKind::Other, lift(u, level)), ("y", QuantityKind::Other, lift(y, 2.0 * level))]
}

#[test]
fn a_delay_stands_in_the_records_and_turns_the_phase() {
    let folder = tempfile::tempdir().unwrap();
    let input = artifact(folder.path(), &lagged(3, 0.0), None);
    let flags = ["--methods=tfest,arx", "--inputs=u", "--outputs=y", "--poles=1", "--zeros=0", "--orders=1"];
    let result = run(&input, &[&flags[..], &["--hold=zero-order", "--delay=3"]].concat());
    for id in ["tfest-1-0", "arx-1"] {
        let tf: TransferFunctionV1 = result.record(&format!("/model/{id}/transfer-function")).unwrap().unwrap();
        let model: StateSpaceV1 = result.record(&format!("/model/{id}/continuous")).unwrap().unwrap();
        let how: IdentificationV1 = result.record(&format!("/identification/{id}")).unwrap().unwrap();
        for delay_s in [tf.delay_s, model.delay_s, how.delay_s] {
            assert_eq!(delay_s, Some(3.0 * DT_S), "{id}");
        }
        assert!(how.notes.iter().any(|n| n.contains("late")), "{id}: {:?}", how.notes);
        assert!(how.fit_percent.unwrap() > 99.999, "{id}: {how:?}");
        let response: ResponseV1 = result.record(&format!("/response/{id}")).unwrap().unwrap();
        for (hz, phase) in response.frequency_hz.iter().zip(&response.phase_rad) {
            // 10/(s + 5) and the delay. Exact data: what the fit leaves is near 1e-8.
            let exact = -(TAU * hz / 5.0).atan() - TAU * hz * 3.0 * DT_S;
            assert!((phase - exact).abs() < 1e-4, "{id}: {hz} Hz {phase} {exact}");
        }
        // 800 samples are shown every second one: the step begins after 0.03 s.
        for (t, step) in response.time_s.iter().zip(&response.step) {
            let exact = 2.0 * (1.0 - (-5.0 * (t - 3.0 * DT_S).max(0.0)).exp());
            assert!((step - exact).abs() < 1e-4, "{id}: {t} s {step} {exact}");
        }
    }
    let without = run(&input, &flags);
    let how: IdentificationV1 = without.record("/identification/tfest-1-0").unwrap().unwrap();
    assert_eq!(how.delay_s, None);
}

#[test]
fn the_mean_is_removed_when_asked_and_both_figures_of_unseen_samples_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let input = artifact(folder.path(), &lagged(0, 40.0), None);
    let flags = ["--methods=tfest,n4sid", "--inputs=u", "--outputs=y", "--poles=1", "--zeros=0", "--orders=1"];
    let flags = [&flags[..], &["--hold=zero-order", "--validate-from=4s", "--remove-mean"]].concat();
    let result = run(&input, &flags);
    for id in ["tfest-1-0", "n4sid-1"] {
        let how: IdentificationV1 = result.record(&format!("/identification/{id}")).unwrap().unwrap();
        assert_eq!(how.notes.iter().filter(|n| n.contains("the mean of the samples")).count(), 2, "{:?}", how.notes);
        let evidence: EvidenceV1 = result.record(&format!("/evidence/{id}")).unwrap().unwrap();
        let on = evidence.validation_fit_percent.unwrap();
        let restarted = evidence.validation_restarted_fit_percent.unwrap();
        // The mean of an output lags behind that of its input by the 20 samples of its memory, of 400: a constant of a
        // tenth of its size is left over.
        assert!(on > 85.0 && restarted > on && on != restarted, "{id}: {on} {restarted}");
    }
}

/// A free oscillation of 20 Hz.
fn oscillation() -> Vec<(&'static str, QuantityKind, Vec<f64>)> {
    let y = (0..200).map(|k| f64::from(k) * DT_S).map(|t| 50.0 * (-3.0 * t).exp() * (TAU * 20.0 * t).cos()).collect();
    vec![("93", QuantityKind::Acceleration, y)]
}

#[test]
fn a_waveform_that_is_not_there_is_answered_by_those_that_are() {
    let folder = tempfile::tempdir().unwrap();
    let input = artifact(folder.path(), &lagged(0, 0.0), None);
    let run = identify(&input, &input.with_file_name("4.mcap"), &["--methods=arx", "--inputs=1", "--outputs=y"]);
    let told = run.said;
    assert_eq!(run.code, Some(3), "{told}");
    assert!(told.contains("there is no waveform \"1\", the inputs hold: u, y") && told.contains("--inputs"), "{told}");
}

#[test]
fn a_mode_at_the_edge_of_any_filter_is_told_of() {
    let none = ChannelFilterV1 {
        cfc: None,
        mode: "butterworth-low".to_owned(),
        frequency_factor: None,
        samples_added: 0,
        coefficients: Vec::new(),
        gain_at_class_db: None,
        zero_level_removed: 0.0,
        notes: Vec::new(),
        corridor: Vec::new(),
        corridor_ok: None,
        cutoff_hz: vec![25.0],
        phase: Some("zero".to_owned()),
        width_s: None,
        resampled_to_hz: None,
        shift_s: None,
    };
    let average =
        ChannelFilterV1 { mode: "moving-average".to_owned(), cutoff_hz: vec![], width_s: Some(0.02), ..none.clone() };
    // sin(pi x)/(pi x) at the edge of the average, 22.1 Hz.
    let x = PI * 0.442_946;
    assert!((x.sin() / x - 0.5_f64.sqrt()).abs() < 1e-6);
    for (filter, expected) in [
        (none.clone(), "near the 25 Hz edge of the butterworth-low filter"),
        (average, "near the 22 Hz edge of the moving average over 0.02 s"),
        (ChannelFilterV1 { cutoff_hz: vec![80.0], ..none }, ""),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let input = artifact(folder.path(), &oscillation(), Some(&filter));
        let notes: NotesV1 = run(&input, &["--orders=2"]).record("/notes").unwrap().unwrap();
        let told: Vec<&String> = notes.notes.iter().filter(|n| n.contains(" edge of the ")).collect();
        assert_eq!(told.len(), usize::from(!expected.is_empty()), "{:?}", notes.notes);
        assert!(told.iter().all(|n| n.contains(expected)), "{told:?}");
    }
}

#[test]
fn rounding_of_an_integrator_is_no_growth() {
    let folder = tempfile::tempdir().unwrap();
    let u: Vec<f64> = (0..400).map(random).collect();
    let mut y = vec![0.0; 400];
    for k in 1..400 {
        y[k] = y[k - 1] + DT_S * u[k - 1];
    }
    let waves = [("u", QuantityKind::Other, u), ("y", QuantityKind::Other, y)];
    let input = artifact(folder.path(), &waves, None);
    let flags = ["--methods=tfest", "--inputs=u", "--outputs=y", "--poles=1", "--zeros=0", "--hold=zero-order"];
    let notes: Option<NotesV1> = run(&input, &flags).record("/notes").unwrap();
    let notes = notes.map(|notes| notes.notes).unwrap_or_default();
    assert!(notes.iter().all(|n| !n.contains("grows")), "{notes:?}");
}
