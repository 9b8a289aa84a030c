//! Coefficients, response and filtered samples against the reference cases.

use crumple_signal::{
    Cfc, CfcMode, Class, Coefficients, FilterSettings, PreEventWindow, STANDARD_GRAVITY_M_PER_S2, Sampled, ZeroLevel,
    filter, pre_event_within,
};
use crumple_testkit::reference_signals::{Case, Reference, assert_close, number, text, two_columns};

fn cfc(case: &Case) -> Cfc {
    match serde_json::from_value(case["params"]["cfc"].clone()).unwrap() {
        Class::Cfc(cfc) => cfc,
        Class::None => panic!("a case without a class"),
    }
}

/// The cases name the standard where the ends do not matter.
fn standard(case: &Case) -> CfcMode {
    match text(&case["params"]["standard"]) {
        "sae" => CfcMode::SaeReflect,
        "iso" => CfcMode::Iso6487,
        other => panic!("standard {other}"),
    }
}

fn mode(case: &Case) -> CfcMode {
    serde_json::from_value(case["params"]["mode"].clone()).unwrap()
}

#[test]
fn coefficients_are_those_of_the_standards() {
    let Some(reference) = Reference::open() else { return };
    for case in reference.cases("cfc-coef-", "cfc.coefficients") {
        let found = Coefficients::new(cfc(case), standard(case), 1.0 / number(&case["params"]["fs_hz"]));
        for (name, value) in ["a0", "a1", "a2", "b1", "b2"].into_iter().zip(found.to_array()) {
            assert_close(case, name, value, number(&case["expected"][name]));
        }
    }
}

#[test]
fn two_passes_have_the_gain_of_the_closed_form() {
    let Some(reference) = Reference::open() else { return };
    for case in reference.cases("cfc-resp-", "cfc.two_pass_response") {
        let coefficients = Coefficients::new(cfc(case), standard(case), 1.0 / number(&case["params"]["fs_hz"]));
        let list = |value: &serde_json::Value| value.as_array().unwrap().iter().map(number).collect::<Vec<f64>>();
        let (gains, gains_db) = (list(&case["expected"]["gain"]), list(&case["expected"]["gain_db"]));
        for ((f_hz, gain), gain_db) in list(&case["params"]["f_hz"]).into_iter().zip(gains).zip(gains_db) {
            assert_close(case, "gain", coefficients.two_pass_gain(f_hz), gain);
            assert_close(case, "gain in dB", coefficients.two_pass_gain_db(f_hz), gain_db);
        }
    }
}

#[test]
fn filtered_samples_are_those_of_an_independent_implementation() {
    let Some(reference) = Reference::open() else { return };
    for case in reference.cases("cfc-", "cfc.filter") {
        let signal = reference.signal(text(&case["signals"][0]));
        let settings = FilterSettings {
            class: Class::Cfc(cfc(case)),
            mode: mode(case),
            zero_level: ZeroLevel::None,
            butterworth: None,
        };
        let filtered = filter(&signal, None, &settings).unwrap();
        let (y, expected) = (filtered.samples.samples(), &case["expected"]);
        let added = filtered.applied.unwrap().samples_added();
        assert_eq!(Some(added as u64), case["params"]["n_pad"].as_u64(), "{}", case["id"]);

        let indices = expected["indices"].as_array().unwrap();
        for (index, value) in indices.iter().zip(expected["values"].as_array().unwrap()) {
            let index = index.as_u64().unwrap() as usize;
            assert_close(case, &format!("sample {index}"), y[index], number(value));
        }
        let (mut highest, mut lowest) = (0, 0);
        for k in 0..y.len() {
            highest = if y[k] > y[highest] { k } else { highest };
            lowest = if y[k] < y[lowest] { k } else { lowest };
        }
        assert_close(case, "max", y[highest], number(&expected["max"]));
        assert_close(case, "min", y[lowest], number(&expected["min"]));
        assert_eq!(Some(highest as u64), expected["argmax"].as_u64(), "{} argmax", case["id"]);
        assert_close(case, "l2", y.iter().map(|v| v * v).sum::<f64>().sqrt(), number(&expected["l2"]));
    }
}

