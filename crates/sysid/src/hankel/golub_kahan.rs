//! The leading singular triplets of a large Hankel matrix.

use crumple_numerics::estimation::random::RandomNumbers;
use crumple_numerics::linalg::{dot, jacobi_svd};
use nalgebra::DMatrix;

use crate::hankel::shift_pair::{Shift, ShiftPair};

/// A norm this small, relative to the largest, is rounding: nothing new was found in that direction.
const BREAKDOWN: f64 = 1e-14;

/// Golub-Kahan-Lanczos bidiagonalisation `H V = U B`, with both bases reorthogonalised in full, twice, at every step.
///
/// Where a product brings nothing new, an invariant subspace is complete. That need not be all: of coinciding singular
/// values (an undamped wave over whole periods) one start vector finds one. So the iteration goes on from a random
/// direction, and only when the matrix annihilates that one too is the range exhausted.
///
/// The start vector comes from a fixed seed: same input, same bits. Every step costs two FFT products and
/// `O(N j)` for the orthogonality.
///
/// Golub & Kahan, SIAM J. Numer. Anal. 2(2), 1965; reorthogonalisation as in Simon & Zha, SIAM J. Sci. Comput. 21(6),
/// 2000.
pub(crate) struct GolubKahan {
    /// Source of the start vector and of fresh directions, seeded with 0.
    random: RandomNumbers,
    /// Left basis, one vector after the other.
    left: Vec<f64>,
    /// Right basis, with the next start vector as its last.
    right: Vec<f64>,
    /// Entries of the upper bidiagonal matrix `B`: `alpha_j` on its diagonal.
    diagonal: Vec<f64>,
    /// Entries `beta_j` beside the diagonal; the last one couples to the next start vector and is the residual of the
    /// factorisation.
    superdiagonal: Vec<f64>,
    /// Whether the last right vector is a random one, not a product.
    fresh_right: bool,
    /// Whether nothing is left outside the two bases, so that the singular values of `B` are those of `H`.
    exhausted: bool,
}

/// Approximate singular triplets, largest value first.
pub(crate) struct Ritz {
    /// Values.
    pub(crate) values: Vec<f64>,
    /// Bounds of the distance to a true singular value: the residual of each triplet.
    pub(crate) residuals: Vec<f64>,
    /// Singular vectors of the bidiagonal matrix: coordinates in the two bases, steps x steps.
    left: DMatrix<f64>,
    right: DMatrix<f64>,
}

impl GolubKahan {
    /// Draws the start vector.
    pub(crate) fn new(columns: usize) -> Self {
        let mut random = RandomNumbers::seeded(0);
        let right = fresh_direction(&mut random, columns, &[]);
        Self {
            random,
            left: Vec::new(),
            right,
            diagonal: Vec::new(),
            superdiagonal: Vec::new(),
            fresh_right: true,
            exhausted: false,
        }
    }

    /// Steps taken.
    pub(crate) fn steps(&self) -> usize {
        self.diagonal.len()
    }

    /// Whether the whole range has been found, so that the values are all there are.
    pub(crate) fn exhausted(&self) -> bool {
        self.exhausted
    }

