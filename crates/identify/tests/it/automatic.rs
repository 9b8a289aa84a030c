//! What the program chooses and notices by itself: methods, orders, delay, halves, trends, outliers, constant inputs.

use crumple_artifact::Artifact;
use crumple_artifact::records::{
    ArxScanV1, EvidenceV1, IdentificationV1, NotesV1, RecommendedBecauseV1, RecordChecksV1, ScanEdgeV1, SelectionV1,
};
use crumple_signal::{Channel, QuantityKind};
use crumple_testkit::uniform;

use crate::program::{Run, Wave, identify, made, written};

const DT_S: f64 = 0.01;
const SAMPLES: u64 = 500;

/// Uniform draws from -0.5 to 0.5.
fn draws(seed: u64) -> Vec<f64> {
    (0..SAMPLES).map(|k| uniform(7000 * seed + k) - 0.5).collect()
}

/// Poles at 8.1 Hz, damping ratio 0.05; the input acts so many samples late beyond its hold. Noise of 4 % of 0.5 rms.
fn oscillator(u: &[f64], late: usize) -> Vec<f64> {
    let noise = draws(9);
    let mut y = vec![0.0; u.len()];
    for k in 2..u.len() {
        let at = |lag: usize| k.checked_sub(lag + late).map_or(0.0, |k| u[k]);
        y[k] = 1.7 * y[k - 1] - 0.95 * y[k - 2] + 0.2 * at(1) + 0.1 * at(2);
    }
    y.iter().zip(noise).map(|(y, e)| y + 0.07 * e).collect()
}

/// Runs the program on voltages and opens what it wrote.
fn run(signals: &[(&str, Vec<f64>)], flags: &[&str]) -> (Run, Artifact) {
    let folder = tempfile::tempdir().unwrap();
    let channels = signals.iter().map(|(id, _)| Channel::new(*id, QuantityKind::Voltage)).collect();
    let waves: Vec<Wave> = signals.iter().map(|(id, y)| (*id, QuantityKind::Voltage, y.clone())).collect();
    let input = written(&made(channels, 0.0, DT_S, &waves), folder.path(), "ingest");
    let output = folder.path().join("4.mcap");
    let run = identify(&input, &output, flags);
    assert_eq!(run.code, Some(0), "{flags:?}: {}", run.said);
    (run, Artifact::open(&output).unwrap())
}

fn checks(result: &Artifact) -> RecordChecksV1 {
    result.record("/checks/y").unwrap().unwrap()
}

#[test]
fn auto_recommends_a_model_that_holds_and_says_why() {
    let u = draws(1);
    let y = oscillator(&u, 0);
    let flags = ["--methods=auto", "--validate-from=50%", "--inputs=u", "--outputs=y"];
    let (said, result) = run(&[("u", u), ("y", y)], &flags);
    let selection: SelectionV1 = result.record("/selection/y").unwrap().unwrap();
    let best = selection.recommended.unwrap();
    // The smallest BIC, unless unseen samples speak against it.
    let (because, passed_over) = match best == selection.best_by_bic {
        true => (RecommendedBecauseV1::SmallestBic, None),
        false => (RecommendedBecauseV1::ValidatesBetter, Some(selection.best_by_bic)),
    };
    assert_eq!((selection.recommended_because, selection.passed_over), (Some(because), passed_over));
    let evidence: EvidenceV1 = result.record(&format!("/evidence/{best}")).unwrap().unwrap();
    let whole: IdentificationV1 = result.record(&format!("/identification/{best}")).unwrap().unwrap();
    assert_eq!((whole.samples, evidence.validation_from_s, evidence.holds_on_unseen), (250, Some(2.5), Some(true)));
    // Noise of 0.07/sqrt 12 on an output of some 0.6: 96 %.
    assert!(evidence.validation_restarted_fit_percent.unwrap() > 90.0, "{evidence:?}");
    assert!(["n4sid", "moesp", "cva"].iter().all(|name| selection.models.iter().any(|m| m.id.starts_with(name))));
    // A record without a fault has none said.
    let found = checks(&result);
    assert!(found.trends.is_empty() && found.outliers.is_empty() && found.order.is_some(), "{found:?}");
    assert!(!said.said.contains("outliers") && !said.said.contains("straight line"), "{}", said.said);
}

