//! The first nonlinear model by the method of its paper: an interior point with side constraints.

use crumple_lumped::{Instants, Model, Nonlinear1};
use crumple_signal::{Displacement, Signal};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::error::positive;
use crate::fit::options::SingleMassFitOptions;
use crate::record::window::Window;
use crate::{Fit, FitQuantity, SolveError};
use crumple_estimation::minimise::interior_point::{Evaluated, InteriorPoint, Program, interior_point};

/// Names of the free parameters, in the order of `x`.
const NAMES: [&str; 6] =
    ["k1_n_per_m", "k2_n_per_m", "c1_n_s_per_m", "c2_n_s_per_m", "c3_n_s_per_m", "v_thresh_m_per_s"];
/// Knots of the damper that the method starts from, shares of the impact speed. Springs and dampers start in the
/// middle of their range.
const KNEES: [f64; 5] = [0.1, 0.25, 0.4, 0.6, 0.8];
/// Bounds of that knot, as in the other fits.
const KNEE: (f64, f64) = (0.005, 0.995);
/// The objective in squared hundredths of the crush, so that the method's tolerance of 1e-8 is far below a
/// millimetre.
const OBJECTIVE: f64 = 1e4;
/// Largest violation of the conditions on crush and speed that is accepted, relative.
const FEASIBLE: f64 = 1e-7;

/// The program: `x` holds `k1, k2, c1, c2, c3` over `m (v0/C)²` and `m v0/C`, and the knot over `v0`. The Hessian is
/// that of Gauss and Newton.
struct SideConstraints<'a> {
    /// The record, m.
    window: &'a Window,
    /// Mass, speed, crush and its time.
    options: &'a SingleMassFitOptions,
    /// Unit of each number of `x`.
    scale: [f64; 6],
}

impl SideConstraints<'_> {
    /// The model at `x`.
    fn model(&self, x: &DVector<f64>) -> Nonlinear1 {
        let p: [f64; 6] = std::array::from_fn(|i| x[i] * self.scale[i]);
        Nonlinear1 {
            mass_kg: self.options.mass_kg,
            k1_n_per_m: p[0],
            k2_n_per_m: p[1],
            c1_n_s_per_m: p[2],
            c2_n_s_per_m: p[3],
            c3_n_s_per_m: p[4],
            v_thresh_m_per_s: p[5],
            crush_m: self.options.crush_m,
            v0_m_per_s: self.options.impact_speed_m_per_s,
        }
    }
}

impl Program for SideConstraints<'_> {
    /// Objective, conditions at dynamic crush and their derivatives, from two simulations with sensitivities.
    fn evaluate(&self, x: &DVector<f64>) -> Option<Evaluated> {
        let (v0, crush) = (self.options.impact_speed_m_per_s, self.options.crush_m);
        let model = Model::Nonlinear1(self.model(x));
        let places = [1, 2, 3, 4, 5, 6];
        let n = self.window.samples.len();
        let at = Instants { first_s: self.window.first_s, dt_s: self.window.dt_s, samples: n };
        let response = model.sensitivity(v0, &at, &places).ok()?;
        let x = &response.motions[0].displacement_m;
        let residuals = DVector::from_fn(n, |k, _| (x[k] - self.window.samples[k]) / crush);
        let columns =
            DMatrix::from_fn(n, 6, |k, j| response.derivatives[j][0].displacement_m[k] * self.scale[j] / crush);
        let end = Instants { first_s: self.options.time_of_dynamic_crush_s, dt_s: self.window.dt_s, samples: 1 };
        let stop = model.sensitivity(v0, &end, &places).ok()?;
        let jacobian = DMatrix::from_fn(2, 6, |i, j| {
            let motion = &stop.derivatives[j][0];
            self.scale[j] * if i == 0 { motion.displacement_m[0] / crush } else { motion.velocity_m_per_s[0] / v0 }
        });
        let c = DVector::from_vec(vec![
            stop.motions[0].displacement_m[0] / crush - 1.0,
            stop.motions[0].velocity_m_per_s[0] / v0,
        ]);
        Some(Evaluated {
            f: OBJECTIVE * residuals.norm_squared(),
            gradient: columns.tr_mul(&residuals) * (2.0 * OBJECTIVE),
            hessian: columns.tr_mul(&columns) * (2.0 * OBJECTIVE),
            c,
            jacobian,
        })
    }
}

