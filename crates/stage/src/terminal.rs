//! Lines and progress on stderr.

use std::borrow::Cow;
use std::ffi::{OsStr, OsString};
use std::fmt::Display;
use std::fs;
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use anyhow::Context;
use console::Style;
use indicatif::{ProgressBar, ProgressStyle};

// Text laid out for the width of the terminal.

/// Columns where nobody says how many there are.
const USUAL: usize = 100;

/// A longer line is read with difficulty.
const WIDEST: usize = 110;

/// Narrower is no terminal.
const NARROWEST: usize = 40;

/// Columns for text on stderr.
pub fn columns() -> usize {
    // Where there are no terminals, nobody can be asked.
    #[cfg(any(unix, windows))]
    let size = terminal_size::terminal_size_of(io::stderr());
    #[cfg(not(any(unix, windows)))]
    let size = terminal_size::terminal_size();
    size.map_or(USUAL, |(columns, _)| usize::from(columns.0).clamp(NARROWEST, WIDEST))
}

/// Words in lines of at most `width` characters; a longer word has a line for itself. Blanks that do not break stay.
pub fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let mut length = 0;
    for word in text.split([' ', '\n']).filter(|word| !word.is_empty()) {
        let word_length = word.chars().count();
        match lines.last_mut() {
            Some(line) if length + 1 + word_length <= width => {
                line.push(' ');
                line.push_str(word);
                length += 1 + word_length;
            }
            _ => {
                lines.push(word.to_owned());
                length = word_length;
            }
        }
    }
    lines
}

/// A label in a column of its own, the text behind it wrapped.
pub fn labelled(label: &str, label_width: usize, text: &str, columns: usize) -> Vec<String> {
    let width = columns.saturating_sub(label_width).max(NARROWEST / 2);
    let lines = wrapped(text, width);
    let mut label = label;
    lines.iter().map(|line| format!("{:<label_width$}{line}", std::mem::take(&mut label))).collect()
}

// Progress of work that takes over a second: a bar on a terminal, log lines elsewhere.

/// Silence before the first sign; most work is over by then.
const PATIENCE: Duration = Duration::from_secs(1);

/// Time between log lines.
const LOG_EVERY: Duration = Duration::from_secs(5);

/// Whether the program that runs was told to show none; set before it reads anything.
static QUIET: AtomicBool = AtomicBool::new(false);

/// Whether progress of the program that runs is shown (`--quiet`).
pub fn be_quiet(quiet: bool) {
    QUIET.store(quiet, Ordering::Relaxed);
}

/// Progress of one piece of work.
#[derive(Debug)]
pub struct Progress {
    what: String,
    total: u64,
    done: u64,
    quiet: bool,
    started: Instant,
    last_line: Option<Instant>,
    bar: Option<ProgressBar>,
}

impl Progress {
    /// Of work with `total` parts; `what` is said with it.
    pub fn new(what: impl Into<String>, total: u64) -> Self {
        let quiet = QUIET.load(Ordering::Relaxed);
        Self { what: what.into(), total, done: 0, quiet, started: Instant::now(), last_line: None, bar: None }
    }

