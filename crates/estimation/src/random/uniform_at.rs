//! Random numbers that depend on their stream and index alone.
//!
//! Meant for starts and resampling in parallel: each draw names its place in the sequence, so no generator is shared
//! and no order of evaluation matters.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Number `index` of stream `stream`, uniform on [0, 1): ChaCha8 with a fixed seed, so the same for any number of
/// threads and in any order.
pub fn uniform_at(stream: usize, index: usize) -> f64 {
    let mut rng = ChaCha8Rng::seed_from_u64(0x5EED);
    rng.set_stream(stream as u64);
    rng.set_word_pos(2 * index as u128);
    (rng.next_u64() >> 11) as f64 * 2.0_f64.powi(-53)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_uniform_and_differ() {
        let numbers: Vec<f64> = (0..1000).map(|k| uniform_at(k % 10, k / 10)).collect();
        let mean = numbers.iter().sum::<f64>() / 1000.0;
        // Standard deviation of the mean 0.009.
        assert!((mean - 0.5).abs() < 0.04 && numbers.iter().all(|x| (0.0..1.0).contains(x)));
        assert!(uniform_at(0, 0) != uniform_at(1, 0) && uniform_at(0, 0) != uniform_at(0, 1));
    }
}
