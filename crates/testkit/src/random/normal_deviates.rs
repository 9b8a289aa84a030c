//! Standard normal numbers by Box and Muller's rule.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// A row of independent standard normal numbers, the same for the same seed.
#[derive(Debug, Clone)]
pub struct NormalDeviates(ChaCha8Rng);

impl NormalDeviates {
    /// The row of this seed.
    pub fn seeded(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// The next number of the same row as one between 0 and 1, each as likely.
    pub fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * 2.0_f64.powi(-53)
    }

    /// The next number.
    pub fn draw(&mut self) -> f64 {
        // 53 bits each; the first in (0, 1] so that its logarithm is finite.
        let unit = 2.0_f64.powi(-53);
        let radius = ((self.0.next_u64() >> 11) + 1) as f64 * unit;
        let angle = (self.0.next_u64() >> 11) as f64 * unit;
        (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * angle).cos()
    }
}

#[test]
fn mean_variance_and_fourth_moment_are_those_of_the_normal_distribution() {
    let mut deviates = NormalDeviates::seeded(3);
    let n = 20_000;
    let draws: Vec<f64> = (0..n).map(|_| deviates.draw()).collect();
    let moment = |power: i32| draws.iter().map(|x| x.powi(power)).sum::<f64>() / f64::from(n);
    // Five standard errors: sqrt(1/n), sqrt(2/n), sqrt(96/n).
    let error = 5.0 / f64::from(n).sqrt();
    assert!(moment(1).abs() < error, "{}", moment(1));
    assert!((moment(2) - 1.0).abs() < 2.0_f64.sqrt() * error, "{}", moment(2));
    assert!((moment(4) - 3.0).abs() < 96.0_f64.sqrt() * error, "{}", moment(4));
}
