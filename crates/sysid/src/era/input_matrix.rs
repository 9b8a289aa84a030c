//! The input matrix of a model whose `A` and `C` are known, from its Markov parameters.

use crumple_linalg::TriangularFactor;
use nalgebra::DMatrix;

/// Directions of the state that the parameters show with less than this fraction of the strongest are left at zero.
const TRUNCATION: f64 = 1e-12;

/// `B` such that `C A^k B` fits `parameters[i][j][k]`, output `i` to input `j`, best in the sense of least squares. The
/// caller sees to it that `A` does not grow beyond bounds over as many samples. `None` if the fit does not settle.
///
/// One equation per output and sample, `C A^k b_j = h_ij[k]`, all inputs as right-hand sides of one factorisation.
/// `a` is `n x n`, `c` is `outputs x n`, the result `n x inputs`, in the unit of the parameters over that of `c`.
pub(crate) fn input_matrix_of(a: &DMatrix<f64>, c: &DMatrix<f64>, parameters: &[Vec<&[f64]>]) -> Option<DMatrix<f64>> {
    let (n, q) = (a.nrows(), parameters.len());
    let (m, samples) = (parameters.first()?.len(), parameters.first()?.first()?.len());
    let mut factor = TriangularFactor::new(n + m);
    let block = TriangularFactor::block_rows(n + m).div_ceil(q);
    let mut free = c.clone();
    let mut next = free.clone();
    for start in (0..samples).step_by(block) {
        let count = block.min(samples - start);
        let rows = count * q;
        let mut data = vec![0.0; rows * (n + m)];
        for k in 0..count {
            for i in 0..q {
                for s in 0..n {
                    data[s * rows + k * q + i] = free[(i, s)];
                }
                for j in 0..m {
                    data[(n + j) * rows + k * q + i] = parameters[i][j][start + k];
                }
            }
            free.mul_to(a, &mut next);
            std::mem::swap(&mut free, &mut next);
        }
        factor.push(rows, &mut data);
    }
    Some(factor.solve(m, TRUNCATION)?.coefficients)
}
