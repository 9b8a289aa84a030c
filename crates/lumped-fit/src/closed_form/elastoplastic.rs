use crumple_lumped::{Elastoplastic, Kelvin};
use crumple_signal::{Displacement, Signal};

use crate::error::positive;
use crate::fit::closed_form_fit::{ClosedForm, fit_logarithms};
use crate::record::window::Window;
use crate::{Fit, NonlinearFitOptions, SolveError, Uncertainty};
use crumple_estimation::minimise::levenberg_marquardt::Bounds;

/// The elastoplastic model with the crush, speed and restitution of the record: `k_E = m v0²/C²`, `k_P = k_E/e²`.
///
/// Energy balance of loading and unloading, single-mass paper, equations 9 to 15; `e` is a ratio of velocities, so
/// the energy returned is `e²`. Keeps `C`, `v0` and the rebound velocity; its time of dynamic crush is `π/2·C/v0`
/// whatever was measured. Relative error: twice that of `C` for `k_E`, and twice that of `e` in addition for `k_P`.
/// Errors: values that are not positive (without rebound `k_P` is infinite), or restitution above 1.
pub fn elastoplastic_from_events(
    mass_kg: f64,
    impact_speed_m_per_s: f64,
    dynamic_crush_m: f64,
    coefficient_of_restitution: f64,
) -> Result<Elastoplastic, SolveError> {
    let m = positive("mass_kg", mass_kg)?;
    let v0 = positive("impact_speed_m_per_s", impact_speed_m_per_s)?;
    let crush = positive("dynamic_crush_m", dynamic_crush_m)?;
    let e = positive("coefficient_of_restitution", coefficient_of_restitution)?;
    if e > 1.0 {
        return Err(SolveError::Value {
            name: "coefficient_of_restitution",
            value: e,
            expected: "at most 1 (more energy came back than went in)",
        });
    }
    let omega = v0 / crush;
    let loading = m * omega * omega;
    Ok(Elastoplastic {
        mass_kg: m,
        loading_stiffness_n_per_m: loading,
        unloading_stiffness_n_per_m: loading / (e * e),
        release: true,
    })
}

/// Coefficient of restitution below which the unloading is rigid to all that a record tells: a zero level 0.1 g off makes as much
/// rebound of nothing within 100 ms at 10 m/s.
pub const RIGID_RESTITUTION: f64 = 0.01;

/// As [`elastoplastic_from_events`], with an unloading stiffness of at most `k_E/0.01²`, and whether it stands there: a smaller
/// restitution, zero or none is no number but a rigid line, and any stiffness above gives the same record.
pub fn elastoplastic_of_record(
    mass_kg: f64,
    impact_speed_m_per_s: f64,
    dynamic_crush_m: f64,
    coefficient_of_restitution: f64,
) -> Result<(Elastoplastic, bool), SolveError> {
    let rigid = coefficient_of_restitution <= RIGID_RESTITUTION;
    let restitution = if rigid { RIGID_RESTITUTION } else { coefficient_of_restitution };
    Ok((elastoplastic_from_events(mass_kg, impact_speed_m_per_s, dynamic_crush_m, restitution)?, rigid))
}

/// Whether the unloading stiffness of a closed form is the one that stands for a rigid line.
pub fn unloads_rigidly(model: &Elastoplastic) -> bool {
    model.coefficient_of_restitution() <= RIGID_RESTITUTION * (1.0 + 1e-9)
}

/// Starts of the loading stiffness over `m (v0/C)²`.
const STIFFNESSES: [f64; 5] = [0.1, 0.3, 1.0, 2.0, 4.0];

/// Fits the loading stiffness of the elastoplastic model to a displacement that never stops: `x = v0/w sin w t`,
/// `w² = k_E/m`.
///
/// Nothing of the record depends on the unloading stiffness: it is set to the loading stiffness, the least that a structure can
/// have, and named among the active bounds. Least squares over the logarithm of `k_E` from five starts, within `e^±9` of
/// `m (v0/C)²`. Errors: as the other fits.
pub fn fit_elastoplastic_loading(
    displacement: &Signal<Displacement>,
    options: &NonlinearFitOptions,
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
