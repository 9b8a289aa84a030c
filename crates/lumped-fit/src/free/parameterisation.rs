//! The trait of a model whose parameters follow from coordinates: what a fit to sensors needs to know of it.
//!
//! Coordinates are of size one: logarithms of springs and dampers, shares of knots and masses. Descents can then use
//! one step size and one tolerance for all of them. Families
//! ([`ModelCoordinates`](crate::free::model_coordinates::ModelCoordinates)) and stated chains implement it.

use crumple_lumped::{Instants, LumpedError, Sensitivity};

use crate::record::observation::Impact;

/// Bounds of one coordinate in a descent, and the range in which searches start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Axis {
    /// Bounds of the descent.
    pub lower: f64,
    pub upper: f64,
    /// Range of the starts, inside the bounds.
    pub box_lower: f64,
    pub box_upper: f64,
}

/// A model that is described by coordinates of size one, `theta`.
pub(crate) trait Parameterisation: Sync {
    /// The model at a point.
    type Model: Send + Sync;

    /// Bounds of each coordinate, in their order.
    fn axes(&self) -> Vec<Axis>;

    /// The model at a point; `None` where its parameters are not physical.
    fn model(&self, theta: &[f64]) -> Option<Self::Model>;

    /// The motion of every mass, and its derivatives by the parameters at these places.
    fn sensitivity(
        &self,
        model: &Self::Model,
        impact_speed_m_per_s: f64,
        at: &Instants,
        places: &[usize],
    ) -> Result<Sensitivity, LumpedError>;

    /// The same in one impact of several tests; a stated total mass is met where the model can take one.
    fn sensitivity_in(
        &self,
        model: &Self::Model,
        impact: Impact,
        at: &Instants,
        places: &[usize],
    ) -> Result<Sensitivity, LumpedError> {
        self.sensitivity(model, impact.speed_m_per_s, at, places)
    }

    /// Numbers of size one that models of one motion share: minima that agree in all of them are one.
    fn place(&self, theta: &[f64]) -> Vec<f64> {
        theta.to_vec()
    }

    /// For each coordinate the places of the parameters that it moves, and their derivatives by it.
    fn derivatives_by_coordinate(&self, theta: &[f64]) -> Vec<Vec<(usize, f64)>>;
}

/// The places that any coordinate moves, each once, in rising order: those whose derivatives of the motion are
/// needed.
pub(crate) fn places(derivatives: &[Vec<(usize, f64)>]) -> Vec<usize> {
    let mut places: Vec<usize> = derivatives.iter().flatten().map(|(place, _)| *place).collect();
    places.sort_unstable();
    places.dedup();
    places
}
