//! The table of solvers: which model is solved by which method, from what, and whether without being asked; the task of
//! one of them, the settings of all, and the call that runs those that are asked for.
//!
//! A new solver is one row here and one function; lists, help texts and dispatch follow from the table.

use std::sync::LazyLock;

use crumple_lumped::{ModelKind, ParameterKind};
use crumple_numerics::estimation::minimise::l_shade::LShadeOptions;
use crumple_numerics::estimation::work::determined;
use crumple_signal::{About, Notes, Sampled, Weight, remarks};
use rayon::prelude::*;

use crate::candidate::{Candidate, Method, Minimum};
use crate::coordinates::MassFit;
use crate::error::SolveError;
use crate::papers::FireflyOptions;
use crate::parameters::MassSplit;
use crate::record::sensor::{FitQuantity, Sensor, TestData};
use crate::solvers::closed_forms::ONE_MASS_RATE_S_PER_M;
use crate::solvers::fitting::NothingToFit;
use crate::solvers::{closed_forms, sensors, single_mass};

/// Models, methods, masses and window that are solved for. Defaults follow from the table of solvers.
#[derive(Debug, Clone, PartialEq)]
pub struct SolveSettings {
    /// Models, in the order of the result.
    pub models: Vec<ModelKind>,
    /// Methods allowed; none: those that each model is solved by without being asked.
    pub methods: Vec<Method>,
    /// Masses of the double model.
    pub split: MassSplit,
    /// Masses of the triple model, kg; `None`: the front of the double model halved.
    pub triple: Option<[f64; 3]>,
    /// Whether masses are known or fitted with a known total.
    pub mass_fit: MassFit,
    /// What of the motion is fitted.
    pub quantity: FitQuantity,
    /// Whether a fitted elastoplastic model leaves the barrier.
    pub release: bool,
    /// Rate factor of a force-deflection curve of one mass, s/m: a prior, which no single test tells.
    pub rate_factor_s_per_m: f64,
    /// Start of the fit window, s after time zero.
    pub fit_from_s: f64,
    /// End of the fit window; `None`: dynamic crush, or the record's end without one.
    pub fit_to_s: Option<f64>,
    /// Most samples fitted: 250 are enough for four parameters.
    pub fit_samples: usize,
    /// Starts of a fit of four free numbers; others have theirs in proportion.
    pub fit_starts: usize,
    /// The firefly search.
    pub firefly: FireflyOptions,
    /// The general global search.
    pub l_shade: LShadeOptions,
}

/// What a solver works on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Needs {
    /// The crash events.
    Events,
    /// The motion of the test, and its events where it has them.
    Motion,
    /// An identified model; see [`Identified::matched`](crate::Identified::matched).
    IdentifiedModel,
}

/// Everything that a solver is given.
pub(crate) struct Task<'a> {
    /// The model of the row.
    pub model: ModelKind,
    /// The method of the row.
    pub method: Method,
    /// The test.
    pub test: &'a TestData<'a>,
    /// What was asked for: windows, masses, sizes of searches.
    pub settings: &'a SolveSettings,
}

impl Task<'_> {
    /// Whether the displacement of the pulse alone is fitted with given masses, so that the special fits of a model
    /// apply.
    ///
    /// A sensor on a mass that the model does not have changes nothing, nor does naming the pulse itself as a sensor.
    pub(crate) fn fits_displacement_alone(&self) -> bool {
        let count = mass_count(self.model);
        let is_pulse = |sensor: &Sensor<'_>| {
            let pulse: Option<&Sampled> = self.test.displacement.map(|displacement| &**displacement);
            sensor.quantity == FitQuantity::Displacement && pulse == Some(sensor.record)
        };
        self.settings.quantity == FitQuantity::Displacement
            && self.settings.mass_fit == MassFit::Known
            && self
                .test
                .sensors
                .iter()
                .all(|sensor| sensor.place.mass(count).is_none_or(|mass| mass + 1 == count && is_pulse(sensor)))
    }
}

/// How many masses a model has.
pub(crate) fn mass_count(kind: ModelKind) -> usize {
    kind.parameters().iter().filter(|parameter| parameter.kind == ParameterKind::Mass).count()
}

/// What a remark on a model concerns: the model whose row of the table was run. Load paths are found beside the curve
/// of one mass.
pub(super) fn row_of(model: &str) -> About {
    let row = if model == ModelKind::LoadPaths.name() { ModelKind::ForceDeflection.name() } else { model };
    About::Model(row.to_owned())
}

