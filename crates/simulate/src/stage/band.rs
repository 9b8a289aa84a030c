//! How far the motion of a model moves with its parameters, by their covariance.

use crumple_lumped::{Instants, Motion, structure_of};
use crumple_numerics::estimation::statistics::NORMAL_95;
use crumple_stage::records::{CandidateV1, MotionBandV1, UncertaintyV1};

/// Instants of a band: no finer than a picture shows.
const INSTANTS: usize = 200;
/// Change of a parameter for its derivative, share of its value: the error of the central difference is its square.
const STEP: f64 = 1e-3;

/// The band of a candidate from contact to the end of the compared window, `1.96 sqrt(g' C g)` with `g` the derivatives
/// of the motion by the parameters and `C` their covariance: the motion is taken for straight in the parameters over
/// their deviations.
///
/// `None` where the record leaves a parameter open: then the covariance knows no end of it.
pub fn motion_band(candidate: &CandidateV1, impact_speed_m_per_s: f64, end_s: f64) -> Option<MotionBandV1> {
    let known = candidate.uncertainty.as_ref()?;
    if known.order.is_empty() || !candidate.undetermined().is_empty() {
        return None;
    }
    let dt_s = end_s / (INSTANTS - 1) as f64;
    let at = Instants { first_s: 0.0, dt_s, samples: INSTANTS };
    let motion = |name: &str, value: f64| {
        let mut parameters = candidate.parameters.clone();
        parameters.insert(name.to_owned(), value);
        let structure = structure_of(&candidate.model, candidate.law.as_deref(), &parameters).ok()?;
        structure.motions_at(impact_speed_m_per_s, &at).ok()?.pop()
    };
    let derivatives = known.order.iter().map(|name| {
        let value = *candidate.parameters.get(name)?;
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
            NORMAL_95 * variance.max(0.0).sqrt()
        };
        let half_widths: Vec<f64> = (0..INSTANTS).map(half_width).collect();
        half_widths.iter().all(|half| half.is_finite()).then_some(half_widths)
    };
    Some(MotionBandV1 {
        dt_s,
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

    use super::*;

    /// A spring alone, whose motion is `v0/w sin(w t)`.
    fn spring(deviation: f64) -> CandidateV1 {
        let stiffness = |value: f64| BTreeMap::from([("stiffness_n_per_m".to_owned(), value)]);
        let end = |value: f64| BTreeMap::from([("stiffness_n_per_m".to_owned(), Some(value))]);
        let mut parameters = stiffness(4e5);
        parameters.extend([("mass_kg", 1000.0), ("damping_n_s_per_m", 0.0)].map(|(name, si)| (name.to_owned(), si)));
        CandidateV1 {
            model: "kelvin".to_owned(),
            parameters,
            uncertainty: Some(UncertaintyV1 {
                standard_deviation: stiffness(deviation),
                interval_low: end(3.9e5),
                interval_high: end(4.1e5),
                order: vec!["stiffness_n_per_m".to_owned()],
                correlation: vec![vec![1.0]],
                ..UncertaintyV1::default()
            }),
            ..CandidateV1::default()
        }
    }

    #[test]
    fn the_band_of_a_spring_is_that_of_its_closed_form() {
        let band = motion_band(&spring(8e3), 10.0, 0.0796).unwrap();
        let (w, v0) = (20.0_f64, 10.0);
        // d/dw of v0/w sin(w t), dw = w/(2k) dk.
        let per_k = w / (2.0 * 4e5);
        for (k, half) in band.displacement_m.iter().enumerate() {
            let t = k as f64 * band.dt_s;
            let by_w = v0 * (t * (w * t).cos() / w - (w * t).sin() / (w * w));
            let expected = NORMAL_95 * (by_w * per_k).abs() * 8e3;
            // The central difference is off by the square of its step.
            assert!((half - expected).abs() <= 1e-5 * expected + 1e-9, "{t}: {half} {expected}");
        }
        let last = *band.velocity_m_per_s.last().unwrap();
        let t = 0.0796;
        let expected = NORMAL_95 * v0 * t * (w * t).sin().abs() * per_k * 8e3;
        assert!((last - expected).abs() <= 1e-5 * expected, "{last} {expected}");
    }

    #[test]
    fn an_open_parameter_has_no_band() {
        assert_eq!(motion_band(&spring(5e5), 10.0, 0.0796), None);
    }
}
