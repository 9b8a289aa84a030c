//! The command line that all stages have in common.

use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering::Relaxed;
use std::{fmt, fs};

use clap::{Arg, ArgAction, ArgMatches, Command};
use crumple_artifact::Compression;

use crate::error::ExitStatus;

/// Flags of every stage.
#[derive(Debug, Clone, clap::Args)]
pub struct SharedFlags {
    /// Input files: artifacts of earlier stages in any order (for ingest: the record as you have it).
    #[arg(required = true, value_name = "INPUT")]
    pub inputs: Vec<PathBuf>,

    /// Artifact to write (an MCAP file).
    #[arg(short, long, value_name = "OUTPUT")]
    pub output: PathBuf,

    /// Pipeline file; the stage takes its options from its own table, flags override them.
    #[arg(short, long, value_name = "FILE")]
    pub pipeline: Option<PathBuf>,

    /// Dependent file to delete when the output changes. It is kept where the output is up to date or the stage fails.
    /// Several are deleted in their order.
    #[arg(long = "dependent", value_name = "FILE")]
    pub dependents: Vec<PathBuf>,

    /// Compute even if the output is up to date.
    #[arg(long)]
    pub force: bool,

    /// Print the records of the result to stdout, one JSON object a line.
    #[arg(long)]
    pub json: bool,

    /// Check the options and end: nothing is read, nothing is written.
    #[arg(long, hide = true)]
    pub check_options: bool,

    /// No summary and no progress.
    #[arg(short, long)]
    pub quiet: bool,

    /// No summary, but progress: crumple-run asks for it, whose last stage sums the run up.
    #[arg(long, hide = true)]
    pub no_summary: bool,

    /// Compression of the artifact; the content and its digest stay the same.
    #[arg(long, value_enum, default_value_t = Compress::None)]
    pub compress: Compress,
}

/// Whether a flag, `--output` or `-o`, is one that every stage has: where it reads and writes, what it prints.
pub fn is_shared_flag(flag: &str) -> bool {
    let command = with_flag(<SharedFlags as clap::Args>::augment_args(Command::new("")));
    let is_it = |arg: &Arg| match flag.strip_prefix("--") {
        Some(long) => arg.get_long() == Some(long),
        None => arg.get_short().is_some_and(|short| flag.strip_prefix('-') == Some(&*short.to_string())),
    };
    command.get_arguments().any(is_it)
}

/// Compression of an artifact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Compress {
    /// Fastest; filtered signals hardly compress.
    None,
    /// Zstandard; halves raw recorder data and more.
    Zstd,
}

impl From<Compress> for Compression {
    fn from(compress: Compress) -> Self {
        match compress {
            Compress::None => Self::None,
            Compress::Zstd => Self::Zstd,
        }
    }
}

/// The whole command line of a stage.
#[derive(Debug, clap::Parser)]
pub(crate) struct Cli<O: clap::Args> {
    #[command(flatten)]
    pub(crate) common: SharedFlags,

    #[command(flatten, next_help_heading = "Stage options (also keys of the stage's pipeline table)")]
    pub(crate) options: O,
}

/// The command with switches that may be said again, which changes nothing: `-q` in a script and by hand.
pub(crate) fn with_switches_said_twice(command: Command) -> Command {
    let again = |arg: Arg| match arg.get_action() {
        ArgAction::SetTrue => {
            let id = arg.get_id().clone();
            arg.overrides_with(id)
        }
        _ => arg,
    };
    command.mut_args(again).mut_subcommands(with_switches_said_twice)
}

/// Name of the flag among the matches.
const FLAG: &str = "memory_limit";
/// Without the flag: this much, and [`TIMES_INPUT`] bytes for every byte of the inputs.
const FREE: u64 = 512 << 20;
const TIMES_INPUT: u64 = 4;
/// Factors of units; the first that is not above a size is the one it is printed in.
const UNITS: [(&str, u64); 8] = [
    ("TiB", 1 << 40),
    ("GiB", 1 << 30),
    ("MiB", 1 << 20),
    ("KiB", 1 << 10),
    ("TB", 1_000_000_000_000),
    ("GB", 1_000_000_000),
    ("MB", 1_000_000),
    ("kB", 1_000),
];

/// The limit typed on the command line of the program that runs, bytes; 0 where none was.
static TYPED: AtomicU64 = AtomicU64::new(0);

fn typed_limit() -> Option<MemorySize> {
    Some(MemorySize(TYPED.load(Relaxed))).filter(|limit| limit.0 > 0)
}

/// An amount of memory, bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct MemorySize(u64);

impl FromStr for MemorySize {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || format!("{text:?} is no amount of memory, expected e.g. 2GiB or 800MB");
        let at = text.find(|c: char| c.is_ascii_alphabetic()).ok_or_else(expected)?;
        let (number, unit) = text.split_at(at);
        let number: f64 = number.trim().parse().map_err(|_| expected())?;
        let (_, factor) = UNITS.iter().find(|(name, _)| name.eq_ignore_ascii_case(unit)).ok_or_else(expected)?;
        let bytes = number * *factor as f64;
        if bytes >= 1.0 && bytes < i64::MAX as f64 { Ok(Self(bytes as u64)) } else { Err(expected()) }
    }
}

impl fmt::Display for MemorySize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (unit, factor) = UNITS[..4].iter().find(|(_, factor)| *factor <= self.0).unwrap_or(&UNITS[3]);
        let amount = (self.0 as f64 / *factor as f64 * 10.0).round() / 10.0;
        write!(f, "{amount} {unit}")
    }
}

