//! Digest of the sources of a program, for build scripts: what made an artifact is part of its provenance.

use std::collections::BTreeSet;
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io;
use std::path::{Path, PathBuf};

/// Files of the workspace that decide what is built of the sources.
const OF_THE_WORKSPACE: [&str; 3] = ["Cargo.toml", "Cargo.lock", "rust-toolchain.toml"];

/// Tells cargo the digest of the package's sources as the variable `CRUMPLE_BUILD`, and to ask again when they change.
///
/// Errors: the sources cannot be read.
pub fn state() -> io::Result<()> {
    let package = std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from).unwrap_or_default();
    let name = package.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let workspace = package.join("../..");
    let crates = crates_of(&workspace, &name)?;
    let parts = crates.iter().flat_map(|name| parts_of(name)).chain(OF_THE_WORKSPACE.map(Into::into));
    // A file that is not there would count as changed every time.
    for path in parts.map(|part| workspace.join(part)).filter(|path| path.exists()) {
        println!("cargo:rerun-if-changed={}", path.display());
    }
    println!("cargo:rustc-env=CRUMPLE_BUILD={}", source_digest(&workspace, &name)?);
    Ok(())
}

/// 16 hexadecimal digits of everything that the crate `name` is made of: its sources, those of the crates of the
/// workspace that it uses, the versions of all others, the toolchain. It depends on names and contents alone, not on
/// where the workspace lies.
pub fn source_digest(workspace: &Path, name: &str) -> io::Result<String> {
    let mut files = BTreeSet::new();
    for part in crates_of(workspace, name)?.iter().flat_map(|name| parts_of(name)) {
        add_files(workspace, Path::new(&part), &mut files)?;
    }
    files.extend(OF_THE_WORKSPACE.map(PathBuf::from).into_iter().filter(|path| workspace.join(path).is_file()));
    // The toolchain is pinned and among the files, so the hash function is the same wherever the digests are compared.
    let mut hasher = DefaultHasher::new();
    for path in files {
        path.to_string_lossy().hash(&mut hasher);
        fs::read(workspace.join(&path))?.hash(&mut hasher);
    }
    Ok(format!("{:016x}", hasher.finish()))
}

/// What of a crate goes into a program.
fn parts_of(name: &str) -> [String; 3] {
    ["Cargo.toml", "build.rs", "src"].map(|part| format!("crates/{name}/{part}"))
}

fn add_files(workspace: &Path, path: &Path, files: &mut BTreeSet<PathBuf>) -> io::Result<()> {
    let full = workspace.join(path);
    if full.is_file() {
        files.insert(path.to_owned());
    } else if full.is_dir() {
        for entry in fs::read_dir(full)? {
            add_files(workspace, &path.join(entry?.file_name()), files)?;
        }
    }
    Ok(())
}

/// The crate and all crates of the workspace below it, by the names of their folders.
fn crates_of(workspace: &Path, name: &str) -> io::Result<BTreeSet<String>> {
    let (mut known, mut open) = (BTreeSet::new(), vec![name.to_owned()]);
    while let Some(name) = open.pop() {
        if known.insert(name.clone()) {
            let manifest = fs::read_to_string(workspace.join("crates").join(&name).join("Cargo.toml"))?;
            open.extend(dependencies(&manifest));
        }
    }
    Ok(known)
}

/// The crates of the workspace under `[dependencies]` of a manifest.
fn dependencies(manifest: &str) -> Vec<String> {
    let lines = manifest.lines().skip_while(|line| line.trim() != "[dependencies]").skip(1);
    let names = lines.take_while(|line| !line.starts_with('[')).filter_map(|line| line.strip_prefix("crumple-"));
    names.map(|rest| rest.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '-').collect()).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;

    fn workspace() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        let write = |path: &str, text: &str| {
            let path = folder.path().join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        write("Cargo.lock", "lock");
        write("crates/a/Cargo.toml", "[dependencies]\ncrumple-b.workspace = true\n[dev-dependencies]\ncrumple-d = 1\n");
        write("crates/a/src/lib.rs", "a");
        write("crates/b/Cargo.toml", "[dependencies]\nserde = 1\n");
        write("crates/b/src/room/mod.rs", "b");
        write("crates/c/Cargo.toml", "");
        folder
    }

    #[test]
    fn the_digest_is_that_of_the_sources_wherever_they_lie() {
        let (one, other) = (workspace(), workspace());
        let digest = source_digest(one.path(), "a").unwrap();
        assert_eq!(digest.len(), 16);
        assert_eq!(digest, source_digest(other.path(), "a").unwrap());
    }

    #[test]
    fn a_change_in_the_crate_below_it_or_in_the_lock_changes_the_digest_and_no_other_does() {
        for (path, changes) in [
            ("crates/a/src/lib.rs", true),
            ("crates/b/src/room/mod.rs", true),
            ("crates/b/src/new.rs", true),
            ("Cargo.lock", true),
            ("crates/c/src/lib.rs", false),
            ("crates/a/tests/t.rs", false),
        ] {
            let folder = workspace();
            let before = source_digest(folder.path(), "a").unwrap();
            let path = folder.path().join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(&path, "changed").unwrap();
            assert_eq!(before != source_digest(folder.path(), "a").unwrap(), changes, "{}", path.display());
        }
    }
}
