//! All candidates for one test.

use crumple_lumped::{Model, ModelKind};
use crumple_signal::{Displacement, Notes, Signal};

use crate::{
    Candidate, DoubleFitOptions, FireflyOptions, KelvinBranch, Method, NonlinearFitOptions, SolveError,
    elastoplastic_from_events, firefly_nonlinear2, fit_double, fit_maxwell, fit_nonlinear1, fit_nonlinear2,
    kelvin_from_events, undetermined_by_the_record,
};

/// Error of a displacement integrated twice by the trapezoidal rule at 10 kHz, m: known records lie within 1.3e-6 m.
const DISPLACEMENT_RESOLUTION_M: f64 = 1.3e-6;

/// What a test says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evidence<'a> {
    /// Test mass, kg.
    pub mass_kg: f64,
    /// Speed at contact, m/s.
    pub impact_speed_m_per_s: f64,
    /// Time of dynamic crush after time zero, s, if the velocity reaches zero.
    pub time_of_dynamic_crush_s: Option<f64>,
    /// Dynamic crush, m.
    pub dynamic_crush_m: Option<f64>,
    /// Coefficient of restitution, if the record shows the rebound.
    pub coefficient_of_restitution: Option<f64>,
    /// Time zero on the axis of the displacement record, s.
    pub time_zero_s: f64,
    /// Displacement of the compartment.
    pub displacement: Option<&'a Signal<Displacement>>,
}

/// How the test mass divides into chassis and compartment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MassSplit {
    /// `m1/(m1 + m2)`.
    FrontFraction(f64),
    /// Mass of the chassis alone, kg; the compartment is the rest.
    Front(f64),
    /// Mass of the compartment alone, kg; the chassis is the rest.
    Rear(f64),
    /// Both, kg.
    Both(f64, f64),
}

/// What is solved for.
#[derive(Debug, Clone, PartialEq)]
pub struct SolveSettings {
    /// Models, in the order of the result.
    pub models: Vec<ModelKind>,
    /// Methods allowed.
    pub methods: Vec<Method>,
    /// Masses of the double model.
    pub split: MassSplit,
    /// Start of the fit window, s after time zero.
    pub fit_from_s: f64,
    /// End of the fit window; `None`: dynamic crush, or the record's end without one.
    pub fit_to_s: Option<f64>,
    /// Most samples fitted.
    pub fit_samples: usize,
    /// Starts of the fit.
    pub fit_starts: usize,
    /// The firefly search.
    pub firefly: FireflyOptions,
}

impl SolveSettings {
    /// Whether a model asked for is fitted to a signal; closed forms need the events only.
    pub fn fits_a_signal(&self) -> bool {
        self.uses(Method::DirectFit) || self.uses(Method::Firefly)
    }

    /// Whether this method is asked for and solves a model asked for.
    pub fn uses(&self, method: Method) -> bool {
        self.methods.contains(&method) && self.models.iter().any(|model| method.solves(*model))
    }

    /// Whether anything asked for needs the crash events; coefficient matching does not.
    pub fn needs_events(&self) -> bool {
        let solves = |method: &&Method| self.models.iter().any(|model| method.solves(*model));
        let mut used = self.methods.iter().filter(solves).peekable();
        used.peek().is_none() || used.any(|method| !matches!(method, Method::CoefficientMatching | Method::CurveFit))
    }
}

/// Finds every candidate that the settings ask for and the test allows; the notes say what is missing and why.
///
/// Errors: only what makes every model senseless or an option impossible: a mass, speed, mass split or window without meaning.
pub fn solve(
    evidence: &Evidence<'_>,
    settings: &SolveSettings,
    notes: &mut Notes,
) -> Result<Vec<Candidate>, SolveError> {
    crate::error::positive("mass_kg", evidence.mass_kg)?;
    crate::error::positive("impact_speed_m_per_s", evidence.impact_speed_m_per_s)?;
    let mut candidates = Vec::new();
    for &model in &settings.models {
        if !settings.methods.iter().any(|method| method.solves(model)) {
            notes.warning(format!("{model}: none of the methods asked for solves this model"));
        }
        for &method in settings.methods.iter().filter(|method| method.solves(model)) {
            match (model, method) {
                // From an identified model, see `match_identified`.
                (_, Method::CoefficientMatching | Method::CurveFit) => {}
                (ModelKind::Kelvin, _) => candidates.extend(kelvin(evidence, method, notes)),
                (ModelKind::Elastoplastic, _) => candidates.extend(elastoplastic(evidence, method, notes)),
                (ModelKind::DoubleSpringMassDamper, _) => {
                    candidates.extend(double(evidence, settings, method, notes)?);
                }
                (other, _) => candidates.extend(single_fit(other, evidence, settings, method, notes)?),
            }
        }
    }
    // Extreme events lead beyond the range of numbers; such a set is no result.
    candidates.retain(|candidate| {
        let finite = candidate.model.parameters().values().all(|value| value.is_finite());
        if !finite {
            notes.warning(format!("{}: left out, a parameter is beyond the range of numbers", candidate.id()));
        }
        finite
    });
    Ok(candidates)
}

