//! Products of vectors in a fixed order of summation.

// The inner product of two slices.
//
// Sums of eight interleaved parts: faster than one running sum, and its rounding error grows with an eighth of the
// length.

/// Inner product of slices of one length, in eight interleaved sums, an order the compiler can keep in vector
/// registers.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    debug_assert_eq!(a.len(), b.len(), "an inner product is of slices of one length");
    let mut sums = [0.0; 8];
    let (a_chunks, b_chunks) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = a_chunks.remainder().iter().zip(b_chunks.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a_chunks.zip(b_chunks) {
        for k in 0..8 {
            sums[k] += a[k] * b[k];
        }
    }
    sums.iter().sum::<f64>() + rest
}
