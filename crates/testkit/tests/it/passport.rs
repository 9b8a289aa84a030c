//! `crumple passport` and `crumple check --passport`: what leaves, what is run again, what is refused.

use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::Path;
use std::process::Command;

use crumple_testkit::programs::binary;
use crumple_testkit::workspace;
use serde_json::Value;
use tempfile::TempDir;
use zip::{ZipArchive, ZipWriter};

/// Exit code, standard output, standard error.
fn crumple(folder: &Path, words: &[&str]) -> (i32, String, String) {
    let programs = binary("crumple").parent().unwrap().to_owned();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let paths = std::env::join_paths(std::iter::once(programs.clone()).chain(std::env::split_paths(&path))).unwrap();
    let mut command = Command::new(programs.join("crumple"));
    let ended = command.args(words).current_dir(folder).env("PATH", paths).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (ended.status.code().unwrap_or(-1), text(&ended.stdout), text(&ended.stderr))
}

fn done(folder: &Path, words: &[&str]) -> String {
    let (code, out, said) = crumple(folder, words);
    assert_eq!(code, 0, "{words:?}: {out}{said}");
    out + &said
}

const MODELS: &str = "parameter-solve.models=kelvin,elastoplastic";

/// A folder with a record and a run of it in `run`, by models that are quick to fit.
fn with_run(flags: &[&str], sidecar: Option<&str>) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().join("crash.csv");
    fs::copy(workspace().join("fixtures/elastoplastic/crash.csv"), &record).unwrap();
    if let Some(options) = sidecar {
        fs::write(folder.path().join("crash.csv.toml"), options).unwrap();
    }
    let words = [&["run", "crash.csv", "--set", MODELS, "-q", "-o", "run"], flags].concat();
    done(folder.path(), &words);
    folder
}

fn passport(folder: &Path, output: &str, flags: &[&str]) -> String {
    done(folder, &[&["passport", "run", "-o", output, "--date", "2026-11-30"], flags].concat())
}

fn entries(zip: &Path) -> Vec<(String, Vec<u8>)> {
    let mut zip = ZipArchive::new(File::open(zip).unwrap()).unwrap();
    let count = zip.len();
    let read = |index| {
        let mut entry = zip.by_index(index).unwrap();
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).unwrap();
        (entry.name().unwrap().into_owned(), bytes)
    };
    (0..count).map(read).collect()
}