    /// Takes steps until there are `steps` of them or the space is exhausted.
    ///
    /// One step: `u = H v_j - beta_(j-1) u_(j-1)`, `alpha_j = |u|`, then `w = H' u_j - alpha_j v_j`, `beta_j = |w|`.
    /// Both new vectors are made orthogonal to all earlier ones of their side, without which rounding brings
    /// converged values back as copies ("ghosts").
    pub(crate) fn extend(&mut self, h: &mut impl ShiftPair, steps: usize) {
        let (rows, columns) = (h.rows(), h.columns());
        let mut u = vec![0.0; rows];
        let mut w = vec![0.0; columns];
        while self.steps() < steps && !self.exhausted {
            let j = self.steps();
            let largest = self.diagonal.iter().chain(&self.superdiagonal).copied().fold(0.0, f64::max);
            h.multiply(Shift::Zero, &self.right[j * columns..], &mut u);
            if j > 0 {
                subtract(&mut u, self.superdiagonal[j - 1], &self.left[(j - 1) * rows..]);
            }
            orthogonalize(&mut u, &self.left);
            let mut alpha = normalize(&mut u);
            let mut fresh_left = false;
            if alpha <= BREAKDOWN * largest {
                if self.fresh_right {
                    self.exhausted = true;
                    break;
                }
                alpha = 0.0;
                fresh_left = true;
                u = fresh_direction(&mut self.random, rows, &self.left);
            }
            h.multiply_transposed(Shift::Zero, &u, &mut w);
            subtract(&mut w, alpha, &self.right[j * columns..]);
            orthogonalize(&mut w, &self.right);
            let mut beta = normalize(&mut w);
            self.fresh_right = beta <= BREAKDOWN * largest.max(alpha);
            if self.fresh_right {
                beta = 0.0;
                w = fresh_direction(&mut self.random, columns, &self.right);
            }
            self.left.extend_from_slice(&u);
            self.right.extend_from_slice(&w);
            self.diagonal.push(alpha);
            self.superdiagonal.push(beta);
            self.exhausted = (fresh_left && self.fresh_right) || self.steps() == rows.min(columns);
        }
    }

    /// Singular triplets of the bidiagonal matrix found so far; `None` if that small SVD does not converge.
    ///
    /// `residual_i = beta_last |P[last, i]|` for the left vectors `P` of `B`; a singular value of `H` lies within it
    /// of the `i`-th value, and the error of a value is of the order of its square over the gap to the next.
    pub(crate) fn ritz(&self) -> Option<Ritz> {
        let j = self.steps();
        let mut bidiagonal = DMatrix::zeros(j, j);
        for k in 0..j {
            bidiagonal[(k, k)] = self.diagonal[k];
            if k + 1 < j {
                bidiagonal[(k, k + 1)] = self.superdiagonal[k];
            }
        }
        let svd = jacobi_svd(&bidiagonal)?;
        // H' u_i = s_i v_i + last superdiagonal entry * P[last, i] * next right vector.
        let open = if self.exhausted { 0.0 } else { self.superdiagonal.last().copied().unwrap_or(0.0) };
        let residuals = (0..j).map(|i| open * svd.left[(j - 1, i)].abs()).collect();
        Some(Ritz { values: svd.values, residuals, left: svd.left, right: svd.right })
    }

    /// The first `count` left and right singular vectors, as columns.
    ///
    /// `U P` and `V Q`: rows (columns) of the matrix x `count`, orthonormal to rounding.
    pub(crate) fn vectors(&self, ritz: &Ritz, count: usize) -> (DMatrix<f64>, DMatrix<f64>) {
        let j = ritz.values.len();
        let basis = |data: &[f64]| DMatrix::from_column_slice(data.len() / self.steps(), j, data);
        let columns = self.right.len() / (self.steps() + 1);
        (
            basis(&self.left) * ritz.left.columns(0, count),
            basis(&self.right[..self.steps() * columns]) * ritz.right.columns(0, count),
        )
    }
}

/// Removes from `x` its part in the space of the orthonormal `basis`. Once is enough where little was removed: what is
/// left of the part is then rounding of what stays. Where the norm falls below `1/sqrt 2` of what it was, much was
/// removed, and it is done again; twice is always enough (Daniel, Gragg, Kaufman & Stewart, Math. Comp. 30, 1976).
fn orthogonalize(x: &mut [f64], basis: &[f64]) {
    let before = dot(x, x);
    if remove(x, basis) < 0.5 * before {
        remove(x, basis);
    }
}

/// One pass of [`orthogonalize`]; returns the square of the norm that is left.
fn remove(x: &mut [f64], basis: &[f64]) -> f64 {
    // Four vectors at a time: each pass over `x` serves them all.
    let vectors: Vec<&[f64]> = basis.chunks_exact(x.len()).collect();
    let components: Vec<f64> = vectors.iter().map(|b| dot(b, x)).collect();
    let mut groups = vectors.chunks_exact(4);
    let mut coefficients = components.chunks_exact(4);
    for (b, c) in groups.by_ref().zip(coefficients.by_ref()) {
        let rest = b[0].iter().zip(b[1]).zip(b[2].iter().zip(b[3]));
        for (x, ((b0, b1), (b2, b3))) in x.iter_mut().zip(rest) {
            *x -= (c[0] * b0 + c[1] * b1) + (c[2] * b2 + c[3] * b3);
        }
    }
    for (b, c) in groups.remainder().iter().zip(coefficients.remainder()) {
        subtract(x, *c, b);
    }
    dot(x, x)
}

