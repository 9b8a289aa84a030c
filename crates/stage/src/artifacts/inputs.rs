//! The artifacts a stage was given. It looks for topics, not for positions.

use std::path::{Path, PathBuf};

use crumple_artifact::records::{ConcernV1, ConcernsV2, DiagnosisV1, TestV1};
use crumple_artifact::{Artifact, InputDigest, ReadError, Record, Wave, same_type};
use crumple_signal::TestDescription;

use crate::error::{MissingTopic, RefuseExt, Refused};
use crate::names::{stage_order, writer_of};
use crate::terminal::Progress;

/// What a stage works on, and the digests that go into its provenance.
#[derive(Debug)]
pub struct Loaded<I> {
    /// The input.
    pub input: I,
    /// Kind and digest of every part of it.
    pub digests: Vec<InputDigest>,
    /// Earlier stages among the inputs that had no acceptable result.
    pub(crate) diagnosed: Diagnosed,
}

/// What earlier stages without an acceptable result leave behind.
#[derive(Debug, Default)]
pub(crate) struct Diagnosed {
    /// Who and why.
    pub(crate) diagnoses: Vec<DiagnosisV1>,
    /// The same with what to do.
    pub(crate) concerns: Vec<ConcernV1>,
    /// The test description travels on all the same.
    pub(crate) test: Option<TestV1>,
}

impl Diagnosed {
    /// The reason why a topic is missing, if the stage that writes it has said that it has no acceptable result.
    pub(crate) fn reason_for(&self, missing: &MissingTopic) -> Option<String> {
        let writer = missing.writer();
        self.diagnoses
            .iter()
            .find(|diagnosis| writer == format!("crumple-{}", diagnosis.stage))
            .map(|diagnosis| format!("nothing to work on, since {} says: {}", diagnosis.stage, diagnosis.reason))
    }

    /// What earlier stages said of why they have no result.
    pub(crate) fn concerns(&self) -> impl Iterator<Item = &ConcernV1> {
        self.concerns.iter().filter(|concern| concern.is_no_result())
    }
}

impl<I> Loaded<I> {
    /// An input that no stage stands behind, such as a file as users have it.
    pub fn new(input: I, digests: Vec<InputDigest>) -> Self {
        Self { input, digests, diagnosed: Diagnosed::default() }
    }

    /// With something beside what the artifacts hold.
    pub fn map<J>(self, beside: impl FnOnce(I) -> J) -> Loaded<J> {
        Loaded { input: beside(self.input), digests: self.digests, diagnosed: self.diagnosed }
    }
}

/// Artifacts of earlier stages, in the order of the pipeline whatever the order they were given in.
///
/// Where two hold the same topic, the later stage's is taken.
#[derive(Debug)]
pub struct Inputs {
    artifacts: Vec<Artifact>,
}

/// Reads an artifact, its progress shown.
pub(crate) fn open(path: &Path) -> Result<Artifact, ReadError> {
    let mut progress = Progress::of_reading(path);
    Artifact::open_reporting(path, &mut |bytes| progress.advance(bytes))
}

/// Reads and checks artifacts. Refuses any that is damaged, foreign or from a later version.
pub fn load_artifacts(paths: &[PathBuf]) -> anyhow::Result<Loaded<Inputs>> {
    let mut artifacts = paths.iter().map(|path| open(path)).collect::<Result<Vec<_>, _>>().map_err(Refused::from)?;
    artifacts.sort_by(|a, b| (stage_order(a.stage()), a.digest()).cmp(&(stage_order(b.stage()), b.digest())));
    let digests = artifacts
        .iter()
        .map(|a| InputDigest { kind: a.stage().unwrap_or("artifact").to_owned(), digest: a.digest().to_owned() })
        .collect();
    let diagnoses = artifacts.iter().filter_map(|a| a.record::<DiagnosisV1>("/diagnosis").ok().flatten()).collect();
    let concerns = artifacts.iter().filter_map(|a| a.record::<ConcernsV2>("/concerns").ok().flatten());
    let concerns = concerns.flat_map(|record| record.concerns).collect();
    let inputs = Inputs { artifacts };
    inputs.refuse_a_mixture()?;
    let test = inputs.record_if::<TestV1>("/test")?;
    Ok(Loaded { input: inputs, digests, diagnosed: Diagnosed { diagnoses, concerns, test } })
}

impl Inputs {
    /// The artifacts in the order of the pipeline.
    pub fn artifacts(&self) -> &[Artifact] {
        &self.artifacts
    }

    /// Two results of one stage, or results of two tests, cannot be meant.
    fn refuse_a_mixture(&self) -> anyhow::Result<()> {
        let name = |artifact: &Artifact| artifact.path().display().to_string();
        for (k, a) in self.artifacts.iter().enumerate() {
            let source = |artifact: &Artifact| -> anyhow::Result<Option<String>> {
                let test = artifact.record::<TestV1>("/test").map_err(Refused::from)?;
                Ok(test.map(|t| t.source.digest).filter(|digest| !digest.is_empty()))
            };
            for b in &self.artifacts[k + 1..] {
                if let (Some(stage), Some(other)) = (a.stage(), b.stage())
                    && stage == other
                {
                    return Err(Refused::new(format!("{} and {} are both of the stage {stage}", name(a), name(b)))
                        .expected("one artifact of each stage")
                        .hint("leave one of them out")
                        .into());
                }
                if let (Some(of_a), Some(of_b)) = (source(a)?, source(b)?)
                    && of_a != of_b
                {
                    return Err(Refused::new(format!("{} and {} are of different records", name(a), name(b)))
                        .expected("artifacts that go back to one record")
                        .hint("give artifacts of one run folder")
                        .into());
                }
            }
        }
        Ok(())
    }

