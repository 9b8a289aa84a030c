//! The test as candidates are compared with it, read from the artifacts; and what a candidate carries of it.

use crumple_lumped_fit::{Comparison, Evaluation, FitQuantity, Measured, MeasuredTest, SensorPlace};
use crumple_signal::{About, Notes, Weight, remarks};
use crumple_stage::Inputs;
use crumple_stage::records::{EvaluationV1, EventsV1};

use crate::stage::inputs::{Displaced, displacement_of, motion};
use crate::stage::options::PlacedSensor;
use crate::stage::settings::StageSettings;

/// Reads the records that candidates are compared with, from contact to dynamic crush or where the fit window ends.
/// `impact`: mass, kg, and speed, m/s. `None` where the displacement is not at hand, or too short.
pub fn measured_test(
    settings: &StageSettings,
    input: &Inputs,
    (events, displacement): (&EventsV1, Option<&Displaced>),
    (mass_kg, impact_speed_m_per_s): (f64, f64),
    notes: &mut Notes,
) -> anyhow::Result<Option<MeasuredTest>> {
    let Some(to_s) = settings.solve.fit_to_s.or(events.time_of_dynamic_crush_s) else { return Ok(None) };
    let Some((displacement, measurement)) = displacement else { return Ok(None) };
    let channel = &events.channel;
    let window_s = (settings.solve.fit_from_s, to_s);
    let of_pulse = Measured { wave: displacement, measurement: *measurement };
    let Ok(mut test) = MeasuredTest::new(channel, impact_speed_m_per_s, window_s, of_pulse) else { return Ok(None) };
    test.dynamic_crush = events.dynamic_crush_m.zip(events.time_of_dynamic_crush_s);
    test.restitution = events.coefficient_of_restitution;
    test.rebound_is_cut = events.still_separating;
    let acceleration_of = |channel: &str| motion(input, channel, FitQuantity::Acceleration, mass_kg).ok();
    if let Some(wave) = acceleration_of(channel) {
        let measurement = input.recording_steps(events, channel, &wave)?;
        test = test.with_acceleration(Measured { wave: &wave, measurement });
    }
    if test.acceleration.is_none() {
        return Ok(Some(test));
    }
    let on_other_masses = settings
        .places
        .iter()
        .filter(|sensor| !matches!(sensor.place, SensorPlace::Compartment | SensorPlace::Occupant | SensorPlace::Wall));
    for PlacedSensor { place, channel } in on_other_masses {
        let Some(wave) = acceleration_of(channel) else { continue };
        let acceleration = Measured { wave: &wave, measurement: input.recording_steps(events, channel, &wave)? };
        let displacement = displacement_of(input, events, channel)?;
        let displacement = displacement.as_ref().map(|(wave, steps)| Measured { wave, measurement: *steps });
        if test.add_sensor((channel, *place), acceleration, displacement).is_err() {
            notes.push(ZeroThroughout { channel: channel.clone() });
        }
    }
    let force = input.wall_force()?;
    let force = force.as_ref().map(|(wave, steps)| Measured { wave, measurement: *steps });
    Ok(Some(test.with_wall(force, |end_s| events.end_of_contact_s(end_s))))
}

/// The evaluation as its candidate carries it: of one test.
pub fn evaluation_record(comparison: &Comparison, evaluations: &[Evaluation]) -> Option<EvaluationV1> {
    let (test, [evaluation]) = (comparison.test()?, evaluations) else { return None };
    let (from_s, to_s) = test.window_s();
    Some(EvaluationV1 {
        from_s,
        to_s,
        fit_as_measured_percent: evaluation.fit_as_measured_percent,
        crush_error: evaluation.own_test.crush,
        time_error: evaluation.own_test.time,
        restitution_error: evaluation.own_test.restitution,
        coefficient_of_restitution: evaluation.restitution,
        force_misfit_percent: evaluation.force_misfit_percent,
        worst_sensor: evaluation.worst_sensor.as_ref().map(|(channel, _)| channel.clone()),
        worst_sensor_fit_percent: evaluation.worst_sensor.as_ref().map(|(_, fit)| *fit),
        crush_error_at_lower_speeds: evaluation.crush_error_at_lower_speeds,
    })
}

remarks! {
    /// Remarks of the comparison with the test.
    pub REMARKS;

    /// A sensor on another mass than the compartment recorded nothing but zeros.
    CR551 ZeroThroughout { channel: String }
    bears on (About::Channel(channel.clone()), Weight::Slight)
    decided "All samples of its acceleration between contact and dynamic crush are zero."
    means "Candidates are chosen by the other sensors."
    remedy "leave the channel out of sensors, or take another one of that place"
    says format!("channel {channel} is zero throughout: it does not take part in the choice");
}
