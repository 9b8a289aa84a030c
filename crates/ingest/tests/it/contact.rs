//! First contact: found where nothing states it, asked about where what states it does not fit the pulse.

use crumple_ingest::{IngestError, Ingested};
use crumple_signal::{Contact, Weight};

use crate::{given, notes, read_as};

/// A table in g at 10 kHz: a half sine of 100 ms and 24.5 g that begins at `contact_s` of its axis, and what lies
/// before and after.
struct Table {
    from_s: f64,
    contact_s: f64,
    /// Level in g at so many seconds before contact (negative) or after it.
    beside: fn(f64) -> f64,
}

const CALM: fn(f64) -> f64 = |_| 0.0;

impl Table {
    fn read(&self, flags: &str) -> Result<Ingested, IngestError> {
        let Self { from_s, contact_s, beside } = *self;
        let row = |k: usize| {
            let t = from_s + 1e-4 * k as f64;
            let tau = t - contact_s;
            let pulse = if (0.0..0.1).contains(&tau) { -24.5 * (std::f64::consts::PI * tau / 0.1).sin() } else { 0.0 };
            // A noise of 0.02 g that repeats itself after 1009 samples.
            let noise = 0.035 * ((k * 7919 % 1009) as f64 / 504.0 - 1.0);
            format!("{t:.6},{:.6}\n", pulse + beside(tau) + noise)
        };
        let rows = ((contact_s - from_s + 0.35) / 1e-4) as usize;
        let text = format!("time_s,accel_g\n{}", (0..rows).map(row).collect::<String>());
        read_as("crash.csv", text, &given(&format!("--mass 1200kg --impact-speed 50km/h {flags}")))
    }
}

fn contact(ingested: &Ingested) -> &Contact {
    ingested.test.contact.as_ref().unwrap()
}

#[test]
fn contact_is_where_the_pulse_begins_wherever_that_is_on_the_file_s_axis() {
    // Both act on through the contact.
    let braking = |t: f64| if (-0.8..0.1).contains(&t) { -0.8 } else { 0.0 };
    let fall = |t: f64| if (-0.6..0.1).contains(&t) { -1.0 } else { 0.0 };
    for (from_s, contact_s, beside) in [
        // Before t = 0, after it, long after the start of a device's clock, after braking and after a fall.
        (-0.1, -0.018, CALM),
        (-0.1, -0.005, CALM),
        (-0.4, -0.3, CALM),
        (0.0, 0.02, CALM),
        (0.0, 0.3, CALM),
        (81.2347, 81.2847, CALM),
        (0.0, 1.5, braking as fn(f64) -> f64),
        (0.0, 1.0, fall as fn(f64) -> f64),
    ] {
        let ingested = Table { from_s, contact_s, beside }.read("").unwrap();
        let found = contact(&ingested);
        // 0.02 g are 0.03 ms of a rise of 770 g/s.
        assert!((found.source_time_s - contact_s).abs() < 2e-4, "{from_s} {contact_s}: {found:?}");
        assert_eq!(found.rule, "auto");
        assert!(found.earlier_by_s > 0.0 && found.uncertainty_s.is_some());
        let pulse = &ingested.pulse().unwrap().samples;
        assert!((pulse.t0_s() - (from_s - found.source_time_s)).abs() < 1e-9);
        // The flag that the note names gives the same axis, to its digits.
        let said = notes(&ingested);
        let flag = said.split("--time-zero ").nth(1).unwrap().split("ms").next().unwrap().to_owned();
        let typed = Table { from_s, contact_s, beside }.read(&format!("--time-zero {flag}ms")).unwrap();
        assert!((contact(&typed).source_time_s - found.source_time_s).abs() < 1e-6, "{flag}");
        assert!(!notes(&typed).contains("the pulse begins"), "{}", notes(&typed));
    }
}

#[test]
fn a_zero_of_the_file_that_fits_the_pulse_is_contact() {
    for (from_s, contact_s) in [(-0.05, 0.0), (-0.1, 0.003), (-0.1, -0.0005), (0.0, 0.0)] {
        let ingested = Table { from_s, contact_s, beside: CALM }.read("").unwrap();
        assert_eq!((contact(&ingested).rule.as_str(), contact(&ingested).source_time_s), ("file", 0.0), "{contact_s}");
    }
    // Asked for, the onset is taken all the same.
    let asked = Table { from_s: -0.1, contact_s: 0.003, beside: CALM }.read("--time-zero auto").unwrap();
    assert!((contact(&asked).source_time_s - 0.003).abs() < 2e-4);
}

