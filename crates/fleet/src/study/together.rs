//! One model for the tests of a vehicle, by `crumple-together`.

use std::collections::HashMap;
use std::ffi::OsString;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::Context;
use crumple_report::SummaryCandidate;
use crumple_run::own_program;
use serde::Deserialize;

use crate::runs::digest_of_programs;
use crate::runs::{Ended, digest_of_summary};
use crate::study::left_out::LeftOut;
use crate::study::options::StudyOptions;
use crate::study::vehicles::Vehicle;

/// Folder of the joint models in that of the fleet.
pub(crate) const STUDY: &str = "study";

/// `summary.json` of a joint result, as far as a study needs it.
#[derive(Debug, Deserialize)]
pub(crate) struct JointSummary {
    pub(crate) candidates: Vec<SummaryCandidate>,
    #[serde(default)]
    pub(crate) recommended: Option<String>,
    #[serde(default)]
    pub(crate) leave_one_out: Vec<LeftOut>,
}

impl JointSummary {
    /// A parameter of the joint Kelvin model.
    pub(crate) fn kelvin(&self, name: &str) -> Option<f64> {
        self.candidates.iter().find(|candidate| candidate.model == "kelvin")?.parameters.get(name).copied()
    }
}

/// Joint fits, those that are up to date left alone.
pub(crate) struct JointFits<'a> {
    options: &'a StudyOptions,
    fleet: &'a Path,
    programs: String,
    known: &'a HashMap<(String, String), Ended>,
}

impl<'a> JointFits<'a> {
    /// Of a fleet with what its journals know.
    pub(crate) fn new(
        options: &'a StudyOptions,
        fleet: &'a Path,
        known: &'a HashMap<(String, String), Ended>,
    ) -> anyhow::Result<Self> {
        let programs = digest_of_programs().context("cannot read the programs")?;
        Ok(Self { options, fleet, programs, known })
    }

    /// Fits one model to the tests of a vehicle, unless that was done with these tests and programs.
    pub(crate) fn fit(&self, vehicle: &Vehicle<'_>) -> anyhow::Result<Ended> {
        let mut hasher = blake3::Hasher::new();
        for row in &vehicle.tests {
            hasher.update(row.ended.summary.as_deref().unwrap_or_default().as_bytes());
        }
        hasher.update(self.programs.as_bytes());
        let folder = format!("{STUDY}/{}", folder_name(&vehicle.name));
        let key = hasher.finalize().to_hex().to_string();
        match self.known.get(&(folder.clone(), key.clone())) {
            Some(ended) if ended.stands(self.fleet) => Ok(ended.clone()),
            _ => self.fit_anew(vehicle, key, folder),
        }
    }

    fn fit_anew(&self, vehicle: &Vehicle<'_>, key: String, folder: String) -> anyhow::Result<Ended> {
        let path = self.fleet.join(&folder);
        let force = if path.exists() { " --force" } else { "" };
        let mut arguments: Vec<OsString> = vec!["--project".into(), self.options.fleet.project.clone().into()];
        arguments.extend(["--pipeline".into(), OsString::from(&self.options.fleet.pipelines()[0])]);
        arguments.extend(["--out".into(), OsString::from(&path)]);
        arguments.extend(["--flags".into(), format!("-q{force}").into(), "--".into()]);
        arguments.extend(vehicle.tests.iter().map(|row| OsString::from(self.fleet.join(&row.run.folder))));
        let program = own_program("together");
        let output = Command::new(&program)
            .args(arguments)
            .env("RAYON_NUM_THREADS", "1")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .output()
            .with_context(|| format!("cannot start {}", program.display()))?;
        let exit_code = output.status.code().unwrap_or_else(|| 128 + output.status.signal().unwrap_or_default());
        let said = String::from_utf8_lossy(&output.stderr);
        let error = if exit_code == 0 { "" } else { said.lines().next().unwrap_or_default() };
        let summary = (exit_code == 0).then(|| digest_of_summary(&path)).flatten();
        Ok(Ended { key, folder, exit_code, error: error.to_owned(), summary, seconds: 0.0 })
    }
}

/// What a joint fit found.
pub(crate) fn joint_summary(fleet: &Path, ended: &Ended) -> anyhow::Result<JointSummary> {
    let path = fleet.join(&ended.folder).join("summary.json");
    let bytes = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
    serde_json::from_slice(&bytes).with_context(|| format!("{} is no joint summary", path.display()))
}

/// A vehicle as the name of a folder: two vehicles never share one.
fn folder_name(vehicle: &str) -> String {
    let plain: String = vehicle
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' })
        .take(60)
        .collect();
    format!("{plain}-{}", &blake3::hash(vehicle.as_bytes()).to_hex()[..8])
}
