//! What the program says of records that are no crash holds: failures, unseen samples, poles that are no modes, words.

use std::path::Path;

use crumple_artifact::Artifact;
use crumple_artifact::records::{
    ConcernV1, ConcernsV2, EvidenceV1, IdentificationV1, ModesV2, NotesV1, OtherPoleKindV1,
};
use crumple_signal::{Channel, QuantityKind};
use crumple_testkit::uniform;

use crate::program::{Run, Wave, identify, made, written};

const DT_S: f64 = 0.01;
const ALL: [&str; 9] = ["era", "okid", "tfest", "exponentials", "n4sid", "moesp", "cva", "arx", "output-error"];

/// Uniform draws from -1 to 1.
fn draws(seed: u64, count: u64) -> Vec<f64> {
    (0..count).map(|k| uniform(1000 * seed + k)).collect()
}

/// `y[k] = sum b_i u[k-i] - sum f_i y[k-i]` from rest, `f` after the leading 1.
fn response(b: &[f64], f: &[f64], u: &[f64]) -> Vec<f64> {
    let mut y: Vec<f64> = Vec::with_capacity(u.len());
    for k in 0..u.len() {
        let past = |values: &[f64], i: usize| k.checked_sub(i).map_or(0.0, |j| values[j]);
        let driven: f64 = b.iter().enumerate().map(|(i, b)| b * past(u, i)).sum();
        let free: f64 = f.iter().enumerate().map(|(i, f)| f * past(&y, i + 1)).sum();
        y.push(driven - free);
    }
    y
}

fn with_noise(mut y: Vec<f64>, size: f64) -> Vec<f64> {
    let noise = draws(77, y.len() as u64);
    y.iter_mut().zip(noise).for_each(|(y, e)| *y += size * e);
    y
}

/// A record of voltages `u` and `y`, and the program run on it.
fn run(folder: &Path, (u, y): (Vec<f64>, Vec<f64>), flags: &[&str]) -> (Run, Option<Artifact>) {
    let channels = ["u", "y"].map(|id| Channel::new(id, QuantityKind::Voltage)).to_vec();
    let waves: [Wave; 2] = [("u", QuantityKind::Voltage, u), ("y", QuantityKind::Voltage, y)];
    let input = written(&made(channels, 0.0, DT_S, &waves), folder, "ingest");
    let output = folder.join("4.mcap");
    let flags: Vec<&str> = [flags, &["--inputs=u", "--outputs=y", "--force"]].concat();
    let run = identify(&input, &output, &flags);
    (run, Artifact::open(&output).ok())
}

fn concerns(result: &Artifact) -> Vec<ConcernV1> {
    result.record::<ConcernsV2>("/concerns").unwrap().map_or(Vec::new(), |record| record.concerns)
}

fn ids(result: &Artifact) -> Vec<String> {
    let topics = result.records().iter().map(|record| record.topic.as_str());
    topics.filter_map(|topic| topic.strip_prefix("/identification/")).map(str::to_owned).collect()
}

/// Poles at 8.1 Hz, damping ratio 0.05.
fn oscillator(u: &[f64]) -> Vec<f64> {
    response(&[0.0, 0.2, 0.1], &[-1.7, 0.95], u)
}

#[test]
fn every_method_has_a_model_or_a_reason() {
    let folder = tempfile::tempdir().unwrap();
    let methods = format!("--methods={}", ALL.join(","));
    let u = draws(1, 200);
    for y in [oscillator(&u), draws(2, 200)] {
        let (said, result) = run(folder.path(), (u.clone(), y), &[&methods, "--orders=4"]);
        assert_eq!(said.code, Some(0), "{}", said.said);
        let result = result.unwrap();
        let (models, concerns) = (ids(&result), concerns(&result));
        for method in ALL {
            let has_model = models.iter().any(|id| {
                id.rsplit_once('-').is_some_and(|(name, _)| name == method || method == "tfest" && name == "tfest-4")
            });
            let about = format!("method:{method}");
            let reason = concerns.iter().find(|concern| concern.about == about);
            assert_ne!(has_model, reason.is_some(), "{method}: {models:?} {concerns:?}");
            let is_said = reason.is_none_or(|reason| {
                reason.text.starts_with(&format!("{method} gave no model: ")) && said.said.contains(&reason.text)
            });
            assert!(is_said, "{}", said.said);
        }
    }
    // Nothing answers, or nothing drives.
    for (signals, name) in [((u.clone(), vec![2.5; 200]), "output y is constant"), ((vec![0.0; 200], u), "input u is")]
    {
        let (said, _) = run(folder.path(), signals, &[&methods, "--orders=4"]);
        assert!(said.code == Some(3) && said.said.contains(name), "{}", said.said);
    }
}

