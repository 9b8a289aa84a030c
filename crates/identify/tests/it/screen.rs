//! What the console shows of a model, and its simulated output, against the records.

use crumple_artifact::Artifact;
use crumple_artifact::records::{EvidenceV1, IdentificationV1, ModesV2, TransferFunctionV1};
use crumple_metrics::fit_percent;
use crumple_signal::{Channel, QuantityKind};
use crumple_testkit::uniform;

use crate::program::{Wave, identify, made, written};

const DT_S: f64 = 0.01;
const SAMPLES: usize = 400;
const USED: usize = 300;

/// An oscillator of 8.1 Hz, damping ratio 0.05, driven by draws, with a little noise and a level.
fn record() -> [Vec<f64>; 2] {
    let u: Vec<f64> = (0..SAMPLES as u64).map(uniform).collect();
    let mut y = vec![0.0; SAMPLES];
    for k in 2..SAMPLES {
        y[k] = 1.7 * y[k - 1] - 0.95 * y[k - 2] + 0.2 * u[k - 1] + 0.1 * u[k - 2];
    }
    let noise = (0..SAMPLES as u64).map(|k| 0.02 * uniform(50_000 + k));
    [u, y.into_iter().zip(noise).map(|(y, e)| 7.0 + y + e).collect()]
}

/// Lines of a model, without the name of the stage: from its own on as long as they are indented or warnings.
fn block<'a>(said: &'a str, id: &str) -> Vec<&'a str> {
    let mut lines = said.lines().map(|line| line.get(17..).unwrap_or_default());
    let first = lines.by_ref().find(|line| line.starts_with(&format!("{id}: "))).unwrap();
    let own = lines.take_while(|line| line.starts_with("  ") || line.starts_with(&format!("warning: {id}: ")));
    std::iter::once(first).chain(own).collect()
}

/// `6.28e5` or `0.0123`: the number at the start of a text.
fn number(text: &str) -> f64 {
    let end = text.find(|c: char| !(c.is_ascii_digit() || "+-.e".contains(c))).unwrap_or(text.len());
    text[..end].parse().unwrap()
}

/// Three significant digits.
fn is_shown(shown: f64, value: f64) -> bool {
    (shown - value).abs() <= 0.005_01 * value.abs()
}

#[test]
fn lines_of_a_model_are_its_records() {
    let folder = tempfile::tempdir().unwrap();
    let [u, y] = record();
    let channels = ["u", "y"].map(|id| Channel::new(id, QuantityKind::Voltage)).to_vec();
    let waves: [Wave; 2] = [("u", QuantityKind::Voltage, u), ("y", QuantityKind::Voltage, y.clone())];
    let input = written(&made(channels, 0.0, DT_S, &waves), folder.path(), "ingest");
    let output = folder.path().join("4.mcap");
    let flags = "--inputs=u --outputs=y --methods=tfest,n4sid --poles=2 --zeros=1 --orders=2 --hold=zero-order \
                 --remove-mean --validate-from=3s";
    let run = identify(&input, &output, &flags.split_whitespace().collect::<Vec<_>>());
    assert_eq!(run.code, Some(0), "{}", run.said);
    let result = Artifact::open(&output).unwrap();
    for id in ["tfest-2-1", "n4sid-2"] {
        let lines = block(&run.said, id);
        assert!(lines.len() <= 12, "{lines:#?}");
        let line = |label: &str| {
            let found = lines.iter().find_map(|line| line.strip_prefix(&format!("  {label:<13} ")));
            found.unwrap_or_else(|| panic!("no {label}: {lines:#?}"))
        };
        let how: IdentificationV1 = result.record(&format!("/identification/{id}")).unwrap().unwrap();
        let evidence: EvidenceV1 = result.record(&format!("/evidence/{id}")).unwrap().unwrap();
        assert_eq!(how.inputs, ["u"]);
        let (fit, unseen) = (how.fit_percent.unwrap(), evidence.validation_restarted_fit_percent.unwrap());
        let said = format!("{id}: fit {fit:.2} % of y, {USED} samples; unseen {unseen:.2} % with the start fitted");
        assert!(lines[0].starts_with(&said), "{said}: {}", lines[0]);
        // The simulated output at the level of the record gives both fits.
        let simulated = result.waves()[&format!("{id}/simulated")].sampled.samples();
        for (range, percent) in [(0..USED, fit), (USED..SAMPLES, unseen)] {
            let own = fit_percent(&y[range.clone()], &simulated[range]).unwrap();
            assert!((own - percent).abs() < 1e-9, "{id}: {own} {percent}");
        }
        let modes: ModesV2 = result.record(&format!("/modes/{id}")).unwrap().unwrap();
        let hz = modes.modes[0].natural_frequency_rad_per_s / std::f64::consts::TAU;
        let poles = line("poles");
        assert!((number(poles) / hz - 1.0).abs() < 1e-3 && poles.contains(" Hz, damping "), "{poles}: {hz}");
        assert!(line("verdict").contains("holds on unseen samples"), "{lines:#?}");
        if id == "n4sid-2" {
            assert_eq!(line("state space"), "2 states, 1 input, 1 output, sampled every 0.01 s");
            continue;
        }
        let tf: TransferFunctionV1 = result.record(&format!("/model/{id}/transfer-function")).unwrap().unwrap();
        for (label, coefficients, deviations) in [
            ("numerator", &tf.numerator[..], &evidence.numerator_deviations),
            ("denominator", &tf.denominator[1..], &evidence.denominator_deviations),
        ] {
            // `(0.123 ± 0.0045) s + (1.23 ± 0.045)`
            let terms: Vec<&str> = line(label).split('(').skip(1).collect();
            assert_eq!((terms.len(), deviations.len()), (coefficients.len(), coefficients.len()), "{label}");
            for ((term, value), deviation) in terms.iter().zip(coefficients).zip(deviations) {
                let shown = term.split_once(" ± ").unwrap();
                assert!(is_shown(number(shown.0), *value) && is_shown(number(shown.1), *deviation), "{term}: {value}");
            }
        }
        let search = line("search");
        let reason = evidence.stop_reason.unwrap().replace('-', " ");
        assert!(search.starts_with(&format!("stopped: {reason} after {}", evidence.iterations.unwrap())), "{search}");
    }
    assert!(!run.said.contains("warning:"), "{}", run.said);
}
