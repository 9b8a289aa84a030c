//! One run, from its start to its end.

use std::ffi::OsString;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

use anyhow::Context;
use crumple_run::own_program;

use crate::command::options::Options;
use crate::runs::journal::{Ended, digest_of_summary};
use crate::runs::plan::{Run, path_in};

/// Longest text that is kept of what a run said.
const LONGEST: usize = 2_000;

/// Runs a record and waits for its end. Whatever ends it, that is a result; an error is one of this program.
pub(crate) fn run_record(run: &Run, fleet: &Path, options: &Options) -> anyhow::Result<Ended> {
    let folder = path_in(fleet, run);
    // What stands in the folder may be of other programs, which the stages do not look at.
    let force = if folder.exists() { " --force" } else { "" };
    let mut arguments: Vec<OsString> = vec!["--project".into(), options.project.clone().into()];
    arguments.extend(["--pipeline".into(), OsString::from(&run.pipeline)]);
    arguments.extend(["--out".into(), OsString::from(&folder)]);
    arguments.extend(["--flags".into(), format!("{} -q{force}", options.flags()).into()]);
    let of_report = options.report_flags(&run.folder);
    if !of_report.is_empty() {
        arguments.extend(["--flags-of-last".into(), of_report.into()]);
    }
    arguments.extend(run.settings.iter().flat_map(|setting| ["--set".into(), OsString::from(setting)]));
    arguments.extend(["--".into(), OsString::from(&run.record.path)]);
    let program = own_program("run");
    let mut command = Command::new(&program);
    // Runs side by side keep the cores busy; threads of one run would only be in each other's way.
    if options.jobs != Some(1) {
        command.env("RAYON_NUM_THREADS", "1");
    }
    let started = Instant::now();
    let output = command
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .output()
        .with_context(|| format!("cannot start {}", program.display()))?;
    let exit_code = output.status.code().unwrap_or_else(|| 128 + output.status.signal().unwrap_or_default());
    let said = String::from_utf8_lossy(&output.stderr);
    let mut ended = Ended {
        key: run.key.clone().unwrap_or_default(),
        folder: run.folder.clone(),
        exit_code,
        error: if exit_code == 0 { String::new() } else { without_places(&said, run, &folder, &options.project) },
        summary: None,
        seconds: (started.elapsed().as_secs_f64() * 1e3).round() / 1e3,
    };
    if ended.has_result() {
        ended.summary = digest_of_summary(&folder);
    }
    Ok(ended)
}

/// What a run said, without the folders that it was made in: the same wherever a fleet lies.
fn without_places(said: &str, run: &Run, folder: &Path, project: &Path) -> String {
    let mut text = said.replace(&run.record.path.display().to_string(), &run.record.identity);
    for (place, short) in [(folder, run.folder.as_str()), (project, ".")] {
        let place = place.display().to_string();
        if place.len() > 1 {
            text = text.replace(&place, short);
        }
    }
    let end = text.char_indices().nth(LONGEST).map_or(text.len(), |(at, _)| at);
    text[..end].trim().to_owned()
}
