//! Lumped-parameter crash models and their exact responses.
//!
//! A model is one or more masses with springs and dampers that meet a rigid barrier at `t = 0` with `x = 0` and
//! `v = v0`. Displacement `x` is crush, positive towards the barrier, and `x'' = a` is negative while the vehicle
//! is stopped (SAE J211). Every response here is exact: a closed form or a matrix exponential, never a step-by-step
//! integration with a step error. What remains is rounding, about `1e-16` a step relative to the largest motion.
//!
//! - [`Kelvin`]: spring and damper in parallel.
//! - [`Elastoplastic`]: stiff unloading about a permanent set.
//! - [`Maxwell`]: spring and damper in series.
//! - [`Nonlinear1`], [`Nonlinear2`]: secant spring and damper with piecewise-linear coefficients, by Taylor series from
//!   knot to knot.
//! - [`DoubleSpringMassDamper`]: chassis and passenger compartment, two of each.
//! - [`TripleSpringMassDamper`] and [`Chain`]: three and any number of masses; impact, input force or base motion.
//! - [`SecantChain`]: the same with piecewise-linear coefficients in every spring and damper.
//!
//! Contact stays closed in all of them (the mass is tied to the barrier) except where `release` is set. So a linear
//! model describes the loading phase of a crash; what it does after rebound is not a prediction.

mod chain;
mod chain_motion;
mod chain_parameters;
mod coefficient_matching;
mod crossing;
mod cubic;
mod curve;
mod double_double;
mod double_spring_mass_damper;
mod driven;
mod dynamics;
mod elastoplastic;
mod elastoplastic_motion;
mod elastoplastic_sensitivity;
mod error;
mod exact_step;
mod falling_zero;
mod kelvin;
mod kind;
mod linear_motion;
mod many;
mod maxwell;
mod model;
mod motion;
mod nonlinear;
mod parameters;
mod physical_coordinates;
mod piecewise_linear;
mod secant_chain;
mod secant_motion;
mod secant_sensitivity;
mod secant_step;
mod second_order;
mod sensitivity;
mod stumpff;

pub use chain::{Chain, ChainResponse, TripleSpringMassDamper};
pub use coefficient_matching::{
    Certificate, CoefficientMatch, CoefficientMatching, MatchRoot, MatchedSolution, Reading, matching_sensitivity,
};
pub use crumple_lti::Complex;
pub use double_spring_mass_damper::DoubleSpringMassDamper;
pub use driven::Drive;
pub use dynamics::{Dynamics, ElementForce, Energy};
pub use elastoplastic::Elastoplastic;
pub use error::LumpedError;
pub use exact_step::{ExactStep, exact_step, exact_step_with_derivatives};
pub use kelvin::Kelvin;
pub use kind::ModelKind;
pub use many::compartment_displacements;
pub use maxwell::Maxwell;
pub use model::Model;
pub use motion::{CrushEvents, Motion, Response, State};
pub use nonlinear::{Nonlinear1, Nonlinear2};
pub use physical_coordinates::{PhysicalCoordinates, RealisedModel};
pub use piecewise_linear::PiecewiseLinear;
pub use secant_chain::SecantChain;
pub use sensitivity::{Instants, Sensitivity};
