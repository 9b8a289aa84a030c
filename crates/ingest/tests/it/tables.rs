//! Tables: real records, synthetic ones with known truth, and facts stated in and beside them.

use std::fs;
use std::path::Path;

use crumple_ingest::{Bundle, IngestError, IngestSettings, Ingested, ingest};
use crumple_signal::{QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G};
use crumple_testkit::shared;

use crate::{given, lenient, notes, open, read_as};

fn from_text(text: &str, settings: &IngestSettings) -> Result<Ingested, IngestError> {
    read_as("crash.csv", text, settings)
}

fn from_path(path: &Path, settings: &IngestSettings) -> Ingested {
    open(path, settings).unwrap()
}

/// Mass and impact speed, and further flags.
fn stated_with(flags: &str) -> IngestSettings {
    given(&format!("--mass 873kg --impact-speed 13.4m/s {flags}"))
}

fn stated() -> IngestSettings {
    stated_with("")
}

/// `n` rows at 10 kHz from -20 ms, in g, quiet before t = 0 and -20 g sin after.
fn pulse(header: &str, n: usize) -> String {
    let rows = (0..n).map(|k| {
        let t = (k as f64 - 200.0) * 1e-4;
        let a = if t < 0.0 { 0.0 } else { -20.0 * (t * 30.0).sin() };
        format!("{t:.4},{a:.6}\n")
    });
    header.to_owned() + &rows.collect::<String>()
}

#[test]
fn every_known_truth_record_is_read_on_its_exact_grid() {
    let Some(folder) = shared("reference/known-truth") else { return };
    let mut read = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path().join("accel.csv");
        if !path.exists() {
            continue;
        }
        let ingested = from_path(&path, &stated());
        let pulse = ingested.pulse().unwrap();
        // Printed with four decimals: the grid must come back to the last bit.
        assert_eq!((pulse.samples.t0_s(), pulse.samples.dt_s()), (-0.02, 1e-4), "{}", path.display());
        assert_eq!((pulse.id.as_str(), pulse.quantity), ("accel_g", QuantityKind::Acceleration));
        // The text's own numbers, one product each: bit for bit.
        let text = fs::read_to_string(&path).unwrap();
        let values = text.lines().filter(|l| l.starts_with(['-', '0', '1'])).map(|l| l.split(',').nth(1).unwrap());
        let expected: Vec<f64> = values.map(|v| v.parse::<f64>().unwrap() * G).collect();
        assert_eq!(pulse.samples.samples(), expected, "{}", path.display());
        read += 1;
    }
    assert_eq!(read, 16);
}

#[test]
fn prose_in_comments_states_nothing() {
    let Some(path) = shared("reference/known-truth/kelvin-underdamped/accel.csv") else { return };
    let ingested = from_path(&path, &IngestSettings::default());
    assert!(notes(&ingested).contains("no impact speed is stated") && notes(&ingested).contains("no mass is stated"));
    assert_eq!((ingested.test.mass_kg, ingested.test.impact_speed_m_per_s), (None, None));
}

#[test]
fn the_accord_record_without_header_asks_for_its_unit() {
    let Some(path) = shared("data/iihs-cep1705-accord/CEP1705_ACXD.csv") else { return };
    let bundle = Bundle::open(&path).unwrap();
    let error = ingest(&bundle, &lenient()).unwrap_err();
    assert_eq!(error.to_string(), "CEP1705_ACXD.csv, column 2 (column 2): no unit is stated");
    assert!(error.hint().contains("--unit g"), "{}", error.hint());
    let settings = given("--allow-missing --unit g");
    let ingested = ingest(&bundle, &settings).unwrap();
    let pulse = ingested.pulse().unwrap();
    assert_eq!(pulse.samples.len(), 6000);
    assert_eq!((pulse.samples.t0_s(), pulse.samples.dt_s()), (-0.0999, 1e-4));
    // Time zero is printed as -3.93852E-11: 3.9e-7 of an interval.
    assert!(
        pulse.quality.record.time_jitter > 1e-8 && pulse.quality.record.time_jitter < 1e-6,
        "{}",
        pulse.quality.record.time_jitter
    );
    // Minimum and its time as stated with the record.
    let (at, minimum) = pulse.samples.samples().iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)).unwrap();
    assert!((minimum / G + 24.862).abs() < 5e-4 && (pulse.samples.time_s(at) - 0.058).abs() < 1e-9);
    assert!(notes(&ingested).contains("no unit of time is stated for column"));
}

