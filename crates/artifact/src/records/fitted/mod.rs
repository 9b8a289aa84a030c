//! Records of parameter-solve and simulate: matching, candidates with their uncertainty, simulations.
//! Uses no other room.

mod candidate;
mod matching;
mod simulation;

pub use candidate::{CandidateV1, FitV1, ProfileV1, ReplicatesV1, SensorFitV1, UncertaintyV1};
pub use matching::{MatchingRootV1, MatchingSolutionV1, MatchingSweepV1, MatchingV1, PhysicalCoordinatesV1};
pub use simulation::{EnergyV1, OtherSensorV1, RatingV1, SimulationV1};
