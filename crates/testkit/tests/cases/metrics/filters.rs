//! Channel frequency classes, zero level and time zero: the filter's library.

use crumple_metrics::{ThresholdRule, time_zero_by_threshold, time_zero_by_velocity_change};
use crumple_signal::{
    Cfc, CfcMode, Coefficients, PreEventWindow, STANDARD_GRAVITY_M_PER_S2, Sampled, Signal, filter_both_ways,
    pre_event, samples_added,
};
use crumple_testkit::reference_signals::{list, number, text};
use serde_json::json;

use crate::metrics::check::Check;

pub fn cfc(class: f64) -> Cfc {
    Cfc::ALL.into_iter().find(|cfc| cfc.frequency_hz() == class).unwrap()
}

pub fn mode(name: &str) -> CfcMode {
    [CfcMode::Iso6487, CfcMode::SaeReflect, CfcMode::SaeZeroState].into_iter().find(|mode| mode.name() == name).unwrap()
}

/// The cases name the standard where the ends do not matter.
fn of_standard(check: &Check<'_>) -> Coefficients {
    let mode = match text(&check.case["params"]["standard"]) {
        "sae" => CfcMode::SaeReflect,
        "iso" => CfcMode::Iso6487,
        other => panic!("standard {other}"),
    };
    Coefficients::new(cfc(check.param("cfc")), mode, 1.0 / check.param("fs_hz"))
}

pub fn coefficients(check: &mut Check<'_>) {
    let found = of_standard(check).to_array();
    for (name, value) in ["a0", "a1", "a2", "b1", "b2"].into_iter().zip(found) {
        check.close(name, value);
    }
}

pub fn two_pass_response(check: &mut Check<'_>) {
    let coefficients = of_standard(check);
    let frequencies: Vec<f64> = list(&check.case["params"]["f_hz"]).iter().map(number).collect();
    let gains = |f: &dyn Fn(f64) -> f64| frequencies.iter().map(|hz| f(*hz)).collect::<Vec<f64>>();
    check.close_list("gain", &gains(&|hz| coefficients.two_pass_gain(hz)));
    check.close_list("gain_db", &gains(&|hz| coefficients.two_pass_gain_db(hz)));
}

pub fn filter(check: &mut Check<'_>) {
    let signal = check.signal(0);
    let coefficients =
        Coefficients::new(cfc(check.param("cfc")), mode(text(&check.case["params"]["mode"])), signal.dt_s());
    let y = filter_both_ways(signal.samples(), 0.0, &coefficients).unwrap();
    if check.has_param("n_pad") && samples_added(signal.len(), &coefficients) as f64 != check.param("n_pad") {
        check.fail(format!("{} samples added", samples_added(signal.len(), &coefficients)));
    }
    let indices: Vec<usize> =
        list(&check.case["expected"]["indices"]).iter().map(|i| i.as_u64().unwrap() as usize).collect();
    check.looked_at("indices");
    check.close_list("values", &indices.iter().map(|i| y[*i]).collect::<Vec<f64>>());
    let (mut highest, mut lowest) = (0, 0);
    for k in 0..y.len() {
        highest = if y[k] > y[highest] { k } else { highest };
        lowest = if y[k] < y[lowest] { k } else { lowest };
    }
    check.close("max", y[highest]);
    check.close("min", y[lowest]);
    check.equal("argmax", json!(highest));
    check.equal("argmin", json!(lowest));
    check.close("l2", y.iter().map(|y| y * y).sum::<f64>().sqrt());
}

pub fn zero_and_time_zero(check: &mut Check<'_>) {
    let signal = check.signal(0);
    let window = &check.case["params"]["bias_window_s"];
    let window = PreEventWindow { from_s: number(&window[0]), to_s: number(&window[1]) };
    let bias = pre_event(&signal, window).unwrap();
    check.close("bias_g", bias.zero_level);
    check.equal("bias_samples", json!(bias.samples));

    let g = STANDARD_GRAVITY_M_PER_S2;
    let level: Sampled = Sampled::new(
        signal.t0_s(),
        signal.dt_s(),
        signal.samples().iter().map(|a| (a - bias.zero_level) * g).collect(),
    )
    .unwrap();
    let acceleration = Signal::from(level);
    let rule = ThresholdRule { threshold_m_per_s2: check.param("threshold_g") * g, hold_s: check.param("hold_s") };
    check.metric("t0_threshold_s", &time_zero_by_threshold(&acceleration, rule), 1.0);
    check.metric("t0_edr_s", &time_zero_by_velocity_change(&acceleration), 1.0);
}
