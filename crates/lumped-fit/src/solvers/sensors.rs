//! Any model fitted to acceleration, velocity or displacement of one or several sensors.

use crumple_lumped::{Model, ModelKind, Parameter, ParameterKind};
use crumple_signal::Notes;

use crate::fit::options::SingleMassFitOptions;
use crate::fit::sensors::fit::{Search, fit_sensors};
use crate::fit::sensors::problem::SensorWindow;
use crate::free::model_coordinates::{ModelCoordinates, Scale};
use crate::record::window::Window;
use crate::solvers::sensor_report::Report;
use crate::solvers::task::{Task, mass_count};
use crate::{
    Candidate, FitQuantity, MassFit, Method, Sensor, SensorPlace, SolveError, elastoplastic_from_events,
    fit_nonlinear1, fit_nonlinear2, kelvin_from_events, masses, triple_masses,
};

/// The fit of the table, by descents or by L-SHADE.
///
/// The window ends with dynamic crush, or with rebound for the elastoplastic model, whose unloading shows only after
/// the crush. Noise levels that are not stated are found from the residuals. A start is the closed form of the
/// events, or the fit of the nonlinear model to the displacement, beside evenly spread ones. Errors: masses without
/// meaning, a window outside a record.
pub(crate) fn fit(task: &Task<'_>, notes: &mut Notes) -> Result<Vec<Candidate>, SolveError> {
    let (kind, test, settings) = (task.model, task.test, task.settings);
    let count = mass_count(kind);
    let (masses_kg, split) = match kind {
        ModelKind::DoubleSpringMassDamper => {
            let (m1, m2, text) = masses(test.mass_kg, settings.split)?;
            (vec![m1, m2], Some(text))
        }
        ModelKind::TripleSpringMassDamper => {
            let (masses, text) = triple_masses(test.mass_kg, settings.split, settings.triple)?;
            (masses.to_vec(), Some(text))
        }
        _ => (vec![test.mass_kg], None),
    };
    let Some(sensors) = sensors_of(task, count, notes) else { return Ok(Vec::new()) };
    let to_s = window_end(task);
    let mut observed = Vec::new();
    for (mass, sensor) in &sensors {
        let window = Window::pick(sensor.record, test.time_zero_s, settings.fit_from_s, to_s, settings.fit_samples)?;
        let noise = sensor.noise.unwrap_or(1.0);
        let mut sensor_window = SensorWindow { mass: *mass, quantity: sensor.quantity, window, noise };
        if sensor.noise.is_none() {
            sensor_window.noise = sensor_window.size().max(f64::MIN_POSITIVE);
        }
        observed.push(sensor_window);
    }
    let length_s = observed.iter().map(|o| o.window.last_s()).fold(0.0, f64::max);
    let scale = Scale {
        impact_speed_m_per_s: test.impact_speed_m_per_s,
        length_s,
        // Without a crush the spring of the nonlinear models has no last knot; the way at full speed stands for it.
        crush_m: test.dynamic_crush_m.unwrap_or(test.impact_speed_m_per_s * length_s),
        release: settings.release,
    };
    let coordinates = ModelCoordinates::new(kind, &masses_kg, settings.mass_fit, &scale);
    let search = match task.method {
        Method::LShade => Search::LShade(settings.l_shade),
        _ => {
            let starts = settings.fit_starts.max(6 * coordinates.free.len());
            Search::Starts(starts, given_starts(task, &coordinates, &masses_kg, to_s))
        }
    };
    let weigh: Vec<bool> = sensors.iter().map(|(_, sensor)| sensor.noise.is_none()).collect();
    let Some(mut fitted) = fit_sensors(&coordinates, test.impact_speed_m_per_s, observed, &weigh, &search) else {
        notes.warning(format!("{kind}: {}", SolveError::NoFit { starts: settings.fit_starts }));
        return Ok(Vec::new());
    };
    let mut remarks = Vec::new();
    if let Some(text) = &split {
        notes.info(format!("{kind}: {text}"));
        remarks.push(match settings.mass_fit {
            MassFit::Known => text.clone(),
            MassFit::Shares { lower, upper } => format!(
                "masses fitted: total {:.1} kg known, each but the last between {lower} and {upper} of what is left \
                 behind it",
                masses_kg.iter().sum::<f64>()
            ),
        });
    }
    remarks.append(&mut fitted.remarks);
    let report = Report { task, coordinates: &coordinates, sensors: &sensors, fitted: &fitted };
    if kind == ModelKind::DoubleSpringMassDamper && sensors.iter().all(|(mass, _)| *mass == 1) {
        Ok(report.pairs(&remarks, notes))
    } else {
        Ok(report.candidates(&remarks, notes))
    }
}

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
fn sensors_of<'a>(task: &Task<'a>, count: usize, notes: &mut Notes) -> Option<Vec<(usize, Sensor<'a>)>> {
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
    if sensors.is_empty()
        && task.settings.quantity == FitQuantity::Displacement
        && let Some(displacement) = task.test.displacement
    {
        let compartment = Sensor {
            channel: "",
            place: SensorPlace::Compartment,
            quantity: FitQuantity::Displacement,
            record: displacement,
            noise: None,
        };
        sensors.push((count - 1, compartment));
    }
    if sensors.is_empty() {
        notes.warning(format!("{}: not fitted, there is no {} of the compartment", task.model, task.settings.quantity));
        return None;
    }
    Some(sensors)
}