/// `n` rows whose times count in units of `unit_s`, at `rate_hz` from -20 ms: a half sine of -20 g over 100 ms from
/// time 0, 12.49 m/s.
fn half_sine(unit_s: f64, rate_hz: f64, n: usize) -> String {
    let rows = (0..n).map(|k| {
        let t = (k as f64 - (0.02 * rate_hz).round()) / rate_hz;
        let a = if (0.0..=0.1).contains(&t) { -20.0 * (t * std::f64::consts::PI / 0.1).sin() } else { 0.0 };
        format!("{:.3},{a:.6}\n", t / unit_s)
    });
    "t,a [g]\n".to_owned() + &rows.collect::<String>()
}

#[test]
fn a_unit_of_time_that_nothing_states_is_asked_for_unless_the_impact_speed_proves_it() {
    // 12.49 m/s of a car that hits at 12 m/s: in ms, then in us; 100 kHz in steps of 10, 10 kHz in steps of 100.
    for (unit_s, rate_hz, symbol, step) in
        [(1e-3, 1e4, "ms", "0.1"), (1e-6, 1e5, "us", "10"), (1e-6, 1e4, "us", "100"), (1e-3, 1250.0, "ms", "0.8")]
    {
        let text = half_sine(unit_s, rate_hz, (0.2 * rate_hz) as usize);
        let ingested = from_text(&text, &given("--mass 1200kg --impact-speed 12m/s")).unwrap();
        let dt_s = ingested.pulse().unwrap().samples.dt_s();
        assert!((dt_s * rate_hz - 1.0).abs() < 1e-12, "{symbol} {dt_s}");
        let expected = format!("column 1 (t) has steps of {step}. It is {symbol}: with it the pulse stops the vehicle");
        assert!(notes(&ingested).contains(&expected), "{}", notes(&ingested));

        // Nothing proves it where no speed is stated, or one that the pulse cannot take. The advice works.
        for flags in ["--mass 1200kg", "--mass 1200kg --impact-speed 25m/s"] {
            let error = from_text(&text, &given(flags)).unwrap_err();
            let asked = format!("the unit of time: column 1 (t) has steps of {step}");
            assert!(error.to_string().ends_with(&asked), "{error}");
            let advice = format!("--time-unit {symbol}");
            assert!(error.hint().contains(&format!("{advice} (sampled at")), "{}", error.hint());
            let answered = from_text(&text, &given(&format!("{flags} {advice}"))).unwrap();
            assert_eq!(answered.pulse().unwrap().samples.dt_s(), dt_s);
        }
    }
}

#[test]
fn a_building_without_a_unit_of_time_is_no_crash_in_milliseconds() {
    let rows = (0..500).map(|k| {
        let t = f64::from(k) * 0.04;
        format!("{t:.2},{:.6}\n", 1e-3 * (t * 9.46).sin())
    });
    let text = "t,a [g]\n".to_owned() + &rows.collect::<String>();
    for flags in ["--allow-missing", "--allow-missing --mass 1200kg --impact-speed 50km/h"] {
        let error = from_text(&text, &given(flags)).unwrap_err();
        let hint = "add --time-unit s (sampled at 25 Hz) or --time-unit ms (sampled at 25 kHz), whichever it is";
        assert_eq!(error.hint(), hint);
    }
    let ingested = from_text(&text, &given("--allow-missing --time-unit s")).unwrap();
    assert_eq!(ingested.pulse().unwrap().samples.dt_s(), 0.04);
}

