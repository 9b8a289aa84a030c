//! Minima of a fit to sensors as candidates, with errors of each sensor, bounds and duals.

use crumple_lumped::{DoubleSpringMassDamper, Model};
use crumple_signal::Notes;

use crate::candidate::linearised::uncertainty;
use crate::candidate::note::{CandidateNote, infos};
use crate::fit::descents::{AS_GOOD, REPORTED};
use crate::fit::sensors::fit::Fitted;
use crate::fit::sensors::problem::{SensorProblem, SensorWindow};
use crate::free::model_coordinates::ModelCoordinates;
use crate::free::parameterisation::Parameterisation;
use crate::solvers::task::Task;
use crate::{Candidate, Fit, Sensor, SensorFit, bounds_remark, errors_in_words, note_of_errors};
use crumple_estimation::minimise::levenberg_marquardt::{Optimum, Response};

/// The note on the side constraints of the single-mass paper that a first nonlinear model breaks: this fit has bounds
/// only.
fn broken_side_constraints(model: &Model) -> Option<String> {
    let Model::Nonlinear1(m) = model else { return None };
    let broken: Vec<&str> = [
        (m.k1_n_per_m > m.k2_n_per_m, "k1 <= k2"),
        (m.c1_n_s_per_m < m.c2_n_s_per_m, "c1 >= c2"),
        (m.c2_n_s_per_m < m.c3_n_s_per_m, "c2 >= c3"),
    ]
    .into_iter()
    .filter_map(|(broken, constraint)| broken.then_some(constraint))
    .collect();
    (!broken.is_empty()).then(|| {
        format!(
            "breaks the side constraints of the paper, {}, which this fit does not know: direct-fit and interior-point \
             to the displacement of the pulse keep them",
            broken.join(" and ")
        )
    })
}

/// The minima of a fit and what they were fitted to.
pub(super) struct Report<'a> {
    /// What was asked for.
    pub task: &'a Task<'a>,
    /// The free parameters of the model.
    pub coordinates: &'a ModelCoordinates,
    /// The sensors, each with the index of its mass.
    pub sensors: &'a [(usize, Sensor<'a>)],
    /// The minima, with the noise levels of the sensors.
    pub fitted: &'a Fitted,
}

