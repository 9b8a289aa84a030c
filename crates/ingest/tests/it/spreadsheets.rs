//! Tables as people's programs write them: section by section what a reader of CSV has to stand.

use crumple_ingest::{Bundle, IngestError, IngestSettings, Ingested, ingest};
use crumple_signal::{QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G};

fn read(text: impl Into<Vec<u8>>) -> Result<Ingested, IngestError> {
    read_with(text, &IngestSettings { allow_missing: Some(true), ..IngestSettings::default() })
}

fn read_with(text: impl Into<Vec<u8>>, settings: &IngestSettings) -> Result<Ingested, IngestError> {
    ingest(&Bundle::from_bytes("a.txt", text.into())?, settings)
}

fn notes(ingested: &Ingested) -> String {
    ingested.notes.to_texts().join("\n")
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
fn milliseconds_without_a_unit_are_told_by_their_step_and_said() {
    let text = format!("t,a [g]\n{}", rows(|t, a| format!("{t:.1},{a:.2}")));
    let ingested = read(text.clone()).unwrap();
    check(&ingested);
    assert!(notes(&ingested).contains("taken as ms, since the steps are 0.100000; --time-unit overrides"));
    let seconds =
        IngestSettings { allow_missing: Some(true), time_unit: Some("s".to_owned()), ..IngestSettings::default() };
    assert_eq!(read_with(text, &seconds).unwrap().pulse().unwrap().samples.dt_s(), 0.1);
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
    assert!(notes(&ingested).contains("warning: the pulse has 500.0 samples a second: CFC 60 needs 600 at least"));
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