    /// Of reading a file, in bytes.
    pub fn of_reading(path: &Path) -> Self {
        let name = path.file_name().map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into_owned());
        Self::new(format!("reading {name}"), fs::metadata(path).map_or(0, |m| m.len()))
    }

    /// Says that `amount` more of the total is done.
    pub fn advance(&mut self, amount: u64) {
        self.done += amount;
        if self.quiet || self.started.elapsed() < PATIENCE {
            return;
        }
        if let Some(bar) = &self.bar {
            bar.set_position(self.done);
        } else if io::stderr().is_terminal() {
            let style = ProgressStyle::with_template("{msg} {wide_bar} {percent:>3} % {eta:>4}");
            let bar = ProgressBar::new(self.total).with_message(self.what.clone());
            self.bar = Some(match style {
                Ok(style) => bar.with_style(style),
                Err(_) => bar,
            });
        } else if self.last_line.is_none_or(|line| line.elapsed() >= LOG_EVERY) {
            self.last_line = Some(Instant::now());
            say(format_args!("{}: {} %", self.what, 100 * self.done / self.total.max(1)));
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

// Lines for people on stderr, and results for programs on stdout.

/// Prints a line to stderr. A reader that has closed the pipe is nobody's problem: the result is in the file.
pub fn say(line: impl Display) {
    let _ = writeln!(io::stderr().lock(), "{}", printable(&line.to_string()));
}

/// What part of a line is marked as, where a terminal has colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// May be used.
    Good,
    /// With care.
    Care,
    /// Not at all.
    Bad,
    /// What was asked for.
    Answer,
}

/// Text in the colour of a mark.
pub fn painted(text: &str, mark: Mark) -> String {
    let style = Style::new().bold().force_styling(true);
    let style = match mark {
        Mark::Good => style.green(),
        Mark::Care => style.yellow(),
        Mark::Bad => style.red(),
        Mark::Answer => style,
    };
    style.apply_to(text).to_string()
}

/// Whether stderr shows colours: a terminal, and neither `NO_COLOR` nor `CLICOLOR=0` is set.
pub fn stderr_has_colours() -> bool {
    console::colors_enabled_stderr()
}

/// The same of stdout.
pub fn stdout_has_colours() -> bool {
    console::colors_enabled()
}

/// Prints a line to stderr as it is: who paints parts of it has made it [`printable`].
pub fn say_as_it_is(line: &str) {
    let _ = writeln!(io::stderr().lock(), "{line}");
}

/// Prints a result to stdout. A reader that has seen enough closes the pipe; that is no error, a full disk is.
pub fn to_stdout(text: &[u8]) -> anyhow::Result<()> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other.context("cannot write to stdout"),
    }
}

/// Words of this call that would break a line, and names of files made of them, each with how it is spelled out.
static NAMES_WITH_LINE_ENDS: LazyLock<Vec<(String, String)>> = LazyLock::new(|| {
    let value = |word: OsString| lossy(&word).rsplit('=').next().map(PathBuf::from);
    let words = std::env::args_os().filter_map(value);
    let names = |word: PathBuf| [Some(word.as_os_str()), word.file_name(), word.file_stem()].map(|n| n.map(lossy));
    let spelled = |name: String| (name.clone(), name.replace('\n', "\\n"));
    // One of line ends alone is in every text.
    let is_one = |name: &String| name.contains('\n') && !name.trim().is_empty();
    words.flat_map(names).flatten().filter(is_one).map(spelled).collect()
});

fn lossy(text: &OsStr) -> String {
    text.to_string_lossy().into_owned()
}

/// The text with everything in it spelled out that a terminal would obey: control characters other than line ends and
/// tabs, marks that turn the direction of writing, and line ends of names that were typed. Titles and names come from
/// files.
pub fn printable(text: &str) -> Cow<'_, str> {
    let mut text = Cow::Borrowed(text);
    for (name, spelled) in &*NAMES_WITH_LINE_ENDS {
        text = text.replace(name, spelled).into();
    }
    let commands = |c: char| {
        (c.is_control() && !matches!(c, '\n' | '\t')) || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    if !text.contains(commands) {
        return text;
    }
    text.chars().map(|c| if commands(c) { c.escape_default().to_string() } else { c.to_string() }).collect()
}

#[cfg(test)]
mod tests {

    use super::*;

    #[test]
    fn lines_are_full_and_never_too_long() {
        assert_eq!(wrapped("one two three four", 9), ["one two", "three", "four"]);
        assert_eq!(wrapped("a unbreakable\u{a0}unit b", 5), ["a", "unbreakable\u{a0}unit", "b"]);
        assert_eq!(labelled("peak", 6, "45.4 g at 63 ms", 28), ["peak  45.4 g at 63 ms"]);
        assert_eq!(
            labelled("peak", 6, "45.4 g at 63 ms, and more of it", 28),
            ["peak  45.4 g at 63 ms, and", "      more of it"]
        );
    }

    #[test]
    fn what_a_terminal_would_obey_is_spelled_out() {
        assert_eq!(printable("a \u{1b}[31mred\u{7}\u{9b}2J\r"), "a \\u{1b}[31mred\\u{7}\\u{9b}2J\\r");
        assert_eq!(printable("\u{202e}txt.exe"), "\\u{202e}txt.exe");
        assert!(matches!(printable("two lines\n\tof Straße 9,81 m/s²"), Cow::Borrowed(_)));
    }
}
