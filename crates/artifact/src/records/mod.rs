//! The records that stages exchange, as they stand on disk.
//!
//! A type here is a contract with other programs: its JSON field names are never changed, only its version is.
//! What code works with is the domain type it converts to and from. Rules that keep every type readable in both
//! encodings: no tagged enums, no `flatten`, no skipped fields, no free-form values; unknown is `null` (`Option`);
//! numbers are finite.

mod agreement;
mod compared;
mod fitted;
mod identified;
mod measured;
mod predicted;
mod run;
mod test;

pub use compared::{
    ArxScanModelV1, ArxScanV1, FoundDelayV1, OutliersV1, RecommendedBecauseV1, RecordChecksV1, ScanEdgeV1,
    SelectionModelV1, SelectionV1, ShapeV1, ShapesV1, StabilizationClusterV1, StabilizationPoleV1, StabilizationV1,
    TrendV1,
};
pub use fitted::{
    CandidateV1, Certainty, Doubt, EnergyV1, EvaluationV1, FitV1, JointTestV1, MassDivisionsV1, MatchingRootV1,
    MatchingSolutionV1, MatchingSweepV1, MatchingV1, MotionBandV1, OtherSensorV1, PhysicalCoordinatesV1, PriorTermV1,
    PriorV1, ProfileV1, RatedCandidateV1, RatingV1, RecommendationEvidenceV1, RecommendationV1, ReplicatesV1,
    ResidualV1, SensorFitV1, SimulationV1, StrengthV1, TestsV1, TestsV2, UncertaintyV1,
};
pub use identified::{
    EvidenceV1, ExponentialSumV1, ExponentialTermV1, IdentificationV1, ModeKindV1, ModeV1, ModesV1, ModesV2,
    NoIntervalV1, NoSpreadV1, NoiseModelV1, NoiseV1, OtherPoleKindV1, OtherPoleV1, ResponseV1, SpreadV1, StateSpaceV1,
    TransferFunctionV1,
};
pub use measured::{
    ChannelFilterV1, CorridorPointV1, DamageV1, EventIntervalV1, EventsV1, ImpactV1, ImpactsV1, IntervalSourceV1,
    MetricV1, MetricsV1, MetricsV2, MissingIntervalV1, QualityV1, VehicleV1, VehiclesV1, WaveBlockV1,
};
pub use predicted::{
    AgainstTestV1, AnsweredByV1, PredictedCollisionV1, PredictedEnergyV1, PredictedIntervalV1, PredictedOccupantV1,
    PredictionV1,
};
pub use run::{ConcernV1, ConcernsV1, ConcernsV2, DiagnosisV1, NotesV1, RemarkV1, RemarksV1, SeverityV1, ValueV1};
pub use test::{ChannelV1, ContactV1, KindV1, SourceV1, TestV1};