/// Depth and time by which a fit to the displacement of one mass is scaled.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent {
    /// Dynamic crush, m; without one the largest displacement of the window.
    pub crush_m: f64,
    /// Its time, s after time zero; without one the end of the window.
    pub time_s: f64,
    /// Whether the mass stops there.
    pub stops: bool,
}

/// Dynamic crush and its time.
///
/// Where the velocity never reaches zero: the end of the window (that of the settings, or of the record) and the
/// largest displacement up to there, with a warning. `None`, with a warning, without a displacement or where it is
/// nowhere positive.
pub(super) fn extent_of(task: &Task<'_>, notes: &mut Notes) -> Option<Extent> {
    let (kind, test) = (task.model, task.test);
    if let Some((time_s, crush_m)) = test.time_of_dynamic_crush_s.zip(test.dynamic_crush_m) {
        return Some(Extent { crush_m, time_s, stops: true });
    }
    let Some(displacement) = test.displacement else {
        notes.push(NothingToFit::displacement(kind));
        return None;
    };
    let end_s = displacement.end_s();
    let time_s = task.settings.fit_to_s.unwrap_or(end_s);
    let first = displacement.index_at_or_after(0.0);
    let after = displacement.index_at_or_after(time_s + 0.5 * displacement.dt_s());
    let window = displacement.samples().get(first..after.min(displacement.len())).unwrap_or_default();
    let crush_m = window.iter().copied().fold(0.0, f64::max);
    if crush_m <= 0.0 || time_s <= 0.0 {
        notes.push(NowherePositive { model: kind.to_string() });
        return None;
    }
    notes.push(NeverStops { model: kind.to_string(), to_s: Some(time_s), largest_m: Some(crush_m) });
    Some(Extent { crush_m, time_s, stops: false })
}

/// Time, s after time zero, and depth, m, of dynamic crush; `None`, with a warning, where the record has none.
pub(super) fn crush_of(task: &Task<'_>, notes: &mut Notes) -> Option<(f64, f64)> {
    let events = task.test.time_of_dynamic_crush_s.zip(task.test.dynamic_crush_m);
    if events.is_none() {
        notes.push(NoDynamicCrush { model: task.model.to_string(), method: task.method.to_string() });
    }
    events
}

/// The function of a row: candidates and notes from a task.
type Solve = fn(&Task<'_>, &mut Notes) -> Result<Vec<Candidate>, SolveError>;

/// A row of the table: one way to solve for one model.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Solver {
    /// The model.
    pub model: ModelKind,
    /// The method.
    pub method: Method,
    /// What it works on.
    pub needs: Needs,
    /// Whether it is used where no method is asked for.
    pub by_default: bool,
    /// What it does; those on identified models are run by the stage, which has them.
    pub(crate) solve: Option<Solve>,
}

/// A row with a function.
const fn solver(model: ModelKind, method: Method, needs: Needs, by_default: bool, solve: Solve) -> Solver {
    Solver { model, method, needs, by_default, solve: Some(solve) }
}

/// Every solver, models in the order of lists and results. Columns: model, method, what it needs, whether it is used
/// without being asked, function.
pub(crate) const SOLVERS: &[Solver] = {
    use ModelKind as K;
    use Needs::{Events, IdentifiedModel, Motion};
    const DOUBLE: ModelKind = K::DoubleSpringMassDamper;
    &[
        solver(K::Kelvin, Method::ClosedForm, Events, true, closed_forms::kelvin),
        solver(K::Kelvin, Method::DirectFit, Motion, true, sensors::fit),
        solver(K::Kelvin, Method::LShade, Motion, false, sensors::fit),
        solver(K::Elastoplastic, Method::ClosedForm, Events, true, closed_forms::elastoplastic),
        solver(K::Elastoplastic, Method::DirectFit, Motion, false, sensors::fit),
        solver(K::Elastoplastic, Method::LShade, Motion, false, sensors::fit),
        solver(K::Maxwell, Method::DirectFit, Motion, true, single_mass::maxwell),
        solver(K::Maxwell, Method::LShade, Motion, false, sensors::fit),
        Solver {
            model: K::Maxwell,
            method: Method::ClosedForm,
            needs: IdentifiedModel,
            by_default: false,
            solve: None,
        },
        solver(K::Nonlinear1, Method::DirectFit, Motion, true, single_mass::nonlinear1),
        solver(K::Nonlinear1, Method::InteriorPoint, Motion, false, single_mass::interior_point),
        solver(K::Nonlinear1, Method::LShade, Motion, false, sensors::fit),
        solver(K::Nonlinear2, Method::DirectFit, Motion, true, single_mass::nonlinear2),
        solver(K::Nonlinear2, Method::Firefly, Motion, false, single_mass::firefly),
        solver(K::Nonlinear2, Method::LShade, Motion, false, sensors::fit),
        solver(DOUBLE, Method::DirectFit, Motion, true, sensors::fit),
        solver(DOUBLE, Method::LShade, Motion, false, sensors::fit),
        Solver {
            model: DOUBLE,
            method: Method::CoefficientMatching,
            needs: IdentifiedModel,
            by_default: false,
            solve: None,
        },
        Solver { model: DOUBLE, method: Method::CurveFit, needs: IdentifiedModel, by_default: false, solve: None },
        solver(K::TripleSpringMassDamper, Method::DirectFit, Motion, true, sensors::fit),
        solver(K::TripleSpringMassDamper, Method::LShade, Motion, false, sensors::fit),
        solver(K::ForceDeflection, Method::DirectFit, Motion, true, closed_forms::fit),
    ]
};

