//! Simulates a model on the grid of a test, moved as the test was or by a record, and compares the two.

use crumple_lumped::{Chain, CrashPulse, CrushEvents, Drive, Dynamics, HORIZON_S, LumpedError, Model, Motion};
use crumple_metrics::{fit_percent, rmse};
use crumple_signal::Sampled;

use crate::comparison::{Comparison, Measured, Simulation, Window, iso_ratings, ratings};
use crate::error::SimulateError;
use crate::residual::residual;

// What moves the models: the impact, or a record of the test.

/// What moves the models. Records are in seconds from contact; what they say before time zero is not used, and
/// after their end a force or an acceleration is 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Excitation<'a> {
    /// The impact speed of the test.
    Impact,
    /// A force on one mass from rest.
    Force {
        /// The force, N, positive towards the barrier.
        record: &'a Sampled,
        /// The mass, from 0 at the barrier.
        mass: usize,
    },
    /// A barrier (sled, shaker) that moves, everything else at rest.
    Base {
        /// Its acceleration, m/s², positive in the direction of crush.
        record: &'a Sampled,
    },
    /// The same by a pulse of a family, from time zero on.
    BasePulse {
        /// The acceleration of the barrier, positive in the direction of crush.
        pulse: &'a CrashPulse,
    },
    /// The impact speed and, as a force on the mass next to the barrier, the whole mass times the measured
    /// acceleration: the forced simulation of the transfer-function paper. Circular: the answer goes in as the
    /// question, and a model that is one rigid mass integrates it to the measured motion.
    PulseAsForce {
        /// The measured acceleration, m/s².
        record: &'a Sampled,
    },
}

impl Excitation<'_> {
    /// Whether models start at the impact speed.
    pub(crate) fn starts_at_impact_speed(&self) -> bool {
        matches!(self, Self::Impact | Self::PulseAsForce { .. })
    }

    /// The drive of a model of `mass_kg` in all at `k dt` after time zero, k = 0 .. `samples`; records are interpolated
    /// linearly, zero outside. Forces are in N, accelerations in m/s². `mass_kg` is used by
    /// [`Excitation::PulseAsForce`] alone, whose force is `mass_kg·a`, negative while the vehicle slows down.
    pub(crate) fn drive(&self, mass_kg: f64, impact_speed_m_per_s: f64, dt_s: f64, samples: usize) -> Drive {
        let on_grid = |record: &Sampled, factor: f64| -> Vec<f64> {
            (0..samples).map(|k| factor * record.at(k as f64 * dt_s).unwrap_or(0.0)).collect()
        };
        match *self {
            Self::Impact => Drive::Impact(impact_speed_m_per_s),
            Self::Force { record, mass } => Drive::Force { mass, samples: on_grid(record, 1.0) },
            Self::Base { record } => Drive::BaseAcceleration(on_grid(record, 1.0)),
            Self::BasePulse { pulse } => Drive::BasePulse(pulse.clone()),
            Self::PulseAsForce { record } => Drive::ImpactAndForce {
                speed_m_per_s: impact_speed_m_per_s,
                mass: 0,
                samples: on_grid(record, mass_kg),
            },
        }
    }
}

/// Simulates a model at the test's impact speed and sampling interval, and compares it with the test.
///
/// The response starts at time zero whatever grid the record has. Where time zero lies between two samples, the
/// record is interpolated linearly to the model's instants, an error of at most `dt² max|a|/8`: 4e-7 m at 10 kHz and
/// 30 g. Events of the model are exact and may lie beyond the record.
///
/// Errors of displacement are root mean square and largest value over the window, m. Fits of displacement, velocity and
/// acceleration are `100·(1 - |y - ŷ|/|y - ȳ|)` with the norms over the samples of the window, ȳ the mean of the test;
/// a fit may be negative, and a constant record has none. A record that begins a little after time zero is compared
/// from its first sample on.
///
/// Errors: a speed or parameters without meaning, a response that leaves the range of numbers, nothing to compare.
pub fn simulate(model: &Model, test: &Measured<'_>, window: Window) -> Result<Simulation, SimulateError> {
    simulate_driven(model, test, window, &Excitation::Impact)
}

