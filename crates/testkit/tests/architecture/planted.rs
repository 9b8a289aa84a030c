//! Each rule names a violation that is planted in a small workspace.

use std::fs;
use std::path::Path;

use crate::{exceptions, violations};

/// A workspace that keeps every rule: numerics of two rooms, and a stage.
const SOUND: [(&str, &str); 12] = [
    ("crates/lti/Cargo.toml", "[dependencies]\ncrumple-linalg.workspace = true\n"),
    (
        "crates/lti/src/lib.rs",
        "//! Systems.\n//! rooms: poles | matrix\n\nmod error;\nmod matrix;\nmod poles;\n\npub use poles::poles;\n",
    ),
    ("crates/lti/src/error.rs", "//! What can go wrong.\n\n/// It.\npub struct LtiError;\n"),
    (
        "crates/lti/src/matrix/mod.rs",
        "//! Matrices.\n//! May use `error` alone.\n\nmod eigen;\n\npub use eigen::{Eigen, eigen};\n",
    ),
    (
        "crates/lti/src/matrix/eigen.rs",
        "//! Eigenvalues.\n\nuse crate::error::LtiError;\n\n/// Some.\npub struct Eigen;\n\n/// Finds them.\n\
         pub fn eigen() -> Result<Eigen, LtiError> {\n    Ok(Eigen)\n}\n",
    ),
    ("crates/lti/src/poles/mod.rs", "//! Poles.\n//! May use `matrix`.\n\nmod find;\n\npub use find::poles;\n"),
    (
        "crates/lti/src/poles/find.rs",
        "//! Finds poles.\n\nuse crate::matrix;\n\n/// Finds them.\npub fn poles() {\n    let _ = \
         matrix::eigen();\n}\n",
    ),
    ("crates/linalg/Cargo.toml", "[dependencies]\n"),
    ("crates/filter/Cargo.toml", "[dependencies]\ncrumple-stage.workspace = true\ncrumple-lti.workspace = true\n"),
    ("crates/filter/src/lib.rs", "//! Filters.\n\nmod filter;\n\npub use filter::filter;\n"),
    ("crates/filter/src/filter.rs", "//! Filters a signal.\n\n/// Filters.\npub fn filter() {}\n"),
    ("crates/filter/src/main.rs", "//! The program.\n\nfn main() {\n    crumple_stage::main();\n}\n"),
];

/// What is said of the sound workspace with these files in the place of its own or beside them.
fn said_of(planted: &[(&str, &str)]) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    for (path, text) in SOUND.iter().chain(planted) {
        let path = folder.path().join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    violations(folder.path()).iter().map(ToString::to_string).collect()
}

/// The only violation is this one.
fn names(planted: &[(&str, &str)], place: &str, words: &[&str]) {
    let said = said_of(planted);
    assert_eq!(said.len(), 1, "{said:#?}");
    assert!(said[0].starts_with(place), "{said:?}");
    for word in words {
        assert!(said[0].contains(word), "{word}: {said:?}");
    }
}

const FIND: &str = "crates/lti/src/poles/find.rs";

#[test]
fn a_sound_workspace_is_left_alone() {
    assert_eq!(said_of(&[]), Vec::<String>::new());
}

#[test]
fn names_a_planted_arrow_between_crates() {
    let manifest = ("crates/lti/Cargo.toml", "[dependencies]\ncrumple-lumped.workspace = true\n");
    names(&[manifest], "crates/lti/Cargo.toml:1: rule 1:", &["lti depends on lumped"]);
    let manifest = ("crates/filter/Cargo.toml", "[dependencies]\ncrumple-testkit.workspace = true\n");
    names(&[manifest], "crates/filter/Cargo.toml:1: rule 1:", &["[dev-dependencies]"]);
    names(&[("crates/extra/Cargo.toml", "")], "crates/extra/Cargo.toml:1: rule 1:", &["has no layer"]);
}

#[test]
fn names_a_planted_stage_that_uses_a_stage() {
    let manifest = ("crates/filter/Cargo.toml", "[dependencies]\ncrumple-ingest.workspace = true\n");
    names(&[manifest], "crates/filter/Cargo.toml:1: rule 1:", &["filter depends on ingest"]);
}

