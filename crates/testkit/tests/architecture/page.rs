//! The section "Rooms" of ARCHITECTURE.md: one line a room, taken from the rooms' own `mod.rs`, so that it cannot age.
//!
//! `CRUMPLE_WRITE_ROOMS=1` writes it (`just rooms`), else it is compared.

use std::fmt::Write;
use std::path::Path;

use crate::source::{Package, Source, packages};

const BEGIN: &str = "<!-- rooms: from the mod.rs of each, written by `just rooms` -->\n";
const END: &str = "<!-- end of rooms -->\n";

/// The text of the first paragraph of a file's `//!`, the line `rooms:` left out, on one line.
fn purpose(source: &Source) -> String {
    let head = source.text.lines().map_while(|line| line.strip_prefix("//!")).map(str::trim);
    let paragraph: Vec<&str> = head.take_while(|line| !line.is_empty() && !line.starts_with("rooms:")).collect();
    let mut text = paragraph.join(" ");
    // A link into the crate is its name here.
    while let Some(start) = text.find("](crate::") {
        let Some(length) = text[start..].find(')') else { break };
        text.replace_range(start..=start + length, "");
        if let Some(bracket) = text[..start].rfind('[') {
            text.remove(bracket);
        }
    }
    text
}

/// The line `rooms:` of a crate's `lib.rs`, continued lines joined.
fn order(package: &Package) -> Option<String> {
    let lib = package.sources.iter().find(|source| source.path.ends_with("/src/lib.rs"))?;
    let mut lines = lib.text.lines().skip_while(|line| !line.starts_with("//! rooms:"));
    let mut order = lines.next()?.trim_start_matches("//! rooms:").trim().to_owned();
    for line in lines.take_while(|line| line.starts_with("//! |")) {
        write!(order, " {}", line.trim_start_matches("//!").trim()).unwrap();
    }
    Some(order)
}

fn section(root: &Path) -> String {
    let mut text = String::new();
    for package in packages(root) {
        let src = format!("crates/{}/src/", package.name);
        let order = order(&package).map_or(String::new(), |order| format!(", in the order `{order}`"));
        writeln!(text, "\n`{src}`{order}\n").unwrap();
        let mut rooms: Vec<(&str, &Source)> = package
            .sources
            .iter()
            .filter_map(|source| Some((source.path.strip_prefix(&src)?.strip_suffix("mod.rs")?, source)))
            .collect();
        rooms.sort_by_key(|(room, _)| *room);
        for (room, source) in rooms {
            let indent = "  ".repeat(room.matches('/').count() - 1);
            writeln!(text, "{indent}- `{room}` {}", purpose(source)).unwrap();
        }
    }
    text.push('\n');
    text
}

#[test]
fn the_page_names_every_room() {
    let root = crate::root();
    let path = root.join("ARCHITECTURE.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let (before, rest) = page.split_once(BEGIN).expect("ARCHITECTURE.md has the line that begins the rooms");
    let (written, after) = rest.split_once(END).expect("ARCHITECTURE.md has the line that ends the rooms");
    let rooms = section(&root);
    if std::env::var_os("CRUMPLE_WRITE_ROOMS").is_some() {
        std::fs::write(&path, format!("{before}{BEGIN}{rooms}{END}{after}")).unwrap();
        return;
    }
    let stale = written.lines().find(|line| !rooms.lines().any(|room| room == *line));
    let absent = rooms.lines().find(|room| !written.lines().any(|line| line == *room));
    assert!(written == rooms, "ARCHITECTURE.md: run `just rooms`; stale: {stale:?}, absent: {absent:?}");
}
