//! Simulations as they stand in the artifact, beside other sensors.

use crate::stage::band::motion_band;
use crate::{OtherSensor, Rating, Residual, SensorFit, Simulation, deceleration_peak, is_on_engine};
use crumple_lumped::{CrushEvents, Dynamics, Motion};
use crumple_signal::{Displacement, Notes, QuantityKind, Sampled, TestDescription};
use crumple_stage::records::{CandidateV1, EnergyV1, OtherSensorV1, RatingV1, ResidualV1, SimulationV1};
use crumple_stage::{Inputs, Output, RefuseExt};

/// What a simulation is compared with beside the motion of the pulse.
pub struct BesideTest {
    pub other_sensors: Vec<OtherSensorV1>,
    /// Displacement fit as measured, and misfit of the force on the wall, percent.
    pub as_measured: AsMeasured,
    pub impact_speed_m_per_s: f64,
    /// What moves the model where it is not the impact alone, in words.
    pub drive: Option<String>,
    /// Whether it is the recommended candidate, whose motion gets its band.
    pub recommended: bool,
}

/// Figures of a model that was measured as the record was, percent; none under a drive.
#[derive(Debug, Clone, Copy, Default)]
pub struct AsMeasured {
    pub fit_percent: Option<f64>,
    pub force_misfit_percent: Option<f64>,
}

/// Writes the record of a simulation and the waves of every mass, spring and damper.
///
/// `grid` is the displacement of the test: its sampling interval and its end.
pub fn write_simulation(
    id: &str,
    candidate: &CandidateV1,
    simulation: Simulation,
    beside: BesideTest,
    grid: &Sampled,
    out: &mut Output,
) -> anyhow::Result<()> {
    let BesideTest { other_sensors, as_measured, impact_speed_m_per_s, drive, recommended } = beside;
    let Simulation { motion, mut events, comparison, compartment, dynamics, .. } = simulation;
    let notes = notes_on(candidate, &mut events, dynamics.as_ref(), grid);
    let rebound = events.rebound_velocity_m_per_s.filter(|_| drive.is_none());
    let has_band = recommended && drive.is_none();
    let band = has_band.then(|| motion_band(candidate, impact_speed_m_per_s, comparison.to_s)).flatten();
    let record = SimulationV1 {
        dynamic_crush_m: events.dynamic_crush_m,
        time_of_dynamic_crush_s: events.time_of_dynamic_crush_s,
        rmse_displacement_m: comparison.rmse_displacement_m,
        fit_percent: comparison.fit_displacement_percent,
        iso18571_score: comparison.iso18571_score,
        dynamic_crush_error_m: comparison.dynamic_crush_error_m.filter(|_| events.dynamic_crush_m.is_some()),
        time_of_dynamic_crush_error_s: comparison
            .time_of_dynamic_crush_error_s
            .filter(|_| events.dynamic_crush_m.is_some()),
        max_displacement_error_m: comparison.max_displacement_error_m,
        fit_velocity_percent: comparison.fit_velocity_percent,
        fit_acceleration_percent: comparison.fit_acceleration_percent,
        from_s: comparison.from_s,
        to_s: comparison.to_s,
        notes: notes.to_texts(),
        aicc: None,
        effective_samples: None,
        fitted_parameters: None,
        other_sensors,
        drive,
        energy: dynamics.as_ref().map_or_else(Vec::new, |d| energies(d, events.time_of_dynamic_crush_s)),
        energy_closure: dynamics.as_ref().and_then(Dynamics::energy_closure),
        ratings: comparison.ratings.into_iter().map(rating_record).collect(),
        fit_as_measured_percent: as_measured.fit_percent,
        force_misfit_percent: as_measured.force_misfit_percent,
        coefficient_of_restitution: rebound.map(|v| -v / impact_speed_m_per_s),
        rebound_velocity_m_per_s: rebound,
        peak_acceleration_m_per_s2: deceleration_peak(&motion.acceleration_m_per_s2, grid.dt_s()),
        residual: comparison.residual.map(residual_record),
        band,
    };
    if !out.put_candidate(&format!("/simulation/{id}"), id, &record)? {
        return Ok(());
    }
    let mut wave = |what: &str, quantity: QuantityKind, samples: Vec<f64>| {
        out.wave(&format!("{id}/{what}"), quantity, Sampled::new(0.0, grid.dt_s(), samples)?)
    };
    let mut write_motion = |prefix: &str, motion: Motion| {
        wave(&format!("{prefix}displacement"), QuantityKind::Displacement, motion.displacement_m)?;
        wave(&format!("{prefix}velocity"), QuantityKind::Velocity, motion.velocity_m_per_s)?;
        wave(&format!("{prefix}acceleration"), QuantityKind::Acceleration, motion.acceleration_m_per_s2)
    };
    write_motion("", motion)?;
    let Some(dynamics) = dynamics else { return Ok(()) };
    // The compartment is written above.
    let motions = dynamics.response.motions.into_iter().enumerate();
    for (k, motion) in motions.filter(|(k, _)| *k != compartment) {
        write_motion(&format!("m{}/", k + 1), motion)?;
    }
    for element in dynamics.forces {
        wave(&format!("force/{}", element.name), QuantityKind::Force, element.force_n)?;
    }
    Ok(())
}

