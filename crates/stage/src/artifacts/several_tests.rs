//! Artifacts of one test as ever, or of several tests, each under a name of its own.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crumple_artifact::InputDigest;
use crumple_artifact::records::TestV1;

use crate::artifacts::inputs::{Diagnosed, Inputs, Loaded, load_artifacts};
use crate::error::{Refused, Usage};

/// What a stage that can join tests was given.
#[derive(Debug)]
pub enum Tests {
    /// Artifacts of one test.
    One(Inputs),
    /// Two or more tests in the order of their names on the command line, each with its own artifacts.
    Several(Vec<(String, Inputs)>),
}

/// Name and path of an input `NAME:PATH`; `None` for a plain path. A path that exists is a path, whatever is in it.
fn named(input: &Path) -> Option<(&str, &Path)> {
    if input.exists() {
        return None;
    }
    let (name, path) = input.to_str()?.split_once(':')?;
    (!name.is_empty() && !name.contains('/') && !path.is_empty()).then(|| (name, Path::new(path)))
}

/// The path of an input, without the name of its test.
pub(crate) fn path_of(input: &Path) -> &Path {
    named(input).map_or(input, |(_, path)| path)
}

/// Reads artifacts of one test, or of several where each path has the name of its test in front: `NAME:PATH`.
///
/// Provenance then has the kinds `NAME:STAGE`. Errors: as for [`load_artifacts`], test by test; some paths with a name
/// and some without; one name alone; one record under two names.
pub fn load_tests(paths: &[PathBuf]) -> anyhow::Result<Loaded<Tests>> {
    let pairs: Vec<(&str, &Path)> = paths.iter().filter_map(|path| named(path)).collect();
    if pairs.is_empty() {
        return Ok(load_artifacts(paths)?.map(Tests::One));
    }
    let hint = "a:runs/a/default/3-integrate.mcap b:runs/b/default/3-integrate.mcap";
    if let Some(plain) = paths.iter().find(|path| named(path).is_none()) {
        let problem = format!("{} has no name of a test in front, other inputs have one", plain.display());
        return Err(Usage::new(problem).hint(hint).into());
    }
    let mut names: Vec<&str> = Vec::new();
    let mut by_name: BTreeMap<&str, Vec<PathBuf>> = BTreeMap::new();
    for (name, path) in pairs {
        if !names.contains(&name) {
            names.push(name);
        }
        by_name.entry(name).or_default().push(path.to_owned());
    }
    if let [only] = names[..] {
        let problem = format!("{only} is the only test; one model for several tests needs two or more");
        return Err(Usage::new(problem).hint(format!("leave {only}: out for the artifacts of one test")).into());
    }
    let (mut tests, mut digests) = (Vec::new(), Vec::new());
    let mut diagnosed = Diagnosed::default();
    for name in names {
        let loaded = load_artifacts(&by_name[name])?;
        let kind = |input: InputDigest| InputDigest { kind: format!("{name}:{}", input.kind), ..input };
        digests.extend(loaded.digests.into_iter().map(kind));
        for mut diagnosis in loaded.diagnosed.diagnoses {
            diagnosis.reason = format!("{name}: {}", diagnosis.reason);
            diagnosed.diagnoses.push(diagnosis);
        }
        diagnosed.test = diagnosed.test.or(loaded.diagnosed.test);
        tests.push((name.to_owned(), loaded.input));
    }
    refuse_one_record_twice(&tests)?;
    Ok(Loaded { input: Tests::Several(tests), digests, diagnosed })
}

fn refuse_one_record_twice(tests: &[(String, Inputs)]) -> anyhow::Result<()> {
    let mut seen: BTreeMap<String, &str> = BTreeMap::new();
    for (name, inputs) in tests {
        let Some(test) = inputs.record_if::<TestV1>("/test")? else { continue };
        let digest = test.source.digest;
        if let Some(other) = seen.get(&digest).filter(|_| !digest.is_empty()) {
            return Err(Refused::new(format!("{other} and {name} are one record"))
                .expected("several tests")
                .hint("name each test once")
                .into());
        }
        seen.insert(digest, name);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_stands_before_the_path_of_its_test() {
        assert_eq!(named(Path::new("a:x/3.mcap")), Some(("a", Path::new("x/3.mcap"))));
        assert_eq!(path_of(Path::new("a:x/3.mcap")), Path::new("x/3.mcap"));
        for plain in ["x/3.mcap", "x/y:3.mcap", ":3.mcap", "a:"] {
            assert_eq!(named(Path::new(plain)), None, "{plain}");
        }
        let folder = tempfile::tempdir().unwrap();
        let odd = folder.path().join("a:b");
        std::fs::write(&odd, "").unwrap();
        assert_eq!(named(&odd), None);
    }

    #[test]
    fn one_name_alone_and_a_missing_name_are_refused() {
        let refused = |paths: &[&str]| load_tests(&paths.iter().map(PathBuf::from).collect::<Vec<_>>()).unwrap_err();
        let alone = refused(&["a:2.mcap", "a:3.mcap"]).to_string();
        assert!(alone.starts_with("a is the only test"), "{alone}");
        let mixed = refused(&["a:2.mcap", "3.mcap"]).to_string();
        assert!(mixed.starts_with("3.mcap has no name of a test in front"), "{mixed}");
    }
}
