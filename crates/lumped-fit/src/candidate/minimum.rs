//! The minimum of a misfit as measured: what a candidate is made from and assessed by.

use crumple_lumped::Model;
use crumple_numerics::estimation::minimise::StopReason;
use nalgebra::DMatrix;

use crate::free::coordinates::Coordinates;
use crate::free::free_parameter::FreeParameter;
use crate::record::observation::Observation;

/// A model at the minimum of its misfit, with the sensitivities there. Metres stand for the unit of the first wave.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// The model.
    pub model: Model,
    /// Its free parameters; the values are those of the minimum.
    pub free: Vec<FreeParameter>,
    /// Which of them stopped on a bound.
    pub on_bound: Vec<bool>,
    /// The waves it was fitted to, with their weights.
    pub observed: Observation,
    /// Model minus record, m.
    pub misfit_m: Vec<f64>,
    /// Change of the displacement by each free parameter's coordinate, m; columns as `free`.
    pub sensitivity_m: DMatrix<f64>,
    /// Model evaluations spent.
    pub evaluations: u64,
    /// Iterations.
    pub iterations: u32,
    /// Why it stopped.
    pub stop_reason: StopReason,
}

impl Minimum {
    /// Root mean square misfit, m.
    pub fn rmse_m(&self) -> f64 {
        (self.misfit_m.iter().map(|r| r * r).sum::<f64>() / self.misfit_m.len() as f64).sqrt()
    }

    /// The fit repeated with other waves or values, from these coordinates and without leaving the minimum.
    pub(crate) fn coordinates(&self) -> Coordinates<Model> {
        Coordinates::near(self.model, &self.free)
    }
}
