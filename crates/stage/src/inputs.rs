//! The artifacts a stage was given. It looks for topics, not for positions.

use std::path::PathBuf;

use crumple_artifact::records::{DiagnosisV1, TestV1};
use crumple_artifact::{Artifact, InputDigest, Record, Wave};
use crumple_signal::TestDescription;

use crate::error::{RefuseExt, Refused};
use crate::stages::{stage_order, writer_of};

/// What a stage works on, and the digests that go into its provenance.
#[derive(Debug)]
pub struct Loaded<I> {
    /// The input.
    pub input: I,
    /// Kind and digest of every part of it.
    pub digests: Vec<InputDigest>,
    /// Why an earlier stage had no acceptable result, if one of the inputs says so.
    pub diagnosis: Option<String>,
}

impl<I> Loaded<I> {
    /// An input that no stage stands behind, such as a file as users have it.
    pub fn new(input: I, digests: Vec<InputDigest>) -> Self {
        Self { input, digests, diagnosis: None }
    }
}

/// A topic that a stage needs is in none of its inputs.
///
/// Where an earlier stage had no acceptable result, this is no fault of the input: the stage has none either.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("topic {topic} is in none of the inputs: {given}")]
pub struct MissingTopic {
    topic: String,
    given: String,
}

impl MissingTopic {
    /// The binary that writes the topic.
    pub(crate) fn hint(&self) -> String {
        format!("give the artifact of {} too", writer_of(&self.topic))
    }
}

/// Artifacts of earlier stages, in the order of the pipeline whatever the order they were given in.
///
/// Where two hold the same topic, the later stage's is taken.
#[derive(Debug)]
pub struct Inputs {
    artifacts: Vec<Artifact>,
}

/// Reads and checks artifacts. Refuses any that is damaged, foreign or from a later version.
pub fn load_artifacts(paths: &[PathBuf]) -> anyhow::Result<Loaded<Inputs>> {
    let mut artifacts =
        paths.iter().map(|path| Artifact::open(path)).collect::<Result<Vec<_>, _>>().map_err(Refused::from)?;
    artifacts.sort_by(|a, b| (stage_order(a.stage()), a.digest()).cmp(&(stage_order(b.stage()), b.digest())));
    let digests = artifacts
        .iter()
        .map(|a| InputDigest { kind: a.stage().unwrap_or("artifact").to_owned(), digest: a.digest().to_owned() })
        .collect();
    let diagnoses = artifacts.iter().filter_map(|a| a.record::<DiagnosisV1>("/diagnosis").ok().flatten());
    let texts: Vec<String> = diagnoses.map(|d| format!("{}: {}", d.stage, d.reason)).collect();
    let diagnosis = (!texts.is_empty()).then(|| texts.join("; "));
    Ok(Loaded { input: Inputs { artifacts }, digests, diagnosis })
}

impl Inputs {
    /// The artifacts in the order of the pipeline.
    pub fn artifacts(&self) -> &[Artifact] {
        &self.artifacts
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
        let mut found = std::collections::BTreeMap::new();
        for artifact in &self.artifacts {
            for raw in artifact.records() {
                if let Some(rest) = raw.topic.strip_prefix(prefix)
                    && raw.schema == R::SCHEMA
                {
                    found.insert(rest.to_owned(), artifact.decode(raw).map_err(Refused::from)?);
                }
            }
        }
        Ok(found.into_iter().collect())
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
        let mut found = std::collections::BTreeMap::new();
        for artifact in &self.artifacts {
            found.extend(artifact.waves().iter().map(|(id, wave)| (id.as_str(), wave)));
        }
        found.into_iter()
    }

    /// The error for a topic that is needed and not there.
    pub fn missing(&self, topic: &str) -> anyhow::Error {
        let given: Vec<String> = self
            .artifacts
            .iter()
            .map(|a| format!("{} ({})", a.path().display(), a.stage().unwrap_or("no stage stated")))
            .collect();
        MissingTopic { topic: topic.to_owned(), given: given.join(", ") }.into()
    }
}
