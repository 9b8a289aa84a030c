//! The occupant behind a restraint: the ride, and the restraint that follows a sensor.

use crumple_lumped::{CrashPulse, Drive, ForceDeflection, Motion, Occupant, OccupantMotion, Structure};
use crumple_numerics::estimation::minimise::levenberg_marquardt::{Bounds, Optimum, Response, derivatives, descend};
use crumple_numerics::estimation::statistics::{InformationCriteria, covariance, effective_samples};
use nalgebra::{DMatrix, SymmetricEigen};

use crate::error::PredictError;

/// How long an occupant is followed after the pulse, s.
const AFTER_PULSE_S: f64 = 0.15;
/// Spacing of the pulse that drives the occupant, s: straight lines between, as all pulses here.
const SPACING_S: f64 = 5e-4;

/// The ride of an occupant in a compartment of this motion. `speed` is what the compartment loses until its own stop:
/// from the frame of that stop the share of ride-down is counted, whatever the ground does.
///
/// `None`: the compartment loses no speed. Errors: a motion that cannot be followed.
pub(crate) fn ride(
    occupant: &Occupant,
    compartment: &Motion,
    dt_s: f64,
    speed: f64,
) -> Result<Option<OccupantMotion>, PredictError> {
    if speed.is_nan() || speed <= 0.0 {
        return Ok(None);
    }
    let every = (SPACING_S / dt_s).round().max(1.0) as usize;
    let samples = compartment.acceleration_m_per_s2.iter().enumerate().step_by(every);
    let points: Vec<(f64, f64)> = samples.map(|(k, a)| (k as f64 * dt_s, -a)).collect();
    let Some(end_s) = points.last().map(|(t, _)| *t).filter(|t| *t > 0.0) else { return Ok(None) };
    Ok(Some(occupant.ride(&CrashPulse::Lines(points), speed, end_s + AFTER_PULSE_S)?))
}

/// Samples of the ride that are needed.
const FEWEST: usize = 20;
/// What no sensor knows of a record, as a share of its root mean square.
const SENSOR: f64 = 1e-3;
/// Step of a coordinate of size one for central differences; the motion is exact to 1e-12.
const STEP: f64 = 1e-5;
/// Slack at the least, as a share of the largest excursion: none.
const NO_SLACK: f64 = 2.0 * STEP;
/// Shares of the excursion that are slack where descents start.
const SLACKS: [f64; 3] = [0.05, 0.3, 0.6];
/// A limit at the start, as a share of the largest deceleration of the chest.
const LIMIT: f64 = 0.9;
/// Deflection over which a force limit lasts at the most, m: an occupant is stopped before.
const ONE_M: f64 = 1.0;
/// Standard deviations of a coordinate that are followed at the most.
const WIDEST: f64 = std::f64::consts::LN_2;

/// Velocities of compartment and chest over ground from contact on, m/s, every `dt_s`.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredRide {
    /// Spacing, s.
    pub dt_s: f64,
    /// Of the compartment.
    pub compartment_m_per_s: Vec<f64>,
    /// Of the chest.
    pub chest_m_per_s: Vec<f64>,
}

/// A number of a restraint and its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fitted {
    /// The value.
    pub value: f64,
    /// Its standard deviation.
    pub deviation: f64,
}

/// A restraint that follows a chest sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedRestraint {
    /// The occupant behind it.
    pub occupant: Occupant,
    /// Stiffness, N/m.
    pub stiffness_n_per_m: Fitted,
    /// Slack, m.
    pub slack_m: Fitted,
    /// Force limit, N; `None`: the sensor does not ask for one.
    pub limit_n: Option<Fitted>,
    /// The occupant one standard deviation up and down along each independent direction of those numbers.
    pub ends: Vec<[Occupant; 2]>,
    /// Root mean square of what the chest's velocity is missed by, m/s.
    pub misfit_m_per_s: f64,
    /// Largest deceleration of the chest, of the model over that of the sensor.
    pub peak_ratio: f64,
    /// Largest excursion, of the model over that of the sensor.
    pub excursion_ratio: f64,
}

/// The ride up to its largest excursion, and the scales of the restraint.
struct Problem {
    mass_kg: f64,
    dt_s: f64,
    base: Drive,
    /// Velocity that the chest has lost, m/s, negative.
    chest_m_per_s: Vec<f64>,
    excursion_m: f64,
    peak_m_per_s2: f64,
    has_limit: bool,
}

