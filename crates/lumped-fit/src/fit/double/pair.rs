//! The double spring-mass-damper fitted to the displacement of its compartment: pairs of dual models.
//!
//! One accelerometer in the compartment cannot tell a model from its dual, which exchanges front and rear, so every
//! minimum stands for two sets of parameters. What is found here is a starting point where the filter of the record
//! is known: [`refine`](crate::refine) then moves it to the minimum of the filtered misfit.

use crumple_lumped::{DoubleSpringMassDamper, Model};
use crumple_signal::{Displacement, Signal};
use rayon::prelude::*;

use crate::candidate::linearised::uncertainty;
use crate::error::positive;
use crate::fit::descents::{REPORTED, SEARCH_SAMPLES, distinct_places};
use crate::fit::double::residuals::DoubleResiduals;
use crate::fit::halton_starts::start;
use crate::fit::multistart::MultiStart;
use crate::free::search_bounds::{DAMPER_BOUNDS, DAMPER_STARTS, SPRING_BOUNDS, SPRING_STARTS};
use crate::record::window::Window;
use crate::{Fit, SolveError, Uncertainty};
use crumple_estimation::minimise::levenberg_marquardt::{Bounds, Optimum, Response, descend};

/// Relative residual below which a minimum is the exact model: rounding of displacements near 1 m.
const EXACT: f64 = 1e-14;
/// Names of the fitted parameters, in the order of theta.
pub(crate) const NAMES: [&str; 4] = ["k1_n_per_m", "k2_n_per_m", "c1_n_s_per_m", "c2_n_s_per_m"];

/// Masses, speed, window and size of the search of a fit of the double model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DoubleFitOptions {
    /// Mass of the chassis, next to the barrier, kg.
    pub m1_kg: f64,
    /// Mass of the compartment, kg.
    pub m2_kg: f64,
    /// Speed at contact, m/s.
    pub impact_speed_m_per_s: f64,
    /// Contact on the record's time axis, s.
    pub time_zero_s: f64,
    /// Start of the window, s after contact.
    pub from_s: f64,
    /// End of the window; `None`: end of the record.
    pub to_s: Option<f64>,
    /// At most so many samples of the window are used, evenly picked.
    pub samples: usize,
    /// Starts of the search.
    pub starts: usize,
    /// Minima whose root mean square errors differ by less than this (and 1 %) are all reported, m: the record cannot
    /// tell them apart.
    pub resolution_m: f64,
}

/// A fitted pair: two models with the same motion of the compartment.
#[derive(Debug, Clone, PartialEq)]
pub struct DoubleFit {
    /// The two models with the same compartment motion, the one with the softer front spring first.
    pub models: [DoubleSpringMassDamper; 2],
    /// How they were fitted.
    pub fit: Fit,
    /// Uncertainty of each model's parameters; `None` if every parameter stands on a bound.
    pub uncertainty: [Option<Uncertainty>; 2],
}

