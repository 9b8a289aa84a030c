//! Names of the folders in which records are run.

use std::collections::BTreeMap;
use std::path::Path;

/// The name of each record's folder: the stem of its file, as `just run` names it; where several share one (also on a
/// disk that knows no capitals), with the start of the digest of what the record is called.
pub(crate) fn names(identities: &[&str]) -> Vec<String> {
    let stems: Vec<String> = identities.iter().map(|identity| stem(identity)).collect();
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for stem in &stems {
        *counts.entry(stem.to_lowercase()).or_default() += 1;
    }
    let name = |(stem, identity): (&String, &&str)| match counts.get(&stem.to_lowercase()) {
        Some(1) => stem.clone(),
        _ => format!("{stem}-{}", &blake3::hash(identity.as_bytes()).to_hex()[..8]),
    };
    stems.iter().zip(identities).map(name).collect()
}

fn stem(identity: &str) -> String {
    Path::new(identity).file_stem().map_or_else(|| "record".to_owned(), |stem| stem.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_of_one_stem_have_folders_of_their_own() {
        let names = names(&["a.csv", "x/b.csv", "y/b.csv", "B.EV5"]);
        assert_eq!(names[0], "a");
        let of_b: std::collections::BTreeSet<&String> = names[1..].iter().collect();
        assert_eq!(of_b.len(), 3);
        assert!(names[1].starts_with("b-") && names[1].len() == 10, "{names:?}");
    }
}
