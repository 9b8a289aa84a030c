//! Which record a run folder held before.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use crumple_artifact::Artifact;
use crumple_artifact::records::TestV1;
use crumple_stage::say;

/// Says which record's run is replaced, if it is another one than that of the artifact now at `path`.
pub(crate) fn say_what_is_replaced(before: File, path: &Path, folder: &Path) {
    let old = Artifact::read(path, BufReader::new(before)).ok().as_ref().and_then(record_of);
    let new = Artifact::open(path).ok().as_ref().and_then(record_of);
    if let Some(old) = old.filter(|old| new.as_ref() != Some(old)) {
        say(format_args!(
            "note: replaces the run of {old} in {}: another record, or this one before a change \
             (just out=DIR run keeps both)",
            folder.display()
        ));
    }
}

/// `crash.csv (csv, content 0123456789ab)`; `None` where an artifact does not say what it was made from.
fn record_of(artifact: &Artifact) -> Option<String> {
    let source = artifact.record::<TestV1>("/test").ok()??.source;
    let digest = source.digest.rsplit(':').next().unwrap_or_default();
    let start = digest.get(..12)?;
    Some(format!("{} ({}, content {start})", source.name, source.format))
}
