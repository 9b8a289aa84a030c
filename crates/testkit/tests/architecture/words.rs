//! Rules 6 to 9: sizes of files and functions, their first line, line lengths, names, notes.

use std::collections::BTreeMap;

use crate::layers::{PROGRAMS, layer};
use crate::modules::Modules;
use crate::rule::Violation;
use crate::source::{Package, Source};

/// Most lines of a file without tests.
const FILE_LINES: usize = 600;
/// Most lines of a function.
const FUNCTION_LINES: usize = 100;
/// Most characters of a line.
const WIDTH: usize = 120;

/// Names that say nothing, or that the field does not use.
const BANNED: [&str; 11] =
    ["found", "further", "unused", "verdict", "knowledge", "adoption", "twins", "utils", "common", "helpers", "misc"];

/// Rules 6, 7 and 9 on one file, and the names of rule 8 in it.
pub fn check_file(source: &Source) -> Vec<Violation> {
    let mut violations = check_form(source);
    let lines = source.lines();
    if lines > FILE_LINES {
        let message = format!("{lines} lines without tests, {FILE_LINES} at most: split it by subject");
        violations.push(Violation::of_file(6, source, 1, message));
    }
    violations.extend(functions(source).into_iter().filter(|(_, _, lines)| *lines > FUNCTION_LINES).map(
        |(name, line, lines)| Violation {
            rule: 6,
            subject: format!("{}::{name}", source.path),
            line,
            message: format!("function {name} has {lines} lines, {FUNCTION_LINES} at most: give its steps names"),
        },
    ));
    violations.extend(check_names(source));
    for (line, text) in source.with_strings.lines().enumerate() {
        let dense: String = text.chars().filter(|c| !c.is_whitespace()).collect();
        let parses = ["starts_with(\"warning", "strip_prefix(\"warning"].iter().any(|call| dense.contains(call));
        let searches = dense.find(".contains(").is_some_and(|at| dense[..at].contains("note"));
        if parses || searches {
            let message = "a note is a Note with its severity: match on that, never on its text";
            violations.push(Violation::of_file(9, source, line + 1, message.to_owned()));
        }
    }
    violations
}

/// Rule 7: the first line says what the file is, and no line is too long. Holds for tests, benchmarks and examples too.
pub fn check_form(source: &Source) -> Vec<Violation> {
    let mut violations = Vec::new();
    if !source.text.starts_with("//!") {
        let message = "the file does not open with //!: say in a line what is in it";
        violations.push(Violation::of_file(7, source, 1, message.to_owned()));
    }
    for (line, text) in source.text.lines().enumerate() {
        let width = text.chars().count();
        if width > WIDTH {
            let message = format!("{width} characters, {WIDTH} at most: break the line");
            violations.push(Violation::of_file(7, source, line + 1, message));
        }
    }
    violations
}

/// Functions with a body: name, first line from 1, number of lines.
fn functions(source: &Source) -> Vec<(String, usize, usize)> {
    let tokens = source.tokens();
    let mut functions = Vec::new();
    for (at, pair) in tokens.windows(2).enumerate() {
        if pair[0].text != "fn" || pair[1].text == "(" {
            continue;
        }
        let mut depth = 0_usize;
        for token in &tokens[at..] {
            match token.text.as_str() {
                "{" => depth += 1,
                "}" if depth == 1 => {
                    functions.push((pair[1].text.clone(), pair[0].line + 1, token.line + 1 - pair[0].line));
                    break;
                }
                "}" => depth -= 1,
                ";" if depth == 0 => break,
                _ => {}
            }
        }
    }
    functions
}

/// Words of `snake_case` or `CamelCase`, in small letters.
fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    for c in name.chars() {
        if c == '_' || c == '-' {
            words.push(String::new());
        } else if c.is_uppercase() || words.is_empty() {
            words.push(c.to_lowercase().to_string());
        } else if let Some(word) = words.last_mut() {
            word.push(c);
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

fn is_banned(name: &str) -> bool {
    let words = words(name);
    let first = words.first().map_or("", String::as_str);
    words.len() > 1 && ["by", "beyond"].contains(&first)
        || words.join("_") == "to_records"
        || words.iter().any(|word| BANNED.contains(&word.as_str()) || word.starts_with("judg"))
}

/// Types that a file defines: name, line from 1, whether they are `pub`.
fn types(source: &Source) -> Vec<(String, usize, bool)> {
    let tokens = source.tokens();
    let is_type = |word: &str| ["struct", "enum", "trait", "union", "type"].contains(&word);
    let mut depth = 0_usize;
    let mut types = Vec::new();
    for (at, token) in tokens.iter().enumerate() {
        match token.text.as_str() {
            "{" => depth += 1,
            "}" => depth = depth.saturating_sub(1),
            word if is_type(word) && depth == 0 => {
                let is_public = at > 0 && tokens[at - 1].text == "pub";
                types.extend(tokens.get(at + 1).map(|name| (name.text.clone(), name.line + 1, is_public)));
            }
            _ => {}
        }
    }
    types
}

/// What to do about a banned name.
const ADVICE: &str = "name the thing in the field's words: assessment, covariance, test data, redundant sensors ...; \
                      docs/adr/0004-rooms.md";

/// Rule 8: names of files, folders and types.
fn check_names(source: &Source) -> Vec<Violation> {
    let mut violations = Vec::new();
    let inside = source.path.split_once("/src/").map_or("", |(_, inside)| inside).trim_end_matches(".rs");
    for name in inside.split('/').filter(|name| is_banned(name)) {
        let message = format!("the name {name} says nothing to a stranger: {ADVICE}");
        violations.push(Violation::of_file(8, source, 1, message));
    }
    for (name, line, _) in types(source).into_iter().filter(|(name, ..)| is_banned(name)) {
        let message = format!("the type {name} says nothing to a stranger: {ADVICE}");
        violations.push(Violation { rule: 8, subject: format!("{}::{name}", source.path), line, message });
    }
    violations
}

/// Rule 8: the name of a type that a library hands out occurs once a layer above `signal`. Programs never meet: there
/// it holds for each one's library, and for the public types of its `stage/`.
pub fn check_type_names(packages: &[Package]) -> Vec<Violation> {
    let mut violations = Vec::new();
    let mut places: BTreeMap<(String, String), (String, usize)> = BTreeMap::new();
    for package in packages {
        let Some(number) = layer(&package.name).filter(|number| *number > 0) else { continue };
        let of_programs = number >= PROGRAMS;
        let exported = Modules::new(package).exported();
        let stage = format!("crates/{}/src/stage/", package.name);
        for (index, source) in package.sources.iter().enumerate() {
            for (name, line, is_public) in types(source) {
                let group = match (source.path.starts_with(&stage), of_programs) {
                    (true, _) => stage.clone(),
                    (false, true) => package.name.clone(),
                    (false, false) => format!("layer {number}"),
                };
                if !is_public || group != stage && !exported.contains(&(index, name.clone())) {
                    continue;
                }
                let place = (source.path.clone(), line);
                let (other, at) = places.entry((group, name.clone())).or_insert_with(|| place.clone());
                if (&*other, *at) != (&place.0, place.1) {
                    let message = format!("{name} is a public type of {other}:{at} too: give one another name");
                    violations.push(Violation { rule: 8, subject: format!("{}::{name}", source.path), line, message });
                }
            }
        }
    }
    violations
}
