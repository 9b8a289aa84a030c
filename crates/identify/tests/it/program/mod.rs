//! The program on waveforms that a test made.

use std::path::{Path, PathBuf};
use std::process::Command;

use crumple_artifact::records::TestV1;
use crumple_artifact::{ArtifactBuilder, Compression, Provenance};
use crumple_signal::{Channel, QuantityKind, Sampled, TestDescription};

/// A name, a quantity and samples.
pub type Wave<'a> = (&'a str, QuantityKind, Vec<f64>);

/// Waveforms sampled together from `t0_s` on, and the test whose channels they are.
pub fn made(channels: Vec<Channel>, t0_s: f64, dt_s: f64, waves: &[Wave]) -> ArtifactBuilder {
    let test = TestDescription { title: "made".to_owned(), channels, ..TestDescription::default() };
    let mut builder = ArtifactBuilder::new();
    builder.put("/test", &TestV1::from(&test)).unwrap();
    for (id, quantity, samples) in waves {
        builder.wave(id, *quantity, Sampled::new(t0_s, dt_s, samples.clone()).unwrap()).unwrap();
    }
    builder
}

/// Writes them where a stage of this name does, and returns the path.
pub fn written(builder: &ArtifactBuilder, folder: &Path, stage: &str) -> PathBuf {
    let path = folder.join(format!("{stage}.mcap"));
    builder.write(&path, &Provenance::new(stage, "0", "{}".to_owned(), Vec::new()), Compression::None).unwrap();
    path
}

/// How a run ended and what it said.
pub struct Run {
    pub code: Option<i32>,
    pub said: String,
}

/// Runs `crumple-identify`.
pub fn identify(input: &Path, output: &Path, flags: &[&str]) -> Run {
    let mut command = Command::new(env!("CARGO_BIN_EXE_crumple-identify"));
    let run = command.arg(input).arg("-o").arg(output).args(flags).output().unwrap();
    Run { code: run.status.code(), said: String::from_utf8_lossy(&run.stderr).into_owned() }
}
