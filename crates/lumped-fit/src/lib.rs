//! Fits the physical parameters of lumped models to a crash record and says how well they are determined.
//!
//! - From the events of a crash (`t_m`, `C`, restitution): Kelvin and elastoplastic model, by closed forms.
//! - From the displacement, velocity or acceleration of one or several sensors: every model, by bounded least squares
//!   or L-SHADE; the nonlinear models also as their papers do, by an interior point and by a firefly search; chains
//!   of any number of masses as stated.
//! - From an identified transfer function, state space, set of modes or sum of exponentials: the double model by
//!   coefficient matching (every solution), the Maxwell model from three exponents, and the curve fit of the ERA
//!   paper for reproduction.
//!
//! Every candidate says how it was found and what was assumed, how well its parameters are determined (covariance,
//! profile, bootstrap, propagation of uncertain inputs), and which other candidate gives the same record. Where a
//! model has no solution the notes say why: that is an answer, not an error.
//!
//! A solver makes starts: closed forms, a momentum balance, or a search on the motion itself. One fit follows them:
//! [`fit_as_measured`] descends to the minimum of the misfit seen through the measurement of the record (sampling,
//! filter, integration; where that is not known, on the motion itself), and the candidate is made from that minimum.
//! [`assess`] works there too.
//!
//! [`choose`] names the candidate for prediction, the simplest and the closest: evidence as measured, and what is known
//! of vehicles as terms of its own.
//!
//! The library knows no files, no command line and no clock; the same input gives the same bits on any number of
//! threads.
//!
//!
//! Sources: single-mass paper, sections 3.1 and 3.2; M. Huang, *Vehicle Crash Mechanics*, 2002, for the Kelvin model;
//! transfer-function paper for coefficient matching; ERA paper for the curve fit; nonlinear paper for the two
//! nonlinear models; each function names its own.

mod candidate;
mod chain;
mod closed_form;
mod error;
mod extraction;
mod fit;
mod free;
mod joint;
mod matching;
mod papers;
mod record;
mod selection;
mod solvers;
mod uncertainty;

pub use candidate::Minimum;
pub use candidate::{Candidate, Fit, Uncertainty, bounds_remark};
pub use candidate::{METHODS, Method};
pub use candidate::{all_in_words, in_words};
pub use chain::assessment::{ChainAssessment, ChainAssessmentOptions, assess_chain};
pub use chain::coordinates::{Stated, StatedChain, StatedElement, StatedMass};
pub use chain::dual::ChainDual;
pub use chain::fit::{ChainSolution, fit_chain};
pub use closed_form::{KelvinBranch, KelvinSolution, centroid_to_crush_time_ratio, kelvin_from_events};
pub use closed_form::{MaxwellExponents, maxwell_constants, maxwell_from_exponents};
pub use closed_form::{elastoplastic_from_events, unloads_rigidly};
pub use crumple_numerics::estimation::minimise::StopReason;
pub use crumple_numerics::estimation::minimise::l_shade::LShadeOptions;
pub use crumple_numerics::estimation::statistics::{Covariance, covariance};
pub use crumple_signal::Distribution;
pub use error::SolveError;
pub use extraction::extract::{extract, hats};
pub use extraction::joint_rate::{RatePrior, extract_with_rate};
pub use extraction::problem::{
    AskedCurve, Extraction, MeasuredElement, MeasuredMass, MeasuredTest, MeasuredThrough, MeasuredWall,
};
pub use fit::as_measured::fit_as_measured;
pub use fit::at_crush::conditions_at_crush;
pub use fit::nonlinear::fit_nonlinear1;
pub use fit::nonlinear::search_nonlinear2;
pub use fit::options::SingleMassFitOptions;
pub use free::free_parameter::{FreeParameter, free_masses, free_parameters, mass_of};
pub use free::mass_split::{MassEvidence, MassSplit, masses, triple_masses};
pub use free::search_coordinates::MassFit;
pub use joint::{JointTest, deepest_crush, fit_together};
pub use joint::{RateFactorSource, rate_factor_source};
pub use matching::CoefficientSpread;
pub use matching::{Identified, Matched, Quartic, match_identified};
pub use papers::curve_fit_of_the_paper;
pub use papers::interior_point_nonlinear1;
pub use papers::match_as_the_paper_typed;
pub use papers::maxwell_from_sum;
pub use papers::{FireflyOptions, FireflyResult, FireflyUnits, firefly_nonlinear2};
pub use papers::{front_from_amplitudes, rear_from_amplitudes};
pub use record::fit_quantity::FitQuantity;
pub use record::measurement::MeasureModel;
pub use record::observation::{Impact, Observation, ObservedWave, RESOLUTION_M, UNKNOWN_FILTER_M};
pub use record::sensor::{Sensor, SensorFit, SensorPlace, errors_in_words, note_of_errors};
pub use record::test_data::TestData;
pub use record::wall_force::WallForce;
pub use selection::choice::{CandidateSelection, Choice, Strength, choose};
pub use selection::compared_candidate::{ComparedCandidate, EnergyClass, OwnTestErrors, depends_on_rate};
pub use selection::evidence::slow_misfit;
pub use selection::inadequacy::{Inadequacy, TestEvent};
pub use selection::lower_speeds::crush_error_at_lower_speeds;
pub use selection::prior::{Prior, SelectionRules};
pub use selection::rating::{ComparedRecord, ComparedWave, Rated};
pub use selection::time_zero::{least_without_shift, without_shift};
pub use solvers::crush_curves::assumptions::{ONE_MASS_RATE_S_PER_M, RATE_PRIOR_S_PER_M};
pub use solvers::settings::{FRONT_MASS_FRACTION, SolveSettings};
pub use solvers::solve::solve;
pub use solvers::table::{DEFAULT_MODELS, MODELS, Solver, solvers_of};
pub use solvers::task::Needs;
pub use uncertainty::assessment::{Assessment, AssessmentOptions, Intervals, assess, undetermined};
pub use uncertainty::block_bootstrap::BlockBootstrap;
pub use uncertainty::closed_form_propagation::{FollowedEvents, propagate_closed_form};
pub use uncertainty::conditioned_propagation::propagate_conditioned;
pub use uncertainty::least_misfit::LeastMisfit;
pub use uncertainty::likelihood::profile_likelihood::Profile;
pub use uncertainty::mass_division::mixture::widen_by_mass_split;
pub use uncertainty::propagation::{
    InputUncertainty, Propagation, REPETITIONS, Repetition, largest_draw, perturbed, propagate, repeat, repetition,
};

pub use crumple_signal::{IntegrationRule, Measurement, TwoPassFilter};
