//! The fit: a start moved to the minimum of its misfit as measured.
//!
//! A record went through a filter and two sums, which change its displacement by some 1e-5 m at contact; a fit that
//! does not repeat them attributes that to springs and dampers. So the model goes through the same steps at every
//! evaluation. Searches, which only have to lead to a start, compare the motion itself; where the steps are not known,
//! the fit does so too.

use crumple_lumped::{DoubleSpringMassDamper, Model};
use crumple_numerics::estimation::minimise::levenberg_marquardt::{Bounds, Optimum, Response, derivatives, descend};
use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::candidate::Minimum;
use crate::coordinates::Coordinates;
use crate::fit::problem::Problem;
use crate::fit::search::{WORTH_A_RESTART, weakest_direction};
use crate::parameters::{FitParameter, Map};
use crate::record::observation::Observation;

/// Relative residual below which the model is exact: rounding of a response of size one through filter and
/// integration.
const EXACT: f64 = 1e-10;
/// Steps in the coordinates along the weakest direction, from which the descent starts once more.
const RESTARTS: [f64; 4] = [-0.3, 0.3, -LEAST_RESTART, LEAST_RESTART];
const LEAST_RESTART: f64 = 0.05;
/// A minimum whose cost rises by so many times itself over the least restart, as its sensitivities say, has no valley
/// in which a lower one could lie.
const SHARP: f64 = 10.0;
/// Steps in which a restart has to come lower: those after which a descent is asked whether it gets anywhere.
const STEPS_OF_A_RESTART: u32 = Bounds::SLOW_STEPS;
/// A model that agrees with its dual to this share is its own dual. The error is flat to fourth order there, so a
/// search to 1e-16 leaves that much.
const OWN_DUAL: f64 = 1e-4;

/// Descends from `model` to the least misfit with all parameters of `free` moving.
///
/// Bounded Levenberg-Marquardt in the coordinates of the fit parameters on analytic sensitivities through sampling,
/// filter and integration. Then descents from both sides of the minimum along the direction in which the misfit rises
/// least, of which the first that lowers the cost by 0.1 % within 20 steps is followed; none where the misfit is below
/// the resolution of the record.
///
/// A parameter that comes near zero, or leaves it, changes its coordinate (logarithm or share of its scale) and the
/// descent goes on. Local: the result depends on the start. `None` where the model has no finite response.
pub fn fit_as_measured(model: &Model, free: &[FitParameter], observed: &Observation) -> Option<Minimum> {
    // The coordinates first: a restart in ones that are to change would be for nothing.
    let minimum = descend_with_restarts(model, free, observed, Restarts::WithCoordinatesThatStay)?;
    let Some(redescribed) = redescribed(free, &minimum.model) else { return Some(minimum) };
    let next = descend_with_restarts(&minimum.model, &redescribed, observed, Restarts::Always)?;
    Some(Minimum {
        evaluations: minimum.evaluations + next.evaluations,
        iterations: minimum.iterations + next.iterations,
        ..next
    })
}

/// The free parameters as they are described at this model; `None` where all keep their kind of coordinate.
fn redescribed(free: &[FitParameter], model: &Model) -> Option<Vec<FitParameter>> {
    let values = model.values();
    let there: Vec<FitParameter> = free.iter().map(|p| p.described_at(values[p.index])).collect();
    there.iter().zip(free).any(|(new, old)| new.is_logarithmic() != old.is_logarithmic()).then_some(there)
}

/// When a descent is followed by restarts from its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Restarts {
    /// Whatever the end.
    Always,
    /// Where no parameter changes its coordinate there.
    WithCoordinatesThatStay,
}

/// The minimum near a start that is close already, by one descent; else as [`fit_as_measured`].
pub(crate) fn fit_nearby(model: &Model, free: &[FitParameter], observed: &Observation) -> Option<Minimum> {
    let coordinates = Coordinates::near(model.clone(), free.to_vec());
    let problem = near(&coordinates, observed);
    let best = problem.follow(&coordinates.start())?;
    finish(&problem, &best, best.evaluations)
}