#[test]
fn names_planted_files_in_numerics() {
    let file = (FIND, "//! Finds poles.\n\n/// Finds them.\npub fn poles() {\n    let _ = std::fs::read(\"a\");\n}\n");
    names(&[file], "crates/lti/src/poles/find.rs:5: rule 1:", &["std::fs", "do it in the stage"]);
    let group = "//! Finds poles.\n\nuse std::{fmt, fs::{self, File}};\n\n/// Finds them.\npub fn poles() {}\n";
    names(&[(FIND, group)], "crates/lti/src/poles/find.rs:3: rule 1:", &["std::fs"]);
    let other = "//! Finds poles.\n\nuse anyhow::Context;\n\n/// Finds them.\npub fn poles() {}\n";
    names(&[(FIND, other)], "crates/lti/src/poles/find.rs:3: rule 1:", &["anyhow"]);
}

#[test]
fn names_a_planted_circle_of_files_through_a_re_export() {
    let files = [
        (
            "crates/lti/src/matrix/mod.rs",
            "//! Matrices.\n//! May use `error`.\n\nmod eigen;\nmod sort;\n\npub use eigen::{Eigen, eigen};\npub use \
             sort::sorted;\n",
        ),
        (
            "crates/lti/src/matrix/eigen.rs",
            "//! Eigenvalues.\n\n/// Some.\npub struct Eigen;\n\n/// Finds them.\npub fn eigen() -> Eigen {\n    \
             crate::matrix::sorted(Eigen)\n}\n",
        ),
        (
            "crates/lti/src/matrix/sort.rs",
            "//! Sorts.\n\nuse super::Eigen;\n\n/// Sorts.\npub fn sorted(eigen: Eigen) -> Eigen {\n    eigen\n}\n",
        ),
    ];
    let words = [
        "circle of files",
        "matrix/eigen.rs:8 uses sorted of matrix/sort.rs",
        "matrix/sort.rs:3 uses Eigen of matrix/eigen.rs",
    ];
    names(&files, "crates/lti/src/matrix/eigen.rs:8: rule 2:", &words);
}

#[test]
fn names_a_planted_circle_of_folders() {
    // The order of the rooms is broken by it too.
    let files = [
        (
            "crates/lti/src/matrix/mod.rs",
            "//! Matrices.\n//! May use `error`.\n\nmod eigen;\nmod sort;\n\npub use eigen::eigen;\n",
        ),
        ("crates/lti/src/matrix/eigen.rs", "//! Eigenvalues.\n\n/// Finds them.\npub fn eigen() {}\n"),
        (
            "crates/lti/src/matrix/sort.rs",
            "//! Sorts.\n\nuse crate::poles;\n\n/// Sorts.\npub fn sort() {\n    poles::poles();\n}\n",
        ),
    ];
    let said = said_of(&files);
    assert_eq!(said.len(), 2, "{said:#?}");
    assert!(said[0].contains("rule 2: circle of folders") && said[0].contains("matrix/sort.rs:3"), "{said:#?}");
    assert!(said[1].starts_with("crates/lti/src/matrix/sort.rs:3: rule 4:"), "{said:#?}");
}

#[test]
fn names_a_planted_file_outside_of_the_rooms() {
    let file = ("crates/lti/src/roots.rs", "//! Roots.\n");
    names(&[file], "crates/lti/src/roots.rs:1: rule 3:", &["move it into a room"]);
}

#[test]
fn names_a_planted_room_that_is_too_large_or_says_nothing() {
    let paths: Vec<String> = (0..13).map(|k| format!("crates/lti/src/poles/p{k}.rs")).collect();
    let files: Vec<(&str, &str)> = paths.iter().map(|path| (path.as_str(), "//! One.\n")).collect();
    names(&files, "crates/lti/src/poles:1: rule 3:", &["15 files", "make two rooms of it"]);
    let paths: Vec<String> = (0..5).map(|k| format!("crates/lti/src/poles/p{k}.rs")).collect();
    let long = format!("//! One.\n{}", "const A: f64 = 1.0;\n".repeat(550));
    let files: Vec<(&str, &str)> = paths.iter().map(|path| (path.as_str(), long.as_str())).collect();
    names(&files, "crates/lti/src/poles:1: rule 3:", &["lines without tests"]);
    let head = ("crates/lti/src/poles/mod.rs", "//! Poles.\n\nmod find;\n\npub use find::poles;\n");
    names(&[head], "crates/lti/src/poles/mod.rs:1: rule 3:", &["two lines"]);
}