#[test]
fn repeated_shock_records_with_odd_headers_are_read() {
    let Some(folder) = shared("data/pcb-shock-txt") else { return };
    let base = from_path(&folder.join("acc_base_a0.txt"), &lenient());
    let pulse = base.pulse().unwrap();
    assert_eq!((pulse.id.as_str(), pulse.samples.len()), ("acceleration", 1439));
    // The interval is an artefact of the source and kept: 20.00278 us, to the digits stated with the record.
    assert!((pulse.samples.dt_s() - 2.000_278e-5).abs() < 5e-12, "{}", pulse.samples.dt_s());
    assert!((pulse.quality.record.maximum / G - 485.972).abs() < 5e-4);

    let board = from_path(&folder.join("acc_pcb_a0.txt"), &lenient());
    let pulse = board.pulse().unwrap();
    assert_eq!((pulse.samples.len(), pulse.samples.dt_s()), (5500, 2e-5));
    assert!(
        (pulse.quality.record.minimum / G + 546.405).abs() < 1e-3
            && (pulse.quality.record.maximum / G - 546.555).abs() < 1e-3
    );
    assert!(pulse.quality.record.clipped_run >= 3);
    assert!(notes(&board).contains("may be clipped"));
}

#[test]
fn kilo_g_and_surplus_names_of_the_drop_tower() {
    let Some(path) = shared("data/drop-tower-csv/accel_1.csv") else { return };
    let bundle = Bundle::open(&path).unwrap();
    let unnamed = ingest(&bundle, &lenient()).unwrap();
    assert_eq!((unnamed.test.pulse.as_deref(), unnamed.waves.len()), (None, 5));
    assert!(notes(&unnamed).contains("no pulse is named (--channel names one): accel_1.csv: 5 acceleration columns"));
    let error = ingest(&bundle, &stated()).unwrap_err();
    assert_eq!(error.to_string(), "accel_1.csv: 5 acceleration columns: accel_1, accel_2, accel_3, accel_4, accel_top");
    let settings = given("--allow-missing --channel accel 3");
    let ingested = ingest(&bundle, &settings).unwrap();
    assert_eq!(ingested.test.pulse.as_deref(), Some("accel_3"));
    let text = notes(&ingested);
    assert!(text.contains("7 names in the header of accel_1.csv, but 6 columns") && text.contains("kilo-g"), "{text}");
    // Column maxima stated with the record, to their last digit.
    for (wave, kilo_g) in ingested.waves.iter().zip([21.41, 23.23, 25.41, 26.64, 26.67]) {
        assert_eq!((wave.samples.len(), wave.samples.t0_s(), wave.samples.dt_s()), (5000, 0.0, 1e-6));
        assert!((wave.quality.record.maximum / (1e3 * G) - kilo_g).abs() < 0.005, "{}", wave.id);
    }
}

#[test]
fn header_comments_state_the_test() {
    let header = "# Title: Test 7\n# vehicle: Ford Fiesta\n# mass: 873 kg\n# Impact_Speed: 36 km/h\n# barrier: pole\n\
        # unit: g\ntime_s,accel\n";
    let ingested = from_text(&pulse(header, 500), &IngestSettings::default()).unwrap();
    let test = &ingested.test;
    assert_eq!(
        (test.title.as_str(), test.vehicle.as_deref(), test.barrier.as_deref()),
        ("Test 7", Some("Ford Fiesta"), Some("pole"))
    );
    assert_eq!((test.mass_kg, test.impact_speed_m_per_s), (Some(873.0), Some(10.0)));
    assert_eq!(test.source.format, "csv");
    let quality = &ingested.pulse().unwrap().quality;
    assert_eq!(quality.pre_event.map(|p| (p.zero_level, p.samples)), Some((0.0, 101)));
}

