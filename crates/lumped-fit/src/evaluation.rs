//! A model beside its test, measured as the record was: the fit of its displacement, how it misses the events, other
//! sensors and the force on the wall.

use crumple_lumped::{HORIZON_S, Model, Structure};
use crumple_signal::{Measurement, Sampled};

use crate::error::SolveError;
use crate::record::observation::{Observation, ObservedWave};
use crate::record::sensor::{FitQuantity, SensorPlace, WallForce};
use crate::selection::compared::{EnergyClass, OwnTestErrors};
use crate::selection::other_speeds::crush_error_at_lower_speeds;

/// What a test shows of an impact and models are compared with.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredTest {
    /// Channel of the pulse.
    pub channel: String,
    /// Window that was asked for, s after contact.
    window_s: (f64, f64),
    /// Displacement of the pulse over the compared window, with the impact speed.
    pub displacement: Observation,
    /// Accelerations of the pulse and of the sensors on other masses, these as shares of their sizes: what the evidence
    /// for a candidate is of. `None`: not at hand, or too short.
    pub acceleration: Option<Observation>,
    /// Sensors on other masses, in the order of their accelerations behind that of the pulse.
    pub other_sensors: Vec<OtherMass>,
    /// Dynamic crush, m, and the time of it, s after contact; `None`: the record does not show it.
    pub dynamic_crush: Option<(f64, f64)>,
    /// Coefficient of restitution; `None`: the record does not show it.
    pub restitution: Option<f64>,
    /// Whether the record ends before the rebound does, so that its restitution is a lower bound.
    pub rebound_is_cut: bool,
    /// Force on the wall up to separation.
    pub wall: Option<WallForce>,
}

/// A wave, and how it was measured.
#[derive(Debug, Clone, Copy)]
pub struct Measured<'a> {
    /// The wave, on its own time axis, s after contact.
    pub wave: &'a Sampled,
    /// How it was measured.
    pub measurement: Measurement,
}

impl Measured<'_> {
    /// What of it lies in a window, s after contact, every sample.
    fn over(&self, window_s: (f64, f64), quantity: FitQuantity) -> Result<ObservedWave, SolveError> {
        ObservedWave::new(self.wave, (None, quantity), self.measurement, window_s, usize::MAX)
    }
}

/// A sensor without a signal: an acceleration of zeros in the compared window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ZeroThroughout;

/// A sensor on another mass than that of the pulse.
#[derive(Debug, Clone, PartialEq)]
pub struct OtherMass {
    /// Its channel.
    pub channel: String,
    /// Where it sits.
    pub place: SensorPlace,
    /// Its displacement over the compared window, where it was integrated.
    pub displacement: Option<Observation>,
}

/// A model beside a test.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Evaluation {
    /// Displacement fit, percent, of the model sampled, filtered and integrated as the record was; `None`: it has no
    /// response, or the record does not vary.
    pub fit_as_measured_percent: Option<f64>,
    /// How it misses the events of the test.
    pub own_test: OwnTestErrors,
    /// Its coefficient of restitution; `None`: it does not come back.
    pub restitution: Option<f64>,
    /// Misfit of the force on the wall, percent of its root mean square; `None`: the test has no such force.
    pub force_misfit_percent: Option<f64>,
    /// Of the sensors on other masses the one that it follows worst: channel and displacement fit, percent.
    pub worst_sensor: Option<(String, f64)>,
    /// Of a plastic model, the largest relative error of the crush at 0.60 to 0.95 of the speed, which the record
    /// itself shows.
    pub crush_error_at_lower_speeds: Option<f64>,
}