#[test]
fn names_a_planted_arrow_up_between_rooms() {
    let order =
        ("crates/lti/src/lib.rs", "//! Systems.\n//! rooms: matrix | poles\n\nmod error;\nmod matrix;\nmod poles;\n");
    names(&[order], "crates/lti/src/poles/find.rs:7: rule 4:", &["poles uses eigen of matrix", "stands above"]);
    let order =
        ("crates/lti/src/lib.rs", "//! Systems.\n//! rooms: matrix poles\n\nmod error;\nmod matrix;\nmod poles;\n");
    names(&[order], "crates/lti/src/poles/find.rs:7: rule 4:", &["stands beside"]);
    let order = ("crates/lti/src/lib.rs", "//! Systems.\n\nmod error;\nmod matrix;\nmod poles;\n");
    names(&[order], "crates/lti/src/lib.rs:1: rule 4:", &["matrix, poles"]);
    let order = ("crates/lti/src/lib.rs", "//! Systems.\n//! rooms: poles\n\nmod error;\nmod matrix;\nmod poles;\n");
    names(&[order], "crates/lti/src/lib.rs:2: rule 4:", &["room matrix is not in the order"]);
}

#[test]
fn names_a_planted_library_that_knows_the_stage() {
    let file = (
        "crates/filter/src/filter.rs",
        "//! Filters.\n\n/// Filters.\npub fn filter() {\n    crumple_stage::say();\n}\n",
    );
    names(&[file], "crates/filter/src/filter.rs:5: rule 5:", &["move this into stage/"]);
    let long = format!("//! The program.\n{}", "const A: f64 = 1.0;\n".repeat(31));
    names(&[("crates/filter/src/main.rs", &long)], "crates/filter/src/main.rs:1: rule 5:", &["32 lines of main"]);
}

#[test]
fn names_a_planted_reader_that_opens_files() {
    let files = [
        ("crates/ingest/Cargo.toml", "[dependencies]\n"),
        ("crates/ingest/src/lib.rs", "//! Reads.\n\nmod ingest;\n"),
        (
            "crates/ingest/src/ingest.rs",
            "//! Reads.\n\nuse std::fs;\n\n/// Reads.\npub fn read() {\n    let _ = fs::read(\"a\");\n}\n",
        ),
    ];
    names(&files, "crates/ingest/src/ingest.rs:3: rule 5:", &["outside of files/"]);
}

#[test]
fn names_a_planted_file_or_function_that_is_too_long() {
    let long = format!("//! Finds poles.\n{}\n/// It.\npub fn poles() {{}}\n", "const A: f64 = 1.0;\n".repeat(600));
    names(&[(FIND, &long)], "crates/lti/src/poles/find.rs:1: rule 6:", &["split it"]);
    let long = format!("//! Finds poles.\n\n/// It.\npub fn poles() {{\n{}}}\n", "    let _ = 1;\n".repeat(99));
    names(&[(FIND, &long)], "crates/lti/src/poles/find.rs:4: rule 6:", &["function poles has 101 lines"]);
    let tests = format!(
        "//! Finds poles.\n\n/// It.\npub fn poles() {{}}\n\n#[cfg(test)]\nmod tests {{\n{}}}\n",
        "    const A: f64 = 1.0;\n".repeat(500)
    );
    assert_eq!(said_of(&[(FIND, &tests)]), Vec::<String>::new(), "tests do not count");
}

#[test]
fn names_a_planted_file_without_its_first_line_and_a_line_that_is_too_long() {
    names(&[(FIND, "/// It.\npub fn poles() {}\n")], "crates/lti/src/poles/find.rs:1: rule 7:", &["//!"]);
    let wide = format!("//! Tests.\n// {}\n", "x".repeat(118));
    names(&[("crates/lti/tests/t.rs", &wide)], "crates/lti/tests/t.rs:2: rule 7:", &["121 characters"]);
}

