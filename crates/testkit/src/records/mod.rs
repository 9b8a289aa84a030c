//! Records and artifacts that tests read: fixtures, records of known parameters, reference signals, outputs of stages
//! made directly; and how a laboratory measures the motions of made cars.

mod filtered;
pub mod fixture;
mod integrated;
pub mod kinds;
mod known_truth;
mod low_pass;
mod measurement;
pub mod reference_signals;
mod table_5;
mod two_vehicles;

pub use filtered::write_filtered;
pub use integrated::{IMPACT_SPEED_M_PER_S, integrated};
pub use known_truth::{KnownTruth, known_truth, known_truths, known_truths_in, other_records, write_known_truth};
pub(crate) use low_pass::LowPass;
pub(crate) use measurement::{FINE_S, Measurement};
pub use table_5::table_5;
pub use two_vehicles::TwoVehicles;
