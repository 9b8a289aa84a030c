//! Who works in a run folder, in words.

use std::ffi::OsString;
use std::fs;
use std::os::unix::ffi::OsStringExt;
use std::path::Path;

/// The process that holds the lock of a folder, as far as `/proc` tells: where it does not, "another process".
pub(crate) fn holder_of(folder: &Path) -> String {
    let holders = holders(folder).unwrap_or_default();
    let run = holders.iter().find_map(|(id, words)| {
        let record = words.iter().skip_while(|word| *word != "--").nth(1)?;
        is_program(words, "crumple-run").then(|| format!("process {id}, which runs {}", record.to_string_lossy()))
    });
    let stage = || {
        let (id, words) = holders.first()?;
        let name = words.first().and_then(|word| Path::new(word).file_name()).unwrap_or_default().to_string_lossy();
        Some(format!("process {id} ({name}), left over from a run that was killed"))
    };
    run.or_else(stage).unwrap_or_else(|| "another process".to_owned())
}

fn is_program(words: &[OsString], name: &str) -> bool {
    words.first().and_then(|word| Path::new(word).file_name()).is_some_and(|file| file == name)
}

/// Id and command line of every process that holds the folder's lock.
fn holders(folder: &Path) -> std::io::Result<Vec<(u32, Vec<OsString>)>> {
    let folder = folder.canonicalize()?;
    let mut holders = Vec::new();
    for process in fs::read_dir("/proc")?.flatten() {
        let Some(id) = process.file_name().to_str().and_then(|name| name.parse().ok()) else { continue };
        let Ok(open) = fs::read_dir(process.path().join("fd")) else { continue };
        let holds = open.flatten().any(|fd| {
            let lock = || fs::read_to_string(process.path().join("fdinfo").join(fd.file_name()));
            fs::read_link(fd.path()).is_ok_and(|target| target == folder)
                && lock().is_ok_and(|info| info.lines().any(|line| line.starts_with("lock:")))
        });
        if holds {
            let line = fs::read(process.path().join("cmdline")).unwrap_or_default();
            let words = line.split(|byte| *byte == 0).map(|word| OsString::from_vec(word.to_vec())).collect();
            holders.push((id, words));
        }
    }
    Ok(holders)
}
