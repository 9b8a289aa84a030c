//! Units, speeds, times and signs taken for others: one question, first, with the flag that mends it. And a fall before
//! contact.

use crumple_ingest::{Bundle, Ingested, ingest};
use crumple_signal::{About, STANDARD_GRAVITY_M_PER_S2 as G, Severity};
use crumple_testkit::shared;

use crate::{given, notes, read_as};

/// A table of a half sine of 100 ms at 2 kHz from -50 ms: from 50 km/h with a restitution of 0.1, in g and s. The head
/// names the columns; times and accelerations are multiplied.
fn table(head: &str, of_time: f64, of_acceleration: f64) -> String {
    let peak = 1.1 * 50.0 / 3.6 * std::f64::consts::PI / (2.0 * 0.1) / G;
    let row = |k: i32| {
        let t = f64::from(k) * 5e-4;
        let a = if (0.0..0.1).contains(&t) { -peak * (std::f64::consts::PI * t / 0.1).sin() } else { 0.0 };
        // An offset, and a noise that no run of equal samples is found in.
        let a = a + 0.2 + 0.01 * (f64::from(k) * 1.7).sin();
        format!("{:.9},{:.6}\n", of_time * t, of_acceleration * a)
    };
    head.to_owned() + &(-100..500).map(row).collect::<String>()
}

fn read(text: &str, flags: &str) -> Ingested {
    read_as("t.csv", text, &given(&format!("--mass 1200kg {flags}"))).unwrap()
}

fn questions(ingested: &Ingested) -> Vec<String> {
    let is_question = |text: &&String| text.contains("stops the car");
    ingested.notes.to_texts().iter().filter(is_question).cloned().collect()
}

/// The first note asks and ends with `flag`; with it instead of `spoilt` nothing is asked any more.
#[track_caller]
fn is_asked_and_answered(text: &str, flags: &str, spoilt: &str, flag: &str) {
    let (asked, mended) = (read(text, &format!("{flags} {spoilt}")), read(text, &format!("{flags} {flag}")));
    let first = asked.notes.iter().next().unwrap();
    assert_eq!(first.severity, Severity::Warning, "{first}");
    assert!(first.text.ends_with(&format!("add {flag}")), "{first}");
    let figures = "crush 643 mm, restitution 0.10, peak 24 g";
    assert!(first.text.contains("stops") && first.text.contains(figures), "{first}");
    assert!(asked.test.exchange_asked && !mended.test.exchange_asked);
    assert_eq!(questions(&mended), Vec::<String>::new());
    assert!((mended.test.impact_speed_m_per_s.unwrap() * 3.6 - 50.0).abs() < 0.01);
}

const SPEED: &str = "--impact-speed 50km/h";

#[test]
fn a_right_record_is_not_asked_about() {
    assert_eq!(questions(&read(&table("time_s,accel_g\n", 1.0, 1.0), SPEED)), Vec::<String>::new());
}

#[test]
fn a_pulse_that_no_vehicle_has_is_questioned() {
    let said = |head: &str| {
        let texts = read(&table(head, 1.0, 1.0), SPEED).notes.to_texts();
        texts.iter().any(|text| text.contains("stays above 1000 g for 3 ms (largest 24") && text.ends_with("and unit"))
    };
    assert!(said("time_s,accel_kilo-g\n") && !said("time_s,accel_g\n"));
}

#[test]
fn the_unit_of_the_acceleration_is_asked() {
    let (in_g, in_si) = ("--unit g", "--unit m/s^2");
    is_asked_and_answered(&table("time_s,accel\n", 1.0, 1.0), SPEED, in_si, in_g);
    is_asked_and_answered(&table("time_s,accel\n", 1.0, G), SPEED, in_g, in_si);
    // A flag overrules the header.
    is_asked_and_answered(&table("time_s,accel_m_per_s2\n", 1.0, 1.0), SPEED, "", in_g);
    is_asked_and_answered(&table("time_s,accel_g\n", 1.0, G), SPEED, "", in_si);
}

