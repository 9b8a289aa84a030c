//! The command line of the programs.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use crumple_stage::{DisplayFlag, Usage};

use crate::program::NamedPrograms;

// The command line of `crumple-run`.

/// Runs pipelines on many records, each into a run folder of its own, and makes tables and a page of the runs.
///
/// The recipe `fleet` of the justfile calls it. A run that is up to date (record, pipeline, programs) is left alone;
/// one that fails is a row with its error and exit code. What was finished stays finished, however the fleet ends.
#[derive(Debug, clap::Parser)]
#[command(
    name = "crumple-fleet",
    version,
    after_help = "Exit codes: 0 every record has its row, failed ones too; 1 unforeseen failure, 2 usage, 3 no record \
                  to be found, or none with a result."
)]
pub struct Options {
    /// Records: folders with all below them, lists of paths (@list.txt), patterns ('tests/**/*.csv'), files.
    #[arg(required = true, value_name = "RECORDS")]
    pub(crate) inputs: Vec<String>,

    /// Pipelines to run on each record: names below `pipelines/` or files [default: that of --pipeline].
    #[arg(long, value_name = "NAME|FILE", value_delimiter = ',')]
    pub(crate) pipelines: Vec<String>,

    /// Option of a stage, with the values to go through: `parameter-solve.front_mass_fraction=0.15,0.25`. Several are
    /// combined, each value with each.
    #[arg(long = "set", value_name = "STAGE.KEY=VALUE,...")]
    pub(crate) sweeps: Vec<Sweep>,

    /// Runs at a time [default: one a processor core].
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) jobs: Option<u16>,

    /// Name of the fleet: its folder is runs/fleet/NAME [default: that of the folder or the list].
    #[arg(long, value_name = "NAME")]
    pub(crate) name: Option<String>,

    /// Folder of the fleet, instead of one below `runs/fleet/` of the project.
    #[arg(short = 'o', long, alias = "output", value_name = "FOLDER", default_value = "", allow_hyphen_values = true)]
    #[arg(overrides_with = "out")]
    pub(crate) out: OsString,

    /// Part K of N of the records, for a cluster; the name of a record decides its part. Writes no tables.
    #[arg(long, value_name = "K/N")]
    pub(crate) batch: Option<Batch>,

    /// Only write tables and page, of the runs that are up to date; the others are named as missing.
    #[arg(long, conflicts_with = "batch")]
    pub(crate) tables_only: bool,

    /// Compression of the artifacts: zstd makes them smaller and a run slower.
    #[arg(long, value_name = "KIND", value_parser = ["zstd"])]
    pub(crate) compress: Option<String>,

    /// Put style and scripts into the page of every run, so that each page can be sent without others; else they share
    /// the files in `page/`.
    #[arg(long)]
    pub(crate) whole_pages: bool,

    /// No line about the runs on stderr.
    #[arg(short, long)]
    pub(crate) quiet: bool,

    /// Compute even what is up to date.
    #[arg(long)]
    pub(crate) force: bool,

    /// Folder with `pipelines/` and `runs/`.
    #[arg(long, value_name = "FOLDER", default_value = ".")]
    pub(crate) project: PathBuf,

    /// Pipeline where --pipelines names none.
    #[arg(
        long,
        value_name = "NAME|FILE",
        default_value = "default",
        allow_hyphen_values = true,
        overrides_with = "pipeline"
    )]
    pub(crate) pipeline: String,

    /// Flags for every stage, as one would type them.
    #[arg(long, value_name = "TEXT", default_value = "", allow_hyphen_values = true)]
    pub(crate) flags: String,

    #[command(flatten)]
    pub(crate) display: DisplayFlag,

    #[command(flatten)]
    pub(crate) programs: NamedPrograms,
}

/// Folder of a fleet with the style and the scripts of its pages.
pub(crate) const PAGE_FILES: &str = "page";

