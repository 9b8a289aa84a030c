//! Identifies linear models from a record.
//!
//! [`era`], the eigensystem realization algorithm, takes a record for the impulse response of a linear system and returns
//! the smallest balanced one that has it, with poles, modes and the evidence for them.

mod arx;
mod balanced_truncation;
mod bootstrap;
mod cascade_filter;
mod caveats;
mod chain_in_seconds;
mod clusters;
mod common_fit;
mod compare;
mod continuation;
mod correlations;
mod era;
mod era_dc;
mod era_error;
mod error;
mod exponential_starts;
mod exponential_sum;
mod exponential_terms;
mod factors;
mod fir_kernel;
mod free_decay;
mod golub_kahan;
mod hankel;
mod horizon;
mod initial_state;
mod input_matrices;
mod input_matrix;
mod io_data;
mod lagged_regression;
mod markov;
mod mirrored_poles;
mod modal;
mod mode_shape;
mod observer_regression;
mod okid;
mod order;
mod order_scan;
mod output_error;
mod output_error_starts;
mod pole_problem;
mod propagation;
mod realization;
mod regularised_fir;
mod residual_noise;
mod search_outcome;
mod section_chain;
mod selection;
mod shift_form;
mod shift_pair;
mod shifted_products;
mod stabilization;
mod stretches;
mod subspace;
mod thinning;
mod transfer_function_array;
mod transfer_function_fit;
mod transfer_function_options;
mod transfer_function_search;
mod transfer_starts;
mod vector_arx;
mod weighting;

pub use arx::{Arx, ArxOrder, arx, arx_scan};
pub use bootstrap::{
    BandPoint, Bootstrap, BootstrapOptions, Sample, Spread, bootstrap, bootstrap_equation_errors, bootstrap_outputs,
};
pub use caveats::{FilterEdge, caveats, mode_notes, weak_fit};
pub use clusters::{PoleCluster, Quartiles};
pub use compare::{FitMeasures, compare, fit_measures, simulate_fitted};
pub use continuation::{continued, sampled};
pub use crumple_estimation::minimise::{Stop, Termination};
pub use crumple_estimation::statistics::{
    InformationCriteria, ResidualTests, autoregressive_effective_samples, residual_tests,
};
pub use crumple_linalg::CONDITION_LIMIT;
pub use era::{Era, EraOptions, Order, era};
pub use era_dc::{EraDc, EraDcOptions, era_dc};
pub use era_error::EraError;
pub use error::IdentifyError;
pub use exponential_sum::{ExponentialOptions, ExponentialSumFit, exponential_sum};
pub use exponential_terms::ExponentialTerm;
pub use factors::Decomposition;
pub use fir_kernel::Kernel;
pub use free_decay::end_of_contact;
pub use horizon::{Horizons, horizons};
pub use io_data::IoData;
pub use markov::{MarkovParameters, markov_parameters};
pub use mirrored_poles::mirrored_poles;
pub use modal::{IdentifiedMode, mode_shapes};
pub use mode_shape::{modal_assurance, phase_collinearity};
pub use okid::{Criterion, Lags, Okid, OkidModel, OkidOptions, OkidRealization};
pub use order::{GapOrder, order_by_gap};
pub use order_scan::{era_order_scan, era_order_scan_of, subspace_order_scan};
pub use output_error::{OutputError, OutputErrorOptions, output_error};
pub use propagation::response_deviations;
pub use realization::Realization;
pub use regularised_fir::{Fir, FirOptions, Hyperparameters, fir};
pub use residual_noise::{Resampling, ResidualNoise};
pub use search_outcome::SearchOutcome;
pub use selection::{Contender, Ranked, Selection, select};
pub use shift_form::ShiftForm;
pub use stabilization::{
    DiagramPole, OrderPoles, Stability, StabilizationDiagram, StabilizationOptions, stabilization,
};
pub use subspace::{Subspace, SubspaceModel, SubspaceOptions};
pub use thinning::{automatic_thinning, thinned};
pub use transfer_function_array::{TransferFunctionArray, transfer_function_array};
pub use transfer_function_fit::{TransferFunctionFit, transfer_function_fit};
pub use transfer_function_options::{Hold, InitialConditions, TransferFunctionOptions};
pub use transfer_starts::Start;
pub use vector_arx::{VectorArx, vector_arx};
pub use weighting::Weighting;

use crumple_lti::Complex;
