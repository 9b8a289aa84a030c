//! Lines for people on stderr.

use std::fmt::Display;
use std::io::Write;

/// Prints a line to stderr. A reader that has closed the pipe is nobody's problem: the result is in the file.
pub fn say(line: impl Display) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}