/// One part of a fleet that is run in several.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Batch {
    /// Number of the part, from 1.
    pub(crate) part: u64,
    /// Number of parts.
    pub(crate) of: u64,
}

impl FromStr for Batch {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').and_then(|(part, of)| Some((part.parse().ok()?, of.parse().ok()?)));
        match numbers {
            Some((part, of)) if 1 <= part && part <= of => Ok(Self { part, of }),
            _ => Err("a part is K/N with K from 1 to N, for example 3/20".to_owned()),
        }
    }
}

impl Batch {
    /// Whether a record of this name is in the part: the same whatever other records there are.
    pub(crate) fn holds(self, identity: &str) -> bool {
        let digest = blake3::hash(identity.as_bytes());
        let start = digest.as_bytes()[..8].iter().fold(0_u64, |number, byte| number << 8 | u64::from(*byte));
        start % self.of == self.part - 1
    }
}

impl Options {
    /// Flags for every stage.
    pub(crate) fn flags(&self) -> String {
        let compress = self.compress.as_ref().map_or_else(String::new, |kind| format!(" --compress {kind}"));
        format!("{}{compress}", self.flags)
    }

    /// Flags of the report of a run in this folder below that of the fleet.
    pub(crate) fn report_flags(&self, folder: &str) -> String {
        let up = "../".repeat(Path::new(folder).components().count());
        let shared = if self.whole_pages { Vec::new() } else { vec![format!("--shared {up}{PAGE_FILES}")] };
        [shared, self.display.words()].concat().join(" ")
    }

    /// The pipelines, as they are typed.
    pub(crate) fn pipelines(&self) -> &[String] {
        if self.pipelines.is_empty() { std::slice::from_ref(&self.pipeline) } else { &self.pipelines }
    }

    /// The folder of the fleet.
    pub(crate) fn folder(&self) -> Result<PathBuf, Usage> {
        if !self.out.is_empty() {
            return Ok(PathBuf::from(&self.out));
        }
        let name = match &self.name {
            Some(name) if name.is_empty() || name.contains('/') || name.starts_with('.') => {
                return Err(
                    Usage::new(format!("--name {name:?} is no name of a folder")).hint("a name without slashes")
                );
            }
            Some(name) => name.clone(),
            None => self.inputs.first().and_then(|word| name_of(word)).ok_or_else(|| {
                Usage::new(format!("{} gives the fleet no name", self.inputs.join(" "))).hint("say --name NAME")
            })?,
        };
        Ok(self.project.join("runs/fleet").join(name))
    }
}

/// The name that a word gives to the fleet: of the folder, the list, or the folder of a pattern.
fn name_of(word: &str) -> Option<String> {
    let path = word.strip_prefix('@').unwrap_or(word);
    let literal = match path.find(['*', '?', '[']) {
        Some(at) => path[..at].rsplit_once('/').map_or(".", |(folder, _)| folder),
        None => path,
    };
    let path = Path::new(literal);
    let full = if path.file_name().is_some() { path.to_owned() } else { path.canonicalize().ok()? };
    let name = if full.is_dir() { full.file_name()? } else { full.file_stem()? };
    Some(name.to_string_lossy().into_owned())
}

// Options of stages that a fleet goes through.

/// An option of a stage with the values to go through.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Sweep {
    /// `parameter-solve.front_mass_fraction`.
    pub(crate) key: String,
    /// Values as they are typed.
    pub(crate) values: Vec<String>,
}

impl FromStr for Sweep {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (key, values) = text.split_once('=').ok_or("a value is missing: STAGE.KEY=VALUE,...")?;
        let has_stage = key.split_once('.').is_some_and(|(stage, key)| !stage.is_empty() && !key.is_empty());
        if !has_stage {
            return Err(format!("{key:?} names no stage: STAGE.KEY=VALUE,..., e.g. filter.cfc=60,180"));
        }
        let values = split(values);
        if values.iter().any(String::is_empty) {
            return Err(format!("a value of {key} is empty"));
        }
        Ok(Self { key: key.to_owned(), values })
    }
}

