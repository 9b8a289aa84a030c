//! Solves for the physical parameters of lumped models.
//!
//! From the events of a crash (`t_m`, `C`, restitution) by closed forms, and from the compartment's displacement by
//! a bounded least-squares fit of the double spring-mass-damper. Every candidate says how it was found, what was
//! assumed, how well its parameters are determined and which other candidate gives the same record. Where a model
//! has no solution the notes say why: that is an answer, not an error.
//!
//! Sources: single-mass paper, sections 3.1 and 3.2; M. Huang, *Vehicle Crash Mechanics*, 2002, for the Kelvin model.

mod amplitude_ratios;
mod candidate;
mod correlation;
mod curve_fit;
mod double_fit;
mod double_residuals;
mod elastoplastic;
mod error;
mod firefly;
mod kelvin;
mod least_squares;
mod levenberg_marquardt;
mod matching;
mod maxwell;
mod maxwell_fit;
mod method;
mod nonlinear_fit;
mod nonnegative;
mod search;
mod solve;
mod starts;
mod window;

pub use amplitude_ratios::{front_from_amplitudes, rear_from_amplitudes};
pub use candidate::{Candidate, Fit, Uncertainty};
pub use curve_fit::curve_fit_of_the_paper;
pub use double_fit::{DoubleFit, DoubleFitOptions, fit_double};
pub use elastoplastic::elastoplastic_from_events;
pub use error::SolveError;
pub use firefly::{FireflyOptions, FireflyResult, FireflyUnits, firefly_nonlinear2};
pub use kelvin::{KelvinBranch, KelvinSolution, centroid_to_crush_time_ratio, kelvin_from_events};
pub use levenberg_marquardt::StopReason;
pub use matching::{Identified, Matched, Quartic, match_identified};
pub use maxwell::{MaxwellExponents, maxwell_constants, maxwell_from_exponents};
pub use maxwell_fit::{fit_maxwell, undetermined_by_the_record};
pub use method::{DEFAULT_METHODS, DEFAULT_MODELS, METHODS, MODELS, Method};
pub use nonlinear_fit::{NonlinearFitOptions, fit_nonlinear1, fit_nonlinear2};
pub use solve::{Evidence, MassSplit, SolveSettings, masses, solve};
