//! A fleet as a whole: its records found, its runs made, its tables and its page written.

use std::collections::HashMap;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::Context;
use crumple_stage::{ExitStatus, say};
use rayon::prelude::*;

use crate::fleet::command::Options;
use crate::fleet::page::write_page;
use crate::fleet::records::records;
use crate::fleet::runs::{Journal, JournalEntry, Run, in_words, plan, read_journals, run_all};
use crate::fleet::tables::{Row, rows, tables, write_tables};
use crate::folder::lock::LockedFolder;

// From the command line to the page.

/// A fleet that was made.
#[derive(Debug)]
pub(crate) struct Fleet {
    /// Its folder.
    pub(crate) folder: PathBuf,
    /// Its runs; none of a fleet that is one part of several.
    pub(crate) rows: Vec<Row>,
    /// Keeps others out of the folder, but parts of one fleet, which have journals of their own.
    _lock: Option<LockedFolder>,
}

/// Runs what is not up to date, and writes the tables and the page of all runs. Exit code 3 where none has a result.
pub fn fleet(options: Options) -> anyhow::Result<ExitStatus> {
    let rows = make(&options)?.rows;
    let nothing = !rows.is_empty() && rows.iter().all(|row| !row.ended.has_result());
    Ok(if nothing { ExitStatus::Refused } else { ExitStatus::Done })
}

/// The same, and what was found.
pub(crate) fn make(options: &Options) -> anyhow::Result<Fleet> {
    let started = Instant::now();
    let folder = options.folder()?;
    options.programs.commands()?.check()?;
    let tell = |line: String| {
        if !options.quiet {
            say(line);
        }
    };
    let (records, others) = records(&options.inputs, options.batch)?;
    if let Some(other) = others.first() {
        tell(format!("fleet: {} files are no records, for example {}", others.len(), other.display()));
    }
    let runs = plan(&records, options)?;
    let lock = options.batch.is_none().then(|| LockedFolder::lock(&folder, options.quiet)).transpose()?;
    let known = read_journals(&folder)?;
    let stands = |run: &Run| ended_of(run, &known).filter(|ended| !options.force && ended.stands(&folder));
    let standing: Vec<Option<&JournalEntry>> = runs.par_iter().map(stands).collect();
    let todo: Vec<&Run> = runs.iter().zip(&standing).filter(|(_, ended)| ended.is_none()).map(|(run, _)| run).collect();
    tell(format!(
        "fleet: {} records, {} runs, {} up to date: {}",
        records.len(),
        runs.len(),
        runs.len() - todo.len(),
        folder.display()
    ));
    let made = if options.tables_only || todo.is_empty() {
        Vec::new()
    } else {
        let part = options.batch.map_or_else(|| "all".to_owned(), |batch| format!("{}-of-{}", batch.part, batch.of));
        run_all(&todo, &folder, options, &mut Journal::open(&folder, &part)?)?
    };
    let made_count = made.len();
    let mut made = made.into_iter();
    let ended: Vec<(Run, JournalEntry)> = runs
        .iter()
        .zip(&standing)
        .filter_map(|(run, standing)| Some((run.clone(), standing.cloned().or_else(|| made.next())?)))
        .collect();
    tell(in_numbers(&ended, made_count, runs.len() - ended.len(), started));
    if options.batch.is_some() {
        return Ok(Fleet { folder, rows: Vec::new(), _lock: lock });
    }
    let rows = rows(&folder, ended).context("a result is gone: run the fleet again")?;
    write_tables(&folder, &tables(&rows))?;
    write_page(&folder, &rows, options)?;
    tell(format!("fleet: {}", folder.join("fleet.html").display()));
    Ok(Fleet { folder, rows, _lock: lock })
}

/// What the journals say of a run as it is now.
fn ended_of<'a>(run: &Run, known: &'a HashMap<(String, String), JournalEntry>) -> Option<&'a JournalEntry> {
    known.get(&(run.folder.clone(), run.key.clone()?))
}

/// Most records that a line names: what fits beside its counts.
const NAMED: usize = 5;

fn in_numbers(ended: &[(Run, JournalEntry)], made: usize, missing: usize, started: Instant) -> String {
    let count = |code: fn(i32) -> bool| ended.iter().filter(|(_, ended)| code(ended.exit_code)).count();
    let elapsed = started.elapsed();
    let mut line = format!(
        "fleet: {} done, {} without an acceptable result, {} refused, {} failed",
        count(|code| code == 0),
        count(|code| code == 4),
        count(|code| code == 2 || code == 3),
        count(|code| ![0, 2, 3, 4].contains(&code)),
    );
    let ended_badly = || ended.iter().filter(|(_, ended)| ![0, 4].contains(&ended.exit_code));
    if ended_badly().next().is_some() {
        let names: Vec<&str> = ended_badly().map(|(run, _)| run.record.identity.as_str()).take(NAMED).collect();
        let more = ended_badly().count() - names.len();
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        line.push_str(&format!(" ({}{more}; fleet.html says why)", names.join(", ")));
    }
    if missing > 0 {
        line.push_str(&format!(", {missing} not run yet"));
    }
    if made > 0 {
        let rate = made as f64 / elapsed.as_secs_f64().max(1e-3);
        line.push_str(&format!("; {made} runs in {}, {rate:.1} a second", in_words(elapsed)));
    }
    line
}
