//! The rules of the house: layers of crates, circles of modules, sizes of files and functions, links
//! of the pages.
//!
//! docs/adr/0004-rooms.md says why. Every rule takes packages and returns what breaks it, a line each.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod pages;
mod paths;
mod planted;
mod sizes;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// A package below `crates/`.
struct Package {
    /// Name of its folder.
    name: String,
    /// `Cargo.toml`.
    manifest: toml::Table,
    /// Its files of Rust by their path below its folder.
    files: BTreeMap<String, Source>,
}

/// A file of Rust.
struct Source {
    text: String,
    syntax: syn::File,
}

impl Package {
    fn new(name: &str, manifest: &str, texts: impl IntoIterator<Item = (String, String)>) -> Self {
        let source = |path: &str, text: String| {
            let syntax = syn::parse_file(&text).unwrap_or_else(|error| panic!("crates/{name}/{path}: {error}"));
            Source { text, syntax }
        };
        let files = texts.into_iter().map(|(path, text)| (path.clone(), source(&path, text))).collect();
        Self { name: name.to_owned(), manifest: manifest.parse().unwrap(), files }
    }

    fn read(folder: &Path) -> Self {
        let mut texts = Vec::new();
        read_rust(folder, folder, &mut texts);
        let manifest = fs::read_to_string(folder.join("Cargo.toml")).unwrap();
        Self::new(folder.file_name().unwrap().to_str().unwrap(), &manifest, texts)
    }
}

/// Paths relative to `base`, with `/`, and texts of all `*.rs` below a folder.
fn read_rust(base: &Path, folder: &Path, texts: &mut Vec<(String, String)>) {
    for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if path.is_dir() {
            read_rust(base, &path, texts);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let relative = path.strip_prefix(base).unwrap().to_str().unwrap().replace('\\', "/");
            texts.push((relative, fs::read_to_string(&path).unwrap()));
        }
    }
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn packages() -> Vec<Package> {
    let mut folders: Vec<PathBuf> =
        fs::read_dir(root().join("crates")).unwrap().map(|entry| entry.unwrap().path()).collect();
    folders.retain(|folder| folder.join("Cargo.toml").exists());
    folders.sort();
    folders.iter().map(|folder| Package::read(folder)).collect()
}

#[test]
fn the_house_keeps_its_rules() {
    let packages = packages();
    let mut broken = sizes::broken_layers(&packages);
    broken.extend(packages.iter().flat_map(paths::broken));
    broken.extend(packages.iter().flat_map(sizes::broken));
    broken.extend(pages::broken(&root()));
    broken.extend(pages::other_versions(&root()));
    assert!(broken.is_empty(), "{} rules broken\n{}", broken.len(), broken.join("\n"));
}

/// Files in which variables of the environment stand, below the root.
const WITH_VARIABLES: [&str; 10] =
    [".ci", "action.yml", "ci", "crates", "docs", "justfile", "page", "pipelines", "python", "scripts"];

/// Names of variables in a text: `CRUMPLE_` and what follows in capitals.
fn variables_in(text: &str) -> impl Iterator<Item = &str> {
    text.match_indices("CRUMPLE_").filter_map(|(at, prefix)| {
        let rest = &text[at + prefix.len()..];
        let length = rest.find(|c: char| !(c.is_ascii_uppercase() || c == '_')).unwrap_or(rest.len());
        let name = &text[at..at + prefix.len() + length];
        (length > 0 && !name.ends_with('_')).then_some(name)
    })
}

fn read_texts(path: &Path, texts: &mut Vec<(PathBuf, String)>) {
    if path.is_dir() {
        fs::read_dir(path).unwrap().for_each(|entry| read_texts(&entry.unwrap().path(), texts));
    } else if let Ok(text) = fs::read_to_string(path) {
        texts.push((path.to_owned(), text));
    }
}

#[test]
fn every_variable_that_the_project_reads_is_in_its_list() {
    let mut texts = Vec::new();
    WITH_VARIABLES.iter().for_each(|path| read_texts(&root().join(path), &mut texts));
    // Its tests name some that are none.
    texts.retain(|(path, _)| !path.ends_with("stage/src/environment.rs"));
    let known: Vec<&str> = crumple_stage::variables().collect();
    let unknown: Vec<String> = texts
        .iter()
        .flat_map(|(path, text)| variables_in(text).map(move |name| (path, name)))
        .filter(|(_, name)| !known.contains(name))
        .map(|(path, name)| format!("{}: {name} is not in crates/stage/src/environment.rs", path.display()))
        .collect();
    assert!(unknown.is_empty(), "{}", unknown.join("\n"));
    let unused: Vec<&&str> = known.iter().filter(|name| !texts.iter().any(|(_, text)| text.contains(**name))).collect();
    assert!(unused.is_empty(), "{unused:?} stand nowhere");
}
