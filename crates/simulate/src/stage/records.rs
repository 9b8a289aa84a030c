//! Simulations as they stand in the artifact, beside other sensors and with the numbers of their fit counted.

use crate::{Information, OtherSensor, Rating, SensorFit, Simulation, deceleration_peak, is_on_engine, numbers_of};
use crumple_artifact::WriteError;
use crumple_lumped::{Chain, CrushEvents, Dynamics, LumpedError, Model, Motion, ParameterKind};
use crumple_signal::{About, Displacement, Notes, QuantityKind, Sampled, TestDescription, Weight};
use crumple_stage::records::{CandidateV1, EnergyV1, OtherSensorV1, RatingV1, SimulationV1};
use crumple_stage::{Inputs, Output, RefuseExt};

/// What a simulation is compared with beside the motion of the pulse.
pub struct BesideTest {
    pub information: Option<Information>,
    pub other_sensors: Vec<OtherSensorV1>,
    /// Misfit of the force on the wall, percent.
    pub force_misfit_percent: Option<f64>,
    pub impact_speed_m_per_s: f64,
    /// What moves the model where it is not the impact alone, in words.
    pub drive: Option<String>,
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
    let BesideTest { information, other_sensors, force_misfit_percent, impact_speed_m_per_s, drive } = beside;
    let Simulation { motion, mut events, comparison, compartment, dynamics, .. } = simulation;
    let notes = notes_on(candidate, &mut events, dynamics.as_ref(), grid);
    let rebound = events.rebound_velocity_m_per_s.filter(|_| drive.is_none());
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
        aicc: information.and_then(|i| i.aicc),
        effective_samples: information.map(|i| i.effective_samples),
        fitted_parameters: information.map(|i| i.parameters),
        other_sensors,
        drive,
        energy: dynamics.as_ref().map_or_else(Vec::new, |d| energies(d, events.time_of_dynamic_crush_s)),
        energy_closure: dynamics.as_ref().and_then(Dynamics::energy_closure),
        ratings: comparison.ratings.into_iter().map(rating_record).collect(),
        fit_as_measured_percent: comparison.fit_as_measured_percent,
        force_misfit_percent,
        coefficient_of_restitution: rebound.map(|v| -v / impact_speed_m_per_s),
        rebound_velocity_m_per_s: rebound,
        peak_acceleration_m_per_s2: deceleration_peak(&motion.acceleration_m_per_s2, grid.dt_s()),
    };
    if let Err(error) = out.put(&format!("/simulation/{id}"), &record) {
        // A motion that grows beyond all numbers takes no other one with it.
        let Some(WriteError::Impossible { field, value, .. }) = error.downcast_ref() else { return Err(error) };
        let text = format!("{id} is left out: its {field} is {value:e}, which is no number of a vehicle");
        out.notes().concern(About::Model(id.to_owned()), Weight::Slight, text);
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

/// Numbers that the fit was free to choose, or the person who stated a chain.
///
/// Of a model by name: its springs, dampers and knots. Of a fitted chain: what its record says was free (an interval, a
/// place in the correlation, or a bound it stopped on), without a mass that is the rest of the total. Of a stated
/// chain, and of a fitted one that says nothing of it: all springs, dampers and knots.
pub fn fitted_parameters(candidate: &CandidateV1, model: &Result<Model, LumpedError>) -> u32 {
    if let Some(model) = model.as_ref().ok().filter(|model| !matches!(model, Model::Chain(_))) {
        return numbers_of(model);
    }
    let names = || candidate.parameters.keys();
    let is_mass = |name: &str| Chain::parameter_kind(name) == Some(ParameterKind::Mass);
    let Some(known) = &candidate.uncertainty else {
        return names().filter(|name| !is_mass(name)).count() as u32;
    };
    let on_bound = candidate.fit.as_ref().map_or(&[][..], |fit| &fit.active_bounds);
    let free = |name: &&String| {
        let fitted = known.order.contains(name) || on_bound.contains(name);
        // A mass with an interval and nothing else follows from the total.
        fitted || (!is_mass(name) && known.interval_low.contains_key(*name))
    };
    names().filter(free).count() as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_lumped::Kelvin;
    use crumple_stage::records::{FitV1, UncertaintyV1};
    use std::collections::BTreeMap;

    const NAMES: [&str; 6] = ["m1_kg", "k1_n_per_m", "c1_n_s_per_m", "m2_kg", "k2_n_per_m", "c2_n_s_per_m"];

    fn stated() -> CandidateV1 {
        CandidateV1 {
            model: "chain".to_owned(),
            method: "car".to_owned(),
            parameters: NAMES.iter().map(|name| ((*name).to_owned(), 1.0)).collect(),
            physical: true,
            equivalent_to: None,
            fit: None,
            uncertainty: None,
            notes: vec![],
        }
    }

    /// A chain of which m1, k1 and k2 were free, k2 stopped on a bound and m2 is the rest.
    fn fitted() -> CandidateV1 {
        let names = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<String>>();
        let interval: BTreeMap<String, Option<f64>> =
            names(&["m1_kg", "k1_n_per_m", "k2_n_per_m", "m2_kg"]).into_iter().map(|name| (name, Some(1.0))).collect();
        CandidateV1 {
            fit: Some(FitV1 {
                channel: "103".to_owned(),
                quantity: "displacement".to_owned(),
                from_s: 0.0,
                to_s: 0.08,
                samples: 250,
                rmse: 1e-3,
                iterations: 9,
                evaluations: 90,
                stop_reason: "cost-converged".to_owned(),
                active_bounds: names(&["k2_n_per_m"]),
                sensors: vec![],
            }),
            uncertainty: Some(UncertaintyV1 {
                order: names(&["m1_kg", "k1_n_per_m"]),
                interval_low: interval.clone(),
                interval_high: interval,
                ..UncertaintyV1::default()
            }),
            ..stated()
        }
    }

    fn count(record: &CandidateV1) -> u32 {
        fitted_parameters(record, &Model::read(&record.model, &record.parameters))
    }

    #[test]
    fn only_what_was_free_of_a_fitted_chain_is_counted() {
        assert_eq!(count(&fitted()), 3);
    }

    #[test]
    fn what_a_person_stated_was_chosen_by_a_person() {
        assert_eq!(count(&stated()), 4);
        assert_eq!(count(&CandidateV1 { uncertainty: None, ..fitted() }), 4);
    }

    #[test]
    fn a_model_by_name_counts_as_ever() {
        let kelvin = Model::Kelvin(Kelvin { mass_kg: 1.0, stiffness_n_per_m: 1.0, damping_n_s_per_m: 1.0 });
        assert_eq!(fitted_parameters(&stated(), &Ok(kelvin)), 2);
    }
}
