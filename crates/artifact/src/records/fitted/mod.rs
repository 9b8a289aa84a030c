//! Records of parameter-solve and simulate: matching, candidates with their uncertainty, which to use, simulations.

mod candidate;
mod joint_tests;
mod matching;
mod recommendation;
mod simulation;

pub use candidate::{
    CandidateV1, Certainty, Doubt, EvaluationV1, FitV1, MassDivisionsV1, ProfileV1, ReplicatesV1, SensorFitV1,
    UncertaintyV1,
};
pub use joint_tests::{JointTestV1, TestsV1, TestsV2};
pub use matching::{MatchingRootV1, MatchingSolutionV1, MatchingSweepV1, MatchingV1, PhysicalCoordinatesV1};
pub use recommendation::{
    PriorTermV1, PriorV1, RatedCandidateV1, RecommendationEvidenceV1, RecommendationV1, StrengthV1,
};
pub use simulation::{EnergyV1, MotionBandV1, OtherSensorV1, RatingV1, ResidualV1, SimulationV1};
