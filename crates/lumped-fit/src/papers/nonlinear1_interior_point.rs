//! The first nonlinear model by the method of its paper: an interior point with side constraints.

use crumple_lumped::{Model, Nonlinear1};
use crumple_numerics::estimation::minimise::interior_point::{Evaluated, InteriorPoint, Program, interior_point};
use crumple_numerics::estimation::minimise::levenberg_marquardt::Response;
use crumple_signal::{Displacement, Signal};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::fit::at_crush::AtCrush;
use crate::fit::nonlinear::coordinates::{KNOTS, coordinates};
use crate::fit::nonlinear::nonlinear1::parts;
use crate::fit::options::SingleMassFitOptions;
use crate::fit::problem::Problem;
use crate::free::coordinates::Map;
use crate::{Fit, SolveError};

/// Names of the free parameters, in the order of `x`.
const NAMES: [&str; 6] =
    ["k1_n_per_m", "k2_n_per_m", "c1_n_s_per_m", "c2_n_s_per_m", "c3_n_s_per_m", "v_thresh_m_per_s"];
/// Knots of the damper that the method starts from, shares of the impact speed. Springs and dampers start in the
/// middle of their range.
const KNEES: [f64; 5] = [0.1, 0.25, 0.4, 0.6, 0.8];
/// The objective in squared hundredths of the crush, so that the method's tolerance of 1e-8 is far below a
/// millimetre.
const OBJECTIVE: f64 = 1e4;
/// Largest violation of the conditions on crush and speed that is accepted, relative.
const FEASIBLE: f64 = 1e-7;

/// The program: `x` holds `k1, k2, c1, c2, c3` over `m (v0/C)²` and `m v0/C`, and the knot over `v0`. The Hessian is
/// that of Gauss and Newton.
struct SideConstraints<'a> {
    /// The misfit of the displacement in units of the crush.
    problem: Problem<'a, Model>,
    /// The conditions at dynamic crush.
    at_crush: AtCrush,
}

impl Program for SideConstraints<'_> {
    /// Objective, conditions at dynamic crush and their derivatives, from two simulations with sensitivities.
    fn evaluate(&self, x: &DVector<f64>) -> Option<Evaluated> {
        let (problem, x) = (&self.problem, x.as_slice());
        let (mut residuals, mut columns) = (DVector::zeros(problem.rows()), DMatrix::zeros(problem.rows(), 6));
        if !(problem.residuals(x, residuals.as_mut_slice()) && problem.sensitivities(x, &mut columns)) {
            return None;
        }
        let places = problem.coordinates.places(&[1, 2, 3, 4, 5, 6]);
        let (conditions, derivatives) = self.at_crush.conditions(&problem.coordinates.structure(x)?, &places)?;
        let slope = |j: usize| problem.coordinates.free[j].slope(x[j]);
        Some(Evaluated {
            f: OBJECTIVE * residuals.norm_squared(),
            gradient: columns.tr_mul(&residuals) * (2.0 * OBJECTIVE),
            hessian: columns.tr_mul(&columns) * (2.0 * OBJECTIVE),
            c: DVector::from_row_slice(&conditions),
            jacobian: DMatrix::from_fn(2, 6, |i, j| slope(j) * derivatives[j][i]),
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
    options.check()?;
    let observed = options.observed(displacement)?;
    let ((k, c), v0) = (options.units(), options.impact_speed_m_per_s);
    let free: Vec<(usize, Map)> = (1..).zip([k, k, c, c, c, v0].map(Map::Share)).collect();
    let coordinates = coordinates(parts(options).template, &free);
    let problem = Problem { unit: options.crush_m, ..Problem::new(&coordinates, &observed, 0.0) };
    let program = SideConstraints { problem, at_crush: AtCrush::new(options) };
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
    let h = DVector::from_vec(vec![0.0, 0.0, 0.0, 0.0, 0.0, -KNOTS.0, KNOTS.1]);
    let ends: Vec<Option<InteriorPoint>> = KNEES
        .par_iter()
        .map(|knee| {
            let start = DVector::from_vec(vec![0.4, 0.9, 0.8, 0.3, 0.05, *knee]);
            interior_point(&program, &start, (&g, &h))
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
    let rmse = (best.f / OBJECTIVE / observed.rows() as f64).sqrt() * options.crush_m;
    let fit = Fit::of_waves(&observed, &[rmse], Vec::new(), (best.iterations, evaluations, best.stop), active_bounds);
    match coordinates.model(best.x.as_slice()) {
        Some(Model::Nonlinear1(model)) => Ok((model, fit)),
        _ => Err(SolveError::NoFit { starts: KNEES.len() }),
    }
}
