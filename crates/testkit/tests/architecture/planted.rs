//! Every rule finds what breaks it.

use crate::sizes::{FILE_LINES, FUNCTION_LINES, WIDTH};
use crate::{Package, paths, sizes};

fn package(name: &str, manifest: &str, files: &[(&str, &str)]) -> Package {
    Package::new(name, manifest, files.iter().map(|(path, text)| ((*path).to_owned(), (*text).to_owned())))
}

/// One message with this text in it; none where the text is empty.
fn assert_broken(broken: &[String], text: &str) {
    let is_expected = if text.is_empty() { broken.is_empty() } else { broken.len() == 1 && broken[0].contains(text) };
    assert!(is_expected, "{text}: {broken:?}");
}

#[test]
fn layers_go_down() {
    let check = |name: &str, manifest: &str, library: &str| {
        sizes::broken_layers(&[package(name, manifest, &[("src/lib.rs", library)])])
    };
    assert_broken(&check("stage", "[dependencies]\ncrumple-signal.workspace = true\nclap = '4'", ""), "");
    assert_broken(&check("signal", "[dev-dependencies]\ncrumple-testkit = { path = '../testkit' }", ""), "");
    assert_broken(&check("signal", "[dependencies]\ncrumple-stage.workspace = true", ""), "signal uses stage");
    assert_broken(&check("filter", "[build-dependencies]\ncrumple-ingest = '1'", ""), "filter uses ingest");
    assert_broken(&check("unheard-of", "", ""), "has no layer");
    assert_broken(&check("metrics", "", "use std::{fmt, fs::File};"), "src/lib.rs:1: std::fs::File");
    assert_broken(&check("metrics", "", "fn f() {\n    print!(\"{}\", std::env::args());\n}"), "std::env::args");
    assert_broken(&check("metrics", "", "#[cfg(test)]\nmod tests {\n    use std::fs;\n}"), "");
}

#[test]
fn modules_use_each_other_in_no_circle() {
    let check = |library: &str, a: &str, b: &str| {
        let files = [("src/lib.rs", library), ("src/a/mod.rs", "mod inner;"), ("src/a/inner.rs", a), ("src/b.rs", b)];
        paths::broken(&package("x", "", &files))
    };
    let library = "mod a;\nmod b;\npub use b::B;";
    let of_a = "fn f() {\n    crate::a::g();\n}";
    assert_broken(&check(library, "use crate::b::B;", "use super::*;"), "");
    assert_broken(&check(library, "use crate::b::B;", "use crate::a::A;"), "src/a/inner.rs:1 a uses crate::b::B, ");
    assert_broken(&check(library, "use crate::B;", "use super::{fmt, a as other};"), "circle of modules");
    assert_broken(&check(library, "use super::super::b as other;", of_a), "src/b.rs:2 b uses crate::a::g");
    assert_broken(&check(library, "const X: &str = concat!(crate::b::NAME);", of_a), "circle of modules");
    assert_broken(&check(library, "#[cfg(test)]\nmod tests {\n    use crate::b::B;\n}", of_a), "");
    assert_broken(&check("mod b;\nuse b::B;", "", "use crate::LIMIT;"), "b uses crate::LIMIT, ");
    let of_errors = [
        ("src/lib.rs", "mod a;\nmod error;"),
        ("src/a.rs", "use crate::error::E;"),
        ("src/error.rs", "use crate::a::A;"),
    ];
    assert_broken(&paths::broken(&package("x", "", &of_errors)), "");
}

#[test]
fn files_functions_and_lines_are_short() {
    let check = |text: &str| sizes::broken(&package("x", "", &[("tests/it/main.rs", text)]));
    let function = |lines: usize| format!("//! X.\nimpl X {{\nfn long() {{\n{}}}\n}}\n", "f();\n".repeat(lines - 2));
    assert_broken(&check(&function(FUNCTION_LINES)), "");
    assert_broken(&check(&function(FUNCTION_LINES + 1)), "main.rs:3: function long");
    assert_broken(&check(&format!("//! X.\n{}", "\n".repeat(FILE_LINES - 1))), "");
    assert_broken(&check(&format!("//! X.\n{}", "\n".repeat(FILE_LINES))), "split it");
    assert_broken(&check(&format!("//! {}", "ä".repeat(WIDTH - 4))), "");
    assert_broken(&check(&format!("//! {}", "ä".repeat(WIDTH - 3))), "main.rs:1: 121 characters");
    assert_broken(&check("fn f() {}"), "does not open");
}
