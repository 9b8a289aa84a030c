//! A folder of records and a program that stands for the run of one.

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::PathBuf;
use std::process::{Command, Output};

use tempfile::TempDir;

/// Writes the summary that its record holds the mass of; refuses, or is killed, where the record says so.
const PROGRAM: &str = r#"#!/bin/sh
arguments="$*"
while [ "$1" != -- ]; do
    [ "$1" = --out ] && out="$2"
    shift
done
record="$2"
content="$(sed -n 2p "$record")"
echo "$record" >> "$(dirname "$0")/runs.log"
[ -z "$STAND_IN_PAUSE" ] || sleep "$STAND_IN_PAUSE"
case "$content" in
    refuse) echo "error: $record is refused" >&2; exit 3 ;;
    kill) kill -9 $$ ;;
esac
mkdir -p "$out"
printf '%s\n' "$arguments" > "$out/arguments"
printf '{"schema": "crumple.summary.v1", "test": {"title": "t", "mass_kg": %s, "impact_speed_m_per_s": 10,
    "channel": "a", "sample_rate_hz": 1000},
    "metrics": {"olc": {"value": 98.0665, "unit": "m/s^2"}},
    "candidates": [{"id": "kelvin/direct-fit/1", "model": "kelvin", "method": "direct-fit", "physical": true,
        "parameters": {"stiffness_n_per_m": 5e5}}],
    "ranking": ["kelvin/direct-fit/1"], "recommended": "kelvin/direct-fit/1"}' "$content" > "$out/.new"
mv "$out/.new" "$out/summary.json"
"#;

/// A project with records, pipelines and the program.
pub struct Fleet(TempDir);

impl Fleet {
    pub fn new() -> Self {
        // Beside the program, so that it can be linked.
        let fleet = Self(tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap());
        let root = fleet.0.path();
        fs::create_dir_all(root.join("records")).unwrap();
        fs::create_dir_all(root.join("pipelines")).unwrap();
        for name in ["default", "one", "two"] {
            fs::write(root.join(format!("pipelines/{name}.toml")), format!("title = \"{name}\"\n")).unwrap();
        }
        fs::hard_link(env!("CARGO_BIN_EXE_crumple-fleet"), root.join("crumple-fleet")).unwrap();
        fs::write(root.join("crumple-run"), PROGRAM).unwrap();
        fs::set_permissions(root.join("crumple-run"), fs::Permissions::from_mode(0o755)).unwrap();
        fleet
    }

    /// Writes a record whose second line is this.
    pub fn record(&self, name: &str, content: &str) {
        let path = self.0.path().join("records").join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, format!("time_s,accel\n{content}\n")).unwrap();
    }

    /// Folder of the results, of one name for all.
    pub fn out(&self) -> PathBuf {
        self.0.path().join("fleet")
    }

    pub fn command(&self, args: &[&str]) -> Command {
        let root = self.0.path();
        let mut command = Command::new(root.join("crumple-fleet"));
        command.arg("--project").arg(root).arg("--out").arg(self.out()).arg(root.join("records")).args(args);
        command
    }

    pub fn run(&self, args: &[&str]) -> Output {
        self.command(args).output().unwrap()
    }

    pub fn count_of_runs(&self) -> usize {
        fs::read_to_string(self.0.path().join("runs.log")).unwrap_or_default().lines().count()
    }

    /// Rows of a table, by the names of its columns.
    pub fn rows(&self, table: &str) -> Vec<BTreeMap<String, String>> {
        let mut reader = csv::Reader::from_path(self.out().join(format!("{table}.csv"))).unwrap();
        reader.deserialize().map(Result::unwrap).collect()
    }

    /// The row of a record.
    pub fn row(&self, table: &str, record: &str) -> BTreeMap<String, String> {
        self.rows(table).into_iter().find(|row| row["record"] == record).unwrap()
    }
}
