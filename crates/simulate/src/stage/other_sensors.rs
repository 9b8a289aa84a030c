//! Accelerometers beside the pulse that a simulation is compared with.

use crumple_signal::{Displacement, TestDescription};
use crumple_simulate::{OtherSensor, is_on_engine};
use crumple_stage::records::CandidateV1;
use crumple_stage::{Inputs, RefuseExt};

/// Every other accelerometer on the vehicle that was integrated.
pub fn other_sensors(input: &Inputs, test: &TestDescription, pulse: &str) -> anyhow::Result<Vec<OtherSensor>> {
    let mut sensors = Vec::new();
    for channel in test.channels.iter().filter(|channel| channel.id != pulse) {
        if let Some(wave) = input.wave_if(&format!("{}/displacement", channel.id)) {
            sensors.push(OtherSensor {
                channel: channel.id.clone(),
                on_engine: is_on_engine(channel),
                displacement: wave.signal::<Displacement>().refuse()?.into_sampled(),
            });
        }
    }
    Ok(sensors)
}

/// Number of the mass, from 1, that the pulse is of in a candidate whose fit says so.
pub fn mass_of_pulse(candidate: &CandidateV1, pulse: &str) -> Option<usize> {
    let sensors = &candidate.fit.as_ref()?.sensors;
    Some(sensors.iter().find(|sensor| sensor.channel == pulse)?.mass as usize)
}

/// Number of the mass behind the compartment that the candidate's fit put this channel on: an occupant's, whose motion
/// no other number of the simulation is about.
pub fn mass_of_occupant(candidate: &CandidateV1, channel: &str, compartment: usize) -> Option<usize> {
    let sensors = &candidate.fit.as_ref()?.sensors;
    let mass = sensors.iter().find(|sensor| sensor.channel == channel)?.mass as usize;
    (mass > compartment).then_some(mass)
}

/// Whether the candidate's own fit saw this channel: it says nothing new then.
pub fn was_fitted(candidate: &CandidateV1, channel: &str) -> bool {
    candidate.fit.as_ref().is_some_and(|fit| fit.sensors.iter().any(|sensor| sensor.channel == channel))
}
