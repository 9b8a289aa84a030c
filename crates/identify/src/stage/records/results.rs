//! All models of a run: what each came to, and which of them the record supports.

use std::collections::BTreeMap;

use crumple_signal::{About, Note, Notes, Weight};
use crumple_stage::Output;
use crumple_stage::records::{EvidenceV1, IdentificationV1, RecommendedBecauseV1, SelectionModelV1, SelectionV1};
use crumple_sysid::{Contender, OnUnseen, Ranked, Recommendable, Selection, left_by_unseen, recommended, select};

/// The artifact, and what every model of the run is entered into.
pub struct Results<'a> {
    /// Compares models of one output once all are there.
    comparison: Comparison,
    /// What unseen samples say against models, in their order.
    contradicted: Vec<String>,
    /// Whether a model holds on samples that it has not seen.
    one_holds: bool,
    /// Records, notes and the summary.
    pub out: &'a mut Output,
}

/// The fit of unseen samples that counts: with the start fitted, where the method can.
fn validation_percent(evidence: &EvidenceV1) -> Option<f64> {
    evidence.validation_restarted_fit_percent.or(evidence.validation_fit_percent)
}

/// Whether a model holds on samples that it has not seen, as [`EvidenceV1::holds_on_unseen`] states.
fn holds_on_unseen(evidence: &EvidenceV1, fit_percent: Option<f64>) -> Option<bool> {
    Some(OnUnseen::of(fit_percent, validation_percent(evidence)?) == OnUnseen::Holds)
}

/// `arx-4: unseen samples from 2000 ms on contradict it: validation -12.0 % with the start fitted, fit 65.7 %`; of
/// several outputs the one that is worst on unseen samples speaks. `None`: none is contradicted.
fn contradiction(id: &str, evidence: &[EvidenceV1], fits: &[Option<f64>]) -> Option<String> {
    let failing = evidence.iter().zip(fits).filter(|(evidence, _)| evidence.holds_on_unseen == Some(false));
    let of_output = failing.filter_map(|(evidence, fit)| Some((evidence, fit, validation_percent(evidence)?)));
    let (worst, fit, unseen) = of_output.min_by(|a, b| a.2.total_cmp(&b.2))?;
    let name = if evidence.len() > 1 { format!(" of {}", worst.output) } else { String::new() };
    let started = if worst.validation_restarted_fit_percent.is_some() { " with the start fitted" } else { "" };
    let fit = fit.map_or_else(|| "no defined fit".to_owned(), |fit| format!("fit {fit:.1} %"));
    Some(format!(
        "{id}: unseen samples{name} from {:.0} ms on contradict it: validation {unseen:.1} %{started}, {fit}",
        1e3 * worst.validation_from_s?
    ))
}

impl<'a> Results<'a> {
    /// No model yet.
    pub fn new(out: &'a mut Output) -> Self {
        Self { comparison: Comparison::default(), contradicted: Vec::new(), one_holds: false, out }
    }

    /// Enters a model and writes the evidence of every output: `/evidence/<id>`, of several outputs
    /// `/evidence/<id>/<number>`. Returns the warning where unseen samples contradict it.
    pub fn enter(
        &mut self,
        id: &str,
        model: &IdentificationV1,
        evidence: &mut [EvidenceV1],
        unseen_squares: Vec<f64>,
    ) -> anyhow::Result<Option<Note>> {
        self.comparison.enter(id, model, evidence, unseen_squares);
        let single = evidence.len() == 1;
        let mut fits = if single { vec![model.fit_percent] } else { model.output_fits_percent.clone() };
        // An ambient record has no fits.
        fits.resize(evidence.len(), None);
        for (number, (output_evidence, fit_percent)) in evidence.iter_mut().zip(&fits).enumerate() {
            output_evidence.holds_on_unseen = holds_on_unseen(output_evidence, *fit_percent);
            let place = if single { String::new() } else { format!("/{}", number + 1) };
            self.out.put(&format!("/evidence/{id}{place}"), output_evidence)?;
        }
        self.one_holds |= evidence.iter().all(|evidence| evidence.holds_on_unseen == Some(true));
        let text = contradiction(id, evidence, &fits);
        self.contradicted.extend(text.clone());
        Ok(text.map(Note::warning))
    }

