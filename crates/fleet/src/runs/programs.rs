//! Which programs a run is made with.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::PathBuf;

use crumple_run::typed_commands;

/// Programs of the project that no run is made with.
const OTHERS: [&str; 5] = ["crumple-fleet", "crumple-study", "crumple-together", "crumple-diff", "crumple-artifact"];

/// Digest of the programs of the stages: of their commands as typed, of every file that stands in one, and of the
/// programs of the project beside this one. A program that another one starts is not seen.
pub(crate) fn digest_of_programs() -> io::Result<String> {
    let commands = typed_commands();
    let words = commands.iter().flat_map(|command| command.split(|c: char| c.is_whitespace() || "'\"\\".contains(c)));
    let mut files: BTreeSet<PathBuf> = words.map(PathBuf::from).filter(|path| path.is_file()).collect();
    let own = std::env::current_exe()?;
    for entry in own.parent().into_iter().filter_map(|folder| fs::read_dir(folder).ok()).flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let is_of_a_run = name.starts_with("crumple-") && !name.contains('.') && !OTHERS.contains(&name.as_str());
        if is_of_a_run && entry.path().is_file() {
            files.insert(entry.path());
        }
    }
    let mut hasher = blake3::Hasher::new();
    hasher.update(commands.join("\n").as_bytes());
    for path in files {
        hasher.update_reader(fs::File::open(&path)?)?;
    }
    Ok(hasher.finalize().to_hex().to_string())
}
