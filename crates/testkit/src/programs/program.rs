//! A stage's program, run as the tests of its crate run it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A program that makes one artifact of another.
#[derive(Debug, Clone, Copy)]
pub struct Program {
    /// Path of the executable: `env!("CARGO_BIN_EXE_...")`.
    pub exe: &'static str,
    /// Name of the artifact it writes, beside its input.
    pub output: &'static str,
}

impl Program {
    /// Runs it and returns what it said.
    pub fn run(&self, input: &Path, flags: &[&str]) -> Output {
        Command::new(self.exe)
            .arg(input)
            .arg("-o")
            .arg(input.with_file_name(self.output))
            .args(flags)
            .output()
            .unwrap_or_else(|error| panic!("{}: {error}", self.exe))
    }

    /// Runs it, fails the test with what it said unless it ended well, and returns the path of what it wrote.
    pub fn written(&self, input: &Path, flags: &[&str]) -> PathBuf {
        let output = self.run(input, flags);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        input.with_file_name(self.output)
    }
}
