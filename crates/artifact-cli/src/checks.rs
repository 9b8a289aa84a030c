//! Checks that an intact artifact says what the format demands.

use crumple_artifact::records::{
    ArxScanV1, CandidateV1, ChannelFilterV1, ConcernsV1, ConcernsV2, DamageV1, DiagnosisV1, EventsV1, EvidenceV1,
    ExponentialSumV1, IdentificationV1, ImpactsV1, MatchingV1, MetricsV1, MetricsV2, ModesV1, ModesV2, NotesV1,
    PredictionV1, QualityV1, RecommendationV1, RecordChecksV1, RemarksV1, ResponseV1, SelectionV1, ShapesV1,
    SimulationV1, StabilizationV1, StateSpaceV1, TestV1, TransferFunctionV1, VehiclesV1, WaveBlockV1,
};
use crumple_artifact::{Artifact, JsonForm, RawRecord, Record};
use crumple_signal::TestDescription;

use crate::show::json_of;

// Whether an artifact says what the format demands, beyond being intact.

/// What an artifact without fault holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Checked {
    /// Small records.
    pub records: usize,
    /// Those whose schema is of another project; they were not decoded.
    pub foreign: usize,
    /// Waveforms.
    pub waves: usize,
    /// Their samples.
    pub samples: usize,
    /// Content digest.
    pub digest: String,
}

impl Checked {
    /// The line of a file without fault.
    pub fn line(&self, file: &std::path::Path) -> String {
        let foreign = match self.foreign {
            0 => String::new(),
            n => format!(" ({n} of other projects, not decoded)"),
        };
        format!(
            "{}: ok: {} records{foreign}, {} waves, {} samples, digest {}\n",
            file.display(),
            self.records,
            self.waves,
            self.samples,
            self.digest
        )
    }
}

/// Topic, or its start where it ends in `/`, and what may stand there.
const STATED: [(&str, &[&str]); 28] = [
    ("/test", &[TestV1::SCHEMA]),
    ("/wave/", &[WaveBlockV1::SCHEMA]),
    ("/quality/", &[QualityV1::SCHEMA]),
    ("/filter/", &[ChannelFilterV1::SCHEMA]),
    ("/events", &[EventsV1::SCHEMA]),
    ("/impacts", &[ImpactsV1::SCHEMA]),
    ("/metrics", &[MetricsV1::SCHEMA, MetricsV2::SCHEMA]),
    ("/model/", &[StateSpaceV1::SCHEMA, TransferFunctionV1::SCHEMA, ExponentialSumV1::SCHEMA]),
    ("/modes/", &[ModesV1::SCHEMA, ModesV2::SCHEMA]),
    ("/identification/", &[IdentificationV1::SCHEMA]),
    ("/evidence/", &[EvidenceV1::SCHEMA]),
    ("/shapes/", &[ShapesV1::SCHEMA]),
    ("/stabilisation/", &[StabilizationV1::SCHEMA]),
    ("/response/", &[ResponseV1::SCHEMA]),
    ("/selection/", &[SelectionV1::SCHEMA]),
    ("/scan/", &[ArxScanV1::SCHEMA]),
    ("/checks/", &[RecordChecksV1::SCHEMA]),
    ("/matching/", &[MatchingV1::SCHEMA]),
    ("/parameters/", &[CandidateV1::SCHEMA]),
    ("/simulation/", &[SimulationV1::SCHEMA]),
    ("/damage", &[DamageV1::SCHEMA]),
    ("/vehicles", &[VehiclesV1::SCHEMA]),
    ("/recommendation", &[RecommendationV1::SCHEMA]),
    ("/prediction/", &[PredictionV1::SCHEMA]),
    ("/remarks", &[RemarksV1::SCHEMA]),
    ("/notes", &[NotesV1::SCHEMA]),
    ("/concerns", &[ConcernsV1::SCHEMA, ConcernsV2::SCHEMA]),
    ("/diagnosis", &[DiagnosisV1::SCHEMA]),
];

/// Checks an artifact that was read, and so is intact: every record decodes to the type its schema names, stands under
/// a topic stated for it, and agrees with itself. Returns every fault found.
pub fn check(artifact: &Artifact) -> Result<Checked, Vec<String>> {
    let mut faults = Vec::new();
    let mut foreign = 0;
    for raw in artifact.records() {
        match artifact.json_text(raw, JsonForm::Line) {
            Err(error) => faults.push(error.to_string()),
            Ok(Some(_)) => faults.extend(place_fault(raw).into_iter().chain(content_fault(artifact, raw))),
            Ok(None) if raw.schema.starts_with("crumple.") => {
                faults.push(format!("topic {} holds {}, which is no type of the format", raw.topic, raw.schema));
            }
            // What `show` prints must be readable too.
            Ok(None) => match json_of(artifact, raw, JsonForm::Line) {
                Err(error) => faults.push(error.to_string()),
                Ok(_) => foreign += 1,
            },
        }
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    Ok(Checked {
        records: artifact.records().len(),
        foreign,
        waves: artifact.waves().len(),
        samples: artifact.waves().values().map(|wave| wave.sampled.len()).sum(),
        digest: artifact.digest().to_owned(),
    })
}

fn place_fault(raw: &RawRecord) -> Option<String> {
    let stands_at = |place: &str| {
        if place.ends_with('/') {
            raw.topic.len() > place.len() && raw.topic.starts_with(place)
        } else {
            raw.topic == place
        }
    };
    let (_, schemas) = STATED.iter().find(|(place, _)| stands_at(place))?;
    (!schemas.contains(&raw.schema.as_str()))
        .then(|| format!("topic {} holds {}, {} is stated for it", raw.topic, raw.schema, schemas.join(" or ")))
}

/// What the types alone do not say.
fn content_fault(artifact: &Artifact, raw: &RawRecord) -> Option<String> {
    let fault = match raw.schema.as_str() {
        TestV1::SCHEMA => test_fault(artifact, artifact.decode(raw).ok()?),
        _ => None,
    };
    fault.map(|fault| format!("topic {}: {fault}", raw.topic))
}

fn test_fault(artifact: &Artifact, test: TestV1) -> Option<String> {
    let test = match TestDescription::try_from(test) {
        Ok(test) => test,
        Err(error) => return Some(error.to_string()),
    };
    test.channels.iter().find_map(|channel| {
        let quantity = artifact.waves().get(&channel.id)?.quantity;
        (quantity != channel.quantity).then(|| {
            format!("channel {:?} is listed as {}, its waveform says {quantity}", channel.id, channel.quantity)
        })
    })
}