/// As [`simulate`], moved by something else than the impact speed alone. The events of a driven model are those of its
/// samples, interpolated between two: right to about `dt²` times the rate of the deceleration.
///
/// A drive is a record of the test, interpolated linearly to the model's instants and zero outside, or a pulse of a
/// family, exact in between. Where the drive needs the mass of the vehicle ([`Excitation::PulseAsForce`]), it is the
/// sum of the model's masses.
pub fn simulate_driven(
    model: &Model,
    test: &Measured<'_>,
    window: Window,
    excitation: &Excitation<'_>,
) -> Result<Simulation, SimulateError> {
    let v0 = test.impact_speed_m_per_s;
    check_speed(v0, excitation)?;
    let mass_kg = model.masses_kg().iter().sum();
    beside_the_test(test, window, |dt, samples| {
        let drive = excitation.drive(mass_kg, v0, dt, samples);
        Ok(if let Excitation::Impact = excitation {
            // After an impact they have the same motions.
            let dynamics = model.dynamics(&drive, dt, samples).ok();
            let response = match &dynamics {
                Some(dynamics) => dynamics.response.clone(),
                None => model.respond(v0, dt, samples)?,
            };
            (response.compartment().clone(), response.motions, model.events(v0)?, dynamics)
        } else {
            driven(model.dynamics(&drive, dt, samples)?)
        })
    })
}

/// As [`simulate_driven`], for a chain of masses, whose initial speed may be another than the test's. Under a force it
/// starts from rest unless a speed is given; under a base motion always. `compartment` is the index of the mass that
/// the test is of; `None`: the last.
pub fn simulate_chain(
    chain: &Chain,
    speed_m_per_s: Option<f64>,
    compartment: Option<usize>,
    test: &Measured<'_>,
    window: Window,
    excitation: &Excitation<'_>,
) -> Result<Simulation, SimulateError> {
    let v0 = speed_m_per_s.unwrap_or(test.impact_speed_m_per_s);
    check_speed(v0, excitation)?;
    let mass_kg = chain.masses_kg().iter().sum();
    let mut simulation = beside_the_test(test, window, |dt, samples| {
        let drive = match (excitation.drive(mass_kg, v0, dt, samples), speed_m_per_s) {
            (Drive::Force { mass, samples }, Some(speed_m_per_s)) => {
                Drive::ImpactAndForce { speed_m_per_s, mass, samples }
            }
            (drive, _) => drive,
        };
        let (mut motion, masses, mut events, dynamics) = driven(chain.dynamics(&drive, dt, samples)?);
        let place = compartment.unwrap_or(masses.len() - 1);
        if let Some(other) = masses.get(place).filter(|_| compartment.is_some()) {
            motion = other.clone();
            events = sampled_events(&motion, dt);
        }
        if let Excitation::Impact = excitation {
            events = chain.events(v0, HORIZON_S)?.get(place).copied().unwrap_or_default();
        }
        Ok((motion, masses, events, dynamics))
    })?;
    simulation.compartment = compartment.unwrap_or(simulation.compartment);
    Ok(simulation)
}

/// Refuses a speed that is not positive where models start at it.
fn check_speed(speed_m_per_s: f64, excitation: &Excitation<'_>) -> Result<(), SimulateError> {
    let positive = speed_m_per_s.is_finite() && speed_m_per_s > 0.0;
    if positive || !excitation.starts_at_impact_speed() { Ok(()) } else { Err(SimulateError::Speed(speed_m_per_s)) }
}

/// Motion of the compartment, of every mass, its events, and everything else.
type Responded = (Motion, Vec<Motion>, CrushEvents, Option<Dynamics>);

/// A response under a drive, with the events of its samples.
fn driven(dynamics: Dynamics) -> Responded {
    let motion = dynamics.response.compartment().clone();
    let events = sampled_events(&motion, dynamics.response.dt_s);
    (motion, dynamics.response.motions.clone(), events, Some(dynamics))
}

