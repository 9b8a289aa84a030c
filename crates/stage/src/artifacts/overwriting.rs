//! What no output may replace.

use std::path::{Path, PathBuf};

use anyhow::Context;
use crumple_artifact::OutputKind;

use crate::artifacts::several_tests::path_of;
use crate::error::Usage;

/// Refuses an output that is an input too, or a file that exists and is of another kind: it would be lost.
///
/// Asked before anything is computed; the writing itself refuses other kinds once more.
pub fn refuse_to_overwrite(output: &Path, kind: OutputKind, inputs: &[PathBuf]) -> anyhow::Result<()> {
    let Ok(existing) = output.canonicalize() else { return Ok(()) };
    let problem = if inputs.iter().any(|input| path_of(input).canonicalize().is_ok_and(|path| path == existing)) {
        "is an input too"
    } else {
        let problem = kind.problem_at(&existing).with_context(|| format!("cannot read {}", output.display()))?;
        match problem {
            Some(problem) => problem,
            None => return Ok(()),
        }
    };
    Err(Usage::new(format!("the output {} {problem}", output.display())).hint("give it another name").into())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn inputs_and_files_of_other_kinds_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, content: &[u8]| {
            let path = folder.path().join(name);
            fs::write(&path, content).unwrap();
            path
        };
        let old = write("2-filter.mcap", b"\x89MCAP0\r\n crumple.Test.v1");
        let input = write("1-ingest.mcap", b"\x89MCAP0\r\n crumple.Test.v1");
        let record = write("crash.csv", b"time_s,accel_g\n");
        let refused = |output: &Path| {
            let asked = refuse_to_overwrite(output, OutputKind::Artifact, std::slice::from_ref(&input));
            asked.err().map(|error| error.to_string().replace(&folder.path().display().to_string(), "F"))
        };
        assert_eq!(refused(&old), None);
        assert_eq!(refused(&folder.path().join("new.mcap")), None);
        assert_eq!(refused(&input).unwrap(), "the output F/1-ingest.mcap is an input too");
        // by another way to it
        assert_eq!(
            refused(&folder.path().join(".").join("1-ingest.mcap")).unwrap(),
            "the output F/./1-ingest.mcap is an input too"
        );
        assert_eq!(refused(&record).unwrap(), "the output F/crash.csv exists and is no artifact of this project");
        assert_eq!(refused(folder.path()).unwrap(), "the output F exists and is no regular file");
    }
}
