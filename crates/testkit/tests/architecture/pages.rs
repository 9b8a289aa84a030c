//! The pages: each link leads to a file and to a heading in it, and the book has every page below `docs/`.

use std::fs;
use std::path::{Path, PathBuf};

/// Pages in a folder, with those of folders below where `deep`.
fn pages(folder: &Path, deep: bool) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let below = |path: PathBuf| if path.is_dir() && deep { pages(&path, deep) } else { vec![path] };
    entries.flat_map(below).filter(|path| path.extension().is_some_and(|extension| extension == "md")).collect()
}

/// The anchor of a line with a heading.
fn anchor(line: &str) -> String {
    let kept = line.trim_start_matches('#').chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.collect::<String>().trim().to_lowercase().replace(' ', "-")
}

/// Links of the pages of the project that lead nowhere, and pages that the table of contents of the book leaves out.
pub fn broken(root: &Path) -> Vec<String> {
    let docs = root.join("docs");
    let contents = fs::read_to_string(docs.join("SUMMARY.md")).unwrap();
    let is_in = |page: &PathBuf| page.ends_with("SUMMARY.md") || contents.contains(&format!("({})", page.display()));
    let below = pages(&docs, true).into_iter().map(|page| page.strip_prefix(&docs).unwrap().to_owned());
    let left_out =
        below.filter(|page| !is_in(page)).map(|page| format!("docs/{}: not in docs/SUMMARY.md", page.display()));
    let mut broken: Vec<String> = left_out.collect();
    for page in pages(root, false).into_iter().chain(pages(&docs, true)) {
        let text = fs::read_to_string(&page).unwrap();
        let links = text.split("](").skip(1).filter_map(|rest| Some(rest.split_once(')')?.0));
        for link in links.filter(|link| !link.contains([':', ' '])) {
            let (path, heading) = link.split_once('#').unwrap_or((link, ""));
            let target = if path.is_empty() { page.clone() } else { page.with_file_name(path) };
            let headings = fs::read_to_string(&target).unwrap_or_default();
            let mut headings = headings.lines().filter(|line| line.starts_with('#'));
            if !target.exists() || !heading.is_empty() && !headings.any(|line| anchor(line) == heading) {
                broken.push(format!("{}: {link} leads nowhere", page.display()));
            }
        }
    }
    broken
}

/// What names another version than the workspace: the citation, the first heading of the changelog.
pub fn other_versions(root: &Path) -> Vec<String> {
    let read = |name: &str| fs::read_to_string(root.join(name)).unwrap();
    let manifest: toml::Table = read("Cargo.toml").parse().unwrap();
    let version = manifest["workspace"]["package"]["version"].as_str().unwrap();
    let places = [("CITATION.cff", "version: "), ("CHANGELOG.md", "## ")];
    let names = |(file, mark): &(&str, &str)| {
        read(file).lines().find_map(|line| line.strip_prefix(mark)?.split(' ').next().map(str::to_owned))
    };
    let other = places.into_iter().filter(|place| names(place).as_deref() != Some(version));
    other.map(|(file, _)| format!("{file} does not name version {version}")).collect()
}
