//! `interval-benchmark --bin BIN [--choice] [--clean] [--misses] [--records N] [--first K] [FAMILY ...]`: how often the
//! 95 % intervals of fitted parameters hold the truth, and how wide they are, by the programs in the folder BIN, as a
//! Markdown table; intervals of parameters that their record determines, as the report says it, apart from other
//! closed ones and from open ones. Records are numbered from K on, 0 by default: another K draws other cars. A family
//! is named by a part of its name. With `--choice`: how often the model that the record was made of, or one that the
//! record cannot tell from it, is recommended or the simplest. With `--clean`: records whose trigger and stated speed
//! have no error, behind a filter without phase. With `--misses`: every interval without the truth too, on stderr.

use std::process::ExitCode;

use crumple_testkit::interval_cover::{Choices, Cover, DRAWN, FAMILIES, choices_of, cover_of};
use crumple_testkit::workspace;

type Failure = Box<dyn std::error::Error>;

const USAGE: &str =
    "usage: interval-benchmark [--bin BIN] [--choice] [--clean] [--misses] [--records N] [--first K] [FAMILY ...]";

fn main() -> ExitCode {
    match benchmark() {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

fn benchmark() -> Result<ExitCode, Failure> {
    let mut bin = workspace().join("target/release");
    let (mut first, mut records, mut choice, mut clean, mut misses) = (0, 300, false, false, false);
    let mut wanted: Vec<String> = Vec::new();
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--bin" => bin = std::path::absolute(arguments.next().ok_or(USAGE)?)?,
            "--choice" => choice = true,
            "--clean" => clean = true,
            "--misses" => misses = true,
            "--records" => records = arguments.next().ok_or(USAGE)?.parse()?,
            "--first" => first = arguments.next().ok_or(USAGE)?.parse()?,
            flag if flag.starts_with('-') => return Err(USAGE.into()),
            family => wanted.push(family.to_owned()),
        }
    }
    let folder = std::env::temp_dir().join(format!("interval-benchmark-{}", std::process::id()));
    let asked = |name: &str| wanted.is_empty() || wanted.iter().any(|part| name.contains(part.as_str()));
    let records = first..first + records;
    let names: Vec<&str> = match choice {
        true => DRAWN.iter().map(|drawn| drawn.name).collect(),
        false => FAMILIES.iter().map(|family| family.name).collect(),
    };
    if !names.iter().any(|name| asked(name)) {
        return Err(format!("no family has {} in its name; there are: {}", wanted.join(", "), names.join("; ")).into());
    }
    if choice {
        println!("{}", Choices::HEAD);
        let pipeline = workspace().join("pipelines/default.toml");
        for drawn in DRAWN.iter().filter(|drawn| asked(drawn.name)) {
            let choices = choices_of(drawn, records.clone(), clean, (&bin, &pipeline), &folder)?;
            print!("{}", choices.row(drawn.name));
        }
    } else {
        println!("{}", Cover::HEAD);
        for family in FAMILIES.iter().filter(|family| asked(family.name)) {
            let cover = cover_of(family, records.clone(), clean, (&bin, &folder))?;
            print!("{}", cover.rows(family.name));
            cover.misses.iter().filter(|_| misses).for_each(|miss| eprintln!("{miss}"));
        }
    }
    std::fs::remove_dir_all(&folder)?;
    Ok(ExitCode::SUCCESS)
}
