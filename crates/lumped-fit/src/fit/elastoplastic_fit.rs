//! The loading part of the elastoplastic model, fitted to a displacement that never stops.

use crumple_estimation::minimise::levenberg_marquardt::Bounds;
use crumple_lumped::{Elastoplastic, Kelvin};
use crumple_signal::{Displacement, Signal};

use crate::error::positive;
use crate::fit::closed_form_fit::{ClosedForm, fit_logarithms};
use crate::fit::options::SingleMassFitOptions;
use crate::record::window::Window;
use crate::{Fit, SolveError, Uncertainty};

/// Starts of the loading stiffness over `m (v0/C)²`.
const STIFFNESSES: [f64; 5] = [0.1, 0.3, 1.0, 2.0, 4.0];

/// Fits the loading stiffness of the elastoplastic model to a displacement that never stops: `x = v0/w sin(w t)`, `w²
/// = k_E/m`.
///
/// No sample depends on the unloading stiffness. It is set to the loading stiffness, the least that a structure can
/// have, and named among the active bounds. Least squares over `ln k_E` from five starts, within `e^±9` of `m
/// (v0/C)²`; differences instead of derivatives, so that the relative error of `k_E` on an exact record is about
/// 1e-7. The standard deviation is linearised.
///
/// `displacement` in m; the options give mass, kg, speed, m/s, crush, m, and the window. Errors: as the other fits.
pub(crate) fn fit_elastoplastic_loading(
    displacement: &Signal<Displacement>,
    options: &SingleMassFitOptions,
) -> Result<(Elastoplastic, Fit, Option<Uncertainty>), SolveError> {
    let mass_kg = positive("mass_kg", options.mass_kg)?;
    let v0 = positive("impact_speed_m_per_s", options.impact_speed_m_per_s)?;
    let crush_m = positive("crush_m", options.crush_m)?;
    let window = Window::pick(displacement, options.time_zero_s, options.from_s, options.to_s, options.samples)?;
    let rate = v0 / crush_m;
    let stiffness = |theta: &[f64]| mass_kg * rate * rate * theta[0].exp();
    let displacement = |theta: &[f64]| {
        let model = Kelvin { mass_kg, stiffness_n_per_m: stiffness(theta), damping_n_s_per_m: 0.0 };
        move |t| model.state(v0, t).displacement_m
    };
    let problem = ClosedForm { window: &window, crush_m, displacement };
    let bounds = Bounds { lower: vec![-9.0], upper: vec![9.0], max_iterations: 100, cost_tolerance: 1e-12 };
    let starts = STIFFNESSES.iter().map(|start| vec![start.ln()]).collect();
    let names = ["loading_stiffness_n_per_m"];
    let (best, mut fit, deviations) =
        fit_logarithms(&problem, starts, &bounds, &names, |theta| vec![stiffness(theta)])?;
    fit.active_bounds.push("unloading_stiffness_n_per_m");
    let stiffness_n_per_m = stiffness(&best.theta);
    let model = Elastoplastic {
        mass_kg,
        loading_stiffness_n_per_m: stiffness_n_per_m,
        unloading_stiffness_n_per_m: stiffness_n_per_m,
        release: true,
    };
    Ok((model, fit, deviations))
}
