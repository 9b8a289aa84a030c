//! Rows of random numbers: uniform and normal deviates of a seed.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// 53 bits over the interval from 0 to 1.
const UNIT: f64 = 1.0 / (1_u64 << 53) as f64;

/// A row of independent random numbers, the same for the same seed: ChaCha8, 53 bits each.
#[derive(Debug, Clone)]
pub struct RandomNumbers(ChaCha8Rng);

impl RandomNumbers {
    /// The row of a seed.
    pub fn seeded(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Row `index` of a seed, independent of its others: repetitions that each draw from their own row do not depend on
    /// the order in which they run.
    pub fn of_stream(seed: u64, index: usize) -> Self {
        let mut row = Self::seeded(seed);
        row.0.set_stream(index as u64);
        row
    }

    /// Uniform on [0, 1).
    pub fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * UNIT
    }

    /// A whole number from 0 to `count - 1`, each as likely to 1e-13 for fewer than a million; 0 for a count of 0.
    pub fn below(&mut self, count: usize) -> usize {
        (self.0.next_u64() % count.max(1) as u64) as usize
    }

    /// A standard normal deviate from two uniform numbers, `sqrt(-2 ln u) cos(2 pi w)` with `u` on (0, 1] and `w` on
    /// [0, 1). The 53 bits end the tails at 8.6.
    ///
    /// Box & Muller, "A note on the generation of random normal deviates", Ann. Math. Stat. 29, 1958.
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (self.uniform() + UNIT).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_variance_and_fourth_moment_are_those_of_the_normal_distribution() {
        let mut random = RandomNumbers::seeded(3);
        let n = 20_000;
        let draws: Vec<f64> = (0..n).map(|_| random.normal()).collect();
        let moment = |power: i32| draws.iter().map(|x| x.powi(power)).sum::<f64>() / f64::from(n);
        // Five standard errors: sqrt(1/n), sqrt(2/n), sqrt(96/n).
        let error = 5.0 / f64::from(n).sqrt();
        assert!(moment(1).abs() < error, "{}", moment(1));
        assert!((moment(2) - 1.0).abs() < 2.0_f64.sqrt() * error, "{}", moment(2));
        assert!((moment(4) - 3.0).abs() < 96.0_f64.sqrt() * error, "{}", moment(4));
    }

    #[test]
    fn rows_of_a_seed_differ_and_come_back() {
        let row = |seed, index| {
            let mut random = RandomNumbers::of_stream(seed, index);
            std::array::from_fn::<usize, 8, _>(|_| random.below(1000))
        };
        assert_eq!(row(1, 2), row(1, 2));
        assert!(row(1, 2) != row(1, 3) && row(1, 2) != row(2, 2));
    }
}
