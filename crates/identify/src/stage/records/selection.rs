//! Models of one output compared with each other, once all are there.

use std::collections::BTreeMap;

use crumple_stage::Output;
use crumple_stage::records::{EvidenceV1, SelectionModelV1, SelectionV1};
use crumple_sysid::{Contender, select};

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
                    })
                    .collect(),
                best_by_aicc,
                best_by_bic: selection.best_by_bic,
                best_by_validation: selection.best_by_validation,
                near_equal: selection.near_equal,
            };
            out.put(&topic, &record)?;
        }
        Ok(())
    }
}
