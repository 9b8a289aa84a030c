//! Sums of exponentials among the inputs, for the Maxwell model.

use crumple_lumped::{Complex, ModelKind};
use crumple_lumped_fit::{Candidate, Method, maxwell_from_sum};
use crumple_stage::records::ExponentialSumV1;
use crumple_stage::{Inputs, Output};

use crate::stage::options::settings::StageSettings;

/// Whether the Maxwell model is to be taken from exponents.
pub fn asked_for(settings: &StageSettings) -> bool {
    settings.solve.models.contains(&ModelKind::Maxwell) && settings.solve.methods.contains(&Method::ClosedForm)
}

/// Maxwell candidates from every sum of three exponentials; what keeps one from being a Maxwell model goes to the notes, and so
/// does a missing mass or sum: with `closed-form` in a list of methods this is one way among others.
pub fn maxwell_candidates(
    settings: &StageSettings,
    input: &Inputs,
    mass_kg: Option<f64>,
    out: &mut Output,
) -> anyhow::Result<Vec<Candidate>> {
    let mut candidates = Vec::new();
    if !asked_for(settings) {
        return Ok(candidates);
    }
    let sums = input.records::<ExponentialSumV1>("/model/")?;
    if sums.is_empty() {
        let text = "maxwell: no closed form, none of the inputs holds a sum of exponentials (crumple-identify --methods \
                    exponentials --terms 3)";
        if settings
            .solve
            .methods
            .iter()
            .any(|method| *method != Method::ClosedForm && method.solves(ModelKind::Maxwell))
        {
            out.notes().info(text);
        } else {
            out.notes().warning(text);
        }
        return Ok(candidates);
    }
    let Some(mass_kg) = mass_kg else {
        out.notes().warning("maxwell: no closed form, the test has no mass (--mass 873kg)");
        return Ok(candidates);
    };
    for (id, sum) in sums {
        let exponents: Vec<Complex> =
            sum.terms.iter().map(|term| Complex::new(term.re_per_s, term.im_rad_per_s)).collect();
        match maxwell_from_sum(&id, &exponents, mass_kg, candidates.len() + 1) {
            Ok(candidate) => candidates.push(candidate),
            Err(error) => out.notes().warning(format!("maxwell: not from {id}: {error}")),
        }
    }
    Ok(candidates)
}
