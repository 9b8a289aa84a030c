//! The ratings of a model's curve against the test's, beside the fit in percent.

use crumple_metrics::definitions::{CATALOGUE, ISO};
use crumple_metrics::{CoraOptions, Iso18571Options, Metric, cora, iso18571, residuals};
use crumple_signal::Sampled;

/// One rating, with the part of the record it belongs to.
#[derive(Debug, Clone, PartialEq)]
pub struct Rating {
    /// What was compared: `acceleration`, `displacement`.
    pub quantity: &'static str,
    /// The number, the key of its definition and its window, s after time zero.
    pub metric: Metric,
    /// How well the definition is known: `C`, `S`, `M` or `U` (see `docs/metrics.md`).
    pub mark: &'static str,
    /// What the definition leaves open and was chosen here.
    pub note: Option<String>,
}

/// Most samples that ISO/TS 18571 rates here: warping costs their square, and no loading phase is longer than 2 s.
const RATED_SAMPLES: usize = 20_000;

/// CORA, Sprague-Geers and Theil's U1 of a modelled curve against the measured one, both on one grid.
///
/// Empty for curves that cannot be rated at all: no samples, a measured curve of zeros, samples beyond the range of
/// numbers.
///
/// In this order: CORA's total, 0 to 1, `0.5·corridor + 0.5·cross`, with the choices made here in its note; its
/// corridor and its cross-correlation rating; then Sprague & Geers and Theil, 0 for equal curves. With `I_xy = ∫xy dt`
/// over test m and model c: magnitude `M = √(I_cc/I_mm) - 1`, phase `P = acos(I_mc/√(I_mm·I_cc))/π`,
/// `C = √(M² + P²)`, `U1 = |m - c|/(|m| + |c|)`. P is right to 2e-8 near 0. The constants of CORA have the
/// mark M: well known, and not checked against its program (`docs/metrics.md`).
pub fn ratings(quantity: &'static str, measured: &Sampled, modelled: &Sampled) -> Vec<Rating> {
    let options = CoraOptions::default();
    let (Ok(cora), Ok(residuals)) = (cora(measured, modelled, &options), residuals(measured, modelled)) else {
        return Vec::new();
    };
    let choices = format!(
        "interval: the compared window, not the manual's automatic rule (mark U); constants (mark M): a0 {}, b0 {}, k \
         {}; D_min {}, D_max {}, INT_min {}; powers {}, {}, {}; weights {}, {}, {} and {}, {}; \
         not checked against CORA's program",
        options.a_0,
        options.b_0,
        options.k,
        options.d_min,
        options.d_max,
        options.int_min,
        options.k_v,
        options.k_g,
        options.k_p,
        options.g_v,
        options.g_g,
        options.g_p,
        options.g_1,
        options.g_2
    );
    let [corridor, cross, total] = cora.metrics();
    let of_residuals = residuals
        .metrics("")
        .into_iter()
        .filter(|metric| ["sprague-geers-m", "sprague-geers-p", "sprague-geers-c", "theil-u1"].contains(&metric.id));
    let cora = [(total, Some(choices)), (corridor, None), (cross, None)];
    let all = cora.into_iter().chain(of_residuals.map(|metric| (metric, None)));
    all.map(|(metric, note)| rating(quantity, metric, note)).collect()
}

