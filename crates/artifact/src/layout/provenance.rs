//! Where an artifact came from: the stage, its resolved configuration and the digests of its inputs.

use std::collections::BTreeMap;

/// Version of the artifact format that this crate writes and the newest it reads.
pub(crate) const FORMAT_VERSION: u32 = 1;

/// Name of the metadata record.
pub(crate) const PROVENANCE: &str = "provenance";

/// One input of a stage.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct InputDigest {
    /// What it is: the stage that wrote it, or the format of a raw file.
    pub kind: String,
    /// Digest of its content, `blake3:<hex>`.
    pub digest: String,
}

/// Who made an artifact, from what, with which settings. No clock, host, user or path.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Provenance {
    /// The stage, e.g. `filter`.
    pub stage: String,
    /// Its version.
    pub stage_version: String,
    /// Its resolved configuration as canonical JSON: sorted keys, no blanks.
    pub config_json: String,
    /// Its inputs, sorted by kind and digest.
    pub inputs: Vec<InputDigest>,
    /// Digest of the sources that the program was built of; empty where it does not say so.
    pub build: String,
    /// What put the artifact together, where that was not the stage itself: `crumple-artifact pack`. Empty else.
    pub made_by: String,
}

impl Provenance {
    /// Sorts the inputs: the order on the command line is not part of what was done.
    pub fn new(stage: &str, stage_version: &str, config_json: String, mut inputs: Vec<InputDigest>) -> Self {
        inputs.sort();
        Self {
            stage: stage.to_owned(),
            stage_version: stage_version.to_owned(),
            config_json,
            inputs,
            build: String::new(),
            made_by: String::new(),
        }
    }

    /// With the digest of the sources that the program was built of.
    #[must_use]
    pub fn with_build(self, build: &str) -> Self {
        Self { build: build.to_owned(), ..self }
    }

    /// The same stated of what another program put together: no result of the stage.
    #[must_use]
    pub fn made_by(self, program: &str) -> Self {
        Self { build: String::new(), made_by: program.to_owned(), ..self }
    }

    pub(crate) fn to_metadata(&self) -> BTreeMap<String, String> {
        let mut map = BTreeMap::from([
            ("format".to_owned(), FORMAT_VERSION.to_string()),
            ("stage".to_owned(), self.stage.clone()),
            ("stage_version".to_owned(), self.stage_version.clone()),
            ("config_json".to_owned(), self.config_json.clone()),
        ]);
        for (key, value) in [("build", &self.build), ("made_by", &self.made_by)] {
            if !value.is_empty() {
                map.insert(key.to_owned(), value.clone());
            }
        }
        for (k, input) in self.inputs.iter().enumerate() {
            map.insert(format!("input.{k:03}.kind"), input.kind.clone());
            map.insert(format!("input.{k:03}.digest"), input.digest.clone());
        }
        map
    }

    /// Reads the metadata record; fields that a foreign writer left out are empty.
    pub(crate) fn from_metadata(map: &BTreeMap<String, String>) -> Self {
        let text = |key: &str| map.get(key).cloned().unwrap_or_default();
        let inputs = map
            .iter()
            .filter_map(|(key, kind)| {
                let name = key.strip_prefix("input.")?.strip_suffix(".kind")?;
                Some(InputDigest { kind: kind.clone(), digest: text(&format!("input.{name}.digest")) })
            })
            .collect();
        Self {
            stage: text("stage"),
            stage_version: text("stage_version"),
            config_json: text("config_json"),
            inputs,
            build: text("build"),
            made_by: text("made_by"),
        }
    }
}
