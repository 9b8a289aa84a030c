//! Triangular factors of matrices whose columns are stretches of signals.

use crumple_numerics::linalg::TriangularFactor;
use rayon::prelude::*;

/// Samples per independent part of a long record.
const PART: usize = 5_120;

/// Triangular factor of the matrix whose columns are stretches of signals: `(signal, offset)`, `rows` samples each.
///
/// `R` of `Q R`, without `Q`, in memory that does not grow with the rows. Parts of the record are factorised in
/// parallel and merged in their order: the result does not depend on the number of threads.
pub(crate) fn triangular_factor(stretches: &[(&[f64], usize)], rows: usize) -> TriangularFactor {
    let width = stretches.len();
    let block_rows = TriangularFactor::block_rows(width);
    let starts: Vec<usize> = (0..rows).step_by(PART.max(4 * width)).collect();
    let factors: Vec<TriangularFactor> = starts
        .into_par_iter()
        .map(|start| {
            let end = (start + PART.max(4 * width)).min(rows);
            let mut factor = TriangularFactor::new(width);
            let mut block = vec![0.0; block_rows * width];
            for k in (start..end).step_by(block_rows) {
                let count = block_rows.min(end - k);
                let block = &mut block[..count * width];
                for (target, (signal, offset)) in block.chunks_exact_mut(count).zip(stretches) {
                    target.copy_from_slice(&signal[offset + k..offset + k + count]);
                }
                factor.push(count, block);
            }
            factor
        })
        .collect();
    let mut factors = factors.into_iter();
    let mut whole = factors.next().unwrap_or_else(|| TriangularFactor::new(width));
    for part in factors {
        whole.merge(&part);
    }
    whole
}