/// The command with the flag, for itself and its subcommands.
pub(crate) fn with_flag(command: Command) -> Command {
    command.arg(
        Arg::new(FLAG)
            .long("memory-limit")
            .value_name("SIZE")
            .value_parser(MemorySize::from_str)
            .global(true)
            .help_heading(None)
            .help("Most memory to use, e.g. 2GiB [default: 4 times the size of the input and 512 MiB]"),
    )
}

/// Takes the limit from a command line.
pub(crate) fn take(matches: &ArgMatches) {
    let typed = matches.get_one::<MemorySize>(FLAG);
    TYPED.store(typed.map_or(0, |limit| limit.0), Relaxed);
    if typed.is_some() {
        keep_budget(&[], ExitStatus::Refused);
    }
}

/// The flag as it was typed, for other programs that this one starts.
pub fn memory_limit_flag() -> Option<String> {
    Some(format!("--memory-limit={}KiB", typed_limit()?.0.div_ceil(1 << 10)))
}

/// From now on the process keeps its budget: what `--memory-limit` says, else 512 MiB and four times the size of the
/// inputs. What exceeds it is refused by the inputs' names, and the process ends with `refused`.
pub fn keep_budget(inputs: &[PathBuf], refused: ExitStatus) {
    let typed = typed_limit();
    let size: u64 = inputs.iter().map(|input| size_on_disk(input)).sum();
    let budget = typed.unwrap_or(MemorySize(FREE + TIMES_INPUT * size));
    let names: Vec<String> = inputs.iter().take(3).map(|input| input.display().to_string()).collect();
    let (what, whose) = match (names.is_empty(), typed) {
        (true, _) => ("this needs".to_owned(), "the limit of --memory-limit"),
        (false, Some(_)) => (format!("{}: this needs", names.join(", ")), "the limit of --memory-limit"),
        (false, None) => {
            (format!("{}: this needs", names.join(", ")), "the budget of a run (4 times its input and 512 MiB)")
        }
    };
    let more = MemorySize((2 * budget.0).next_power_of_two()).to_string().replace(' ', "");
    crumple_memory::set_budget(
        budget.0,
        format!(
            "error: {what} more than {budget} of memory, {whose}\n  hint: where the input is right all the same, give \
             it more: --memory-limit {more}"
        ),
        refused as i32,
    );
}

/// Bytes of a file and of those beside it that share its name up to the ending (the signal files of a test); of a
/// folder, of everything in it and in its folders.
fn size_on_disk(path: &Path) -> u64 {
    let sizes = |folder: &Path, wanted: &dyn Fn(&Path) -> bool| -> u64 {
        let entries = fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok).map(|entry| entry.path());
        entries.filter(|path| wanted(path)).filter_map(|path| fs::metadata(path).ok()).map(|m| m.len()).sum()
    };
    let Ok(metadata) = fs::metadata(path) else { return 0 };
    if !metadata.is_dir() {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        return metadata.len().max(sizes(folder, &|other| other.is_file() && other.file_stem() == path.file_stem()));
    }
    let folders = fs::read_dir(path).into_iter().flatten().filter_map(Result::ok).map(|entry| entry.path());
    let below: u64 = folders.filter(|path| path.is_dir()).map(|folder| sizes(&folder, &|path| path.is_file())).sum();
    sizes(path, &|path| path.is_file()).saturating_add(below)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn amounts_of_memory_have_a_unit() {
        let bytes = |text: &str| text.parse::<MemorySize>().map(|size| size.0);
        assert_eq!(bytes("2GiB"), Ok(2 << 30));
        assert_eq!(bytes("1.5 MiB"), Ok(3 << 19));
        assert_eq!(bytes("800mb"), Ok(800_000_000));
        for wrong in ["2", "GiB", "2 sheep", "-1GiB", "0MB", "1e300GiB", "nanGiB", ""] {
            assert!(bytes(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn amounts_of_memory_print_in_the_largest_unit_that_fits() {
        let text = |bytes| MemorySize(bytes).to_string();
        assert_eq!([text(512 << 20), text(3 << 29), text(100)], ["512 MiB", "1.5 GiB", "0.1 KiB"]);
    }

    #[test]
    fn flags_of_every_stage_are_known() {
        let flags = ["--output", "-o", "--dependent", "--memory-limit", "--cfc", "-x", "cfc"];
        assert_eq!(flags.map(is_shared_flag), [true, true, true, true, false, false, false]);
    }

    #[test]
    fn the_files_of_a_test_count_together() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, bytes: usize| {
            fs::write(folder.path().join(name), vec![0; bytes]).unwrap();
        };
        write("a.EV5", 10);
        write("a.001", 100);
        write("b.csv", 1000);
        assert_eq!(size_on_disk(&folder.path().join("a.EV5")), 110);
        assert_eq!(size_on_disk(&folder.path().join("b.csv")), 1000);
        assert_eq!(size_on_disk(folder.path()), 1110);
        assert_eq!(size_on_disk(&folder.path().join("none")), 0);
    }

    #[test]
    fn switches_may_be_said_twice_and_values_may_not() {
        #[derive(clap::Parser)]
        struct Flags {
            #[command(flatten)]
            _shared: SharedFlags,
        }
        let command = with_switches_said_twice(Flags::command().no_binary_name(true));
        let parse = |words: &str| command.clone().try_get_matches_from(words.split(' '));
        let matches = parse("a.mcap -o b.mcap -q --force --quiet --force").unwrap();
        assert!(matches.get_flag("quiet") && matches.get_flag("force"));
        assert!(parse("a.mcap -o b.mcap -o c.mcap").is_err());
    }
}