    /// The test description, from the latest stage that carries it.
    pub fn test(&self) -> anyhow::Result<TestDescription> {
        TestDescription::try_from(self.record::<TestV1>("/test")?).refuse_with_hint("see docs/format.md, type Test")
    }

    /// The record under a topic. Refuses when it is missing, and says which stage writes it.
    pub fn record<R: Record>(&self, topic: &str) -> anyhow::Result<R> {
        self.record_if(topic)?.ok_or_else(|| self.missing(topic))
    }

    /// The record under a topic, if it is there.
    pub fn record_if<R: Record>(&self, topic: &str) -> anyhow::Result<Option<R>> {
        for artifact in self.artifacts.iter().rev() {
            if let Some(record) = artifact.record(topic).map_err(Refused::from)? {
                return Ok(Some(record));
            }
        }
        Ok(None)
    }

    /// All records of a type under a topic prefix, as `(rest of the topic, record)`, sorted by topic.
    pub fn records<R: Record>(&self, prefix: &str) -> anyhow::Result<Vec<(String, R)>> {
        let mut by_topic = std::collections::BTreeMap::new();
        for artifact in &self.artifacts {
            for raw in artifact.records() {
                if let Some(rest) = raw.topic.strip_prefix(prefix)
                    && same_type(&raw.schema, R::SCHEMA)
                {
                    by_topic.insert(rest.to_owned(), artifact.decode(raw).map_err(Refused::from)?);
                }
            }
        }
        Ok(by_topic.into_iter().collect())
    }

    /// The waveform of a channel. Refuses when it is missing.
    pub fn wave(&self, id: &str) -> anyhow::Result<&Wave> {
        self.wave_if(id).ok_or_else(|| self.missing(&format!("/wave/{id}")))
    }

    /// The waveform of a channel, if it is there.
    pub fn wave_if(&self, id: &str) -> Option<&Wave> {
        self.artifacts.iter().rev().find_map(|a| a.waves().get(id))
    }

    /// All waveforms as `(id, waveform)`, sorted by id.
    pub fn waves(&self) -> impl Iterator<Item = (&str, &Wave)> {
        let mut by_id = std::collections::BTreeMap::new();
        for artifact in &self.artifacts {
            by_id.extend(artifact.waves().iter().map(|(id, wave)| (id.as_str(), wave)));
        }
        by_id.into_iter()
    }

    /// The error for a topic that is needed and not there.
    pub fn missing(&self, topic: &str) -> anyhow::Error {
        let given: Vec<String> = self
            .artifacts
            .iter()
            .map(|a| format!("{} ({})", a.path().display(), a.stage().unwrap_or("no stage stated")))
            .collect();
        MissingTopic::new(topic, given.join(", "), writer_of(topic)).into()
    }
}

#[cfg(test)]
mod tests {
    use crumple_artifact::records::SeverityV1;
    use crumple_artifact::{ArtifactBuilder, Compression, Provenance, put_json};

    use super::*;

    /// An artifact of a stage about the record with this digest.
    fn written(folder: &Path, name: &str, stage: &str, record: &str) -> PathBuf {
        let source = serde_json::json!({"format": "csv", "name": "crash.csv", "digest": record});
        let test = serde_json::json!({"title": "", "source": source, "channels": []});
        let mut builder = ArtifactBuilder::new();
        put_json(&mut builder, "/test", TestV1::SCHEMA, test).unwrap();
        let path = folder.join(name);
        let provenance = Provenance::new(stage, "0.1.0", "{}".into(), Vec::new());
        builder.write(&path, &provenance, Compression::None).unwrap();
        path
    }

    #[test]
    fn a_stage_without_a_result_is_the_reason_for_what_is_missing() {
        let diagnosis = DiagnosisV1 { stage: "identify".to_owned(), reason: "no poles".to_owned(), has_result: false };
        let concern = |severity| ConcernV1 { severity, ..ConcernV1::default() };
        let concerns = vec![concern(SeverityV1::Warning), concern(SeverityV1::NoResult)];
        let diagnosed = Diagnosed { diagnoses: vec![diagnosis], concerns, test: None };
        let missing = |writer| MissingTopic::new("/model", String::new(), writer);
        let reason = diagnosed.reason_for(&missing("crumple-identify")).unwrap();
        assert_eq!(reason, "nothing to work on, since identify says: no poles");
        assert_eq!(diagnosed.reason_for(&missing("crumple-filter")), None);
        assert_eq!(diagnosed.concerns().count(), 1);
    }

    #[test]
    fn two_artifacts_of_one_stage_and_artifacts_of_two_records_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name, stage, record| written(folder.path(), name, stage, record);
        let filter = write("2.mcap", "filter", "blake3:aa");
        let integrate = write("3.mcap", "integrate", "blake3:aa");
        let of_another_record = write("3b.mcap", "integrate", "blake3:bb");
        let unnamed = write("x.mcap", "", "");
        let problem = |paths: &[&PathBuf]| {
            let paths: Vec<PathBuf> = paths.iter().map(|path| (*path).clone()).collect();
            let refused = load_artifacts(&paths).err().map(|error| error.to_string());
            refused.map(|text| text.replace(&format!("{}/", folder.path().display()), ""))
        };
        assert_eq!(problem(&[&integrate, &filter]), None);
        assert_eq!(problem(&[&filter, &unnamed]), None, "who does not name stage or record is believed");
        assert_eq!(problem(&[&filter, &of_another_record]).unwrap(), "2.mcap and 3b.mcap are of different records");
        assert_eq!(
            problem(&[&of_another_record, &integrate]).unwrap().split(" are ").nth(1),
            Some("both of the stage integrate")
        );
    }
}