/// Values between commas; those inside brackets and quotes belong to a value.
fn split(text: &str) -> Vec<String> {
    let mut values = vec![String::new()];
    let (mut depth, mut quote) = (0_i32, None);
    for c in text.chars() {
        match (c, quote) {
            ('"' | '\'', None) => quote = Some(c),
            (_, Some(open)) if c == open => quote = None,
            ('[', None) => depth += 1,
            (']', None) => depth -= 1,
            (',', None) if depth <= 0 => {
                values.push(String::new());
                continue;
            }
            _ => {}
        }
        if let Some(value) = values.last_mut() {
            value.push(c);
        }
    }
    values.iter().map(|value| value.trim().to_owned()).collect()
}

/// All combinations of the values, the last option changing first; one without options where there are none.
pub(crate) fn combinations(sweeps: &[Sweep]) -> Vec<Vec<String>> {
    sweeps.iter().fold(vec![Vec::new()], |all, sweep| {
        let with = |one: &Vec<String>| {
            let one = one.clone();
            sweep
                .values
                .iter()
                .map(move |value| one.iter().cloned().chain([format!("{}={value}", sweep.key)]).collect::<Vec<_>>())
                .collect::<Vec<_>>()
        };
        all.iter().flat_map(with).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    fn options(words: &[&str]) -> Options {
        Options::parse_from([&["fleet", "--project", "/p"], words].concat())
    }

    #[test]
    fn a_fleet_is_named_after_its_records() {
        let folder = |words: &[&str]| options(words).folder().map(|path| path.display().to_string());
        assert_eq!(folder(&["tests/ncap/"]).unwrap(), "/p/runs/fleet/ncap");
        assert_eq!(folder(&["@lists/small.txt"]).unwrap(), "/p/runs/fleet/small");
        assert_eq!(folder(&["tests/*.csv"]).unwrap(), "/p/runs/fleet/tests");
        assert_eq!(folder(&["a", "b", "--name", "both"]).unwrap(), "/p/runs/fleet/both");
        assert_eq!(folder(&["a", "--out", "/x"]).unwrap(), "/x");
        assert!(folder(&["a", "--name", "b/c"]).is_err());
    }

    #[test]
    fn reports_know_the_way_to_the_files_they_share() {
        let flags = |words: &[&str]| options(words).report_flags("runs/a/papers/civic");
        assert_eq!(flags(&["a"]), "--shared ../../../../page");
        assert_eq!(flags(&["a", "--whole-pages"]), "");
    }

    #[test]
    fn the_parts_of_a_fleet_hold_each_record_once() {
        let parts: Vec<Batch> = (1..=7).map(|part| Batch { part, of: 7 }).collect();
        for record in 0..100 {
            let name = format!("tests/{record}.csv");
            assert_eq!(parts.iter().filter(|part| part.holds(&name)).count(), 1);
        }
        assert!("0/3".parse::<Batch>().is_err() && "4/3".parse::<Batch>().is_err() && "3".parse::<Batch>().is_err());
    }

    #[test]
    fn every_value_meets_every_other() {
        let sweeps: Vec<Sweep> =
            ["filter.cfc=60,180", "identify.methods=[\"era\",\"okid\"]"].map(|text| text.parse().unwrap()).into();
        let all = combinations(&sweeps);
        let methods = "identify.methods=[\"era\",\"okid\"]";
        assert_eq!(all, [["filter.cfc=60", methods], ["filter.cfc=180", methods]]);
        assert_eq!(combinations(&[]), [Vec::<String>::new()]);
    }

    #[test]
    fn an_option_needs_a_stage_and_values() {
        for text in ["cfc=60", "filter.cfc", "filter.cfc=", "filter.cfc=60,,180", ".cfc=60"] {
            assert!(text.parse::<Sweep>().is_err(), "{text}");
        }
    }
}
