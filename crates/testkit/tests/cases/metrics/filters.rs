//! Filters, models and real records among the cases of metrics.

use crumple_lumped::{CoefficientMatching, Kelvin, MatchedSolution, Reading};
use crumple_lumped_fit::{KelvinBranch, MaxwellExponents, elastoplastic_from_events, kelvin_from_events};
use crumple_metrics::{ThresholdRule, peak, time_zero_by_threshold, time_zero_by_velocity_change};
use crumple_numerics::lti::{Complex, Mode};
use crumple_signal::{
    Cfc, CfcMode, Coefficients, PreEventWindow, STANDARD_GRAVITY_M_PER_S2, Sampled, Signal, filter_both_ways,
    pre_event_within, samples_added,
};
use crumple_testkit::reference_signals::{list, number, text, two_columns};
use serde_json::{Value, json};

use crate::metrics::Motion;
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
    let bias = pre_event_within(&signal, window).unwrap();
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

pub fn kelvin(check: &mut Check<'_>) {
    let (v0, mass_kg) = (check.param("v0_ms"), check.param("mass_kg"));
    let (t_m, crush) = if check.has_param("omega") {
        // There and back: the events of the model, and the model from the events.
        let (omega, zeta) = (check.param("omega"), check.param("zeta"));
        let model = Kelvin {
            mass_kg,
            stiffness_n_per_m: mass_kg * omega * omega,
            damping_n_s_per_m: 2.0 * zeta * omega * mass_kg,
        };
        let events = model.events(v0);
        (events.time_of_dynamic_crush_s.unwrap(), events.dynamic_crush_m.unwrap())
    } else {
        (check.param("t_m_s"), check.param("dynamic_crush_m"))
    };
    let found = kelvin_from_events(mass_kg, v0, t_m, crush).unwrap();
    check.close("t_m_s", t_m);
    check.close("dynamic_crush_m", crush);
    check.close("tc_over_tm", found.time_ratio);
    check.close("tc_s", found.time_ratio * t_m);
    check.close("omega", found.natural_frequency_rad_per_s);
    check.close("zeta", found.damping_ratio);
    check.close("k_N_per_m", found.model.stiffness_n_per_m);
    check.close("c_Ns_per_m", found.model.damping_n_s_per_m);
    let (undamped, model_t_m) = match found.branch {
        KelvinBranch::UndampedReduction { model_time_of_dynamic_crush_s } => (true, model_time_of_dynamic_crush_s),
        _ => (false, t_m),
    };
    check.equal("undamped_fallback", json!(undamped));
    check.close("t_m_model_s", model_t_m);
}

pub fn maxwell(check: &mut Check<'_>) {
    let mass_kg = check.param("mass_kg");
    let exponents = match text(&check.case["params"]["branch"]) {
        "imaginary" => MaxwellExponents::Complex { a_per_s: check.param("a"), b_rad_per_s: check.param("b") },
        "real" => {
            let names = if check.has_param("r2") { ["r2", "r3"] } else { ["a", "b"] };
            let [r2, r3] = names.map(|name| check.param(name));
            MaxwellExponents::Real { a_per_s: (r2 + r3) / 2.0, b_per_s: (r2 - r3).abs() / 2.0 }
        }
        other => panic!("branch {other}"),
    };
    let found = exponents.model(mass_kg).unwrap();
    check.close("k_N_per_m", found.stiffness_n_per_m);
    check.close("c_Ns_per_m", found.damping_n_s_per_m);
}

pub fn elastoplastic(check: &mut Check<'_>) {
    let (v0, crush) = (check.param("v0_ms"), check.param("dynamic_crush_m"));
    let restitution = check.param("rebound_ms").abs() / v0;
    let found = elastoplastic_from_events(check.param("mass_kg"), v0, crush, restitution).unwrap();
    check.close("restitution", restitution);
    check.close("kE_N_per_m", found.loading_stiffness_n_per_m);
    check.close("kP_N_per_m", found.unloading_stiffness_n_per_m);
    // Elastic part of the crush: C·k_E/k_P.
    check.close("de_m", crush * found.loading_stiffness_n_per_m / found.unloading_stiffness_n_per_m);
}