/// One descent and the restarts from its end, with coordinates fixed to those of `free`.
fn descend_with_restarts(
    model: &Model,
    free: &[FitParameter],
    observed: &Observation,
    restarts: Restarts,
) -> Option<Minimum> {
    let coordinates = Coordinates::near(model.clone(), free.to_vec());
    let problem = near(&coordinates, observed);
    let mut best = problem.follow(&coordinates.start())?;
    let mut evaluations = best.evaluations;
    let stays = redescribed(free, &coordinates.model(&best.theta)?).is_none();
    // Below the resolution no other minimum can be told to be better, nor below what an accelerometer can tell.
    let ends = best.cost <= observed.unresolved().max(problem.fine()) || best.on_bound.iter().any(|on_bound| *on_bound);
    let hardly_rises = |weak: &Vec<f64>| {
        let step = DMatrix::from_column_slice(weak.len(), 1, weak) * LEAST_RESTART;
        (&best.r * step).norm_squared() <= SHARP * best.cost
    };
    let weak = weakest_direction(&best).filter(hardly_rises);
    if let Some(weak) = weak.filter(|_| !ends && (stays || restarts == Restarts::Always)) {
        let restart =
            Bounds { cost_tolerance: WORTH_A_RESTART, max_iterations: STEPS_OF_A_RESTART, ..problem.bounds() };
        let on_motion = problem.on_motion();
        let restarted: Vec<Optimum> = RESTARTS
            .par_iter()
            .filter_map(|size| {
                let start: Vec<f64> = best.theta.iter().zip(&weak).map(|(t, w)| t + size * w).collect();
                descend(&on_motion, &start, &restart)
            })
            .collect();
        evaluations += restarted.iter().map(|minimum| minimum.evaluations).sum::<u64>();
        let lower = restarted.into_iter().find(|minimum| minimum.cost < (1.0 - WORTH_A_RESTART) * best.cost);
        if let Some(minimum) = lower.and_then(|minimum| problem.follow(&minimum.theta)) {
            evaluations += minimum.evaluations;
            best = minimum;
        }
    }
    finish(&problem, &best, evaluations)
}

/// The fit near a minimum, for repetitions of it: one descent without restarts.
pub(crate) fn near<'a>(coordinates: &'a Coordinates, observed: &'a Observation) -> Problem<'a> {
    Problem::new(coordinates, observed, EXACT)
}

/// The minimum with misfit and sensitivities at every sample, in the unit of the first wave.
pub(crate) fn finish(problem: &Problem<'_>, best: &Optimum, evaluations: u64) -> Option<Minimum> {
    let model = problem.coordinates.model(&best.theta)?;
    let misfit_m = problem.misfit(&best.theta)?;
    let sensitivity_m = derivatives(problem, &best.theta)? * problem.unit;
    Some(Minimum {
        model,
        free: problem.coordinates.free.clone(),
        rest: problem.coordinates.rest,
        on_bound: best.on_bound.clone(),
        observed: problem.observed.clone(),
        misfit_m,
        sensitivity_m,
        evaluations,
        iterations: best.iterations,
        stop_reason: best.stop,
    })
}

/// Whether a double model agrees with its dual to [`OWN_DUAL`].
pub(crate) fn is_own_dual(model: &Model) -> bool {
    let Model::DoubleSpringMassDamper(own) = model else { return false };
    let near = |(a, b): (&f64, &f64)| (a - b).abs() <= OWN_DUAL * a.abs().max(b.abs());
    model.values().iter().zip(&Model::DoubleSpringMassDamper(own.dual()).values()).all(near)
}

