//! Folders by what tells them apart.

use std::path::{Component, PathBuf};

/// The folders by what tells them apart: their paths without the folders that all begin with and the names that all
/// end with.
pub fn told_apart(folders: &[PathBuf]) -> Vec<String> {
    let parts = |folder: &PathBuf| -> Vec<String> {
        let named = folder.components().filter(|part| !matches!(part, Component::CurDir));
        named.map(|part| part.as_os_str().to_string_lossy().into_owned()).collect()
    };
    let mut all: Vec<Vec<String>> = folders.iter().map(parts).collect();
    let same = |all: &[Vec<String>], at: fn(&Vec<String>) -> Option<&String>| {
        all.iter().all(|parts| parts.len() > 1 && at(parts) == at(&all[0]))
    };
    while same(&all, |parts| parts.first()) {
        all.iter_mut().for_each(|parts| _ = parts.remove(0));
    }
    while same(&all, |parts| parts.last()) {
        all.iter_mut().for_each(|parts| _ = parts.pop());
    }
    all.into_iter().map(|parts| parts.join("/")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_are_called_by_what_tells_them_apart() {
        let of = |folders: &[&str]| told_apart(&folders.iter().map(PathBuf::from).collect::<Vec<_>>());
        assert_eq!(of(&["runs/a/default", "runs/b/default"]), ["a", "b"]);
        assert_eq!(of(&["runs/a/default/", "./runs/a/unfiltered"]), ["default", "unfiltered"]);
        assert_eq!(of(&["a", "a/x"]), ["a", "a/x"]);
        assert_eq!(of(&["a", "a"]), ["a", "a"]);
    }
}
