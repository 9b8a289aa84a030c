//! Identifies linear models from a record.
//!
//! One method so far: [`era`], the eigensystem realization algorithm, which takes the record for the impulse response
//! of a linear system and returns the smallest balanced one that has it, with poles, modes and the evidence for them.

mod arx;
mod bootstrap;
mod caveats;
mod clusters;
mod compare;
mod continuation;
mod era;
mod error;
mod exponential_sum;
mod factors;
mod fit;
mod golub_kahan;
mod hankel;
mod information;
mod initial_state;
mod input_matrices;
mod io_data;
mod least_squares;
mod modal;
mod order;
mod order_scan;
mod output_error;
mod pole_problem;
mod propagation;
mod random;
mod residual;
mod residual_noise;
mod section_chain;
mod selection;
mod separable;
mod stabilization;
mod statistics;
mod subspace;
mod transfer_function_fit;
mod transfer_starts;

pub use arx::{Arx, ArxOrder, arx, arx_scan};
pub use bootstrap::{BandPoint, Bootstrap, BootstrapOptions, Sample, Spread, bootstrap};
pub use caveats::{caveats, filter_edge_hz, mode_notes};
pub use clusters::{PoleCluster, Quartiles};
pub use compare::{FitMeasures, compare, fit_measures, simulate_fitted};
pub use continuation::{continued, sampled};
pub use era::{Era, EraError, EraOptions, Order, Realization, era};
pub use error::IdentifyError;
pub use exponential_sum::{ExponentialOptions, ExponentialSumFit, ExponentialTerm, exponential_sum};
pub use factors::Decomposition;
pub use fit::{fit_percent, rmse};
pub use information::InformationCriteria;
pub use io_data::IoData;
pub use least_squares::CONDITION_LIMIT;
pub use modal::IdentifiedMode;
pub use order::{GapOrder, order_by_gap};
pub use order_scan::{era_order_scan, subspace_order_scan};
pub use output_error::{OutputError, OutputErrorOptions, output_error};
pub use propagation::response_deviations;
pub use residual::{ResidualTests, effective_samples, residual_tests};
pub use residual_noise::{Resampling, ResidualNoise};
pub use selection::{Contender, Ranked, Selection, select};
pub use separable::{Stop, Termination};
pub use stabilization::{
    DiagramPole, OrderPoles, Stability, StabilizationDiagram, StabilizationOptions, modal_assurance,
    phase_collinearity, stabilization,
};
pub use subspace::{Subspace, SubspaceModel, SubspaceOptions, Weighting};
pub use transfer_function_fit::{
    Hold, InitialConditions, TransferFunctionFit, TransferFunctionOptions, transfer_function_fit,
};
pub use transfer_starts::Start;

use crumple_lti::Complex;