#[test]
fn names_a_planted_type_name_that_occurs_twice() {
    let files = [
        ("crates/artifact/Cargo.toml", "[dependencies]\n"),
        ("crates/artifact/src/lib.rs", "//! Artifacts.\n\n/// One.\npub struct Eigen;\n"),
        ("crates/lti/src/poles/find.rs", "//! Finds poles.\n\nstruct Eigen;\n\n/// It.\npub fn poles() {}\n"),
        (
            "crates/lti/src/lib.rs",
            "//! Systems.\n//! rooms: poles | matrix\n\nmod error;\nmod matrix;\nmod poles;\n\npub use \
             matrix::Eigen;\n",
        ),
    ];
    names(
        &files,
        "crates/lti/src/matrix/eigen.rs:6: rule 8:",
        &["Eigen is a public type of crates/artifact/src/lib.rs:4"],
    );
}

#[test]
fn names_a_planted_word_that_says_nothing() {
    for name in ["found", "further_sensors", "judging", "by_era", "beyond_era", "to_records", "utils"] {
        let path = format!("crates/lti/src/poles/{name}.rs");
        names(&[(&path, "//! One.\n")], &format!("{path}:1: rule 8:"), &[name, "field's word"]);
    }
    for name in ["Found", "ChainVerdict", "ByEra", "JudgeOptions"] {
        let text = format!("//! Finds poles.\n\nenum {name} {{}}\n\n/// It.\npub fn poles() {{}}\n");
        names(&[(FIND, &text)], "crates/lti/src/poles/find.rs:3: rule 8:", &[name]);
    }
    for name in ["Standby", "Foundation", "Reused"] {
        let text = format!("//! Finds poles.\n\nenum {name} {{}}\n\n/// It.\npub fn poles() {{}}\n");
        assert_eq!(said_of(&[(FIND, &text)]), Vec::<String>::new(), "{name}");
    }
}

#[test]
fn names_a_planted_note_that_is_read_as_text() {
    for call in [
        "text.starts_with(\"warning: \")",
        "text.strip_prefix(\"warning: \")",
        "notes.iter().any(|n| n.contains(text))",
    ] {
        let text = format!("//! Finds poles.\n\n/// It.\npub fn poles() {{\n    let _ = {call};\n}}\n");
        names(&[(FIND, &text)], "crates/lti/src/poles/find.rs:5: rule 9:", &["match on that"]);
    }
}

#[test]
fn names_a_planted_crate_that_is_too_large() {
    let long = format!("//! One.\n{}", "const A: f64 = 1.0;\n".repeat(440));
    let mut files: Vec<(String, String)> = Vec::new();
    for room in 0..6 {
        files.push((format!("crates/lti/src/matrix/r{room}/mod.rs"), "//! One.\n//! May use nothing.\n".to_owned()));
        files.extend((0..4).map(|k| (format!("crates/lti/src/matrix/r{room}/f{k}.rs"), long.clone())));
    }
    let files: Vec<(&str, &str)> = files.iter().map(|(path, text)| (path.as_str(), text.as_str())).collect();
    names(&files, "crates/lti:1: rule 10:", &["make two of it"]);
}

#[test]
fn an_exception_covers_its_violation_and_is_named_when_nothing_needs_it() {
    let folder = tempfile::tempdir().unwrap();
    let list = folder.path().join("crates/testkit/tests/architecture/exceptions.toml");
    fs::create_dir_all(list.parent().unwrap()).unwrap();
    let one =
        |rule: u8, subject: &str| format!("[[exception]]\nrule = {rule}\nsubject = \"{subject}\"\nreason = \"a\"\n");
    fs::write(&list, one(7, "crates/lti/src/roots.rs") + &one(3, "crates/lti/src/gone.rs")).unwrap();
    let roots = folder.path().join("crates/lti/src/roots.rs");
    fs::create_dir_all(roots.parent().unwrap()).unwrap();
    fs::write(Path::new(&roots), "mod a;\n").unwrap();
    fs::write(folder.path().join("crates/lti/Cargo.toml"), "").unwrap();
    let exceptions = exceptions::read(folder.path());
    let (left, needless) = exceptions::apply(violations(folder.path()), &exceptions);
    assert_eq!(left.iter().map(|violation| violation.rule).collect::<Vec<_>>(), [3], "{left:?}");
    assert_eq!(needless.iter().map(|e| e.subject.as_str()).collect::<Vec<_>>(), ["crates/lti/src/gone.rs"]);
}
