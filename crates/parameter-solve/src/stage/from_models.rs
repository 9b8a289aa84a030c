//! Candidates from identified models with four poles, by coefficient matching.

use crumple_lumped_fit::{Candidate, Identified, Quartic, match_identified};
use crumple_stage::{Inputs, Output, RefuseExt, Refused};

use crate::stage::inputs::given_masses;
use crate::stage::inputs::identified_models;
use crate::stage::options::settings::StageSettings;
use crate::stage::records::matching_record;

/// Candidates from every identified model with four poles, and the record of each matching.
pub fn from_models(
    settings: &StageSettings,
    input: &Inputs,
    mass_kg: Option<f64>,
    out: &mut Output,
) -> anyhow::Result<Vec<Candidate>> {
    let identified = identified_models(input)?;
    if identified.is_empty() && settings.paper.is_some() {
        return Ok(Vec::new());
    }
    let (m1_kg, m2_kg) = given_masses(settings, mass_kg, out)?;
    if identified.is_empty() {
        return Err(Refused::new("none of the inputs holds a model with four poles")
            .expected(
                "below /model/ a transfer function with a denominator of degree 4, a state space of order 4 or a sum \
                 of four exponentials, or four poles below /modes/",
            )
            .hint("give the artifact of crumple-identify with order 4, or --methods exponentials --terms 4, too")
            .into());
    }
    let mut candidates: Vec<Candidate> = Vec::new();
    for model in &identified {
        let first = candidates.len() + 1;
        let matched =
            match_identified(model, m1_kg, m2_kg, first, out.notes()).refuse_with_hint(matching_hint(model))?;
        out.put(&format!("/matching/{}", model.id), &matching_record(&matched, model.source))?;
        candidates.extend(matched.candidates);
    }
    Ok(candidates)
}

/// What to do where matching refuses an identified model. The masses have been checked: it is its poles.
fn matching_hint(model: &Identified) -> String {
    match model.quartic {
        Quartic::Coefficients(_) => format!("look at the denominator of {}: its coefficients must be finite", model.id),
        Quartic::Poles(_) => {
            format!("look at {}: its complex poles must come in conjugate pairs, each written down", model.id)
        }
    }
}