#[test]
fn a_sidecar_beats_comments_and_a_flag_beats_both() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("crash.csv");
    fs::write(&path, pulse("# mass: 873 kg\n# impact speed: 36 km/h\ntime_s,accel\n", 500)).unwrap();
    fs::write(folder.path().join("crash.csv.toml"), "mass = \"900 kg\"\nunit = \"g\"\n").unwrap();
    let bundle = Bundle::open(&path).unwrap();
    assert_eq!(ingest(&bundle, &IngestSettings::default()).unwrap().test.mass_kg, Some(900.0));
    let settings = given("--mass 1t");
    let ingested = ingest(&bundle, &settings).unwrap();
    assert_eq!(ingested.test.mass_kg, Some(1000.0));
    let text = notes(&ingested);
    assert!(text.contains("mass is 1000 kg by flag; crash.csv.toml says 900 kg"), "{text}");
}

#[test]
fn time_zero_shifts_the_axis_and_sign_turns_the_pulse() {
    let settings = stated_with("--time-zero 5ms --sign flip");
    let text = pulse("time_s,accel_g\n", 800);
    let ingested = from_text(&text, &settings).unwrap();
    let plain = from_text(&text, &stated()).unwrap();
    let (turned, kept) = (ingested.pulse().unwrap(), plain.pulse().unwrap());
    assert_eq!(turned.samples.t0_s(), -0.025);
    assert!(turned.samples.samples().iter().zip(kept.samples.samples()).all(|(a, b)| *a == -*b));
    // Turned the wrong way: turning it is not advised again.
    assert!(notes(&ingested).contains("leave --sign out") && !notes(&ingested).contains("use --sign flip"));
    assert!(!notes(&plain).contains("--sign"));
}

