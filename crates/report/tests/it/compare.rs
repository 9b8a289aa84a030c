//! Several runs on one page: `crumple-report --compare`, and the Markdown of one run.

use crate::sample;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn report(inputs: &[&Path], more: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_crumple-report")).args(inputs).args(more).output().unwrap()
}

/// Run folders of the synthetic record; the crush of the last one is longer by `more_mm`.
fn runs(folder: &Path, more_mm: f64) -> [PathBuf; 2] {
    let [a, b] = ["runs/a/default", "runs/b/default"].map(|name| folder.join(name));
    for (run, more_mm) in [(&a, 0.0), (&b, more_mm)] {
        std::fs::create_dir_all(run).unwrap();
        sample::write_with_longer_crush(run, true, 1e-3 * more_mm);
    }
    [a, b]
}

fn compared(more_mm: f64) -> (String, String) {
    let folder = tempfile::tempdir().unwrap();
    let [a, b] = runs(folder.path(), more_mm);
    let (page, text) = (folder.path().join("c.html"), folder.path().join("c.md"));
    let more = ["--compare", "-q", "-o", page.to_str().unwrap(), "--markdown", text.to_str().unwrap()];
    let output = report(&[&a, &b], &more);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    (std::fs::read_to_string(page).unwrap(), std::fs::read_to_string(text).unwrap())
}

#[test]
fn what_is_apart_by_more_than_a_millimetre_is_marked_and_what_is_not_is_not() {
    let (page, text) = compared(0.8);
    assert!(page.contains("Nothing differs by more than"), "{text}");
    assert!(!page.contains("class=\"differs\"") && !text.contains('≠'), "{text}");
    // 447.7 mm and 3 mm more.
    let (page, text) = compared(3.0);
    assert!(text.contains(" | **≠** 451\u{a0}mm (+3.0\u{a0}mm"), "{text}");
    assert_eq!((page.matches("class=\"differs\"").count(), text.matches('≠').count()), (1, 1), "{text}");
    assert!(page.contains("These differ by more than") && page.contains(": Dynamic crush C.</p>"), "{text}");
    // The test is the same, so that it is drawn once, with both models over it.
    assert!(
        page.contains("test, the same in all runs") && page.contains("</svg>a, double spring-mass-damper ("),
        "{page}"
    );
    for hostile in ["<b>impact", "window.broken = true</script>"] {
        assert!(!page.contains(hostile) && !text.contains(hostile));
    }
}

#[test]
fn one_run_and_folders_without_artifacts_are_refused_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let [a, _] = runs(folder.path(), 0.0);
    let page = folder.path().join("c.html");
    let refused = |inputs: &[&Path]| {
        let output = report(inputs, &["--compare", "-o", page.to_str().unwrap()]);
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, text) = refused(&[&a]);
    assert!(code == Some(2) && text.contains("name two run folders or more"), "{text}");
    let (code, text) = refused(&[&a, folder.path()]);
    assert!(code == Some(3) && text.contains("holds no artifact"), "{text}");
    let (code, text) = refused(&[&a, &folder.path().join("absent")]);
    assert!(code == Some(3) && text.contains("absent"), "{text}");
    assert!(!page.exists());
}

#[test]
fn the_markdown_of_a_run_says_what_its_page_says_first() {
    let folder = tempfile::tempdir().unwrap();
    let artifacts = sample::write_artifacts(folder.path(), true);
    let inputs: Vec<&Path> = artifacts.iter().map(PathBuf::as_path).collect();
    let (page, text) = (folder.path().join("r.html"), folder.path().join("r.md"));
    let more = ["-q", "-o", page.to_str().unwrap(), "--markdown", text.to_str().unwrap(), "--pipeline-name", "default"];
    assert_eq!(report(&inputs, &more).status.code(), Some(0));
    let text = std::fs::read_to_string(&text).unwrap();
    insta::assert_snapshot!(text);
    // What is not of this program stays.
    let mine = folder.path().join("README.md");
    std::fs::write(&mine, "# Mine\n").unwrap();
    let output = report(&inputs, &["-q", "-o", page.to_str().unwrap(), "--markdown", mine.to_str().unwrap()]);
    assert!(!output.status.success() && std::fs::read_to_string(&mine).unwrap() == "# Mine\n");
}
