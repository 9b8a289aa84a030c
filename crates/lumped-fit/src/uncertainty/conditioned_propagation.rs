//! Uncertain inputs of the first nonlinear model under its side conditions: the same constrained fit to a changed
//! record.

use std::collections::BTreeMap;

use crumple_lumped::{Instants, Model, Nonlinear1, ParameterKind};
use nalgebra::DMatrix;

use crate::Observation;
use crate::record::observation::ObservedWave;
use crate::uncertainty::closed_form_propagation::FollowedEvents;
use crate::uncertainty::propagation::{InputUncertainty, Propagation, Repetition, over_repetitions, with_errors};
use crumple_estimation::minimise::levenberg_marquardt::{Bounds, Response, descend};

/// Rounds of the augmented Lagrangian.
const ROUNDS: usize = 12;
/// Relative violation of the conditions on crush and speed at which they are met.
const MET: f64 = 1e-8;
/// Places of the parameters that are free: all but the mass and the last knots.
const PLACES: [usize; 6] = [1, 2, 3, 4, 5, 6];

/// Repeats the fit of the first nonlinear model under `k1 <= k2`, `c1 >= c2 >= c3`, `x(t_m) = C` and `v(t_m) = 0`
/// with uncertain inputs, and takes percentiles.
///
/// The estimator of [`fit_nonlinear1`](crate::fit_nonlinear1): crush, its time and the last knots are those of each
/// repetition's record, and the displacement is compared without the filter. Every repetition descends from `model`.
/// With time zero more than 0.25 ms off, another start of the fit could win: the spread is then that of one minimum
/// and too small.
///
/// `events`, `whole`: as for [`propagate_closed_form`](crate::propagate_closed_form); `observed`: the samples
/// compared. A repetition that cannot meet the conditions is not counted. `None` with fewer than 20 results.
pub fn propagate_conditioned(
    model: &Nonlinear1,
    events: &FollowedEvents,
    (observed, whole): (&Observation, &Observation),
    mass_kg: f64,
    inputs: &InputUncertainty,
    repetitions: usize,
) -> Option<Propagation> {
    over_repetitions(mass_kg, inputs, (repetitions, 1), |errors| {
        let moved = events.moved(whole, &with_errors(whole, errors)?.observed)?;
        repeat_conditioned(model, &moved, &with_errors(observed, errors)?)
    })
}

/// One repetition: the parameters scaled to the mass drawn, and the dynamic crush of the model, m. `None` where the
/// conditions are not met after [`ROUNDS`].
fn repeat_conditioned(
    model: &Nonlinear1,
    events: &FollowedEvents,
    repetition: &Repetition,
) -> Option<BTreeMap<String, f64>> {
    let record = repetition.observed.waves.first()?;
    let v0 = repetition.observed.impact_speed_m_per_s;
    let crush = events.dynamic_crush_m;
    let n = record.samples.len();
    let rate = v0 / crush;
    let mut problem = Conditioned {
        record,
        impact_speed_m_per_s: v0,
        events,
        spring: model.mass_kg * rate * rate,
        damper: model.mass_kg * rate,
        mass_kg: model.mass_kg,
        weight: n as f64,
        multipliers: [0.0; 2],
    };
    let (k, c) = (problem.spring, problem.damper);
    let mut theta = vec![
        model.k1_n_per_m / k,
        (model.k2_n_per_m - model.k1_n_per_m) / k,
        (model.c1_n_s_per_m - model.c2_n_s_per_m) / c,
        (model.c2_n_s_per_m - model.c3_n_s_per_m) / c,
        model.c3_n_s_per_m / c,
        model.v_thresh_m_per_s / v0,
    ];
    let mut bounds = Bounds { lower: vec![0.0; 6], upper: vec![1e3; 6], max_iterations: 120, cost_tolerance: 1e-7 };
    (bounds.lower[5], bounds.upper[5]) = (0.005, 0.995);
    let mut met = false;
    for _ in 0..ROUNDS {
        theta = descend(&problem, &theta, &bounds)?.theta;
        let conditions = problem.at_crush(&problem.model(&theta)?)?;
        met = conditions.iter().all(|c| c.abs() <= MET);
        if met {
            break;
        }
        for (multiplier, condition) in problem.multipliers.iter_mut().zip(conditions) {
            *multiplier += problem.weight * condition;
        }
        problem.weight = (problem.weight * 4.0).min(1e8);
    }
    if !met {
        return None;
    }
    let fitted = Model::Nonlinear1(problem.model(&theta)?);
    let values = fitted.parameters();
    let scaled = |&place: &usize| {
        let parameter = &fitted.kind().parameters()[place];
        let ratio = if parameter.kind == ParameterKind::Rate { 1.0 } else { repetition.mass_ratio };
        (parameter.name.to_owned(), values[parameter.name] * ratio)
    };
    let mut result: BTreeMap<String, f64> = PLACES.iter().map(scaled).collect();
    if let Some(crush) = fitted.events(v0).ok().and_then(|events| events.dynamic_crush_m) {
        result.insert("dynamic_crush_m".to_owned(), crush);
    }
    Some(result)
}

