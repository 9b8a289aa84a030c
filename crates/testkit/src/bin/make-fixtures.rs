//! Writes the fixtures: `make-fixtures [folder]`, by default into `fixtures/` of the workspace.

use std::path::PathBuf;
use std::process::ExitCode;

fn main() -> ExitCode {
    let folder =
        std::env::args_os().nth(1).map_or_else(|| crumple_testkit::workspace().join("fixtures"), PathBuf::from);
    match write(&folder) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: cannot write fixtures into {}: {error}", folder.display());
            ExitCode::FAILURE
        }
    }
}

fn write(folder: &std::path::Path) -> Result<(), Box<dyn std::error::Error>> {
    for fixture in crumple_testkit::fixture::fixtures()? {
        let target = folder.join(fixture.name);
        std::fs::create_dir_all(&target)?;
        std::fs::write(target.join("crash.csv"), &fixture.csv)?;
        std::fs::write(target.join("truth.json"), fixture.truth_text())?;
    }
    Ok(())
}