/// End of the window, s after time zero: that of the settings, else dynamic crush, for the elastoplastic model
/// rebound. `None`: the end of the record.
fn window_end(task: &Task<'_>) -> Option<f64> {
    let crush = task.test.time_of_dynamic_crush_s;
    task.settings.fit_to_s.or(match task.model {
        ModelKind::Elastoplastic => crush.and(task.test.time_of_rebound_s),
        _ => crush,
    })
}

/// Springs and dampers elsewhere than at the soft place of [`one_soft_pair`], as multiples of those there.
const NEARLY_RIGID: f64 = 100.0;
/// Least damper of [`one_soft_pair`], in units of mass over time of crush: searches in logarithms cannot start at
/// zero.
const SOME_DAMPING: f64 = 0.01;

/// A chain that is nearly one mass: the Kelvin model of this crush and time at one place, with all masses behind it,
/// and nearly rigid elsewhere. A start of the search for chains: one for each place.
fn one_soft_pair(
    kind: ModelKind,
    masses_kg: &[f64],
    soft: usize,
    v0: f64,
    (time_s, crush_m): (f64, f64),
) -> Option<Model> {
    let behind_kg: f64 = masses_kg[soft..].iter().sum();
    let kelvin = kelvin_from_events(behind_kg, v0, time_s, crush_m).ok()?.model;
    let damper = kelvin.damping_n_s_per_m.max(SOME_DAMPING * behind_kg / time_s);
    let value = |index: usize, parameter: &Parameter| -> Option<f64> {
        let place = kind.parameters()[..index].iter().filter(|before| before.kind == parameter.kind).count();
        let rigid = if place == soft { 1.0 } else { NEARLY_RIGID };
        Some(match parameter.kind {
            ParameterKind::Mass => *masses_kg.get(place)?,
            ParameterKind::Stiffness => rigid * kelvin.stiffness_n_per_m,
            _ => rigid * damper,
        })
    };
    let named = kind.parameters().iter().enumerate().map(|(k, p)| Some((p.name.to_owned(), value(k, p)?)));
    Model::from_parameters(kind, &named.collect::<Option<_>>()?).ok()
}

/// Starts that other solvers give: closed forms of the events, and the fit of a nonlinear model to the displacement.
fn given_starts(
    task: &Task<'_>,
    coordinates: &ModelCoordinates,
    masses_kg: &[f64],
    to_s: Option<f64>,
) -> Vec<Vec<f64>> {
    let e = task.test;
    let events = e.time_of_dynamic_crush_s.zip(e.dynamic_crush_m);
    let (v0, m) = (e.impact_speed_m_per_s, e.mass_kg);
    if let (ModelKind::DoubleSpringMassDamper | ModelKind::TripleSpringMassDamper, Some(crush)) = (task.model, events) {
        let places = 0..masses_kg.len();
        let models = places.filter_map(|soft| one_soft_pair(task.model, masses_kg, soft, v0, crush));
        return models.map(|model| coordinates.theta(&model)).collect();
    }
    let model = match (task.model, events, e.displacement) {
        (ModelKind::Kelvin, Some((t, c)), _) => kelvin_from_events(m, v0, t, c).ok().map(|s| Model::Kelvin(s.model)),
        (ModelKind::Elastoplastic, Some((_, c)), _) => {
            let restitution = e.coefficient_of_restitution.filter(|e| *e > 0.0).unwrap_or(0.2);
            elastoplastic_from_events(m, v0, c, restitution).ok().map(Model::Elastoplastic)
        }
        (ModelKind::Nonlinear1 | ModelKind::Nonlinear2, Some((t, c)), Some(displacement)) => {
            let options = SingleMassFitOptions {
                mass_kg: m,
                impact_speed_m_per_s: v0,
                crush_m: c,
                time_of_dynamic_crush_s: t,
                time_zero_s: e.time_zero_s,
                from_s: task.settings.fit_from_s,
                to_s,
                samples: task.settings.fit_samples,
            };
            if task.model == ModelKind::Nonlinear1 {
                fit_nonlinear1(displacement, &options, false).ok().map(|(model, _)| Model::Nonlinear1(model))
            } else {
                fit_nonlinear2(displacement, &options).ok().map(|(model, ..)| Model::Nonlinear2(model))
            }
        }
        _ => None,
    };
    model.iter().map(|model| coordinates.theta(model)).collect()
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
