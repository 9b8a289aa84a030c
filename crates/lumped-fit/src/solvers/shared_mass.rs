//! The sensors that a model is fitted to: those on its masses, one place on each.

use crumple_signal::Notes;

use crate::solvers::task::{Task, mass_count};
use crate::{FitQuantity, Sensor, SensorPlace};

/// Why a model cannot be fitted: sensors of two different places are on one of its masses, which has one motion. One
/// channel named for two places is one sensor; two channels of one place are two measurements of it, and allowed.
pub(crate) fn shared_mass(places: &[(SensorPlace, &str)], count: usize) -> Option<String> {
    let on_masses = || places.iter().filter_map(|(place, channel)| Some((place.mass(count)?, *place, *channel)));
    let (mass, first, second) = on_masses().enumerate().find_map(|(k, (mass, place, channel))| {
        let mut before = on_masses().take(k);
        let other = before.find(|(m, p, c)| *m == mass && *p != place && *c != channel)?;
        Some((mass, (other.1, other.2), (place, channel)))
    })?;
    // The compartment is the pulse, which every fit needs: the other one has to go.
    let goes = if second.0 == SensorPlace::Compartment { first } else { second };
    let instead = match goes.0 {
        SensorPlace::Mass(1) if count == 1 => {
            format!("write front={} in sensors instead, which a model of one mass is not fitted to", goes.1)
        }
        place => format!("leave {place}={} out of sensors, or this model out of models", goes.1),
    };
    Some(format!(
        "not fitted: sensors {} ({}) and {} ({}) both fall on mass {} of its {count}, which moves one way only; \
         {instead}",
        first.1,
        first.0,
        second.1,
        second.0,
        mass + 1
    ))
}

/// The sensors on masses of the model, each with the index of its mass; without any the displacement of the
/// compartment. `None`, with a warning, where there is nothing to fit, or where [`shared_mass`] gives a reason.
pub(super) fn sensors_of<'a>(task: &Task<'a>, notes: &mut Notes) -> Option<Vec<(usize, Sensor<'a>)>> {
    let count = mass_count(task.model);
    let places: Vec<_> = task.test.sensors.iter().map(|sensor| (sensor.place, sensor.channel)).collect();
    if let Some(reason) = shared_mass(&places, count) {
        notes.warning(format!("{}: {reason}", task.model));
        return None;
    }
    let mut sensors = Vec::new();
    for sensor in task.test.sensors {
        match sensor.place.mass(count) {
            Some(mass) => sensors.push((mass, *sensor)),
            None => notes.info(format!(
                "{}: sensor {} is on the {}, which this model does not have: not fitted",
                task.model, sensor.channel, sensor.place
            )),
        }
    }
    if sensors.is_empty() && task.settings.quantity == FitQuantity::Displacement {
        sensors.extend(pulse(task).map(|pulse| (count - 1, pulse)));
    }
    if sensors.is_empty() {
        notes.warning(format!("{}: not fitted, there is no {} of the compartment", task.model, task.settings.quantity));
        return None;
    }
    Some(sensors)
}

/// The displacement of the pulse as a sensor on the compartment.
pub(super) fn pulse<'a>(task: &Task<'a>) -> Option<Sensor<'a>> {
    let test = task.test;
    test.displacement.map(|displacement| Sensor {
        channel: "",
        place: SensorPlace::Compartment,
        quantity: FitQuantity::Displacement,
        record: displacement,
        measurement: test.measurement,
        noise: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_places_on_one_mass_leave_the_model_out_and_say_what_to_write() {
        let stated =
            [(SensorPlace::Compartment, "floor"), (SensorPlace::Mass(1), "front"), (SensorPlace::Mass(2), "engine")];
        assert_eq!(shared_mass(&stated, 3), None);
        assert_eq!(
            shared_mass(&stated, 2).unwrap(),
            "not fitted: sensors floor (compartment) and engine (m2) both fall on mass 2 of its 2, which moves one way \
             only; leave m2=engine out of sensors, or this model out of models"
        );
        let reason = shared_mass(&stated, 1).unwrap();
        assert!(
            reason.ends_with("write front=front in sensors instead, which a model of one mass is not fitted to"),
            "{reason}"
        );
        // Front and chassis are one mass of two; a model of one has neither.
        let parts = [(SensorPlace::Front, "a"), (SensorPlace::Chassis, "b"), (SensorPlace::Compartment, "c")];
        assert!(shared_mass(&parts, 2).unwrap().contains("a (front) and b (chassis) both fall on mass 1"));
        assert_eq!(shared_mass(&parts, 1), None);
    }

    #[test]
    fn a_sensor_named_for_two_places_and_two_sensors_of_one_place_are_no_conflict() {
        assert_eq!(shared_mass(&[(SensorPlace::Compartment, "93"), (SensorPlace::Mass(2), "93")], 2), None);
        assert_eq!(shared_mass(&[(SensorPlace::Compartment, "93"), (SensorPlace::Compartment, "94")], 2), None);
    }
}
