//! Writes records of a made fleet: `make-fleet FOLDER RECORDS [BROKEN]`.

use std::path::Path;
use std::process::ExitCode;

/// The fleet is the same every time.
const SEED: u64 = 17;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let count = |at: usize| words.get(at).map_or(Ok(0), |word| word.parse::<usize>());
    let (Some(folder), Ok(records), Ok(broken)) =
        (words.first().filter(|word| !word.starts_with('-')), count(1), count(2))
    else {
        eprintln!("usage: make-fleet FOLDER RECORDS [BROKEN]");
        return ExitCode::from(2);
    };
    match crumple_testkit::made_fleet::write_fleet(Path::new(folder), records, broken, SEED) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {folder}: {error}");
            ExitCode::FAILURE
        }
    }
}
