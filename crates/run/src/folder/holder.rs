//! Who works in a run folder, in words.

use std::ffi::OsString;
use std::fs;
use std::os::unix::ffi::OsStringExt;
use std::path::Path;
use std::thread::sleep;
use std::time::Duration;

/// A process and the words of its command line.
type Holder = (u32, Vec<OsString>);

/// The process that holds a lock, as far as `/proc` tells: where it does not, "another process".
pub(crate) fn holder_of(locked: &Path) -> String {
    let look = || holders(locked).unwrap_or_default();
    in_words(&look(), || {
        // A run that just takes or leaves the lock, or starts a stage, shows itself at a second look.
        sleep(Duration::from_millis(50));
        look()
    })
}

/// A stage without its run is left over only if two looks say so.
fn in_words(holders: &[Holder], look_again: impl FnOnce() -> Vec<Holder>) -> String {
    let run = |holders: &[Holder]| {
        holders.iter().find_map(|(id, words)| {
            let record = words.iter().skip_while(|word| *word != "--").nth(1)?;
            is_program(words, "crumple-run").then(|| format!("process {id}, which runs {}", record.to_string_lossy()))
        })
    };
    if let Some(run) = run(holders) {
        return run;
    }
    let again = look_again();
    if let Some(run) = run(&again) {
        return run;
    }
    let of_a_run = |holders: &[Holder]| holders.iter().any(|(_, words)| is_program(words, "crumple-run"));
    let stage = again.iter().filter(|holder| holders.contains(holder)).find_map(|(id, words)| {
        let name = Path::new(words.first()?).file_name()?.to_string_lossy();
        Some(format!("process {id} ({name}), left over from a run that was killed"))
    });
    stage.filter(|_| !of_a_run(holders) && !of_a_run(&again)).unwrap_or_else(|| "another process".to_owned())
}

fn is_program(words: &[OsString], name: &str) -> bool {
    words.first().and_then(|word| Path::new(word).file_name()).is_some_and(|file| file == name)
}

/// Every process that holds the lock.
fn holders(locked: &Path) -> std::io::Result<Vec<Holder>> {
    let locked = locked.canonicalize()?;
    let mut holders = Vec::new();
    for process in fs::read_dir("/proc")?.flatten() {
        let Some(id) = process.file_name().to_str().and_then(|name| name.parse().ok()) else { continue };
        let Ok(open) = fs::read_dir(process.path().join("fd")) else { continue };
        let holds = open.flatten().any(|fd| {
            let lock = || fs::read_to_string(process.path().join("fdinfo").join(fd.file_name()));
            fs::read_link(fd.path()).is_ok_and(|target| target == locked)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_two_looks_see_is_left_over() {
        let holder = |id, line: &str| vec![(id, line.split(' ').map(OsString::from).collect())];
        let stage = holder(7, "/bin/crumple-identify x");
        let run = holder(6, "/bin/crumple-run -- crash.csv");
        let words = |first: &[Holder], second: &[Holder]| in_words(first, || second.to_vec());
        assert_eq!(words(&run, &[]), "process 6, which runs crash.csv");
        assert_eq!(words(&stage, &run), "process 6, which runs crash.csv");
        assert_eq!(words(&stage, &stage), "process 7 (crumple-identify), left over from a run that was killed");
        for unclear in [vec![], holder(7, ""), holder(8, "/bin/sh")] {
            assert_eq!(words(&stage, &unclear), "another process");
            assert_eq!(words(&unclear, &stage), "another process");
        }
        assert_eq!(words(&holder(7, ""), &holder(7, "")), "another process");
    }
}
