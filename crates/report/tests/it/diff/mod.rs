//! `crumple-diff` on artifacts and runs that a test made.

mod accepted;
mod cli;
mod prints;
mod values;

use std::path::{Path, PathBuf};
use std::process::Command;

use crumple_artifact::records::{MetricV1, MetricsV2, NotesV1};
use crumple_artifact::{ArtifactBuilder, Compression, Provenance};
use crumple_signal::{QuantityKind, Sampled};

/// How a run ended and what it said.
pub struct Outcome {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

/// Runs `crumple-diff` in a folder; where no tolerance is named, that of rounding.
pub fn diff(folder: &Path, args: &[&str]) -> Outcome {
    let named = ["--engineering", "--rounding", "--exact", "--bits"];
    let base: &[&str] = if args.iter().any(|arg| named.contains(arg)) { &[] } else { &["--rounding"] };
    let mut command = Command::new(env!("CARGO_BIN_EXE_crumple-diff"));
    let output = command.args(args).args(base).current_dir(folder).output().unwrap();
    Outcome {
        code: output.status.code().unwrap(),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

/// What an artifact of these tests is made of.
pub struct Made {
    pub samples: Vec<f64>,
    pub peak: f64,
    pub olc: f64,
    pub notes: Vec<String>,
    pub cfc: u16,
    pub compression: Compression,
}

impl Default for Made {
    fn default() -> Self {
        Self {
            // Exact in binary, so that the numbers in messages are the same everywhere.
            samples: (0..200).map(|k| f64::from(k % 40) * 2.5 - 50.0).collect(),
            peak: 445.75,
            olc: 255.0,
            notes: vec!["zero level 0.01 m/s^2".into()],
            cfc: 60,
            compression: Compression::None,
        }
    }
}

fn metric(name: &str, value: f64) -> MetricV1 {
    let text = String::new;
    MetricV1 {
        name: name.into(),
        value: Some(value),
        unit: "m/s^2".into(),
        channel: "93".into(),
        definition: text(),
        ..MetricV1::default()
    }
}

impl Made {
    pub fn metrics(&self) -> MetricsV2 {
        MetricsV2 { metrics: vec![metric("peak_acceleration", self.peak), metric("olc", self.olc)] }
    }

    pub fn record_notes(&self) -> NotesV1 {
        NotesV1 { stage: "integrate".into(), notes: self.notes.clone() }
    }

    pub fn write(&self, path: &Path) -> PathBuf {
        let mut builder = ArtifactBuilder::new();
        builder.put("/metrics", &self.metrics()).unwrap();
        builder.put("/notes", &self.record_notes()).unwrap();
        let sampled = Sampled::new(-0.01, 1e-4, self.samples.clone()).unwrap();
        builder.wave("93", QuantityKind::Acceleration, sampled).unwrap();
        let provenance = Provenance::new("integrate", "0.1.0", format!(r#"{{"cfc":{}}}"#, self.cfc), Vec::new());
        builder.write(path, &provenance, self.compression).unwrap();
        path.to_owned()
    }
}

/// `a.mcap` is the default; `b.mcap` is as told.
pub fn pair(b: &Made) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    Made::default().write(&folder.path().join("a.mcap"));
    b.write(&folder.path().join("b.mcap"));
    folder
}
