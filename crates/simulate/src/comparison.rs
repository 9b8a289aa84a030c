//! A simulation beside the test: errors, ratings, other sensors.

use crumple_lumped::{CrushEvents, Dynamics, Motion};
use crumple_metrics::definitions::{CATALOGUE, ISO};
use crumple_metrics::{CoraOptions, Iso18571Options, Metric, cora, fit_percent, iso18571, residuals, rmse};
use crumple_signal::{Cfc, Channel, Measurement, Sampled, through_class};

use crate::residual::Residual;

// The peak of a model's deceleration as a laboratory reads it.

/// Zero acceleration before contact, as a laboratory records it: the filter looks ahead.
const BEFORE_CONTACT_S: f64 = 0.04;
/// Channel frequency class of vehicle structures.
const CLASS: Cfc = Cfc::Cfc60;

/// Largest deceleration through CFC 60, m/s², negative, of an acceleration from contact on. `None` where the interval
/// is too coarse for the class, or nothing slows down.
pub fn deceleration_peak(acceleration_m_per_s2: &[f64], dt_s: f64) -> Option<f64> {
    let before = (BEFORE_CONTACT_S / dt_s).round().min(1e6) as usize;
    let mut samples = vec![0.0; before];
    samples.extend_from_slice(acceleration_m_per_s2);
    let filtered = through_class(&samples, dt_s, CLASS)?;
    filtered.into_iter().skip(before).reduce(f64::min).filter(|peak| *peak < 0.0)
}

// A candidate beside a sensor that its fit did not see.

/// Another accelerometer on the vehicle, integrated.
#[derive(Debug, Clone)]
pub struct OtherSensor {
    /// Channel.
    pub channel: String,
    /// Whether it sits on the engine, and so on the mass next to the barrier.
    pub on_engine: bool,
    /// Its displacement, m.
    pub displacement: Sampled,
}

/// The error of a candidate at another sensor, over the window of its comparison with the pulse.
#[derive(Debug, Clone, PartialEq)]
pub struct SensorFit {
    /// Channel.
    pub channel: String,
    /// Mass compared, counted from the barrier, from 1.
    pub mass: usize,
    /// Root mean square displacement error over the window, m.
    pub rmse_m: f64,
    /// Displacement fit, percent.
    pub fit_percent: Option<f64>,
}

/// Whether a sensor sits on the engine: as its location says, and without a location, as in a plain table, its name.
/// The rule by which integration tells what moves apart from the compartment.
pub fn is_on_engine(channel: &Channel) -> bool {
    let place = if channel.location.trim().is_empty() { &channel.id } else { &channel.location };
    place.to_lowercase().contains("engine")
}

/// Compares the displacement of the sensor with that of its mass over the window of the simulation: the engine's with
/// the mass next to the barrier, any other with the compartment. `None` where the record does not cover the window, and
/// for a model of one mass beside the engine's sensor: that mass is the compartment, and nothing of such a model moves
/// as an engine does.
///
/// For two dual double models this is the only figure that differs.
pub fn beside(simulation: &Simulation, sensor: &OtherSensor, dt_s: f64) -> Option<SensorFit> {
    if sensor.on_engine && simulation.masses.len() == 1 {
        return None;
    }
    beside_mass(simulation, sensor, if sensor.on_engine { 1 } else { simulation.compartment + 1 }, dt_s)
}

/// As [`beside`], with the mass that the sensor sits on, counted from the barrier, from 1. `None` for mass 0 and for a
/// mass that the model does not have.
///
/// The sensor is interpolated linearly at `k·dt_s`, k from 0 to the end of the window, and has to cover
/// all of it. Error and fit are those of [`Comparison`](crate::Comparison), the sensor in the place of the pulse.
pub fn beside_mass(simulation: &Simulation, sensor: &OtherSensor, mass: usize, dt_s: f64) -> Option<SensorFit> {
    let motion: &Motion = simulation.masses.get(mass.checked_sub(1)?)?;
    let compared = (simulation.comparison.to_s / dt_s).round() as usize + 1;
    let (mut x, mut xh) = (Vec::new(), Vec::new());
    for (k, modelled) in motion.displacement_m.iter().enumerate().take(compared) {
        x.push(sensor.displacement.at(k as f64 * dt_s)?);
        xh.push(*modelled);
    }
    Some(SensorFit { channel: sensor.channel.clone(), mass, rmse_m: rmse(&x, &xh)?, fit_percent: fit_percent(&x, &xh) })
}

