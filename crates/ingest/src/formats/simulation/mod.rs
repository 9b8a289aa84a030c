//! Crash simulations: time histories that LS-DYNA and OpenRadioss write, and curves of them.
//!
//! [`history`] is what all of them have: nodes, walls, contacts, energies over time, in the units of the model. A
//! reader makes it of bytes; [`record`] makes a record of it, in SI, along the line of driving.

pub mod ascii;
pub mod binout;
pub mod channels;
pub mod curves;
pub mod history;
pub mod lsda;
pub mod nodes;
pub mod radioss;
pub mod record;
pub mod remarks;
pub mod table;

use ascii::Text;
use lsda::Source;

use crate::formats::reader::{Bundle, Reader};
use crate::recording::content::Recording;
use crate::{IngestSettings, Result};

/// Flags that simulations heed.
const FLAGS: &[&str] = &["--resample", "--node", "--axis", "--units"];

/// A result of several files.
const fn of_files(
    format: &'static str,
    recognises: fn(&[u8]) -> bool,
    companion: fn(&str, &str) -> bool,
    read: fn(&Bundle, &IngestSettings) -> Result<Recording>,
) -> Reader {
    Reader { companion, ..Reader::of_one_file(format, recognises, FLAGS, read) }
}

pub const BINOUT: Reader = Reader {
    seeks: true,
    ..of_files("ls-dyna-binout", lsda::recognises, is_of_family, |bundle, settings| {
        let in_memory = || files(bundle).into_iter().map(|(name, bytes)| (name, Source::of(bytes)));
        let on_disk = || bundle.on_disk.iter().map(|(name, file)| (name.as_str(), Source::on_disk(file)));
        let sources = if bundle.on_disk.is_empty() { in_memory().collect() } else { on_disk().collect() };
        record::recording(&bundle.name, binout::read(sources, settings)?, settings)
    })
};
pub const TEXTS: Reader = of_files("ls-dyna-text", ascii::recognises, is_text_beside, |bundle, settings| {
    record::recording(&bundle.name, ascii::read(&files(bundle))?, settings)
});
pub const T01: Reader = of_files("openradioss-t01", radioss::recognises, is_titles, |bundle, settings| {
    let titles = bundle.companions.values().next().map(Vec::as_slice);
    record::recording(&bundle.name, radioss::read(&bundle.main.name, &bundle.main.bytes, titles)?, settings)
});
pub const TABLE: Reader = Reader::of_one_file("openradioss-table", table::recognises, FLAGS, |bundle, settings| {
    record::recording(&bundle.name, table::read(&bundle.main.name, &bundle.main.bytes)?, settings)
});
pub const CURVES: Reader = Reader::of_one_file("simulation-curves", curves::recognises, FLAGS, |bundle, settings| {
    record::recording(&bundle.name, curves::read(&bundle.main.name, &bundle.main.bytes)?, settings)
});

/// Whether a reader may have files beside the main one.
pub fn has_companions(reader: &Reader) -> bool {
    [&BINOUT, &TEXTS, &T01].iter().any(|own| own.format == reader.format)
}

/// Whether a file that starts so is the main file of a result.
pub fn is_result(head: &[u8]) -> bool {
    [&BINOUT, &TEXTS, &T01].iter().any(|reader| (reader.recognises)(head))
}

/// All files by name: `binout0000`, `binout0000%001`, `binout0001`.
fn files(bundle: &Bundle) -> Vec<(&str, &[u8])> {
    let main = (bundle.main.name.as_str(), bundle.main.bytes.as_slice());
    let beside = bundle.companions.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice()));
    let mut files: Vec<(&str, &[u8])> = std::iter::once(main).chain(beside).collect();
    files.sort_by_key(|(name, _)| *name);
    files
}

/// A name without `%001` and without the number of its process.
fn family(name: &str) -> &str {
    name.split('%').next().unwrap_or(name).trim_end_matches(|c: char| c.is_ascii_digit())
}

fn is_of_family(main: &str, name: &str) -> bool {
    let tail = name.strip_prefix(family(main));
    name != main && tail.is_some_and(|tail| tail.bytes().all(|b| b.is_ascii_digit() || b == b'%'))
}

fn is_text_beside(main: &str, name: &str) -> bool {
    let prefix = Text::NAMES.iter().find_map(|own| main.strip_suffix(own));
    name != main && prefix.is_some_and(|prefix| Text::NAMES.iter().any(|own| name.strip_prefix(prefix) == Some(own)))
}

fn is_titles(main: &str, name: &str) -> bool {
    name.strip_prefix(main) == Some("_TITLES")
}

/// Rank of a file's name among those of a folder: which stands for the record. The content decides whether it does.
pub fn rank(name: &str) -> Option<u8> {
    let is_binout = family(name).ends_with("binout");
    let is_t01 = name.ends_with("T01");
    let text = Text::NAMES.iter().position(|own| name.ends_with(own));
    match text {
        _ if is_binout => Some(0),
        Some(k) => Some(2 + k as u8),
        None => is_t01.then_some(1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_stages_know_the_formats() {
        assert_eq!([BINOUT, TEXTS, T01, TABLE, CURVES].map(|reader| reader.format), crumple_signal::SIMULATED);
    }

    #[test]
    fn files_of_one_result_are_known_by_their_names() {
        for name in ["binout0000%001", "binout0001", "binout0012%123"] {
            assert!(is_of_family("binout0000", name) && is_of_family("binout0000%002", name), "{name}");
        }
        assert!(is_of_family("binout", "binout%001") && !is_of_family("R7.binout", "R9.binout"));
        assert!(is_text_beside("nodout", "rwforc") && is_text_beside("a.nodout", "a.glstat"));
        assert!(!is_text_beside("nodout", "a.glstat") && is_titles("CART01", "CART01_TITLES"));
        assert_eq!(["binout0000", "CART01", "nodout", "test.csv"].map(rank), [Some(0), Some(1), Some(2), None]);
    }
}
