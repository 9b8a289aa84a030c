//! Records of predict: impacts that were not made.
//! Uses no other room.

mod prediction;

pub use prediction::{AgainstTestV1, PredictedEnergyV1, PredictedIntervalV1, PredictionV1};
