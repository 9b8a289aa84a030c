//! Progress of work that takes over a second: a bar on a terminal, log lines elsewhere.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// Silence before the first sign; most work is over by then.
const PATIENCE: Duration = Duration::from_secs(1);
/// Time between log lines.
const LOG_EVERY: Duration = Duration::from_secs(5);

/// Progress of one piece of work.
#[derive(Debug)]
pub struct Progress {
    what: String,
    total: u64,
    done: u64,
    quiet: bool,
    started: Instant,
    last_line: Instant,
    bar: Option<ProgressBar>,
}

impl Progress {
    pub(crate) fn new(what: String, total: u64, quiet: bool) -> Self {
        let now = Instant::now();
        Self { what, total, done: 0, quiet, started: now, last_line: now, bar: None }
    }

    /// Says that `amount` more of the total is done.
    pub fn advance(&mut self, amount: u64) {
        self.done += amount;
        if self.quiet || self.started.elapsed() < PATIENCE {
            return;
        }
        if let Some(bar) = &self.bar {
            bar.set_position(self.done);
        } else if std::io::stderr().is_terminal() {
            let style = ProgressStyle::with_template("{msg} {wide_bar} {percent:>3} % {eta:>4}");
            let bar = ProgressBar::new(self.total).with_message(self.what.clone());
            self.bar = Some(match style {
                Ok(style) => bar.with_style(style),
                Err(_) => bar,
            });
        } else if self.last_line.elapsed() >= LOG_EVERY {
            self.last_line = Instant::now();
            eprintln!("{}: {} %", self.what, 100 * self.done / self.total.max(1));
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