/// Residuals of one repetition: displacements in units of the crush, then the two weighted conditions of the
/// augmented Lagrangian. Coefficients are sums of parts that are not negative, which keeps their order.
struct Conditioned<'a> {
    /// The changed record.
    record: &'a ObservedWave,
    impact_speed_m_per_s: f64,
    /// Its events.
    events: &'a FollowedEvents,
    /// Unit of springs, N/m: `m (v0/C)²`.
    spring: f64,
    /// Unit of dampers, N·s/m: `m v0/C`.
    damper: f64,
    mass_kg: f64,
    /// Weight and multipliers of the augmented Lagrangian.
    weight: f64,
    multipliers: [f64; 2],
}

impl Conditioned<'_> {
    /// The model at a point; `None` if it is not physical.
    fn model(&self, theta: &[f64]) -> Option<Nonlinear1> {
        let v0 = self.impact_speed_m_per_s;
        let model = Nonlinear1 {
            mass_kg: self.mass_kg,
            k1_n_per_m: theta[0] * self.spring,
            k2_n_per_m: (theta[0] + theta[1]) * self.spring,
            c1_n_s_per_m: (theta[2] + theta[3] + theta[4]) * self.damper,
            c2_n_s_per_m: (theta[3] + theta[4]) * self.damper,
            c3_n_s_per_m: theta[4] * self.damper,
            v_thresh_m_per_s: theta[5] * v0,
            crush_m: self.events.dynamic_crush_m,
            v0_m_per_s: v0,
        };
        model.check().is_ok().then_some(model)
    }

    /// The instants of the samples that are compared.
    fn instants(&self) -> Instants {
        let m = &self.record.measurement;
        Instants {
            first_s: self.record.time_s(0).max(0.0),
            dt_s: m.dt_s * self.record.stride as f64,
            samples: self.record.samples.len(),
        }
    }

    /// The instant of dynamic crush.
    fn stop(&self) -> Instants {
        Instants { first_s: self.events.time_of_dynamic_crush_s, dt_s: self.record.measurement.dt_s, samples: 1 }
    }

    /// `x(t_m)/C - 1` and `v(t_m)/v0`.
    fn at_crush(&self, model: &Nonlinear1) -> Option<[f64; 2]> {
        let v0 = self.impact_speed_m_per_s;
        let response = Model::Nonlinear1(*model).sensitivity(v0, &self.stop(), &[]).ok()?;
        let motion = response.motions.first()?;
        Some([motion.displacement_m[0] / self.events.dynamic_crush_m - 1.0, motion.velocity_m_per_s[0] / v0])
    }

    /// For each coordinate the places of the parameters that it moves, and their derivatives by it.
    fn derivatives(&self) -> [Vec<(usize, f64)>; 6] {
        let (k, c) = (self.spring, self.damper);
        [
            vec![(1, k), (2, k)],
            vec![(2, k)],
            vec![(3, c)],
            vec![(3, c), (4, c)],
            vec![(3, c), (4, c), (5, c)],
            vec![(6, self.impact_speed_m_per_s)],
        ]
    }
}

impl Response for Conditioned<'_> {
    /// One residual for each sample, and two for the conditions.
    fn rows(&self) -> usize {
        self.record.samples.len() + 2
    }

    /// `(x(t_k) - s_k)/C`, then `sqrt(w) (c_j + y_j/w)`.
    fn residuals(&self, theta: &[f64], out: &mut [f64]) -> bool {
        let Some(model) = self.model(theta) else { return false };
        let v0 = self.impact_speed_m_per_s;
        let n = self.record.samples.len();
        let at = self.instants();
        if model.displacement(v0, at.first_s, at.dt_s, &mut out[..n]).is_err() {
            return false;
        }
        for (x, s) in out[..n].iter_mut().zip(&self.record.samples) {
            *x = (*x - s) / self.events.dynamic_crush_m;
        }
        let Some(conditions) = self.at_crush(&model) else { return false };
        for j in 0..2 {
            out[n + j] = self.weight.sqrt() * (conditions[j] + self.multipliers[j] / self.weight);
        }
        out.iter().all(|x| x.is_finite())
    }

    /// Derivatives of both by each coordinate.
    fn sensitivities(&self, theta: &[f64], out: &mut DMatrix<f64>) -> Option<bool> {
        let Some(model) = self.model(theta).map(Model::Nonlinear1) else { return Some(false) };
        let (v0, crush) = (self.impact_speed_m_per_s, self.events.dynamic_crush_m);
        let n = self.record.samples.len();
        let Ok(response) = model.sensitivity(v0, &self.instants(), &PLACES) else { return Some(false) };
        let Ok(stop) = model.sensitivity(v0, &self.stop(), &PLACES) else { return Some(false) };
        let weight = self.weight.sqrt();
        for (j, by) in self.derivatives().iter().enumerate() {
            out.column_mut(j).fill(0.0);
            for (place, factor) in by {
                for (k, d) in response.derivatives[place - 1][0].displacement_m.iter().enumerate() {
                    out[(k, j)] += factor * d / crush;
                }
                let motion = &stop.derivatives[place - 1][0];
                out[(n, j)] += weight * factor * motion.displacement_m[0] / crush;
                out[(n + 1, j)] += weight * factor * motion.velocity_m_per_s[0] / v0;
            }
        }
        Some(true)
    }
}
