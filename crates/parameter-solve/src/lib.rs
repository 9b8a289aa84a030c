//! Solves for the physical parameters of lumped models.
//!
//! From the events of a crash (`t_m`, `C`, restitution) by closed forms; from the displacement, velocity or acceleration of one
//! or several sensors by bounded least squares of every model, the first nonlinear one also by an interior point, the second
//! also by firefly, all by L-SHADE; from an identified transfer function, state space or set of modes by coefficient matching;
//! from four exponentials as the ERA paper does. Every candidate says how it was found, what was assumed, how well its
//! parameters are determined (covariance, profile, bootstrap, propagation) and which other candidate gives the same record.
//! Where a model has no solution the notes say why: that is an answer, not an error.
//!
//! Sources: single-mass paper, sections 3.1 and 3.2; M. Huang, *Vehicle Crash Mechanics*, 2002, for the Kelvin model; transfer
//! function paper for coefficient matching; ERA paper for the curve fit; nonlinear paper for the two nonlinear models; each
//! function names its own.

mod amplitude_ratios;
mod bootstrap;
mod candidate;
mod chain_dual;
mod chain_fit;
mod chain_judge;
mod chain_knowledge;
mod chain_problem;
mod closed_form_fit;
mod closed_form_propagation;
mod coefficient_spread;
mod conditioned_propagation;
mod curve_fit;
mod double_fit;
mod double_residuals;
mod dual_scale;
mod elastoplastic;
mod error;
mod evidence;
mod family;
mod firefly;
mod free_chain;
mod free_model;
mod identifiability;
mod interior_nonlinear1;
mod judge;
mod kelvin;
mod linearised;
mod mass_split;
mod matching;
mod maxwell;
mod maxwell_fit;
mod maxwell_sum;
mod measurement;
mod method;
mod momentum;
mod nonlinear_fit;
mod nonlinear_problem;
mod observed;
mod parameter_words;
mod profile;
mod propagation;
mod quantity;
mod random_starts;
mod refine;
mod search;
mod sensor;
mod sensor_fit;
mod sensor_problem;
mod settings;
mod solve;
mod solver;
mod solvers;
mod starts;
mod tfest_paper;
mod weighing;
mod window;

pub use amplitude_ratios::{front_from_amplitudes, rear_from_amplitudes};
pub use bootstrap::{Bootstrap, REPLICATES, bootstrap};
pub use candidate::{Candidate, Fit, Uncertainty, bounds_remark};
pub use chain_dual::ChainDual;
pub use chain_fit::{ChainSolution, fit_chain};
pub use chain_judge::{ChainQuestions, ChainVerdict, judge_chain};
pub use chain_knowledge::ChainKnowledge;
pub use closed_form_propagation::{FollowedEvents, propagate_closed_form};
pub use coefficient_spread::CoefficientSpread;
pub use conditioned_propagation::propagate_conditioned;
pub use crumple_estimation::minimise::StopReason;
pub use crumple_estimation::minimise::l_shade::LShadeOptions;
pub use crumple_estimation::statistics::{Covariance, covariance};
pub use crumple_signal::Distribution;
pub use curve_fit::curve_fit_of_the_paper;
pub use double_fit::{DoubleFit, DoubleFitOptions, fit_double};
pub use dual_scale::DualScale;
pub use elastoplastic::{
    RIGID_RESTITUTION, elastoplastic_from_events, elastoplastic_of_record, fit_elastoplastic_loading, unloads_rigidly,
};
pub use error::SolveError;
pub use evidence::Evidence;
pub use family::{MassFit, largest_of_chain};
pub use firefly::{FireflyOptions, FireflyResult, FireflyUnits, firefly_nonlinear2};
pub use free_chain::{Stated, StatedChain, StatedElement, StatedMass};
pub use identifiability::weakest_direction;
pub use interior_nonlinear1::interior_point_nonlinear1;
pub use judge::{Intervals, JudgeOptions, Judgement, judge, undetermined};
pub use kelvin::{KelvinBranch, KelvinSolution, centroid_to_crush_time_ratio, kelvin_from_events};
pub use mass_split::{MassSplit, masses, triple_masses};
pub use matching::{Identified, Matched, Quartic, match_identified};
pub use maxwell::{MaxwellExponents, maxwell_constants, maxwell_from_exponents};
pub use maxwell_fit::{fit_maxwell, undetermined_by_the_record};
pub use maxwell_sum::maxwell_from_sum;
pub use measurement::{IntegrationRule, Measurement, TwoPassFilter};
pub use method::{METHODS, Method};
pub use nonlinear_fit::{NonlinearFitOptions, fit_nonlinear1, fit_nonlinear2};
pub use nonlinear_problem::conditions_at_crush;
pub use observed::{FreeParameter, Observed, RESOLUTION_M, SeenWave, free_masses, free_parameters};
pub use parameter_words::{all_in_words, in_words};
pub use profile::{Profile, RISE_95, profile};
pub use propagation::{
    InputUncertainty, Propagation, REPETITIONS, Repetition, largest_draw, perturbed, propagate, propagate_unfiltered,
    repeat, repetition,
};
pub use quantity::FitQuantity;
pub use random_starts::random_start_nonlinear2;
pub use refine::{Refined, refine};
pub use sensor::{Place, Sensor, SensorFit, errors_in_words, errors_remark, is_errors_remark};
pub use settings::SolveSettings;
pub use solve::solve;
pub use solver::{DEFAULT_MODELS, MODELS, Needs, SOLVERS, Solver, solvers_of};
pub use tfest_paper::match_as_the_paper_typed;
