use crumple_lumped::{Elastoplastic, Kelvin};
use crumple_signal::{Displacement, Signal};

use crate::error::positive;
use crate::least_squares::{Bounds, Optimum, Response, descend, uncertainty};
use crate::window::Window;
use crate::{Fit, FitQuantity, NonlinearFitOptions, SolveError, Uncertainty};

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

/// Starts of the loading stiffness over `m (v0/C)²`.
const STIFFNESSES: [f64; 5] = [0.1, 0.3, 1.0, 2.0, 4.0];

/// The undamped swing beside the record, over the logarithm of the stiffness.
struct Loading<'a> {
    window: &'a Window,
    options: &'a NonlinearFitOptions,
    unit_n_per_m: f64,
}

impl Response for Loading<'_> {
    fn rows(&self) -> usize {
        self.window.samples.len()
    }

    fn residuals(&self, theta: &[f64], out: &mut [f64]) -> bool {
        let model = Kelvin {
            mass_kg: self.options.mass_kg,
            stiffness_n_per_m: self.unit_n_per_m * theta[0].exp(),
            damping_n_s_per_m: 0.0,
        };
        for (k, (r, s)) in out.iter_mut().zip(&self.window.samples).enumerate() {
            let t = self.window.first_s + k as f64 * self.window.dt_s;
            *r = (model.state(self.options.impact_speed_m_per_s, t).displacement_m - s) / self.options.crush_m;
        }
        out.iter().all(|x| x.is_finite())
    }
}

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
    let rate = positive("impact_speed_m_per_s", options.impact_speed_m_per_s)? / positive("crush_m", options.crush_m)?;
    let window = Window::pick(displacement, options.time_zero_s, options.from_s, options.to_s, options.samples)?;
    let problem = Loading { window: &window, options, unit_n_per_m: mass_kg * rate * rate };
    let bounds = Bounds { lower: vec![-9.0], upper: vec![9.0], max_iterations: 100, cost_tolerance: 1e-12 };
    let found: Vec<Optimum> =
        STIFFNESSES.iter().filter_map(|start| descend(&problem, &[start.ln()], &bounds)).collect();
    let evaluations = found.iter().map(|optimum| optimum.evaluations).sum();
    let best = found
        .into_iter()
        .min_by(|a, b| a.cost.total_cmp(&b.cost))
        .ok_or(SolveError::NoFit { starts: STIFFNESSES.len() })?;
    let stiffness_n_per_m = problem.unit_n_per_m * best.theta[0].exp();
    let names = ["loading_stiffness_n_per_m"];
    let mut rest = vec![0.0; problem.rows()];
    let known = problem.residuals(&best.theta, &mut rest);
    let deviations = known.then(|| uncertainty(&best, &rest, &names, &[stiffness_n_per_m])).flatten();
    let fit = Fit {
        from_s: window.first_s,
        to_s: window.last_s(),
        samples: window.samples.len(),
        quantity: FitQuantity::Displacement,
        rmse: (best.cost / window.samples.len() as f64).sqrt() * options.crush_m,
        iterations: best.iterations,
        evaluations,
        stop_reason: best.stop,
        active_bounds: best
            .on_bound
            .first()
            .is_some_and(|held| *held)
            .then_some(names[0])
            .into_iter()
            .chain(["unloading_stiffness_n_per_m"])
            .collect(),
        sensors: Vec::new(),
    };
    let model = Elastoplastic {
        mass_kg,
        loading_stiffness_n_per_m: stiffness_n_per_m,
        unloading_stiffness_n_per_m: stiffness_n_per_m,
        release: true,
    };
    Ok((model, fit, deviations))
}
