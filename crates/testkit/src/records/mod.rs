//! Records and artifacts that tests read: fixtures, records of known parameters, reference signals, outputs of stages
//! made directly. May use `random` and `places`.

mod filtered;
pub mod fixture;
mod integrated;
pub mod kinds;
mod known_truth;
pub mod reference_signals;
mod table_5;
mod two_vehicles;

pub use filtered::write_filtered;
pub use integrated::{IMPACT_SPEED_M_PER_S, integrated};
pub use known_truth::{KnownTruth, known_truth, known_truths, known_truths_in, other_records, write_known_truth};
pub use table_5::table_5;
pub use two_vehicles::TwoVehicles;