/// Models that are not solved for without being asked: the first nonlinear model, which the second one covers, and
/// the triple model, which one sensor does not determine.
const NOT_BY_DEFAULT: &[ModelKind] = &[ModelKind::Nonlinear1, ModelKind::TripleSpringMassDamper];

/// See [`SolveSettings::all_models`].
static MODELS: LazyLock<Vec<ModelKind>> = LazyLock::new(|| {
    let mut models: Vec<_> = SOLVERS.iter().map(|solver| solver.model).collect();
    models.dedup();
    models
});

/// See [`SolveSettings::default_models`].
static DEFAULT_MODELS: LazyLock<Vec<ModelKind>> =
    LazyLock::new(|| MODELS.iter().copied().filter(|model| !NOT_BY_DEFAULT.contains(model)).collect());

impl Default for SolveSettings {
    /// The default models by their default methods, a quarter of the mass in front, up to dynamic crush.
    fn default() -> Self {
        Self {
            models: DEFAULT_MODELS.clone(),
            methods: Vec::new(),
            split: MassSplit::FrontFraction(MassSplit::USUAL_FRONT),
            triple: None,
            mass_fit: MassFit::Known,
            quantity: FitQuantity::Displacement,
            rate_factor_s_per_m: ONE_MASS_RATE_S_PER_M,
            release: true,
            fit_from_s: 0.0,
            fit_to_s: None,
            fit_samples: 250,
            fit_starts: 24,
            firefly: FireflyOptions::default(),
            l_shade: LShadeOptions::default(),
        }
    }
}

impl SolveSettings {
    /// Models this crate can solve for, in the order of the result.
    pub fn all_models() -> &'static [ModelKind] {
        &MODELS
    }

    /// Those solved for where none is asked for.
    pub fn default_models() -> &'static [ModelKind] {
        &DEFAULT_MODELS
    }

    /// How many times the starts and evaluations of a usual search these are, at least one.
    pub fn searches(&self) -> usize {
        let usual = Self::default();
        let evaluations = self.l_shade.evaluations.div_ceil(usual.l_shade.evaluations.max(1)) as usize;
        evaluations.max(self.fit_starts.div_ceil(usual.fit_starts)).max(1)
    }

    /// Whether a solver that is asked for needs this.
    fn needs(&self, needs: Needs) -> bool {
        self.models.iter().any(|model| solvers_of(*model, &self.methods).iter().any(|solver| solver.needs == needs))
    }

    /// Whether a model asked for is fitted to a signal; closed forms need the events only.
    pub fn fits_a_signal(&self) -> bool {
        self.needs(Needs::Motion)
    }

    /// Whether this method is asked for and solves a model asked for.
    pub fn uses(&self, method: Method) -> bool {
        self.models.iter().any(|model| solvers_of(*model, &self.methods).iter().any(|s| s.method == method))
    }

    /// Whether anything asked for needs the crash events; work on identified models does not.
    pub fn needs_events(&self) -> bool {
        self.needs(Needs::Events) || self.needs(Needs::Motion) || !self.needs(Needs::IdentifiedModel)
    }
}

impl Method {
    /// Whether it is a way to solve for this model.
    pub fn solves(self, model: ModelKind) -> bool {
        SOLVERS.iter().any(|solver| solver.model == model && solver.method == self)
    }

    /// Those that solve for a model without being asked for.
    pub fn default_of(model: ModelKind) -> impl Iterator<Item = Self> {
        solvers_of(model, &[]).into_iter().map(|solver| solver.method)
    }

    /// Models it solves for.
    pub fn models(self) -> impl Iterator<Item = ModelKind> {
        SOLVERS.iter().filter(move |solver| solver.method == self).map(|solver| solver.model)
    }
}