fn closed_form(model: Model, method: Method, notes: Vec<String>) -> Candidate {
    Candidate { model, method, index: 1, equivalent_to: None, fit: None, uncertainty: None, notes }
}

/// One mass fitted to the displacement: Maxwell and the nonlinear models.
fn single_fit(
    kind: ModelKind,
    evidence: &Evidence<'_>,
    settings: &SolveSettings,
    method: Method,
    notes: &mut Notes,
) -> Result<Option<Candidate>, SolveError> {
    let Some((t_m, crush)) = crush_of(evidence, kind, notes) else { return Ok(None) };
    let Some(displacement) = evidence.displacement else {
        notes.warning(format!("{kind}: not fitted, there is no displacement"));
        return Ok(None);
    };
    let options = NonlinearFitOptions {
        mass_kg: evidence.mass_kg,
        impact_speed_m_per_s: evidence.impact_speed_m_per_s,
        crush_m: crush,
        time_of_dynamic_crush_s: t_m,
        time_zero_s: evidence.time_zero_s,
        from_s: settings.fit_from_s,
        to_s: settings.fit_to_s.or(Some(t_m)),
        samples: settings.fit_samples,
    };
    let mut remarks = Vec::new();
    let found = match (kind, method) {
        (ModelKind::Maxwell, _) => fit_maxwell(displacement, &options).map(|(m, fit, u)| (Model::Maxwell(m), fit, u)),
        (ModelKind::Nonlinear1, _) => {
            remarks.push("constrained to the dynamic crush and its time; k1 <= k2, c1 >= c2 >= c3".to_owned());
            fit_nonlinear1(displacement, &options, true).map(|(m, fit)| (Model::Nonlinear1(m), fit, None))
        }
        (ModelKind::Nonlinear2, Method::Firefly) => {
            firefly_nonlinear2(displacement, &options, &settings.firefly).map(|found| {
                remarks.push(if found.attraction > 0.0 {
                    format!("mean attraction of two fireflies at the start {:.3}", found.attraction)
                } else {
                    "the attraction of two fireflies is zero in these units: a random walk".to_owned()
                });
                (Model::Nonlinear2(found.model), found.fit, None)
            })
        }
        (ModelKind::Nonlinear2, _) => {
            fit_nonlinear2(displacement, &options).map(|(m, fit, u)| (Model::Nonlinear2(m), fit, u))
        }
        _ => {
            notes.warning(format!("{kind}: no solver for this model"));
            return Ok(None);
        }
    };
    let (model, fit, uncertainty) = match found {
        Ok(found) => found,
        Err(error @ SolveError::NoFit { .. }) => {
            notes.warning(format!("{kind}: {error}"));
            return Ok(None);
        }
        Err(error) => return Err(error),
    };
    remarks.insert(0, format!("fitted from {:.2} ms to {:.2} ms after time zero", 1e3 * fit.from_s, 1e3 * fit.to_s));
    if let Model::Maxwell(maxwell) = &model
        && let Some(finding) = undetermined_by_the_record(maxwell, evidence.impact_speed_m_per_s, crush)
    {
        notes.warning(format!("{kind}: {finding}"));
        remarks.push(finding);
    }
    if !fit.active_bounds.is_empty() {
        remarks.push(format!("on a bound, not determined by the record: {}", fit.active_bounds.join(", ")));
    }
    Ok(Some(Candidate { model, method, index: 1, equivalent_to: None, fit: Some(fit), uncertainty, notes: remarks }))
}

fn crush_of(evidence: &Evidence<'_>, model: ModelKind, notes: &mut Notes) -> Option<(f64, f64)> {
    let events = evidence.time_of_dynamic_crush_s.zip(evidence.dynamic_crush_m);
    if events.is_none() {
        notes.warning(format!(
            "{model}: not solved, since the velocity of the record never reaches zero: it has no dynamic crush"
        ));
    }
    events
}

