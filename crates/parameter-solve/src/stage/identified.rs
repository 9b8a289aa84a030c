//! Candidates from identified models: by coefficient matching with four poles, from sums of exponentials.

use crumple_lumped::{Complex, ModelKind, RealisedModel};
use crumple_lumped_fit::{
    Candidate, CoefficientSpread, Identified, MassSplit, MassesTaken, Method, Quartic, curve_fit_of_the_paper,
    maxwell_from_sum,
};
use crumple_numerics::lti::{eigenvalues, matrix_logarithm};
use crumple_signal::{About, Weight, remarks};
use crumple_stage::records::{EvidenceV1, ExponentialSumV1, ModesV2, StateSpaceV1, TransferFunctionV1};
use crumple_stage::{Inputs, Output, RefuseExt, Refused, flag, option, program};

use crate::stage::inputs::see;
use nalgebra::{DMatrix, Matrix4, RowVector4, Vector4};

use crate::stage::records::matching_record;
use crate::stage::settings::StageSettings;

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
            .hint(format!(
                "give the artifact of {} with order 4, or exponentials with 4 terms, too",
                program("identify")
            ))
            .into());
    }
    let mut candidates: Vec<Candidate> = Vec::new();
    for model in &identified {
        let first = candidates.len() + 1;
        let matched = model.matched(m1_kg, m2_kg, first, out.notes()).refuse_with_hint(matching_hint(model))?;
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
        if settings
            .solve
            .methods
            .iter()
            .any(|method| *method != Method::ClosedForm && method.solves(ModelKind::Maxwell))
        {
            out.notes().push(OtherWayForMaxwell {});
        } else {
            out.notes().push(NoSumForMaxwell {});
        }
        return Ok(candidates);
    }
    let Some(mass_kg) = mass_kg else {
        out.notes().push(NoMassForMaxwell {});
        return Ok(candidates);
    };
    for (id, sum) in sums {
        let exponents: Vec<Complex> =
            sum.terms.iter().map(|term| Complex::new(term.re_per_s, term.im_rad_per_s)).collect();
        match maxwell_from_sum(&id, &exponents, mass_kg, candidates.len() + 1) {
            Ok(candidate) => candidates.push(candidate),
            Err(error) => out.notes().push(NotAMaxwell { id, reason: error.to_string() }),
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
            .hint(
                ["methods exponentials", "terms 4", "real"]
                    .map(|words| {
                        let (name, value) = words.split_once(' ').unwrap_or((words, ""));
                        option("identify", name, value)
                    })
                    .join(", "),
            )
            .into());
    }
    let (m1_kg, m2_kg) = given_masses(settings, mass_kg, out)?;
    let mut candidates = Vec::new();
    for (id, sum) in sums {
        let real = sum.terms.iter().all(|term| term.im_rad_per_s == 0.0);
        let [a, b, c, d] = &sum.terms[..] else {
            out.notes().push(NotThePapersForm { id, terms: sum.terms.len() });
            continue;
        };
        if !real {
            out.notes().push(NotThePapersForm { id, terms: sum.terms.len() });
            continue;
        }
        let exponents = [a, b, c, d].map(|term| term.re_per_s);
        let amplitudes = [a, b, c, d].map(|term| term.re_amplitude);
        match curve_fit_of_the_paper(&id, &exponents, &amplitudes, m1_kg, m2_kg, candidates.len() + 1) {
            Ok(candidate) => {
                out.notes().push(ForReproduction { id: candidate.id() });
                candidates.push(candidate);
            }
            Err(error) => out.notes().push(NoCurveFit { id, reason: error.to_string() }),
        }
    }
    Ok(candidates)
}

// Identified models with four poles among the inputs.