fn write_zip(path: &Path, entries: &[(String, Vec<u8>)]) {
    let mut zip = ZipWriter::new(File::create(path).unwrap());
    for (name, bytes) in entries {
        zip.start_file(name.as_str(), zip::write::SimpleFileOptions::default()).unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap();
}

/// A copy of a crate with one text in it replaced.
fn changed(folder: &Path, from: &str, to: &str, file: &str, text: [&str; 2]) {
    let mut all = entries(&folder.join(from));
    let bytes = &mut all.iter_mut().find(|(name, _)| name == file).unwrap().1;
    let before = String::from_utf8(bytes.clone()).unwrap();
    assert!(before.contains(text[0]), "{before}");
    *bytes = before.replace(text[0], text[1]).into_bytes();
    write_zip(&folder.join(to), &all);
}

#[test]
fn a_passport_has_the_same_bytes_and_no_sample_unless_it_is_asked_for() {
    let folder = with_run(&[], None);
    let said = passport(folder.path(), "a.zip", &[]);
    assert!(
        said.contains("only their digests: crash.csv, 1-ingest.mcap, 2-filter.mcap, 3-integrate.mcap, report.html"),
        "{said}"
    );
    passport(folder.path(), "b.zip", &[]);
    let bytes = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert_eq!(bytes("a.zip"), bytes("b.zip"));
    let names: Vec<String> = entries(&folder.path().join("a.zip")).into_iter().map(|(name, _)| name).collect();
    let expected = ["ro-crate-metadata.json", "0-pipeline.toml", "4-identify.mcap", "5-parameter-solve.mcap"];
    assert_eq!(names, [&expected[..], &["6-simulate.mcap", "7-predict.mcap", "summary.json"]].concat());
    let metadata: Value = serde_json::from_slice(&entries(&folder.path().join("a.zip"))[0].1).unwrap();
    let entity = |id: &str| metadata["@graph"].as_array().unwrap().iter().find(|one| one["@id"] == id).cloned();
    assert_eq!(entity("./").unwrap()["datePublished"], "2026-11-30");
    assert_eq!(entity("#record/crash.csv").unwrap()["@type"], "CreativeWork");

    // With the record; a folder holds the same files.
    passport(folder.path(), "whole.zip", &["--with-record"]);
    passport(folder.path(), "whole", &["--with-record"]);
    let all = entries(&folder.path().join("whole.zip"));
    assert!(
        all.len() == 12 && all.iter().any(|(name, bytes)| name == "record/crash.csv" && *bytes == bytes_of(&folder))
    );
    for (name, bytes) in all {
        assert_eq!(fs::read(folder.path().join("whole").join(&name)).unwrap(), bytes, "{name}");
    }
    // A folder that holds something may hold a record.
    let (code, _, said) = crumple(folder.path(), &["passport", "run", "-o", "whole", "--force"]);
    assert!(code == 2 && said.contains("is not empty"), "{said}");

    // The record lies elsewhere.
    fs::rename(folder.path().join("crash.csv"), folder.path().join("moved.csv")).unwrap();
    let (code, _, said) = crumple(folder.path(), &["passport", "run", "-o", "moved.zip", "--with-record"]);
    assert!(code == 3 && said.contains("--record FILE"), "{said}");
    passport(folder.path(), "moved.zip", &["--with-record", "--record", "moved.csv"]);
    assert_eq!(bytes("moved.zip"), bytes("whole.zip"));
}

fn bytes_of(folder: &TempDir) -> Vec<u8> {
    fs::read(folder.path().join("crash.csv")).unwrap()
}

#[test]
fn a_run_is_made_again_elsewhere_and_what_differs_is_named() {
    let flags = [
        "--impact-speed",
        "58km/h",
        "--set",
        "filter.cfc=180",
        "--stage",
        "integrate=crumple integrate --rule simpson",
    ];
    let folder = with_run(&flags, Some("mass = \"1450 kg\"\n"));
    passport(folder.path(), "p.zip", &[]);
    passport(folder.path(), "whole", &["--with-record"]);
    fs::remove_dir_all(folder.path().join("run")).unwrap();
    fs::remove_file(folder.path().join("crash.csv.toml")).unwrap();

    // Under another name, without the options beside it, in another folder.
    let other = tempfile::tempdir().unwrap();
    fs::rename(folder.path().join("crash.csv"), other.path().join("renamed.csv")).unwrap();
    let place = |name: &str| folder.path().join(name).display().to_string();
    let crate_ = place("p.zip");
    let check = |words: &[&str]| crumple(other.path(), &[&["check", "--passport"], words].concat());
    for words in [&[&*crate_, "--record", "renamed.csv"][..], &[&place("whole")]] {
        let (code, out, said) = check(words);
        assert!(code == 0 && out.starts_with("equal: crash.csv run again gives all 9 results"), "{code} {out}{said}");
    }
    let (code, _, said) = check(&[&crate_]);
    assert!(
        code == 2 && said.contains("the record crash.csv is not in") && said.contains("--record crash.csv"),
        "{said}"
    );

    // Another record.
    let record = fs::read_to_string(other.path().join("renamed.csv")).unwrap();
    fs::write(other.path().join("other.csv"), record.replacen("0.07,", "0.0700001,", 1)).unwrap();
    let (code, _, said) = check(&[&crate_, "--record", "other.csv"]);
    assert!(code == 3 && said.contains("is another record: blake3:"), "{code} {said}");

    // Another digest of a result, or another option with its digest: not equal, by name.
    let metadata: Value = serde_json::from_slice(&entries(Path::new(&crate_))[0].1).unwrap();
    let content = metadata["@graph"].as_array().unwrap().iter().find(|one| one["@id"] == "#digest-2-of-7-predict.mcap");
    let content = content.unwrap()["value"].as_str().unwrap();
    let replaced = format!("blake3:{:064}", 7);
    changed(folder.path(), "p.zip", "digest.zip", "ro-crate-metadata.json", [content, &replaced]);
    let (code, out, _) = check(&[&place("digest.zip"), "--record", "renamed.csv"]);
    assert!(code == 1 && out.starts_with("not equal: 1 of 9 results of crash.csv\n  7-predict.mcap: "), "{code} {out}");
    changed(folder.path(), "p.zip", "damaged.zip", "0-pipeline.toml", ["cfc = 180", "cfc = 600"]);
    let (code, _, said) = check(&[&place("damaged.zip"), "--record", "renamed.csv"]);
    assert!(code == 3 && said.contains("0-pipeline.toml was changed after the crate was made"), "{code} {said}");
    let digest = |zip: &str| format!("blake3:{}", blake3::hash(&entries(&folder.path().join(zip))[1].1));
    let [before, after] = ["p.zip", "damaged.zip"].map(digest);
    changed(folder.path(), "damaged.zip", "option.zip", "ro-crate-metadata.json", [&before, &after]);
    let (code, out, _) = check(&[&place("option.zip"), "--record", "renamed.csv"]);
    assert!(code == 1 && out.contains("  2-filter.mcap: blake3:") && !out.contains("  1-ingest.mcap"), "{code} {out}");
}

#[test]
fn paths_that_leave_links_bombs_and_flags_that_write_are_refused() {
    let folder = with_run(&[], None);
    passport(folder.path(), "p.zip", &["--with-record"]);
    passport(folder.path(), "p", &["--with-record"]);
    let check = |name: &str| {
        let (code, out, said) = crumple(folder.path(), &["check", "--passport", name]);
        assert_eq!(code, 3, "{name}: {out}{said}");
        said
    };
    let own = entries(&folder.path().join("p.zip"));
    for path in ["../x", "/tmp/x", "a/../../x", "a\\x"] {
        write_zip(&folder.path().join("out.zip"), &[&own[..], &[(path.to_owned(), b"x".to_vec())]].concat());
        assert!(check("out.zip").contains("leads out of the crate"), "{path}");
    }
    let name = ["\"name\": \"crash.csv\"", "\"name\": \"../crash.csv\""];
    changed(folder.path(), "p.zip", "name.zip", "ro-crate-metadata.json", name);
    assert!(check("name.zip").contains("leads out of the crate"));
    // 64 MiB of zeros in place of a megabyte: read no further than the crate states.
    let bomb = |(name, bytes): &(String, Vec<u8>)| {
        (name.clone(), if name == "6-simulate.mcap" { vec![0; 64 << 20] } else { bytes.clone() })
    };
    write_zip(&folder.path().join("bomb.zip"), &own.iter().map(bomb).collect::<Vec<_>>());
    assert!(check("bomb.zip").contains("make it again: crumple passport RUN"));
    assert!(check("bomb.zip").contains("6-simulate.mcap was changed after the crate was made: it has more than its"));
    fs::write(folder.path().join("text.zip"), "no archive").unwrap();
    assert!(check("text.zip").contains("cannot be read as a zip archive"));
    assert!(check("absent.zip").contains("absent.zip"));

    // A crate that would have a stage delete a file.
    let kept = folder.path().join("kept");
    fs::write(&kept, "x").unwrap();
    let flags = format!("[run.flags]\nfilter = \"--dependent {}\"\n\n[run]\n", kept.display());
    changed(folder.path(), "p.zip", "half.zip", "0-pipeline.toml", ["[run]\n", &flags]);
    let digest = |zip: &str| format!("blake3:{}", blake3::hash(&entries(&folder.path().join(zip))[1].1));
    let size = |zip: &str| format!("\"contentSize\": \"{}\"", entries(&folder.path().join(zip))[1].1.len());
    let [before, after] = ["p.zip", "half.zip"].map(digest);
    changed(folder.path(), "half.zip", "digest.zip", "ro-crate-metadata.json", [&before, &after]);
    let [before, after] = ["p.zip", "half.zip"].map(size);
    changed(folder.path(), "digest.zip", "flag.zip", "ro-crate-metadata.json", [&before, &after]);
    assert!(check("flag.zip").contains("flag of filter: --dependent"));
    assert!(kept.exists());

    #[cfg(unix)]
    {
        let inside = folder.path().join("p/summary.json");
        fs::rename(&inside, folder.path().join("summary.json")).unwrap();
        std::os::unix::fs::symlink(folder.path().join("summary.json"), &inside).unwrap();
        assert!(check("p").contains("is a link"));
    }
}

#[test]
fn a_program_from_elsewhere_runs_only_where_it_is_named_and_is_the_same() {
    let script = workspace().join("crates/testkit/tests/it/swapped_stages.py");
    let folder = tempfile::tempdir().unwrap();
    fs::copy(&script, folder.path().join("mine.py")).unwrap();
    fs::copy(workspace().join("fixtures/elastoplastic/crash.csv"), folder.path().join("crash.csv")).unwrap();
    let stage = "filter=python3 mine.py filter:wide";
    done(folder.path(), &["run", "crash.csv", "--set", MODELS, "-q", "-o", "run", "--stage", stage]);
    passport(folder.path(), "p.zip", &["--with-record"]);
    let metadata = String::from_utf8(entries(&folder.path().join("p.zip")).swap_remove(0).1).unwrap();
    assert!(metadata.contains("\"name\": \"python3 mine.py filter:wide\""), "{metadata}");
    assert!(metadata.contains("\"name\": \"BLAKE3 of mine.py\""), "{metadata}");
    let check = |words: &[&str]| crumple(folder.path(), &[&["check", "--passport", "p.zip"], words].concat());
    let (code, _, said) = check(&[]);
    let hint = "crumple check --passport p.zip --stage 'filter=python3 mine.py filter:wide'";
    assert!(
        code == 3 && said.contains("the stage filter was run by a program from elsewhere") && said.contains(hint),
        "{said}"
    );
    let (code, out, said) = check(&["--stage", stage]);
    assert!(code == 0 && out.starts_with("equal: "), "{code} {out}{said}");
    let (code, _, said) = check(&["--stage", stage, "--stage", "integrate=python3 mine.py integrate"]);
    assert!(code == 2 && said.contains("has Crumple's own"), "{code} {said}");
    let mut file = fs::OpenOptions::new().append(true).open(folder.path().join("mine.py")).unwrap();
    file.write_all(b"# another one\n").unwrap();
    let (code, _, said) = check(&["--stage", stage]);
    assert!(code == 3 && said.contains("none of its files is mine.py of blake3:"), "{code} {said}");
}
