//! The free numbers of the nonlinear models in the searches of the single-mass paper, and the record of their fits.

use crumple_lumped::{Model, Parameter, ParameterKind};
use crumple_numerics::estimation::minimise::levenberg_marquardt::Optimum;

use crate::fit::options::SingleMassFitOptions;
use crate::free::coordinates::{Axis, Coordinates, FreeNumber, Map};
use crate::{Fit, Observation};

/// Bounds of the knots, as shares of the last one.
pub(crate) const KNOTS: (f64, f64) = (0.005, 0.995);

/// The coordinates of a model of which the parameters at these indices are free: springs and dampers not negative,
/// knots inside the range of the record.
pub(crate) fn coordinates(template: Model, free: &[(usize, Map)]) -> Coordinates<Model> {
    let parameters = template.kind().parameters();
    let number = |&(index, map): &(usize, Map)| {
        let Parameter { name, kind, .. } = parameters[index];
        let is_knot = matches!(kind, ParameterKind::Length | ParameterKind::Rate);
        let (lower, upper) = if is_knot { KNOTS } else { (0.0, 1e3) };
        FreeNumber {
            name: name.into(),
            kind,
            index,
            map,
            axis: Axis { lower, upper, box_lower: lower, box_upper: upper },
        }
    };
    Coordinates::new(template, free.iter().map(number).collect())
}

/// The record of a fit to the displacement that ended here, with the sum of squares of the record alone, in squared
/// units of the crush. Parameters on a bound stand in the order of the model.
pub(crate) fn record_of_fit(
    coordinates: &Coordinates<Model>,
    observed: &Observation,
    best: &Optimum,
    evaluations: u64,
    options: &SingleMassFitOptions,
) -> Fit {
    let rmse = (best.cost / observed.rows() as f64).sqrt() * options.crush_m;
    let on_bound = coordinates.free.iter().zip(&best.on_bound).filter(|(_, on_bound)| **on_bound);
    let mut indices: Vec<usize> = on_bound.map(|(number, _)| number.index).collect();
    indices.sort_unstable();
    let names = coordinates.template.kind().parameter_names();
    let active_bounds = indices.into_iter().map(|index| names[index]).collect();
    Fit::of_waves(observed, &[rmse], Vec::new(), (best.iterations, evaluations, best.stop), active_bounds)
}
