//! Two curves.

use crumple_metrics::{CoraOptions, Grade, Iso18571Options};
use crumple_testkit::reference_signals::{list, number, text};
use serde_json::json;

use crate::metrics::check::Check;

pub fn iso18571(check: &mut Check<'_>) {
    let d = Iso18571Options::default();
    let weights = check.case["params"].get("weights").map(|w| list(w).iter().map(number).collect::<Vec<f64>>());
    let options = Iso18571Options {
        inner_corridor: check.param_or("a0", d.inner_corridor),
        outer_corridor: check.param_or("b0", d.outer_corridor),
        corridor_power: check.param_or("k_z", d.corridor_power),
        largest_shift: check.param_or("eps_p", d.largest_shift),
        phase_power: check.param_or("k_p", d.phase_power),
        largest_magnitude_error: check.param_or("eps_m", d.largest_magnitude_error),
        magnitude_power: check.param_or("k_m", d.magnitude_power),
        warping_window: check.param_or("dtw_window", d.warping_window),
        largest_slope_error: check.param_or("eps_s", d.largest_slope_error),
        slope_power: check.param_or("k_s", d.slope_power),
        weights: weights.map_or(d.weights, |w| w.try_into().unwrap()),
    };
    let found = crumple_metrics::iso18571(&check.signal(0), &check.signal(1), &options).unwrap();
    check.close("corridor", found.corridor);
    check.close("phase", found.phase);
    check.close_or_null("magnitude", found.magnitude);
    check.close_or_null("slope", found.slope);
    check.close_or_null("overall", found.overall);
    check.close_or_null("rho", found.correlation);
    check.close_or_null("e_mag", found.magnitude_error);
    check.close_or_null("e_slope", found.slope_error);
    check.equal("shift_samples_comparison_late", json!(found.shift_samples));
    check.equal("grade", json!(found.grade.map(Grade::name)));
}

pub fn cora(check: &mut Check<'_>) {
    let d = CoraOptions::default();
    let options = CoraOptions {
        a_0: check.param_or("a0", d.a_0),
        b_0: check.param_or("b0", d.b_0),
        k: check.param_or("k", d.k),
        d_min: check.param_or("d_min", d.d_min),
        d_max: check.param_or("d_max", d.d_max),
        int_min: check.param_or("int_min", d.int_min),
        k_v: check.param_or("k_v", d.k_v),
        k_g: check.param_or("k_g", d.k_g),
        k_p: check.param_or("k_p", d.k_p),
        g_v: check.param_or("g_v", d.g_v),
        g_g: check.param_or("g_g", d.g_g),
        g_p: check.param_or("g_p", d.g_p),
        g_1: check.param_or("g_1", d.g_1),
        g_2: check.param_or("g_2", d.g_2),
        interval: d.interval,
    };
    let found = crumple_metrics::cora(&check.signal(0), &check.signal(1), &options).unwrap();
    check.close("corridor", found.corridor);
    check.close("progression", found.progression);
    check.close("size", found.size);
    check.close("phase", found.phase);
    check.close("cross", found.cross_correlation);
    check.close("total", found.total);
    check.close("K", found.correlation);
    check.equal("shift_samples_comparison_late", json!(found.shift_samples));
}

pub fn residuals(check: &mut Check<'_>) {
    let by_name = |key: &str, k: usize| match check.case["params"].get(key) {
        Some(name) => check.reference.signal(text(name)),
        None => check.signal(k),
    };
    let (measured, computed) = (by_name("measured", 0), by_name("computed", 1));
    let found = crumple_metrics::residuals(&measured, &computed).unwrap();
    check.close("rmse", found.rmse);
    for (path, value) in [
        ("sprague_geers_m", found.sprague_geers_magnitude),
        ("sprague_geers_p", found.sprague_geers_phase),
        ("sprague_geers_c", found.sprague_geers_comprehensive),
        ("fit_percent", found.fit_percent),
        ("nrmse", found.nrmse),
        ("r2", found.r2),
        ("vaf_percent", found.vaf_percent),
        ("theil_u", found.theil_u1),
        ("theil_u1", found.theil_u1),
        ("theil_u2", found.theil_u2),
        ("anova_mean", found.anova_mean),
        ("anova_std", found.anova_standard_deviation),
    ] {
        check.close_or_null(path, value);
    }
}
