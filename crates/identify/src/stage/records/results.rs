//! All models of a run: what each came to, and which of them the record supports.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::fmt;

use crumple_signal::{About, Notes, Weight};
use crumple_stage::Output;
use crumple_stage::records::{EvidenceV1, IdentificationV1, SelectionModelV1, SelectionV1};
use crumple_sysid::{Contender, select};

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
    /// The lower of two: run on from the state at the end of the samples it was identified from, and with the state
    /// fitted to them.
    unseen_fit_percent: f64,
    holds: bool,
}

/// A fit of unseen samples that lies further (percent) below the fit of those that a model was identified from is that
/// of another system.
const LARGEST_LOSS_PERCENT: f64 = 30.0;

/// Whether a model holds on samples that it has not seen, as [`EvidenceV1::holds_on_unseen`] states.
fn holds_on_unseen(evidence: &EvidenceV1, fit_percent: Option<f64>) -> Option<bool> {
    let holds = |unseen: f64| unseen >= 0.0 && fit_percent.is_none_or(|fit| unseen >= fit - LARGEST_LOSS_PERCENT);
    let restarted = evidence.validation_restarted_fit_percent.is_none_or(holds);
    Some(holds(evidence.validation_fit_percent?) && restarted)
}

impl Unseen {
    /// `None`: the model has seen all samples of this output.
    fn new(id: &str, evidence: &EvidenceV1, fit_percent: Option<f64>) -> Option<Self> {
        let run_on = evidence.validation_fit_percent?;
        Some(Self {
            id: id.to_owned(),
            from_s: evidence.validation_from_s?,
            fit_percent,
            unseen_fit_percent: evidence.validation_restarted_fit_percent.map_or(run_on, |fit| fit.min(run_on)),
            holds: evidence.holds_on_unseen?,
        })
    }

    /// Those that do not hold first, then by the fit of the unseen samples, the smallest first.
    fn compare(&self, other: &Self) -> Ordering {
        self.holds.cmp(&other.holds).then(self.unseen_fit_percent.total_cmp(&other.unseen_fit_percent))
    }
}

/// `arx-4 (fit 66 %, on unseen samples below 0)`.
impl fmt::Display for Unseen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { id, fit_percent, unseen_fit_percent, .. } = self;
        let fit = fit_percent.map_or("not defined".to_owned(), |fit| format!("{fit:.0} %"));
        let unseen = match unseen_fit_percent {
            ..0.0 => "below 0".to_owned(),
            unseen => format!("{unseen:.0} %"),
        };
        write!(f, "{id} (fit {fit}, on unseen samples {unseen})")
    }
}

impl<'a> Results<'a> {
    /// No model yet.
    pub fn new(out: &'a mut Output) -> Self {
        Self { comparison: Comparison::default(), unseen: Vec::new(), out }
    }

    /// Enters a model and writes the evidence of every output: `/evidence/<id>`, of several outputs
    /// `/evidence/<id>/<number>`. Of several outputs the one that is worst on unseen samples counts.
    pub fn enter(&mut self, id: &str, model: &IdentificationV1, evidence: &mut [EvidenceV1]) -> anyhow::Result<()> {
        self.comparison.enter(id, usize::try_from(model.samples).unwrap_or(usize::MAX), evidence);
        let single = evidence.len() == 1;
        let fits = match &model.output_fits_percent {
            fits if fits.len() == evidence.len() => fits.clone(),
            _ => vec![model.fit_percent; evidence.len()],
        };
        let mut outputs = Vec::new();
        for (number, (output_evidence, fit_percent)) in evidence.iter_mut().zip(fits).enumerate() {
            output_evidence.holds_on_unseen = holds_on_unseen(output_evidence, fit_percent);
            let place = if single { String::new() } else { format!("/{}", number + 1) };
            self.out.put(&format!("/evidence/{id}{place}"), output_evidence)?;
            outputs.extend(Unseen::new(id, output_evidence, fit_percent));
        }
        self.unseen.extend(outputs.into_iter().min_by(Unseen::compare));
        Ok(())
    }