/// ISO/TS 18571 of an acceleration and its four parts; the overall rating is the first.
///
/// The overall rating is 0.4 times the corridor and 0.2 times each of phase, magnitude and slope, which follow in this
/// order, all from 0 to 1. Its note is the grade: excellent above 0.94, good above 0.80, fair above 0.58, else poor.
///
/// The standard wants 10 kHz: at another rate, and beyond 20,000 samples, the overall rating is absent and says why.
pub(crate) fn iso_ratings(measured: &Sampled, modelled: &Sampled) -> Vec<Rating> {
    let absent = |reason: &str| vec![rating("acceleration", Metric::absent(&ISO, reason), None)];
    if (measured.dt_s() - 1e-4).abs() > 1e-9 {
        return absent(&format!("sampled at {:.0} Hz, the standard wants 10 kHz", measured.rate_hz()));
    }
    if measured.len() > RATED_SAMPLES {
        return absent("the window is longer than 2 s");
    }
    match iso18571(measured, modelled, &Iso18571Options::default()) {
        Ok(iso) => {
            let [corridor, phase, magnitude, slope, overall] = iso.metrics();
            let grade = iso.grade.map(|grade| grade.name().to_owned());
            let parts = [corridor, phase, magnitude, slope].map(|metric| rating("acceleration", metric, None));
            std::iter::once(rating("acceleration", overall, grade)).chain(parts).collect()
        }
        Err(error) => absent(&error.to_string()),
    }
}

/// A metric with the mark of its definition in the catalogue (`U` for one that is not in it). A missing value says why
/// in its note.
fn rating(quantity: &'static str, metric: Metric, note: Option<String>) -> Rating {
    let mark = CATALOGUE.iter().find(|d| d.id == metric.id).map_or("U", |definition| definition.mark.letter());
    let note = if metric.value.is_some() { note } else { Some(metric.definition.clone()) };
    Rating { quantity, metric, mark, note }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;

    fn half_sine(dt_s: f64, height: f64) -> Sampled {
        let n = (0.08 / dt_s) as i32;
        let at = |k| height * (std::f64::consts::PI * f64::from(k) / f64::from(n)).sin();
        Sampled::new(0.01, dt_s, (0..=n).map(at).collect()).unwrap()
    }

    fn value(rated: &[Rating], id: &str) -> f64 {
        rated.iter().find(|rating| rating.metric.id == id).unwrap().metric.value.unwrap()
    }

    #[test]
    fn a_model_of_four_fifths_the_height_is_rated_as_its_scale_says() {
        let rated = ratings("acceleration", &half_sine(1e-4, 100.0), &half_sine(1e-4, 80.0));
        // Equal shape: M = 0.8 - 1, U1 = 0.2/1.8, CORA's size 0.64, progression and phase 1. Rounding of sums over 801
        // samples; P keeps half the digits.
        assert!((value(&rated, "sprague-geers-m") + 0.2).abs() < 1e-13 && value(&rated, "sprague-geers-p") < 1e-7);
        assert!((value(&rated, "sprague-geers-c") - 0.2).abs() < 1e-13);
        assert!((value(&rated, "theil-u1") - 0.2 / 1.8).abs() < 1e-13);
        assert!((value(&rated, "cora-cross") - (0.5 + 0.25 * 0.64 + 0.25)).abs() < 1e-12);
        let total = &rated[0];
        assert_eq!((total.metric.id, total.mark), ("cora", "M"));
        assert!(total.note.as_ref().unwrap().contains(
            "compared window, not the manual's automatic rule (mark U); constants (mark M): a0 0.05, b0 0.5,"
        ));
        let window = total.metric.window.unwrap();
        assert!((window.from_s - 0.01).abs() < 1e-15 && (window.to_s - 0.09).abs() < 1e-12);
    }

    #[test]
    fn the_standard_rates_at_its_rate_alone_and_says_so() {
        let rated = iso_ratings(&half_sine(1e-4, 100.0), &half_sine(1e-4, 100.0));
        assert_eq!((value(&rated, "iso18571"), rated[0].note.as_deref()), (1.0, Some("excellent")));
        assert_eq!(rated.len(), 5);
        let slow = iso_ratings(&half_sine(1e-3, 100.0), &half_sine(1e-3, 100.0));
        assert_eq!((slow.len(), slow[0].metric.value), (1, None));
        assert_eq!(slow[0].note.as_deref(), Some("absent: sampled at 1000 Hz, the standard wants 10 kHz"));
    }

    #[test]
    fn a_test_at_rest_is_not_rated() {
        assert!(ratings("displacement", &half_sine(1e-4, 0.0), &half_sine(1e-4, 1.0)).is_empty());
    }
}