#[test]
fn spreadsheet_exports_read_like_plain_ones() {
    let plain = from_text(&pulse("time_s,accel_g\n", 300), &stated()).unwrap();
    let expected = &plain.pulse().unwrap().samples;
    let rows: Vec<(f64, f64)> = (0..300).map(|k| (expected.time_s(k), expected.samples()[k] / G)).collect();
    let comma = |x: f64, digits: usize| format!("{x:.digits$}").replace('.', ",");
    let german: String = rows.iter().map(|(t, a)| format!("{};{}\r\n", comma(t * 1e3, 1), comma(*a, 6))).collect();
    let mut latin = b"Zeit [ms];Verz\xF6gerung [g]\r\n".to_vec();
    latin.extend(german.as_bytes());
    let utf16: Vec<u8> = "\u{feff}t (s)\ta (g)\n"
        .chars()
        .chain(rows.iter().map(|(t, a)| format!("{t:.4}\t{a:.6}\n")).collect::<String>().chars())
        .flat_map(|c| (c as u16).to_le_bytes())
        .collect();
    let units: String = rows.iter().map(|(t, a)| format!("\"{t:.4}\" , {a:.6}\n")).collect();
    for bytes in [latin, utf16, format!("\u{feff}t,a\ns,g\n{units}").into_bytes()] {
        let ingested = ingest(&Bundle::from_bytes("x.txt", bytes).unwrap(), &stated()).unwrap();
        let pulse = ingested.pulse().unwrap();
        assert_eq!((pulse.samples.t0_s(), pulse.samples.dt_s()), (-0.02, 1e-4));
        // The values went through /G and six printed decimals again.
        let error =
            pulse.samples.samples().iter().zip(expected.samples()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(error < 1e-9, "{error}");
    }
}

#[test]
fn other_quantities_are_kept_beside_the_pulse() {
    let rows: String =
        (0..100).map(|k| format!("{:.4},{:.3},{k},{k},{k}\n", f64::from(k) * 1e-4, -0.1 * f64::from(k))).collect();
    let ingested = from_text(&format!("time_s,accel_x_cfc60_g,force_kN,strain,Sample\n{rows}"), &stated()).unwrap();
    let kinds: Vec<_> = ingested.waves.iter().map(|w| (w.id.as_str(), w.quantity, w.samples.samples()[2])).collect();
    assert_eq!(kinds[1], ("force_kN", QuantityKind::Force, 2000.0));
    assert_eq!(kinds[2], ("strain", QuantityKind::Other, 2.0));
    assert_eq!(kinds.len(), 3);
    let channel = &ingested.test.channels[0];
    assert_eq!((channel.axis, channel.cfc), (Some(crumple_signal::Axis::X), Some(60)));
    assert!(notes(&ingested).contains("no unit is known for strain"));
    assert!(notes(&ingested).contains("column 5 (Sample) counts the rows: left out"));
}

#[test]
fn the_digest_of_a_table_is_that_of_its_bytes() {
    let text = pulse("time_s,accel_g\n", 300);
    let ingested = from_text(&text, &stated()).unwrap();
    assert_eq!(ingested.test.source.digest, format!("blake3:{}", blake3::hash(text.as_bytes()).to_hex()));
}

/// A report of an event data recorder: a preamble, a pre-crash table, the crash table, another one.
fn recorder_report() -> String {
    let rows: String = (0..26).map(|k| format!("{},-{}\n", 10 * k, (6 * k).min(54))).collect();
    format!(
        "CDR Report,v21\nPre-Crash Data\nTime (sec),Speed (km/h)\n-5,60\n-4,61\n\n\
         Longitudinal Crash Pulse (Event Record 1)\n\
         Time (msec),\"Delta-V, longitudinal (km/h)\"\n{rows}\nLateral\n0,1\n"
    )
}

#[test]
fn a_table_of_an_event_data_recorder_is_a_change_of_velocity() {
    let settings = given("--profile edr --skip-to longitudinal crash pulse");
    let ingested = from_text(&recorder_report(), &settings).unwrap();
    assert_eq!((ingested.test.pulse.as_deref(), ingested.waves.len()), (Some("Delta-V_longitudinal"), 1));
    let wave = &ingested.waves[0];
    assert_eq!((wave.quantity, wave.samples.len(), wave.samples.dt_s()), (QuantityKind::VelocityChange, 26, 0.01));
    assert!((wave.quality.record.minimum + 15.0).abs() < 1e-12, "54 km/h are 15 m/s");
    assert!(notes(&ingested).contains("event data recorder table"));
    // Without its title the crash table is found all the same.
    let found = from_text(&recorder_report(), &given("--profile edr")).unwrap();
    assert_eq!(found.waves[0].samples, wave.samples);
    assert!(notes(&found).contains("other tables of the report, not read: \"Pre-Crash Data\""), "{}", notes(&found));
    let error = from_text(&recorder_report().replace("(km/h)", ""), &settings).unwrap_err();
    assert!(error.hint().contains("--unit km/h"), "{error}: {}", error.hint());
}

#[test]
fn a_table_without_a_time_column_needs_its_interval() {
    let rows: String = (0..100).map(|k| format!("{} {}\n", (k * 37) % 11, (k * 17) % 7)).collect();
    let error = from_text(&rows, &lenient()).unwrap_err();
    assert!(error.hint().contains("--sample-time"), "{}", error.hint());
    let settings = given("--allow-missing --sample-time 2ms");
    let ingested = from_text(&rows, &settings).unwrap();
    assert_eq!((ingested.waves.len(), ingested.waves[1].samples.dt_s()), (2, 2e-3));
    let one: String = (0..100).map(|k| format!("{}\n", (k * 37) % 11)).collect();
    assert_eq!(from_text(&one, &settings).unwrap().waves[0].samples.len(), 100);
    let growing: String = (0..100).map(|k| format!("{} {}\n", 2 * k, (k * 17) % 7)).collect();
    let error = from_text(&format!("time,a\n{growing}"), &settings).unwrap_err();
    assert!(error.to_string().contains("column time is named as time"), "{error}");
}

#[test]
fn a_pattern_means_one_column_or_is_refused() {
    let rows: String = (0..100).map(|k| format!("{:.4},{k},{k}\n", f64::from(k) * 1e-4)).collect();
    let text = format!("time_s,left_g,right_g\n{rows}");
    let named = |channel: &str| from_text(&text, &given(&format!("--allow-missing --channel {channel}")));
    assert_eq!(named("le*").unwrap().test.pulse.as_deref(), Some("left_g"));
    let error = named("*_g").unwrap_err();
    assert!(error.to_string().contains("--channel *_g means 2 columns: left_g, right_g"), "{error}");
}

#[test]
fn the_unit_of_a_long_table_is_asked_for_before_its_rows_are_read() {
    let refused = |text: &str| from_text(text, &stated()).unwrap_err();
    let (short, long) = (pulse("time_s,accel\n", 600), pulse("time_s,accel\n", 80_000));
    assert!(long.len() > 1 << 20);
    // What stands further down is not looked at: the same question as of the start alone.
    let asked = refused(&(long.clone() + "0.1,no number\n"));
    assert_eq!((asked.to_string(), asked.hint()), (refused(&short).to_string(), refused(&short).hint()));
    assert!(asked.to_string().contains("no unit is stated"), "{asked}");
    let stated = from_text(&long, &stated_with("--unit g")).unwrap();
    assert_eq!(stated.pulse().unwrap().samples.len(), 80_000);
}

#[test]
fn columns_named_by_channel_codes_are_decoded_and_the_pulse_is_found_by_place() {
    let header = "time_s,10ENGN000000ACXP (g),10VEHCCG0000ACXD (g),10SECMLERE00AC1P (g)\n";
    let rows: String = (0..400)
        .map(|k| {
            let a = if k < 200 { 0.0 } else { -20.0 * (f64::from(k - 200) * 0.01).sin() };
            format!("{:.4},{a:.4},{a:.4},{a:.4}\n", f64::from(k - 200) * 1e-4)
        })
        .collect();
    let ingested = from_text(&(header.to_owned() + &rows), &stated()).unwrap();
    let channel = |id: &str| ingested.test.channel(id).unwrap().clone();
    let body = channel("10VEHCCG0000ACXD");
    assert_eq!((body.cfc, body.location.as_str()), (Some(60), "vehicle, centre of gravity"));
    assert_eq!(body.code.as_deref(), Some("10VEHCCG0000ACXD"));
    assert_eq!(ingested.test.pulse.as_deref(), Some("10SECMLERE00AC1P"));
    assert!(channel("10SECMLERE00AC1P").polarity.is_some());
    // Without units: both are accelerations by their codes, and the flag is for them.
    let bare = header.replace(" (g)", "");
    let error = from_text(&(bare.clone() + &rows), &stated()).unwrap_err();
    assert!(error.to_string().contains("no unit is stated"), "{error}");
    let settings = stated_with("--unit g");
    let ingested = from_text(&(bare + &rows), &settings).unwrap();
    assert!(ingested.test.channels.iter().all(|c| c.quantity == QuantityKind::Acceleration));
}

#[test]
fn a_unit_by_flag_serves_all_columns_named_as_accelerations() {
    let rows: String = (0..400).map(|k| format!("{:.4},{},{},{}\n", f64::from(k) * 1e-4, -k, -2 * k, 3 * k)).collect();
    let settings = stated_with("--unit g --channel acc_left");
    let ingested = from_text(&format!("time_s,acc_left,acc_right,force\n{rows}"), &settings).unwrap();
    let quantities: Vec<QuantityKind> = ingested.waves.iter().map(|wave| wave.quantity).collect();
    assert_eq!(quantities, [QuantityKind::Acceleration, QuantityKind::Acceleration, QuantityKind::Other]);
    assert_eq!(ingested.waves[1].samples.samples()[1], -2.0 * G);
}

#[test]
fn the_sign_is_turned_by_auto_only_where_it_is_certainly_wrong() {
    // 30 g half sine over 90 ms: a change of 16.9 m/s.
    let text = |peak: f64| -> String {
        let at = |t: f64| if (0.0..0.09).contains(&t) { peak * (std::f64::consts::PI * t / 0.09).sin() } else { 0.0 };
        let rows = (0..2000).map(|k| (f64::from(k) - 500.0) * 1e-4).map(|t| format!("{t:.4},{:.6}\n", at(t)));
        format!("time_s,accel_g\n{}", rows.collect::<String>())
    };
    let run = |peak: f64, speed: &str| {
        let settings = given(&format!("--mass 873kg --impact-speed {speed} --sign auto"));
        let ingested = from_text(&text(peak), &settings).unwrap();
        (ingested.pulse().unwrap().samples.samples()[950] < 0.0, notes(&ingested))
    };
    let (negative, said) = run(30.0, "15m/s");
    assert!(negative && said.contains("sign turned by --sign auto") && !said.contains("--sign flip"), "{said}");
    let (negative, said) = run(-30.0, "15m/s");
    assert!(negative && said.contains("sign kept: "), "{said}");
    // A gain of a third of the speed proves nothing.
    let (negative, said) = run(30.0, "50m/s");
    assert!(!negative && said.contains("not certain"), "{said}");
}

#[test]
fn what_states_time_zero_travels_with_the_test() {
    let text = pulse("time_s,accel_g\n", 600);
    let rule = |settings| from_text(&text, &settings).unwrap().test.contact.unwrap().rule;
    assert_eq!([rule(stated()), rule(stated_with("--time-zero 0s"))], ["file", "stated by flag"]);
}

#[test]
fn columns_of_heads_leave_the_vehicle_as_the_pulse_and_alone_they_need_no_mass_and_speed() {
    let rows = |columns: usize| -> String {
        (0..800).map(|k| format!("{:.4}{}\n", -0.02 + 1e-4 * f64::from(k), ",1.5".repeat(columns))).collect()
    };
    let both = format!("time_s,head_x_g,head_y_g,sill_x_g\n{}", rows(3));
    assert_eq!(from_text(&both, &stated()).unwrap().test.pulse.as_deref(), Some("sill_x_g"));
    let two = format!("time_s,head_x_g,left_x_g,right_x_g\n{}", rows(3));
    assert!(from_text(&two, &stated()).is_err(), "which of both sides is asked back");
    let heads = from_text(&format!("time_s,head_y_g,head_x_g\n{}", rows(2)), &IngestSettings::default()).unwrap();
    assert_eq!(heads.test.pulse.as_deref(), Some("head_x_g"));
    assert_eq!((heads.test.mass_kg, heads.test.impact_speed_m_per_s), (None, None));
    assert!(notes(&heads).contains("the criteria of an occupant need neither") && !notes(&heads).contains("--sign"));
}

#[test]
fn records_for_identification_need_neither_time_column_nor_crash() {
    let Some(folder) = shared("data/sysid") else { return };
    let stated = |interval: &str| given(&format!("--allow-missing --sample-time {interval}"));
    let dryer = from_path(&folder.join("hair-dryer/dryer.dat"), &stated("0.08s"));
    assert_eq!((dryer.waves.len(), dryer.test.pulse.as_deref()), (2, None));
    let input = &dryer.waves[0];
    assert_eq!((input.quantity, input.samples.len(), input.samples.dt_s()), (QuantityKind::Other, 1000, 0.08));
    assert_eq!(input.samples.samples()[..2], [6.41, 3.41]);
    let frame = folder.join("steel-subframe-a/steel_subframe_u1u2_y01-y06.csv");
    let frame = from_path(&frame, &stated("0.0009765625s"));
    assert_eq!((frame.waves.len(), frame.waves[0].id.as_str(), frame.waves[7].samples.rate_hz()), (8, "u1", 1024.0));
}
