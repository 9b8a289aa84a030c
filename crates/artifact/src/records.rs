//! The records that stages exchange, as they stand on disk.
//!
//! A type here is a contract with other programs: its JSON field names are never changed, only its version is.
//! What code works with is the domain type it converts to and from. Rules that keep every type readable in both
//! encodings: no tagged enums, no `flatten`, no skipped fields, no free-form values; unknown is `null` (`Option`);
//! numbers are finite.

mod arx_scan;
mod candidate;
mod channel_filter;
mod diagnosis;
mod events;
mod evidence;
mod identification;
mod matching;
mod metrics;
mod model;
mod notes;
mod quality;
mod response;
mod selection;
mod shapes;
mod simulation;
mod stabilization;
mod test;
mod wave;

pub use arx_scan::{ArxScanModelV1, ArxScanV1};
pub use candidate::{CandidateV1, FitV1, ProfileV1, ReplicatesV1, SensorFitV1, UncertaintyV1};
pub use channel_filter::{ChannelFilterV1, CorridorPointV1};
pub use diagnosis::DiagnosisV1;
pub use events::{EventIntervalV1, EventsV1, MissingIntervalV1};
pub use evidence::{EvidenceV1, SpreadV1};
pub use identification::IdentificationV1;
pub use matching::{MatchingRootV1, MatchingSolutionV1, MatchingSweepV1, MatchingV1, PhysicalCoordinatesV1};
pub use metrics::{MetricV1, MetricsV1};
pub use model::{ExponentialSumV1, ExponentialTermV1, ModeV1, ModesV1, StateSpaceV1, TransferFunctionV1};
pub use notes::NotesV1;
pub use quality::QualityV1;
pub use response::ResponseV1;
pub use selection::{SelectionModelV1, SelectionV1};
pub use shapes::{ShapeV1, ShapesV1};
pub use simulation::{EnergyV1, OtherSensorV1, RatingV1, SimulationV1};
pub use stabilization::{StabilizationClusterV1, StabilizationPoleV1, StabilizationV1};
pub use test::{ChannelV1, SourceV1, TestV1};
pub use wave::WaveBlockV1;

use schemars::JsonSchema;
use serde::{Serialize, de::DeserializeOwned};

/// A type that may stand in an artifact.
pub trait Record: Serialize + DeserializeOwned + JsonSchema {
    /// Schema name and version, e.g. `crumple.Events.v1`.
    const SCHEMA: &'static str;
}

/// Does something with a record type that is known by its schema name only.
pub(crate) trait TypeVisitor {
    type Output;
    fn visit<R: Record>(self) -> Self::Output;
}

macro_rules! record {
    ($($type:ty => $schema:literal),* $(,)?) => {
        $(impl Record for $type { const SCHEMA: &'static str = $schema; })*

        /// Schema names of all record types, sorted by name.
        pub const SCHEMAS: &[&str] = &[$($schema),*];

        /// Shows a visitor the type behind a schema name; `None` if the name is not in [`SCHEMAS`].
        pub(crate) fn with_type<V: TypeVisitor>(schema: &str, visitor: V) -> Option<V::Output> {
            match schema {
                $($schema => Some(visitor.visit::<$type>()),)*
                _ => None,
            }
        }
    };
}

record! {
    ArxScanV1 => "crumple.ArxScan.v1",
    CandidateV1 => "crumple.Candidate.v1",
    ChannelFilterV1 => "crumple.ChannelFilter.v1",
    DiagnosisV1 => "crumple.Diagnosis.v1",
    EventsV1 => "crumple.Events.v1",
    EvidenceV1 => "crumple.Evidence.v1",
    ShapesV1 => "crumple.Shapes.v1",
    ExponentialSumV1 => "crumple.ExponentialSum.v1",
    IdentificationV1 => "crumple.Identification.v1",
    MatchingV1 => "crumple.Matching.v1",
    MetricsV1 => "crumple.Metrics.v1",
    ModesV1 => "crumple.Modes.v1",
    NotesV1 => "crumple.Notes.v1",
    QualityV1 => "crumple.Quality.v1",
    ResponseV1 => "crumple.Response.v1",
    SelectionV1 => "crumple.Selection.v1",
    SimulationV1 => "crumple.Simulation.v1",
    StabilizationV1 => "crumple.Stabilization.v1",
    StateSpaceV1 => "crumple.StateSpace.v1",
    TestV1 => "crumple.Test.v1",
    TransferFunctionV1 => "crumple.TransferFunction.v1",
    WaveBlockV1 => "crumple.WaveBlock.v1",
}
