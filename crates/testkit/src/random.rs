//! Numbers that look random and are the same in every run, by their place.
//! Rows of them: `crumple_numerics::estimation::random`.

/// A number from -1 to 1 that looks random, by its place (a multiplicative hash of 64 bits).
pub fn uniform(place: u64) -> f64 {
    let mut x = place.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    x ^= x >> 32;
    x = x.wrapping_mul(0xD6E8_FEB8_6659_FD93);
    x ^= x >> 32;
    (x >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// White noise of variance 1, uniform: sample `k` of a stream.
pub fn white_noise(stream: usize, k: usize) -> f64 {
    uniform((stream * 1_000_003 + k) as u64) * 3.0_f64.sqrt()
}
