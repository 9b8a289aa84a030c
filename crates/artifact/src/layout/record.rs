//! Which types may stand in an artifact, their schema names, and their way into messages and back.
//!
//! The way is written out for each type here, so that it is compiled once and not again in every program that uses it.

use std::sync::OnceLock;

use serde::{Serialize, de::DeserializeOwned};

use crate::finite::first_non_finite;
use crate::layout::codec::Codec;
use crate::layout::json_text::{to_json, without_blanks};
use crate::records::{
    ArxScanV1, CandidateV1, ChannelFilterV1, ConcernsV1, ConcernsV2, DamageV1, DiagnosisV1, EventsV1, EvidenceV1,
    ExponentialSumV1, IdentificationV1, ImpactsV1, MatchingV1, MetricsV1, MetricsV2, ModesV1, ModesV2, NotesV1,
    PredictionV1, QualityV1, RecommendationV1, RecordChecksV1, RemarksV1, ResponseV1, SelectionV1, ShapesV1,
    SimulationV1, StabilizationV1, StateSpaceV1, TestV1, TestsV1, TestsV2, TransferFunctionV1, VehiclesV1, WaveBlockV1,
};

/// A type that may stand in an artifact. A record is a JSON object: viewers and checks of schemas take no other.
pub trait Record: Serialize + DeserializeOwned + Clone + 'static {
    /// Schema name and version, e.g. `crumple.Events.v1`.
    const SCHEMA: &'static str;

    /// Its JSON Schema as text: complete for validators, safe for viewers. It is that of `docs/schemas/`, built in: to
    /// make it of the type takes a process longer than to write a small artifact.
    fn schema_json() -> &'static [u8];

    /// The same made of the type, which tests hold `docs/schemas/` against, and `just schemas` writes there.
    #[cfg(feature = "schemas")]
    fn schema_of_type() -> serde_json::Value;

    /// The record as a message. Errors say what in it cannot be encoded.
    fn encode(&self, codec: Codec) -> Result<Vec<u8>, String>;

    /// The record as JSON, what is unknown left out. Errors say what in it cannot be encoded.
    fn to_json(&self) -> Result<Vec<u8>, String>;

    /// Schema name of the version before this one, if it is still read.
    const EARLIER: Option<&'static str> = None;

    /// The record in a message. Errors say what does not decode, trailing bytes among it, or what contradicts itself
    /// ([`Record::check`]).
    fn decode(codec: Codec, bytes: &[u8]) -> Result<Self, String>;

    /// The record in a message of the version before this one. Errors: those of [`Record::decode`].
    fn decode_earlier(codec: Codec, bytes: &[u8]) -> Result<Self, String> {
        Self::decode(codec, bytes)
    }

    /// Errors say what in the record contradicts itself: an interval whose low end is above its high end, a correlation
    /// above one.
    fn check(&self) -> Result<(), String>;

    /// Path and value of its first number that is not finite or, in what is said of a crash, beyond what one can have.
    fn first_impossible(&self) -> Option<(String, f64)>;
}

/// Does something with a record type that is known by its schema name only.
pub(crate) trait TypeVisitor {
    type Output;
    fn visit<R: Record>(self) -> Self::Output;
}

/// A record without contradictions.
fn checked<R: Record>(record: R) -> Result<R, String> {
    record.check().map(|()| record)
}

macro_rules! record {
    ($($type:ty => $schema:literal $(after $earlier:ty)? $(where $check:ident)?),* $(,)?) => {
        $(impl Record for $type {
            const SCHEMA: &'static str = $schema;

            fn schema_json() -> &'static [u8] {
                static TEXT: OnceLock<Vec<u8>> = OnceLock::new();
                TEXT.get_or_init(|| {
                    without_blanks(include_str!(concat!("../../../../docs/schemas/", $schema, ".json")))
                })
            }

            #[cfg(feature = "schemas")]
            fn schema_of_type() -> serde_json::Value {
                crate::layout::schema::viewer_safe_schema(schemars::schema_for!($type).to_value(), $schema)
            }

            fn encode(&self, codec: Codec) -> Result<Vec<u8>, String> {
                codec.encode(self)
            }

            fn to_json(&self) -> Result<Vec<u8>, String> {
                to_json(self)
            }

            fn decode(codec: Codec, bytes: &[u8]) -> Result<Self, String> {
                codec.decode(bytes).and_then(checked)
            }

            fn check(&self) -> Result<(), String> {
                $(self.$check()?;)?
                Ok(())
            }
            $(
                const EARLIER: Option<&'static str> = Some(<$earlier as Record>::SCHEMA);

                fn decode_earlier(codec: Codec, bytes: &[u8]) -> Result<Self, String> {
                    codec.decode::<$earlier>(bytes).map(Self::from).and_then(checked)
                }
            )?

            fn first_impossible(&self) -> Option<(String, f64)> {
                first_non_finite(self)$(.or_else(|| {
                    let _ = Self::$check;
                    self.first_too_large()
                }))?
            }
        })*

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
    CandidateV1 => "crumple.Candidate.v1" where check_numbers,
    ChannelFilterV1 => "crumple.ChannelFilter.v1",
    DamageV1 => "crumple.Damage.v1",
    ConcernsV1 => "crumple.Concerns.v1",
    ConcernsV2 => "crumple.Concerns.v2" after ConcernsV1,
    VehiclesV1 => "crumple.Vehicles.v1",
    DiagnosisV1 => "crumple.Diagnosis.v1",
    EventsV1 => "crumple.Events.v1" where check_numbers,
    EvidenceV1 => "crumple.Evidence.v1",
    ShapesV1 => "crumple.Shapes.v1",
    ExponentialSumV1 => "crumple.ExponentialSum.v1",
    IdentificationV1 => "crumple.Identification.v1",
    ImpactsV1 => "crumple.Impacts.v1",
    MatchingV1 => "crumple.Matching.v1",
    MetricsV1 => "crumple.Metrics.v1",
    MetricsV2 => "crumple.Metrics.v2" after MetricsV1 where check_numbers,
    ModesV1 => "crumple.Modes.v1",
    ModesV2 => "crumple.Modes.v2" after ModesV1,
    NotesV1 => "crumple.Notes.v1",
    PredictionV1 => "crumple.Prediction.v1" where check_numbers,
    QualityV1 => "crumple.Quality.v1",
    RecommendationV1 => "crumple.Recommendation.v1",
    RecordChecksV1 => "crumple.RecordChecks.v1",
    RemarksV1 => "crumple.Remarks.v1",
    ResponseV1 => "crumple.Response.v1",
    SelectionV1 => "crumple.Selection.v1",
    SimulationV1 => "crumple.Simulation.v1",
    StabilizationV1 => "crumple.Stabilization.v1",
    StateSpaceV1 => "crumple.StateSpace.v1",
    TestV1 => "crumple.Test.v1",
    TestsV1 => "crumple.Tests.v1",
    TestsV2 => "crumple.Tests.v2" after TestsV1,
    TransferFunctionV1 => "crumple.TransferFunction.v1",
    WaveBlockV1 => "crumple.WaveBlock.v1",
}