#[test]
fn a_range_of_orders_is_all_of_them() {
    let u = draws(2);
    let y = oscillator(&u, 0);
    let (_, result) = run(&[("u", u), ("y", y)], &["--methods=arx", "--orders=1:5", "--inputs=u", "--outputs=y"]);
    for order in 1..=5 {
        assert!(result.record::<EvidenceV1>(&format!("/evidence/arx-{order}")).unwrap().is_some(), "{order}");
    }
}

#[test]
fn the_delay_is_found_and_said_in_samples() {
    let u = draws(3);
    let y = oscillator(&u, 5);
    let flags = ["--methods=output-error", "--orders=2", "--delay=auto", "--inputs=u", "--outputs=y"];
    let (said, result) = run(&[("u", u.clone()), ("y", y.clone())], &flags);
    let found = checks(&result).delay.unwrap();
    assert_eq!((found.samples, found.at_edge, found.last), (5, false, 19));
    assert!(said.said.contains("delay: 5 samples"), "{}", said.said);
    let whole: IdentificationV1 = result.record("/identification/output-error-2").unwrap().unwrap();
    assert!((whole.delay_s.unwrap() - 5.0 * DT_S).abs() < 1e-12 && whole.fit_percent.unwrap() > 90.0);
    // Widened once from 4 to 9.
    let flags = ["--methods=output-error", "--orders=2", "--delay=auto=0-4", "--inputs=u", "--outputs=y"];
    assert_eq!(checks(&run(&[("u", u.clone()), ("y", y.clone())], &flags).1).delay.unwrap().samples, 5);
    // A scan of ARX structures that ends too early.
    let flags = ["--methods=arx", "--arx-scan=2,2,0-4", "--inputs=u", "--outputs=y"];
    let (said, result) = run(&[("u", u), ("y", y)], &flags);
    let scan: ArxScanV1 = result.record("/scan/y").unwrap().unwrap();
    assert_eq!(scan.at_edge, [ScanEdgeV1::Delay], "{scan:?}");
    assert!(said.said.contains("at the edge of the ranges"), "{}", said.said);
}

#[test]
fn a_constant_input_is_left_out_and_the_methods_run_on() {
    let u = draws(4);
    let y = oscillator(&u, 0);
    let signals = [("u", u), ("v", vec![2.5; 500]), ("y", y)];
    let flags = ["--methods=n4sid,moesp,cva,arx,okid,output-error,tfest", "--orders=2", "--poles=2", "--inputs=u,v"];
    let (said, result) = run(&signals, &[&flags[..], &["--outputs=y"]].concat());
    assert_eq!(checks(&result).inputs_left_out, ["v"]);
    assert!(said.said.contains("without v, which is constant"), "{}", said.said);
    for id in ["n4sid-2", "moesp-2", "cva-2", "arx-2", "okid-2", "output-error-2", "tfest-2-1"] {
        let evidence: EvidenceV1 = result.record(&format!("/evidence/{id}")).unwrap().unwrap();
        assert_eq!(evidence.input.as_deref(), Some("u"), "{id}");
    }
}

#[test]
fn a_trend_and_an_outlier_are_said_with_their_place_and_the_flag() {
    let u = draws(5);
    let clean = oscillator(&u, 0);
    let flags = ["--methods=output-error", "--orders=2", "--inputs=u", "--outputs=y"];
    let drifting: Vec<f64> = clean.iter().enumerate().map(|(k, y)| y + 0.004 * k as f64).collect();
    let (said, result) = run(&[("u", u.clone()), ("y", drifting.clone())], &flags);
    let trends = checks(&result).trends;
    // 0.4 V/s; the slope of a finite record of the motion itself is some 0.02.
    assert!(trends.len() == 1 && (trends[0].slope_per_s - 0.4).abs() < 0.1, "{trends:?}");
    assert!(said.said.contains("--remove-trend"), "{}", said.said);
    let (_, result) = run(&[("u", u.clone()), ("y", drifting)], &[&flags[..], &["--remove-trend"]].concat());
    assert!(checks(&result).trends.is_empty());
    let notes: NotesV1 = result.record("/notes").unwrap().unwrap();
    assert!(notes.notes.iter().all(|note| !note.contains("follows a straight line")), "{notes:?}");
    let mut struck = clean;
    struck[320] += 1.5;
    let (said, result) = run(&[("u", u), ("y", struck)], &flags);
    let outliers = checks(&result).outliers;
    assert!(outliers.len() == 1 && outliers[0].samples == [320], "{outliers:?}");
    assert!(said.said.contains("3.200000 s"), "{}", said.said);
}
