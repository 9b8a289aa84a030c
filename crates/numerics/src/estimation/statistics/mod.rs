//! Statistics of residuals and estimates: autocorrelation, covariance, information criteria, quantiles.

mod autocorrelated_covariance;
mod autocorrelation;
mod distributions;
mod information_criteria;
mod quantile;
mod residual_tests;
mod standard_deviation;

pub use autocorrelated_covariance::{Block, Covariance, SensorError, covariance, covariance_of_blocks};
pub use autocorrelation::{
    autocovariance, autoregressive_effective_samples, effective_samples, first_zero_lag, geyer_autocorrelation_time,
    lag_1_autocorrelation, sokal_autocorrelation_time,
};
pub use distributions::{chi_square_95, normal_distribution, shortest_with, student_95};
pub use information_criteria::InformationCriteria;
pub use quantile::quantile;
pub use residual_tests::{ResidualTests, residual_tests};
pub use standard_deviation::standard_deviation;
