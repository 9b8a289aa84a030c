//! Displacement of a nonlinear model minus the record, with analytic sensitivities and the conditions at dynamic
//! crush.

use crumple_lumped::{Instants, Model, Nonlinear1};
use nalgebra::DMatrix;

use crate::fit::options::SingleMassFitOptions;
use crate::record::window::Window;
use crumple_estimation::minimise::levenberg_marquardt::Response;

/// For each coordinate the places of the parameters that it moves, among the names of the model, and their
/// derivatives by it.
pub(crate) type Derivatives = Vec<Vec<(usize, f64)>>;

/// Displacement of a model minus the record over the window, in units of the crush; with `conditions` two rows more.
///
/// The rows are `sqrt(w) (c_j + y_j/w)`: `c` the two conditions at dynamic crush, `w` the weight and `y` the
/// multipliers of the augmented Lagrangian. Their square is the Lagrangian up to a constant.
pub(crate) struct Displacements<'a, F> {
    /// The record, m.
    pub window: &'a Window,
    /// Mass, speed, crush and its time.
    pub options: &'a SingleMassFitOptions,
    /// The model at a point of the search; `None` if it is not physical.
    pub model: F,
    /// Derivatives of the parameters, by their places, by each of theta.
    pub derivatives: fn(&[f64], &SingleMassFitOptions) -> Derivatives,
    /// Weighted conditions at dynamic crush, `(weight, multipliers)`.
    pub conditions: Option<(f64, [f64; 2])>,
}

/// `x(t_m)/C - 1` and `v(t_m)/v0` of a model at the time of dynamic crush of the options: zero where the side
/// conditions are met. `None` without a response.
pub fn conditions_at_crush(model: &Nonlinear1, options: &SingleMassFitOptions) -> Option<[f64; 2]> {
    at_crush(&Model::Nonlinear1(*model), options)
}

/// The same for a model of either kind.
fn at_crush(model: &Model, options: &SingleMassFitOptions) -> Option<[f64; 2]> {
    let (v0, t) = (options.impact_speed_m_per_s, options.time_of_dynamic_crush_s);
    let motion = model.respond(v0, t, 2).ok()?;
    let compartment = motion.compartment();
    Some([compartment.displacement_m[1] / options.crush_m - 1.0, compartment.velocity_m_per_s[1] / v0])
}

impl<F: Fn(&[f64]) -> Option<Model> + Sync> Response for Displacements<'_, F> {
    /// One residual for each sample, and two for the conditions where they are set.
    fn rows(&self) -> usize {
        self.window.samples.len() + if self.conditions.is_some() { 2 } else { 0 }
    }

    /// `(x(t_k) - s_k)/C`, then the weighted conditions.
    fn residuals(&self, theta: &[f64], out: &mut [f64]) -> bool {
        let Some(model) = (self.model)(theta) else { return false };
        let n = self.window.samples.len();
        let v0 = self.options.impact_speed_m_per_s;
        let (first, dt) = (self.window.first_s, self.window.dt_s);
        let done = match &model {
            Model::Nonlinear1(m) => m.displacement(v0, first, dt, &mut out[..n]),
            Model::Nonlinear2(m) => m.displacement(v0, first, dt, &mut out[..n]),
            _ => return false,
        };
        if done.is_err() {
            return false;
        }
        for (x, s) in out[..n].iter_mut().zip(&self.window.samples) {
            *x = (*x - s) / self.options.crush_m;
        }
        if let Some((weight, multipliers)) = self.conditions {
            let Some(conditions) = at_crush(&model, self.options) else { return false };
            for j in 0..2 {
                out[n + j] = weight.sqrt() * (conditions[j] + multipliers[j] / weight);
            }
        }
        out.iter().all(|x| x.is_finite())
    }

    /// Derivatives of both by each coordinate, from the analytic sensitivities of the model; places of the mass and
    /// of the last knots are left out.
    fn sensitivities(&self, theta: &[f64], out: &mut DMatrix<f64>) -> bool {
        let Some(model) = (self.model)(theta) else { return false };
        let derivatives = (self.derivatives)(theta, self.options);
        let places: Vec<usize> = (1..model.kind().parameter_names().len() - 2).collect();
        let n = self.window.samples.len();
        let v0 = self.options.impact_speed_m_per_s;
        let at = Instants { first_s: self.window.first_s, dt_s: self.window.dt_s, samples: n };
        let Ok(response) = model.sensitivity(v0, &at, &places) else { return false };
        for (j, by) in derivatives.iter().enumerate() {
            out.column_mut(j).fill(0.0);
            for (place, factor) in by {
                let scale = factor / self.options.crush_m;
                for (k, d) in response.derivatives[place - 1][0].displacement_m.iter().enumerate() {
                    out[(k, j)] += scale * d;
                }
            }
        }
        if let Some((weight, _)) = self.conditions {
            let at = Instants { first_s: self.options.time_of_dynamic_crush_s, dt_s: self.window.dt_s, samples: 1 };
            let Ok(response) = model.sensitivity(v0, &at, &places) else { return false };
            for (j, (place, factor)) in
                derivatives.iter().enumerate().flat_map(|(j, by)| by.iter().map(move |b| (j, b)))
            {
                let motion = &response.derivatives[place - 1][0];
                out[(n, j)] += weight.sqrt() * factor * motion.displacement_m[0] / self.options.crush_m;
                out[(n + 1, j)] += weight.sqrt() * factor * motion.velocity_m_per_s[0] / v0;
            }
        }
        true
    }
}

/// Derivatives of the second model: each coordinate moves one parameter; the two damper knots may stand in either
/// order.
pub(crate) fn derivatives2(theta: &[f64], options: &SingleMassFitOptions) -> Derivatives {
    let (spring, damper) = options.units();
    let (crush, v0) = (options.crush_m, options.impact_speed_m_per_s);
    let mut places = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10];
    if theta[8] > theta[9] {
        places.swap(5, 6);
        places.swap(8, 9);
    }
    let factors = [spring, spring, spring, crush, damper, damper, damper, damper, v0, v0];
    places.into_iter().zip(factors).map(|by| vec![by]).collect()
}

/// Derivatives of the first model, whose coefficients are sums of parts: a part moves every coefficient it is in.
pub(crate) fn derivatives1(_: &[f64], options: &SingleMassFitOptions) -> Derivatives {
    let (k, c) = options.units();
    vec![
        vec![(1, k), (2, k)],
        vec![(2, k)],
        vec![(3, c)],
        vec![(3, c), (4, c)],
        vec![(3, c), (4, c), (5, c)],
        vec![(6, options.impact_speed_m_per_s)],
    ]
}
