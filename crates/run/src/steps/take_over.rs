//! Taking over what a program from elsewhere wrote.
//!
//! Only the stages of the project know by themselves whether their output is up to date, and remove what was made from
//! the old one before the new one appears. Any other program writes into a folder of its own, and this is done for it.

use std::fs::{self, File};
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};

use crumple_artifact::remove_in_order;

/// Moves new results from one folder to another.
///
/// Results that are the same as the old ones leave these alone. Else `dependents`, made from the old ones, go first,
/// and of several results that belong together no old one stands beside a new one at any moment.
pub(crate) fn take_over(from: &Path, to: &Path, names: &[&str], dependents: &[PathBuf]) -> io::Result<()> {
    let written: Vec<&&str> = names.iter().filter(|name| from.join(name).exists()).collect();
    let mut unchanged = written.len() == names.len();
    for name in &written {
        unchanged = unchanged && same_bytes(&from.join(name), &to.join(name))?;
    }
    if unchanged {
        return Ok(());
    }
    for name in &written {
        // To the disk before the move: after a power cut the name must not point at an empty file.
        File::open(from.join(name))?.sync_data()?;
    }
    remove_in_order(dependents)?;
    if names.len() > 1 {
        remove_in_order(&names.iter().map(|name| to.join(name)).collect::<Vec<_>>())?;
    }
    for name in written {
        fs::rename(from.join(name), to.join(name))?;
    }
    Ok(())
}

/// Whether two files hold the same; one that does not exist holds nothing.
fn same_bytes(a: &Path, b: &Path) -> io::Result<bool> {
    let (Ok(length_a), Ok(length_b)) = (fs::metadata(a), fs::metadata(b)) else { return Ok(false) };
    if length_a.len() != length_b.len() {
        return Ok(false);
    }
    let (mut a, mut b) = (BufReader::new(File::open(a)?), BufReader::new(File::open(b)?));
    let (mut of_a, mut of_b) = ([0; 1 << 16], [0; 1 << 16]);
    loop {
        let read = a.read(&mut of_a)?;
        if read == 0 {
            return Ok(true);
        }
        b.read_exact(&mut of_b[..read])?;
        if of_a[..read] != of_b[..read] {
            return Ok(false);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_result_changes_nothing_and_another_takes_the_dependents_away() {
        let root = tempfile::tempdir().unwrap();
        let (from, to) = (root.path().join("new"), root.path().join("run"));
        let names = ["report.html", "summary.json"];
        let dependent = to.join("later");
        for folder in [&from, &to] {
            fs::create_dir(folder).unwrap();
            names.iter().for_each(|name| fs::write(folder.join(name), "old").unwrap());
        }
        fs::write(&dependent, "x").unwrap();
        let take = || take_over(&from, &to, &names, std::slice::from_ref(&dependent)).unwrap();
        take();
        assert!(dependent.exists());

        // Of two results only one is written: the other is not that of an older run.
        fs::remove_file(from.join("summary.json")).unwrap();
        fs::write(from.join("report.html"), "new").unwrap();
        take();
        assert!(!dependent.exists() && !to.join("summary.json").exists());
        assert_eq!(fs::read(to.join("report.html")).unwrap(), b"new");
    }
}
