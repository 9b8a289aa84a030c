//! How several waves are weighed by how well each is met.

use crate::{Observed, SeenWave};

/// The least noise level of a wave, as a share of it.
const LEAST_LEVEL: f64 = 1e-6;

impl Observed {
    /// The noise level of each wave from its root mean square misfit: never less than a millionth of the wave.
    pub fn noise_levels(&self, rmse: &[f64]) -> Vec<f64> {
        let of = |(wave, rmse): (&SeenWave, &f64)| rmse.max(LEAST_LEVEL * wave.size()).max(f64::MIN_POSITIVE);
        self.waves.iter().zip(rmse).map(of).collect()
    }

    /// Weighs the waves by the noise levels that follow from the root mean square misfit of each; whether a weight changed by more
    /// than the share `worth` of itself.
    pub fn weigh(&mut self, rmse: &[f64], worth: f64) -> bool {
        let levels = self.noise_levels(rmse);
        let mut moved = false;
        for (wave, level) in self.waves.iter_mut().zip(&levels).skip(1) {
            let weight = levels[0] / level;
            moved |= (weight / wave.weight).ln().abs() > worth;
            wave.weight = weight;
        }
        moved
    }
}
