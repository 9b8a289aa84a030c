//! A fitted model moved to the minimum of its misfit as measured: what replaces a fit made without the filter.
//!
//! The other fits of this room compare the motion itself, which is quick and has closed forms. The record went
//! through a filter and two sums, which change its displacement by some 1e-5 m at contact; a fit that does not repeat
//! them attributes that to springs and dampers.

use crumple_lumped::Model;
use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::fit::multistart::weakest_direction;
use crate::fit::observed_problem::Problem;
use crate::free::free_parameter::FreeParameter;
use crate::record::observation::Observation;
use crumple_estimation::minimise::StopReason;
use crumple_estimation::minimise::levenberg_marquardt::{Bounds, Optimum, derivatives, descend};

/// A model at the minimum of its misfit, with the sensitivities there. Metres stand for the unit of the first wave.
#[derive(Debug, Clone)]
pub struct Refined {
    /// The model.
    pub model: Model,
    /// Its free parameters; the values are those of the minimum.
    pub free: Vec<FreeParameter>,
    /// Which of them stopped on a bound.
    pub on_bound: Vec<bool>,
    /// Model minus record, m.
    pub misfit_m: Vec<f64>,
    /// Change of the displacement by each free parameter's coordinate, m; columns as `free`.
    pub sensitivity_m: DMatrix<f64>,
    /// Model evaluations spent.
    pub evaluations: u64,
    /// Iterations.
    pub iterations: u32,
    /// Why it stopped.
    pub stop_reason: StopReason,
}

/// Iterations of one descent at most.
const ITERATIONS: u32 = 200;
/// Relative decrease of the cost that is worth another step: over 250 samples it moves a parameter by `sqrt(250e-7)`,
/// 0.5 % of its standard deviation.
const COST_TOLERANCE: f64 = 1e-7;
/// Steps in the coordinates along the weakest direction, from which the descent starts once more.
const HOPS: [f64; 4] = [-0.3, 0.3, -0.05, 0.05];
/// Relative decrease of the cost for which a hop is worth following.
const WORTH_A_HOP: f64 = 1e-3;

impl Refined {
    /// Root mean square misfit, m.
    pub fn rmse_m(&self) -> f64 {
        (self.misfit_m.iter().map(|r| r * r).sum::<f64>() / self.misfit_m.len() as f64).sqrt()
    }
}

/// Descends from `model` to the least misfit with all parameters of `free` moving.
///
/// Bounded Levenberg-Marquardt in the coordinates of [`FreeParameter`] on analytic sensitivities through sampling,
/// filter and integration. Then descents from both sides of the minimum along the direction in which the misfit rises
/// least, at most three times, as long as the cost falls by 0.1 % and the misfit is above the resolution of the
/// record.
///
/// A parameter that comes near zero, or leaves it, changes its coordinate (logarithm or share of its scale) and the
/// descent goes on. Local: the result depends on the start. `None` where the model has no finite response.
pub fn refine(model: &Model, free: &[FreeParameter], observed: &Observation) -> Option<Refined> {
    let minimum = descend_with_hops(model, free, observed)?;
    let redescribed: Vec<FreeParameter> = minimum.free.iter().map(|p| p.described_at(p.value)).collect();
    if redescribed.iter().zip(free).all(|(new, old)| new.logarithmic == old.logarithmic) {
        return Some(minimum);
    }
    let next = descend_with_hops(&minimum.model, &redescribed, observed)?;
    Some(Refined {
        evaluations: minimum.evaluations + next.evaluations,
        iterations: minimum.iterations + next.iterations,
        ..next
    })
}

/// One descent and the hops from its end, with coordinates fixed to those of `free`.
fn descend_with_hops(model: &Model, free: &[FreeParameter], observed: &Observation) -> Option<Refined> {
    let problem = Problem::new(*model, free.to_vec(), observed);
    let mut best = descend(&problem, &problem.start(), &bounds(free))?;
    let mut evaluations = best.evaluations;
    for _ in 0..3 {
        // Below the resolution no other minimum can be told to be better.
        if best.cost <= observed.unresolved() || best.on_bound.iter().any(|on_bound| *on_bound) {
            break;
        }
        let Some(weak) = weakest_direction(&best) else { break };
        let hopped: Vec<Optimum> = HOPS
            .par_iter()
            .filter_map(|hop| {
                let start: Vec<f64> = best.theta.iter().zip(&weak).map(|(t, w)| t + hop * w).collect();
                descend(&problem, &start, &Bounds { cost_tolerance: WORTH_A_HOP, ..bounds(free) })
            })
            .collect();
        evaluations += hopped.iter().map(|minimum| minimum.evaluations).sum::<u64>();
        let Some(minimum) = hopped.into_iter().find(|minimum| minimum.cost < (1.0 - WORTH_A_HOP) * best.cost) else {
            break;
        };
        let Some(minimum) = descend(&problem, &minimum.theta, &bounds(free)) else { break };
        evaluations += minimum.evaluations;
        best = minimum;
    }
    finish(&problem, best, evaluations)
}