#[test]
fn the_zero_level_is_the_mean_before_the_event() {
    let Some(reference) = Reference::open() else { return };
    for case in reference.cases("zero-", "ingest.zero_and_time_zero") {
        let window = &case["params"]["bias_window_s"];
        let window = PreEventWindow { from_s: number(&window[0]), to_s: number(&window[1]) };
        let found = pre_event_within(&reference.signal(text(&case["signals"][0])), window).unwrap();
        assert_close(case, "bias", found.zero_level, number(&case["expected"]["bias_g"]));
        assert_eq!(Some(found.samples as u64), case["expected"]["bias_samples"].as_u64());
    }
}

/// Time of the first zero of velocity and displacement there, by the trapezoid from time zero.
fn crush(acceleration: &Sampled, v0_m_per_s: f64) -> (f64, f64) {
    let (a, dt) = (acceleration.samples(), acceleration.dt_s());
    let (mut v, mut x) = (v0_m_per_s, 0.0);
    for k in acceleration.index_at_or_after(0.0) + 1..a.len() {
        let next = v + dt * (a[k - 1] + a[k]) / 2.0;
        if next <= 0.0 {
            let since = dt * v / (v - next);
            return (acceleration.time_s(k - 1) + since, x + since * v / 2.0);
        }
        x += dt * (v + next) / 2.0;
        v = next;
    }
    panic!("the velocity never reaches zero");
}

#[test]
fn peak_and_crush_are_those_of_an_independent_calculation() {
    let Some(reference) = Reference::open() else { return };
    for case in reference.cases("real-nhtsa-10146-", "record.end_to_end") {
        let (params, expected) = (&case["params"], &case["expected"]);
        let Some(path) = crumple_testkit::shared(text(&params["file"])) else { return };
        let record = two_columns(&path, '\t');
        for (class, key) in
            [(Class::None, "raw"), (Class::Cfc(Cfc::Cfc60), "cfc60"), (Class::Cfc(Cfc::Cfc180), "cfc180")]
        {
            let settings = FilterSettings { class, mode: CfcMode::Iso6487, ..FilterSettings::default() };
            assert!(matches!(settings.zero_level, ZeroLevel::PreEvent(_)));
            let filtered = filter(&record, None, &settings).unwrap();
            let close = |what: &str, found: f64, expected: f64, limit: f64| {
                assert!((found - expected).abs() <= limit, "{} {key} {what}: {found}, not {expected}", case["id"]);
            };
            // Tolerances of the case: 1e-6 relative on values, a sample on times.
            let relative = number(&case["tolerance"]["rel"]);
            let sample = number(&case["tolerance"]["abs_t"]);
            let value = |what: &str, found: f64, expected: &serde_json::Value| {
                close(what, found, number(expected), relative * number(expected).abs());
            };
            value("bias", filtered.zero_level_removed / STANDARD_GRAVITY_M_PER_S2, &expected["bias_g"]);

            let after = filtered.samples.slice(filtered.samples.index_at_or_after(0.0), usize::MAX);
            let lowest = (0..after.len()).min_by(|&i, &j| after.samples()[i].total_cmp(&after.samples()[j])).unwrap();
            value("minimum", after.samples()[lowest] / STANDARD_GRAVITY_M_PER_S2, &expected[key]["min_g"]);
            close("its time", after.time_s(lowest), number(&expected[key]["t_min_s"]), sample);
            let (t_m, c) = crush(&filtered.samples, number(&params["v0_ms"]));
            value("t_m", t_m, &expected[key]["t_m_s"]);
            value("crush", c, &expected[key]["dynamic_crush_m"]);
        }
    }
}

#[test]
fn cfc_60_and_cfc_180_give_the_same_crush_on_all_four_rear_seat_channels() {
    for channel in ["093", "094", "099", "100"] {
        let Some(path) = crumple_testkit::shared(&format!("data/nhtsa-v10146-camry-frontal/v10146.{channel}")) else {
            return;
        };
        let record = two_columns(&path, '\t');
        let [(_, low), (_, high)] = [Cfc::Cfc60, Cfc::Cfc180].map(|cfc| {
            let settings = FilterSettings { class: Class::Cfc(cfc), ..FilterSettings::default() };
            crush(&filter(&record, None, &settings).unwrap().samples, 57.09 / 3.6)
        });
        // Low-pass filtering keeps the integral up to its ends; 0.2 mm is what these four records show, 1 mm is a
        // finding.
        assert!((low - high).abs() < 2.5e-4, "{channel}: {low} m, {high} m");
    }
}