/// Simulates on the grid of the test and compares. `respond` is given the interval in s and the number of samples, and
/// returns the response at 0, dt, 2·dt ... after time zero.
///
/// The window ends at the end stated, else at dynamic crush of the test, else with the displacement record, and never
/// after that. Ratings and fits see the samples that both curves have in it. A window of fewer than two is refused.
fn beside_the_test(
    test: &Measured<'_>,
    window: Window,
    respond: impl FnOnce(f64, usize) -> Result<Responded, LumpedError>,
) -> Result<Simulation, SimulateError> {
    let dt = test.displacement.dt_s();
    let end_s = test.displacement.end_s();
    let to_s = window.end_s(test);
    // Samples at 0, dt, ... up to an instant; rounding of decimal time stamps must not lose the last. A time zero long
    // before the record would ask for samples that no test has.
    let most = test.displacement.len() + 1;
    let up_to = |t: f64| if t >= 0.0 { (t / dt + 1e-6).floor().min(most as f64) as usize + 1 } else { 0 };
    let (samples, compared) = (up_to(end_s), up_to(to_s));
    if compared < 2 || samples > most {
        return Err(SimulateError::Empty { end_s, to_s });
    }
    let (motion, masses, events, dynamics) = respond(dt, samples)?;

    // Test and model inside the window, on one grid from time zero on; a record that starts a little late gives less.
    let pairs = |record: &Sampled, modelled: &[f64]| -> Option<(Sampled, Sampled)> {
        let at = |k: usize| record.at(k as f64 * dt);
        let first = (0..compared).find(|&k| at(k).is_some())?;
        let y: Vec<f64> = (first..compared).map_while(at).collect();
        let yh = modelled[first..first + y.len()].to_vec();
        let grid = |samples| Sampled::new(first as f64 * dt, dt, samples).ok();
        Some((grid(y)?, grid(yh)?))
    };
    let displacement = pairs(test.displacement, &motion.displacement_m);
    let (x, xh) = displacement.as_ref().map(|(x, xh)| (x.samples(), xh.samples())).unwrap_or_default();
    let velocity = test.velocity.and_then(|record| pairs(record, &motion.velocity_m_per_s));
    let acceleration = test.acceleration.and_then(|record| pairs(record, &motion.acceleration_m_per_s2));
    let fit =
        |pair: &Option<(Sampled, Sampled)>| pair.as_ref().and_then(|(y, yh)| fit_percent(y.samples(), yh.samples()));
    let (mut rated, mut left) = (Vec::new(), None);
    if let Some((a, ah)) = &acceleration {
        left = residual(a.samples(), ah.samples(), dt);
        rated = iso_ratings(a, ah);
        rated.extend(ratings("acceleration", a, ah));
    }
    if let Some((x, xh)) = &displacement {
        rated.extend(ratings("displacement", x, xh));
    }
    let iso18571_score =
        rated.iter().find(|rating| rating.metric.id == "iso18571").and_then(|rating| rating.metric.value);
    let comparison = Comparison {
        iso18571_score,
        from_s: 0.0,
        to_s: (compared - 1) as f64 * dt,
        rmse_displacement_m: rmse(x, xh),
        max_displacement_error_m: max_abs_error(x, xh),
        fit_displacement_percent: fit(&displacement),
        fit_velocity_percent: fit(&velocity),
        fit_acceleration_percent: fit(&acceleration),
        dynamic_crush_error_m: difference(events.dynamic_crush_m, test.dynamic_crush_m),
        time_of_dynamic_crush_error_s: difference(events.time_of_dynamic_crush_s, test.time_of_dynamic_crush_s),
        ratings: rated,
        residual: left,
    };
    let compartment = masses.len().saturating_sub(1);
    Ok(Simulation { motion, events, comparison, masses, compartment, dynamics })
}

/// First zero of the velocity from above, between two samples: `t_m = t[k-1] + T·v[k-1]/(v[k-1] - v[k])`,
/// `C = x[k-1] + (t_m - t[k-1])·v[k-1]/2`, as for the test. The rebound is not sought: a drive may end it at any time.
fn sampled_events(motion: &Motion, dt_s: f64) -> CrushEvents {
    let v = &motion.velocity_m_per_s;
    let Some(k) = (1..v.len()).find(|&k| v[k - 1] > 0.0 && v[k] <= 0.0) else { return CrushEvents::default() };
    let part = v[k - 1] / (v[k - 1] - v[k]);
    CrushEvents {
        time_of_dynamic_crush_s: Some(((k - 1) as f64 + part) * dt_s),
        dynamic_crush_m: Some(motion.displacement_m[k - 1] + 0.5 * v[k - 1] * part * dt_s),
        ..CrushEvents::default()
    }
}

/// Model minus test, where both have a value.
fn difference(model: Option<f64>, test: Option<f64>) -> Option<f64> {
    model.zip(test).map(|(model, test)| model - test)
}

/// Largest absolute error; `None` without samples, for unequal numbers of them, or beyond the range of numbers.
fn max_abs_error(measured: &[f64], modelled: &[f64]) -> Option<f64> {
    if measured.len() != modelled.len() {
        return None;
    }
    measured.iter().zip(modelled).map(|(y, yh)| (y - yh).abs()).max_by(f64::total_cmp).filter(|e| e.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_error_is_that_of_a_sample() {
        assert_eq!(max_abs_error(&[0.0, 0.0], &[3.0, -4.0]), Some(4.0));
        assert_eq!((max_abs_error(&[], &[]), max_abs_error(&[1.0], &[])), (None, None));
    }
}
