//! The state matrix from singular vectors: three ways to solve the shift equation.

use crumple_numerics::linalg::jacobi_svd;
use nalgebra::{DMatrix, DVector};

/// How the state matrix follows from the decomposition `H0 = U S V'`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ShiftForm {
    /// `S^-1/2 U' H1 V S^-1/2`, as in Juang & Pappa (1985). Damps poles in noise.
    #[default]
    Hankel,
    /// The observability matrix `O = U S^1/2` without its last block row, times `A`, is `O` without its first: least
    /// squares. Damps poles in noise too.
    LeastSquares,
    /// The same by total least squares, both sides taken for noisy: poles less biased, more scattered. On `U`, all of
    /// whose columns count alike (Roy & Kailath, ESPRIT, IEEE Trans. ASSP 37(7), 1989).
    TotalLeastSquares,
}

impl ShiftForm {
    /// All of them, the default first.
    pub const ALL: [Self; 3] = [Self::Hankel, Self::LeastSquares, Self::TotalLeastSquares];

    /// Name in options: `hankel`, `least-squares`, `total-least-squares`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hankel => "hankel",
            Self::LeastSquares => "least-squares",
            Self::TotalLeastSquares => "total-least-squares",
        }
    }
}

/// `A` in balanced coordinates from the left singular vectors `u` (as many columns as states, `block` rows each
/// sample), the square roots of the singular values, and `shifted = U' H1 V`. `None`: too few rows, or a decomposition
/// that does not settle or is singular.
pub(crate) fn state_matrix(
    form: ShiftForm,
    u: &DMatrix<f64>,
    roots: &DVector<f64>,
    shifted: &DMatrix<f64>,
    block: usize,
) -> Option<DMatrix<f64>> {
    let n = roots.len();
    if form == ShiftForm::Hankel {
        return Some(DMatrix::from_fn(n, n, |i, j| shifted[(i, j)] / (roots[i] * roots[j])));
    }
    let kept = u.nrows().checked_sub(block).filter(|kept| *kept >= n)?;
    let (early, late) = (u.view((0, 0), (kept, n)), u.view((block, 0), (kept, n)));
    let bare = match form {
        ShiftForm::TotalLeastSquares => {
            let mut both = DMatrix::zeros(kept.max(2 * n), 2 * n);
            both.view_mut((0, 0), (kept, n)).copy_from(&early);
            both.view_mut((0, n), (kept, n)).copy_from(&late);
            let right = jacobi_svd(&both.qr().r())?.right;
            let noise = right.columns(n, n);
            -(noise.rows(0, n) * noise.rows(n, n).into_owned().try_inverse()?)
        }
        _ => {
            let (q, r) = early.into_owned().qr().unpack();
            let svd = jacobi_svd(&r)?;
            svd.values.last().filter(|s| **s > f64::EPSILON)?;
            let mut parts = svd.left.tr_mul(&q.tr_mul(&late));
            for (mut row, s) in parts.row_iter_mut().zip(&svd.values) {
                row.unscale_mut(*s);
            }
            svd.right * parts
        }
    };
    // From the coordinates of U to those of U S^1/2.
    let a = DMatrix::from_fn(n, n, |i, j| bare[(i, j)] / roots[i] * roots[j]);
    a.iter().all(|x| x.is_finite()).then_some(a)
}
