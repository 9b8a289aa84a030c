//! Head injury criterion and its relatives on a resultant.

use crumple_signal::{Acceleration, STANDARD_GRAVITY_M_PER_S2, Signal};

use crate::metric::definitions::{GSI, HIC, HIC15, HIC36, HICD};
use crate::occupant::hic::search;
use crate::sums::cumulative::in_samples;
use crate::{Definition, Metric};

/// Longest window of HIC15, s.
pub const HIC15_WINDOW_S: f64 = 0.015;
/// Longest window of HIC36, s.
pub const HIC36_WINDOW_S: f64 = 0.036;

/// Head injury criterion: largest `(t2 - t1)·(mean of a in g)^2.5` over all pairs of samples with `t1 < t2 <= t1 + W`
/// (inclusive); its window is on the signal's own axis.
///
/// The mean is `(V(t2) - V(t1))/(t2 - t1)` with V the cumulative trapezoid; a negative mean counts as 0. Exact over the
/// samples, like trying all pairs, but by pruning: see [`hic_all_pairs`] and `docs/metrics.md`, which agree to 1e-12.
/// Between samples the criterion is higher by at most about 2e-4 of itself at 10 kHz. Several windows of equal value
/// (a square pulse): one of them is reported. The input is a resultant at CFC 1000. `window_s` of 15 or 36 ms give
/// HIC15 and HIC36.
pub fn hic(resultant: &Signal<Acceleration>, window_s: f64) -> Metric {
    worst_window(resultant, window_s, search::pruned)
}

/// [`hic`] by trying every pair: time grows with samples times window. The yardstick of [`hic`].
pub fn hic_all_pairs(resultant: &Signal<Acceleration>, window_s: f64) -> Metric {
    worst_window(resultant, window_s, search::all_pairs)
}

/// The criterion with the window in which it is reached, by a search over pairs of samples.
fn worst_window(resultant: &Signal<Acceleration>, window_s: f64, search: fn(&[f64], usize) -> search::Best) -> Metric {
    let definition = definition(window_s);
    let (a, dt) = (resultant.samples(), resultant.dt_s());
    if a.len() < 2 {
        return Metric::absent(definition, "the record has fewer than two samples");
    }
    if !(window_s.is_finite() && window_s > 0.0) {
        return Metric::absent(definition, "the window is not a positive time");
    }
    let longest = in_samples(window_s, dt).map_or(0, |(whole, _)| whole).min(a.len() - 1);
    if longest == 0 {
        return Metric::absent(definition, &format!("the window of {window_s} s is shorter than a sampling interval"));
    }
    let best = search(a, longest);
    // The search works in m/s² and samples.
    let value = dt * best.value / STANDARD_GRAVITY_M_PER_S2.powf(2.5);
    if best.value == 0.0 {
        return Metric::with_value(definition, 0.0)
            .over(resultant.t0_s(), resultant.end_s())
            .remarked("no window has a positive mean");
    }
    Metric::with_value(definition, value).over(resultant.time_s(best.start), resultant.time_s(best.end))
}

fn definition(window_s: f64) -> &'static Definition {
    if (window_s - HIC15_WINDOW_S).abs() < 1e-12 {
        &HIC15
    } else if (window_s - HIC36_WINDOW_S).abs() < 1e-12 {
        &HIC36
    } else {
        &HIC
    }
}

/// HIC(d) = 0.75446·HIC36 + 166.4 of a free-motion headform, FMVSS 201; its window is that of HIC36.
pub fn hic_d(resultant: &Signal<Acceleration>) -> Metric {
    let hic36 = hic(resultant, HIC36_WINDOW_S);
    let metric = Metric::of(&HICD, hic36.value.map(hic_d_of), hic36.definition.trim_start_matches("absent: "));
    Metric { window: hic36.window, ..metric }
}

/// HIC(d) of a known HIC36.
pub fn hic_d_of(hic36: f64) -> f64 {
    0.75446 * hic36 + 166.4
}

/// Gadd severity index: `∫ (a in g)^2.5 dt` over the whole record by the trapezoid, a negative sample counting as 0.
pub fn gadd_severity_index(resultant: &Signal<Acceleration>) -> Metric {
    let power = |a: f64| (a.max(0.0) / STANDARD_GRAVITY_M_PER_S2).powf(2.5);
    let a = resultant.samples();
    if a.len() < 2 {
        return Metric::absent(&GSI, "the record has fewer than two samples");
    }
    let sum: f64 = a.iter().map(|&a| power(a)).sum::<f64>() - (power(a[0]) + power(a[a.len() - 1])) / 2.0;
    Metric::with_value(&GSI, sum * resultant.dt_s()).over(resultant.t0_s(), resultant.end_s())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(level_g: f64) -> Signal<Acceleration> {
        let a = (0..1001).map(|k| if (100..=300).contains(&k) { level_g * STANDARD_GRAVITY_M_PER_S2 } else { 0.0 });
        Signal::new(0.0, 1e-4, a.collect()).unwrap()
    }

    #[test]
    fn a_square_pulse_follows_the_formula() {
        let exact = 60.0_f64.powf(2.5) * 0.015;
        let metric = hic(&square(60.0), HIC15_WINDOW_S);
        // The running sum of 1001 samples rounds by 1.1e-13 of it at most; the power takes that 2.5 times.
        let rounding = 2.5 * 1001.0 * f64::EPSILON / 2.0;
        assert!((metric.value.unwrap() / exact - 1.0).abs() < rounding);
        let window = metric.window.unwrap();
        // Two multiples of 1e-4 s below 0.03 s, each rounded twice.
        assert!((window.to_s - window.from_s - 0.015).abs() < 4.0 * 0.03 * f64::EPSILON);
        assert_eq!(metric.id, "hic15-fmvss208");
        // 420.8 of it is the HIC36, rounded as above.
        let hic_d_exact = 0.75446 * 60.0_f64.powf(2.5) * 0.02 + 166.4;
        assert!((hic_d(&square(60.0)).value.unwrap() - hic_d_exact).abs() < 421.0 * rounding);
    }

    #[test]
    fn windows_and_records_without_a_pair_are_absent() {
        assert!(hic(&Signal::new(0.0, 1e-4, vec![1.0]).unwrap(), 0.015).value.is_none());
        assert!(hic(&Signal::new(0.0, 0.1, vec![1.0; 9]).unwrap(), 0.015).value.is_none());
        assert_eq!(hic(&Signal::new(0.0, 1e-4, vec![-1.0; 9]).unwrap(), 0.015).value, Some(0.0));
        // Overflow is no number.
        assert!(hic(&Signal::new(0.0, 1e-4, vec![1e300; 9]).unwrap(), 0.015).value.is_none());
    }

    #[test]
    fn the_severity_index_of_a_square_is_its_area() {
        let gsi = gadd_severity_index(&square(60.0)).value.unwrap();
        // Two flanks of one interval each, half a sample each by the trapezoid: 201 intervals.
        // A sum of 201 equal terms: half a rounding each.
        assert!((gsi / (60.0_f64.powf(2.5) * 0.0201) - 1.0).abs() < 201.0 * f64::EPSILON / 2.0);
    }
}
