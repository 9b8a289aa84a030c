//! What each candidate brings into the choice: its misfit as measured, its restitution, what the record leaves open.

use crumple_lumped::{ParameterKind, parameter_kind, structure_of};
use crumple_lumped_fit::{
    ComparedCandidate, ComparedRecord, EnergyClass, FitQuantity, Measurement, Observation, ObservedWave, WallForce,
    crush_error_at_lower_speeds,
};
use crumple_signal::{Displacement, Sampled};
use crumple_stage::records::{CandidateV1, EventsV1};
use crumple_stage::{Inputs, RefuseExt, Wave};
use rayon::prelude::*;

use crate::stage::inputs::motions::motion;
use crate::stage::options::settings::StageSettings;
use crate::stage::recommend::felt::is_felt;

/// A crash is over in two seconds or never.
const HORIZON_S: f64 = 2.0;

/// A candidate with what its record does not say.
#[derive(Debug)]
pub struct Submitted<'a> {
    pub id: &'a str,
    pub record: &'a CandidateV1,
    /// Whether masses were fitted that this record does not divide.
    pub division_undecided: bool,
}

/// The record that all candidates are compared with, from contact to dynamic crush.
pub struct Comparison {
    /// Acceleration of the pulse: what the evidence is of.
    acceleration: Observation,
    /// Displacement of the pulse: what closest means.
    displacement: Observation,
    tested_restitution: Option<f64>,
    /// Force on the wall up to separation.
    wall: Option<WallForce>,
}

impl Comparison {
    /// Reads both waves up to `to_s` after time zero. `None` where one is not at hand or too short.
    pub fn read(
        settings: &StageSettings,
        input: &Inputs,
        events: &EventsV1,
        (mass_kg, impact_speed_m_per_s): (f64, f64),
    ) -> anyhow::Result<Option<Self>> {
        let channel = &events.channel;
        let Some(to_s) = settings.solve.fit_to_s.or(events.time_of_dynamic_crush_s) else { return Ok(None) };
        let displacement = input.wave_if(&format!("{channel}/displacement"));
        let Some(displacement) = displacement.map(Wave::signal::<Displacement>).transpose().refuse()? else {
            return Ok(None);
        };
        let Ok(acceleration) = motion(input, channel, FitQuantity::Acceleration, mass_kg) else { return Ok(None) };
        let observe = |wave: &Sampled, quantity: FitQuantity| -> anyhow::Result<Option<Observation>> {
            let measurement: Measurement = input.recording_steps(events, channel, wave)?.into();
            let (window, what) = ((settings.solve.fit_from_s, to_s), (None, quantity));
            let wave = ObservedWave::new(wave, what, events.time_zero_s, measurement, window, usize::MAX).ok();
            Ok(wave.map(|wave| Observation { impact_speed_m_per_s, waves: vec![wave] }))
        };
        let displacement = observe(&displacement, FitQuantity::Displacement)?;
        let acceleration = observe(&acceleration, FitQuantity::Acceleration)?;
        let tested_restitution = events.coefficient_of_restitution.filter(|e| *e > 0.0);
        let wall = input.wall_force(events)?.and_then(|(force, steps)| {
            let to_s = events.end_of_contact_s(force.end_s());
            WallForce::new(&force, events.time_zero_s, steps.into(), to_s).ok()
        });
        Ok(acceleration.zip(displacement).map(|(acceleration, displacement)| Self {
            acceleration,
            displacement,
            tested_restitution,
            wall,
        }))
    }

    /// The wave that the evidence is of.
    pub fn wave(&self) -> &ObservedWave {
        &self.acceleration.waves[0]
    }

    /// Whether the models are sampled and filtered as the record was.
    pub fn is_as_measured(&self) -> bool {
        self.acceleration.is_as_measured()
    }

