//! Writes the report of a synthetic run into a folder: `cargo run --example sample_report -- FOLDER`.

#[path = "../tests/it/sample/mod.rs"]
mod sample;
#[path = "../src/stage/mod.rs"]
mod stage;

use clap::Parser;

fn main() -> anyhow::Result<()> {
    let folder = std::path::PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "runs/sample".to_owned()));
    std::fs::create_dir_all(&folder)?;
    let mut args = vec!["crumple-report".into(), "-o".into(), folder.join("report.html")];
    args.extend(sample::write_artifacts(&folder, true));
    stage::run(stage::Cli::parse_from(args))?;
    Ok(())
}