/// Compares a model with a test. `pulse`: index of the mass that the pulse is of, from the barrier on; `None`: the
/// last.
///
/// The response of the displacement through the measurement is the expensive part. A model without a response has no
/// figures.
pub fn evaluate(model: &Model, pulse: Option<usize>, test: &MeasuredTest) -> Evaluation {
    let Ok(structure) = model.structure() else { return Evaluation::default() };
    let mut observed = test.displacement.clone();
    observed.waves[0].mass = pulse;
    let misfit = observed.misfit_of(&structure);
    let impact = observed.impact_of(&observed.waves[0]);
    let speed = impact.speed_m_per_s;
    let loaded = impact.structure(&structure);
    let events = loaded.as_ref().and_then(|structure| structure.events(speed, HORIZON_S).ok());
    let of_pulse = events.as_ref().and_then(|events| pulse.and_then(|mass| events.get(mass)).or(events.last()));
    let restitution = of_pulse.and_then(|events| events.rebound_velocity_m_per_s).map(|rebound| -rebound / speed);
    let crush = of_pulse.and_then(|events| events.dynamic_crush_m.zip(events.time_of_dynamic_crush_s));
    let is_plastic = EnergyClass::of(model) == EnergyClass::Plastic;
    let wall = test.wall.as_ref().zip(loaded.as_ref());
    Evaluation {
        fit_as_measured_percent: misfit.as_ref().and_then(|misfit| observed.fit_percent(misfit)),
        own_test: crush.map_or_else(OwnTestErrors::default, |crush| OwnTestErrors {
            velocity: misfit.as_ref().and_then(|misfit| test.velocity_error(misfit, speed)),
            ..test.errors(crush, restitution.unwrap_or(0.0))
        }),
        restitution,
        force_misfit_percent: wall.and_then(|(wall, structure)| wall.misfit_percent(structure, speed)),
        worst_sensor: test.worst_sensor(&structure),
        crush_error_at_lower_speeds: misfit.filter(|_| is_plastic).and_then(|misfit| {
            let wave = &observed.waves[0];
            let model: Vec<f64> = wave.samples.iter().zip(&misfit).map(|(x, misfit)| x + misfit).collect();
            crush_error_at_lower_speeds(&wave.samples, &model, wave.time_s(1) - wave.time_s(0), speed)
        }),
    }
}

impl MeasuredTest {
    /// A test by the displacement of its pulse at an impact speed, m/s, over a window, s after contact. Errors: fewer
    /// than 12 samples in the window.
    pub fn new(
        channel: &str,
        impact_speed_m_per_s: f64,
        window_s: (f64, f64),
        displacement: Measured<'_>,
    ) -> Result<Self, SolveError> {
        let displacement = displacement.over(window_s, FitQuantity::Displacement)?;
        Ok(Self {
            channel: channel.to_owned(),
            window_s,
            displacement: Observation { impact_speed_m_per_s, waves: vec![displacement] },
            acceleration: None,
            other_sensors: Vec::new(),
            dynamic_crush: None,
            restitution: None,
            rebound_is_cut: false,
            wall: None,
        })
    }

    /// Adds the acceleration of the pulse; one that is too short stays out.
    pub fn with_acceleration(mut self, acceleration: Measured<'_>) -> Self {
        let observed = acceleration.over(self.window_s, FitQuantity::Acceleration).ok();
        let impact_speed_m_per_s = self.displacement.impact_speed_m_per_s;
        self.acceleration = observed.map(|wave| Observation { impact_speed_m_per_s, waves: vec![wave] });
        self
    }

    /// Adds a sensor on another mass, its acceleration and its displacement where it was integrated. What is too short
    /// stays out, and all of it where the pulse has no acceleration. Errors: an acceleration of zeros.
    pub fn add_sensor(
        &mut self,
        (channel, place): (&str, SensorPlace),
        acceleration: Measured<'_>,
        displacement: Option<Measured<'_>>,
    ) -> Result<(), ZeroThroughout> {
        let Some(accelerations) = &mut self.acceleration else { return Ok(()) };
        let Ok(mut wave) = acceleration.over(self.window_s, FitQuantity::Acceleration) else { return Ok(()) };
        wave.weight = accelerations.waves[0].size() / wave.size();
        if !wave.weight.is_finite() {
            return Err(ZeroThroughout);
        }
        accelerations.waves.push(wave);
        let displacement =
            displacement.and_then(|record| record.over(self.window_s, FitQuantity::Displacement).ok()).map(|wave| {
                Observation { impact_speed_m_per_s: self.displacement.impact_speed_m_per_s, waves: vec![wave] }
            });
        self.other_sensors.push(OtherMass { channel: channel.to_owned(), place, displacement });
        Ok(())
    }

