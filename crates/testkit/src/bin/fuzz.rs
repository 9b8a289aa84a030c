//! `fuzz --bin BIN [--files N] [--first K] [--folder FOLDER]`: N mutated files and N tampered artifacts, each read by
//! the program that it is meant for. Exit code 1 where one of them aborts, takes too much memory or time, or gives a
//! wrong result; the files stay in FOLDER.

use std::path::PathBuf;
use std::process::ExitCode;

use crumple_testkit::fuzz::{Campaign, Tally, run_campaign};
use crumple_testkit::workspace;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut campaign = Campaign {
        bin: workspace().join("target/release"),
        folder: workspace().join("target/fuzz"),
        first: 0,
        files: 1000,
    };
    for pair in arguments.chunks(2) {
        match pair {
            [flag, value] if flag == "--bin" => campaign.bin = PathBuf::from(value),
            [flag, value] if flag == "--folder" => campaign.folder = PathBuf::from(value),
            [flag, value] if flag == "--files" && value.parse::<u64>().is_ok() => {
                campaign.files = value.parse().unwrap_or_default();
            }
            [flag, value] if flag == "--first" && value.parse::<u64>().is_ok() => {
                campaign.first = value.parse().unwrap_or_default();
            }
            _ => {
                eprintln!("usage: fuzz [--bin BIN] [--files N] [--first K] [--folder FOLDER]");
                return ExitCode::from(2);
            }
        }
    }
    match run_campaign(&campaign, &mut |line| println!("{line}")) {
        Ok([mutated, tampered]) => {
            println!("mutated files: {mutated}\ntampered artifacts: {tampered}");
            ExitCode::from(u8::from([&mutated, &tampered].into_iter().map(Tally::not_allowed).sum::<usize>() > 0))
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}
