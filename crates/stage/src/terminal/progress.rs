//! Progress of work that takes over a second: a bar on a terminal, log lines elsewhere.

use std::fs;
use std::io::{self, IsTerminal};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::terminal::say::say;

/// Silence before the first sign; most work is over by then.
const PATIENCE: Duration = Duration::from_secs(1);
/// Time between log lines.
const LOG_EVERY: Duration = Duration::from_secs(5);

/// Whether the process was told to show none; set before anything is read, never again.
static QUIET: AtomicBool = AtomicBool::new(false);

/// No progress of this process is shown (`--quiet`).
pub fn be_quiet() {
    QUIET.store(true, Ordering::Relaxed);
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
