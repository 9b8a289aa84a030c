//! All models of a run: what each came to, and which of them the record supports.

use std::collections::BTreeMap;

use crumple_signal::{About, Note, Notes, Weight, remarks};
use crumple_stage::Output;
use crumple_stage::records::{EvidenceV1, IdentificationV1, RecommendedBecauseV1, SelectionModelV1, SelectionV1};
use crumple_sysid::{Contender, OnUnseen, Ranked, Recommendable, Selection, left_by_unseen, recommended, select};

/// The artifact, and what every model of the run is entered into.
pub struct Results<'a> {
    /// Compares models of one output once all are there.
    comparison: Comparison,
    /// What unseen samples say against models, in their order.
    contradicted: Vec<Contradicted>,
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

/// Whether unseen samples contradict a model; of several outputs the one that is worst on unseen samples speaks.
fn contradiction(id: &str, evidence: &[EvidenceV1], fits: &[Option<f64>]) -> Option<Contradicted> {
    let failing = evidence.iter().zip(fits).filter(|(evidence, _)| evidence.holds_on_unseen == Some(false));
    let of_output = failing.filter_map(|(evidence, fit)| Some((evidence, fit, validation_percent(evidence)?)));
    let (worst, fit, _) = of_output.min_by(|a, b| a.2.total_cmp(&b.2))?;
    Some(Contradicted {
        id: id.to_owned(),
        output: (evidence.len() > 1).then(|| worst.output.clone()),
        from_s: worst.validation_from_s?,
        validation_percent: worst.validation_fit_percent,
        restarted_percent: worst.validation_restarted_fit_percent,
        fit_percent: *fit,
    })
}

/// `unseen samples from 2000 ms on contradict it: validation -12.0 % with the start fitted, fit 65.7 %`.
fn contradiction_in_words(
    output: Option<&str>,
    from_s: f64,
    (validation_percent, restarted_percent): (Option<f64>, Option<f64>),
    fit_percent: Option<f64>,
) -> String {
    let name = output.map_or_else(String::new, |output| format!(" of {output}"));
    let started = restarted_percent.map_or("", |_| " with the start fitted");
    let fit = fit_percent.map_or_else(|| "no defined fit".to_owned(), |fit| format!("fit {fit:.1} %"));
    format!(
        "unseen samples{name} from {:.0} ms on contradict it: validation {:.1} %{started}, {fit}",
        1e3 * from_s,
        restarted_percent.or(validation_percent).unwrap_or_default()
    )
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
        let found = contradiction(id, evidence, &fits);
        self.contradicted.extend(found.clone());
        Ok(found.map(Note::from))
    }

    /// Writes what the comparison says, and which models unseen samples contradict, before all other notes.
    ///
    /// Returns the number of states of the model to use of the first output, or of its only one.
    pub fn conclude(self) -> anyhow::Result<Option<usize>> {
        let Self { comparison, contradicted, one_holds, out } = self;
        let mut notes = Notes::new();
        for found in contradicted {
            // Where one holds it is the one to use.
            if one_holds {
                notes.push(found);
            } else {
                let in_summary = Note::from(found.clone());
                let Contradicted { id, output, from_s, validation_percent, restarted_percent, fit_percent } = found;
                let remark =
                    Note::from(NoneHolds { id, output, from_s, validation_percent, restarted_percent, fit_percent });
                out.replace_in_summary(&in_summary, &remark);
                notes.push(remark);
            }
        }
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
                let (models, samples) = (selection.near_equal.clone(), selection.effective_samples);
                out.notes().push(NotToldApart { models, samples });
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

remarks! {
    /// Remarks of the comparison of models.
    pub REMARKS;

    /// Unseen samples contradict a model, and another model holds on them.
    CR474 Contradicted {
        id: String, output: Option<String>, from_s: f64, validation_percent: Option<f64>,
        restarted_percent: Option<f64>, fit_percent: Option<f64>
    }
    bears on (About::IdentifiedModels, Weight::Marked)
    decided "The fit of the samples kept by --validate-from is below 0, or more than 30 points below the fit of the \
             samples that the model was identified from. The start is fitted to them where the method can."
    means "The model is not one of the system, but of the samples it was fitted to. Do not use it."
    remedy "use a model that holds on unseen samples: see recommended in the record /selection"
    says format!(
        "{id}: {}",
        contradiction_in_words(output.as_deref(), *from_s, (*validation_percent, *restarted_percent), *fit_percent)
    );

    /// Unseen samples contradict a model, and no model of the run holds on all of them.
    CR475 NoneHolds {
        id: String, output: Option<String>, from_s: f64, validation_percent: Option<f64>,
        restarted_percent: Option<f64>, fit_percent: Option<f64>
    }
    bears on (About::IdentifiedModels, Weight::Decisive)
    decided "The fit of the samples kept by --validate-from is below 0, or more than 30 points below the fit of the \
             samples that the model was identified from. The start is fitted to them where the method can."
    means "The system changes over the record, an input is missing, or it is not linear. No model of this run is one \
           of it."
    remedy "try other orders, methods or inputs, or a window in which the system is the same: --from, --to"
    says format!(
        "{id}: {}",
        contradiction_in_words(output.as_deref(), *from_s, (*validation_percent, *restarted_percent), *fit_percent)
    );

    /// Several models follow the record equally well.
    CR476 NotToldApart { models: Vec<String>, samples: f64 }
    bears on (About::IdentifiedModels, Weight::None)
    decided "Their AICc differ by less than 2 (Burnham & Anderson, Model Selection and Multimodel Inference, 2002, ch. \
             2.6), with as many independent samples as the errors are worth."
    means "What these models say differently, the record does not tell."
    remedy "nothing; take the smallest one, or keep samples for a validation: --validate-from 50%"
    says format!(
        "the record does not tell apart {}: their AICc differ by less than 2 (with {samples:.0} independent samples)",
        models.join(", ")
    );
}
