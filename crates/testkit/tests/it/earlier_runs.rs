//! A run folder of an earlier version: every command reads it. One whose contact `integrate` moved is refused, which
//! the tests of `artifact` show.

use std::path::{Path, PathBuf};
use std::process::Command;

use crumple_testkit::programs::{binary, code_and_error};
use crumple_testkit::workspace;

/// The fixture `kelvin` as commit 6f92d1fa of August 2026 left it: contact is a time of the record's axis there.
const EARLIER: &str = "crates/testkit/tests/data/kelvin-6f92d1fa";

/// A copy of the run as runs/NAME/default.
fn copied(to: &Path, name: &str) -> PathBuf {
    let folder = to.join("runs").join(name).join("default");
    std::fs::create_dir_all(&folder).unwrap();
    for entry in std::fs::read_dir(workspace().join(EARLIER)).unwrap().flatten() {
        std::fs::copy(entry.path(), folder.join(entry.file_name())).unwrap();
    }
    folder
}

/// Commands that take artifacts or folders of a run: program, arguments. `{K}` is artifact K, `{run}` and `{other}` are
/// folders, `{out}` an output.
const COMMANDS: [(&str, &str); 15] = [
    ("crumple-filter", "{1} -o {out}.mcap"),
    ("crumple-integrate", "{2} -o {out}.mcap"),
    ("crumple-identify", "{2} {3} -o {out}.mcap"),
    ("crumple-parameter-solve", "{3} -o {out}.mcap"),
    ("crumple-simulate", "{3} {5} -o {out}.mcap"),
    ("crumple-predict", "{1} {2} {3} {4} {5} --speed 40km/h -o {out}.mcap"),
    ("crumple-report", "{1} {2} {3} {4} {5} -o {out}.html"),
    ("crumple-report", "--index {run} -o {out}.html"),
    ("crumple-report", "--compare {run} {other} -o {out}.html"),
    ("crumple-diff", "{run} {other}"),
    ("crumple-artifact", "show {3}"),
    ("crumple-artifact", "notes {run}"),
    ("crumple-artifact", "curve {5}"),
    ("crumple-export", "{run} --to csv -o {out}"),
    ("crumple", "accept {runs} --into {out}"),
];

/// Exit code and standard error of a command on two run folders below a folder.
fn of_command(folder: &Path, number: usize) -> (i32, String) {
    let (program, arguments) = COMMANDS[number];
    let [run, other] = ["one", "two"].map(|name| folder.join("runs").join(name).join("default"));
    let names = ["1-ingest", "2-filter", "3-integrate", "4-identify", "5-parameter-solve"];
    let argument = |word: &str| {
        let mut word = word.replace("{runs}", &folder.join("runs").to_string_lossy());
        word = word.replace("{run}", &run.to_string_lossy()).replace("{other}", &other.to_string_lossy());
        word = word.replace("{out}", &folder.join(format!("out-{number}")).to_string_lossy());
        names.iter().enumerate().fold(word, |word, (k, name)| {
            word.replace(&format!("{{{}}}", k + 1), &run.join(format!("{name}.mcap")).to_string_lossy())
        })
    };
    let mut command = Command::new(binary(program));
    command.args(arguments.split(' ').map(argument)).current_dir(folder);
    code_and_error(&mut command)
}

#[test]
fn every_command_reads_a_run_of_an_earlier_version() {
    let folder = tempfile::tempdir().unwrap();
    copied(folder.path(), "one");
    copied(folder.path(), "two");
    for (number, (program, arguments)) in COMMANDS.iter().enumerate() {
        let (code, error) = of_command(folder.path(), number);
        assert_eq!(code, 0, "{program} {arguments}: {error}");
    }
}
