//! The table of solvers: which model is solved by which method, from what, and whether without being asked.
//!
//! A new solver is one row here and one function; lists, help texts and dispatch follow from the table.

use std::sync::LazyLock;

use crumple_lumped::ModelKind;
use crumple_signal::Notes;

use crate::solvers::crush_curves::assumptions::ONE_MASS_RATE_S_PER_M;
use crate::solvers::crush_curves::one_mass;
use crate::solvers::settings::FRONT_MASS_FRACTION;
use crate::solvers::task::{Needs, Task};
use crate::solvers::{closed_forms, sensors, single_mass};
use crate::{Candidate, FireflyOptions, FitQuantity, MassFit, MassSplit, Method, SolveError, SolveSettings};
use crumple_numerics::estimation::minimise::l_shade::LShadeOptions;

/// The function of a row: candidates and notes from a task.
type Solve = fn(&Task<'_>, &mut Notes) -> Result<Vec<Candidate>, SolveError>;

/// A row of the table: one way to solve for one model.
#[derive(Debug, Clone, Copy)]
pub struct Solver {
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
        solver(K::ForceDeflection, Method::DirectFit, Motion, true, one_mass::fit),
    ]
};

/// Models that are not solved for without being asked: the first nonlinear model, which the second one covers, and
/// the triple model, which one sensor does not determine.
const NOT_BY_DEFAULT: &[ModelKind] = &[ModelKind::Nonlinear1, ModelKind::TripleSpringMassDamper];

/// Models this crate can solve for, in the order of the result.
pub static MODELS: LazyLock<Vec<ModelKind>> = LazyLock::new(|| {
    let mut models: Vec<_> = SOLVERS.iter().map(|solver| solver.model).collect();
    models.dedup();
    models
});

/// Those solved for where none is asked for.
pub static DEFAULT_MODELS: LazyLock<Vec<ModelKind>> =
    LazyLock::new(|| MODELS.iter().copied().filter(|model| !NOT_BY_DEFAULT.contains(model)).collect());

impl Default for SolveSettings {
    /// The default models by their default methods, a quarter of the mass in front, up to dynamic crush.
    fn default() -> Self {
        Self {
            models: DEFAULT_MODELS.clone(),
            methods: Vec::new(),
            split: MassSplit::FrontFraction(FRONT_MASS_FRACTION),
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

    /// Models it solves for.
    pub fn models(self) -> impl Iterator<Item = ModelKind> {
        SOLVERS.iter().filter(move |solver| solver.method == self).map(|solver| solver.model)
    }
}

/// The solvers of a model among these methods, in their order; without any method those that need no asking.
pub fn solvers_of(model: ModelKind, methods: &[Method]) -> Vec<&'static Solver> {
    let of_model = || SOLVERS.iter().filter(move |solver| solver.model == model);
    if methods.is_empty() {
        of_model().filter(|solver| solver.by_default).collect()
    } else {
        methods.iter().filter_map(|method| of_model().find(|solver| solver.method == *method)).collect()
    }
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