/// Every model with four poles: transfer functions of fourth order with the state space of the same name where there is
/// one, then state spaces without a transfer function, sums of four exponentials, and modes of four poles that belong
/// to none of them.
pub fn identified_models(input: &Inputs) -> anyhow::Result<Vec<Identified>> {
    let mut models: Vec<Identified> = Vec::new();
    for (id, model) in input.records::<TransferFunctionV1>("/model/")? {
        if let [leading, t, u, v, w] = model.denominator[..]
            && leading != 0.0
        {
            let quartic = Quartic::Coefficients([t, u, v, w].map(|c| c / leading));
            let source = "denominator of the transfer function";
            let spread = spread(input, &id)?;
            let delay_s = model.delay_s.unwrap_or(0.0);
            let numerator = Some(model.numerator);
            models.push(Identified { id, quartic, numerator, source, realised: None, spread, delay_s });
        }
    }
    let spaces = input.records::<StateSpaceV1>("/model/")?;
    for (id, model) in &spaces {
        // The continuous one of a pair says all.
        let base = base_of(id);
        if id.ends_with("/discrete") && spaces.iter().any(|(other, _)| *other == format!("{base}/continuous")) {
            continue;
        }
        let Some((a, rows)) = continuous(model) else { continue };
        let realised = realised(&a, &rows, model);
        if let Some(known) = models.iter_mut().find(|known| base_of(&known.id) == base) {
            known.realised = realised;
            continue;
        }
        let poles = eigenvalues(&DMatrix::from_column_slice(4, 4, a.as_slice()))?;
        if let Ok(poles) = <[Complex; 4]>::try_from(poles) {
            let delay_s = model.delay_s.unwrap_or(0.0);
            let bare = Identified::of_poles(id.clone(), poles, "eigenvalues of the state matrix of");
            models.push(Identified { realised, delay_s, ..bare });
        }
    }
    for (id, sum) in input.records::<ExponentialSumV1>("/model/")? {
        if let [a, b, c, d] = &sum.terms[..] {
            let poles = [a, b, c, d].map(|term| Complex::new(term.re_per_s, term.im_rad_per_s));
            models.push(Identified::of_poles(id, poles, "exponents of the sum"));
        }
    }
    for (id, modes) in input.records::<ModesV2>("/modes/")? {
        if let [a, b, c, d] = &modes.modes[..]
            && !models.iter().any(|model| base_of(&model.id) == id)
        {
            let poles = [a, b, c, d].map(|mode| Complex::new(mode.re_per_s, mode.im_rad_per_s));
            models.push(Identified::of_poles(id, poles, "poles of the modes of"));
        }
    }
    Ok(models)
}

/// How well the coefficients of a transfer function are known, by the evidence that its identification left.
fn spread(input: &Inputs, id: &str) -> anyhow::Result<Option<CoefficientSpread>> {
    let evidence: Option<EvidenceV1> = input.record_if(&format!("/evidence/{}", base_of(id)))?;
    Ok(evidence.and_then(|evidence| {
        CoefficientSpread::of_covariance(&evidence.denominator_covariance)
            .or_else(|| CoefficientSpread::of_deviations(&evidence.denominator_deviations))
    }))
}

/// `era-4` of `era-4/continuous`.
fn base_of(id: &str) -> &str {
    ["/continuous", "/discrete", "/transfer-function"].iter().find_map(|end| id.strip_suffix(end)).unwrap_or(id)
}

/// State matrix in continuous time and output rows of a model with four states; `None` for another order or where the
/// sampled matrix has no logarithm.
fn continuous(model: &StateSpaceV1) -> Option<(Matrix4<f64>, Vec<RowVector4<f64>>)> {
    let flat: Vec<f64> = model.a.iter().flatten().copied().collect();
    if model.a.len() != 4 || flat.len() != 16 {
        return None;
    }
    let a = Matrix4::from_row_slice(&flat);
    let a = if model.sample_time_s > 0.0 {
        let log = matrix_logarithm(&DMatrix::from_column_slice(4, 4, a.as_slice())).ok()?;
        Matrix4::from_column_slice((log / model.sample_time_s).as_slice())
    } else {
        a
    };
    let rows = model.c.iter().filter(|row| row.len() == 4).map(|row| RowVector4::from_row_slice(row)).collect();
    Some((a, rows))
}

/// One output is the compartment's; of two the first is that of the chassis. `None` where the words of the output name
/// no motion.
fn realised(a: &Matrix4<f64>, rows: &[RowVector4<f64>], model: &StateSpaceV1) -> Option<RealisedModel> {
    let derivative = ["displacement", "velocity", "acceleration"].iter().position(|q| model.output.starts_with(q))?;
    let (chassis, compartment) = match rows {
        [compartment] => (None, *compartment),
        [chassis, compartment] => (Some(*chassis), *compartment),
        _ => return None,
    };
    // The state right after an impulse is the column of the input: the start of a free motion.
    let column: Vec<f64> = model.b.iter().filter_map(|row| row.first().copied()).collect();
    let free = model.input.contains("impulse") && column.len() == 4;
    let start = free.then(|| Vector4::from_column_slice(&column));
    Some(RealisedModel { a: *a, compartment, chassis, derivative, start })
}

// Masses of chassis and compartment for models that are matched.

