//! Rules 3, 4 and 5: what lies where in `src`, in which direction the rooms use each other, and who knows the stage.

use std::collections::BTreeMap;

use crate::modules::{Arrow, line_of_path};
use crate::rule::Violation;
use crate::source::{Package, Source};

/// Most files of a folder.
const FILES: usize = 14;
/// Most lines of a folder's files without tests.
const LINES: usize = 2_400;
/// What lies in `src` and belongs to programs.
const PROGRAMS: [&str; 3] = ["stage", "bin", "main.rs"];
/// Most lines of a stage's `main.rs`.
const MAIN_LINES: usize = 30;

/// Rule 3: folders are rooms of a size that can be read.
pub fn check_layout(package: &Package) -> Vec<Violation> {
    let root = format!("crates/{}/src", package.name);
    let mut violations = Vec::new();
    let mut folders: BTreeMap<&str, Vec<&Source>> = BTreeMap::new();
    for source in &package.sources {
        folders.entry(source.folder()).or_default().push(source);
    }
    for (folder, sources) in folders {
        if folder == root {
            let verb = package.name.replace('-', "_");
            let mut more: Vec<&&Source> =
                sources.iter().filter(|source| !["lib", "main", "error"].contains(&source.stem())).collect();
            if let Some(place) = more.iter().position(|source| verb.contains(source.stem())) {
                more.remove(place);
            }
            violations.extend(more.into_iter().map(|source| {
                let message =
                    "only lib.rs, main.rs, error.rs and one file named after the crate lie in src: move it into a room";
                Violation::of_file(3, source, 1, message.to_owned())
            }));
            continue;
        }
        if folder == format!("{root}/bin") {
            continue;
        }
        let lines: usize = sources.iter().map(|source| source.lines()).sum();
        let mut broken = |message: String| {
            violations.push(Violation { rule: 3, subject: folder.to_owned(), line: 1, message });
        };
        if sources.len() > FILES || lines > LINES {
            broken(format!(
                "{} files and {lines} lines without tests, {FILES} and {LINES} at most: make two rooms of it",
                sources.len()
            ));
        }
        match sources.iter().find(|source| source.stem() == "mod") {
            None => broken("a room has a mod.rs that says what is in it and what it may use: add one".to_owned()),
            Some(source) if source.text.lines().take_while(|line| line.starts_with("//!")).count() < 2 => {
                let message = "a room's mod.rs opens with two lines of //!: what is in it, and what it may use";
                violations.push(Violation::of_file(3, source, 1, message.to_owned()));
            }
            Some(_) => {}
        }
    }
    violations
}

/// Rule 4: the line `//! rooms: a | b c | d` of `lib.rs`, or of a folder's `mod.rs`, is the order in which its rooms
/// use each other.
pub fn check_order(package: &Package, arrows: &[Arrow]) -> Vec<Violation> {
    let root = format!("crates/{}/src", package.name);
    let mut violations = Vec::new();
    let of_root = |name: &str| package.sources.iter().find(|source| source.path == format!("{root}/{name}.rs"));
    let mut heads: Vec<&Source> = of_root("lib").or_else(|| of_root("main")).into_iter().collect();
    heads.extend(package.sources.iter().filter(|source| source.stem() == "mod"));
    for head in heads {
        let folder = head.folder();
        let line = head.text.lines().position(|line| line.starts_with("//! rooms:"));
        let is_required = folder == root || folder == format!("{root}/stage");
        let mut below: Vec<&str> = package.sources.iter().filter_map(|source| room_of(folder, source)).collect();
        below.retain(|name| !name.ends_with(".rs") && (folder != root || !PROGRAMS.contains(name)));
        below.sort_unstable();
        below.dedup();
        let Some(line) = line else {
            if is_required && !below.is_empty() {
                let message = format!("no line `//! rooms: a | b c | d` that orders {}: add it", below.join(", "));
                violations.push(Violation::of_file(4, head, 1, message));
            }
            continue;
        };
        let text = order_text(head, line);
        let order: Vec<Vec<&str>> = text.split('|').map(|group| group.split_whitespace().collect()).collect();
        let place = |room: &str| order.iter().position(|group| group.contains(&room.trim_end_matches(".rs")));
        let mut broken = |source: &Source, line: usize, message: String| {
            violations.push(Violation::of_file(4, source, line, message));
        };
        for room in &below {
            if place(room).is_none() {
                broken(head, line + 1, format!("room {room} is not in the order of the rooms: add it"));
            }
        }
        for room in order.iter().flatten() {
            let is_there = package.sources.iter().filter_map(|source| room_of(folder, source));
            if !is_there.into_iter().any(|name| name.trim_end_matches(".rs") == *room) {
                broken(head, line + 1, format!("there is no room {room}: take it out of the order"));
            }
        }
        for arrow in arrows {
            // Programs stand above the library's rooms.
            let is_program = |source: &Source| room_of(&root, source).is_some_and(|room| PROGRAMS.contains(&room));
            if folder == root && is_program(&package.sources[arrow.from]) {
                continue;
            }
            let (from, to) = (&package.sources[arrow.from], &package.sources[arrow.to]);
            let (Some(user), Some(used)) = (room_of(folder, from), room_of(folder, to)) else { continue };
            if user == used || ["error.rs", "mod.rs", "lib.rs"].contains(&used) {
                continue;
            }
            let message = |what: &str| format!("{user} uses {} of {used}, {what}: move it", arrow.name);
            match (place(user), place(used)) {
                (Some(a), Some(b)) if b < a => broken(from, arrow.line, message("which stands above it")),
                (Some(a), Some(b)) if a == b => broken(from, arrow.line, message("which stands beside it")),
                (Some(_), None) if folder == root && used.ends_with(".rs") => {
                    broken(from, arrow.line, message("which stands above all rooms"));
                }
                _ => {}
            }
        }
    }
    violations
}

