//! The program in a folder: `3.mcap` goes in, `5.mcap` comes out.

use std::path::Path;
use std::process::{Command, Output};

use crumple_artifact::{Artifact, ArtifactBuilder, Compression, Provenance};

/// Writes an artifact as integration does.
pub fn write(builder: &ArtifactBuilder, path: &Path) {
    let provenance = Provenance::new("integrate", "0", "{}".to_owned(), Vec::new());
    builder.write(path, &provenance, Compression::None).unwrap();
}

pub fn run(folder: &Path, flags: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_crumple-parameter-solve"))
        .args([folder.join("3.mcap").as_os_str(), "-o".as_ref(), folder.join("5.mcap").as_os_str()])
        .args(flags)
        .output()
        .unwrap()
}

pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// What a run that is done wrote.
pub fn result(folder: &Path, output: &Output) -> Artifact {
    assert_eq!(output.status.code(), Some(0), "{}", said(output));
    Artifact::open(&folder.join("5.mcap")).unwrap()
}

/// The result of [`run`].
pub fn solved(folder: &Path, flags: &[&str]) -> Artifact {
    result(folder, &run(folder, flags))
}
