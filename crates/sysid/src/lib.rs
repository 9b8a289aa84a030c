//! System identification: linear models from records, with the evidence for them.
//!
//! Free motion, from one channel or several: [`era`] realises a state space from Markov parameters,
//! [`exponential_sum`] fits a sum of exponentials. From inputs and outputs ([`IoData`]): [`Subspace`] (N4SID, MOESP,
//! CVA), [`arx`], [`Okid`], [`output_error`], and [`transfer_function_fit`] for continuous models. Validation:
//! [`stabilization`] over orders, [`noise_model`] and [`bootstrap`], [`compare`] and [`continued`] on other samples,
//! [`select`] and [`recommended`] among several, [`caveats`] in words; of a record [`delay_scan`], [`trend`],
//! [`outliers`], [`ambient_modes`].
//!
//! ```
//! use crumple_sysid::{EraOptions, Order, era};
//!
//! // The impulse response of a system with the poles -5 ± 60i 1/s.
//! let times = (0..400).map(|k| f64::from(k) * 1e-3);
//! let record: Vec<f64> = times.map(|t| (-5.0 * t).exp() * (60.0 * t).sin()).collect();
//! let model = era(&record, EraOptions { order: Order::Given(2), ..EraOptions::new(1e-3) })?.continuous?;
//! assert!(model.poles()?.iter().all(|pole| (pole.re + 5.0).abs() < 1e-6 && (pole.im.abs() - 60.0).abs() < 1e-6));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Functions of numbers only: no file, clock, environment or terminal. The same record and options give the same model
//! on any number of threads; random starts and draws are seeded. Signals are slices of `f64` in any unit, sampled
//! together at `sample_time_s` seconds; poles of continuous models are in 1/s and rad/s.

mod ambient;
mod arx;
mod data;
mod era;
mod error;
mod exponentials;
mod hankel;
mod harmonic;
mod modes;
mod okid;
mod order;
mod output_error;
mod poles;
mod polynomial_form;
mod regression;
mod simulation;
mod subspace;
mod subspace_choice;
mod transfer_function;
mod validation;

pub use ambient::{AmbientMode, AmbientModes, AmbientOptions, AmbientPole, ambient_modes};
pub use arx::{Arx, ArxOrder, arx, arx_from, arx_scan};
pub use crumple_numerics::estimation::minimise::{Stop, StopReason};
pub use crumple_numerics::estimation::statistics::{
    InformationCriteria, ResidualTests, autoregressive_effective_samples, residual_tests,
};
pub use data::{Hold, IoData, MarkovParameters, automatic_thinning, end_of_contact, markov_parameters, thinned};
pub use era::era::{Era, EraOptions, Order, era};
pub use era::realization::Realization;
pub use error::{EraError, IdentifyError, MissReason};
pub use exponentials::{ExponentialOptions, ExponentialSumFit, ExponentialTerm, exponential_sum};
pub use hankel::singular_value_gap::GapOrder;
pub use hankel::svd::Decomposition;
pub use harmonic::{HarmonicLine, harmonic_line};
pub use modes::{
    IdentifiedMode, PoleKind, PoleRecord, modal_assurance, mode_shapes, phase_collinearity, pole_kinds,
    response_deviations,
};
pub use okid::{Criterion, Lags, Okid, OkidModel, OkidOptions};
pub use order::{
    DiagramPole, OrderPoles, PoleCluster, Quartiles, Stability, StabilizationDiagram, StabilizationOptions,
    era_order_scan, era_order_scan_of, stabilization, subspace_order_scan,
};
pub use output_error::options::OutputErrorOptions;
pub use output_error::output_error::{OutputError, output_error, output_error_from};
pub use poles::options::{InitialConditions, TransferFunctionOptions};
pub use poles::search_outcome::SearchOutcome;
pub use poles::starts::Start;
pub use polynomial_form::{PolynomialDeviations, PolynomialForm};
pub use simulation::continuation::{continued, sampled};
pub use simulation::fit::{FitMeasures, compare, fit_measures, simulate_fitted};
pub use subspace::{Horizons, Subspace, SubspaceModel, SubspaceOptions, Weighting, horizons};
pub use subspace_choice::{ChosenOrder, Horizon, HorizonModel, SHORTEST_HORIZON, SubspaceSettings};
pub use transfer_function::{TransferFunctionFit, transfer_function_fit};
pub use validation::bootstrap::{
    BandPoint, Bootstrap, BootstrapOptions, NoSpread, RecordLength, Sample, Spread, bootstrap,
};
pub use validation::cancellation::{Cancelled, cancelled_poles};
pub use validation::caveats::{FilterEdge, REMARKS as CAVEAT_REMARKS, WeakFit, caveats, pole_notes, weak_fit};
pub use validation::input_hold::{LineLoss, is_staircase, line_loss};
pub use validation::model_choice::{
    DelayScan, OnUnseen, Recommendable, arx_orders, delay_scan, noise_of_orders, recommended, smallest,
};
pub use validation::model_selection::{
    Contender, Ranked, Selection, best_of_many, left_by_unseen, select, unseen_squares,
};
pub use validation::noise_model::{NoiseKind, NoiseModel, NoiseOptions, Whiteness, noise_model};
pub use validation::record_checks::{Constants, Trend, is_constant, outliers, straight_line, trend};