    /// Adds the force on the wall, where there is one, up to the end of contact: `end_of_contact_s` is given the end of
    /// the record. One that is too short stays out.
    pub fn with_wall(mut self, force: Option<Measured<'_>>, end_of_contact_s: impl Fn(f64) -> f64) -> Self {
        let wall = |Measured { wave, measurement }: Measured<'_>| {
            WallForce::new(wave, measurement, end_of_contact_s(wave.end_s())).ok()
        };
        self.wall = force.and_then(wall);
        self
    }

    /// The compared window, s after contact.
    pub fn window_s(&self) -> (f64, f64) {
        self.displacement.waves[0].window_s()
    }

    /// How a model with this dynamic crush, m, this time of it, s, and this restitution misses the events.
    fn errors(&self, (crush_m, time_s): (f64, f64), restitution: f64) -> OwnTestErrors {
        let share = |model: f64, test: f64| Some(model / test - 1.0).filter(|error| error.is_finite());
        OwnTestErrors {
            crush: self.dynamic_crush.and_then(|(of_test, _)| share(crush_m, of_test)),
            time: self.dynamic_crush.and_then(|(_, of_test)| share(time_s, of_test)),
            velocity: None,
            restitution: self.restitution.map(|of_test| {
                let error = restitution - of_test;
                if self.rebound_is_cut { error.min(0.0) } else { error }
            }),
        }
    }

    /// Velocity at the end of the compared window of a displacement misfit, over the impact speed: by its last 32nd
    /// part, which no noise of a displacement reaches.
    fn velocity_error(&self, misfit: &[f64], speed: f64) -> Option<f64> {
        let wave = &self.displacement.waves[0];
        let last = misfit.len() - 1;
        let before = last - (misfit.len() / 32).max(1);
        Some((misfit[last] - misfit[before]) / (wave.time_s(last) - wave.time_s(before)) / speed)
    }

    /// Of the sensors on other masses the one that a structure follows worst, and its displacement fit, percent.
    fn worst_sensor(&self, structure: &Structure) -> Option<(String, f64)> {
        let fits = self.other_sensors.iter().filter_map(|other| {
            let mut observed = other.displacement.clone()?;
            observed.waves[0].mass = other.place.mass(structure.masses_kg().len());
            let fit = observed.fit_percent(&observed.misfit_of(structure)?)?;
            Some((other.channel.clone(), fit))
        });
        fits.min_by(|(_, a), (_, b)| a.total_cmp(b))
    }
}

#[cfg(test)]
mod tests {
    use crumple_lumped::Kelvin;

    use super::*;

    #[test]
    fn the_model_of_the_record_misses_nothing_and_one_of_another_spring_its_crush() {
        let model = |stiffness_n_per_m: f64| Kelvin { mass_kg: 1000.0, stiffness_n_per_m, damping_n_s_per_m: 0.0 };
        let (made, speed) = (model(4e5), 15.0);
        let at = |k: u32| made.state(speed, f64::from(k) * 1e-4).displacement_m;
        let record = Sampled::new(0.0, 1e-4, (0..800).map(at).collect()).unwrap();
        let measured_by = |measurement| {
            let displacement = Measured { wave: &record, measurement };
            MeasuredTest::new("pulse", speed, (0.0, 0.078), displacement).unwrap()
        };
        let events = made.events(speed);
        let test = MeasuredTest {
            dynamic_crush: events.dynamic_crush_m.zip(events.time_of_dynamic_crush_s),
            restitution: Some(1.0),
            ..measured_by(Measurement::of_samples(&record))
        };
        let own = evaluate(&Model::Kelvin(made), None, &test);
        // Rounding of 800 steps and of the closed form.
        assert!((own.fit_as_measured_percent.unwrap() - 100.0).abs() < 1e-9, "{own:?}");
        let OwnTestErrors { crush, time, restitution, .. } = own.own_test;
        assert!([crush, time, restitution].iter().all(|error| error.unwrap().abs() < 1e-9), "{own:?}");
        // The fit is the same wherever the acceleration begins that the displacement is integrated from.
        for first_s in [-0.001, -0.01, -0.05, -0.3_f64] {
            let samples = record.len() + (-first_s / 1e-4).round() as usize;
            let measurement = Measurement { first_s, samples, ..Measurement::of_samples(&record) };
            let early = evaluate(&Model::Kelvin(made), None, &measured_by(measurement));
            assert!((early.fit_as_measured_percent.unwrap() - 100.0).abs() < 1e-9, "{first_s}: {early:?}");
        }
        // A fourfold stiffness halves crush and time.
        let other = evaluate(&Model::Kelvin(model(1.6e6)), Some(0), &test).own_test;
        assert!((other.crush.unwrap() + 0.5).abs() < 1e-9 && (other.time.unwrap() + 0.5).abs() < 1e-9, "{other:?}");
    }
}
