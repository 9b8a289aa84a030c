//! The weighted projections of the subspace methods.
//!
//! The extended observability matrix is the column space of what past inputs and outputs tell of future outputs. The
//! three methods weigh that projection differently before its singular values are taken, and differ in nothing else:
//! Van Overschee & De Moor, *Subspace Identification for Linear Systems*, 1996.

use crumple_linalg::jacobi_svd;
use crumple_linalg::{numerical_rank, pseudo_inverse_times};
use nalgebra::DMatrix;

/// How the projection of the future on the past is weighted before its singular values are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weighting {
    /// The oblique projection as it is (Van Overschee & De Moor 1994).
    N4sid,
    /// Without the part that future inputs explain (Verhaegen 1994).
    Moesp,
    /// Canonical correlations: in units of what the past leaves unexplained (Larimore 1990).
    Cva,
}

impl Weighting {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::N4sid, Self::Moesp, Self::Cva];

    /// Name of the method: `n4sid`, `moesp`, `cva`.
    pub fn name(self) -> &'static str {
        match self {
            Self::N4sid => "n4sid",
            Self::Moesp => "moesp",
            Self::Cva => "cva",
        }
    }
}

/// The transposed weighted projection of future outputs on the past, tall, and what takes its right vectors back to the
/// extended observability matrix; `None`: they are it.
pub(crate) struct Projection {
    /// Rows x future outputs; its right singular vectors are the directions of the observability matrix.
    pub(crate) transposed: DMatrix<f64>,
    /// What undoes a weighting of the outputs.
    pub(crate) back: Option<DMatrix<f64>>,
}

impl Weighting {
    /// The projection from the triangular factor `r` of `[U_f; W_p; Y_f]'`: `future` columns of future inputs, `past`
    /// of past inputs and outputs, `outputs` of future outputs. `None`: a decomposition does not converge.
    ///
    /// MOESP takes `L32`, N4SID the oblique projection `L32 L22^+ [L21 L22]`, CVA `L32` divided by the square root of
    /// the covariance of the future outputs without the part of future inputs.
    pub(crate) fn projection(self, r: &DMatrix<f64>, future: usize, past: usize, outputs: usize) -> Option<Projection> {
        let part = |row: usize, rows: usize, column: usize, columns: usize| {
            r.view((row, column), (rows, columns)).into_owned()
        };
        // L = R': L32 is R23', and so on.
        let r22 = part(future, past, future, past);
        let r23 = part(future, past, future + past, outputs);
        let r33 = part(future + past, outputs, future + past, outputs);
        let (transposed, back) = match self {
            Self::Moesp => (r23, None),
            Self::N4sid => {
                // L32 L22^+ [L21 L22], transposed.
                let r12 = part(0, future, future, past);
                let coefficients = pseudo_inverse_times(&r22, &r23)?;
                let mut projection = DMatrix::zeros(future + past, outputs);
                projection.rows_mut(0, future).copy_from(&(r12 * &coefficients));
                projection.rows_mut(future, past).copy_from(&(&r22 * &coefficients));
                (projection, None)
            }
            Self::Cva => {
                let mut both = DMatrix::zeros(past + outputs, outputs);
                both.rows_mut(0, past).copy_from(&r23);
                both.rows_mut(past, outputs).copy_from(&r33);
                let svd = jacobi_svd(&both.qr().r())?;
                let rank = numerical_rank(&svd.values);
                let basis = svd.right.columns(0, rank).into_owned();
                let values = &svd.values[..rank];
                let mut weighted = r23 * &basis;
                let mut back = basis;
                for (k, s) in values.iter().enumerate() {
                    weighted.column_mut(k).unscale_mut(*s);
                    back.column_mut(k).scale_mut(*s);
                }
                (weighted, Some(back))
            }
        };
        Some(Projection { transposed, back })
    }
}
