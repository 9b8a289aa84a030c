//! How far a fleet has come: a bar on a terminal, log lines elsewhere.

use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use crumple_stage::say;
use indicatif::{ProgressBar, ProgressStyle};

/// Time between log lines.
const LOG_EVERY: Duration = Duration::from_secs(10);

/// Progress of the runs.
#[derive(Debug)]
pub(crate) struct Progress {
    total: usize,
    done: usize,
    failed: usize,
    started: Instant,
    last_line: Instant,
    bar: Option<ProgressBar>,
    quiet: bool,
}

impl Progress {
    /// Of this many runs.
    pub(crate) fn new(total: usize, quiet: bool) -> Self {
        let bar = (!quiet && total > 0 && io::stderr().is_terminal()).then(|| {
            let bar = ProgressBar::new(total as u64);
            let style = "fleet {wide_bar} {pos} of {len}{msg}, {eta} left";
            ProgressStyle::with_template(style).map_or(bar.clone(), |style| bar.with_style(style))
        });
        let now = Instant::now();
        Self { total, done: 0, failed: 0, started: now, last_line: now, bar, quiet }
    }

    /// One more run has ended.
    pub(crate) fn advance(&mut self, has_result: bool) {
        self.done += 1;
        self.failed += usize::from(!has_result);
        if let Some(bar) = &self.bar {
            if self.failed > 0 {
                bar.set_message(format!(" ({} failed)", self.failed));
            }
            bar.set_position(self.done as u64);
        } else if !self.quiet && self.last_line.elapsed() >= LOG_EVERY {
            self.last_line = Instant::now();
            say(self.line());
        }
    }

    fn line(&self) -> String {
        let elapsed = self.started.elapsed();
        let left = elapsed.mul_f64((self.total - self.done) as f64 / self.done.max(1) as f64);
        format!(
            "fleet: {} of {} runs, {} failed, {:.1} a second, {} left",
            self.done,
            self.total,
            self.failed,
            self.done as f64 / elapsed.as_secs_f64().max(1e-3),
            in_words(left)
        )
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// A time as people say it.
pub(crate) fn in_words(time: Duration) -> String {
    match time.as_secs() {
        seconds @ 0..90 => format!("{seconds} s"),
        seconds @ 90..5400 => format!("{} min", seconds.div_ceil(60)),
        seconds => format!("{:.1} h", seconds as f64 / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_said_in_the_unit_that_fits() {
        let said = [59, 119, 7200].map(|seconds| in_words(Duration::from_secs(seconds)));
        assert_eq!(said, ["59 s", "2 min", "2.0 h"]);
    }
}
