//! Candidates from identified sums of exponentials: the Maxwell model of three, the ERA paper's curve fit of four.

use crumple_lumped::{Complex, ModelKind};
use crumple_lumped_fit::{Candidate, Method, curve_fit_of_the_paper, maxwell_from_sum};
use crumple_stage::records::ExponentialSumV1;
use crumple_stage::{Inputs, Output, Refused};

use crate::stage::inputs::given_masses;
use crate::stage::options::settings::StageSettings;

/// Whether the Maxwell model is to be taken from exponents.
fn asked_for(settings: &StageSettings) -> bool {
    settings.solve.models.contains(&ModelKind::Maxwell) && settings.solve.methods.contains(&Method::ClosedForm)
}

/// Maxwell candidates from every sum of three exponentials; what keeps one from being a Maxwell model goes to the
/// notes, and so does a missing mass or sum: with `closed-form` in a list of methods this is one way among others.
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
        let text = "maxwell: no closed form, none of the inputs holds a sum of exponentials (crumple-identify \
            --methods exponentials --terms 3)";
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

/// Candidates of the ERA paper's curve fit from every sum of four real exponentials.
pub fn from_exponentials(
    settings: &StageSettings,
    input: &Inputs,
    mass_kg: Option<f64>,
    out: &mut Output,
) -> anyhow::Result<Vec<Candidate>> {
    let sums = input.records::<ExponentialSumV1>("/model/")?;
    if sums.is_empty() {
        return Err(Refused::new("none of the inputs holds a sum of exponentials")
            .expected("a sum of four real ones below /model/")
            .hint("crumple-identify --methods exponentials --terms 4 --real")
            .into());
    }
    let (m1_kg, m2_kg) = given_masses(settings, mass_kg, out)?;
    let mut candidates = Vec::new();
    for (id, sum) in sums {
        let real = sum.terms.iter().all(|term| term.im_rad_per_s == 0.0);
        let [a, b, c, d] = &sum.terms[..] else {
            out.notes().warning(format!("curve-fit: {id} has {} terms, the paper's form has four", sum.terms.len()));
            continue;
        };
        if !real {
            out.notes().warning(format!(
                "curve-fit: {id} has a damped wave, the paper's form has four real exponents (--real at \
                 crumple-identify); coefficient-matching takes any"
            ));
            continue;
        }
        let exponents = [a, b, c, d].map(|term| term.re_per_s);
        let amplitudes = [a, b, c, d].map(|term| term.re_amplitude);
        match curve_fit_of_the_paper(&id, &exponents, &amplitudes, m1_kg, m2_kg, candidates.len() + 1) {
            Ok(candidate) => {
                out.notes().warning(format!("{}: as the ERA paper prints it, for reproduction only", candidate.id()));
                candidates.push(candidate);
            }
            Err(error) => out.notes().warning(format!("curve-fit: {id}: {error}")),
        }
    }
    Ok(candidates)
}
