//! Tables as people's programs write them: section by section what a reader of CSV has to stand.

use crumple_ingest::{Bundle, IngestError, Ingested, list};
use crumple_signal::{Axis, QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G};

use crate::{given, notes, read_as};

fn read(text: impl Into<Vec<u8>>) -> Result<Ingested, IngestError> {
    // Its ramp begins with the record, 10 ms before the file's t = 0.
    read_as("a.txt", text, &given("--allow-missing --time-zero-rule file"))
}

/// Rows of time (ms) and acceleration (g) in words of `line`.
fn rows(line: impl Fn(f64, f64) -> String) -> String {
    (0..300_i32).map(|k| line(f64::from(k - 100) * 0.1, f64::from(k) * -7.25) + "\n").collect()
}

/// t0 -10 ms, dt 0.1 ms, -7.25 k g.
#[track_caller]
fn check(ingested: &Ingested) {
    let pulse = ingested.pulse().unwrap();
    assert_eq!((pulse.samples.len(), pulse.samples.t0_s(), pulse.samples.dt_s()), (300, -0.01, 1e-4));
    assert_eq!(pulse.samples.samples()[299], 299.0 * -7.25 * G);
}

#[test]
fn milliseconds_without_a_unit_are_asked_for() {
    let text = format!("t,a [g]\n{}", rows(|t, a| format!("{t:.1},{a:.2}")));
    let error = read(text.clone()).unwrap_err();
    assert_eq!(error.to_string(), "a.txt does not state the unit of time: column 1 (t) has steps of 0.1");
    let hint = "add --time-unit s (sampled at 10 Hz) or --time-unit ms (sampled at 10 kHz), whichever it is";
    assert_eq!(error.hint(), hint);
    check(&read_as("a.txt", text.clone(), &given("--allow-missing --time-zero-rule file --time-unit ms")).unwrap());
    assert_eq!(
        read_as("a.txt", text, &given("--allow-missing --time-unit s")).unwrap().pulse().unwrap().samples.dt_s(),
        0.1
    );
    // Steps of 100 are neither: asked.
    let odd: String = (0..100).map(|k| format!("{},{k}\n", k * 100)).collect();
    let error = read(format!("t,a [g]\n{odd}")).unwrap_err();
    assert!(error.to_string().contains("the unit of time: column 1 (t) has steps of 100"), "{error}");
}

#[test]
fn thousands_and_quotes_of_every_country() {
    let english = |x: f64| {
        let text = format!("{:.2}", x.abs());
        let (whole, part) = text.split_once('.').unwrap();
        let whole = if whole.len() > 3 {
            format!("{},{}", &whole[..whole.len() - 3], &whole[whole.len() - 3..])
        } else {
            whole.to_owned()
        };
        format!("{}{whole}.{part}", if x < 0.0 { "-" } else { "" })
    };
    let german = |x: f64| english(x).replace(',', "_").replace('.', ",").replace('_', ".");
    let swiss = |x: f64| english(x).replace(',', "'");
    check(&read(format!("time (ms),accel (g)\n{}", rows(|t, a| format!("\"{t:.1}\",\"{}\"", english(a))))).unwrap());
    check(&read(format!("Zeit [ms];a [g]\n{}", rows(|t, a| format!("{};{}", german(t), german(a))))).unwrap());
    check(&read(format!("Zeit [ms];a [g]\n{}", rows(|t, a| format!("{t:.1};{}", swiss(a))))).unwrap());
    let french = rows(|t, a| format!("{};{}", german(t), german(a).replace('.', "\u{a0}")));
    check(&read(format!("temps [ms];a [g]\n{french}")).unwrap());
    let latin: Vec<u8> = format!("temps [ms];a [g]\n{french}").chars().map(|c| c as u8).collect();
    check(&read(latin).unwrap());
    // Decimal commas in quotes between commas can be read; without quotes they cannot.
    let comma = |text: String| text.replace('.', ",");
    let quoted =
        |q: &str| rows(|t, a| format!("{q}{}{q},{q}{}{q}", comma(format!("{t:.1}")), comma(format!("{a:.2}"))));
    check(&read(format!("\"t [ms]\",\"a [g]\"\n{}", quoted("\""))).unwrap());
    let error = read(format!("t [ms],a [g]\n{}", quoted(""))).unwrap_err();
    assert!(error.to_string().contains("decimal commas between comma-separated fields"), "{error}");
}

#[test]
fn time_stands_where_its_name_says_and_styles_of_numbers_mix() {
    check(&read(format!("a [g];Zeit [ms]\n{}", rows(|t, a| format!("{a:.2};{t:.1}")))).unwrap());
    let mixed = rows(|t, a| {
        let t = if t.abs() < 1e-9 {
            "-3.93852E-11".to_owned()
        } else if t < 0.0 {
            format!("{t:.6E}")
        } else {
            format!("{t:.1}")
        };
        format!("  {t}   {}", if a < -1000.0 { format!("{a:.5e}") } else { format!("{a}") })
    });
    let ingested =
        read(format!("% made by hand\n// of two programs\n# time(ms), \t \t acceleration(g)\n{mixed}")).unwrap();
    check(&ingested);
    assert!(ingested.pulse().unwrap().quality.record.time_jitter < 1e-3);
}

