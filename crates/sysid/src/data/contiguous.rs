//! Rows and columns of a matrix as slices, for inner products that run over neighbouring numbers.

use nalgebra::DMatrix;

/// Rows of a matrix, contiguous.
pub(crate) fn rows_of(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    matrix.row_iter().map(|row| row.iter().copied().collect()).collect()
}

/// Columns of a matrix, contiguous.
pub(crate) fn columns_of(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    matrix.column_iter().map(|column| column.iter().copied().collect()).collect()
}
