use crumple_lumped::ModelKind;

use crate::solvers::table::solvers_of;
use crate::{DEFAULT_MODELS, FireflyOptions, FitQuantity, LShadeOptions, MassFit, MassSplit, Method, Needs};

/// What is solved for.
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
    /// The general global search.
    pub l_shade: LShadeOptions,
}

impl Default for SolveSettings {
    /// The default models by their default methods, a quarter of the mass in front, up to dynamic crush.
    fn default() -> Self {
        Self {
            models: DEFAULT_MODELS.clone(),
            methods: Vec::new(),
            split: MassSplit::FrontFraction(0.25),
            triple: None,
            mass_fit: MassFit::Known,
            quantity: FitQuantity::Displacement,
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
