//! Where the models of a run go.

use std::cmp::Ordering;
use std::fmt;

use crumple_signal::{About, Notes, Weight};
use crumple_stage::Output;
use crumple_stage::records::{EvidenceV1, IdentificationV1};

use crate::stage::records::selection::Comparison;

/// The artifact, and what every model of the run is entered into.
pub struct Results<'a> {
    /// Compares models of one output once all are there.
    comparison: Comparison,
    /// How the models do on samples that they have not seen, where such were kept.
    unseen: Vec<Unseen>,
    /// Records, notes and the summary.
    pub out: &'a mut Output,
}

/// A model on the samples that it has not seen.
struct Unseen {
    id: String,
    from_s: f64,
    fit_percent: Option<f64>,
    /// Run on from the state that the model has at the end of the samples it was identified from.
    unseen_fit_percent: f64,
    /// With the state fitted to them, where that was done.
    restarted_fit_percent: Option<f64>,
    holds: bool,
}

impl Unseen {
    /// Those that do not hold first, then by the fit of the unseen samples, the smallest first.
    fn compare(&self, other: &Self) -> Ordering {
        self.holds.cmp(&other.holds).then(self.unseen_fit_percent.total_cmp(&other.unseen_fit_percent))
    }
}

/// `arx-4 (fit 65.7 %, unseen -5595.0 %, with the state fitted to them -310.2 %)`.
impl fmt::Display for Unseen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { id, fit_percent, unseen_fit_percent, restarted_fit_percent, .. } = self;
        let fit = fit_percent.map_or("not defined".to_owned(), |fit| format!("{fit:.1} %"));
        write!(f, "{id} (fit {fit}, unseen {unseen_fit_percent:.1} %")?;
        if let Some(restarted) = restarted_fit_percent {
            write!(f, ", with the state fitted to them {restarted:.1} %")?;
        }
        f.write_str(")")
    }
}

impl<'a> Results<'a> {
    /// No model yet.
    pub fn new(out: &'a mut Output) -> Self {
        Self { comparison: Comparison::default(), unseen: Vec::new(), out }
    }

    /// Enters a model, with the evidence of every output. Of several outputs the one that is worst on unseen samples
    /// counts.
    pub fn enter(&mut self, id: &str, model: &IdentificationV1, evidence: &[EvidenceV1]) {
        self.comparison.enter(id, usize::try_from(model.samples).unwrap_or(usize::MAX), evidence);
        let fits = match &model.output_fits_percent {
            fits if fits.len() == evidence.len() => fits.clone(),
            _ => vec![model.fit_percent; evidence.len()],
        };
        let outputs = evidence.iter().zip(fits).filter_map(|(output_evidence, fit_percent)| {
            Some(Unseen {
                id: id.to_owned(),
                from_s: output_evidence.validation_from_s?,
                fit_percent,
                unseen_fit_percent: output_evidence.validation_fit_percent?,
                restarted_fit_percent: output_evidence.validation_restarted_fit_percent,
                holds: output_evidence.holds_on_unseen(fit_percent)?,
            })
        });
        self.unseen.extend(outputs.min_by(Unseen::compare));
    }

    /// Writes what the comparison says, and which models unseen samples contradict, before all other notes.
    pub fn conclude(self) -> anyhow::Result<()> {
        let Self { comparison, unseen, out } = self;
        let failing: Vec<String> = unseen.iter().filter(|model| !model.holds).map(Unseen::to_string).collect();
        if let Some(first) = unseen.first().filter(|_| !failing.is_empty()) {
            let best = unseen.iter().filter(|model| model.holds).max_by(|a, b| a.compare(b));
            let instead = best.map_or_else(String::new, |model| format!("; {model} holds"));
            let text = format!(
                "on the samples from {} s on, which no model has seen, these fail: {}; do not use them beyond the \
                 samples they were identified from{instead}",
                first.from_s,
                failing.join(", "),
            );
            // Where one holds it is the one to use.
            let weight = if best.is_some() { Weight::Marked } else { Weight::Decisive };
            let mut notes = Notes::new();
            notes.concern(About::IdentifiedModels, weight, text);
            notes.extend(std::mem::take(out.notes()));
            *out.notes() = notes;
        }
        comparison.put(out)
    }
}