#[test]
fn the_impact_speed_is_asked() {
    let text = table("time_s,accel_g\n", 1.0, 1.0);
    for (spoilt, meant) in
        [("50mph", "50km/h"), ("31.069km/h", "31.069mph"), ("13.889km/h", "13.889m/s"), ("50m/s", "50km/h")]
    {
        let [spoilt, meant] = [spoilt, meant].map(|speed| format!("--impact-speed {speed}"));
        is_asked_and_answered(&text, "", &spoilt, &meant);
    }
    is_asked_and_answered(&format!("# impact speed: 50 mph\n{text}"), "", "", SPEED);
}

#[test]
fn the_unit_of_the_time_is_asked() {
    // At 2 samples a second no filter would take it: the question is the refusal.
    let slow = table("time_s,accel_g\n", 1e3, 1.0);
    let error = read_as("t.csv", slow.as_str(), &given(&format!("--mass 1200kg {SPEED}"))).unwrap_err();
    assert!(error.to_string().contains("with times 1000 times shorter this pulse stops the car"), "{error}");
    assert_eq!(error.hint(), "add --time-unit ms");
    assert_eq!(questions(&read(&slow, &format!("{SPEED} --time-unit ms"))), Vec::<String>::new());
    is_asked_and_answered(&table("time_ms,accel_g\n", 1.0, 1.0), SPEED, "", "--time-unit s");
    is_asked_and_answered(&table("time,accel_g\n", 1e3, 1.0), SPEED, "--time-unit us", "--time-unit ms");
}

#[test]
fn the_sign_is_asked_once() {
    let text = table("time_s,accel_g\n", 1.0, -1.0);
    is_asked_and_answered(&text, SPEED, "", "--sign flip");
    assert!(!notes(&read(&text, SPEED)).contains("the pulse is positive"));
    is_asked_and_answered(&table("time_s,accel_g\n", 1.0, 1.0), SPEED, "--sign flip", "--sign keep");
}

/// Real tests and the records of known truth.
#[test]
fn nothing_is_asked_of_right_records() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut paths: Vec<std::path::PathBuf> = ["kelvin", "double", "elastoplastic", "noisy"]
        .iter()
        .map(|name| root.join("fixtures").join(name).join("crash.csv"))
        .collect();
    paths.extend(
        ["data/nhtsa-10146", "reference/cases/F04-free-fall-as-zero-level/offset-5g-right-today.csv"]
            .iter()
            .filter_map(|path| shared(path)),
    );
    for path in paths {
        let Ok(bundle) = Bundle::open(&path) else { continue };
        let flags = given(if path.ends_with("offset-5g-right-today.csv") { SPEED } else { "" });
        let ingested = ingest(&bundle, &flags).unwrap();
        assert_eq!(questions(&ingested), Vec::<String>::new(), "{}", path.display());
    }
}

#[test]
fn a_fall_before_contact_is_named_and_an_offset_is_not() {
    // Rest until -150 ms, a fall until contact, 20 ms of 50 g, rest.
    let text = |fall: f64, sign: f64| {
        let row = |k: i32| {
            let t = f64::from(k) * 1e-3;
            let pulse = if (0.0..0.02).contains(&t) { 50.0 * (std::f64::consts::PI * t / 0.02).sin() } else { 0.0 };
            let level = if (-0.15..0.0).contains(&t) { fall } else { 0.0 };
            format!("{t:.3},{:.5}\n", 0.3 + sign * (level + pulse) + 0.01 * (f64::from(k) * 1.7).sin())
        };
        format!("time_s,acc_z_g\n{}", (-250..400).map(row).collect::<String>())
    };
    let notes_of = |text: &str| read(text, "").notes.iter().cloned().collect::<Vec<_>>();
    for sign in [1.0, -1.0] {
        let notes = notes_of(&text(-1.0, sign));
        let words = format!("free fall before contact: its level is {:+.2} g off the level at rest", -sign);
        let note = notes.iter().find(|note| note.text.contains(&words)).unwrap_or_else(|| panic!("{notes:#?}"));
        assert_eq!(note.bearing.as_ref().map(|bearing| &bearing.about), Some(&About::Pulse));
    }
    assert!(!notes_of(&text(0.0, 1.0)).iter().any(|note| note.text.contains("free fall")));
}