fn kelvin(evidence: &Evidence<'_>, method: Method, notes: &mut Notes) -> Option<Candidate> {
    let (t_m, crush) = crush_of(evidence, ModelKind::Kelvin, notes)?;
    let solution = match kelvin_from_events(evidence.mass_kg, evidence.impact_speed_m_per_s, t_m, crush) {
        Ok(solution) => solution,
        Err(error) => {
            notes.warning(format!("kelvin: not solved, {error}"));
            return None;
        }
    };
    let ratio = solution.time_ratio;
    let remark = match solution.branch {
        KelvinBranch::Underdamped => {
            format!("t_c/t_m = {ratio:.4}: damping ratio {:.4}", solution.damping_ratio)
        }
        KelvinBranch::Overdamped => format!(
            "t_c/t_m = {ratio:.4} is not above 1/e = 0.3679: overdamped, damping ratio {:.3}",
            solution.damping_ratio
        ),
        KelvinBranch::UndampedReduction { model_time_of_dynamic_crush_s } => {
            let text = format!(
                "t_c/t_m = {ratio:.4} is not below 2/pi = 0.6366: no Kelvin damping ratio exists; reduced to the undamped \
                 model, which keeps crush and speed and stops at {:.2} ms instead of {:.2} ms",
                1e3 * model_time_of_dynamic_crush_s,
                1e3 * t_m
            );
            notes.warning(format!("kelvin: {text}"));
            text
        }
    };
    Some(closed_form(Model::Kelvin(solution.model), method, vec![remark]))
}

fn elastoplastic(evidence: &Evidence<'_>, method: Method, notes: &mut Notes) -> Option<Candidate> {
    let (t_m, crush) = crush_of(evidence, ModelKind::Elastoplastic, notes)?;
    let restitution = match evidence.coefficient_of_restitution {
        Some(e) if e > 0.0 => e,
        Some(_) => {
            notes.warning(
                "elastoplastic: not solved, the record shows no rebound: the unloading stiffness would be infinite",
            );
            return None;
        }
        None => {
            notes.warning("elastoplastic: not solved, the coefficient of restitution is not known");
            return None;
        }
    };
    match elastoplastic_from_events(evidence.mass_kg, evidence.impact_speed_m_per_s, crush, restitution) {
        Ok(model) => {
            let model_t_m = std::f64::consts::FRAC_PI_2 * crush / evidence.impact_speed_m_per_s;
            let remark = format!(
                "keeps crush, speed and restitution {restitution:.4}; stops at {:.2} ms, the record at {:.2} ms",
                1e3 * model_t_m,
                1e3 * t_m
            );
            Some(closed_form(Model::Elastoplastic(model), method, vec![remark]))
        }
        Err(error) => {
            notes.warning(format!("elastoplastic: not solved, {error}"));
            None
        }
    }
}

/// Chassis and compartment masses, with the sentence that says where they come from.
pub fn masses(mass_kg: f64, split: MassSplit) -> Result<(f64, f64, String), SolveError> {
    let value = |name, value, expected| SolveError::Value { name, value, expected };
    let below = "positive and below the test mass";
    let (m1, m2, source) = match split {
        MassSplit::FrontFraction(f) if f > 0.0 && f < 1.0 => (
            f * mass_kg,
            (1.0 - f) * mass_kg,
            format!(
                "front mass fraction {f} assumed: one accelerometer does not tell it, and the parameters depend on it"
            ),
        ),
        MassSplit::FrontFraction(f) => return Err(value("front_mass_fraction", f, "between 0 and 1")),
        MassSplit::Front(m1) if m1 > 0.0 && m1 < mass_kg => (m1, mass_kg - m1, "m1 given, m2 is the rest".to_owned()),
        MassSplit::Front(m1) => return Err(value("m1_kg", m1, below)),
        MassSplit::Rear(m2) if m2 > 0.0 && m2 < mass_kg => (mass_kg - m2, m2, "m2 given, m1 is the rest".to_owned()),
        MassSplit::Rear(m2) => return Err(value("m2_kg", m2, below)),
        MassSplit::Both(m1, m2) => {
            crate::error::positive("m1_kg", m1)?;
            crate::error::positive("m2_kg", m2)?;
            (m1, m2, "both masses given".to_owned())
        }
    };
    let total = if (m1 + m2 - mass_kg).abs() > 5e-3 * mass_kg {
        format!("; their sum {:.1} kg is not the test mass {mass_kg:.1} kg", m1 + m2)
    } else {
        String::new()
    };
    Ok((m1, m2, format!("m1 = {m1:.2} kg, m2 = {m2:.2} kg: {source}{total}")))
}

