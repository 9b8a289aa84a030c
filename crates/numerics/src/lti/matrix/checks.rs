//! Checks of a matrix before it is computed with.

use nalgebra::DMatrix;

use crate::lti::LtiError;

/// Errors unless every entry is finite.
pub(crate) fn check_finite(what: &'static str, matrix: &DMatrix<f64>) -> Result<(), LtiError> {
    if matrix.iter().all(|x| x.is_finite()) { Ok(()) } else { Err(LtiError::NotFinite { what }) }
}

/// Errors unless the matrix is square and finite.
pub(crate) fn check_square(what: &'static str, matrix: &DMatrix<f64>) -> Result<(), LtiError> {
    let (rows, columns) = matrix.shape();
    if rows != columns {
        return Err(LtiError::Shape { what, rows, columns, expected: "a square matrix".to_owned() });
    }
    check_finite(what, matrix)
}