    /// The record in numbers.
    pub fn record(&self) -> ComparedRecord {
        let wave = self.wave();
        let length_s = wave.time_s(wave.samples.len() - 1) - wave.time_s(0);
        let measurement = &wave.measurement;
        let most = measurement.filter.map(|filter| 2.0 * filter.noise_bandwidth_hz(measurement.dt_s) * length_s);
        ComparedRecord {
            rms: wave.size(),
            most_samples: most.unwrap_or(f64::INFINITY),
            restitution: self.tested_restitution,
        }
    }

    /// What the candidates bring, in their order.
    pub fn candidates(&self, submitted: &[Submitted<'_>]) -> Vec<ComparedCandidate> {
        submitted.par_iter().map(|candidate| self.candidate(candidate)).collect()
    }

    fn candidate(&self, candidate: &Submitted<'_>) -> ComparedCandidate {
        let record = candidate.record;
        let structure = structure_of(&record.model, &record.parameters).ok();
        let misfit = |observed: &Observation| observed.misfit_of(structure.as_ref()?);
        let speed = self.acceleration.impact_speed_m_per_s;
        let events = structure.as_ref().and_then(|structure| structure.events(speed, HORIZON_S).ok());
        let rebound = events.and_then(|events| events.last()?.rebound_velocity_m_per_s);
        let force_misfit_percent = self
            .wall
            .as_ref()
            .zip(structure.as_ref())
            .and_then(|(wall, structure)| wall.misfit_percent(structure, speed));
        let is_zero = |name: &str| record.parameters.get(name).is_some_and(|value| *value == 0.0);
        let bounds = record.fit.as_ref().map_or(&[][..], |fit| &fit.active_bounds);
        let mut open: Vec<String> = record.undetermined().into_iter().map(str::to_owned).collect();
        let mut open_and_felt: Vec<String> = open.iter().filter(|name| is_felt(record, name, speed)).cloned().collect();
        if candidate.division_undecided {
            open.push("the division of the mass".to_owned());
            open_and_felt.extend(open.last().cloned());
        }
        let class = EnergyClass::of(&record.model, &record.parameters);
        let of_displacement = misfit(&self.displacement);
        ComparedCandidate {
            id: candidate.id.to_owned(),
            class,
            parameters: free_numbers(record).max(open.len()),
            open,
            open_and_felt,
            on_bound: bounds.iter().filter(|name| !is_zero(name)).cloned().collect(),
            physical: record.physical,
            misfit: misfit(&self.acceleration),
            fit_percent: of_displacement.as_ref().and_then(|misfit| self.fit_percent(misfit)),
            restitution: rebound.map(|rebound| -rebound / speed),
            force_misfit_percent,
            crush_error_at_lower_speeds: of_displacement
                .filter(|_| class == EnergyClass::Plastic)
                .and_then(|misfit| self.crush_error_at_lower_speeds(&misfit)),
        }
    }

    fn crush_error_at_lower_speeds(&self, misfit: &[f64]) -> Option<f64> {
        let wave = &self.displacement.waves[0];
        let model: Vec<f64> = wave.samples.iter().zip(misfit).map(|(x, misfit)| x + misfit).collect();
        let spacing_s = wave.time_s(1) - wave.time_s(0);
        crush_error_at_lower_speeds(&wave.samples, &model, spacing_s, self.displacement.impact_speed_m_per_s)
    }

    /// `100 (1 - |x - xh| / |x - mean x|)` of the displacement.
    fn fit_percent(&self, misfit: &[f64]) -> Option<f64> {
        let samples = &self.displacement.waves[0].samples;
        let mean = samples.iter().sum::<f64>() / samples.len() as f64;
        let norm = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>().sqrt();
        let size = norm(&mut samples.iter().map(|x| x - mean));
        (size > 0.0).then(|| 100.0 * (1.0 - norm(&mut misfit.iter().copied()) / size))
    }
}

/// Numbers that the record was asked for; of a candidate that nobody assessed all but its masses.
fn free_numbers(record: &CandidateV1) -> usize {
    match record.asked().count() {
        0 => {
            let is_mass = |name: &str| parameter_kind(&record.model, name) == Some(ParameterKind::Mass);
            record.parameters.keys().filter(|name| !is_mass(name)).count()
        }
        asked => asked,
    }
}
