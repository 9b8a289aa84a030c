//! The elements: springs and dampers with knots, both in series, an elastoplastic spring, force-deflection curves.

pub mod crush_curve;
pub mod force_deflection;
pub mod in_series;
pub mod piecewise_linear;
pub mod plastic_spring;
pub mod secant;
pub mod series_spring_damper;
pub mod trend;
