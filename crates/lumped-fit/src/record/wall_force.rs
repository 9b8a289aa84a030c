//! The force on the wall of a test, and how far a model misses it.

use crumple_lumped::Structure;
use crumple_signal::Sampled;

use crate::record::observation::ObservedWave;
use crate::{FitQuantity, Measurement, SolveError};

/// A measured force on the wall, from contact to the end of its window.
#[derive(Debug, Clone, PartialEq)]
pub struct WallForce {
    wave: ObservedWave,
}

impl WallForce {
    /// The force, N, up to `to_s` after contact; `measurement`: how it was measured. Errors: a window that leaves the
    /// record, or fewer than 12 samples.
    pub fn new(force: &Sampled, time_zero_s: f64, measurement: Measurement, to_s: f64) -> Result<Self, SolveError> {
        let what = (None, FitQuantity::Force);
        let wave = ObservedWave::new(force, what, time_zero_s, measurement, (0.0, to_s), usize::MAX)?;
        Ok(Self { wave })
    }

    /// End of the window, s after contact.
    pub fn to_s(&self) -> f64 {
        self.wave.time_s(self.wave.samples.len() - 1)
    }

    /// How far a model that hits the wall at this speed misses the force, percent: root mean square of the force of the
    /// model, filtered as that measured, less the one measured, over the root mean square of that. `None` for a record
    /// of zeros, and where the model has no response.
    pub fn misfit_percent(&self, structure: &Structure, impact_speed_m_per_s: f64) -> Option<f64> {
        let force = self.wave.response(impact_speed_m_per_s, structure).ok()?;
        let missed: f64 = force.iter().zip(&self.wave.samples).map(|(model, record)| (model - record).powi(2)).sum();
        let measured: f64 = self.wave.samples.iter().map(|force| force * force).sum();
        let same_length = force.len() == self.wave.samples.len();
        Some(100.0 * (missed / measured).sqrt()).filter(|percent| same_length && percent.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use crumple_lumped::{Kelvin, Model};

    use super::*;

    /// A spring alone: the force is `k x`, the wall feels nothing else.
    #[test]
    fn the_force_of_the_model_itself_is_not_missed_and_half_of_it_by_as_much_again() {
        let model = Kelvin { mass_kg: 1000.0, stiffness_n_per_m: 9e5, damping_n_s_per_m: 0.0 };
        let structure = Model::Kelvin(model).structure().unwrap();
        let omega = 30.0_f64;
        let force = |scale: f64| -> Vec<f64> {
            (0..800).map(|k| scale * 9e5 * 14.0 / omega * (omega * 1e-4 * f64::from(k)).sin()).collect()
        };
        let misfit = |scale: f64| {
            let record = Sampled::new(0.0, 1e-4, force(scale)).unwrap();
            let wall = WallForce::new(&record, 0.0, Measurement::of_samples(&record, 0.0), 0.07).unwrap();
            wall.misfit_percent(&structure, 14.0).unwrap()
        };
        // Rounding of 700 steps.
        assert!(misfit(1.0) < 1e-9, "{}", misfit(1.0));
        assert!((misfit(0.5) - 100.0).abs() < 1e-9, "{}", misfit(0.5));
    }
}