/// The order from this line on; it goes on where a line ends or begins with `|`.
fn order_text(head: &Source, line: usize) -> String {
    let lines = head.text.lines().skip(line).map(|line| line.trim_start_matches("//!").trim());
    let mut text = String::new();
    for line in lines {
        if !text.is_empty() && !text.ends_with('|') && !line.starts_with('|') {
            break;
        }
        text += line;
    }
    text.trim_start_matches("rooms:").to_owned()
}

/// The file or folder of `folder` that the source is or lies in.
fn room_of<'a>(folder: &str, source: &'a Source) -> Option<&'a str> {
    let rest = source.path.strip_prefix(folder)?.strip_prefix('/')?;
    Some(rest.split('/').next().unwrap_or(rest))
}

/// Rule 5: in a stage's package `main.rs` is short, only `main.rs` and `stage/` know the stage, and ingest reads files
/// in `files/`.
pub fn check_stage(package: &Package) -> Vec<Violation> {
    let uses_stage = package
        .manifest
        .get("dependencies")
        .and_then(toml::Value::as_table)
        .is_some_and(|table| table.contains_key("crumple-stage"));
    let root = format!("crates/{}/src", package.name);
    let mut violations = Vec::new();
    // They start programs and compute nothing of a test: all of them may know the stage.
    if uses_stage && !["run", "fleet"].contains(&package.name.as_str()) {
        for source in &package.sources {
            let inside = source.path.strip_prefix(&root).unwrap_or_default();
            let is_program = inside == "/main.rs" || inside.starts_with("/stage/") || inside.starts_with("/bin/");
            let named = source.tokens().iter().find(|token| token.text == "crumple_stage").map(|token| token.line + 1);
            if let (false, Some(line)) = (is_program, named) {
                let message = "the library names crumple_stage: only main.rs and stage/ do; move this into stage/";
                violations.push(Violation::of_file(5, source, line, message.to_owned()));
            }
            let lines = source.text.lines().count();
            if inside == "/main.rs" && lines > MAIN_LINES {
                let message = format!("{lines} lines of main, {MAIN_LINES} at most: move the rest into stage/");
                violations.push(Violation::of_file(5, source, 1, message));
            }
        }
    }
    if package.name == "ingest" {
        for source in package.sources.iter().filter(|s| !s.path.starts_with(&format!("{root}/files/"))) {
            violations.extend(line_of_path(source, &["std", "fs"]).map(|line| {
                let message = "std::fs outside of files/: read the file there and hand over what is in it";
                Violation::of_file(5, source, line, message.to_owned())
            }));
        }
    }
    violations
}
