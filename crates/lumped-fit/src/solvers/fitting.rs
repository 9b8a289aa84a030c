//! The one fit of all solvers: the sensors on the masses of a model, their waves as measured, and the candidate that a
//! start leads to.

use crumple_lumped::{Elastoplastic, Model, ModelKind, Nonlinear1, ParameterKind};
use crumple_signal::{About, Measurement, Note, Notes, Weight, remarks};

use crate::candidate::{Candidate, Fit, Minimum, bounds_remark, fixed_at_bound};
use crate::closed_form::unloads_rigidly;
use crate::coordinates::{MassFit, largest_of_chain};
use crate::error::SolveError;
use crate::fit::as_measured::{fit_as_measured, fit_nearby};
use crate::parameters::{FitParameter, free_masses, free_parameters, mass_of};
use crate::record::observation::{Observation, ObservedWave};
use crate::record::sensor::{FitQuantity, Sensor, SensorPlace, errors_in_words, note_of_errors};
use crate::solvers::table::{Task, mass_count, row_of};
use crate::uncertainty::acceleration_likelihood::acceleration_misfit;

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
        notes.push(SharedMass { model: task.model.to_string(), reason });
        return None;
    }
    let mut sensors = Vec::new();
    for sensor in task.test.sensors {
        match sensor.place.mass(count) {
            Some(mass) => sensors.push((mass, *sensor)),
            None => notes.push(SensorElsewhere {
                model: task.model.to_string(),
                channel: sensor.channel.to_owned(),
                place: sensor.place.to_string(),
            }),
        }
    }
    if sensors.is_empty() && task.settings.quantity == FitQuantity::Displacement {
        sensors.extend(pulse(task).map(|pulse| (count - 1, pulse)));
    }
    if sensors.is_empty() {
        let what = format!("{} of the compartment", task.settings.quantity);
        notes.push(NothingToFit { model: task.model.to_string(), what });
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

/// Half a swing on the unloading stiffness below which nothing tells whether the mass stays on it, s. A swing of twice
/// as long is one of 100 Hz, where CFC 60 leaves 0.7 of it (SAE J211-1).
const UNSEEN_HALF_SWING_S: f64 = 5e-3;

/// Whether a mass that stayed on its spring after unloading would swing too fast to be seen, or its unloading is rigid.
fn leaves_at_once(model: &Elastoplastic) -> bool {
    let half_swing_s = std::f64::consts::PI * (model.mass_kg / model.unloading_stiffness_n_per_m).sqrt();
    half_swing_s < UNSEEN_HALF_SWING_S || unloads_rigidly(model)
}

/// Rounds of weighing sensors, and the change of a weight that is worth another one.
const WEIGHINGS: usize = 4;
const WORTH_ANOTHER: f64 = 0.01;
/// The first nonlinear model keeps its conditions at dynamic crush where the minimum without them misses crush or time
/// by more than this share: the filter itself moves the time of a crush that ends steeply by 0.1 ms and more.
const CONDITIONS: f64 = 5e-3;

/// Where a fit starts, and what was spent to come there.
#[derive(Debug, Clone)]
pub(super) struct FitStart {
    /// The model.
    pub model: Model,
    /// Parameters that a search left on a bound.
    pub on_bound: Vec<String>,
    /// Iterations of the search that ended here.
    pub iterations: u32,
    /// Model evaluations of all its starts.
    pub evaluations: u64,
    /// Whether springs and dampers stay within the bounds of the search.
    pub within_search: bool,
}

impl FitStart {
    /// A start that was computed, and not searched for.
    pub fn computed(model: Model) -> Self {
        Self { model, on_bound: Vec::new(), iterations: 0, evaluations: 0, within_search: false }
    }
}

/// The waves that a model is fitted to.
pub(super) struct FitTask<'a> {
    /// What was asked for.
    pub task: &'a Task<'a>,
    /// The sensors on masses of the model, each with the index of its mass.
    pub sensors: Vec<(usize, Sensor<'a>)>,
    /// Their waves in the window, as measured, with their weights.
    pub observed: Observation,
    /// Dynamic crush; without one the largest displacement, m: the scale of springs and dampers.
    pub crush_m: f64,
}

impl<'a> FitTask<'a> {
    /// The sensors of a task up to `to_s` after time zero (`None`: the end of each record). `None`, with a warning,
    /// where there is nothing to fit. Errors: a window outside a record.
    pub fn of_sensors(task: &'a Task<'a>, to_s: Option<f64>, notes: &mut Notes) -> Result<Option<Self>, SolveError> {
        sensors_of(task, notes).map(|sensors| Self::new(task, sensors, to_s)).transpose()
    }

    /// The displacement of the pulse alone. `None` without one.
    pub fn of_pulse(task: &'a Task<'a>, to_s: Option<f64>) -> Result<Option<Self>, SolveError> {
        let sensors = pulse(task).map(|sensor| vec![(mass_count(task.model) - 1, sensor)]);
        sensors.map(|sensors| Self::new(task, sensors, to_s)).transpose()
    }

    fn new(task: &'a Task<'a>, sensors: Vec<(usize, Sensor<'a>)>, to_s: Option<f64>) -> Result<Self, SolveError> {
        let (test, settings) = (task.test, task.settings);
        let wave = |(mass, sensor): &(usize, Sensor<'a>)| -> Result<ObservedWave, SolveError> {
            let end_s = to_s.unwrap_or(sensor.record.end_s());
            let measurement = sensor.measurement.unwrap_or_else(|| Measurement::of_samples(sensor.record));
            let what = (Some(*mass), sensor.quantity);
            let window_s = (settings.fit_from_s, end_s);
            let samples = settings.fit_samples;
            let wave = ObservedWave::new(sensor.record, what, measurement, window_s, samples)?;
            Ok(ObservedWave { noise: sensor.noise, ..wave })
        };
        let waves = sensors.iter().map(wave).collect::<Result<Vec<_>, _>>()?;
        let observed = Observation { impact_speed_m_per_s: test.impact_speed_m_per_s, waves };
        let observed = observed.limited(settings.searches());
        let largest = || test.displacement.map(|x| x.samples().iter().copied().fold(0.0, f64::max));
        let crush_m = test.dynamic_crush_m.or_else(largest).filter(|crush| *crush > 0.0);
        let crush_m = crush_m.unwrap_or_else(|| test.impact_speed_m_per_s * end_s(&observed));
        Ok(Self { task, sensors, observed, crush_m })
    }

    /// Time of the last sample that is compared, s after contact.
    pub fn end_s(&self) -> f64 {
        end_s(&self.observed)
    }

    /// The minimum that a start leads to, with the weights that the waves have now. An elastoplastic model that is
    /// fitted to the pulse alone leaves the barrier or stays attached, as can meet the acceleration better: an error of
    /// the zero level, summed twice, hides when the force ends.
    pub fn minimum(&self, start: &FitStart) -> Option<Minimum> {
        let fit = |model: &Model| {
            let mut free = free_parameters(model, self.observed.impact_speed_m_per_s, self.crush_m);
            if let MassFit::Shares { lower, upper } = self.task.settings.mass_fit {
                free.extend(free_masses(model, (lower, upper)));
            }
            let fixed = fixed_at_bound(model, &start.on_bound, self.end_s());
            free.retain(|parameter| !fixed.contains(&&*parameter.name));
            if start.within_search {
                within_the_search(&mut free, model, self.end_s());
            }
            fit_as_measured(model, &free, &self.observed)
        };
        match &start.model {
            Model::Elastoplastic(model) if self.task.fits_displacement_alone() && !leaves_at_once(model) => {
                let both = [true, false].map(|release| fit(&Model::Elastoplastic(Elastoplastic { release, ..*model })));
                let misfit = |minimum: &Minimum| acceleration_misfit(minimum).unwrap_or(f64::INFINITY);
                both.into_iter().flatten().min_by(|a, b| misfit(a).total_cmp(&misfit(b)))
            }
            Model::Elastoplastic(model) if self.task.fits_displacement_alone() => {
                fit(&Model::Elastoplastic(Elastoplastic { release: true, ..*model }))
            }
            model => fit(model),
        }
    }

    /// The same, with the waves weighed by their misfits there, in turn with the fit.
    pub fn weighed_minimum(&mut self, start: &FitStart) -> Option<Minimum> {
        let mut minimum = self.minimum(start)?;
        for _ in 0..WEIGHINGS {
            if !self.observed.weigh(&self.observed.rmse(&minimum.misfit_m), WORTH_ANOTHER) {
                break;
            }
            minimum = fit_as_measured(&minimum.model, &minimum.free, &self.observed)?;
        }
        Some(minimum)
    }

    /// The minimum near a start that is close already, with the waves weighed by their misfits there, in turn with the
    /// fit.
    pub fn weighed_nearby(&mut self, start: &Model, free: &[FitParameter]) -> Option<Minimum> {
        let mut minimum = fit_nearby(start, free, &self.observed)?;
        for _ in 0..WEIGHINGS {
            let weighed = self.observed.weigh(&self.observed.rmse(&minimum.misfit_m), WORTH_ANOTHER);
            // What came near zero, or left it, goes on in another coordinate: zero is an answer, not a bound.
            let free = minimum.redescribed();
            let redescribed =
                free.iter().zip(&minimum.free).any(|(new, old)| new.is_logarithmic() != old.is_logarithmic());
            if !(weighed || redescribed) {
                break;
            }
            minimum = fit_nearby(&minimum.model, &free, &self.observed)?;
        }
        Some(minimum)
    }

    /// The error of each sensor in words: `8.1 mm at 93 (compartment)`.
    pub fn errors(&self, misfit: &[f64]) -> String {
        let errors = self.sensors.iter().zip(self.observed.rmse(misfit));
        errors_in_words(errors.map(|((_, s), rmse)| (rmse, s.quantity, s.channel, s.place.to_string())))
    }

    /// A minimum as candidate number `index`, with `remarks`, the window, errors of several sensors, active bounds and
    /// broken side constraints for notes.
    pub fn candidate(&self, start: &FitStart, minimum: Minimum, index: usize, remarks: &[String]) -> Candidate {
        let model = minimum.model.clone();
        let mut active_bounds = start.on_bound.clone();
        active_bounds.retain(|name| minimum.free.iter().all(|p| p.name != *name));
        active_bounds.extend(minimum.names_on_bound());
        // The displacement of the pulse alone needs no name.
        let several = !self.task.fits_displacement_alone();
        let number = |mass: usize, sensor: &Sensor<'_>| if sensor.place == SensorPlace::Wall { 0 } else { mass + 1 };
        let named = self.sensors.iter().filter(|_| several);
        let named = named.map(|(mass, s)| (s.channel.to_owned(), number(*mass, s))).collect();
        let descent =
            (start.iterations + minimum.iterations, start.evaluations + minimum.evaluations, minimum.stop_reason);
        let fit = Fit::of_waves(&self.observed, &self.observed.rmse(&minimum.misfit_m), named, descent, active_bounds);
        let mut notes = remarks.iter().map(Note::info).collect::<Vec<_>>();
        notes.push(window_note(&fit));
        if self.sensors.len() > 1 {
            let seen = self.observed.is_as_measured().then_some("through the filter");
            notes.push(Note::info(note_of_errors(&self.errors(&minimum.misfit_m), seen)));
        }
        notes.extend(bounds_remark(&model, &fit.active_bounds).map(Note::info));
        notes.extend(broken_side_constraints(&model).map(Note::warning));
        if let Model::Elastoplastic(model) = &model
            && self.task.fits_displacement_alone()
        {
            let chosen = if model.release { "leaves the barrier at rebound" } else { "stays attached and swings on" };
            let text = format!("the model {chosen}: fits the record up to rebound better than the alternative");
            notes.push(Note::info(text));
        }
        Candidate { fit: Some(fit), minimum: Some(minimum), index, ..computed(self.task, model, notes) }
    }

    /// The side conditions of the first nonlinear model: order of the coefficients, crush and time of the record.
    pub fn meets_conditions(&self, model: &Nonlinear1) -> bool {
        let test = self.task.test;
        let ordered = model.k1_n_per_m <= model.k2_n_per_m
            && model.c1_n_s_per_m >= model.c2_n_s_per_m
            && model.c2_n_s_per_m >= model.c3_n_s_per_m;
        let Some(crush_m) = test.dynamic_crush_m else { return ordered };
        let events = Model::Nonlinear1(*model).events(test.impact_speed_m_per_s).ok();
        let of_model = events.and_then(|e| e.dynamic_crush_m.zip(e.time_of_dynamic_crush_s));
        let near = |of_model: f64, of_record: f64| (of_model / of_record - 1.0).abs() <= CONDITIONS;
        ordered
            && of_model
                .zip(test.time_of_dynamic_crush_s)
                .is_some_and(|((crush, time), record_time)| near(crush, crush_m) && near(time, record_time))
    }
}

fn end_s(observed: &Observation) -> f64 {
    observed.waves.iter().map(|wave| wave.window_s().1).fold(0.0, f64::max)
}

/// A candidate of no fit.
pub(super) fn computed(task: &Task<'_>, model: Model, notes: Vec<Note>) -> Candidate {
    Candidate::new(model, task.method, 1, notes)
}

/// The note on the window of a fit.
pub(super) fn window_note(fit: &Fit) -> Note {
    let (from_ms, to_ms) = (1e3 * fit.from_s, 1e3 * fit.to_s);
    Note::info(format!("fitted to {} from {from_ms:.2} ms to {to_ms:.2} ms after time zero", fit.quantity))
}

/// Keeps springs and dampers of a chain within the stiff bounds of the search; they may go to zero.
fn within_the_search(free: &mut [FitParameter], model: &Model, window_s: f64) {
    let (stiffest, strongest) = largest_of_chain(mass_of(model), window_s);
    let values = model.values();
    for parameter in free {
        let largest = match parameter.kind {
            ParameterKind::Damping => strongest,
            ParameterKind::Stiffness => stiffest,
            _ => continue,
        };
        *parameter = parameter.with_limit(parameter.limit.min(largest.max(values[parameter.index])));
    }
}

/// The note on the side constraints of the single-mass paper that a first nonlinear model breaks: this fit has bounds
/// only.
fn broken_side_constraints(model: &Model) -> Option<String> {
    let Model::Nonlinear1(m) = model else { return None };
    let broken: Vec<&str> = [
        (m.k1_n_per_m > m.k2_n_per_m, "k1 <= k2"),
        (m.c1_n_s_per_m < m.c2_n_s_per_m, "c1 >= c2"),
        (m.c2_n_s_per_m < m.c3_n_s_per_m, "c2 >= c3"),
    ]
    .into_iter()
    .filter_map(|(broken, constraint)| broken.then_some(constraint))
    .collect();
    (!broken.is_empty()).then(|| {
        format!(
            "breaks the side constraints of the paper, {}, which this fit does not know: direct-fit and interior-point \
             to the displacement of the pulse keep them",
            broken.join(" and ")
        )
    })
}

impl NothingToFit {
    /// Of a model that is fitted to the displacement of the pulse.
    pub(super) fn displacement(model: ModelKind) -> Self {
        Self { model: model.to_string(), what: "displacement".to_owned() }
    }
}

remarks! {
    /// Remarks of sensors on the masses of models.
    pub REMARKS;

    /// Two sensors of different places fall on one mass of a model.
    CR516 SharedMass { model: String, reason: String }
    bears on (row_of(model), Weight::Slight)
    decided "Each place is on one mass of the model, and a mass has one motion. Several channels of one place are \
             several measurements of it, and are allowed."
    means "The model is left out. Models that have a mass for each of the places are fitted."
    remedy "write in sensors what the sentence says, or leave the model out of models"
    says format!("{model}: {reason}");

    /// A sensor is on a part that the model does not have.
    CR517 SensorElsewhere { model: String, channel: String, place: String }
    bears on (About::Model(String::new()), Weight::None)
    decided "The place of the sensor is looked for among the masses of the model."
    means "The model is fitted without this sensor."
    remedy "nothing; a model with more masses uses the sensor"
    says format!("{model}: sensor {channel} is on the {place}, which this model does not have: not fitted");

    /// The motion that a model is fitted to is not there.
    CR518 NothingToFit { model: String, what: String }
    bears on (row_of(model), Weight::Slight)
    decided "A fit needs the displacement of the pulse, or the motion of a sensor that fit_quantity names."
    means "The model has no fitted candidate."
    remedy "give the artifact of integrate, or name a sensor on a mass of the model: sensors"
    says format!("{model}: not fitted, there is no {what}");
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

    #[test]
    fn broken_side_constraints_are_named() {
        let kept = Nonlinear1 {
            mass_kg: 900.0,
            k1_n_per_m: 1e5,
            k2_n_per_m: 3e5,
            c1_n_s_per_m: 3e4,
            c2_n_s_per_m: 1e4,
            c3_n_s_per_m: 1e4,
            v_thresh_m_per_s: 3.0,
            crush_m: 0.5,
            v0_m_per_s: 12.0,
        };
        assert_eq!(broken_side_constraints(&Model::Nonlinear1(kept)), None);
        let broken = Nonlinear1 { k1_n_per_m: 4e5, c3_n_s_per_m: 2e4, ..kept };
        let text = broken_side_constraints(&Model::Nonlinear1(broken)).unwrap();
        assert!(text.starts_with("breaks the side constraints of the paper, k1 <= k2 and c2 >= c3"), "{text}");
    }
}
