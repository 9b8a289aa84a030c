#!/usr/bin/env bash
# Guess: a crate that advertises reading MDF4 applies the formula of a channel, or refuses a channel whose formula
#   it cannot compute.
# Seen: a formula of + - * / ^ is applied; in one that calls a function, such as 2*X+sqrt(X), nothing is: the raw
#   counts come back under the physical unit, without an error or a word. asammdf gives the converted values.
# Version: mdf4-rs 0.3.3 (the newest one for Rust 1.95), files by asammdf 8.8.28, Python 3.11
# Hurts: a flow or a temperature computed by its formula reads as counts of the converter, beside channels of the
#   same file that are right.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
export CARGO_HOME="$folder/cargo" CARGO_TARGET_DIR="$folder/target"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile --only-binary :all: \
  asammdf==8.8.28 numpy==2.4.6 pandas==3.1.1
mkdir src
cat > Cargo.toml <<'TOML'
[package]
name = "reader"
version = "0.0.0"
edition = "2024"

[dependencies]
mdf4-rs = "=0.3.3"

[profile.dev]
debug = 0
TOML
cat > src/main.rs <<'RS'
use mdf4_rs::{DecodedValue, MDF, Result};

fn main() -> Result<()> {
    let mdf = MDF::from_file("formula.mf4")?;
    for group in mdf.channel_groups() {
        for channel in group.channels() {
            let (name, unit) = (channel.name()?.unwrap(), channel.unit()?.unwrap());
            print!("{name} {unit}");
            for value in channel.values()? {
                match value.expect("a valid sample") {
                    DecodedValue::Float(v) => print!(" {v:?}"),
                    DecodedValue::UnsignedInteger(v) => print!(" {v}"),
                    other => print!(" {other:?}"),
                }
            }
            println!();
        }
    }
    Ok(())
}
RS
cargo build --quiet
cat > run.py <<'PY'
import subprocess
import tomllib
from importlib.metadata import version

import numpy as np
from asammdf import MDF, Signal

with open("Cargo.lock", "rb") as lock:
    crates = {crate["name"]: crate["version"] for crate in tomllib.load(lock)["package"]}
print("mdf4-rs", crates["mdf4-rs"], "asammdf", version("asammdf"))
counts = np.arange(101, dtype=np.uint16)
formulas = {
    "plain": ("2*X+1", 2.0 * counts + 1.0),
    "root": ("2*X+sqrt(X)", 2.0 * counts + np.sqrt(counts)),
    "sine": ("5*sin(X)", 5.0 * np.sin(counts)),
}
record = MDF(version="4.10")
record.append(
    [
        Signal(counts, counts * 1e-3, name=name, unit="kPa", conversion={"formula": formula})
        for name, (formula, _) in formulas.items()
    ]
)
record.save("formula.mf4", overwrite=True)

lines = subprocess.run(["target/debug/reader"], check=True, capture_output=True, text=True).stdout.splitlines()
seen = {name: (unit, np.array(values, dtype=float)) for name, unit, *values in map(str.split, lines)}
with MDF("formula.mf4") as file:
    print("version of the file:", file.version)
    assert file.version == "4.10", "changed: version of the file"
    for name, (formula, physical) in formulas.items():
        stored, read = file.get(name, raw=True), file.get(name).samples
        unit, values = seen[name]
        print(f"{formula:12} asammdf: {read[:4].round(3)} mdf4-rs: {values[:4].round(3)} {unit}")
        assert stored.conversion.conversion_type == 3 and stored.conversion.formula == formula, "changed: the file"
        assert np.array_equal(stored.samples, counts), "changed: what asammdf stored"
        assert np.allclose(read, physical), "changed: what asammdf converts"
        assert unit == "kPa", "changed: the unit"
        assert np.array_equal(values, physical if name == "plain" else counts), f"changed: {formula}"
PY
venv/bin/python run.py
