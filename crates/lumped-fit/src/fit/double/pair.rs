//! The double spring-mass-damper fitted to the displacement of its compartment: pairs of dual models.
//!
//! One accelerometer in the compartment cannot tell a model from its dual, which exchanges front and rear, so every
//! minimum stands for two sets of parameters. What is found here is a starting point where the filter of the record
//! is known: [`refine`](crate::refine) then moves it to the minimum of the filtered misfit.

use std::collections::BTreeMap;

use crumple_linalg::jacobi_svd;
use crumple_lumped::DoubleSpringMassDamper;
use crumple_signal::{Displacement, Signal};
use nalgebra::{DMatrix, Matrix4, Vector4};
use rayon::prelude::*;

use crate::error::positive;
use crate::fit::descents::{REPORTED, SEARCH_SAMPLES};
use crate::fit::double::multistart::{distinct, search};
use crate::fit::double::residuals::DoubleResiduals;
use crate::free::search_bounds::{DAMPER_BOUNDS, DAMPER_STARTS, SPRING_BOUNDS, SPRING_STARTS};
use crate::record::window::Window;
use crate::{Fit, FitQuantity, SolveError, Uncertainty};
use crumple_estimation::minimise::levenberg_marquardt_4::{Minimum, Residuals, Settings, minimise};
use crumple_estimation::statistics::lag_1_autocorrelation;

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
/// and no value is determined. The search is a deterministic multi-start on a thinned window, see `search`; what it
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
        scale: Vector4::new(spring, spring / mu, damper, damper / mu),
        unit_m: impact_speed_m_per_s * length_s,
    };
    let logarithms = |springs: f64, dampers: f64| Vector4::new(springs, springs, dampers, dampers).map(f64::ln);
    let settings = Settings {
        lower: logarithms(SPRING_BOUNDS.0, DAMPER_BOUNDS.0),
        upper: logarithms(SPRING_BOUNDS.1, DAMPER_BOUNDS.1),
        max_iterations: 200,
        cost_tolerance: 1e-15,
        step_tolerance: 1e-13,
        gradient_tolerance: 1e-13,
    };
    // Structures that stop a car in time T are near these scales.
    let (box_lower, box_upper) =
        (logarithms(SPRING_STARTS.0, DAMPER_STARTS.0), logarithms(SPRING_STARTS.1, DAMPER_STARTS.1));

    let coarse = problem(&thin);
    let (coarse_minima, mut evaluations) = search(&coarse, options.starts, &settings, &box_lower, &box_upper);
    let fine = problem(&window);
    let mut minima: Vec<Minimum> = coarse_minima
        .par_iter()
        .map(|m| {
            minimise(&fine, &m.theta, &settings).map(|on| Minimum { iterations: m.iterations + on.iterations, ..on })
        })
        .collect::<Vec<_>>()
        .into_iter()
        .flatten()
        .collect();
    evaluations += minima.iter().map(|m| m.evaluations).sum::<u64>();
    // Stable: equal costs keep the order of the search.
    minima.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let minima = distinct(&fine, minima, REPORTED);
    let rmse = |m: &Minimum| (m.cost / window.samples.len() as f64).sqrt() * fine.unit_m;
    let best = minima.first().map(rmse).ok_or(SolveError::NoFit { starts: options.starts })?;
    let as_good = |m: &&Minimum| rmse(m) <= 1.01 * best + options.resolution_m;
    Ok(minima.iter().filter(as_good).map(|m| pair(&fine, m, evaluations)).collect())
}

/// A minimum as the two models it stands for. The dual exchanges the relative deviations and the bounds of front and
/// rear.
fn pair(fine: &DoubleResiduals<'_>, best: &Minimum, evaluations: u64) -> DoubleFit {
    let window = fine.window;
    let residuals = fine.residuals(&best.theta).unwrap_or_default();
    let model = fine.model(&best.theta);
    let mut pair = [model, model.dual()];
    let relative = relative_deviations(best, &residuals);
    // The dual exchanges front and rear, and with them their relative deviations.
    let exchanged = relative.as_ref().map(|(d, condition)| ([d[1], d[0], d[3], d[2]], *condition));
    let mut deviations = [relative, exchanged];
    let mut active = [best.on_bound, [1, 0, 3, 2].map(|i| best.on_bound[i])];
    if pair[1].k1_n_per_m < pair[0].k1_n_per_m {
        pair.reverse();
        deviations.reverse();
        active.reverse();
    }
    let correlation = lag_1_autocorrelation(&residuals);
    let uncertainty = [0, 1].map(|i| {
        let (relative, condition) = deviations[i]?;
        let p = [pair[i].k1_n_per_m, pair[i].k2_n_per_m, pair[i].c1_n_s_per_m, pair[i].c2_n_s_per_m];
        let standard_deviation: BTreeMap<_, _> =
            (0..4).filter_map(|j| relative[j].map(|d| (NAMES[j], d * p[j]))).collect();
        Some(Uncertainty {
            method: crate::candidate::linearised::LINEARISED,
            standard_deviation,
            condition,
            residual_autocorrelation: Some(correlation),
        })
    });
    DoubleFit {
        models: pair,
        fit: Fit {
            from_s: window.first_s,
            to_s: window.last_s(),
            samples: window.samples.len(),
            quantity: FitQuantity::Displacement,
            rmse: (best.cost / window.samples.len() as f64).sqrt() * fine.unit_m,
            iterations: best.iterations,
            evaluations,
            stop_reason: best.stop,
            active_bounds: (0..4).filter(|&j| active[0][j]).map(|j| NAMES[j]).collect(),
            sensors: Vec::new(),
        },
        uncertainty,
    }
}

/// Relative standard deviations of the free parameters, and the condition of their scaled sensitivities.
///
/// `sigma² (J'J)^-1` with `sigma² = cost/(n - p)`, times `(1+rho)/(1-rho)` for residuals with lag-1 correlation rho:
/// the number of independent samples is smaller by it. In logarithms, hence relative.
fn relative_deviations(best: &Minimum, residuals: &[f64]) -> Option<([Option<f64>; 4], f64)> {
    let free: Vec<usize> = (0..4).filter(|&i| !best.on_bound[i]).collect();
    let norms = best.r.column_iter().map(|c| c.norm()).collect::<Vec<_>>();
    if free.is_empty() || free.iter().any(|&i| norms[i] == 0.0) || residuals.len() <= free.len() {
        return None;
    }
    // Columns of unit length; fixed ones stay zero, and the singular values of zero that they bring come last.
    let mut scaled = Matrix4::zeros();
    for &i in &free {
        scaled.set_column(i, &(best.r.column(i) / norms[i]));
    }
    let svd = jacobi_svd(&DMatrix::from_column_slice(4, 4, scaled.as_slice()))?;
    let (largest, smallest) = (svd.values[0], svd.values[free.len() - 1]);
    if smallest <= 0.0 {
        return None;
    }
    let rho = lag_1_autocorrelation(residuals);
    let variance = best.cost / (residuals.len() - free.len()) as f64 * (1.0 + rho) / (1.0 - rho);
    let deviation = |i: usize| {
        let inverse: f64 = (0..free.len()).map(|k| (svd.right[(i, k)] / svd.values[k]).powi(2)).sum();
        (variance * inverse).sqrt() / norms[i]
    };
    let deviations: [Option<f64>; 4] = std::array::from_fn(|i| (!best.on_bound[i]).then(|| deviation(i)));
    if deviations.iter().flatten().any(|d| !d.is_finite()) {
        return None;
    }
    Some((deviations, largest / smallest))
}
