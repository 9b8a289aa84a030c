//! Ratings of a simulation's curves with the test as reference.

use crumple_metrics::{Cora, CoraOptions, Iso18571, Iso18571Options, cora, iso18571};
use crumple_signal::Sampled;

/// Sampling interval of the ratings, s: ISO/TS 18571 wants 10 kHz.
const INTERVAL_S: f64 = 1e-4;

/// The ratings of one quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Rating {
    /// `velocity` or `acceleration`.
    pub quantity: &'static str,
    /// ISO/TS 18571 with its parts.
    pub iso: Iso18571,
    /// CORA with its parts.
    pub cora: Cora,
}

impl Rating {
    /// From contact to `to_s` or where the first curve ends, both interpolated linearly to 10 kHz. `None`: a curve does
    /// not begin at contact, or cannot be rated.
    pub fn new(quantity: &'static str, test: &Sampled, simulation: &Sampled, to_s: f64) -> Option<Self> {
        let count = (to_s.min(test.end_s()).min(simulation.end_s()) / INTERVAL_S).round() as usize;
        let on_grid = |wave: &Sampled| {
            // A first state up to one interval behind contact counts as contact; so does the end.
            let time = |k: usize| (k as f64 * INTERVAL_S).clamp(wave.t0_s().min(wave.dt_s()), wave.end_s());
            let samples: Option<Vec<f64>> = (0..=count).map(|k| wave.at(time(k))).collect();
            Sampled::new(0.0, INTERVAL_S, samples?).ok()
        };
        let (test, simulation) = (on_grid(test)?, on_grid(simulation)?);
        let iso = iso18571(&test, &simulation, &Iso18571Options::default()).ok()?;
        let cora = cora(&test, &simulation, &CoraOptions::default()).ok()?;
        Some(Self { quantity, iso, cora })
    }

    /// Time by which the simulation is late, s; negative: early.
    pub fn shift_s(&self) -> f64 {
        self.iso.shift_samples as f64 * INTERVAL_S
    }

    /// Names of the parts with their scores, the overall rating first in each.
    pub fn parts(&self) -> [(&'static str, Option<f64>); 8] {
        let (iso, cora) = (&self.iso, &self.cora);
        [
            ("ISO/TS 18571", iso.overall),
            ("ISO/TS 18571: corridor Z", Some(iso.corridor)),
            ("ISO/TS 18571: phase E_P", Some(iso.phase)),
            ("ISO/TS 18571: magnitude E_M", iso.magnitude),
            ("ISO/TS 18571: slope E_S", iso.slope),
            ("CORA", Some(cora.total)),
            ("CORA: corridor", Some(cora.corridor)),
            ("CORA: cross-correlation", Some(cora.cross_correlation)),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::validate::segments::tests::{LAW, STIFF, crash};

    #[test]
    fn equal_curves_rate_1_at_any_rate_and_a_stiffer_car_still_rates_well_by_its_velocity() {
        let [_, test, _] = crash(&LAW);
        let slow: Vec<f64> = test.samples().iter().step_by(4).copied().collect();
        let slow = Sampled::new(0.0, 4e-4, slow).unwrap();
        let rating = Rating::new("velocity", &test, &slow, 0.06).unwrap();
        assert!(rating.iso.overall.unwrap() > 0.999 && rating.cora.total > 0.999 && rating.shift_s() == 0.0);
        let [_, stiff, _] = crash(&STIFF);
        let rating = Rating::new("velocity", &test, &stiff, 0.06).unwrap();
        assert!((0.7..0.95).contains(&rating.iso.overall.unwrap()), "{:?}", rating.iso);
        let late = test.starting_at(0.01).unwrap();
        assert!(Rating::new("velocity", &test, &late, 0.06).is_none());
    }
}