/// The solvers of a model among these methods, in their order; without any method those that need no asking.
fn solvers_of(model: ModelKind, methods: &[Method]) -> Vec<&'static Solver> {
    let of_model = || SOLVERS.iter().filter(move |solver| solver.model == model);
    if methods.is_empty() {
        of_model().filter(|solver| solver.by_default).collect()
    } else {
        methods.iter().filter_map(|method| of_model().find(|solver| solver.method == *method)).collect()
    }
}

/// Solves for every model by every method that the settings ask for and the test allows; the notes say what is
/// missing and why.
///
/// Solvers run in parallel and know nothing of each other; candidates and notes come in the order of the settings,
/// whatever the number of threads. A record too coarse for a fit (that of an event data recorder) still gives the
/// closed forms. A set with a parameter beyond the range of numbers is left out with a warning. So is what takes more
/// work than any record needs, and a solver that panics: it costs its own candidates.
///
/// Errors: a mass, speed, mass split or window without meaning, which no model can be solved with.
pub fn solve(test: &TestData<'_>, settings: &SolveSettings, notes: &mut Notes) -> Result<Vec<Candidate>, SolveError> {
    crate::error::positive("mass_kg", test.mass_kg)?;
    crate::error::positive("impact_speed_m_per_s", test.impact_speed_m_per_s)?;
    // Solvers know nothing of each other; candidates and notes keep the order of the settings for any number of
    // threads.
    let results: Vec<(Result<Vec<Candidate>, SolveError>, Notes)> = settings
        .models
        .par_iter()
        .flat_map_iter(|&model| {
            let solvers = solvers_of(model, &settings.methods);
            let mut none = Notes::new();
            if solvers.is_empty() {
                none.push(NoMethod { model: model.to_string() });
            }
            let solved = solvers.into_iter().filter_map(move |solver| {
                let mut notes = Notes::new();
                let task = Task { model, method: solver.method, test, settings };
                let solve = solver.solve?;
                let mut result = determined(|| solve(&task, &mut notes)).unwrap_or_else(|reason| {
                    notes = Notes::new();
                    let (model, method) = (model.to_string(), solver.method.to_string());
                    notes.push(NotSolved { model, method, reason: reason.to_string() });
                    Ok(Vec::new())
                });
                let minima = result.iter_mut().flatten().filter_map(|candidate| candidate.minimum.as_mut());
                minima.for_each(Minimum::release_work);
                // A record that is too coarse for a fit (an event data recorder's) still has its events for the closed
                // forms.
                if let Err(SolveError::TooFewSamples { samples, from_s, to_s, needed }) = result {
                    let (model, method) = (model.to_string(), solver.method.to_string());
                    notes.push(TooCoarse { model, method, samples, from_s, to_s, needed });
                    result = Ok(Vec::new());
                }
                Some((result, notes))
            });
            std::iter::once((Ok(Vec::new()), none)).chain(solved)
        })
        .collect();
    let mut candidates = Vec::new();
    for (result, remarks) in results {
        notes.extend(remarks);
        candidates.extend(result?);
    }
    // Extreme events lead beyond the range of numbers; such a set is no result.
    candidates.retain(|candidate| {
        let finite = candidate.model.parameters().values().all(|value| value.is_finite());
        if !finite {
            notes.push(BeyondNumbers { id: candidate.id() });
        }
        finite
    });
    Ok(candidates)
}

