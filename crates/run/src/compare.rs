//! `compare`: runs on one page. A test and its simulations may be records, which are run first.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

use crumple_report::CompareCli;
use crumple_stage::{Call, ExitStatus, Usage, artifacts_of_a_run, say};

use crate::names::folder_of_record;
use crate::together::joint_run::run_record;

/// Flags of a record that are those of simulations only.
const OF_SIMULATIONS: [&str; 4] = ["--node", "--axis", "--units", "--wall"];
/// The pipeline of the runs.
const PIPELINE: &str = "default";

// That of the comparison, which has its help, with flags of records behind its runs.
#[derive(Debug, clap::Parser)]
#[command(name = "crumple-compare", version)]
pub(crate) struct CompareOptions {
    #[command(flatten)]
    comparison: CompareCli,
    /// With --validate: one option of a stage for the runs of records, such as `filter.cfc=180`. Several.
    #[arg(long, value_name = "STAGE.OPTION=VALUE", requires = "validate")]
    set: Vec<String>,
}

/// Runs what is a record, then compares.
pub(crate) fn compare(options: CompareOptions, call: &Call) -> anyhow::Result<ExitStatus> {
    let CompareOptions { mut comparison, set } = options;
    let is_flag = |word: &PathBuf| word.as_os_str().as_encoded_bytes().starts_with(b"-");
    let count = comparison.inputs.iter().take_while(|word| !is_flag(word)).count();
    let flags: Vec<OsString> = comparison.inputs.split_off(count).into_iter().map(PathBuf::into_os_string).collect();
    refuse_records_of_a_comparison(&comparison)?;
    let simulations: Vec<PathBuf> =
        comparison.inputs.iter().filter(|path| is_record_of_simulation(path)).cloned().collect();
    let records = comparison.inputs.iter_mut().filter(|path| comparison.validation.validate && is_record(path));
    let mut records = records.peekable();
    if let (Some(flag), None) = (flags.first(), records.peek()) {
        let problem = format!("{} is a flag of a record, and none is to be run", flag.display());
        let hint = "with --validate the test and its simulations may be records: crumple compare --help";
        return Err(Usage::new(problem).hint(hint).into());
    }
    for record in records {
        let folder = folder_of_record(Path::new("."), record);
        let folder = folder.ok_or_else(|| Usage::new(format!("{} has no file name", record.display())))?;
        let folder = folder.join(PIPELINE);
        let of_record = flags_of(&flags, crumple_ingest::is_simulation(record));
        let set = set.iter().flat_map(|typed| ["--set".into(), OsString::from(typed)]);
        let words: Vec<OsString> = set
            .chain(["-q", "--out"].map(OsString::from))
            .chain([folder.clone().into(), "--".into(), record.clone().into()])
            .chain(of_record)
            .collect();
        if let Some(status) = run_record(&folder, &words)? {
            say(format_args!("error: the run of {} failed; nothing was compared", record.display()));
            if simulations.len() > 1 && simulations.contains(record) {
                say("  hint: --node, --axis, --units and --wall are those of all simulations; where they differ, run \
                     each by itself and compare the runs:");
                for simulation in &simulations {
                    let (name, run) = (simulation.display(), folder_of_record(Path::new("."), simulation));
                    let folder = run.unwrap_or_else(|| PathBuf::from("DIR"));
                    say(format_args!("    crumple run {name} --units SYSTEM --node ID -o {}", folder.display()));
                }
            }
            return Ok(status);
        }
        *record = folder;
    }
    crumple_report::compare_runs(&comparison, call)
}

/// Errors: a record is to be compared without --validate.
fn refuse_records_of_a_comparison(comparison: &CompareCli) -> Result<(), Usage> {
    let is_record = |path: &&PathBuf| path.is_file() || is_record_of_simulation(path);
    let mut records = comparison.inputs.iter().filter(is_record).filter(|_| !comparison.validation.validate);
    let Some(record) = records.next() else { return Ok(()) };
    let hint = format!(
        "add --validate to compare a simulation with its test; or run each record first: crumple run {}",
        record.display()
    );
    Err(Usage::new(format!("{} is a record, not the folder of a run", record.display())).hint(hint))
}

fn is_record_of_simulation(path: &Path) -> bool {
    is_record(path) && crumple_ingest::is_simulation(path)
}

/// Whether it is to be run: it is there, and no folder of a run.
fn is_record(path: &Path) -> bool {
    path.exists() && !(path.is_dir() && artifacts_of_a_run(path).is_ok())
}

/// The flags of a record: of a simulation those that only simulations have, of any other all others.
fn flags_of(flags: &[OsString], is_simulation: bool) -> Vec<OsString> {
    let is_flag = |word: &OsStr| word.as_encoded_bytes().starts_with(b"--");
    let is_of_simulations = |word: &OsString| {
        let text = word.to_string_lossy();
        OF_SIMULATIONS.contains(&text.split('=').next().unwrap_or_default())
    };
    // A flag with what stands behind it.
    let groups = flags.chunk_by(|_, next| !is_flag(next));
    groups.filter(|group| is_of_simulations(&group[0]) == is_simulation).flatten().cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flag_goes_to_the_simulation_or_to_the_test() {
        let words = |text: &str| text.split(' ').map(OsString::from).collect::<Vec<_>>();
        let flags = words("--mass 1500kg --node 7 --time-zero -5ms --units=mm-s-t --allow-missing");
        assert_eq!(flags_of(&flags, true), words("--node 7 --units=mm-s-t"));
        assert_eq!(flags_of(&flags, false), words("--mass 1500kg --time-zero -5ms --allow-missing"));
    }
}
