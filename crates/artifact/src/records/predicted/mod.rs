//! Records of predict: impacts that were not made.

mod prediction;

pub use prediction::{
    AgainstTestV1, AnsweredByV1, PredictedCollisionV1, PredictedEnergyV1, PredictedIntervalV1, PredictedOccupantV1,
    PredictionV1,
};
