//! `bytes --bin BIN [OUT]` writes digests of everything the programs in the folder BIN write; `bytes --compare A B`
//! names what differs. What the programs write lies in `OUT` with the ending `.cases` meanwhile.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use crumple_testkit::bytes::{Difference, compare, write_digests};
use crumple_testkit::workspace;

type Failure = Box<dyn std::error::Error>;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let mut bin = workspace().join("target/release");
    if let ["--bin", given, ..] = arguments[..] {
        bin = PathBuf::from(given);
        arguments.drain(..2);
    }
    let result = match arguments[..] {
        ["--compare", a, b] => report_differences(a, b, Difference::AroundContent),
        ["--compare", a, b, "--content"] => report_differences(a, b, Difference::Texts),
        ["--compare", a, b, "--masked"] => report_differences(a, b, Difference::Content),
        [] => list(&bin, &workspace().join("target/bytes.txt")),
        [out] if !out.starts_with('-') => list(&bin, Path::new(out)),
        _ => {
            eprintln!("usage: bytes [--bin BIN] [OUT] | bytes --compare A B [--content | --masked]");
            return ExitCode::from(2);
        }
    };
    result.unwrap_or_else(|error| {
        eprintln!("error: {error}");
        ExitCode::from(2)
    })
}

fn list(bin: &Path, out: &Path) -> Result<ExitCode, Failure> {
    let digests = write_digests(bin, &out.with_extension("cases"))?;
    std::fs::write(out, &digests)?;
    eprintln!("{} digests: {}", digests.lines().count(), out.display());
    Ok(ExitCode::SUCCESS)
}

/// Names every difference; those from `least` on make the exit code 1.
fn report_differences(a: &str, b: &str, least: Difference) -> Result<ExitCode, Failure> {
    let (first, second) = (std::fs::read_to_string(a)?, std::fs::read_to_string(b)?);
    let differences = compare(&first, &second)?;
    for (file, difference) in &differences {
        println!("{difference}: {file}");
    }
    let counted = differences.iter().filter(|(_, difference)| *difference >= least).count();
    println!("{} of {} lines differ, {counted} of them count", differences.len(), first.lines().count());
    Ok(ExitCode::from(u8::from(counted > 0)))
}
