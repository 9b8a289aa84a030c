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
//! [`Minimum::assess`] works there too.
//!
//! [`evaluate`] compares a model with its [`MeasuredTest`], once for all who ask. [`Comparison::solution`] names the
//! candidate for prediction, the simplest and the closest: evidence as measured, and what is known of vehicles as terms
//! of its own.
//!
//! ```
//! use crumple_lumped::Kelvin;
//! use crumple_lumped_fit::kelvin_from_events;
//!
//! let car = Kelvin { mass_kg: 1200.0, stiffness_n_per_m: 4e5, damping_n_s_per_m: 6e3 };
//! let events = car.events(14.0);
//! let (time_s, crush_m) = events.time_of_dynamic_crush_s.zip(events.dynamic_crush_m).ok_or("it stops")?;
//! let fitted = kelvin_from_events(1200.0, 14.0, time_s, crush_m)?.model;
//! assert!((fitted.stiffness_n_per_m / 4e5 - 1.0).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The library knows no files, no command line and no clock; the same input gives the same bits on any number of
//! threads.
//!
//! Sources: single-mass paper, sections 3.1 and 3.2; M. Huang, *Vehicle Crash Mechanics*, 2002, for the Kelvin model;
//! transfer-function paper for coefficient matching; ERA paper for the curve fit; nonlinear paper for the two
//! nonlinear models; each function names its own.

mod candidate;
mod chain;
mod closed_form;
mod comparison;
mod coordinates;
mod error;
mod evaluation;
mod extraction {
    //! Force-deflection curves and masses read off measured motions: a bounded linear least squares problem.

    pub mod extract;
    pub mod problem;
}
mod fit {
    //! Models fitted to records by bounded least squares: searches on the motion itself, and the one fit as measured.

    pub mod as_measured;
    pub mod nonlinear;
    pub mod problem;
    pub mod search;
}
mod joint;
mod matching;
mod own_model;
mod papers;
mod parameters;
mod record {
    //! What is known of a test: its events, its waves, how they were measured, where they are compared.

    pub mod measured_motion;
    pub mod observation;
    pub mod sensor;
    pub mod sensor_noise;
}
mod selection {
    //! Which candidate to use: evidence as measured, prior knowledge of vehicles, and the choice with its reasons.

    pub mod choice;
    pub mod compared;
    pub mod evidence;
    pub mod other_speeds;
    pub mod rating;
}
mod solvers {
    //! The table of solvers, the functions of its rows, and the call that runs all that settings ask for.

    pub mod closed_forms;
    pub mod fitting;
    pub mod load_paths;
    pub mod sensors;
    pub mod single_mass;
    pub mod table;
}
mod uncertainty {
    //! How well fitted parameters are determined: covariance, intervals, profiles, bootstrap, propagation of uncertain
    //! inputs.

    pub mod acceleration_likelihood;
    pub mod assessment;
    pub mod curve_posterior;
    pub mod mass_division;
    pub mod propagation;
    pub mod transfer_posterior;
    pub mod uncertain_inputs;
}

pub use candidate::{
    Assessed, Assessment, BlockBootstrap, Candidate, Fit, Method, Minimum, Profile, Propagation, Uncertainty,
};
pub use chain::{Stated, StatedChain, StatedElement, StatedMass};
pub use closed_form::{
    KelvinBranch, MaxwellExponents, centroid_to_crush_time_ratio, elastoplastic_from_events, kelvin_from_events,
};
pub use comparison::{Comparison, EvaluatedCandidate, KnownNumbers, Solution};
pub use coordinates::MassFit;
pub use crumple_signal::Measurement;
pub use error::SolveError;
pub use evaluation::{Evaluation, Measured, MeasuredTest, evaluate};
pub use extraction::extract::extract;
pub use extraction::problem::{AskedCurve, Extraction, ExtractionTest, MeasuredElement, MeasuredMass};
pub use fit::as_measured::fit_as_measured;
pub use fit::problem::SingleMassFitOptions;
pub use joint::{JointTest, REMARKS as JOINT_REMARKS, RateFactorSource, fit_together};
pub use matching::{CoefficientSpread, Identified, MassDivisions, Matched, Quartic, REMARKS as MATCHING_REMARKS};
pub use own_model::fit_own_model;
pub use papers::{
    FireflyOptions, FireflyUnits, curve_fit_of_the_paper, front_from_amplitudes, match_as_the_paper_typed,
    maxwell_from_sum, rear_from_amplitudes,
};
pub use parameters::{MassSplit, free_parameters};
pub use record::measured_motion::MeasureModel;
pub use record::observation::{Impact, Observation, ObservedWave};
pub use record::sensor::{FitQuantity, Sensor, SensorFit, SensorPlace, TestData, WallForce};
pub use selection::choice::{Choice, Strength};
pub use selection::compared::{ComparedCandidate, EnergyClass, SelectionRules, depends_on_rate};
pub use selection::rating::Rated;
pub use solvers::closed_forms::{ONE_MASS_RATE_S_PER_M, RATE_PRIOR_S_PER_M, REMARKS as CLOSED_FORM_REMARKS};
pub use solvers::fitting::REMARKS as PLACE_REMARKS;
pub use solvers::load_paths::REMARKS as LOAD_PATH_REMARKS;
pub use solvers::sensors::{MassesTaken, REMARKS as SENSOR_REMARKS};
pub use solvers::single_mass::REMARKS as SINGLE_MASS_REMARKS;
pub use solvers::table::{REMARKS as SOLVE_REMARKS, SolveSettings, solve};
pub use uncertainty::assessment::AssessmentOptions;
pub use uncertainty::propagation::{FollowedEvents, InputUncertainty, Repetition, propagate};
pub use uncertainty::uncertain_inputs::{TIME_ZERO_S, WithInputs};