impl MeasuredRide {
    /// Way of the chest ahead of the compartment at every sample, m.
    fn excursions(&self) -> Vec<f64> {
        let ahead = self.chest_m_per_s.iter().zip(&self.compartment_m_per_s).map(|(chest, vehicle)| chest - vehicle);
        let mut sum = 0.0;
        let ahead: Vec<f64> = ahead.collect();
        std::iter::once(0.0)
            .chain(ahead.windows(2).map(|pair| {
                sum += 0.5 * self.dt_s * (pair[0] + pair[1]);
                sum
            }))
            .collect()
    }

    fn problem(&self, mass_kg: f64, has_limit: bool) -> Option<Problem> {
        let excursions = self.excursions();
        let last = (0..excursions.len()).max_by(|a, b| excursions[*a].total_cmp(&excursions[*b]))?;
        let (excursion_m, dt_s) = (excursions[last], self.dt_s);
        let chest = self.chest_m_per_s.get(..=last)?;
        let peak_m_per_s2 = largest_deceleration(chest, dt_s);
        if last + 1 < FEWEST || excursion_m <= 0.0 || peak_m_per_s2 <= 0.0 {
            return None;
        }
        let slopes = self.compartment_m_per_s.windows(2).enumerate();
        let points = slopes.map(|(k, pair)| ((k as f64 + 0.5) * dt_s, (pair[1] - pair[0]) / dt_s)).collect();
        let base = Drive::BasePulse(CrashPulse::Lines(points));
        let chest_m_per_s = chest.iter().map(|v| v - chest[0]).collect();
        Some(Problem { mass_kg, dt_s, base, chest_m_per_s, excursion_m, peak_m_per_s2, has_limit })
    }

    /// The restraint whose occupant moves as the chest did, of an occupant of this mass, kg: stiffness, slack and a
    /// force limit where the corrected Akaike criterion asks for one. Only force over mass follows from the sensor.
    ///
    /// `None`: the chest does not move ahead of the compartment, or no restraint follows it.
    pub fn restraint(&self, mass_kg: f64) -> Option<FittedRestraint> {
        let fitted = |has_limit: bool| {
            let problem = self.problem(mass_kg, has_limit)?;
            let optimum = problem.minimum()?;
            Some((problem, optimum))
        };
        let (without, with) = (fitted(false), fitted(true));
        let asked_for = match (&without, &with) {
            (Some((problem, without)), Some((limited, with))) => asks_for(problem, without, limited, with),
            (without, _) => without.is_none(),
        };
        let (problem, optimum) = if asked_for { with? } else { without? };
        problem.fitted(&optimum, &self.excursions())
    }
}

/// Whether the criterion is lower with the limit, of the independent samples of the better misfit.
fn asks_for(problem: &Problem, without: &Optimum, limited: &Problem, with: &Optimum) -> bool {
    let misfit = |problem: &Problem, optimum: &Optimum| {
        let mut misfit = vec![0.0; problem.rows()];
        problem.residuals(&optimum.theta, &mut misfit).then_some(misfit)
    };
    let (Some(a), Some(b)) = (misfit(problem, without), misfit(limited, with)) else { return false };
    let known = SENSOR * root_mean_square(&problem.chest_m_per_s);
    let loss = |misfit: &[f64]| root_mean_square(misfit).hypot(known).powi(2);
    let samples = effective_samples(if loss(&b) < loss(&a) { &b } else { &a }).unwrap_or(problem.rows() as f64);
    // One level of noise is a number too; a record of fewer samples tells no limit.
    let criterion = |misfit: &[f64], numbers: usize| {
        let enough = samples > (numbers + 2) as f64;
        if enough { InformationCriteria::new(loss(misfit), samples, numbers).aicc } else { f64::INFINITY }
    };
    criterion(&b, 4) < criterion(&a, 3)
}

fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
}

/// Largest deceleration by central differences, m/s².
fn largest_deceleration(velocity: &[f64], dt_s: f64) -> f64 {
    velocity.windows(3).map(|v| (v[0] - v[2]) / (2.0 * dt_s)).fold(0.0, f64::max)
}

impl Problem {
    /// Stiffness, N/m, slack, m, and limit, N, at a point: two logarithms over their scales and a share.
    fn numbers(&self, theta: &[f64]) -> [f64; 3] {
        let force_n = self.mass_kg * self.peak_m_per_s2;
        let limit = theta.get(2).map_or(f64::INFINITY, |x| force_n * x.exp());
        [force_n / self.excursion_m * theta[0].exp(), self.excursion_m * theta[1], limit]
    }

