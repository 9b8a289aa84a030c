//! The Maxwell model fitted to the compartment's displacement.

use crumple_lumped::Maxwell;
use crumple_signal::{Displacement, Signal};

use crate::error::positive;
use crate::least_squares::{Bounds, Optimum, Response, descend, uncertainty};
use crate::window::Window;
use crate::{Fit, FitQuantity, NonlinearFitOptions, SolveError, Uncertainty};

/// Starts of the spring and of the damper, in their units.
const SPRINGS: [f64; 5] = [0.3, 1.0, 3.0, 10.0, 30.0];
const DAMPERS: [f64; 4] = [0.3, 1.0, 3.0, 10.0];

struct Displacements<'a> {
    window: &'a Window,
    options: &'a NonlinearFitOptions,
}

impl Displacements<'_> {
    /// The model of logarithms over `m (v0/C)²` and `m v0/C`.
    fn model(&self, theta: &[f64]) -> Maxwell {
        let rate = self.options.impact_speed_m_per_s / self.options.crush_m;
        Maxwell {
            mass_kg: self.options.mass_kg,
            stiffness_n_per_m: self.options.mass_kg * rate * rate * theta[0].exp(),
            damping_n_s_per_m: self.options.mass_kg * rate * theta[1].exp(),
        }
    }
}

impl Response for Displacements<'_> {
    fn rows(&self) -> usize {
        self.window.samples.len()
    }

    fn residuals(&self, theta: &[f64], out: &mut [f64]) -> bool {
        let model = self.model(theta);
        for (k, (r, s)) in out.iter_mut().zip(&self.window.samples).enumerate() {
            let t = self.window.first_s + k as f64 * self.window.dt_s;
            *r = (model.state(self.options.impact_speed_m_per_s, t).displacement_m - s) / self.options.crush_m;
        }
        out.iter().all(|x| x.is_finite())
    }
}

/// Fits spring and damper in series, with `x(0) = 0`, `v(0) = v0`, `a(0) = 0` as the model has them: two numbers, where the
/// paper's five free constants do not reproduce the curve.
///
/// Logarithms, from 20 starts, bounded to `e^±9` of their units; the closed form is exact at every sample. Errors: as the
/// other fits.
pub fn fit_maxwell(
    displacement: &Signal<Displacement>,
    options: &NonlinearFitOptions,
) -> Result<(Maxwell, Fit, Option<Uncertainty>), SolveError> {
    positive("mass_kg", options.mass_kg)?;
    positive("impact_speed_m_per_s", options.impact_speed_m_per_s)?;
    positive("crush_m", options.crush_m)?;
    let window = Window::pick(displacement, options.time_zero_s, options.from_s, options.to_s, options.samples)?;
    let problem = Displacements { window: &window, options };
    let bounds = Bounds { lower: vec![-9.0; 2], upper: vec![9.0; 2], max_iterations: 100, cost_tolerance: 1e-10 };
    let mut evaluations = 0;
    let mut best: Option<Optimum> = None;
    for start in SPRINGS.iter().flat_map(|k| DAMPERS.map(|c| [f64::ln(*k), f64::ln(c)])) {
        let Some(found) = descend(&problem, &start, &bounds) else { continue };
        evaluations += found.evaluations;
        if best.as_ref().is_none_or(|best| found.cost < best.cost) {
            best = Some(found);
        }
    }
    let best = best.ok_or(SolveError::NoFit { starts: SPRINGS.len() * DAMPERS.len() })?;
    let names = ["stiffness_n_per_m", "damping_n_s_per_m"];
    let fit = Fit {
        from_s: window.first_s,
        to_s: window.last_s(),
        samples: window.samples.len(),
        quantity: FitQuantity::Displacement,
        rmse: (best.cost / window.samples.len() as f64).sqrt() * options.crush_m,
        iterations: best.iterations,
        evaluations,
        stop_reason: best.stop,
        active_bounds: (0..2).filter(|&i| best.on_bound[i]).map(|i| names[i]).collect(),
        sensors: Vec::new(),
    };
    let model = problem.model(&best.theta);
    let mut rest = vec![0.0; problem.rows()];
    let known = problem.residuals(&best.theta, &mut rest);
    let factors = [model.stiffness_n_per_m, model.damping_n_s_per_m];
    let deviations = known.then(|| uncertainty(&best, &rest, &names, &factors)).flatten();
    Ok((model, fit, deviations))
}

/// Share of the dynamic crush below which a part of the model is nearly rigid.
const RIGID: f64 = 0.02;

/// Which parameter the record hardly determines, in words, and why; `None` where both take part.
///
/// Spring and damper in series share the crush. The damper gives `m v0/c` until the mass stops, at most; the spring's share
/// is at least the rest. Where one of them gives less than 2 % of the crush it could as well be rigid: its value follows
/// from that small remainder, to which noise, filter and the other's law contribute as much.
pub fn undetermined_by_the_record(model: &Maxwell, impact_speed_m_per_s: f64, crush_m: f64) -> Option<String> {
    let damper = model.mass_kg * impact_speed_m_per_s / model.damping_n_s_per_m;
    // At dynamic crush the momentum has passed through the damper; the rest of the crush is the spring's.
    let events = model.events(impact_speed_m_per_s);
    let spring = events.dynamic_crush_m.map(|crush| crush - damper);
    let share = |give: f64| format!("{:.2} mm of {:.1} mm", 1e3 * give, 1e3 * crush_m);
    if damper < RIGID * crush_m {
        return Some(format!(
            "the damper is nearly rigid, it gives {}: the record does not determine damping_n_s_per_m, only that it is large, and the \
             model is a spring alone",
            share(damper)
        ));
    }
    match spring {
        Some(spring) if spring < RIGID * crush_m => Some(format!(
            "the spring is nearly rigid, it gives {}: the record does not determine stiffness_n_per_m, only that it is large, and the \
             model is a damper alone",
            share(spring.max(0.0))
        )),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_nearly_rigid_damper_is_found_and_a_working_one_is_not() {
        let model = Maxwell { mass_kg: 900.0, stiffness_n_per_m: 3e5, damping_n_s_per_m: 1e8 };
        let crush = model.events(10.0).dynamic_crush_m.unwrap();
        let finding = undetermined_by_the_record(&model, 10.0, crush).unwrap();
        assert!(finding.contains("does not determine damping_n_s_per_m"), "{finding}");
        let working = Maxwell { damping_n_s_per_m: 4e4, stiffness_n_per_m: 1e6, ..model };
        let crush = working.events(10.0).dynamic_crush_m.unwrap();
        assert_eq!(undetermined_by_the_record(&working, 10.0, crush), None);
    }
}
