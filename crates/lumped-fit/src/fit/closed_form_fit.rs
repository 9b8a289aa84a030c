//! A single mass whose displacement is a closed form, fitted to a record: residuals, and the best of several
//! descents.

use crate::candidate::linearised::uncertainty;
use crate::candidate::parameter_set::Fit;
use crate::fit::descents::all;
use crate::record::window::Window;
use crate::{SolveError, Uncertainty};
use crumple_estimation::minimise::levenberg_marquardt::{Bounds, Optimum, Response};

/// Displacement of a model minus the record over the window, in units of the crush: `r_k = (x(t_k) - s_k)/C`.
///
/// Without derivatives of its own: descents use differences, which cost one evaluation for each of one or two
/// parameters.
pub(crate) struct ClosedForm<'a, F> {
    /// The record, m.
    pub window: &'a Window,
    /// Unit of the residuals, m.
    pub crush_m: f64,
    /// For a point of the search the displacement at an instant, m, s after contact.
    pub displacement: F,
}

impl<F: Fn(&[f64]) -> G + Sync, G: Fn(f64) -> f64> Response for ClosedForm<'_, F> {
    /// One residual for each sample of the window.
    fn rows(&self) -> usize {
        self.window.samples.len()
    }

    /// `(x(t_k) - s_k)/C`; `false` where one is not finite.
    fn residuals(&self, theta: &[f64], out: &mut [f64]) -> bool {
        let displacement = (self.displacement)(theta);
        for (k, (r, s)) in out.iter_mut().zip(&self.window.samples).enumerate() {
            let t = self.window.first_s + k as f64 * self.window.dt_s;
            *r = (displacement(t) - s) / self.crush_m;
        }
        out.iter().all(|x| x.is_finite())
    }
}

/// Descends from every start and takes the best end: its coordinates, the record of the fit, and the standard
/// deviations of `names`.
///
/// Coordinates are logarithms; `values` gives the parameters at a point, which are also their derivatives by the
/// logarithms. Errors: no start with a finite response.
pub(crate) fn fit_logarithms<F: Fn(&[f64]) -> G + Sync, G: Fn(f64) -> f64>(
    problem: &ClosedForm<'_, F>,
    starts: Vec<Vec<f64>>,
    bounds: &Bounds,
    names: &[&'static str],
    values: impl Fn(&[f64]) -> Vec<f64>,
) -> Result<(Optimum, Fit, Option<Uncertainty>), SolveError> {
    let tried = starts.len();
    let (mut ends, evaluations) = all(problem, starts, bounds);
    if ends.is_empty() {
        return Err(SolveError::NoFit { starts: tried });
    }
    let best = ends.remove(0);
    let mut residuals = vec![0.0; problem.rows()];
    let finite = problem.residuals(&best.theta, &mut residuals);
    let deviations = finite.then(|| uncertainty(&best, &residuals, names, &values(&best.theta))).flatten();
    let fit = Fit::of_displacement(&best, problem.window, evaluations, names, problem.crush_m);
    Ok((best, fit, deviations))
}