#[test]
fn a_contact_that_is_stated_where_the_pulse_does_not_begin_is_asked_about_first_with_the_flag_that_mends_it() {
    for (stated, words) in [("0ms", "50.0 ms after contact"), ("58ms", "8.0 ms before contact")] {
        let table = Table { from_s: 0.0, contact_s: 0.05, beside: CALM };
        let ingested = table.read(&format!("--time-zero {stated}")).unwrap();
        let first = ingested.notes.iter().next().unwrap();
        assert!(
            first.text.contains(words) && first.text.contains("--time-zero 50.0")
                || first.text.contains("--time-zero 49.9"),
            "{}",
            first.text
        );
        assert_eq!(first.bearing.as_ref().unwrap().weight, Weight::Decisive);
    }
    let table = Table { from_s: 0.0, contact_s: 0.05, beside: CALM };
    assert!(!notes(&table.read("--time-zero 50ms").unwrap()).contains("the pulse begins"));
}

#[test]
fn a_contact_outside_the_record_is_refused_with_bounds_and_proposal_on_the_file_s_axis() {
    let table = Table { from_s: 81.2347, contact_s: 81.2847, beside: CALM };
    let error = table.read("--time-zero 0.05s").unwrap_err();
    assert!(error.to_string().contains("from 81.2347 s to 81.63"), "{error}");
    let hint = error.hint();
    let flag = hint.split("--time-zero ").nth(1).unwrap().split("s,").next().unwrap().to_owned();
    assert!((flag.parse::<f64>().unwrap() - 81.2847).abs() < 2e-4, "{hint}");
    table.read(&format!("--time-zero {flag}s")).unwrap();
}

#[test]
fn contact_is_found_by_the_rule_asked_for_and_its_uncertainty_is_stated() {
    let table = Table { from_s: 0.0, contact_s: 0.05, beside: CALM };
    let by = |rule: &str| {
        let ingested = table.read(&format!("--time-zero-rule {rule}")).unwrap();
        contact(&ingested).clone()
    };
    let threshold = by("threshold");
    // 0.5 g of 770 g/s are 0.65 ms; CFC 60 rounds the foot.
    assert!((threshold.source_time_s - 0.0506).abs() < 5e-4, "{threshold:?}");
    let edr = by("edr");
    assert!(
        (0.03..0.05).contains(&edr.source_time_s)
            && (edr.uncertainty_s.unwrap().size - 0.02 / 3.0_f64.sqrt()).abs() < 1e-12,
        "{edr:?}"
    );
    assert_eq!((by("file").source_time_s, by("file").rule.as_str()), (0.0, "file"));
    let error = table.read("--time-zero-rule contact:nope").unwrap_err();
    assert!(error.to_string().contains("channel nope is not in the record"), "{error}");
}

#[test]
fn a_record_that_begins_inside_the_pulse_has_a_lower_bound_and_says_what_is_missing() {
    let whole = Table { from_s: -0.005, contact_s: -0.01, beside: CALM };
    let ingested = whole.read("").unwrap();
    // The first sample is 5 ms after contact: 3.8 g.
    assert!(notes(&ingested).contains("begins inside the pulse, at 3.9 g"), "{}", notes(&ingested));
    let found = contact(&ingested);
    assert!((0.005..0.009).contains(&found.earlier_by_s), "{found:?}");
    // Times that count from the first sample: the zero level, unknown for the same reason, comes after it.
    let said = notes(&Table { from_s: 0.0, contact_s: -0.013, beside: CALM }.read("").unwrap());
    let place = |text: &str| said.find(text).unwrap_or_else(|| panic!("{text}: {said}"));
    assert!(place("begins inside the pulse, at 9.8 g") < place("zero level and noise"), "{said}");
}

#[test]
fn braking_before_contact_is_no_zero_level() {
    let braking = |t: f64| if (-1.0..0.0).contains(&t) { -0.8 } else { 0.0 };
    let ingested = Table { from_s: -1.5, contact_s: 0.0, beside: braking }.read("").unwrap();
    assert_eq!(contact(&ingested).rule, "file");
    let quality = &ingested.pulse().unwrap().quality;
    assert!(quality.zero_level().unwrap().abs() < 0.1, "{quality:?}");
    assert!(notes(&ingested).contains("it brakes before contact"), "{}", notes(&ingested));
}
