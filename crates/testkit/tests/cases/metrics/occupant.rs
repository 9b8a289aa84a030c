//! Head criteria on resultants.

use std::f64::consts::PI;

use crumple_metrics::{CLIP_3MS_S, clip_contiguous, clip_cumulative, hic_all_pairs, hic_d_of};
use crumple_signal::{Acceleration, STANDARD_GRAVITY_M_PER_S2, Signal};

use crate::metrics::check::Check;

/// The signal of the case, or the one that its parameter writes out: `sin(20 pi t), t=0..0.05 s step 0.1 ms`, in g.
fn resultant(check: &Check<'_>) -> Signal<Acceleration> {
    let Some(formula) = check.case["params"]["signal"].as_str() else { return check.acceleration(0) };
    let numbers: Vec<f64> = formula
        .replace("..", " ")
        .split(|c: char| !(c.is_ascii_digit() || c == '.'))
        .filter_map(|word| word.parse().ok())
        .collect();
    assert!(formula.starts_with("sin(") && numbers.len() == 4, "{formula}");
    let (factor, end_s, dt_s) = (numbers[0], numbers[2], numbers[3] / 1e3);
    let n = (end_s / dt_s).round() as i32;
    let at = |k: i32| (factor * PI * f64::from(k) * dt_s).sin() * STANDARD_GRAVITY_M_PER_S2;
    Signal::new(0.0, dt_s, (0..=n).map(at).collect()).unwrap()
}

pub fn hic(check: &mut Check<'_>) {
    let (resultant, window_s) = (resultant(check), check.param("window_s"));
    let found = crumple_metrics::hic(&resultant, window_s);
    check.metric("hic", &found, 1.0);
    if check.expects("hic_exact_continuous") {
        check.metric("hic_exact_continuous", &crumple_metrics::hic(&check.fine_acceleration(0), window_s), 1.0);
    }
    let (value, limit) = (found.value.unwrap_or(0.0), check.general_limit(found.value.unwrap_or(0.0)));
    check.window("t1_s", "t2_s", &found, |from_s, to_s| {
        let part = resultant.slice(resultant.index_at_or_after(from_s), resultant.index_at_or_after(to_s) + 1);
        hic_all_pairs(&part.into(), window_s).value.is_some_and(|there| (there - value).abs() <= limit)
    });
    let all = hic_all_pairs(&resultant, window_s).value;
    let gap = found.value.zip(all).map_or(0.0, |(found, all)| (found - all).abs() / all.abs().max(f64::MIN_POSITIVE));
    if found.value.is_some() != all.is_some() || gap > 1e-12 {
        check.fail(format!("{:?} by pruning, {all:?} by all pairs", found.value));
    }
}

pub fn hic_d(check: &mut Check<'_>) {
    if check.has_param("hic") {
        check.close("hicd", hic_d_of(check.param("hic")));
        return;
    }
    let found = crumple_metrics::hic_d(&resultant(check));
    check.metric("hicd", &found, 1.0);
    check.window("t1_s", "t2_s", &found, |_, _| false);
}

pub fn clip(check: &mut Check<'_>) {
    let (resultant, duration_s) = (resultant(check), check.param_or("duration_s", CLIP_3MS_S));
    let contiguous = clip_contiguous(&resultant, duration_s);
    check.metric_g("contiguous", &contiguous);
    if check.expects("exact_continuous") {
        check.metric_g("exact_continuous", &clip_contiguous(&check.fine_acceleration(0), duration_s));
    }
    check.metric_g("cumulative", &clip_cumulative(&resultant, duration_s));
    check.window("t1_s", "t2_s", &contiguous, |_, _| false);
}