pub fn double(check: &mut Check<'_>) {
    let denominator: Vec<f64> = list(&check.case["params"]["den"]).iter().map(number).collect();
    let [leading, t, u, v, w] = denominator.as_slice().try_into().unwrap();
    let polynomial = [t, u, v, w].map(|coefficient: f64| coefficient / leading);
    let (m1, m2) = (check.param("m1_kg"), check.param("m2_kg"));
    let found = CoefficientMatching::new(polynomial, m1, m2, Reading::Binary).unwrap().solve();
    let real: Vec<&MatchedSolution> = found.solutions.iter().filter(|solution| solution.real).collect();
    let expected = list(&check.case["expected"]["real_solutions"]);
    let physical = list(&check.case["expected"]["physical"]);
    check.looked_at("real_solutions");
    check.looked_at("physical");
    if real.len() != expected.len() {
        check.fail(format!("{} real solutions instead of {}", real.len(), expected.len()));
    }
    // In any order.
    for (solution, physical) in expected.iter().zip(physical) {
        match real.iter().find(|found| same(check, found, solution)).map(|found| found.physical) {
            Some(is) if json!(is) == *physical => {}
            Some(_) => check.fail(format!("{solution} is physical where it is not, or the reverse")),
            None => check.fail(format!("{solution} is not among the solutions")),
        }
    }
}

fn same(check: &Check<'_>, found: &MatchedSolution, solution: &Value) -> bool {
    [("c1", found.c1_n_s_per_m), ("c2", found.c2_n_s_per_m), ("k1", found.k1_n_per_m), ("k2", found.k2_n_per_m)]
        .iter()
        .all(|(key, found)| {
            let expected = number(&solution[key]);
            (found.re - expected).abs() <= check.general_limit(expected)
        })
}

pub fn mode_of_model(check: &mut Check<'_>) {
    let mode = Mode::continuous(Complex::new(check.param("re"), check.param("im")));
    check.close("omega_n", mode.natural_frequency_rad_per_s);
    check.close_or_null("zeta", mode.damping_ratio);
    check.close("f_hz", mode.natural_frequency_hz());
}

pub fn end_to_end(check: &mut Check<'_>) {
    let params = &check.case["params"];
    let Some(path) = crumple_testkit::shared(text(&params["file"])) else {
        check.fail(format!("the file {} is not here", params["file"]));
        return;
    };
    let record = two_columns(&path, '\t');
    let window = &params["bias_window_s"];
    let window = PreEventWindow { from_s: number(&window[0]), to_s: number(&window[1]) };
    let bias = pre_event_within(&record, window).unwrap().zero_level;
    check.close("bias_g", bias / STANDARD_GRAVITY_M_PER_S2);
    let mode = mode(text(&params["filter_mode"]));
    for (key, class) in [
        ("raw", None),
        ("cfc60", Some(60.0)),
        ("cfc180", Some(180.0)),
        ("cfc600", Some(600.0)),
        ("cfc1000", Some(1000.0)),
    ] {
        if !check.expects(key) {
            continue;
        }
        let samples = match class {
            Some(class) => {
                let coefficients = Coefficients::new(cfc(class), mode, record.dt_s());
                filter_both_ways(record.samples(), bias, &coefficients).unwrap()
            }
            None => record.samples().iter().map(|a| a - bias).collect(),
        };
        let filtered = Sampled::new(record.t0_s(), record.dt_s(), samples).unwrap();
        let part = filtered.slice(filtered.index_at_or_after(0.0), filtered.len());
        // Sample times of decimal records: t = 0 to rounding.
        let part = Sampled::new(0.0, part.dt_s(), part.into_samples()).unwrap();
        let motion = Motion::new(part.into(), check.param("v0_ms"));
        let metrics = motion.metrics(Some(check.param("mass_kg")));
        let path = |name: &str| format!("{key}/{name}");

        let peak = peak(&motion.acceleration).unwrap();
        check.close(&path("min_g"), peak.acceleration_m_per_s2 / STANDARD_GRAVITY_M_PER_S2);
        check.close(&path("t_min_s"), peak.time_s);
        let rebound = motion.events.rebound;
        check.close_or_null(&path("v_min_ms"), rebound.map(|r| r.velocity_m_per_s));
        check.close_or_null(&path("t_v_min_s"), rebound.map(|r| r.time_s));
        for (name, metric) in [
            ("t_m_s", "time_of_dynamic_crush"),
            ("dynamic_crush_m", "dynamic_crush"),
            ("restitution", "coefficient_of_restitution"),
            ("centroid_time_s", "centroid_time"),
            ("olc_ms2", "olc"),
            ("vpi_ms2", "vpi"),
            ("k_avg_N_per_m", "average_stiffness"),
        ] {
            check.metric(&path(name), metrics.get(metric), 1.0);
        }
        check.metric_g(&path("sm25_g"), metrics.get("sm25"));
        check.window(&path("olc_t1_s"), &path("olc_t2_s"), metrics.get("olc"), |_, _| false);
    }
}
