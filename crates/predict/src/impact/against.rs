//! A prediction beside a test that was made.

use crumple_metrics::{Iso18571Options, iso18571};
use crumple_signal::Sampled;

use crate::impact::felt::FeltOverEnergy;
use crate::impact::outcome::{Outcome, Quantity, Wave, through_cfc_60};

/// A test that was made.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MadeTest {
    /// Dynamic crush, m.
    pub dynamic_crush_m: Option<f64>,
    /// Its time, s after time zero.
    pub time_of_dynamic_crush_s: Option<f64>,
    /// Change of velocity up to the rebound, m/s; `None` where the record ends before it does, so that it is a lower
    /// bound.
    pub delta_v_m_per_s: Option<f64>,
    /// Coefficient of restitution; `None` likewise.
    pub coefficient_of_restitution: Option<f64>,
    /// Standard deviations of these by its inputs, where they are known.
    pub deviations: Vec<(Quantity, f64)>,
    /// Largest deceleration, m/s².
    pub peak_m_per_s2: Option<f64>,
    /// Acceleration of the compartment as filtered, counted from time zero.
    pub acceleration: Option<Sampled>,
    /// What it felt over the energy it had taken.
    pub felt: Option<FeltOverEnergy>,
}

impl MadeTest {
    /// What it says of a quantity.
    pub fn get(&self, quantity: Quantity) -> Option<f64> {
        match quantity {
            Quantity::DynamicCrush => self.dynamic_crush_m,
            Quantity::TimeOfDynamicCrush => self.time_of_dynamic_crush_s,
            Quantity::DeltaV => self.delta_v_m_per_s,
            Quantity::Restitution => self.coefficient_of_restitution,
            Quantity::Peak => self.peak_m_per_s2,
            _ => None,
        }
    }

    /// The standard deviation that a number has that is known as well as the one measured, in proportion to it.
    pub(crate) fn deviation_of(&self, quantity: Quantity, value: f64) -> f64 {
        let known = self.deviations.iter().find(|(other, _)| *other == quantity).zip(self.get(quantity));
        known.map_or(0.0, |((_, deviation), measured)| match measured == 0.0 {
            true => *deviation,
            false => deviation * (value / measured).abs(),
        })
    }

    /// The test with what it felt over the energy it had taken, from its velocity, counted from time zero; `filtered`:
    /// its acceleration was through CFC 60 already.
    #[must_use]
    pub fn with_velocity(self, speed_m_per_s: f64, velocity: &Sampled, filtered: bool) -> Self {
        let dt_s = velocity.dt_s();
        let first = (-velocity.t0_s() / dt_s - 1e-6).ceil().max(0.0) as usize;
        let velocity = velocity.samples().get(first..).unwrap_or_default();
        let deceleration: Vec<f64> = velocity.windows(2).map(|pair| (pair[0] - pair[1]) / dt_s).collect();
        let deceleration = if filtered { Some(deceleration) } else { through_cfc_60(&deceleration, dt_s) };
        let felt = deceleration.and_then(|felt| FeltOverEnergy::new(speed_m_per_s, velocity.get(1..)?, &felt));
        Self { felt, ..self }
    }

    /// Predicted less measured, percent of the measured.
    pub fn error_percent(&self, outcome: &Outcome, quantity: Quantity) -> Option<f64> {
        let (predicted, measured) = (outcome.get(quantity)?, self.get(quantity)?);
        (measured != 0.0).then(|| 100.0 * (predicted / measured - 1.0))
    }

    /// Score of the predicted acceleration by ISO/TS 18571 up to the dynamic crush of the test, through CFC 60 as a
    /// laboratory would filter it; the record is interpolated linearly to the instants of the prediction, 10 kHz.
    /// `None`: one of both is too short.
    pub fn iso18571_score(&self, wave: &Wave) -> Option<f64> {
        let measured = self.acceleration.as_ref()?;
        let predicted = through_cfc_60(&wave.compartment()?.acceleration_m_per_s2, wave.dt_s)?;
        let samples = (self.time_of_dynamic_crush_s? / wave.dt_s) as usize + 1;
        let record: Vec<f64> = (0..samples).map_while(|k| measured.at(k as f64 * wave.dt_s)).collect();
        let predicted = predicted.get(..record.len())?.to_vec();
        let grid = |samples| Sampled::new(0.0, wave.dt_s, samples).ok();
        iso18571(&grid(record)?, &grid(predicted)?, &Iso18571Options::default()).ok()?.overall
    }
}

#[cfg(test)]
mod tests {
    use crumple_lumped::{Elastoplastic, Model};

    use super::*;
    use crate::impact::outcome::at_wall;

    #[test]
    fn a_test_that_was_the_prediction_scores_1_and_another_less() {
        let structure = |k: f64| {
            let model = Elastoplastic {
                mass_kg: 1000.0,
                loading_stiffness_n_per_m: k,
                unloading_stiffness_n_per_m: 1.6e7,
                release: true,
            };
            Model::Elastoplastic(model).structure().unwrap()
        };
        let (outcome, wave) = at_wall(&structure(4e5), 15.0, 1e-4).unwrap();
        let filtered = through_cfc_60(&wave.compartment().unwrap().acceleration_m_per_s2, 1e-4).unwrap();
        let made = MadeTest {
            dynamic_crush_m: outcome.get(Quantity::DynamicCrush),
            time_of_dynamic_crush_s: outcome.get(Quantity::TimeOfDynamicCrush),
            coefficient_of_restitution: outcome.get(Quantity::Restitution),
            peak_m_per_s2: outcome.get(Quantity::Peak),
            acceleration: Sampled::new(0.0, 1e-4, filtered).ok(),
            ..MadeTest::default()
        };
        assert_eq!(made.error_percent(&outcome, Quantity::DynamicCrush), Some(0.0));
        // Equal curves rate 1; interpolation between equal instants is a rounding.
        assert!((made.iso18571_score(&wave).unwrap() - 1.0).abs() < 1e-6);
        let (stiffer, other) = at_wall(&structure(5e5), 15.0, 1e-4).unwrap();
        // Crush goes as one over the root of the stiffness.
        let error = made.error_percent(&stiffer, Quantity::DynamicCrush).unwrap();
        assert!((error - 100.0 * (0.8_f64.sqrt() - 1.0)).abs() < 1e-6, "{error}");
        assert!(made.iso18571_score(&other).unwrap() < 0.95);
        assert_eq!(MadeTest::default().iso18571_score(&wave), None);
    }
}