fn double(
    evidence: &Evidence<'_>,
    settings: &SolveSettings,
    method: Method,
    notes: &mut Notes,
) -> Result<Vec<Candidate>, SolveError> {
    let kind = ModelKind::DoubleSpringMassDamper;
    let (m1_kg, m2_kg, split) = masses(evidence.mass_kg, settings.split)?;
    notes.info(format!("{kind}: {split}"));
    let Some(displacement) = evidence.displacement else {
        notes.warning(format!("{kind}: not fitted, there is no displacement"));
        return Ok(Vec::new());
    };
    let to_s = settings.fit_to_s.or(evidence.time_of_dynamic_crush_s);
    if to_s.is_none() {
        notes.warning(format!("{kind}: fitted up to the end of the record, since there is no dynamic crush"));
    }
    let options = DoubleFitOptions {
        m1_kg,
        m2_kg,
        impact_speed_m_per_s: evidence.impact_speed_m_per_s,
        time_zero_s: evidence.time_zero_s,
        from_s: settings.fit_from_s,
        to_s,
        samples: settings.fit_samples,
        starts: settings.fit_starts,
        resolution_m: DISPLACEMENT_RESOLUTION_M,
    };
    let found = match fit_double(displacement, &options) {
        Ok(found) => found,
        Err(error @ SolveError::NoFit { .. }) => {
            notes.warning(format!("{kind}: {error}"));
            return Ok(Vec::new());
        }
        Err(error) => return Err(error),
    };
    let window = &found[0].fit;
    let window = format!("fitted from {:.2} ms to {:.2} ms after time zero", 1e3 * window.from_s, 1e3 * window.to_s);
    notes.info(format!(
        "{kind}: {window}; one compartment accelerometer cannot tell its two dual solutions apart, a second one on the front can"
    ));
    if found.len() > 1 {
        notes.warning(format!(
            "{kind}: {} pairs of parameter sets fit equally well within the accuracy of the displacement; the record does \
             not determine the parameters",
            found.len()
        ));
    }
    let mut candidates = Vec::new();
    for (place, pair) in found.iter().enumerate() {
        if !pair.fit.active_bounds.is_empty() {
            notes.warning(format!(
                "{kind}: {} of solution {} stopped on a bound, the record does not determine its value",
                pair.fit.active_bounds.join(", "),
                2 * place + 1
            ));
        }
        let own = coincides_with_its_dual(&pair.models);
        for dual in 0..if own { 1 } else { 2 } {
            let mut remarks = vec![split.clone(), window.clone()];
            if own {
                remarks.push(
                    "its own dual, listed once, counts twice: front and rear can move against each other without a change of \
                     the record in first order, so there are no standard deviations"
                        .to_owned(),
                );
            }
            if let Some(u) = pair.uncertainty[dual].as_ref().filter(|_| !own) {
                remarks.push(format!(
                    "standard deviations: linearised, widened for a residual autocorrelation of {:.4}; they hold for the \
                     given masses and if the model is true, and say nothing of other solutions",
                    u.residual_autocorrelation
                ));
            }
            let mut fit = pair.fit.clone();
            if dual == 1 {
                fit.active_bounds = exchanged(&fit.active_bounds);
            }
            candidates.push(Candidate {
                model: Model::DoubleSpringMassDamper(pair.models[dual]),
                method,
                index: 2 * place + dual + 1,
                equivalent_to: (!own).then_some(2 * place + 2 - dual),
                fit: Some(fit),
                uncertainty: pair.uncertainty[dual].clone().filter(|_| !own),
                notes: remarks,
            });
        }
    }
    Ok(candidates)
}

/// Whether the two models of a pair are one to 1e-4: the error is flat to fourth order there, so a fit to 1e-16 leaves that.
fn coincides_with_its_dual([a, b]: &[crumple_lumped::DoubleSpringMassDamper; 2]) -> bool {
    let near = |x: f64, y: f64| (x - y).abs() <= 1e-4 * x.abs().max(y.abs());
    near(a.k1_n_per_m, b.k1_n_per_m) && near(a.c1_n_s_per_m, b.c1_n_s_per_m)
}

/// The same bounds seen from the dual model, which exchanges front and rear.
fn exchanged(bounds: &[&'static str]) -> Vec<&'static str> {
    use crate::double_fit::NAMES;
    let dual = [NAMES[1], NAMES[0], NAMES[3], NAMES[2]];
    let mut names: Vec<_> =
        NAMES.iter().zip(dual).filter(|(name, _)| bounds.contains(name)).map(|(_, other)| other).collect();
    names.sort_by_key(|name| NAMES.iter().position(|n| n == name));
    names
}
