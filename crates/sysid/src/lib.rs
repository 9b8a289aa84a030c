//! System identification: linear models from records, with the evidence for them.
//!
//! Free motion, from one channel or several: [`era`] and [`era_dc`] realise a state space from Markov parameters,
//! [`exponential_sum`] fits a sum of exponentials. From inputs and outputs ([`IoData`]): [`Subspace`] (N4SID, MOESP,
//! CVA), [`arx`] and [`vector_arx`], [`Okid`], [`fir`], [`output_error`], and [`transfer_function_fit`] and
//! [`transfer_function_array`] for continuous models. What speaks for a model: [`stabilization`] over orders,
//! [`bootstrap`], [`compare`] and [`continued`] on other samples, [`select`] among several, [`caveats`] in words.
//!
//! Functions of numbers only: no file, clock, environment or terminal. The same record and options give the same model
//! on any number of threads; random starts and draws are seeded. Signals are slices of `f64` in any unit, sampled
//! together at `sample_time_s` seconds; poles of continuous models are in 1/s and rad/s.

mod arx;
mod data;
mod era;
mod error;
mod exponentials;
mod fir;
mod hankel;
mod modes;
mod okid;
mod order;
mod output_error;
mod poles;
mod regression;
mod simulation;
mod subspace;
mod transfer_function;
mod validation;

pub use arx::arx::{Arx, ArxOrder, arx, arx_scan};
pub use arx::vector_arx::{VectorArx, vector_arx};
pub use data::decimation::{automatic_thinning, thinned};
pub use data::free_decay::end_of_contact;
pub use data::hold::Hold;
pub use data::io_data::IoData;
pub use data::markov_parameters::{MarkovParameters, markov_parameters};
pub use era::era::{Era, EraOptions, Order, era};
pub use era::era_dc::{EraDc, EraDcOptions, era_dc};
pub use era::realization::Realization;
pub use era::shift_form::ShiftForm;
pub use error::era::EraError;
pub use error::identify::{IdentifyError, MissReason};
pub use exponentials::exponential_sum::{ExponentialSumFit, exponential_sum};
pub use exponentials::options::ExponentialOptions;
pub use exponentials::terms::ExponentialTerm;
pub use fir::fir::{Fir, FirOptions, Hyperparameters, fir};
pub use fir::kernel::Kernel;
pub use hankel::singular_value_gap::GapOrder;
pub use hankel::svd::Decomposition;
pub use modes::identified_mode::{IdentifiedMode, mode_shapes};
pub use modes::mode_deviations::response_deviations;
pub use modes::mode_shape::{modal_assurance, phase_collinearity};
pub use modes::pole_kind::{PoleKind, PoleRecord, pole_kinds};
pub use okid::observer_regression::Criterion;
pub use okid::okid::{Lags, Okid, OkidModel, OkidOptions, OkidRealization};
pub use order::order_scan::{era_order_scan, era_order_scan_of, subspace_order_scan};
pub use order::stabilization::{
    DiagramPole, OrderPoles, PoleCluster, Quartiles, Stability, StabilizationDiagram, StabilizationOptions,
    stabilization,
};
pub use output_error::options::OutputErrorOptions;
pub use output_error::output_error::{OutputError, output_error};
pub use poles::options::{InitialConditions, TransferFunctionOptions};
pub use poles::search_outcome::SearchOutcome;
pub use poles::starts::Start;
pub use simulation::continuation::{continued, sampled};
pub use simulation::fit::{FitMeasures, compare, fit_measures, simulate_fitted};
pub use simulation::mirrored_poles::mirrored_poles;
pub use subspace::horizon::{Horizons, horizons};
pub use subspace::subspace::{Subspace, SubspaceModel, SubspaceOptions};
pub use subspace::weighting::Weighting;
pub use transfer_function::array::{TransferFunctionArray, transfer_function_array};
pub use transfer_function::fit::{TransferFunctionFit, transfer_function_fit};
pub use validation::bootstrap::{
    BandPoint, BootstrapOptions, ResidualBootstrap, Sample, Spread, bootstrap, bootstrap_equation_errors,
    bootstrap_outputs,
};
pub use validation::caveats::{FilterEdge, caveats, pole_notes, weak_fit};
pub use validation::model_selection::{Contender, Ranked, Selection, select};
pub use validation::residual_resampling::Resampling;

pub use crumple_estimation::minimise::{Stop, StopReason};
pub use crumple_estimation::statistics::{
    InformationCriteria, ResidualTests, autoregressive_effective_samples, residual_tests,
};
