//! A record of the fleet.

use std::collections::BTreeSet;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use crumple_ingest::{Bundle, RecordDigests};
use crumple_stage::Refused;
use rayon::prelude::*;

use crate::command::Batch;
use crate::records::inputs::records_meant;
use crate::records::names::names;

/// A record.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Record {
    /// Where it is.
    pub(crate) path: PathBuf,
    /// What it is called in the tables: its path below what was typed.
    pub(crate) identity: String,
    /// Name of its folder among the runs.
    pub(crate) name: String,
    /// Its content; `None`: there is no file.
    pub(crate) digests: Option<Digests>,
}

/// What a record is, by its content.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Digests {
    /// `blake3:<hex>` of the record, as `crumple-ingest` states it; empty where its format is not known.
    pub(crate) record: String,
    /// Of all that a run reads: format, name, record and sidecar.
    pub(crate) input: blake3::Hash,
}

/// The records that are meant by the words of the command line, each once, or those of one part of the fleet, and the
/// other files in their folders. Only what is in the part is read: a fleet of many parts reads each record once.
pub(crate) fn records(words: &[String], batch: Option<Batch>) -> anyhow::Result<(Vec<Record>, Vec<PathBuf>)> {
    let mut others = Vec::new();
    let mut found = Vec::new();
    let mut seen = BTreeSet::new();
    for word in words {
        let meant = records_meant(word)?;
        others.extend(meant.others);
        for (path, identity) in meant.records {
            if seen.insert(path.clone()) {
                // Of several folders the same path below each may be two records.
                let identity = if words.len() > 1 { path.to_string_lossy().into_owned() } else { identity };
                found.push((path, identity));
            }
        }
    }
    if found.is_empty() {
        return Err(Refused::new(format!("no record in {}", words.join(", ")))
            .expected("crash records as crumple-ingest reads them")
            .hint("crumple-ingest --list FILE says what it makes of a file")
            .into());
    }
    let names = names(&found.iter().map(|(_, identity)| identity.as_str()).collect::<Vec<_>>());
    let in_part = |((_, identity), _): &((PathBuf, String), String)| batch.is_none_or(|batch| batch.holds(identity));
    let records = found.into_par_iter().zip(names).filter(in_part).map(|((path, identity), name)| {
        let read = || Bundle::open(&path).ok().map(|bundle| bundle.digests());
        let digests = match Bundle::digests_at(&path).or_else(read) {
            Some(record) => Some(digests(record)),
            // It will be refused, and again as long as it is the same.
            None => digest_of_file(&path).ok(),
        };
        Record { path, identity, name, digests }
    });
    Ok((records.collect(), others))
}

fn digest_of_file(path: &Path) -> io::Result<Digests> {
    let input = blake3::Hasher::new().update_reader(File::open(path)?)?.finalize();
    Ok(Digests { record: String::new(), input })
}

fn digests(RecordDigests { format, name, record, sidecar }: RecordDigests) -> Digests {
    let mut hasher = blake3::Hasher::new();
    let sidecar = sidecar.as_deref().and_then(|digest| digest.strip_prefix("blake3:")).unwrap_or_default();
    for part in [format, &name, &record, sidecar] {
        hasher.update(part.as_bytes());
        hasher.update(&[0]);
    }
    Digests { record, input: hasher.finalize() }
}
