//! How the process shows progress and words a refusal.

use crumple_ingest::{IngestError, IngestSettings};
use crumple_stage::{Progress, Refused, nearest};

/// Progress of reading, on a terminal or as log lines.
pub(crate) fn show_progress(what: String, total: u64) -> Box<dyn FnMut(u64)> {
    let mut progress = Progress::new(what, total);
    Box::new(move |bytes| progress.advance(bytes))
}

/// A refusal of the library as one of the process, with the nearest key of a sidecar for an unknown one.
pub(crate) fn refused(error: IngestError) -> anyhow::Error {
    let nearest_key = match &error {
        IngestError::UnknownKey { key, .. } => nearest(key, IngestSettings::KEYS),
        _ => None,
    };
    let hint = nearest_key.map_or_else(|| error.hint().to_owned(), |name| format!("did you mean {name:?}?"));
    let mut refused = Refused::new(error.to_string()).hint(hint);
    if let Some(expected) = error.expected() {
        refused = refused.expected(expected);
    }
    refused.into()
}
