//! Methods as papers print them, for reproduction and comparison.

pub mod era_amplitude_ratios;
pub mod era_curve_fit;
pub mod firefly;
pub mod maxwell_sum;
pub mod nonlinear1_interior_point;
pub mod tfest;