// The ratings of a model's curve against the test's, beside the fit in percent.

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

// The motion of a test and a simulation beside it.

/// The motion of the test. The records may have grids of their own, all on one time axis; the displacement gives the
/// sampling interval of the simulation, and where it ends the simulation ends.
#[derive(Debug, Clone, Copy)]
pub struct Measured<'a> {
    /// Speed at time zero, m/s.
    pub impact_speed_m_per_s: f64,
    /// Displacement, m, zero at time zero.
    pub displacement: &'a Sampled,
    /// How it was measured.
    pub measurement: Measurement,
    /// Velocity, if there is one.
    pub velocity: Option<&'a Sampled>,
    /// Acceleration, if there is one.
    pub acceleration: Option<&'a Sampled>,
    /// Dynamic crush, if the velocity reaches zero.
    pub dynamic_crush_m: Option<f64>,
    /// Its time after time zero.
    pub time_of_dynamic_crush_s: Option<f64>,
}

/// Where model and test are compared.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Window {
    /// End of the window, s after time zero; `None`: dynamic crush of the test, or the record's end without one.
    pub to_s: Option<f64>,
}

impl Window {
    /// The end stated, else dynamic crush, else the end of the displacement, and never after that, s.
    pub(crate) fn end_s(&self, test: &Measured<'_>) -> f64 {
        let end_s = test.displacement.end_s();
        self.to_s.or(test.time_of_dynamic_crush_s).unwrap_or(end_s).min(end_s)
    }
}

/// A model beside the test. A number is `None` where a record is missing, has no variation (fits) or leaves the range
/// of numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Start of the window, s after time zero.
    pub from_s: f64,
    /// Time of its last sample.
    pub to_s: f64,
    /// Displacement error, root mean square, m.
    pub rmse_displacement_m: Option<f64>,
    /// Largest displacement error, m.
    pub max_displacement_error_m: Option<f64>,
    /// Fit of the displacement, percent.
    pub fit_displacement_percent: Option<f64>,
    /// Fit of the velocity, percent.
    pub fit_velocity_percent: Option<f64>,
    /// Fit of the acceleration, percent.
    pub fit_acceleration_percent: Option<f64>,
    /// ISO/TS 18571 rating of the acceleration over the window, 0 to 1; `None` unless sampled at 10 kHz as the standard
    /// wants it.
    pub iso18571_score: Option<f64>,
    /// Dynamic crush of the model minus that of the test, m; `None` if either has none.
    pub dynamic_crush_error_m: Option<f64>,
    /// Time of dynamic crush of the model minus that of the test, s.
    pub time_of_dynamic_crush_error_s: Option<f64>,
    /// ISO/TS 18571 of the acceleration; CORA, Sprague-Geers and Theil of acceleration and displacement.
    pub ratings: Vec<Rating>,
    /// What the model leaves of the measured acceleration.
    pub residual: Option<Residual>,
}

/// The response of a model from time zero to the end of the test's displacement record.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulation {
    /// Motion of the compartment at `k·dt` after time zero, `dt` that of the test.
    pub motion: Motion,
    /// Its events, from the exact solution.
    pub events: CrushEvents,
    /// Beside the test.
    pub comparison: Comparison,
    /// Motion of every mass, from the barrier on.
    pub masses: Vec<Motion>,
    /// Which of them is the compartment, from 0: the last, unless a chain has an occupant behind it.
    pub compartment: usize,
    /// The force in every spring and damper, and the energy; `None` where the heat leaves the range of numbers.
    pub dynamics: Option<Dynamics>,
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;

    #[test]
    fn a_long_half_sine_keeps_its_peak_and_a_speed_up_has_none() {
        let sine = |scale: f64| -> Vec<f64> {
            (0..1000).map(|k| scale * (std::f64::consts::PI * f64::from(k) / 1000.0).sin()).collect()
        };
        // A half sine of 100 ms is 5 Hz: 1 - |H| of both passes at 125 Hz design is 2.6e-6.
        let peak = deceleration_peak(&sine(-200.0), 1e-4).unwrap();
        assert!((peak + 200.0).abs() < 0.01, "{peak}");
        assert_eq!(deceleration_peak(&sine(-200.0), 0.01), None);
    }

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
