//! A folder that records arrive in: each is run as soon as it is whole.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, SystemTime};

use anyhow::Context;
use crumple_signal::value::Time;
use crumple_stage::{DisplayFlag, ExitStatus, Refused, say};

use crate::fleet::records::{records_below, spans_files};
use crate::program::own_command;
use crate::steps::{StageExit, run_program};

/// Runs every record that arrives in a folder, until it is interrupted (Ctrl-C).
///
/// A record is run once its files have not changed between two looks, and again when they change. Results stand in
/// runs/RECORD/PIPELINE, as those of `crumple run`. A record that fails is named, and the next one is run. Records that
/// lie there at first are run too; those that are up to date are left alone.
#[derive(Debug, clap::Parser)]
#[command(
    name = "crumple-watch",
    version,
    after_help = "An interrupted run leaves the results of the run before.\n\
                  Exit codes: 2 usage, 3 the folder is gone or cannot be read; an interruption is that of the system."
)]
pub struct WatchOptions {
    /// Folder that records arrive in, with all below it.
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,

    /// Time between two looks.
    #[arg(long, value_name = "TIME", default_value = "2s")]
    every: Time,

    /// Pipeline: a file below `pipelines/` without its ending, or the path of a file elsewhere.
    #[arg(long, value_name = "NAME|FILE", default_value = "default")]
    pipeline: String,

    /// Folder with `runs/`, and with `pipelines/` where they are not those that are built in.
    #[arg(long, value_name = "FOLDER", default_value = ".")]
    project: PathBuf,

    #[command(flatten)]
    display: DisplayFlag,

    /// No line about the records on stderr.
    #[arg(short, long)]
    quiet: bool,

    /// Flags of every run behind `--`, such as --impact-speed 56km/h.
    #[arg(last = true, value_name = "FLAGS")]
    flags: Vec<OsString>,
}

/// Watches; it ends by an interruption, or where the folder cannot be read.
pub fn watch(options: WatchOptions) -> anyhow::Result<ExitStatus> {
    let every = Duration::try_from_secs_f64(options.every.si()).ok().filter(|every| !every.is_zero());
    let every = every.ok_or_else(|| crumple_stage::Usage::new("--every needs a time above zero").hint("--every 2s"))?;
    if !options.folder.is_dir() {
        let problem = format!("{}: no such folder", options.folder.display());
        return Err(Refused::new(problem).expected("a folder that records arrive in").hint("check the path").into());
    }
    if !options.quiet {
        say(format_args!("{:<16} {}; Ctrl-C ends it", "watching", options.folder.display()));
    }
    let mut arrivals = Arrivals::default();
    loop {
        let records = records_below(&options.folder)?.records;
        for record in arrivals.whole(records) {
            run_one(&record, &options)?;
        }
        thread::sleep(every);
    }
}

/// Runs a record; one that fails is named.
fn run_one(record: &Path, options: &WatchOptions) -> anyhow::Result<()> {
    if !options.quiet {
        say(format_args!("{:<16} {}", "record", record.display()));
    }
    let mut command = own_command("run");
    command.arg("--project").arg(&options.project).args(["--pipeline", &options.pipeline]);
    command.args(options.display.words()).args(options.quiet.then_some("--quiet"));
    command.arg("--").arg(record).args(&options.flags);
    let ended = run_program(&mut command).with_context(|| format!("cannot run {}", record.display()))?;
    let why = match ended {
        StageExit::WithResult(ExitStatus::Done) => return Ok(()),
        StageExit::WithResult(status) | StageExit::Failed(status) => format!("exit code {}", status as u8),
        StageExit::Contradicts => format!("exit code {}", ExitStatus::Refused as u8),
        StageExit::Unforeseen(_) => "unforeseen".to_owned(),
    };
    say(format_args!("{:<16} {} ended with {why}; watching goes on", "record", record.display()));
    Ok(())
}

/// Length of all files of a record, and the latest change of them.
type Stamp = (u64, Option<SystemTime>);

/// Which records are whole and not run yet.
#[derive(Debug, Default)]
struct Arrivals {
    /// What each record was like at the last look, and whether it was run so.
    seen: BTreeMap<PathBuf, (Stamp, bool)>,
}

impl Arrivals {
    /// Of the records that lie there now those that are as they were at the last look, each once. What is empty or
    /// cannot be read waits: its writer is at work.
    fn whole(&mut self, records: Vec<PathBuf>) -> Vec<PathBuf> {
        let mut whole = Vec::new();
        let mut seen = BTreeMap::new();
        for record in records {
            let Some(stamp) = stamp(&record).ok().filter(|(length, _)| *length > 0) else { continue };
            let before = self.seen.get(&record).filter(|(before, _)| *before == stamp);
            let was_run = before.is_some_and(|(_, was_run)| *was_run);
            if before.is_some() && !was_run {
                whole.push(record.clone());
            }
            seen.insert(record, (stamp, before.is_some()));
        }
        self.seen = seen;
        whole
    }
}

/// Of a test of several files, those in its folder and below it.
fn stamp(record: &Path) -> io::Result<Stamp> {
    let beside = record.parent().filter(|_| spans_files(record));
    let files = beside.map_or_else(|| Ok(vec![record.to_owned()]), files_below)?;
    files.iter().try_fold((0, None), |(length, latest), file| {
        let found = fs::metadata(file)?;
        Ok((length + found.len(), latest.max(found.modified().ok())))
    })
}

fn files_below(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        match path.is_dir() {
            true if path.is_symlink() => {}
            true => files.extend(files_below(&path)?),
            false => files.push(path),
        }
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_is_whole_when_it_has_not_changed_between_two_looks_and_once() {
        let folder = tempfile::tempdir().unwrap();
        let record = folder.path().join("a.csv");
        let mut arrivals = Arrivals::default();
        let mut look = || arrivals.whole(records_below(folder.path()).unwrap().records);
        assert!(look().is_empty());
        fs::write(&record, "").unwrap();
        assert_eq!([look(), look()], [const { Vec::<PathBuf>::new() }; 2], "an empty file is about to be written");
        fs::write(&record, "time_s,accel_g\n0,0\n").unwrap();
        assert!(look().is_empty());
        fs::write(&record, "time_s,accel_g\n0,0\n1,0\n").unwrap();
        assert!(look().is_empty(), "it grew");
        assert_eq!(look(), std::slice::from_ref(&record));
        assert!(look().is_empty(), "once");
        fs::write(&record, "time_s,accel_g\n0,0\n1,0\n2,0\n").unwrap();
        assert!(look().is_empty());
        assert_eq!(look(), [record]);
    }

    #[test]
    fn a_test_of_several_files_is_whole_when_all_of_them_are() {
        let folder = tempfile::tempdir().unwrap();
        let main = folder.path().join("v1.EV5");
        fs::write(&main, "EV5").unwrap();
        let before = stamp(&main).unwrap();
        fs::write(folder.path().join("v1.001"), "1 2 3").unwrap();
        assert_ne!(stamp(&main).unwrap(), before);
        let table = folder.path().join("a.csv");
        fs::write(&table, "1").unwrap();
        assert_eq!(stamp(&table).unwrap().0, 1);
    }
}