/// What a reader of the simulation should know. A crush beyond the end of the record is taken out of the events.
fn notes_on(candidate: &CandidateV1, events: &mut CrushEvents, dynamics: Option<&Dynamics>, grid: &Sampled) -> Notes {
    let mut notes = Notes::new();
    let end_s = grid.end_s();
    if let (Some(t), Some(crush)) = (events.time_of_dynamic_crush_s, events.dynamic_crush_m)
        && t > end_s + grid.dt_s()
    {
        notes.warning(format!(
            "the model stops {:.0} ms after time zero at {:.0} mm, but the record ends at {:.0} ms: this is not the \
             crush of the test",
            1e3 * t,
            1e3 * crush,
            1e3 * end_s
        ));
        (events.time_of_dynamic_crush_s, events.dynamic_crush_m) = (None, None);
    } else if events.dynamic_crush_m.is_none() {
        notes.info("the model never stops: it has no dynamic crush");
    }
    if !candidate.physical {
        notes.warning("not physical: a spring or damper is negative");
    }
    if dynamics.is_some_and(Dynamics::diverges) {
        notes.warning("diverges, the motion grows without end: a pole is unstable");
    }
    notes
}

/// How a model does at a sensor that its fit did not see.
pub fn sensor_record(fit: SensorFit) -> OtherSensorV1 {
    OtherSensorV1 {
        channel: fit.channel,
        mass: fit.mass as u32,
        rmse_displacement_m: fit.rmse_m,
        fit_percent: fit.fit_percent,
    }
}

fn residual_record(residual: Residual) -> ResidualV1 {
    ResidualV1 {
        rms_m_per_s2: residual.rms_m_per_s2,
        share_of_test: residual.share_of_test,
        samples: residual.samples as u64,
        lag_s: residual.lag_s,
        autocorrelation: residual.autocorrelation,
        limit: residual.limit,
        share_outside: residual.share_outside,
    }
}

fn rating_record(rating: Rating) -> RatingV1 {
    RatingV1 {
        name: rating.metric.name.to_owned(),
        quantity: rating.quantity.to_owned(),
        value: rating.metric.value,
        definition_id: rating.metric.id.to_owned(),
        mark: rating.mark.to_owned(),
        from_s: rating.metric.window.map(|window| window.from_s),
        to_s: rating.metric.window.map(|window| window.to_s),
        note: rating.note,
    }
}

/// Energy at the start, at the sample next to dynamic crush, and at the end.
fn energies(dynamics: &Dynamics, time_of_crush_s: Option<f64>) -> Vec<EnergyV1> {
    let dt_s = dynamics.response.dt_s;
    let last = dynamics.energy.len().saturating_sub(1);
    let crush = time_of_crush_s.map(|t| (t / dt_s).round() as usize).filter(|k| *k < last);
    [("start", Some(0)), ("dynamic crush", crush), ("end", Some(last))]
        .into_iter()
        .filter_map(|(instant, k)| {
            let energy = dynamics.energy.get(k?)?;
            Some(EnergyV1 {
                instant: instant.to_owned(),
                time_s: k? as f64 * dt_s,
                kinetic_j: energy.kinetic_j,
                stored_j: energy.stored_j,
                dissipated_j: energy.dissipated_j,
                input_j: energy.input_j,
            })
        })
        .collect()
}

/// The line of the summary.
pub fn summary_line(id: &str, simulation: &Simulation) -> String {
    let c = &simulation.comparison;
    let crush = match (simulation.events.dynamic_crush_m, simulation.events.time_of_dynamic_crush_s) {
        (Some(crush), Some(t)) => format!("crush {:.1} mm at {:.2} ms", 1e3 * crush, 1e3 * t),
        _ => "never stops".to_owned(),
    };
    let fit = c.fit_displacement_percent.map_or_else(String::new, |fit| format!(", displacement fit {fit:.2} %"));
    let error = c.rmse_displacement_m.map_or_else(String::new, |rmse| format!(", rms error {:.2} mm", 1e3 * rmse));
    format!("{id}: {crush}{fit}{error}")
}

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