remarks! {
    /// Remarks of the solvers of all models.
    pub REMARKS;

    /// None of the methods that are asked for solves a model.
    CR529 NoMethod { model: String }
    bears on (About::Model(model.clone()), Weight::Slight)
    decided "The table of docs/methods/parameter-solve.md has the methods of each model; method names none of them."
    means "The model has no candidate. Other models are not touched by it."
    remedy "leave method out, or add one of the methods of the model"
    says format!("{model}: none of the methods asked for solves this model");

    /// A method ended without a result: it reached its limit of work, or its computation failed.
    CR530 NotSolved { model: String, method: String, reason: String }
    bears on (About::Model(model.clone()), Weight::Slight)
    decided "A fit may take the work of 250 million samples, some 2.5 s of one processor; searches with more starts or \
             evaluations may take more in proportion. The fits of an ordinary record take a hundredth of it."
    means "The model has no candidate by this method. Other models are not touched by it."
    remedy "check units of mass, impact speed and pulse, or leave the model out of models"
    says format!("{model} by {method}: {reason}");

    /// The fit window holds too few samples for a fit.
    CR531 TooCoarse { model: String, method: String, samples: usize, from_s: f64, to_s: f64, needed: usize }
    bears on (About::Model(model.clone()), Weight::Slight)
    decided "Samples between the ends of the fit window are counted; the sentence has how many a fit needs. Records of \
             event data recorders have few."
    means "The model has no fitted candidate. Closed forms need the events only, and hold."
    remedy "widen the window (fit_from, fit_to), or use the closed forms"
    says {
        let (samples, from_s, to_s, needed) = (*samples, *from_s, *to_s, *needed);
        let error = SolveError::TooFewSamples { samples, from_s, to_s, needed };
        format!("{model}: not fitted by {method}: {error}")
    };

    /// A set of parameters is left out: one of them is infinite or no number.
    CR532 BeyondNumbers { id: String }
    bears on (About::Model(id.clone()), Weight::Slight)
    decided "Every parameter of a candidate is to be finite. Extreme events lead beyond."
    means "The set is no result. Other candidates are not touched by it."
    remedy "check mass, impact speed and unit of the pulse"
    says format!("{id}: left out, a parameter is beyond the range of numbers");

    /// The vehicle does not move towards the barrier after contact.
    CR533 NowherePositive { model: String }
    bears on (About::Model(model.clone()), Weight::Slight)
    decided "The record has no dynamic crush. The largest displacement between contact and the end of the fit window \
             is not above zero, or the window ends at contact."
    means "There is no crush that a model could be fitted to."
    remedy "check the sign of the pulse, time zero and the end of the window (fit_to)"
    says format!("{model}: not fitted, the displacement is nowhere positive after time zero");

    /// The vehicle does not stop within the record: there is no dynamic crush.
    CR534 NeverStops { model: String, to_s: Option<f64>, largest_m: Option<f64> }
    bears on (About::Model(model.clone()), Weight::Slight)
    decided "The velocity does not reach zero. The largest displacement of the fit window takes the place of the \
             crush; models of several masses are fitted up to the end of the record."
    means "The model follows the record within the window. Its crush and its rebound beyond are extrapolated."
    remedy "use a longer record; else state where the impact ends: fit_to"
    says match to_s.zip(*largest_m) {
        Some((to_s, largest_m)) => format!(
            "{model}: the velocity of the record never reaches zero: fitted up to {:.2} ms, the end of the window, \
             with the largest displacement {:.1} mm in place of the dynamic crush",
            1e3 * to_s,
            1e3 * largest_m
        ),
        None => format!("{model}: fitted up to the end of the record, since there is no dynamic crush"),
    };

    /// A method needs the dynamic crush, and the vehicle does not stop within the record.
    CR535 NoDynamicCrush { model: String, method: String }
    bears on (About::Model(model.clone()), Weight::Slight)
    decided "The method works with depth and time of the dynamic crush. The velocity does not reach zero."
    means "The model has no candidate by this method. Fits to the motion are not touched by it."
    remedy "fit the model to the motion: method = [\"direct-fit\"]"
    says format!(
        "{model}: not solved: the velocity never reaches zero, so there is no dynamic crush for {method}. Use \
         direct-fit"
    );

    /// No start of a fit led to a motion that could be computed.
    CR536 NoFiniteResponse { model: String, starts: usize }
    bears on (About::Model(model.clone()), Weight::Slight)
    decided "The motion of the model is computed from each start; a start counts where all of it is finite."
    means "The model has no candidate by this method. Other models are not touched by it."
    remedy "check units of mass, impact speed and pulse"
    says format!("{model}: {}", SolveError::NoFit { starts: *starts });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_stands_together_and_has_a_default() {
        for model in MODELS.iter() {
            assert_eq!(MODELS.iter().filter(|other| *other == model).count(), 1, "{model}");
            assert!(SOLVERS.iter().any(|s| s.model == *model && s.by_default), "{model}");
        }
        for (k, a) in SOLVERS.iter().enumerate() {
            assert!(SOLVERS[..k].iter().all(|b| (a.model, a.method) != (b.model, b.method)), "{a:?}");
            assert_eq!(a.solve.is_none(), a.needs == Needs::IdentifiedModel, "{a:?}");
        }
    }

    #[test]
    fn methods_keep_the_order_asked_for() {
        let both = [Method::CoefficientMatching, Method::DirectFit, Method::Firefly];
        let methods: Vec<_> = solvers_of(ModelKind::DoubleSpringMassDamper, &both).iter().map(|s| s.method).collect();
        assert_eq!(methods, both[..2]);
        assert_eq!(solvers_of(ModelKind::Kelvin, &[]).len(), 2);
    }
}
