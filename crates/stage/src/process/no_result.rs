//! The outcome of work on several models of which none came to a result.

use crumple_signal::{About, Bearing, Note};

use crate::artifacts::output::Output;
use crate::process::run::Outcome;

impl Output {
    /// No acceptable result, in the words of the first warning about a model, and how many more there are; `otherwise`
    /// without any. `remedy`: see [`Output::remedy`].
    pub fn no_result(&mut self, otherwise: &str, remedy: &str) -> Outcome {
        let is_of_a_model = |note: &&Note| matches!(&note.bearing, Some(Bearing { about: About::Model(_), .. }));
        let texts: Vec<&str> = self.notes.iter().filter(is_of_a_model).map(|note| note.text.as_str()).collect();
        let reason = match texts[..] {
            [] => otherwise.to_owned(),
            [only] => only.to_owned(),
            [first, ..] => format!("{first}; {} more notes say why", texts.len() - 1),
        };
        self.remedy(remedy);
        Outcome::NoAcceptableResult(reason)
    }
}