/// The same without hops, from the coordinates `start`: for many repetitions near a minimum.
pub(crate) fn follow(problem: &Problem<'_>, start: &[f64]) -> Option<Optimum> {
    descend(problem, start, &bounds(&problem.free))
}

/// Bounds of these parameters in their coordinates.
pub(crate) fn bounds(free: &[FreeParameter]) -> Bounds {
    Bounds {
        lower: free.iter().map(|p| p.bounds().0).collect(),
        upper: free.iter().map(|p| p.bounds().1).collect(),
        max_iterations: ITERATIONS,
        cost_tolerance: COST_TOLERANCE,
    }
}

/// The minimum with misfit and sensitivities at every sample, in the unit of the first wave.
fn finish(problem: &Problem<'_>, best: Optimum, evaluations: u64) -> Option<Refined> {
    let model = problem.model(&best.theta)?;
    let misfit_m = problem.observed.misfit(&model)?;
    let sensitivity_m = derivatives(problem, &best.theta, &bounds(&problem.free))? * problem.unit_m;
    let values = model.parameters();
    let free = problem.free.iter().map(|p| FreeParameter { value: values[p.name], ..*p }).collect();
    // `unit` stays that of the start: a logarithm's derivative does not depend on it.
    Some(Refined {
        model,
        free,
        on_bound: best.on_bound,
        misfit_m,
        sensitivity_m,
        evaluations,
        iterations: best.iterations,
        stop_reason: best.stop,
    })
}

#[cfg(test)]
mod tests {
    use crumple_lumped::{DoubleSpringMassDamper, Elastoplastic, Nonlinear2};
    use crumple_signal::{Displacement, Signal};

    use super::*;
    use crate::free::free_parameter::free_masses;
    use crate::{IntegrationRule, Measurement, TwoPassFilter, free_parameters};
    use crumple_estimation::minimise::levenberg_marquardt::{Response, central_differences};

    /// CFC 60 at 10 kHz.
    const FILTER: TwoPassFilter = TwoPassFilter {
        coefficients: [0.001_460_3, 0.002_920_6, 0.001_460_3, 1.889_033_6, -0.894_874_8],
        samples_added: 100,
    };

    #[test]
    fn derivatives_seen_through_the_filter_are_the_limits_of_differences() {
        let models = [
            Model::DoubleSpringMassDamper(DoubleSpringMassDamper {
                m1_kg: 300.0,
                m2_kg: 900.0,
                k1_n_per_m: 5e5,
                k2_n_per_m: 8e5,
                c1_n_s_per_m: 9e3,
                c2_n_s_per_m: 5e3,
            }),
            Model::Elastoplastic(Elastoplastic {
                mass_kg: 1200.0,
                loading_stiffness_n_per_m: 5e5,
                unloading_stiffness_n_per_m: 2e7,
                release: true,
            }),
            Model::Nonlinear2(Nonlinear2 {
                mass_kg: 1200.0,
                k1_n_per_m: 8e4,
                k2_n_per_m: 1e5,
                k3_n_per_m: 2.5e5,
                x1_m: 0.5,
                c1_n_s_per_m: 8e4,
                c2_n_s_per_m: 6e4,
                c3_n_s_per_m: 2e4,
                c4_n_s_per_m: 2e3,
                v1_m_per_s: 3.0,
                v2_m_per_s: 7.0,
                crush_m: 0.7,
                v0_m_per_s: 13.0,
            }),
        ];
        for (from_contact, model) in models.iter().flat_map(|model| [(false, model), (true, model)]) {
            let measurement = Measurement {
                dt_s: 1e-4,
                // Contact between two samples.
                first_s: -0.010_03,
                samples: 1200,
                filter: Some(FILTER),
                from_contact,
                rule: IntegrationRule::Trapezoid,
            };
            let x = measurement.displacement(model, 13.0, 1199).unwrap();
            let x = Signal::<Displacement>::new(-0.010_03, 1e-4, x.iter().map(|x| 1.01 * x).collect()).unwrap();
            let observed = Observation::new(&x, 0.0, measurement, 13.0, (0.0, 0.09), 250).unwrap();
            let mut free = free_parameters(model, 13.0, 0.7, true);
            if matches!(model, Model::DoubleSpringMassDamper(_)) {
                free.extend(free_masses(model, (0.05, 0.6)));
            }
            let problem = Problem::new(*model, free, &observed);
            let theta = problem.start();
            let mut analytic = DMatrix::zeros(observed.rows(), theta.len());
            assert_eq!(problem.sensitivities(&theta, &mut analytic), Some(true));
            let by_differences = central_differences(&problem, &theta, &bounds(&problem.free)).unwrap();
            for (j, (a, b)) in analytic.column_iter().zip(by_differences.column_iter()).enumerate() {
                // Square of the step times the third derivative, rounding over the step, and samples that a kink of the
                // acceleration crosses within the step.
                assert!(
                    (a - b).norm() <= 1e-5 * b.norm(),
                    "{} {j}: {:e} of {:e}",
                    model.kind(),
                    (a - b).norm(),
                    b.norm()
                );
            }
        }
    }
}
