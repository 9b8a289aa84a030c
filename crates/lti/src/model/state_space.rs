//! State-space models.

use nalgebra::DMatrix;

use crate::matrix::checks::check_finite;
use crate::{Complex, LtiError, eigenvalues};

/// `x' = a x + b u`, `y = c x + d u`, or with `x[k+1]` on the left for a sampled model.
///
/// Built by [`StateSpace::new`]: shapes agree and every entry is finite.
#[derive(Debug, Clone, PartialEq)]
pub struct StateSpace {
    /// State matrix, n x n.
    pub a: DMatrix<f64>,
    /// Input matrix, n x inputs.
    pub b: DMatrix<f64>,
    /// Output matrix, outputs x n.
    pub c: DMatrix<f64>,
    /// Direct term, outputs x inputs.
    pub d: DMatrix<f64>,
    /// Sampling interval, s; `None`: continuous time.
    pub sample_time_s: Option<f64>,
}

impl StateSpace {
    /// Checks shapes and values. Errors: [`LtiError::Shape`], [`LtiError::NotFinite`], [`LtiError::SampleTime`].
    pub fn new(
        a: DMatrix<f64>,
        b: DMatrix<f64>,
        c: DMatrix<f64>,
        d: DMatrix<f64>,
        sample_time_s: Option<f64>,
    ) -> Result<Self, LtiError> {
        let (n, inputs, outputs) = (a.nrows(), b.ncols(), c.nrows());
        for (what, matrix, (rows, columns)) in
            [("a", &a, (n, n)), ("b", &b, (n, inputs)), ("c", &c, (outputs, n)), ("d", &d, (outputs, inputs))]
        {
            if matrix.shape() != (rows, columns) {
                return Err(LtiError::Shape {
                    what,
                    rows: matrix.nrows(),
                    columns: matrix.ncols(),
                    expected: format!("{rows} x {columns}"),
                });
            }
            check_finite(what, matrix)?;
        }
        if let Some(dt) = sample_time_s {
            check_sample_time(dt)?;
        }
        Ok(Self { a, b, c, d, sample_time_s })
    }

    /// Number of states.
    pub fn order(&self) -> usize {
        self.a.nrows()
    }

    /// Eigenvalues of `a`, in the order of [`eigenvalues`]: s-plane for a continuous model (1/s,
    /// rad/s), z-plane for a sampled one. Errors: [`LtiError::NotConverged`].
    pub fn poles(&self) -> Result<Vec<Complex>, LtiError> {
        eigenvalues(&self.a)
    }

    /// The sampling interval, s. Errors: [`LtiError::TimeDomain`] for a continuous model.
    pub fn require_discrete(&self) -> Result<f64, LtiError> {
        self.sample_time_s.ok_or(LtiError::TimeDomain { found: "continuous", needed: "a discrete one" })
    }

    /// Errors with [`LtiError::TimeDomain`] for a sampled model.
    pub fn require_continuous(&self) -> Result<(), LtiError> {
        match self.sample_time_s {
            None => Ok(()),
            Some(_) => Err(LtiError::TimeDomain { found: "discrete", needed: "a continuous one" }),
        }
    }

    /// Errors with [`LtiError::NotSingle`] unless there is one input and one output.
    pub fn require_single(&self) -> Result<(), LtiError> {
        match (self.b.ncols(), self.c.nrows()) {
            (1, 1) => Ok(()),
            (inputs, outputs) => Err(LtiError::NotSingle { inputs, outputs }),
        }
    }
}

/// Errors unless the interval is a positive number.
pub(crate) fn check_sample_time(dt_s: f64) -> Result<(), LtiError> {
    if dt_s.is_finite() && dt_s > 0.0 { Ok(()) } else { Err(LtiError::SampleTime(dt_s)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;

    #[test]
    fn names_the_matrix_that_does_not_fit() {
        let error = StateSpace::new(DMatrix::identity(2, 2), dmatrix![1.0], dmatrix![1.0, 0.0], dmatrix![0.0], None)
            .unwrap_err();
        assert_eq!(error.to_string(), "b is 1 x 1, expected 2 x 1");
    }

    #[test]
    fn refuses_a_nan_and_a_zero_interval() {
        let unit = dmatrix![1.0];
        let nan = StateSpace::new(dmatrix![f64::NAN], unit.clone(), unit.clone(), unit.clone(), None).unwrap_err();
        assert_eq!(nan.to_string(), "a holds a value that is not finite");
        let zero = StateSpace::new(unit.clone(), unit.clone(), unit.clone(), unit, Some(0.0)).unwrap_err();
        assert_eq!(zero, LtiError::SampleTime(0.0));
    }
}