/// `x -= factor b`.
fn subtract(x: &mut [f64], factor: f64, b: &[f64]) {
    for (x, b) in x.iter_mut().zip(b) {
        *x -= factor * b;
    }
}

/// A random unit vector orthogonal to `basis`.
fn fresh_direction(random: &mut RandomNumbers, length: usize, basis: &[f64]) -> Vec<f64> {
    let mut x: Vec<f64> = (0..length).map(|_| 2.0 * random.uniform() - 1.0).collect();
    orthogonalize(&mut x, basis);
    normalize(&mut x);
    x
}

/// Divides by the Euclidean norm, which it returns; a zero vector stays.
fn normalize(x: &mut [f64]) -> f64 {
    let norm = dot(x, x).sqrt();
    if norm > 0.0 {
        for value in x {
            *value /= norm;
        }
    }
    norm
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hankel::block_hankel::Hankel;

    #[test]
    fn agrees_with_the_dense_decomposition_on_a_decaying_record() {
        let y: Vec<f64> = (0..160)
            .map(|k| {
                let t = f64::from(k);
                (-0.02 * t).exp() * (0.3 * t).cos() + 0.1 * (-0.005 * t).exp() + 1e-3 * (t * t).sin()
            })
            .collect();
        let mut h = Hankel::new(vec![&y], 1, 80, 80);
        let dense = h.dense().singular_values();
        let mut lanczos = GolubKahan::new(80);
        lanczos.extend(&mut h, 30);
        let ritz = lanczos.ritz().unwrap();
        for i in 0..3 {
            // Rounding of the FFT products, relative to the largest value.
            assert!((ritz.values[i] - dense[i]).abs() < 1e-13 * dense[0], "{} {}", ritz.values[i], dense[i]);
        }
        let (u, v) = lanczos.vectors(&ritz, 3);
        assert!((u.transpose() * &u - DMatrix::identity(3, 3)).norm() < 1e-13);
        let residual =
            h.dense() * &v - &u * DMatrix::from_diagonal(&nalgebra::DVector::from_column_slice(&ritz.values[..3]));
        assert!(residual.norm() < 1e-12 * dense[0], "{}", residual.norm());
    }

    #[test]
    fn finds_both_of_two_equal_singular_values() {
        // Whole periods of an undamped wave: the two singular values are 50 and 50.
        let y: Vec<f64> = (0..200).map(|k| (f64::from(k) * std::f64::consts::TAU / 25.0).cos()).collect();
        let mut lanczos = GolubKahan::new(100);
        lanczos.extend(&mut Hankel::new(vec![&y], 1, 100, 100), 10);
        let values = lanczos.ritz().unwrap().values;
        // Rounding of the FFT products.
        assert!((values[0] - 50.0).abs() < 1e-12 && (values[1] - 50.0).abs() < 1e-12, "{values:?}");
        assert!(values.iter().skip(2).all(|s| *s < 1e-12), "{values:?}");
    }

    #[test]
    fn stops_at_the_rank_of_an_exact_record() {
        let y: Vec<f64> = (0..200).map(|k| 0.99_f64.powi(k) + (-0.9_f64).powi(k)).collect();
        let mut h = Hankel::new(vec![&y], 1, 100, 100);
        let mut lanczos = GolubKahan::new(100);
        lanczos.extend(&mut h, 40);
        let ritz = lanczos.ritz().unwrap();
        // Rank 2; whatever steps were taken after it found rounding only.
        assert!(ritz.values.iter().skip(2).all(|s| *s < 1e-13 * ritz.values[0]), "{:?}", ritz.values);
    }
}
