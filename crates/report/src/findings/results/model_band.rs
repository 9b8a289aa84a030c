//! How far the motion of a model moves with its parameters, by their covariance.

use crumple_artifact::records::UncertaintyV1;
use crumple_lumped::{Instants, Motion, structure_of};
use crumple_signal::Sampled;

use crate::findings::{CandidateResult, Run};

/// Instants of a band: no finer than a picture shows.
const INSTANTS: usize = 200;
/// Change of a parameter for its derivative, share of its value: the error of the central difference is its square.
const STEP: f64 = 1e-3;
/// Standard deviations to either side of 95 % of a normal distribution.
const HALF_WIDTH: f64 = 1.96;

/// Half-widths of the 95 % band about a model's motion, from contact to the end of the compared window.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelBand {
    /// Of the compartment's displacement, m.
    pub displacement_m: Sampled,
    /// Of its velocity, m/s.
    pub velocity_m_per_s: Sampled,
}

/// The band of a candidate, `1.96 sqrt(g' C g)` with `g` the derivatives of the motion by the parameters and `C` their
/// covariance: the motion is taken for straight in the parameters over their deviations.
///
/// `None` without impact speed or simulation, or where the record leaves a parameter open: then the covariance knows
/// no end of it.
pub fn model_band(run: &Run, candidate: &CandidateResult) -> Option<ModelBand> {
    let known = candidate.record.uncertainty.as_ref()?;
    if known.order.is_empty() || !candidate.record.undetermined().is_empty() {
        return None;
    }
    let speed_m_per_s = run.test.impact_speed_m_per_s?;
    let end_s = candidate.simulation.as_ref()?.to_s;
    let dt_s = end_s / (INSTANTS - 1) as f64;
    let at = Instants { first_s: 0.0, dt_s, samples: INSTANTS };
    let motion = |name: &str, value: f64| {
        let mut parameters = candidate.record.parameters.clone();
        parameters.insert(name.to_owned(), value);
        let structure = structure_of(&candidate.record.model, &parameters).ok()?;
        structure.motions_at(speed_m_per_s, &at).ok()?.pop()
    };
    let derivatives = known.order.iter().map(|name| {
        let value = *candidate.record.parameters.get(name)?;
        // A parameter at zero has one side.
        let (below, above) = match known.standard_deviation.get(name) {
            Some(deviation) if value == 0.0 => (0.0, STEP * deviation),
            _ => (value - STEP * value.abs(), value + STEP * value.abs()),
        };
        Some((motion(name, below)?, motion(name, above)?, above - below))
    });
    let derivatives: Vec<(Motion, Motion, f64)> = derivatives.collect::<Option<_>>()?;
    let covariance = covariance(known)?;
    let band = |wave: fn(&Motion) -> &[f64]| {
        let half_width = |k: usize| {
            let g: Vec<f64> =
                derivatives.iter().map(|(below, above, step)| (wave(above)[k] - wave(below)[k]) / step).collect();
            let sum = |row: &Vec<f64>| row.iter().zip(&g).map(|(c, g)| c * g).sum::<f64>();
            let variance: f64 = covariance.iter().zip(&g).map(|(row, g)| g * sum(row)).sum();
            HALF_WIDTH * variance.max(0.0).sqrt()
        };
        Sampled::new(0.0, dt_s, (0..INSTANTS).map(half_width).collect()).ok()
    };
    Some(ModelBand {
        displacement_m: band(|motion| &motion.displacement_m)?,
        velocity_m_per_s: band(|motion| &motion.velocity_m_per_s)?,
    })
}

/// Covariance of the parameters in their units, rows in the order of the record; `None` where it is not whole.
fn covariance(known: &UncertaintyV1) -> Option<Vec<Vec<f64>>> {
    let deviations = known.order.iter().map(|name| known.standard_deviation.get(name).copied());
    let deviations: Vec<f64> = deviations.collect::<Option<_>>()?;
    let is_square = known.correlation.len() == deviations.len()
        && known.correlation.iter().all(|row| row.len() == deviations.len());
    let row = |(row, of_row): (&Vec<f64>, &f64)| row.iter().zip(&deviations).map(|(r, d)| r * d * of_row).collect();
    is_square.then(|| known.correlation.iter().zip(&deviations).map(row).collect())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use crumple_artifact::records::{CandidateV1, SimulationV1};

    use super::*;

    /// A spring alone, whose motion is `v0/w sin(w t)`.
    fn spring(deviation: f64) -> (Run, CandidateResult) {
        let mut run = Run::default();
        run.test.impact_speed_m_per_s = Some(10.0);
        let record: CandidateV1 = serde_json::from_value(serde_json::json!({
            "model": "kelvin", "method": "direct-fit", "physical": true, "equivalent_to": null, "fit": null,
            "parameters": {"mass_kg": 1000.0, "stiffness_n_per_m": 4e5, "damping_n_s_per_m": 0.0},
            "uncertainty": null
        }))
        .unwrap();
        let uncertainty = UncertaintyV1 {
            standard_deviation: BTreeMap::from([("stiffness_n_per_m".to_owned(), deviation)]),
            interval_low: BTreeMap::from([("stiffness_n_per_m".to_owned(), Some(3.9e5))]),
            interval_high: BTreeMap::from([("stiffness_n_per_m".to_owned(), Some(4.1e5))]),
            order: vec!["stiffness_n_per_m".to_owned()],
            correlation: vec![vec![1.0]],
            ..UncertaintyV1::default()
        };
        let candidate = CandidateResult {
            id: "kelvin/direct-fit/1".to_owned(),
            record: CandidateV1 { uncertainty: Some(uncertainty), ..record },
            simulation: Some(SimulationV1 { to_s: 0.0796, ..SimulationV1::default() }),
            displacement: None,
            velocity: None,
            acceleration: None,
            elements: vec![],
            masses: vec![],
        };
        (run, candidate)
    }

    #[test]
    fn the_band_of_a_spring_is_that_of_its_closed_form() {
        let (run, candidate) = spring(8e3);
        let band = model_band(&run, &candidate).unwrap();
        let (w, v0) = (20.0_f64, 10.0);
        // d/dw of v0/w sin(w t), dw = w/(2k) dk.
        let per_k = w / (2.0 * 4e5);
        for (k, half) in band.displacement_m.samples().iter().enumerate() {
            let t = band.displacement_m.time_s(k);
            let by_w = v0 * (t * (w * t).cos() / w - (w * t).sin() / (w * w));
            let expected = 1.96 * (by_w * per_k).abs() * 8e3;
            // The central difference is off by the square of its step.
            assert!((half - expected).abs() <= 1e-5 * expected + 1e-9, "{t}: {half} {expected}");
        }
        let last = *band.velocity_m_per_s.samples().last().unwrap();
        let t = 0.0796;
        let expected = 1.96 * v0 * t * (w * t).sin().abs() * per_k * 8e3;
        assert!((last - expected).abs() <= 1e-5 * expected, "{last} {expected}");
    }

    #[test]
    fn an_open_parameter_has_no_band() {
        let (run, candidate) = spring(5e5);
        assert_eq!(model_band(&run, &candidate), None);
    }
}
