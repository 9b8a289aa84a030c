//! Own models: files that `models` names beside the families.

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use crumple_lumped::{ModelKind, OwnLaw};
use crumple_lumped_fit::SolveSettings;
use crumple_stage::Usage;
use serde::Serialize;

use crate::stage::options::Named;

/// How the name of a model file ends.
const ENDING: &str = ".toml";
/// Where a person finds a file to start from.
const START_FROM: &str = "docs/how-to/own-model.md has a file to start from";

/// A model asked for: a family, or the file of an own model.
#[derive(Debug, Clone, PartialEq)]
pub enum AskedModel {
    Family(ModelKind),
    File(PathBuf),
}

impl FromStr for AskedModel {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text.ends_with(ENDING) {
            return Ok(Self::File(PathBuf::from(text)));
        }
        text.parse().map(Self::Family).map_err(|error: crumple_lumped::LumpedError| error.to_string())
    }
}

impl fmt::Display for AskedModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Family(kind) => kind.fmt(f),
            Self::File(path) => path.display().fmt(f),
        }
    }
}

/// The parser of the flag: a file, or a family, of which a mistyped one is answered with the nearest.
#[derive(Debug, Clone)]
pub struct ModelParser;

impl ModelParser {
    fn families() -> PossibleValuesParser {
        PossibleValuesParser::new(SolveSettings::all_models().iter().map(|model| model.name()))
    }
}

impl TypedValueParser for ModelParser {
    type Value = Named<AskedModel>;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        value: &std::ffi::OsStr,
    ) -> Result<Self::Value, clap::Error> {
        if Path::new(value).extension().is_some_and(|ending| ending == "toml") {
            return Ok(Named(AskedModel::File(PathBuf::from(value))));
        }
        Self::families().try_map(|name| name.parse()).parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        let values: Vec<PossibleValue> = Self::families().possible_values()?.collect();
        Some(Box::new(values.into_iter()))
    }
}

/// An own model to be fitted.
#[derive(Debug, Clone)]
pub struct StatedLaw {
    pub name: String,
    pub law: Arc<OwnLaw>,
}

impl Serialize for StatedLaw {
    /// Part of the file format: name and text, from which the law is read again.
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        (&self.name, self.law.text()).serialize(serializer)
    }
}

/// Reads the files among the models asked for; a path counts from the working folder. Errors: a file that cannot be
/// read or holds no law, two of one name.
pub fn read_laws(asked: &[Named<AskedModel>]) -> anyhow::Result<Vec<StatedLaw>> {
    let mut laws: Vec<StatedLaw> = Vec::new();
    for Named(model) in asked {
        let AskedModel::File(path) = model else { continue };
        let text = std::fs::read_to_string(path).map_err(|error| {
            Usage::new(format!("cannot read the model file {}: {error}", path.display()))
                .hint("give its path from the working folder")
        })?;
        let law = OwnLaw::read(&text)
            .map_err(|mistake| Usage::new(format!("{}, {mistake}", path.display())).hint(START_FROM))?;
        let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        let name = topic(law.name().unwrap_or(&stem));
        if laws.iter().any(|other| other.name == name) {
            let problem = format!("two model files are named {name:?}");
            return Err(Usage::new(problem).hint("give one of them another name = \"...\"").into());
        }
        laws.push(StatedLaw { name, law: Arc::new(law) });
    }
    Ok(laws)
}

/// A name as it may stand in a topic.
fn topic(name: &str) -> String {
    let letter = |c: char| if c.is_ascii_alphanumeric() || c == '_' { c } else { '-' };
    name.trim().chars().map(letter).collect()
}
