//! Lines for people on stderr, and results for programs on stdout.

use std::borrow::Cow;
use std::fmt::Display;
use std::io::{self, Write};

use anyhow::Context;

/// Prints a line to stderr. A reader that has closed the pipe is nobody's problem: the result is in the file.
pub fn say(line: impl Display) {
    let _ = writeln!(io::stderr().lock(), "{}", printable(&line.to_string()));
}

/// Prints a result to stdout. A reader that has seen enough closes the pipe; that is no error, a full disk is.
pub fn to_stdout(text: &[u8]) -> anyhow::Result<()> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other.context("cannot write to stdout"),
    }
}

/// The text with everything in it spelled out that a terminal would obey: control characters other than line ends and
/// tabs, and marks that turn the direction of writing. Titles and names come from files.
pub fn printable(text: &str) -> Cow<'_, str> {
    let commands = |c: char| {
        (c.is_control() && !matches!(c, '\n' | '\t')) || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    if !text.contains(commands) {
        return Cow::Borrowed(text);
    }
    text.chars().map(|c| if commands(c) { c.escape_default().to_string() } else { c.to_string() }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_would_obey_is_spelled_out() {
        assert_eq!(printable("a \u{1b}[31mred\u{7}\u{9b}2J\r"), "a \\u{1b}[31mred\\u{7}\\u{9b}2J\\r");
        assert_eq!(printable("\u{202e}txt.exe"), "\\u{202e}txt.exe");
        assert!(matches!(printable("two lines\n\tof Straße 9,81 m/s²"), Cow::Borrowed(_)));
    }
}
