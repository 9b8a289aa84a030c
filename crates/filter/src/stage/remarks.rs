//! Notes of many channels; what holds for several is said once.

use std::collections::BTreeMap;

use crumple_signal::{ConcernContext, Note, Notes, Severity};

/// Notes by text, with the channels they hold for.
#[derive(Default)]
pub struct Remarks(BTreeMap<(Severity, String), (Option<ConcernContext>, Vec<String>)>);

impl Remarks {
    pub fn add(&mut self, id: &str, note: Note) {
        let (bearing, ids) = self.0.entry((note.severity, note.text)).or_default();
        *bearing = note.bearing.or(bearing.take());
        ids.push(id.to_owned());
    }

    pub fn info(&mut self, id: &str, text: impl Into<String>) {
        self.add(id, Note::info(text));
    }

    pub fn warning(&mut self, id: &str, text: impl Into<String>) {
        self.add(id, Note::warning(text));
    }

    /// A note on no channel of those that are filtered.
    pub fn of_test(&mut self, text: impl Into<String>) {
        self.0.entry((Severity::Info, text.into())).or_default();
    }

    pub fn into_notes(self) -> Notes {
        let mut notes = Notes::new();
        for ((severity, text), (bearing, ids)) in self.0 {
            if ids.is_empty() {
                notes.info(text);
                continue;
            }
            let text = format!("channel{} {}: {text}", if ids.len() > 1 { "s" } else { "" }, first_of(&ids));
            notes.push(Note { severity, text, bearing });
        }
        notes
    }
}

/// The first of a list of names: hundreds of load cells help nobody.
pub fn first_of(ids: &[String]) -> String {
    const SHOWN: usize = 12;
    match ids.len().saturating_sub(SHOWN) {
        0 => ids.join(", "),
        more => format!("{} and {more} more", ids[..SHOWN].join(", ")),
    }
}
