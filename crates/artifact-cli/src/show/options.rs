//! What to show of an artifact.

use crumple_artifact::{Artifact, WAVE_PREFIX, Wave, topic_matches};

/// Topics to show.
#[derive(Debug, Clone, Default)]
pub struct Wanted(pub Vec<String>);

impl Wanted {
    /// Whether a topic matches one of the patterns; without patterns every topic does.
    pub fn takes(&self, topic: &str) -> bool {
        self.0.is_empty() || self.0.iter().any(|pattern| topic_matches(pattern, topic))
    }
}

/// What is shown.
#[derive(Debug, Clone, Default)]
pub struct ShowOptions {
    /// Of which topics.
    pub topics: Wanted,
    /// Samples of waveforms, too.
    pub samples: bool,
}

/// The waveforms to show, with their topics.
pub(crate) fn wanted_waves<'a>(
    artifact: &'a Artifact,
    options: &'a ShowOptions,
) -> impl Iterator<Item = (String, &'a Wave)> + use<'a> {
    let named = artifact.waves().iter().map(|(id, wave)| (format!("{WAVE_PREFIX}{id}"), wave));
    named.filter(|(topic, _)| options.topics.takes(topic))
}
