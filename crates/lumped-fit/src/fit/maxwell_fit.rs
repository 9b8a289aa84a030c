//! The Maxwell model, spring and damper in series, fitted to the displacement of the compartment.

use crumple_lumped::Maxwell;
use crumple_signal::{Displacement, Signal};

use crate::error::positive;
use crate::fit::closed_form_fit::{ClosedForm, fit_logarithms};
use crate::fit::options::SingleMassFitOptions;
use crate::record::window::Window;
use crate::{Fit, SolveError, Uncertainty};
use crumple_estimation::minimise::levenberg_marquardt::Bounds;

/// Starts of the spring in units of `m (v0/C)²`.
const SPRINGS: [f64; 5] = [0.3, 1.0, 3.0, 10.0, 30.0];
/// Starts of the damper in units of `m v0/C`.
const DAMPERS: [f64; 4] = [0.3, 1.0, 3.0, 10.0];

/// Fits the spring and the damper of the Maxwell model, in series, with `x(0) = 0`, `v(0) = v0` and `a(0) = 0`.
///
/// Two numbers, where the five free constants of the single-mass paper do not reproduce the curve. Least squares of
/// their logarithms from 20 starts, bounded to `e^±9` of `m (v0/C)²` and `m v0/C`; the closed form is exact at every
/// sample, whether the mass swings or creeps. Near a rigid spring or damper the other one is determined alone.
///
/// Errors: as the other fits.
pub fn fit_maxwell(
    displacement: &Signal<Displacement>,
    options: &SingleMassFitOptions,
) -> Result<(Maxwell, Fit, Option<Uncertainty>), SolveError> {
    let mass_kg = positive("mass_kg", options.mass_kg)?;
    let v0 = positive("impact_speed_m_per_s", options.impact_speed_m_per_s)?;
    let crush_m = positive("crush_m", options.crush_m)?;
    let window = Window::pick(displacement, options.time_zero_s, options.from_s, options.to_s, options.samples)?;
    let rate = v0 / crush_m;
    // Logarithms over `m (v0/C)²` and `m v0/C`.
    let build = |theta: &[f64]| Maxwell {
        mass_kg,
        stiffness_n_per_m: mass_kg * rate * rate * theta[0].exp(),
        damping_n_s_per_m: mass_kg * rate * theta[1].exp(),
    };
    let displacement = |theta: &[f64]| {
        let model = build(theta);
        move |t| model.state(v0, t).displacement_m
    };
    let problem = ClosedForm { window: &window, crush_m, displacement };
    let bounds = Bounds { lower: vec![-9.0; 2], upper: vec![9.0; 2], max_iterations: 100, cost_tolerance: 1e-10 };
    let starts = SPRINGS.iter().flat_map(|k| DAMPERS.map(|c| vec![f64::ln(*k), f64::ln(c)])).collect();
    let names = ["stiffness_n_per_m", "damping_n_s_per_m"];
    let values = |theta: &[f64]| {
        let model = build(theta);
        vec![model.stiffness_n_per_m, model.damping_n_s_per_m]
    };
    let (best, fit, deviations) = fit_logarithms(&problem, starts, &bounds, &names, values)?;
    Ok((build(&best.theta), fit, deviations))
}

/// Share of the dynamic crush below which a part of the model is nearly rigid.
const RIGID: f64 = 0.02;

/// Which parameter the record hardly determines, in words, and why; `None` where both take part.
///
/// Spring and damper in series share the crush. The damper gives `m v0/c` until the mass stops, at most; the spring
/// gives the largest force over its stiffness, at a thousand instants up to twice the time `C/v0` (the force of a stiff
/// spring is largest soon after contact and falls slowly). Where one of them gives less than 2 % of the crush it could
/// as well be rigid: its value follows from that small part, to which noise, filter and the other's law contribute as
/// much.
pub(crate) fn undetermined_by_the_record(model: &Maxwell, impact_speed_m_per_s: f64, crush_m: f64) -> Option<String> {
    let damper = model.mass_kg * impact_speed_m_per_s / model.damping_n_s_per_m;
    let step_s = 2.0 * crush_m / impact_speed_m_per_s / 1000.0;
    let force =
        |k: u32| model.mass_kg * model.state(impact_speed_m_per_s, f64::from(k) * step_s).acceleration_m_per_s2.abs();
    let spring = (1..=1000).map(force).fold(0.0, f64::max) / model.stiffness_n_per_m;
    let share = |give: f64| format!("{:.2} mm of {:.1} mm", 1e3 * give, 1e3 * crush_m);
    if damper < RIGID * crush_m {
        return Some(format!(
            "the damper is nearly rigid, it gives {}: the record does not determine its damping, only that it is \
             large, and the model is a spring alone",
            share(damper)
        ));
    }
    (spring < RIGID * crush_m).then(|| {
        format!(
            "the spring is nearly rigid, it gives {}: the record does not determine its stiffness, only that it is \
             large, and the model is a damper alone",
            share(spring)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_nearly_rigid_damper_is_found_and_a_working_one_is_not() {
        let model = Maxwell { mass_kg: 900.0, stiffness_n_per_m: 3e5, damping_n_s_per_m: 1e8 };
        let crush = model.events(10.0).dynamic_crush_m.unwrap();
        let finding = undetermined_by_the_record(&model, 10.0, crush).unwrap();
        assert!(finding.contains("does not determine its damping, only"), "{finding}");
        let working = Maxwell { damping_n_s_per_m: 4e4, stiffness_n_per_m: 1e6, ..model };
        let crush = working.events(10.0).dynamic_crush_m.unwrap();
        assert_eq!(undetermined_by_the_record(&working, 10.0, crush), None);
    }

    #[test]
    fn a_spring_that_has_relaxed_when_the_mass_stops_is_not_rigid() {
        // Nearly critical: hardly any force is left at dynamic crush, but the spring gave a fifth of the crush on the
        // way.
        let slow = Maxwell { mass_kg: 1600.0, stiffness_n_per_m: 6e5, damping_n_s_per_m: 1.6e4 };
        let crush = slow.events(17.0).dynamic_crush_m.unwrap();
        assert!(crush - 1600.0 * 17.0 / 1.6e4 < 0.02 * crush);
        assert_eq!(undetermined_by_the_record(&slow, 17.0, crush), None);
        // A spring hundred times as stiff is rigid beside the same damper: it gives c v0/k at most.
        let stiff = Maxwell { stiffness_n_per_m: 6e7, ..slow };
        let finding = undetermined_by_the_record(&stiff, 17.0, 1.7).unwrap();
        assert!(finding.contains("the spring is nearly rigid, it gives 4."), "{finding}");
    }
}
