//! Kits of stages: the files that are written, the page that shows them, plain files with text.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const LANGUAGES: [(&str, &str); 5] = [("python", "py"), ("shell", "sh"), ("octave", "m"), ("r", "R"), ("julia", "jl")];

const STAGES: [&str; 6] = ["filter", "integrate", "identify", "parameter-solve", "simulate", "predict"];

fn new_stage(folder: &Path, words: &[&str]) -> Output {
    let mut program = Command::new(env!("CARGO_BIN_EXE_crumple-artifact"));
    program.arg("new-stage").args(words).current_dir(folder).output().unwrap()
}

fn kit() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/kit"))
}

#[test]
fn a_kit_is_written_for_every_stage_and_language_and_nothing_is_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    for stage in STAGES {
        for (language, ending) in LANGUAGES {
            let to = format!("{stage}-{language}");
            let words = [stage, "--language", language, "-o", &to];
            let output = new_stage(folder.path(), &words);
            assert_eq!(output.status.code(), Some(0), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
            let read = |name: &str| fs::read_to_string(folder.path().join(&to).join(name)).unwrap();
            let program = fs::read_to_string(kit().join(format!("{language}/{stage}.{ending}"))).unwrap();
            assert_eq!(read(&format!("stage.{ending}")), program);
            assert!(read("test.sh").contains("crumple check") && read("CONTRACT.md").contains("## Every stage"));
            assert_eq!(new_stage(folder.path(), &words).status.code(), Some(2), "{to} exists");
        }
    }
    fs::create_dir(folder.path().join("my-filter")).unwrap();
    fs::write(folder.path().join("my-filter/test.sh"), "mine").unwrap();
    let output = new_stage(folder.path(), &["filter", "-l", "r"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(2) && said.contains("my-filter/test.sh exists"), "{said}");
    assert_eq!(fs::read_dir(folder.path().join("my-filter")).unwrap().count(), 1, "no half of a kit");
}

#[test]
fn a_stage_without_a_kit_is_refused_with_those_that_have_one() {
    let folder = tempfile::tempdir().unwrap();
    for (stage, expected) in [
        ("ingest", "there is no kit for ingest: it reads a record, not an artifact"),
        ("report", "there are kits for filter, integrate, identify, parameter-solve, simulate, predict"),
        ("filtre", "did you mean \"filter\"?"),
    ] {
        let output = new_stage(folder.path(), &[stage, "--language", "shell"]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && said.contains(expected), "{said}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

const BEGIN: &str = "<!-- kit: ";
const END: &str = "<!-- end of kit -->";

/// A page with the files of the kit between its marks: programs in fences, contracts as they are.
fn with_kits(page: &str) -> String {
    let mut parts = page.split(BEGIN);
    let mut whole = parts.next().unwrap().to_owned();
    for part in parts {
        let (name, rest) = part.split_once(" -->\n").unwrap();
        let (_, after) = rest.split_once(END).unwrap();
        let text = fs::read_to_string(kit().join(name)).unwrap();
        let fence = match name.rsplit_once('.').unwrap().1 {
            "py" => "python",
            // Blocks of `sh` are commands of the book, which a test runs.
            "sh" => "bash",
            "m" => "matlab",
            "R" => "r",
            "jl" => "julia",
            _ => "",
        };
        let shown = if fence.is_empty() { text } else { format!("```{fence}\n{text}```\n") };
        whole += &format!("{BEGIN}{name} -->\n{shown}{END}{after}");
    }
    whole
}

/// `CRUMPLE_WRITE_DOCS=1 cargo test -p crumple-artifact-cli --test it the_page_shows` writes them.
#[test]
fn the_page_shows_the_kits_as_they_are() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/write-a-stage.md");
    let page = fs::read_to_string(&path).unwrap();
    let expected = with_kits(&page);
    if std::env::var_os("CRUMPLE_WRITE_DOCS").is_some() {
        fs::write(&path, expected).unwrap();
        return;
    }
    assert_eq!(page, expected, "docs/write-a-stage.md and the kits differ: run with CRUMPLE_WRITE_DOCS=1");
    let shown = |file: &String| page.contains(&format!("{BEGIN}{file} -->"));
    let contracts = STAGES.iter().chain(&["every-stage"]).map(|stage| format!("contract/{stage}.md"));
    let programs = LANGUAGES.iter().map(|(language, ending)| format!("{language}/filter.{ending}"));
    assert_eq!(contracts.chain(programs).find(|file| !shown(file)), None);
}

#[test]
fn lines_of_the_kits_are_short() {
    for folder in fs::read_dir(kit()).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_dir()) {
        for file in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            let text = fs::read_to_string(&file).unwrap();
            let is_long = |line: &&str| line.chars().count() > 120 && !line.starts_with('|');
            assert_eq!(text.lines().find(is_long), None, "{}", file.display());
            assert!(text.ends_with('\n') && !text.contains("```"), "{}", file.display());
        }
    }
}