    /// Writes what the comparison says, and which models unseen samples contradict, before all other notes.
    ///
    /// Returns the number of states of the model to use of the first output, or of its only one.
    pub fn conclude(self) -> anyhow::Result<Option<usize>> {
        let Self { comparison, contradicted, one_holds, out } = self;
        // Where one holds it is the one to use.
        let weight = if one_holds { Weight::Marked } else { Weight::Decisive };
        let mut notes = Notes::new();
        contradicted.into_iter().for_each(|text| notes.concern(About::IdentifiedModels, weight, text));
        notes.extend(std::mem::take(out.notes()));
        *out.notes() = notes;
        let order = comparison.order();
        comparison.put(out)?;
        Ok(order)
    }
}

/// The models of a run, by output and by the samples they were fitted to.
#[derive(Default)]
pub struct Comparison(BTreeMap<(String, u64), Vec<Contender>>);

/// Standard errors of the difference by which a model may follow unseen samples worse than the best.
const ONE_ERROR: f64 = 1.0;

/// The id of the model to use, and of the one with the smallest BIC where that was passed over: among those that unseen
/// samples leave, where there are any.
fn best_of(selection: &Selection, contenders: &[Contender]) -> Option<(String, Option<String>)> {
    let left = left_by_unseen(contenders, ONE_ERROR);
    let model = |Ranked { contender, bic_difference, .. }: &Ranked| Recommendable {
        id: contender.id.clone(),
        order: contender.order,
        bic: *bic_difference,
        validation_percent: contender.restarted_fit_percent,
    };
    let is_left = |ranked: &&Ranked| left.iter().any(|contender| contender.id == ranked.contender.id);
    let models: Vec<Recommendable> = selection.ranked.iter().filter(is_left).map(model).collect();
    let best = recommended(&models)?.0.id.clone();
    let passed_over = Some(selection.best_by_bic.clone()).filter(|other| *other != best);
    Some((best, passed_over))
}

impl Comparison {
    /// The number of states of the model to use of the first output, or of its only one.
    fn order(&self) -> Option<usize> {
        let contenders = self.0.values().next()?;
        let id = select(contenders).and_then(|selection| Some(best_of(&selection, contenders)?.0));
        contenders.iter().find(|contender| id.as_ref().is_none_or(|id| contender.id == *id)).map(|best| best.order)
    }

    /// Enters a model of so many samples, with the evidence of every output.
    ///
    /// Of several outputs the losses are multiplied (their geometric mean is taken) and the independent samples added:
    /// the likelihood of noises that are independent of each other. Such models are compared among themselves, for
    /// their parameters serve all outputs.
    pub fn enter(&mut self, id: &str, model: &IdentificationV1, evidence: &[EvidenceV1], unseen_squares: Vec<f64>) {
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
        let restarted: Option<Vec<f64>> = evidence.iter().map(validation_percent).collect();
        self.0.entry((output, model.samples)).or_default().push(Contender {
            order: model.order as usize,
            restarted_fit_percent: restarted.map(|fits| fits.iter().sum::<f64>() / fits.len() as f64),
            id: id.to_owned(),
            parameters: usize::try_from(first.parameters).unwrap_or(usize::MAX),
            loss,
            effective_samples: known.iter().map(|(_, effective)| effective).sum(),
            validation_fit_percent: validations.and_then(|fits| fits.into_iter().reduce(f64::min)),
            unseen_squares,
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
            let best = best_of(&selection, &contenders);
            if let Some((id, passed_over)) = &best {
                let why = match passed_over {
                    Some(other) => format!("follows unseen samples better than {other}, which has the smallest BIC"),
                    None => "the smallest BIC".to_owned(),
                };
                out.summary(format!("recommended of {}: {id} ({why})", contenders.len()));
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
                        order: u32::try_from(r.contender.order).ok(),
                        validation_restarted_fit_percent: r.contender.restarted_fit_percent,
                    })
                    .collect(),
                best_by_aicc,
                best_by_bic: selection.best_by_bic,
                best_by_validation: selection.best_by_validation,
                near_equal: selection.near_equal,
                recommended_because: best.as_ref().map(|(_, passed_over)| match passed_over {
                    Some(_) => RecommendedBecauseV1::ValidatesBetter,
                    None => RecommendedBecauseV1::SmallestBic,
                }),
                passed_over: best.as_ref().and_then(|(_, passed_over)| passed_over.clone()),
                recommended: best.map(|(id, _)| id),
            };
            out.put(&topic, &record)?;
        }
        Ok(())
    }
}