    fn occupant(&self, theta: &[f64]) -> Option<Occupant> {
        let [stiffness, slack, limit] = self.numbers(theta);
        let restraint = ForceDeflection::new(&[(0.0, 0.0), (ONE_M, stiffness * ONE_M)], stiffness).ok()?;
        let restraint = restraint.with_gap(slack).ok()?;
        let restraint = if self.has_limit { restraint.with_limit(limit).ok()? } else { restraint };
        Some(Occupant { mass_kg: self.mass_kg, restraint })
    }

    /// Velocity that the model's chest has lost, m/s, and its way ahead of where it started, m.
    fn ride(&self, theta: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
        let occupant = self.occupant(theta)?;
        let structure = Structure::row(&[self.mass_kg], [vec![occupant.restraint.into()]]).ok()?;
        let motion =
            structure.dynamics(&self.base, self.dt_s, self.chest_m_per_s.len()).ok()?.response.motions.pop()?;
        Some((motion.velocity_m_per_s, motion.displacement_m))
    }

    /// The lowest minimum of all starts.
    fn minimum(&self) -> Option<Optimum> {
        let (mut lower, mut upper) = (vec![-7.0, NO_SLACK], vec![7.0, 0.98]);
        if self.has_limit {
            lower.push(-3.0);
            upper.push(1.0);
        }
        let bounds = Bounds { lower, upper, max_iterations: 100, cost_tolerance: 1e-12, slow: 0.0 };
        let minima = SLACKS.iter().filter_map(|slack| {
            let start = [-(1.0 - slack).ln(), *slack, LIMIT.ln()];
            descend(self, &start[..bounds.lower.len()], &bounds)
        });
        minima.min_by(|a, b| a.cost.total_cmp(&b.cost))
    }

    fn fitted(&self, optimum: &Optimum, excursions: &[f64]) -> Option<FittedRestraint> {
        let theta = &optimum.theta;
        let mut misfit = vec![0.0; self.rows()];
        let followed = self.residuals(theta, &mut misfit);
        let known = SENSOR * root_mean_square(&self.chest_m_per_s);
        let covariance = covariance(&derivatives(self, theta)?, &misfit, known).filter(|_| followed)?.matrix;
        let deviation = |k: usize| covariance[(k, k)].max(0.0).sqrt();
        let [stiffness, slack, limit] = self.numbers(theta);
        let (velocity, way) = self.ride(theta)?;
        // The base moves as the compartment was measured.
        let vehicle =
            self.chest_m_per_s.iter().zip(excursions).scan((0.0, 0.0), |(way, before), (chest, excursion)| {
                *way += 0.5 * self.dt_s * (chest + *before);
                *before = *chest;
                Some(*way - excursion)
            });
        let excursion = way.iter().zip(vehicle).map(|(chest, vehicle)| chest - vehicle).fold(0.0, f64::max);
        Some(FittedRestraint {
            occupant: self.occupant(theta)?,
            stiffness_n_per_m: Fitted { value: stiffness, deviation: stiffness * deviation(0) },
            slack_m: Fitted { value: slack, deviation: self.excursion_m * deviation(1) },
            limit_n: self.has_limit.then(|| Fitted { value: limit, deviation: limit * deviation(2) }),
            ends: self.ends(theta, covariance),
            misfit_m_per_s: root_mean_square(&misfit),
            peak_ratio: largest_deceleration(&velocity, self.dt_s) / self.peak_m_per_s2,
            excursion_ratio: excursion / self.excursion_m,
        })
    }

    /// One standard deviation up and down along the principal directions.
    fn ends(&self, theta: &[f64], covariance: DMatrix<f64>) -> Vec<[Occupant; 2]> {
        let eigen = SymmetricEigen::new(covariance);
        let along = |i: usize, sign: f64| {
            let step = sign * eigen.eigenvalues[i].max(0.0).sqrt().min(WIDEST);
            let direction = eigen.eigenvectors.column(i);
            let mut moved: Vec<f64> = theta.iter().zip(direction.iter()).map(|(x, part)| x + step * part).collect();
            moved[1] = moved[1].max(0.0);
            self.occupant(&moved)
        };
        (0..theta.len()).filter_map(|i| Some([along(i, 1.0)?, along(i, -1.0)?])).collect()
    }
}

impl Response for Problem {
    fn rows(&self) -> usize {
        self.chest_m_per_s.len()
    }

    fn residuals(&self, theta: &[f64], out: &mut [f64]) -> bool {
        let Some((velocity, _)) = self.ride(theta) else { return false };
        for (out, (model, measured)) in out.iter_mut().zip(velocity.iter().zip(&self.chest_m_per_s)) {
            *out = model - measured;
        }
        out.iter().all(|residual| residual.is_finite())
    }