#[test]
fn units_are_taken_by_name_and_never_by_size() {
    for (unit, factor) in
        [("g", G), ("mg", 1e-3 * G), ("kilo-g", 1e3 * G), ("ft/s^2", 0.3048), ("m/s2", 1.0), ("mm/s^2", 1e-3)]
    {
        let text = format!("time [ms],accel [{unit}]\n{}", rows(|t, _| format!("{t:.1},1")));
        let ingested = read(text).unwrap();
        let found = ingested.pulse().unwrap().samples.samples()[7];
        // One product.
        assert!((found / factor - 1.0).abs() < 1e-15, "{unit}: {found}");
    }
    let small = format!("time [ms],accel\n{}", rows(|t, a| format!("{t:.1},{}", a * 1e-6)));
    let huge = format!("time [ms],accel\n{}", rows(|t, a| format!("{t:.1},{}", a * 1e6)));
    for text in [small, huge] {
        assert!(read(text).unwrap_err().to_string().contains("no unit is stated"));
    }
}

#[test]
fn a_gap_in_time_and_uneven_steps_come_with_their_figures() {
    let uneven: String =
        (0..200).map(|k| format!("{:.4},{k}\n", f64::from(k) * 0.1 + if k % 2 == 1 { 0.02 } else { 0.0 })).collect();
    let error = read(format!("t [ms],a [g]\n{uneven}")).unwrap_err();
    assert!(error.to_string().contains("a step of 0.000") && error.hint().contains("resample"), "{error}");
}

#[test]
fn a_slow_pulse_is_said_to_be_too_slow_for_cfc_60() {
    let rows: String = (0..200).map(|k| format!("{},{}\n", 2 * k, k % 7)).collect();
    let ingested = read(format!("t [ms],a [g]\n{rows}")).unwrap();
    assert!(notes(&ingested).contains("warning: the pulse has 500.0 samples a second; CFC 60 needs at least 600"));
}

#[test]
fn several_inputs_and_outputs_of_any_quantity_need_no_crash() {
    let rows: String =
        (0..400).map(|k| format!("{:.3};{};{};{};{}\n", f64::from(k) * 1e-3, k % 5, k % 7, k % 11, k % 13)).collect();
    let text = format!("time [s];force [kN];voltage [V];displacement [mm];counter\n{rows}");
    let ingested = read(text).unwrap();
    let found: Vec<(&str, QuantityKind, f64)> =
        ingested.waves.iter().map(|w| (w.id.as_str(), w.quantity, w.samples.samples()[4])).collect();
    let expected = [
        ("force", QuantityKind::Force, 4000.0),
        ("voltage", QuantityKind::Voltage, 4.0),
        ("displacement", QuantityKind::Displacement, 0.004),
        ("counter", QuantityKind::Other, 4.0),
    ];
    assert_eq!(found, expected);
    assert_eq!(ingested.test.pulse, None);
}

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

fn read_report(text: &str, flags: &str) -> Result<Ingested, IngestError> {
    read_as("edr.csv", text, &given(flags))
}

#[test]
fn the_longitudinal_table_of_the_first_event_is_taken_and_the_others_are_named() {
    let ingested = read_report(&report(), "--profile edr").unwrap();
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
    assert_eq!(
        read_report(&report(), "--profile edr --channel *Event Record 2*").unwrap().test.pulse.as_deref(),
        Some("Velocity_Change-3")
    );
    let ingested = read_report(&report(), "--profile edr --skip-to lateral crash").unwrap();
    // The only change of velocity, across as it is.
    assert_eq!((ingested.waves.len(), ingested.test.pulse.as_deref()), (1, Some("Velocity_Change")));
    let error = read_report(&report(), "--profile edr --channel Velocity*").unwrap_err();
    assert!(error.to_string().contains("means 3 channels"), "{error}");
    let error = read_report(&report(), "--profile edr --skip-to Rollover").unwrap_err();
    assert_eq!(error.to_string(), "edr.csv: no line holds \"Rollover\"");
}

#[test]
fn the_list_shows_every_table() {
    let bundle = Bundle::from_bytes("edr.csv", report().into_bytes()).unwrap();
    let lines = list(&bundle, &given("--profile edr")).unwrap();
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
    let notes = read_report(&wrong, "--profile edr").unwrap().notes.to_texts().join("\n");
    assert!(notes.contains("1 cells of column Velocity Change say two different things in MPH and km/h"), "{notes}");
}

#[test]
fn without_the_profile_the_refusal_names_it() {
    let error = read_report(&report(), "").unwrap_err();
    assert!(error.hint().contains("--profile edr"), "{error}: {}", error.hint());
    let rows: String = (0..60).map(|k| format!("{},{}\n", 10 * k, -(k.min(50)))).collect();
    let error = read_report(&format!("Time (msec),Delta-V (km/h)\n{rows}"), "").unwrap_err();
    assert!(error.hint().contains("--profile edr"), "{error}: {}", error.hint());
}