    /// Writes what the comparison says, and which models unseen samples contradict, before all other notes.
    pub fn conclude(self) -> anyhow::Result<()> {
        let Self { comparison, unseen, out } = self;
        let failing: Vec<String> = unseen.iter().filter(|model| !model.holds).map(Unseen::to_string).collect();
        if let Some(first) = unseen.first().filter(|_| !failing.is_empty()) {
            let best = unseen.iter().filter(|model| model.holds).max_by(|a, b| a.compare(b));
            let instead = best.map_or_else(String::new, |model| format!(". Use {model}"));
            let text = format!(
                "not to be used beyond the samples up to {:.0} ms that they were identified from: {}{instead}",
                1e3 * first.from_s,
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

/// The models of a run, by output and by the samples they were fitted to.
#[derive(Default)]
pub struct Comparison(BTreeMap<(String, u64), Vec<Contender>>);

impl Comparison {
    /// Enters a model of so many samples, with the evidence of every output.
    ///
    /// Of several outputs the losses are multiplied (their geometric mean is taken) and the independent samples added:
    /// the likelihood of noises that are independent of each other. Such models are compared among themselves, for
    /// their parameters serve all outputs.
    pub fn enter(&mut self, id: &str, samples: usize, evidence: &[EvidenceV1]) {
        let Some(first) = evidence.first() else { return };
        let known: Vec<(f64, f64)> = evidence.iter().filter_map(|s| Some((s.loss?, s.effective_samples?))).collect();
        if known.len() < evidence.len() {
            return;
        }
        let loss = match &known[..] {
            [(loss, _)] => *loss,
            several => (several.iter().map(|(loss, _)| loss.ln()).sum::<f64>() / several.len() as f64).exp(),
        };
        let output = evidence.iter().map(|s| s.output.as_str()).collect::<Vec<_>>().join(", ");
        let validations: Option<Vec<f64>> = evidence.iter().map(|s| s.validation_fit_percent).collect();
        self.0.entry((output, samples as u64)).or_default().push(Contender {
            id: id.to_owned(),
            parameters: usize::try_from(first.parameters).unwrap_or(usize::MAX),
            loss,
            effective_samples: known.iter().map(|(_, effective)| effective).sum(),
            validation_fit_percent: validations.and_then(|fits| fits.into_iter().reduce(f64::min)),
        });
    }

    /// Writes what the comparison says, for every output with two models or more.
    pub fn put(self, out: &mut Output) -> anyhow::Result<()> {
        let mut written: Vec<String> = Vec::new();
        for ((output, samples), contenders) in self.0 {
            let Some(selection) = select(&contenders) else { continue };
            // Models of other windows of the same output have a place of their own.
            let place = output.replace(", ", "+");
            let topic = if written.contains(&output) {
                format!("/selection/{place}/{samples}")
            } else {
                format!("/selection/{place}")
            };
            written.push(output.clone());
            let best_by_aicc = selection.ranked[0].contender.id.clone();
            if selection.near_equal.len() > 1 {
                out.notes().info(format!(
                    "the record does not tell apart {}: their AICc differ by less than 2 (with {:.0} independent \
                     samples)",
                    selection.near_equal.join(", "),
                    selection.effective_samples
                ));
            }
            let record = SelectionV1 {
                output,
                effective_samples: selection.effective_samples,
                models: selection
                    .ranked
                    .iter()
                    .map(|r| SelectionModelV1 {
                        id: r.contender.id.clone(),
                        parameters: r.contender.parameters as u64,
                        loss: r.contender.loss,
                        aicc_difference: r.aicc_difference,
                        bic_difference: r.bic_difference,
                        validation_fit_percent: r.contender.validation_fit_percent,
                        order: None,
                        validation_restarted_fit_percent: None,
                    })
                    .collect(),
                best_by_aicc,
                best_by_bic: selection.best_by_bic,
                best_by_validation: selection.best_by_validation,
                near_equal: selection.near_equal,
                recommended: None,
                recommended_because: None,
                passed_over: None,
            };
            out.put(&topic, &record)?;
        }
        Ok(())
    }
}