/// Fits `k1, k2, c1, c2 > 0` to the compartment's displacement by least squares.
///
/// The masses are given, since one accelerometer does not determine them. Parameters are positive by construction
/// (their logarithms are fitted) and bounded: springs between 1e-4 and 1e4 times `M (π/2T)²`, the spring of an undamped
/// mass `M` that stops at the window's end `T`, dampers between 1e-5 and 1e3 times `M/T` (those in the rear divided by
/// `M/m2`). A fit that ends on a bound says so: that damper or spring does not matter (or ties the masses together),
/// and no value is determined. The search is a deterministic multi-start on a thinned window with hops; what it
/// finds is followed to convergence on the whole window. Starts run in parallel and are collected by index, so the
/// result does not depend on the number of threads. A global minimum is likely, not proven.
///
/// The two models of a pair fit equally, exactly. With an exact record the parameters come back to 1e-9 relative and
/// better; with a displacement integrated by the trapezoidal rule at 10 kHz (error about 1e-6 m, smooth) to 1e-4 to
/// 1e-2, worst for four real poles.
///
/// Errors: masses or speed that are not positive, a window outside the record or with fewer than 12 samples, or no
/// finite response from any start.
///
/// **Several minima.** The error has more than one minimum, and with strong damping they lie close: records with
/// real poles exist where parameter sets that differ by a factor of 5 leave 4e-9 to 1.4e-7 m. So the result is a list,
/// best first, of all minima found that the record cannot tell from the best.
pub fn fit_double(
    displacement: &Signal<Displacement>,
    options: &DoubleFitOptions,
) -> Result<Vec<DoubleFit>, SolveError> {
    let m1_kg = positive("m1_kg", options.m1_kg)?;
    let m2_kg = positive("m2_kg", options.m2_kg)?;
    let impact_speed_m_per_s = positive("impact_speed_m_per_s", options.impact_speed_m_per_s)?;
    let window = Window::pick(displacement, options.time_zero_s, options.from_s, options.to_s, options.samples)?;
    let thin = window.thinned(SEARCH_SAMPLES);

    let length_s = window.last_s();
    let spring = (m1_kg + m2_kg) * (std::f64::consts::FRAC_PI_2 / length_s).powi(2);
    let damper = (m1_kg + m2_kg) / length_s;
    // With the rear scaled by it, the dual model is the exchange of front and rear: the box of the search holds both.
    let mu = (m1_kg + m2_kg) / m2_kg;
    let problem = |window| DoubleResiduals {
        m1_kg,
        m2_kg,
        impact_speed_m_per_s,
        window,
        scale: [spring, spring / mu, damper, damper / mu],
        unit_m: impact_speed_m_per_s * length_s,
    };
    let logarithms = |springs: f64, dampers: f64| vec![springs.ln(), springs.ln(), dampers.ln(), dampers.ln()];
    let bounds = Bounds {
        lower: logarithms(SPRING_BOUNDS.0, DAMPER_BOUNDS.0),
        upper: logarithms(SPRING_BOUNDS.1, DAMPER_BOUNDS.1),
        max_iterations: 200,
        cost_tolerance: 1e-15,
    };
    // Structures that stop a car in time T are near these scales.
    let (box_lower, box_upper) =
        (logarithms(SPRING_STARTS.0, DAMPER_STARTS.0), logarithms(SPRING_STARTS.1, DAMPER_STARTS.1));
    let points = (0..options.starts).map(|k| start(k, &box_lower, &box_upper)).collect();

    let coarse = problem(&thin);
    let exact = EXACT * EXACT * coarse.rows() as f64;
    let search = MultiStart { problem: &coarse, bounds: &bounds, exact, place: |theta: &[f64]| place(&coarse, theta) };
    let (mut coarse_minima, mut evaluations) = search.search(points);
    coarse_minima.truncate(REPORTED);
    let fine = problem(&window);
    let mut minima: Vec<Optimum> = coarse_minima
        .par_iter()
        .map(|m| descend(&fine, &m.theta, &bounds).map(|on| Optimum { iterations: m.iterations + on.iterations, ..on }))
        .collect::<Vec<_>>()
        .into_iter()
        .flatten()
        .collect();
    evaluations += minima.iter().map(|m| m.evaluations).sum::<u64>();
    // Stable: equal costs keep the order of the search.
    minima.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let minima = distinct_places(minima, REPORTED, |theta| place(&fine, theta));
    let rmse = |m: &Optimum| (m.cost / window.samples.len() as f64).sqrt() * fine.unit_m;
    let best = minima.first().map(rmse).ok_or(SolveError::NoFit { starts: options.starts })?;
    let as_good = |m: &&Optimum| rmse(m) <= 1.01 * best + options.resolution_m;
    Ok(minima.iter().filter(as_good).map(|m| pair(&fine, m, evaluations)).collect())
}

/// Five numbers that a model and its dual share and other models do not: the four coefficients of the characteristic
/// polynomial and the product of the dampers, in logarithms.
fn place(problem: &DoubleResiduals<'_>, theta: &[f64]) -> Vec<f64> {
    let model = problem.model(theta);
    let [_, t, u, v, w] = model.characteristic_polynomial();
    [t, u, v, w, model.c1_n_s_per_m * model.c2_n_s_per_m].map(f64::ln).to_vec()
}

/// A minimum as the two models it stands for. The dual exchanges front and rear, and with them relative deviations and
/// bounds.
fn pair(fine: &DoubleResiduals<'_>, best: &Optimum, evaluations: u64) -> DoubleFit {
    let mut residuals = vec![0.0; fine.rows()];
    let finite = fine.residuals(&best.theta, &mut residuals);
    let model = fine.model(&best.theta);
    // Each with the names of its parameters in the order of theta.
    let exchanged = [1, 0, 3, 2].map(|i| NAMES[i]);
    let mut pair = [(model, NAMES), (model.dual(), exchanged)];
    if pair[1].0.k1_n_per_m < pair[0].0.k1_n_per_m {
        pair.reverse();
    }
    let uncertainty = pair.map(|(model, names)| {
        let values = Model::DoubleSpringMassDamper(model).parameters();
        // In logarithms, hence relative.
        finite.then(|| uncertainty(best, &residuals, &names, &names.map(|name| values[name]))).flatten()
    });
    let mut fit = Fit::of_displacement(best, fine.window, evaluations, &pair[0].1, fine.unit_m);
    fit.active_bounds.sort_by_key(|name| NAMES.iter().position(|other| other == name));
    DoubleFit { models: pair.map(|(model, _)| model), fit, uncertainty }
}
