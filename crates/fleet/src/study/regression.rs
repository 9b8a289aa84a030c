//! Linear regression with exact intervals.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Share of cases that an interval holds.
const LEVEL: f64 = 0.95;
/// A column that the others explain but for this share of it says nothing of its own.
const LEAST_OWN_SHARE: f64 = 1e-10;

/// A quantity that may explain another.
#[derive(Debug, Clone)]
pub(crate) struct Regressor {
    /// What its coefficient is called, e.g. `per kg of mass`.
    pub(crate) name: String,
    /// Its value for each case.
    pub(crate) values: Vec<f64>,
}

/// A fitted coefficient.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Coefficient {
    /// What it multiplies.
    pub(crate) name: String,
    /// Estimate.
    pub(crate) value: f64,
    /// Standard deviation of the estimate.
    pub(crate) standard_deviation: f64,
    /// Lower end of the 95 % interval.
    pub(crate) low: f64,
    /// Upper end.
    pub(crate) high: f64,
}

/// A regression.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Regression {
    /// The intercept, which is the value at the means of all regressors, then a coefficient for each.
    pub(crate) coefficients: Vec<Coefficient>,
    /// Cases.
    pub(crate) cases: usize,
    /// Cases less coefficients.
    pub(crate) degrees_of_freedom: usize,
    /// Standard deviation of the residuals.
    pub(crate) residual_standard_deviation: f64,
    /// Share of the variance that is explained.
    pub(crate) r_squared: f64,
}

/// Least squares of `values` over the regressors, each less its mean. Intervals are those of independent normal
/// residuals of one variance: the estimate and Student's quantile times its standard deviation. `None`: no degree of
/// freedom is left, or a regressor is a combination of the others.
pub(crate) fn regression(values: &[f64], regressors: &[Regressor]) -> Option<Regression> {
    let (cases, count) = (values.len(), regressors.len() + 1);
    let degrees_of_freedom = cases.checked_sub(count).filter(|degrees| *degrees > 0)?;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let centred: Vec<Vec<f64>> = regressors
        .iter()
        .map(|regressor| {
            let mean = mean(&regressor.values);
            regressor.values.iter().map(|value| value - mean).collect()
        })
        .collect();
    // Columns of length 1: the conditioning is that of the regressors, not of their units.
    let lengths: Vec<f64> = centred.iter().map(|column| column.iter().map(|x| x * x).sum::<f64>().sqrt()).collect();
    if lengths.iter().any(|length| *length <= 0.0) {
        return None;
    }
    let scaled = DMatrix::from_fn(cases, regressors.len(), |row, column| centred[column][row] / lengths[column]);
    let inverse = match regressors.is_empty() {
        true => DMatrix::zeros(0, 0),
        false => (scaled.transpose() * &scaled).cholesky()?.inverse(),
    };
    if (0..regressors.len()).any(|column| 1.0 / inverse[(column, column)] < LEAST_OWN_SHARE) {
        return None;
    }
    let level = mean(values);
    let about_mean = DVector::from_iterator(cases, values.iter().map(|value| value - level));
    let slopes = &inverse * (scaled.transpose() * &about_mean);
    let residuals = &about_mean - &scaled * &slopes;
    let variance = residuals.norm_squared() / degrees_of_freedom as f64;
    let student = StudentsT::new(0.0, 1.0, degrees_of_freedom as f64).ok()?.inverse_cdf(0.5 + 0.5 * LEVEL);
    let coefficient = |name: &str, value: f64, standard_deviation: f64| Coefficient {
        name: name.to_owned(),
        value,
        standard_deviation,
        low: value - student * standard_deviation,
        high: value + student * standard_deviation,
    };
    let mut coefficients = vec![coefficient("at the means", level, (variance / cases as f64).sqrt())];
    coefficients.extend(regressors.iter().enumerate().map(|(number, regressor)| {
        let deviation = (variance * inverse[(number, number)]).sqrt() / lengths[number];
        coefficient(&regressor.name, slopes[number] / lengths[number], deviation)
    }));
    let total = about_mean.norm_squared();
    let r_squared = if total > 0.0 { 1.0 - residuals.norm_squared() / total } else { 0.0 };
    Some(Regression {
        coefficients,
        cases,
        degrees_of_freedom,
        residual_standard_deviation: variance.sqrt(),
        r_squared,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn regressor(name: &str, values: &[f64]) -> Regressor {
        Regressor { name: name.to_owned(), values: values.to_vec() }
    }

    /// Norris of the NIST Statistical Reference Datasets, certified to 15 digits.
    #[test]
    fn norris_of_nist_comes_out() {
        let data = [
            (0.1, 0.2),
            (338.8, 337.4),
            (118.1, 118.2),
            (888.0, 884.6),
            (9.2, 10.1),
            (228.1, 226.5),
            (668.5, 666.3),
            (998.5, 996.3),
            (449.1, 448.6),
            (778.9, 777.0),
            (559.2, 558.2),
            (0.3, 0.4),
            (0.1, 0.6),
            (778.1, 775.5),
            (668.8, 666.9),
            (339.3, 338.0),
            (448.9, 447.5),
            (10.8, 11.6),
            (557.7, 556.0),
            (228.3, 228.1),
            (998.0, 995.8),
            (888.8, 887.6),
            (119.6, 120.2),
            (0.3, 0.3),
            (0.6, 0.3),
            (557.6, 556.8),
            (339.3, 339.1),
            (888.0, 887.2),
            (998.5, 999.0),
            (778.9, 779.0),
            (10.2, 11.1),
            (117.6, 118.3),
            (228.9, 229.2),
            (668.4, 669.1),
            (449.2, 448.9),
            (0.2, 0.5),
        ];
        let y: Vec<f64> = data.iter().map(|(y, _)| *y).collect();
        let x: Vec<f64> = data.iter().map(|(_, x)| *x).collect();
        let found = regression(&y, &[regressor("x", &x)]).unwrap();
        let slope = &found.coefficients[1];
        // The certified values to the digits that sums of 36 terms of size 1e3 leave.
        assert!((slope.value - 1.002_116_818_020_45).abs() < 1e-12, "{}", slope.value);
        assert!((slope.standard_deviation - 0.429_796_848_199_937e-3).abs() < 1e-14, "{}", slope.standard_deviation);
        assert!((found.residual_standard_deviation - 0.884_796_396_144_373).abs() < 1e-11);
        assert!((found.r_squared - 0.999_993_745_883_712).abs() < 1e-13);
        // Student's quantile of 34 degrees of freedom, from printed tables: 2.0322.
        assert!(((slope.high - slope.value) / slope.standard_deviation - 2.032_245).abs() < 1e-5);
    }

    #[test]
    fn what_cannot_be_told_apart_has_no_answer() {
        let x = [1.0, 2.0, 3.0, 5.0];
        let twice = x.map(|x| 2.0 * x + 1.0);
        let y = [1.0, 2.0, 2.5, 7.0];
        assert!(regression(&y, &[regressor("x", &x), regressor("2x", &twice)]).is_none());
        assert!(regression(&y, &[regressor("1", &[1.0; 4])]).is_none());
        assert!(regression(&y[..2], &[regressor("x", &x[..2])]).is_none());
    }
}
