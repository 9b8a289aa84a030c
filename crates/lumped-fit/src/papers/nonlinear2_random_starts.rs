//! The second nonlinear model by descents from random points: what the default is measured against.

use crumple_lumped::{Model, ModelKind, Nonlinear2};
use crumple_signal::{Displacement, Signal};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::error::positive;
use crate::fit::descents::{all, bounds};
use crate::fit::options::NonlinearFitOptions;
use crate::fit::sensors::problem::{Observed, SensorProblem};
use crate::free::model_coordinates::{Family, Scale};
use crate::free::parameterisation::FreeModel;
use crate::record::window::Window;
use crate::{Fit, FitQuantity, MassFit, SolveError};

/// Bounded Levenberg-Marquardt from `starts` points drawn evenly in the logarithms of the coefficients, the best of all ends.
///
/// For comparison: needs many times the evaluations of [`fit_nonlinear2`](crate::fit_nonlinear2). Errors: as that fit.
pub fn random_start_nonlinear2(
    displacement: &Signal<Displacement>,
    options: &NonlinearFitOptions,
    starts: usize,
    seed: u64,
) -> Result<(Nonlinear2, Fit), SolveError> {
    let mass_kg = positive("mass_kg", options.mass_kg)?;
    let impact_speed_m_per_s = positive("impact_speed_m_per_s", options.impact_speed_m_per_s)?;
    let crush_m = positive("crush_m", options.crush_m)?;
    let window = Window::pick(displacement, options.time_zero_s, options.from_s, options.to_s, options.samples)?;
    let scale = Scale { impact_speed_m_per_s, length_s: window.last_s(), crush_m, release: true };
    let family = Family::new(ModelKind::Nonlinear2, &[mass_kg], MassFit::Known, &scale);
    let sensors = [Observed { mass: 0, quantity: FitQuantity::Displacement, window, noise: crush_m }];
    let problem = SensorProblem { family: &family, impact_speed_m_per_s, sensors: &sensors };
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut even = || (random.next_u64() >> 11) as f64 * (0.5_f64).powi(53);
    let points = (0..starts)
        .map(|_| family.coordinates.iter().map(|c| c.box_lower + (c.box_upper - c.box_lower) * even()).collect())
        .collect();
    let (found, evaluations) = all(&problem, points, &bounds(&family, 120, 1e-9));
    let best = found.first().ok_or(SolveError::NoFit { starts })?;
    let Some(Model::Nonlinear2(model)) = family.model(&best.theta) else { return Err(SolveError::NoFit { starts }) };
    let window = &sensors[0].window;
    let names = family.names();
    let fit = Fit::of_displacement(best, window, evaluations, &names, crush_m);
    Ok((model, fit))
}