impl<'a> Report<'a> {
    /// The residuals with the noise levels that the fit ended with.
    fn problem(&self) -> SensorProblem<'_, ModelCoordinates> {
        SensorProblem {
            coordinates: self.coordinates,
            impact_speed_m_per_s: self.task.test.impact_speed_m_per_s,
            sensors: &self.fitted.sensors,
        }
    }

    /// Root mean square weighted residual: 1 where every sensor is met to its noise level.
    fn level(&self, minimum: &Optimum) -> f64 {
        (minimum.cost / self.problem().rows() as f64).sqrt()
    }

    /// The error of each sensor in words: `8.1 mm at 93 (compartment)`. `None` without a finite response.
    fn errors(&self, theta: &[f64]) -> Option<String> {
        let rmse = self.problem().rmse(theta)?;
        let sensor_error = |((_, sensor), rmse): (&(usize, Sensor<'a>), f64)| {
            (rmse, sensor.quantity, sensor.channel, sensor.place.to_string())
        };
        Some(errors_in_words(self.sensors.iter().zip(rmse).map(sensor_error)))
    }

    /// A minimum as candidate number `index`, with linearised standard deviations and its notes: `remarks`, window,
    /// errors of the sensors, active bounds, broken side constraints.
    fn candidate(&self, minimum: &Optimum, index: usize, remarks: &[String]) -> Option<Candidate> {
        let problem = self.problem();
        let model = self.coordinates.model(&minimum.theta)?;
        let mut residuals = vec![0.0; problem.rows()];
        if !problem.residuals(&minimum.theta, &mut residuals) {
            return None;
        }
        let rmse = problem.rmse(&minimum.theta)?;
        let names = self.coordinates.names();
        let first = &self.fitted.sensors[0];
        let active_bounds: Vec<_> =
            names.iter().zip(&minimum.on_bound).filter(|(_, on_bound)| **on_bound).map(|(name, _)| *name).collect();
        let mut notes = infos(remarks.to_vec());
        notes.push(CandidateNote::info(format!(
            "fitted to {} from {:.2} ms to {:.2} ms after time zero",
            first.quantity,
            1e3 * first.window.first_s,
            1e3 * first.window.last_s()
        )));
        if self.sensors.len() > 1 {
            notes.push(CandidateNote::sensor_errors(note_of_errors(&self.errors(&minimum.theta)?, None)));
        }
        notes.extend(bounds_remark(&model, &active_bounds).map(CandidateNote::active_bounds));
        notes.extend(broken_side_constraints(&model).map(CandidateNote::warning));
        let sensor_fit =
            |((mass, sensor), (observed, rmse)): (&(usize, Sensor<'_>), (&SensorWindow, &f64))| SensorFit {
                channel: sensor.channel.to_owned(),
                mass: mass + 1,
                quantity: sensor.quantity,
                rmse: *rmse,
                noise: observed.noise,
            };
        // The pulse's displacement is assessed like the special fits of a model, through the filter of the record.
        let plain = self.task.fits_displacement_alone();
        let sensors = self.sensors.iter().zip(self.fitted.sensors.iter().zip(&rmse)).map(sensor_fit);
        Some(Candidate {
            model,
            method: self.task.method,
            index,
            equivalent_to: None,
            fit: Some(Fit {
                from_s: first.window.first_s,
                to_s: first.window.last_s(),
                samples: problem.rows(),
                quantity: first.quantity,
                rmse: rmse[0],
                iterations: minimum.iterations,
                evaluations: self.fitted.evaluations,
                stop_reason: minimum.stop,
                active_bounds,
                sensors: if plain { Vec::new() } else { sensors.collect() },
            }),
            uncertainty: uncertainty(minimum, &residuals, &names, &self.coordinates.factors(&minimum.theta)),
            notes,
        })
    }

    /// Every minimum as good as the best, at most three.
    ///
    /// For the double model with a sensor on the chassis also the minimum that is found from the dual of the best:
    /// the second sensor tells the two apart, and the notes say by how much.
    pub fn candidates(&self, remarks: &[String], notes: &mut Notes) -> Vec<Candidate> {
        let Some(best) = self.fitted.minima.first() else { return Vec::new() };
        let limit = AS_GOOD * self.level(best);
        let mut minima: Vec<Optimum> = self.fitted.minima.iter().filter(|m| self.level(m) <= limit).cloned().collect();
        if minima.len() > 1 {
            notes.warning(format!(
                "{}: {} parameter sets fit within 1 % as well as the best; the record does not determine the \
                 parameters",
                self.task.model,
                minima.len()
            ));
            minima.truncate(REPORTED);
        }
        let mut extra_remarks = vec![Vec::new(); minima.len()];
        if let Some(Model::DoubleSpringMassDamper(model)) = self.coordinates.model(&best.theta) {
            let dual = self.coordinates.theta(&Model::DoubleSpringMassDamper(model.dual()));
            let at_best = self.errors(&best.theta);
            if let (Some(at_dual), Some(at_best)) = (self.errors(&dual), at_best) {
                let text = format!(
                    "the dual model moves the compartment alike, but not the chassis: it misses by {at_dual}, this one \
                     by {at_best}; the second sensor decides, and the two are not equivalent"
                );
                notes.info(format!("{}: {text}", self.task.model));
                extra_remarks[0].push(text);
            }
            // Where the dual leads if it is followed: the second best explanation.
            let settings = crate::fit::descents::bounds(self.coordinates, 200, 1e-15);
            if let Some(followed) =
                crumple_estimation::minimise::levenberg_marquardt::descend(&self.problem(), &dual, &settings)
            {
                let apart = |m: &Optimum| m.theta.iter().zip(&followed.theta).any(|(a, b)| (a - b).abs() > 0.01);
                if minima.iter().all(apart) {
                    extra_remarks.push(vec![format!(
                        "followed from the dual of the first: weighted error {:.3} times that of the first, not \
                         equivalent",
                        self.level(&followed) / self.level(best).max(f64::MIN_POSITIVE)
                    )]);
                    minima.push(followed);
                }
            }
        }
        let all = minima.iter().zip(extra_remarks).enumerate();
        all.filter_map(|(k, (minimum, extra_remarks))| {
            self.candidate(minimum, k + 1, &[remarks, &extra_remarks].concat())
        })
        .collect()
    }

    /// The double model with sensors on the compartment alone: each minimum and its dual, which fits equally. A dual
    /// that a bound excludes is no candidate.
    pub fn pairs(&self, remarks: &[String], notes: &mut Notes) -> Vec<Candidate> {
        notes.info(format!(
            "{}: one compartment accelerometer cannot tell its two dual solutions apart, a second one on the front can",
            self.task.model
        ));
        let Some(best) = self.fitted.minima.first() else { return Vec::new() };
        let limit = AS_GOOD * self.level(best);
        let mut models: Vec<DoubleSpringMassDamper> = Vec::new();
        let mut pairs = Vec::new();
        for minimum in self.fitted.minima.iter().filter(|m| self.level(m) <= limit) {
            let Some(Model::DoubleSpringMassDamper(model)) = self.coordinates.model(&minimum.theta) else { continue };
            // Alike within 1 %; dampers also where both are nothing beside the critical one of their spring.
            let alike = |a: &DoubleSpringMassDamper, b: &DoubleSpringMassDamper| {
                let near = |x: f64, y: f64, size: f64| (x - y).abs() <= 0.01 * x.abs().max(y.abs()).max(size);
                near(a.k1_n_per_m, b.k1_n_per_m, 0.0)
                    && near(a.k2_n_per_m, b.k2_n_per_m, 0.0)
                    && near(a.c1_n_s_per_m, b.c1_n_s_per_m, 0.1 * (a.k1_n_per_m * a.m1_kg).sqrt())
                    && near(a.c2_n_s_per_m, b.c2_n_s_per_m, 0.1 * (a.k2_n_per_m * a.m2_kg).sqrt())
            };
            if models.iter().any(|other| alike(&model, other) || alike(&model.dual(), other)) {
                continue;
            }
            models.push(model);
            let index = pairs.len() + 1;
            let dual = model.dual();
            let theta = self.coordinates.theta(&Model::DoubleSpringMassDamper(dual));
            let settings = crate::fit::descents::bounds(self.coordinates, 0, 1e-15);
            // Where a bound keeps the dual out it is none of the candidates.
            let other = crumple_estimation::minimise::levenberg_marquardt::descend(&self.problem(), &theta, &settings)
                .filter(|other| other.cost <= minimum.cost * (1.0 + 1e-6) + 1e-20);
            let mut pair: Vec<Candidate> = [Some(minimum), other.as_ref()]
                .into_iter()
                .flatten()
                .enumerate()
                .filter_map(|(k, m)| self.candidate(m, index + k, remarks))
                .collect();
            if pair.len() == 2 {
                if let Some(fit) = &mut pair[1].fit {
                    fit.stop_reason = minimum.stop;
                    fit.iterations = minimum.iterations;
                }
                pair[0].equivalent_to = Some(index + 1);
                pair[1].equivalent_to = Some(index);
            }
            pairs.extend(pair);
        }
        pairs
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_lumped::Nonlinear1;

    #[test]
    fn broken_side_constraints_are_named() {
        let kept = Nonlinear1 {
            mass_kg: 900.0,
            k1_n_per_m: 1e5,
            k2_n_per_m: 3e5,
            c1_n_s_per_m: 3e4,
            c2_n_s_per_m: 1e4,
            c3_n_s_per_m: 1e4,
            v_thresh_m_per_s: 3.0,
            crush_m: 0.5,
            v0_m_per_s: 12.0,
        };
        assert_eq!(broken_side_constraints(&Model::Nonlinear1(kept)), None);
        let broken = Nonlinear1 { k1_n_per_m: 4e5, c3_n_s_per_m: 2e4, ..kept };
        let text = broken_side_constraints(&Model::Nonlinear1(broken)).unwrap();
        assert!(text.starts_with("breaks the side constraints of the paper, k1 <= k2 and c2 >= c3"), "{text}");
    }
}