#[test]
fn a_run_without_any_model_names_every_method_with_its_reason() {
    let folder = tempfile::tempdir().unwrap();
    let u = draws(1, 6);
    let (said, _) = run(folder.path(), (u.clone(), oscillator(&u)), &["--methods=era,n4sid,arx", "--orders=4"]);
    assert_eq!(said.code, Some(3), "{}", said.said);
    for method in ["era: ", "n4sid: ", "arx: "] {
        assert!(said.said.contains(method), "{}", said.said);
    }
    // One reason is told once.
    let channels = vec![Channel::new("u", QuantityKind::Voltage)];
    let input =
        written(&made(channels, 0.0, DT_S, &[("u", QuantityKind::Voltage, draws(1, 100))]), folder.path(), "ingest");
    let said = identify(&input, &folder.path().join("5.mcap"), &["--methods=n4sid,arx", "--inputs=u", "--outputs=z"]);
    assert_eq!(said.said.matches("there is no waveform").count(), 1, "{}", said.said);
}

#[test]
fn unseen_samples_that_contradict_a_model_come_before_all_other_warnings() {
    let folder = tempfile::tempdir().unwrap();
    let u = draws(1, 400);
    let flags = ["--methods=arx,n4sid,output-error", "--orders=2", "--validate-from=2s"];
    // Another system from the middle on.
    let (first, second) = u.split_at(200);
    let y = [oscillator(first), response(&[0.0, -5.0, 3.0], &[-0.6, 0.6], second)].concat();
    let (said, result) = run(folder.path(), (u.clone(), with_noise(y, 0.02)), &flags);
    let result = result.unwrap();
    let notes: NotesV1 = result.record("/notes").unwrap().unwrap();
    let first = &concerns(&result)[0];
    assert_eq!((first.about.as_str(), first.weight), ("identified-models", 3));
    for id in ids(&result) {
        let evidence: EvidenceV1 = result.record(&format!("/evidence/{id}")).unwrap().unwrap();
        let fit = result.record::<IdentificationV1>(&format!("/identification/{id}")).unwrap().unwrap().fit_percent;
        assert_eq!(evidence.holds_on_unseen, Some(false), "{id}");
        let unseen = evidence.validation_restarted_fit_percent.unwrap();
        let fit = fit.unwrap();
        assert!(unseen < 0.0 || unseen < fit - 30.0, "{id}: {unseen} {fit}");
        let text = format!(
            "{id}: unseen samples from 2000 ms on contradict it: validation {unseen:.1} % with the start fitted, fit \
             {fit:.1} %"
        );
        // Before all other notes, and the first warning of its model on the screen.
        assert!(notes.notes[..3].contains(&format!("warning: {text}")), "{text}: {notes:?}");
        let mut block = said.said.lines().skip_while(|line| !line.contains(&format!("{id}: fit ")));
        assert_eq!(block.nth(1).map(|line| line.contains(&text)), Some(true), "{}", said.said);
        assert_eq!(said.said.matches(&text).count(), 1, "{}", said.said);
    }
    // The same system throughout.
    let (said, result) = run(folder.path(), (u.clone(), with_noise(oscillator(&u), 0.02)), &flags);
    assert!(!said.said.contains("contradict"), "{}", said.said);
    assert!(concerns(&result.unwrap()).iter().all(|concern| concern.weight < 3));
}

