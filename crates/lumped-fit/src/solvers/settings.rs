//! Settings of the solvers: which models by which methods, how masses divide, which window.

use crumple_lumped::ModelKind;

use crumple_numerics::estimation::minimise::l_shade::LShadeOptions;

use crate::{FireflyOptions, FitQuantity, MassFit, MassSplit, Method};

/// Engine and front structure of a passenger car are about a quarter of it: an assumption, which a note states.
pub const FRONT_MASS_FRACTION: f64 = 0.25;

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
