//! What a fit to sensors asks of a model whose numbers are free.

use crumple_lumped::{Instants, LumpedError, Sensitivity};

/// One free number: bounds of the descent, and the box that searches start in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Axis {
    pub lower: f64,
    pub upper: f64,
    pub box_lower: f64,
    pub box_upper: f64,
}

/// A model with free numbers of size one, `theta`.
pub(crate) trait Parameterisation: Sync {
    /// The model at a point.
    type Model: Send;

    fn axes(&self) -> Vec<Axis>;

    /// `None` where it has no meaning.
    fn model(&self, theta: &[f64]) -> Option<Self::Model>;

    /// The motion of every mass, and its derivatives by the parameters at these places.
    fn sensitivity(
        &self,
        model: &Self::Model,
        impact_speed_m_per_s: f64,
        at: &Instants,
        places: &[usize],
    ) -> Result<Sensitivity, LumpedError>;

    /// Places of the parameters that change with each number, and their derivatives by it; `None` where the model has
    /// no derivatives of its own and differences must do.
    fn derivatives_by_coordinate(&self, theta: &[f64]) -> Option<Vec<Vec<(usize, f64)>>>;
}

/// The places that any number changes, each once, rising.
pub(crate) fn places(derivatives: &[Vec<(usize, f64)>]) -> Vec<usize> {
    let mut places: Vec<usize> = derivatives.iter().flatten().map(|(place, _)| *place).collect();
    places.sort_unstable();
    places.dedup();
    places
}
