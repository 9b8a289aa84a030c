//! Any bytes as an artifact: it is read or refused, and never panics.
#![no_main]

use std::path::Path;

use crumple_artifact::Artifact;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = Artifact::read(Path::new("artifact"), bytes);
});
