//! The sentences that artifacts hold, in the units of the reader. They are written once, in metric units,
//! by stages of this project and of others.

use std::borrow::Cow;

use crumple_signal::display::sentence;

use crate::findings::Run;

fn show(text: &mut String) {
    if let Cow::Owned(shown) = sentence(text) {
        *text = shown;
    }
}

impl Run {
    /// The same run with its sentences as they are shown now.
    #[must_use]
    pub fn with_sentences_shown(mut self) -> Self {
        for remark in self.remarks.iter_mut().chain(&mut self.contradictions) {
            show(&mut remark.text);
            remark.remedy.iter_mut().for_each(show);
        }
        self.missing.iter_mut().chain(&mut self.without).for_each(show);
        for metric in &mut self.metrics {
            show(&mut metric.definition);
            metric.interval_by.iter_mut().for_each(show);
        }
        if let Some(events) = &mut self.events {
            events.intervals.iter_mut().for_each(|interval| show(&mut interval.interval_by));
            events.end_of_event_rule.iter_mut().for_each(show);
        }
        self.matchings.iter_mut().flat_map(|(_, matching)| &mut matching.notes).for_each(show);
        for candidate in &mut self.candidates {
            candidate.record.notes.iter_mut().for_each(show);
            let uncertainty = candidate.record.uncertainty.iter_mut();
            uncertainty.flat_map(|known| &mut known.weakest_direction).for_each(show);
            candidate.simulation.iter_mut().flat_map(|simulation| &mut simulation.notes).for_each(show);
        }
        for prediction in &mut self.predictions {
            prediction.notes.iter_mut().chain(&mut prediction.partner).for_each(show);
            prediction.intervals.iter_mut().for_each(|interval| show(&mut interval.interval_by));
        }
        if let Some(choice) = &mut self.recommendation {
            let because = [&mut choice.recommended_because, &mut choice.simplest_because, &mut choice.closest_because];
            because.into_iter().chain(&mut choice.beside).for_each(show);
            choice.candidates.iter_mut().flat_map(|rated| &mut rated.not_adequate_because).for_each(show);
            for prior in &mut choice.priors {
                show(&mut prior.statement);
                show(&mut prior.source);
            }
        }
        self
    }
}
