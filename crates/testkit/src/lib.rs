//! Helpers for the workspace's tests, and the fixture generator. A dev-dependency only.

pub mod atlas;
pub mod benchmark;
pub mod browser;
pub mod bytes;
pub mod calibration;
pub mod contact_cover;
pub mod fuzz;
pub mod identification_cover;
pub mod instructions;
pub mod interval_cover;
pub mod made_fleet;
pub mod numbers;
mod places;
pub mod prediction_error;
pub mod programs;
mod random;
mod records;
pub mod truth;

/// Characters in a line of a page, as in all of docs/.
const PAGE_COLUMNS: usize = 120;

pub use places::{shared, workspace};
pub use random::{uniform, white_noise};
pub use records::{
    Errors, IMPACT_SPEED_M_PER_S, KnownTruth, TwoVehicles, fixture, identification, integrated, kinds, known_truth,
    known_truths, known_truths_in, other_records, reference_signals, simulated, table_5, write_camry_with_load_cells,
    write_filtered, write_known_truth,
};