/// Masses of chassis and compartment, by the options and the test.
pub fn given_masses(settings: &StageSettings, mass_kg: Option<f64>, out: &mut Output) -> anyhow::Result<(f64, f64)> {
    let mass_kg = match (mass_kg, settings.solve.split) {
        (Some(mass), _) => mass,
        (None, MassSplit::Both(m1, m2)) => m1 + m2,
        (None, _) => {
            return Err(Refused::new("the test has no mass")
                .expected("the masses of chassis and compartment")
                .hint(format!("{} {}", option("parameter-solve", "m1", "284.4kg"), flag("parameter-solve", "m2")))
                .into());
        }
    };
    let (m1_kg, m2_kg, split) = settings.solve.split.masses(mass_kg).refuse_with_hint(see(&["m1", "m2"]))?;
    out.notes().push(MassesTaken { model: None, reason: split });
    Ok((m1_kg, m2_kg))
}

/// What is said where no input has what the closed form of the Maxwell model is made from.
const NO_SUM: &str = "maxwell: no closed form, none of the inputs holds a sum of exponentials (--set \
    identify.methods=exponentials --set identify.terms=3)";

remarks! {
    /// Remarks of candidates from identified models.
    pub REMARKS;

    /// The Maxwell model is asked for from exponents, and no sum of exponentials was identified.
    CR552 NoSumForMaxwell {}
    bears on (About::Model(String::new()), Weight::Slight)
    decided "Sums of exponentials are looked for below /model/. No other method that is asked for solves this model."
    means "There is no Maxwell candidate."
    remedy "let identify fit three exponentials (methods exponentials, terms 3), or add direct-fit to method"
    says NO_SUM;

    /// The Maxwell model is not found from exponents, and another method finds it.
    CR553 OtherWayForMaxwell {}
    bears on (About::Model(String::new()), Weight::None)
    decided "Sums of 3 exponentials are looked for below /model/. Another method that is asked for solves this model."
    means "The other method makes the Maxwell candidate."
    remedy "nothing"
    says NO_SUM;

    /// The Maxwell model is asked for from exponents, and the mass is not known.
    CR554 NoMassForMaxwell {}
    bears on (About::Model(String::new()), Weight::Slight)
    decided "Exponents give stiffness and damping over the mass; neither the test nor --mass has it."
    means "There is no Maxwell candidate from exponents."
    remedy "state the mass: --mass 873kg"
    says "maxwell: no closed form, the test has no mass (--mass 873kg)";

    /// A sum of exponentials is not the motion of a Maxwell model.
    CR555 NotAMaxwell { id: String, reason: String }
    bears on (About::Model(String::new()), Weight::Slight)
    decided "The displacement has a constant and two more exponents, real or conjugate, that decay (single-mass paper, \
             equations 18 to 25). The sentence has what is missing."
    means "This sum gives no candidate."
    remedy "let identify fit three exponentials to the displacement, or use direct-fit"
    says format!("maxwell: not from {id}: {reason}");

    /// A sum of exponentials does not have the form that the curve fit of the ERA paper needs.
    CR556 NotThePapersForm { id: String, terms: usize }
    bears on (About::Model(String::new()), Weight::Slight)
    decided "The paper's equations take four real exponents."
    means "This sum gives no candidate of curve-fit."
    remedy "use coefficient-matching; for the paper let identify fit with terms 4 and real"
    says if *terms == 4 {
        format!(
            "curve-fit: {id} has a damped wave, the paper's form has four real exponents (--real at identify); \
             coefficient-matching takes any"
        )
    } else {
        format!("curve-fit: {id} has {terms} terms, the paper's form has four")
    };

    /// A candidate reproduces the equations of the ERA paper.
    CR557 ForReproduction { id: String }
    bears on (About::Model(String::new()), Weight::Slight)
    decided "The method curve-fit is asked for: equations 17 to 25 of the paper, which do not follow from the model \
             (docs/papers.md)."
    means "The model does not have the exponents that it was made from. Its springs and dampers mean nothing."
    remedy "use coefficient-matching with the same exponents"
    says format!("{id}: as the ERA paper prints it, for reproduction only");

    /// The curve fit of the ERA paper has no solution with a sum of exponentials.
    CR558 NoCurveFit { id: String, reason: String }
    bears on (About::Model(String::new()), Weight::Slight)
    decided "Masses are to be positive and exponents to differ; the sentence has what is wrong."
    means "This sum gives no candidate of curve-fit."
    remedy "use coefficient-matching"
    says format!("curve-fit: {id}: {reason}");
}