    fn sensitivities(&self, theta: &[f64], out: &mut DMatrix<f64>) -> bool {
        for j in 0..theta.len() {
            let at = |step: f64| {
                let mut moved = theta.to_vec();
                moved[j] += step;
                self.ride(&moved).map(|(velocity, _)| velocity)
            };
            let (Some(up), Some(down)) = (at(STEP), at(-STEP)) else { return false };
            for (i, (up, down)) in up.iter().zip(&down).enumerate() {
                out[(i, j)] = (up - down) / (2.0 * STEP);
            }
        }
        out.iter().all(|derivative| derivative.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const SPEED: f64 = 14.0;
    const DT_S: f64 = 5e-4;

    /// The ride of 75 kg behind this restraint in a compartment that a half-sine stops in 90 ms.
    fn ride(stiffness: f64, slack: f64, limit: Option<f64>) -> MeasuredRide {
        let (duration, samples) = (0.09, 300);
        let peak = SPEED * PI / (2.0 * duration);
        let restraint = ForceDeflection::new(&[(0.0, 0.0), (1.0, stiffness)], stiffness).unwrap();
        let restraint = restraint.with_gap(slack).unwrap();
        let restraint = limit.map_or(restraint.clone(), |limit| restraint.with_limit(limit).unwrap());
        let base = Drive::BasePulse(CrashPulse::HalfSine { peak_m_per_s2: -peak, duration_s: duration });
        let structure = Structure::row(&[75.0], [vec![restraint.into()]]).unwrap();
        let chest = structure.dynamics(&base, DT_S, samples).unwrap().response.motions.pop().unwrap();
        let vehicle = |t: f64| SPEED - peak * duration / PI * (1.0 - (PI * t.min(duration) / duration).cos());
        MeasuredRide {
            dt_s: DT_S,
            compartment_m_per_s: (0..samples).map(|k| vehicle(k as f64 * DT_S)).collect(),
            chest_m_per_s: chest.velocity_m_per_s.iter().map(|v| v + SPEED).collect(),
        }
    }

    fn near(fitted: Fitted, truth: f64, share: f64) {
        assert!((fitted.value / truth - 1.0).abs() < share, "{fitted:?}, expected {truth}");
    }

    #[test]
    fn slack_stiffness_and_limit_come_back() {
        let fitted = ride(60e3, 0.03, Some(5e3)).restraint(75.0).unwrap();
        // The compartment is known by straight lines between half milliseconds: some 1e-4 of its motion.
        near(fitted.stiffness_n_per_m, 60e3, 5e-3);
        near(fitted.slack_m, 0.03, 5e-3);
        near(fitted.limit_n.unwrap(), 5e3, 5e-3);
        assert!((fitted.peak_ratio - 1.0).abs() < 5e-3 && (fitted.excursion_ratio - 1.0).abs() < 5e-3, "{fitted:?}");
        assert_eq!(fitted.ends.len(), 3);
    }

    #[test]
    fn a_limit_that_was_not_reached_is_not_invented() {
        let fitted = ride(60e3, 0.03, None).restraint(75.0).unwrap();
        assert_eq!(fitted.limit_n, None);
        near(fitted.stiffness_n_per_m, 60e3, 5e-3);
        // Twice the mass behind twice the stiffness moves alike.
        near(ride(60e3, 0.03, None).restraint(150.0).unwrap().stiffness_n_per_m, 120e3, 5e-3);
    }

    #[test]
    fn deviations_hold_what_noise_does() {
        let mut noisy = ride(60e3, 0.03, Some(5e3));
        let mut random = crumple_numerics::estimation::random::RandomNumbers::of_stream(3, 1);
        noisy.chest_m_per_s.iter_mut().skip(1).for_each(|v| *v += 0.05 * random.normal());
        let fitted = noisy.restraint(75.0).unwrap();
        for (fitted, truth) in
            [(fitted.stiffness_n_per_m, 60e3), (fitted.slack_m, 0.03), (fitted.limit_n.unwrap(), 5e3)]
        {
            let off = (fitted.value - truth).abs() / fitted.deviation;
            assert!(off < 3.0 && fitted.deviation < 0.2 * truth, "{fitted:?}, {truth}");
        }
    }

    #[test]
    fn a_chest_that_stays_with_its_seat_has_no_restraint() {
        let mut still = ride(60e3, 0.03, None);
        still.chest_m_per_s.clone_from(&still.compartment_m_per_s);
        assert_eq!(still.restraint(75.0), None);
    }
}
