//! Reports of event data recorders: several tables, cells in two units, files that are not complete.

use crumple_ingest::{Bundle, IngestError, IngestSettings, Ingested, Profile, ingest, list};
use crumple_signal::{Axis, QuantityKind};

/// Two events with a longitudinal and a lateral table each, before them a table of the five seconds before.
fn report() -> String {
    let mut text = String::from(
        "CDR File Information,v21\nComplete File Recorded,No\n\nPre-Crash Data (Event Record 1)\n\
         Time (sec),\"Speed, Vehicle Indicated (MPH [km/h])\",Service Brake\n",
    );
    for k in 0..11 {
        text += &format!("{:.1},{} [{}],Off\n", -5.0 + 0.5 * f64::from(k), 38, 61);
    }
    for (event, lateral) in [(1, true), (1, false), (2, false)] {
        let (direction, factor) = if lateral { ("Lateral", 0.1) } else { ("Longitudinal", -1.0) };
        text +=
            &format!("\n{direction} Crash Pulse (Event Record {event})\nTime (msec),Velocity Change (MPH [km/h])\n");
        for k in 0..26 {
            // km/h, a half sine of 100 ms that loses 60 km/h.
            let share = 0.5 * (1.0 - (std::f64::consts::PI * f64::from(k.min(10)) / 10.0).cos());
            let change = factor * 60.0 * share / f64::from(event);
            text += &format!("{},{:.0} [{:.0}]\n", 10 * k, change / 1.609_344, change);
        }
    }
    text
}

fn read(text: &str, settings: &IngestSettings) -> Result<Ingested, IngestError> {
    ingest(&Bundle::from_bytes("edr.csv", text.as_bytes().to_vec())?, settings)
}

fn edr() -> IngestSettings {
    IngestSettings { profile: Some(Profile::Edr), ..IngestSettings::default() }
}

#[test]
fn the_longitudinal_table_of_the_first_event_is_taken_and_the_others_are_named() {
    let ingested = read(&report(), &edr()).unwrap();
    assert_eq!(ingested.test.pulse.as_deref(), Some("Velocity_Change-2"));
    let channel = ingested.test.channel("Velocity_Change-2").unwrap();
    assert_eq!((channel.quantity, channel.axis), (QuantityKind::VelocityChange, Some(Axis::X)));
    let wave = ingested.waves.iter().find(|w| w.id == "Velocity_Change-2").unwrap();
    // -60 km/h, the finer of both units.
    assert!((wave.quality.record.minimum + 60.0 / 3.6).abs() < 1e-12, "{}", wave.quality.record.minimum);
    let notes = ingested.notes.to_texts().join("\n");
    for said in [
        "others: Velocity_Change (Lateral Crash Pulse (Event Record 1)), Velocity_Change-3 (Longitudinal Crash Pulse \
         (Event Record 2))",
        "not read: \"Pre-Crash Data (Event Record 1)\"",
        "its file is not complete (line 2: Complete File Recorded,No)",
    ] {
        assert!(notes.contains(said), "{said}: {notes}");
    }
    assert!(!notes.contains("two different things"), "{notes}");
    assert!(ingested.test.notes.iter().any(|note| note.contains("not complete")), "{:?}", ingested.test.notes);
}

#[test]
fn a_channel_or_a_title_picks_another_table() {
    let settings = IngestSettings { channel: Some("*Event Record 2*".to_owned()), ..edr() };
    assert_eq!(read(&report(), &settings).unwrap().test.pulse.as_deref(), Some("Velocity_Change-3"));
    let settings = IngestSettings { skip_to: Some("lateral crash".to_owned()), ..edr() };
    let ingested = read(&report(), &settings).unwrap();
    assert_eq!((ingested.waves.len(), ingested.test.pulse), (1, None));
    let error = read(&report(), &IngestSettings { channel: Some("Velocity*".to_owned()), ..edr() }).unwrap_err();
    assert!(error.to_string().contains("means 3 channels"), "{error}");
    let error = read(&report(), &IngestSettings { skip_to: Some("Rollover".to_owned()), ..edr() }).unwrap_err();
    assert_eq!(error.to_string(), "edr.csv: no line holds \"Rollover\"");
}

#[test]
fn the_list_shows_every_table() {
    let bundle = Bundle::from_bytes("edr.csv", report().into_bytes()).unwrap();
    let lines = list(&bundle, &edr()).unwrap();
    let shown: Vec<_> = lines.iter().map(|l| (l.id.as_str(), l.quantity.as_str(), l.samples)).collect();
    assert_eq!(
        shown,
        [
            ("Speed_Vehicle_Indicated", "velocity", 11),
            ("Velocity_Change", "velocity_change", 26),
            ("Velocity_Change-2", "velocity_change", 26),
            ("Velocity_Change-3", "velocity_change", 26),
        ]
    );
    assert_eq!(lines[3].comment.as_deref(), Some("Longitudinal Crash Pulse (Event Record 2)"));
}

#[test]
fn units_that_disagree_are_named_with_their_line() {
    let wrong = report().replacen("-37 [-60]", "-37 [-50]", 1);
    let notes = read(&wrong, &edr()).unwrap().notes.to_texts().join("\n");
    assert!(notes.contains("1 cells of column Velocity Change say two different things in MPH and km/h"), "{notes}");
}

#[test]
fn without_the_profile_the_refusal_names_it() {
    let error = read(&report(), &IngestSettings::default()).unwrap_err();
    assert!(error.hint().contains("--profile edr"), "{error}: {}", error.hint());
    let rows: String = (0..60).map(|k| format!("{},{}\n", 10 * k, -(k.min(50)))).collect();
    let error = read(&format!("Time (msec),Delta-V (km/h)\n{rows}"), &IngestSettings::default()).unwrap_err();
    assert!(error.hint().contains("--profile edr"), "{error}: {}", error.hint());
}