#[test]
fn integrators_and_poles_beyond_nyquist_are_no_modes() {
    let folder = tempfile::tempdir().unwrap();
    let u: Vec<f64> = draws(5, 200).into_iter().map(f64::signum).collect();
    // s = 0 twice, sampled; and z = -0.8, which no continuous pole below the Nyquist frequency has.
    let twice = response(&[0.0, 5e-5, 5e-5], &[-2.0, 1.0], &u);
    let alternating = response(&[1.0, 0.3], &[0.8], &u);
    for (y, order, kind) in [(twice, 2, OtherPoleKindV1::Integrator), (alternating, 1, OtherPoleKindV1::BeyondNyquist)]
    {
        let order = order.to_string();
        let flags = ["--methods=arx,n4sid,output-error", "--orders", &order, "--bootstrap=20"];
        let (said, result) = run(folder.path(), (u.clone(), y), &flags);
        let result = result.unwrap();
        assert_eq!(ids(&result).len(), 3, "{}", said.said);
        for id in ids(&result) {
            let ModesV2 { modes, other_poles } = result.record(&format!("/modes/{id}")).unwrap().unwrap();
            assert!(modes.is_empty(), "{id}: {modes:?}");
            assert_eq!(other_poles.len().to_string(), order);
            assert!(other_poles.iter().all(|pole| pole.kind == kind), "{id}: {other_poles:?}");
            let evidence: EvidenceV1 = result.record(&format!("/evidence/{id}")).unwrap().unwrap();
            let of_modes = [evidence.frequency_spreads.len(), evidence.frequency_deviations.len()];
            assert_eq!(of_modes, [0, 0], "{id}");
        }
        let word = if kind == OtherPoleKindV1::Integrator { "integrator" } else { "beyond Nyquist" };
        assert!(said.said.lines().any(|line| line.contains(" poles ") && line.contains(word)), "{}", said.said);
        assert!(!said.said.contains("the mode at"), "{}", said.said);
    }
}

#[test]
fn a_level_is_named_with_the_flag_that_removes_it() {
    let folder = tempfile::tempdir().unwrap();
    let u = draws(1, 400);
    let y: Vec<f64> = oscillator(&u).into_iter().map(|y| y + 50.0).collect();
    let flags = ["--methods=n4sid,arx", "--orders=2"];
    let (said, _) = run(folder.path(), (u.clone(), y.clone()), &flags);
    assert!(said.said.contains("the mean of y is ") && said.said.contains("--remove-mean"), "{}", said.said);
    let (said, result) = run(folder.path(), (u.clone(), y), &[&flags[..], &["--remove-mean"]].concat());
    assert!(!said.said.contains("the mean of y"), "{}", said.said);
    let fit = result.unwrap().record::<IdentificationV1>("/identification/n4sid-2").unwrap().unwrap().fit_percent;
    // A clean record with its level removed: what is left is the mean of a finite record.
    assert!(fit.unwrap() > 95.0, "{fit:?}");
    let (said, _) = run(folder.path(), (u.clone(), oscillator(&u)), &flags);
    assert!(!said.said.contains("--remove-mean"), "{}", said.said);
}

#[test]
fn no_word_of_cars_is_said_of_a_record_of_none() {
    let folder = tempfile::tempdir().unwrap();
    let methods = format!("--methods={}", ALL.join(","));
    let u = draws(1, 400);
    let growing = response(&[0.0, 0.01, 0.01], &[-2.0073, 1.0098], &u);
    for y in [with_noise(oscillator(&u), 0.02), growing, draws(3, 400)] {
        let (said, result) = run(folder.path(), (u.clone(), y), &[&methods, "--validate-from=2s", "--stabilisation"]);
        let result = result.unwrap();
        let mut texts = result.record::<NotesV1>("/notes").unwrap().unwrap().notes;
        // The last line names files.
        texts.extend(said.said.lines().filter(|line| !line.contains("crumple-artifact")).map(str::to_owned));
        for id in ids(&result) {
            texts.extend(result.record::<IdentificationV1>(&format!("/identification/{id}")).unwrap().unwrap().notes);
        }
        for text in texts {
            let words = text.split(|c: char| !c.is_ascii_alphabetic()).map(str::to_lowercase);
            let of_cars = ["car", "vehicle", "crash", "crush", "test", "impact", "barrier"];
            assert_eq!(words.into_iter().find(|word| of_cars.contains(&word.as_str())), None, "{text}");
        }
    }
}
