//! Real channels from the file to the indices: zero level on the raw record, filter the whole record, keep t >= 0,
//! integrate from v0.

use crumple_metrics::peak;
use crumple_signal::{Coefficients, PreEventWindow, STANDARD_GRAVITY_M_PER_S2, Sampled, filter_both_ways, pre_event};
use crumple_testkit::reference_signals::{number, text, two_columns};

use crate::metrics::check::Check;
use crate::metrics::filters::{cfc, mode};
use crate::metrics::pulse::Motion;

pub fn end_to_end(check: &mut Check<'_>) {
    let params = &check.case["params"];
    let Some(path) = crumple_testkit::shared(text(&params["file"])) else {
        check.fail(format!("the file {} is not here", params["file"]));
        return;
    };
    let record = two_columns(&path, '\t');
    let window = &params["bias_window_s"];
    let window = PreEventWindow { from_s: number(&window[0]), to_s: number(&window[1]) };
    let bias = pre_event(&record, window).unwrap().zero_level;
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
