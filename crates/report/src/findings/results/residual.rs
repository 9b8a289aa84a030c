//! What a model leaves of the measured acceleration, and whether that looks like noise.

use crumple_signal::Sampled;
use serde::Serialize;

use crate::findings::{CandidateResult, Run};

/// Share of the compared window up to which lags are looked at.
const LAGS: usize = 4;

/// Acceleration of the test minus that of a model over the compared window.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Residual {
    /// The candidate.
    pub id: String,
    /// Root mean square, m/s².
    pub rms_m_per_s2: f64,
    /// That over the root mean square of the test.
    pub share_of_test: f64,
    /// Samples compared.
    pub samples: usize,
    /// Spacing of the lags, s.
    pub dt_s: f64,
    /// Autocorrelation at the lags 0, 1, ... up to a quarter of the window.
    pub autocorrelation: Vec<f64>,
    /// 95 % limits of the autocorrelation of white noise of so many samples: `1.96/sqrt(N)` to either side of zero.
    pub limit: f64,
    /// Share of the lags from 1 on that lie outside the limits; of white noise one in twenty does.
    pub share_outside: f64,
}

/// The residual of a candidate; `None` without both curves, or where the residual vanishes.
///
/// The model's acceleration is that of its motion, the test's went through the filter: what the filter takes from the
/// model is part of the residual.
pub fn residual(run: &Run, candidate: &CandidateResult) -> Option<Residual> {
    let test = run.measured.filtered.as_ref()?;
    let model = candidate.acceleration.as_ref()?;
    let window = candidate.simulation.as_ref()?;
    let half = 0.5 * test.dt_s();
    let inside = (0..test.len()).filter(|k| (window.from_s - half..=window.to_s + half).contains(&test.time_s(*k)));
    let pairs: Vec<(f64, f64)> =
        inside.filter_map(|k| Some((test.samples()[k], between(model, test.time_s(k))?))).collect();
    let count = pairs.len() as f64;
    let mean = pairs.iter().map(|(test, model)| test - model).sum::<f64>() / count;
    let residual: Vec<f64> = pairs.iter().map(|(test, model)| test - model - mean).collect();
    let squares = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>();
    let power = squares(&mut residual.iter().copied());
    let of_test = squares(&mut pairs.iter().map(|pair| pair.0));
    if !(power > 0.0 && of_test > 0.0) {
        return None;
    }
    let at_lag = |lag: usize| residual.iter().zip(&residual[lag..]).map(|(a, b)| a * b).sum::<f64>() / power;
    let autocorrelation: Vec<f64> = (0..=residual.len() / LAGS).map(at_lag).collect();
    let limit = 1.96 / count.sqrt();
    let outside = autocorrelation.iter().skip(1).filter(|r| r.abs() > limit).count();
    let rms = |power: f64| (power / count).sqrt();
    let whole = squares(&mut pairs.iter().map(|(test, model)| test - model));
    Some(Residual {
        id: candidate.id.clone(),
        rms_m_per_s2: rms(whole),
        share_of_test: rms(whole) / rms(of_test),
        samples: pairs.len(),
        dt_s: test.dt_s(),
        limit,
        share_outside: outside as f64 / autocorrelation.len().saturating_sub(1).max(1) as f64,
        autocorrelation,
    })
}

/// The value of a wave at an instant, linear between samples.
fn between(wave: &Sampled, t_s: f64) -> Option<f64> {
    // Rounding of a grid must not lose its last sample.
    let place = ((t_s - wave.t0_s()) / wave.dt_s()).max(0.0);
    let below = place.floor() as usize;
    let share = place - place.floor();
    let at = |k: usize| wave.samples().get(k).copied();
    let low = at(below)?;
    let high = at(below + 1).unwrap_or(low);
    (t_s >= wave.t0_s() - 1e-6 * wave.dt_s()).then_some(low + share * (high - low))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_artifact::records::{CandidateV1, SimulationV1};

    fn of(residual_of: impl Fn(usize) -> f64) -> Residual {
        let wave = |f: &dyn Fn(usize) -> f64| Sampled::new(0.0, 1e-4, (0..1000).map(f).collect()).ok();
        let record: CandidateV1 = serde_json::from_str(
            r#"{"model": "kelvin", "method": "fit", "parameters": {}, "physical": true, "equivalent_to": null,
                "fit": null, "uncertainty": null}"#,
        )
        .unwrap();
        let mut run = Run::default();
        run.measured.filtered = wave(&|k| -100.0 + residual_of(k));
        let candidate = CandidateResult {
            id: "kelvin/fit/1".to_owned(),
            record,
            simulation: Some(SimulationV1 { to_s: 0.0799, ..SimulationV1::default() }),
            displacement: None,
            velocity: None,
            acceleration: wave(&|_| -100.0),
            elements: vec![],
            masses: vec![],
        };
        residual(&run, &candidate).unwrap()
    }

    #[test]
    fn a_wave_is_left_over_and_noise_is_not() {
        let wave = of(|k| (k as f64 * 0.05).sin());
        assert_eq!((wave.samples, wave.autocorrelation.len()), (800, 201));
        assert!((wave.rms_m_per_s2 - 0.5_f64.sqrt()).abs() < 0.01 && (wave.share_of_test - 0.00707).abs() < 1e-4);
        assert!((wave.limit - 1.96 / 800_f64.sqrt()).abs() < 1e-12 && wave.share_outside > 0.9);
        // A sine comes back after its period of 125.7 samples.
        assert_eq!(wave.autocorrelation[0], 1.0);
        assert!(wave.autocorrelation[63] < -0.8 && wave.autocorrelation[126] > 0.7);
        // A linear congruential generator, its upper bits.
        let step = |state: &u64| Some(state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1));
        let states: Vec<u64> = std::iter::successors(Some(1), step).skip(10).take(1000).collect();
        let noise = of(|k| (states[k] >> 11) as f64 / (1_u64 << 53) as f64 - 0.5);
        assert!(noise.share_outside < 0.12, "{}", noise.share_outside);
    }
}