/// The minimum at the dual of a double model, which moves the compartment alike: the same misfit, with the
/// sensitivities of its own parameters. `None` without a finite response.
pub(crate) fn dual_of(minimum: &Minimum, dual: &DoubleSpringMassDamper) -> Option<Minimum> {
    let template = Model::DoubleSpringMassDamper(*dual);
    let (names, values) = (template.names(), template.values());
    let of_dual = |(p, on_bound): (&FitParameter, &bool)| {
        let index = names.iter().position(|name| *name == exchanged(&p.name)).unwrap_or(p.index);
        let (name, value) = (names[index].clone(), values[index]);
        let map = if p.is_logarithmic() { Map::Logarithm(value) } else { p.map };
        let limit = p.limit.max(value);
        (FitParameter { name, index, limit, ..p.clone() }.with_map(map), *on_bound)
    };
    let mut free: Vec<(FitParameter, bool)> = minimum.free.iter().zip(&minimum.on_bound).map(of_dual).collect();
    free.sort_by_key(|(p, _)| p.index);
    let (free, on_bound): (Vec<_>, Vec<_>) = free.into_iter().unzip();
    let coordinates = Coordinates::near(template, free);
    let best = Optimum {
        theta: coordinates.start(),
        cost: 0.0,
        r: DMatrix::zeros(0, 0),
        on_bound,
        iterations: minimum.iterations,
        evaluations: minimum.evaluations,
        stop: minimum.stop_reason,
    };
    finish(&near(&coordinates, &minimum.observed), &best, minimum.evaluations)
}

/// The parameter of the dual that follows from this one: it exchanges front and rear.
pub(crate) fn exchanged(name: &str) -> &str {
    match name {
        "k1_n_per_m" => "k2_n_per_m",
        "k2_n_per_m" => "k1_n_per_m",
        "c1_n_s_per_m" => "c2_n_s_per_m",
        "c2_n_s_per_m" => "c1_n_s_per_m",
        name => name,
    }
}

#[cfg(test)]
mod tests {
    use crumple_lumped::{DoubleSpringMassDamper, Elastoplastic, Nonlinear2};
    use crumple_numerics::estimation::minimise::levenberg_marquardt::Response;
    use crumple_signal::{Displacement, IntegrationRule, Measurement, Signal, TwoPassFilter};

    use super::*;
    use crate::parameters::{free_masses, free_parameters};
    use crate::record::measured_motion::MeasureModel;
    use nalgebra::DVector;

    /// CFC 60 at 10 kHz.
    const FILTER: TwoPassFilter = TwoPassFilter {
        coefficients: [0.001_460_3, 0.002_920_6, 0.001_460_3, 1.889_033_6, -0.894_874_8],
        samples_added: 100,
    };

    /// The derivative of the residuals by coordinate `j` from a central difference: off by a third of the squared step
    /// times the third derivative, and rounding over the step, both near 1e-10.
    fn central_difference(problem: &impl Response, theta: &[f64], j: usize) -> DVector<f64> {
        let at = |step: f64| {
            let (mut moved, mut residuals) = (theta.to_vec(), vec![0.0; problem.rows()]);
            moved[j] += step;
            assert!(problem.residuals(&moved, &mut residuals));
            DVector::from_vec(residuals)
        };
        (at(1e-5) - at(-1e-5)) / 2e-5
    }

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
                rule: Some(IntegrationRule::Trapezoid),
                before_event: None,
            };
            let x = measurement.displacement(model, 13.0, 1199).unwrap();
            let x = Signal::<Displacement>::new(-0.010_03, 1e-4, x.iter().map(|x| 1.01 * x).collect()).unwrap();
            let observed = Observation::new(&x, measurement, 13.0, (0.0, 0.09), 250).unwrap();
            let mut free = free_parameters(model, 13.0, 0.7);
            if matches!(model, Model::DoubleSpringMassDamper(_)) {
                free.extend(free_masses(model, (0.05, 0.6)));
            }
            let coordinates = Coordinates::near(model.clone(), free);
            let problem = near(&coordinates, &observed);
            let theta = coordinates.start();
            let mut analytic = DMatrix::zeros(observed.rows(), theta.len());
            assert!(problem.sensitivities(&theta, &mut analytic));
            for (j, a) in analytic.column_iter().enumerate() {
                let b = &central_difference(&problem, &theta, j);
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
