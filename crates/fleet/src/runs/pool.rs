//! Runs side by side.

use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;

use crate::command::options::Options;
use crate::runs::journal::{Ended, Journal};
use crate::runs::plan::Run;
use crate::runs::progress::Progress;
use crate::runs::start::run_record;

/// Runs at a time, where none is typed.
pub(crate) fn jobs(options: &Options) -> usize {
    options.jobs.map_or_else(|| thread::available_parallelism().map_or(1, usize::from), usize::from)
}

/// Runs these records, several at a time, and writes down the end of each as it comes. Returns the ends in the order of
/// the runs.
pub(crate) fn run_all(
    runs: &[&Run],
    fleet: &Path,
    options: &Options,
    journal: &mut Journal,
) -> anyhow::Result<Vec<Ended>> {
    let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
    let mut ends: Vec<Option<Ended>> = vec![None; runs.len()];
    let mut progress = Progress::new(runs.len(), options.quiet);
    thread::scope(|scope| -> anyhow::Result<()> {
        let (sender, receiver) = mpsc::channel();
        for _ in 0..jobs(options).min(runs.len()) {
            let (sender, next, stop) = (sender.clone(), &next, &stop);
            scope.spawn(move || {
                while !stop.load(Ordering::Relaxed) {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    let Some(run) = runs.get(number) else { return };
                    if sender.send((number, run_record(run, fleet, options))).is_err() {
                        return;
                    }
                }
            });
        }
        drop(sender);
        for (number, ended) in receiver {
            let written = ended.and_then(|ended| journal.add(&ended).map(|()| ended));
            let ended = written.inspect_err(|_| stop.store(true, Ordering::Relaxed))?;
            progress.advance(ended.has_result());
            ends[number] = Some(ended);
        }
        Ok(())
    })?;
    Ok(ends.into_iter().flatten().collect())
}