/// Fits the first nonlinear model as the paper does: interior point with `k1 <= k2`, `c1 >= c2 >= c3`, `x(t_m) = C`,
/// `v(t_m) = 0` as constraints (single-mass paper, section 4.1).
///
/// Begun from five knees of the damper, the best feasible end is taken. Reaches the same point as
/// [`fit_nonlinear1`](crate::fit_nonlinear1), whose start is a better one. Errors: as that fit; also where no end meets
/// the constraints.
pub fn interior_point_nonlinear1(
    displacement: &Signal<Displacement>,
    options: &SingleMassFitOptions,
) -> Result<(Nonlinear1, Fit), SolveError> {
    let m = positive("mass_kg", options.mass_kg)?;
    let v0 = positive("impact_speed_m_per_s", options.impact_speed_m_per_s)?;
    let rate = v0 / positive("crush_m", options.crush_m)?;
    positive("time_of_dynamic_crush_s", options.time_of_dynamic_crush_s)?;
    let window = options.window(displacement)?;
    let (k, c) = (m * rate * rate, m * rate);
    let problem = SideConstraints { window: &window, options, scale: [k, k, c, c, c, v0] };
    #[rustfmt::skip]
    let g = DMatrix::from_row_slice(7, 6, &[
        1.0,  0.0, 0.0,  0.0,  0.0, 0.0, // k1 >= 0
        -1.0, 1.0, 0.0,  0.0,  0.0, 0.0, // k2 >= k1
        0.0,  0.0, 1.0, -1.0,  0.0, 0.0, // c1 >= c2
        0.0,  0.0, 0.0,  1.0, -1.0, 0.0, // c2 >= c3
        0.0,  0.0, 0.0,  0.0,  1.0, 0.0, // c3 >= 0
        0.0,  0.0, 0.0,  0.0,  0.0, 1.0,
        0.0,  0.0, 0.0,  0.0,  0.0, -1.0,
    ]);
    let h = DVector::from_vec(vec![0.0, 0.0, 0.0, 0.0, 0.0, -KNEE.0, KNEE.1]);
    let ends: Vec<Option<InteriorPoint>> = KNEES
        .par_iter()
        .map(|knee| {
            let start = DVector::from_vec(vec![0.4, 0.9, 0.8, 0.3, 0.05, *knee]);
            interior_point(&problem, &start, (&g, &h))
        })
        .collect();
    let evaluations = ends.iter().flatten().map(|end| end.evaluations).sum();
    let best = ends
        .into_iter()
        .flatten()
        .filter(|end| end.infeasibility <= FEASIBLE)
        .min_by(|a, b| a.f.total_cmp(&b.f))
        .ok_or(SolveError::NoFit { starts: KNEES.len() })?;
    let gaps = &g * &best.x + &h;
    // What makes two equal, or zero, holds the first of the two.
    let of_gap = [0, 1, 2, 3, 4, 5, 5];
    let active_bounds = (0..7).filter(|i| gaps[*i] < 1e-6).map(|i| NAMES[of_gap[i]]).collect();
    let fit = Fit {
        from_s: window.first_s,
        to_s: window.last_s(),
        samples: window.samples.len(),
        quantity: FitQuantity::Displacement,
        rmse: (best.f / OBJECTIVE / window.samples.len() as f64).sqrt() * options.crush_m,
        iterations: best.iterations,
        evaluations,
        stop_reason: best.stop,
        active_bounds,
        sensors: Vec::new(),
    };
    Ok((problem.model(&best.x), fit))
}
