//! What each candidate brings into the choice: its misfit as measured, its restitution, what the record does not
//! identify.

use crumple_lumped::{HORIZON_S, Model, ModelKind, ParameterKind, Structure};
use crumple_lumped_fit::{
    ComparedCandidate, ComparedRecord, ComparedWave, EnergyClass, FitQuantity, Impact, LeastMisfit, Measurement,
    Observation, ObservedWave, OwnTestErrors, SensorPlace, WallForce, affects_predictions, crush_error_at_lower_speeds,
    least_without_shift, slow_misfit, without_shift,
};
use crumple_signal::{Notes, Sampled};
use crumple_stage::Inputs;
use crumple_stage::records::{Certainty, EventsV1};
use rayon::prelude::*;

use crate::stage::inputs::{Displaced, displacement_of, motion};
use crate::stage::options::PlacedSensor;
use crate::stage::records::AssessedCandidate;
use crate::stage::settings::StageSettings;

/// Share of the largest force at a knot, spring or damper of a model below which another is none.
const NO_FORCE: f64 = 1e-3;

/// A misfit beyond so many times the noise before the event is not explained by it wherever its least lies: fits to the
/// displacement of made records of three masses missed the acceleration by eight times its least at most.
const NEAR_NOISE: f64 = 10.0;
/// A misfit of another candidate that is at most so many times the noise says that the record is of some model, so that
/// a shift of time zero is what fits to the displacement may have followed.
const SOME_MODEL: f64 = 4.0;
/// The largest misfit over the noise that is brought to its least then: a shift of 0.35 ms of a pulse of 30 g behind
/// CFC 60 is 50 times the noise.
const NEAR_WHERE_SOME_MODEL: f64 = 100.0;

/// Parameters of which the bound is another parameter of the same model, by the side constraints of its paper: `k1 <=
/// k2`, `c1 >= c2 >= c3`. On it the two are one number, which says something of the vehicle.
const ORDERED: (ModelKind, [&str; 3]) = (ModelKind::Nonlinear1, ["k2_n_per_m", "c1_n_s_per_m", "c2_n_s_per_m"]);

/// The records that all candidates are compared with, from contact to dynamic crush: one test, or several whose
/// evidence adds up.
pub struct Comparison {
    tests: Vec<ComparedTest>,
}

/// The record of one test.
struct ComparedTest {
    /// Accelerations of the pulse and of the sensors on other masses, as shares of their sizes: what the evidence is
    /// of.
    acceleration: Observation,
    /// Channel of the pulse.
    channel: String,
    /// Those sensors, in the order of their waves.
    others: Vec<OtherSensor>,
    /// Displacement of the pulse: what closest means.
    displacement: Observation,
    /// Its dynamic crush, m, and the time of it, s.
    dynamic_crush: Option<(f64, f64)>,
    tested_restitution: Option<f64>,
    /// Whether its record ends before the rebound does, so that its restitution is a lower bound.
    rebound_is_cut: bool,
    /// Its mass, kg: where several tests stand side by side, each has its own; else it is that of the candidates.
    mass_kg: f64,
    /// Force on the wall up to separation.
    wall: Option<WallForce>,
}

/// A sensor on another mass than that of the pulse.
struct OtherSensor {
    channel: String,
    place: SensorPlace,
    displacement: Option<Observation>,
}

impl Comparison {
    /// Reads both waves up to `to_s` after time zero. `None` where one is not at hand or too short.
    pub fn read(
        settings: &StageSettings,
        input: &Inputs,
        (events, displacement): (&EventsV1, Option<&Displaced>),
        (mass_kg, impact_speed_m_per_s): (f64, f64),
        notes: &mut Notes,
    ) -> anyhow::Result<Option<Self>> {
        let channel = &events.channel;
        let Some(to_s) = settings.solve.fit_to_s.or(events.time_of_dynamic_crush_s) else { return Ok(None) };
        let Some((displacement, measurement)) = displacement else { return Ok(None) };
        let acceleration_of = |channel: &str| motion(input, channel, FitQuantity::Acceleration, mass_kg).ok();
        let Some(acceleration) = acceleration_of(channel) else { return Ok(None) };
        let as_measured = |wave: &Sampled, measurement: Measurement, quantity: FitQuantity| {
            let (window, what) = ((settings.solve.fit_from_s, to_s), (None, quantity));
            let wave = ObservedWave::new(wave, what, measurement, window, usize::MAX).ok()?;
            Some(Observation { impact_speed_m_per_s, waves: vec![wave] })
        };
        let observe = |channel: &str, wave: &Sampled| -> anyhow::Result<Option<Observation>> {
            let measurement = input.recording_steps(events, channel, wave)?;
            Ok(as_measured(wave, measurement, FitQuantity::Acceleration))
        };
        let displacement = as_measured(displacement, *measurement, FitQuantity::Displacement);
        let mut acceleration = observe(channel, &acceleration)?;
        let mut others = Vec::new();
        let on_other_masses = settings.places.iter().filter(|sensor| {
            !matches!(sensor.place, SensorPlace::Compartment | SensorPlace::Occupant | SensorPlace::Wall)
        });
        for PlacedSensor { place, channel } in on_other_masses {
            let Some(observed) = acceleration.as_mut() else { break };
            let Some(wave) = acceleration_of(channel) else { continue };
            let Some(mut other) = observe(channel, &wave)? else { continue };
            let sizes = observed.waves[0].size() / other.waves[0].size();
            if !sizes.is_finite() {
                notes.warning(format!("channel {channel} is zero throughout: it does not take part in the choice"));
                continue;
            }
            other.waves[0].weight = sizes;
            observed.waves.append(&mut other.waves);
            let displacement = displacement_of(input, events, channel)?
                .and_then(|(wave, measurement)| as_measured(&wave, measurement, FitQuantity::Displacement));
            others.push(OtherSensor { channel: channel.clone(), place: *place, displacement });
        }
        let wall = input.wall_force()?.and_then(|(force, steps)| {
            let to_s = events.end_of_contact_s(force.end_s());
            WallForce::new(&force, steps, to_s).ok()
        });
        Ok(acceleration.zip(displacement).map(|(acceleration, displacement)| Self {
            tests: vec![ComparedTest {
                acceleration,
                channel: channel.clone(),
                others,
                displacement,
                dynamic_crush: events.dynamic_crush_m.zip(events.time_of_dynamic_crush_s),
                tested_restitution: events.coefficient_of_restitution,
                rebound_is_cut: events.still_separating,
                mass_kg,
                wall,
            }],
        }))
    }

    /// Several tests side by side, each with its own mass.
    pub fn of_several(each: Vec<Self>) -> Self {
        let mut tests: Vec<ComparedTest> = each.into_iter().flat_map(|comparison| comparison.tests).collect();
        for test in &mut tests {
            let impact = Impact { speed_m_per_s: test.acceleration.impact_speed_m_per_s, mass_kg: Some(test.mass_kg) };
            for wave in test.acceleration.waves.iter_mut().chain(&mut test.displacement.waves) {
                wave.impact = Some(impact);
            }
        }
        Self { tests }
    }

    /// What is compared, in words.
    pub fn quantity(&self) -> String {
        let name = self.tests[0].wave().quantity.name();
        if self.tests.len() == 1 { name.to_owned() } else { format!("{name} over its root mean square") }
    }

    /// Channels whose records are compared.
    pub fn channels(&self) -> Vec<String> {
        let of_test = |test: &ComparedTest| {
            let others = test.others.iter().map(|other| other.channel.clone());
            std::iter::once(test.channel.clone()).chain(others).collect::<Vec<_>>()
        };
        self.tests.iter().flat_map(of_test).collect()
    }

    /// The compared window, s after time zero: the longest of several.
    pub fn window_s(&self) -> (f64, f64) {
        let ends = self.tests.iter().map(ComparedTest::window_s);
        ends.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or_default()
    }

    /// Samples compared.
    pub fn samples(&self) -> usize {
        self.tests.iter().map(|test| test.acceleration.rows()).sum()
    }

    /// Whether the models are sampled and filtered as the records were.
    pub fn is_as_measured(&self) -> bool {
        self.tests.iter().all(|test| test.acceleration.is_as_measured())
    }

    /// The records in numbers. Those of several tests are shares of the root mean square of each.
    pub fn record(&self) -> ComparedRecord {
        ComparedRecord {
            rms: if self.tests.len() == 1 { self.tests[0].wave().size() } else { 1.0 },
            waves: self.tests.iter().flat_map(ComparedTest::compared_waves).collect(),
            noise: match &self.tests[..] {
                [test] => test.noise(),
                _ => None,
            },
            restitution: geometric_mean(self.tests.iter().filter_map(ComparedTest::usual_restitution)),
        }
    }

    /// What the candidates bring, in their order.
    pub fn candidates(&self, assessed: &[&AssessedCandidate<'_>]) -> Vec<ComparedCandidate> {
        let mut compared: Vec<ComparedCandidate> =
            assessed.par_iter().map(|candidate| self.candidate(candidate, NEAR_NOISE)).collect();
        let Some(noise) = self.record().noise else { return compared };
        let times_noise = |candidate: &ComparedCandidate| {
            let misfit = candidate.misfit.as_deref()?;
            Some((misfit.iter().map(|e| e * e).sum::<f64>() / misfit.len() as f64).sqrt() / noise)
        };
        let is_some_model = |candidate: &ComparedCandidate| {
            candidate.physical && times_noise(candidate).is_some_and(|times| times <= SOME_MODEL)
        };
        if compared.iter().any(is_some_model) {
            // The others have been brought to their least.
            let far = compared.par_iter_mut().zip(assessed);
            far.filter(|(candidate, _)| times_noise(candidate).is_some_and(|times| times > NEAR_NOISE))
                .for_each(|(candidate, from)| *candidate = self.candidate(from, NEAR_WHERE_SOME_MODEL));
        }
        compared
    }

    fn candidate(&self, assessed: &AssessedCandidate<'_>, near: f64) -> ComparedCandidate {
        let AssessedCandidate { candidate, record } = assessed;
        let model = &candidate.model;
        let class = EnergyClass::of(model);
        let each: Vec<InTest> = self.tests.iter().map(|test| test.candidate(assessed, class, near)).collect();
        let one = self.tests.len() == 1;
        let in_units = |of: fn(&InTest) -> &Option<Vec<f64>>| -> Option<Vec<f64>> {
            let misfits = self.tests.iter().zip(&each).map(|(test, in_test)| {
                let unit = if one { 1.0 } else { test.wave().size() };
                of(in_test).as_ref().map(|misfit| misfit.iter().map(|e| e / unit).collect::<Vec<f64>>())
            });
            misfits.collect::<Option<Vec<_>>>().map(|misfits| misfits.concat())
        };
        let fits: Option<Vec<f64>> = each.iter().map(|in_test| in_test.fit_percent).collect();
        let restitutions: Option<Vec<f64>> = each.iter().map(|in_test| in_test.restitution).collect();
        let of_events: Vec<OwnTestErrors> = each.iter().map(|in_test| in_test.own_test).collect();
        let crush_errors: Option<Vec<f64>> = each.iter().map(|in_test| in_test.crush_error_at_lower_speeds).collect();
        let force_misfits: Vec<f64> = each.iter().filter_map(|in_test| in_test.force_misfit_percent).collect();
        let worst_sensors = each.iter().filter_map(|in_test| in_test.worst_sensor.clone());
        let speeds: Vec<f64> = self.tests.iter().map(|test| test.acceleration.impact_speed_m_per_s).collect();
        // Forces at knots, springs and dampers end at zero, which a search in logarithms only comes near to.
        let size = |name: &str| model.value(name).map(f64::abs);
        let kind = |name: &str| model.parameter_kind(name);
        let ends_at_zero = |kind: &ParameterKind| {
            matches!(kind, ParameterKind::Force | ParameterKind::Stiffness | ParameterKind::Damping)
        };
        let largest = |of: ParameterKind| {
            let of_kind = record.parameters.keys().filter(|name| kind(name) == Some(of));
            of_kind.filter_map(|name| size(name)).fold(0.0, f64::max)
        };
        let is_zero = |name: &str| {
            let smallest = kind(name).filter(ends_at_zero).map_or(0.0, |of| NO_FORCE * largest(of));
            size(name).is_some_and(|value| value <= smallest)
        };
        let is_ordered = |name: &str| model.kind() == ORDERED.0 && ORDERED.1.contains(&name);
        let is_limit = |name: &str| is_zero(name) || is_ordered(name);
        let bounds = candidate.fit.as_ref().map_or(&[][..], |fit| &fit.active_bounds);
        // What the misfit of the displacement leaves on a bound, a sum of errors, that of the acceleration may know.
        let is_inside = |name: &str| each.iter().any(|in_test| in_test.inside.iter().any(|inside| inside == name));
        let mut unidentified: Vec<String> = record.undetermined().into_iter().map(str::to_owned).collect();
        // A rate factor is free in a fit to several tests alone: however little they say of it, it is more than the
        // prior of one test, and its deviation is in the intervals of predictions.
        let is_rate = |name: &str| kind(name) == Some(ParameterKind::RateFactor);
        let matter = unidentified.iter().filter(|name| !is_rate(name) && affects_predictions(candidate, name, &speeds));
        let mut affects_other_speeds: Vec<String> = matter.cloned().collect();
        if candidate.division_undecided {
            unidentified.push("the division of the mass".to_owned());
            affects_other_speeds.extend(unidentified.last().cloned());
        }
        ComparedCandidate {
            id: candidate.id(),
            model: record.model.clone(),
            class,
            masses: model.masses_kg().len(),
            parameters: free_numbers(assessed).max(unidentified.len()),
            unidentified,
            is_assessed: record.asked().next().is_some(),
            order_of_magnitude: record.parameters_of(Certainty::OrderOfMagnitude).len(),
            affects_other_speeds,
            on_bound: bounds.iter().filter(|name| !is_limit(name) && !is_inside(name)).cloned().collect(),
            physical: record.physical,
            misfit: in_units(|in_test| &in_test.misfit),
            slow_misfit: in_units(|in_test| &in_test.slow_misfit),
            // The worst of several: a model is to follow all.
            fit_percent: fits.and_then(|fits| fits.into_iter().reduce(f64::min)),
            worst_sensor: worst_sensors.min_by(|(_, a), (_, b)| a.total_cmp(b)),
            restitution: restitutions.and_then(|each| match each[..] {
                [one] => Some(one),
                _ => geometric_mean(each.into_iter()),
            }),
            // The largest of the tests that have such a force.
            force_misfit_percent: force_misfits.into_iter().reduce(f64::max),
            own_test: OwnTestErrors::worst(&of_events),
            // The largest too: what the record of one test says of slower ones holds for all.
            crush_error_at_lower_speeds: crush_errors.and_then(|errors| errors.into_iter().reduce(f64::max)),
        }
    }
}

/// The geometric mean; `None` of nothing, or where one is not positive.
fn geometric_mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let values: Vec<f64> = values.collect();
    match values[..] {
        [] => None,
        [one] => Some(one),
        _ if values.iter().any(|value| *value <= 0.0) => None,
        _ => Some((values.iter().map(|value| value.ln()).sum::<f64>() / values.len() as f64).exp()),
    }
}

/// A candidate in one test.
struct InTest {
    /// Of the acceleration, at its least where noise might explain it.
    misfit: Option<Vec<f64>>,
    /// The part of it that is slower than 60 Hz.
    slow_misfit: Option<Vec<f64>>,
    /// Parameters that stand on no bound at the least misfit.
    inside: Vec<String>,
    force_misfit_percent: Option<f64>,
    fit_percent: Option<f64>,
    worst_sensor: Option<(String, f64)>,
    restitution: Option<f64>,
    own_test: OwnTestErrors,
    crush_error_at_lower_speeds: Option<f64>,
}

impl ComparedTest {
    /// The wave that the evidence is of.
    fn wave(&self) -> &ObservedWave {
        &self.acceleration.waves[0]
    }

    fn window_s(&self) -> (f64, f64) {
        let wave = self.wave();
        (wave.time_s(0), wave.time_s(wave.samples.len() - 1))
    }

    /// Standard deviation of the accelerations before the event, behind the filter: the root mean square of all, times
    /// their weights.
    fn noise(&self) -> Option<f64> {
        let of_wave = |wave: &ObservedWave| {
            let before =
                wave.measurement.before_event.filter(|before| before.noise > 0.0 && before.noise_samples > 1)?;
            Some((wave.weight * before.noise).powi(2))
        };
        let waves = &self.acceleration.waves;
        let variances: Vec<f64> = waves.iter().map(of_wave).collect::<Option<_>>()?;
        Some((variances.iter().sum::<f64>() / waves.len() as f64).sqrt())
    }

    /// The accelerations as a model of so many masses meets them: a sensor on a mass that it does not have moves with
    /// its compartment, as in a rigid body.
    fn observed_by(&self, masses: usize) -> Observation {
        let mut observed = self.acceleration.clone();
        for (wave, other) in observed.waves.iter_mut().skip(1).zip(&self.others) {
            wave.mass = other.place.mass(masses);
        }
        observed
    }

    /// Of the sensors on other masses the one that a structure follows worst, and its displacement fit, percent.
    fn worst_sensor(&self, structure: &Structure) -> Option<(String, f64)> {
        let fits = self.others.iter().filter_map(|other| {
            let mut observed = other.displacement.clone()?;
            observed.waves[0].mass = other.place.mass(structure.masses_kg().len());
            let fit = observed.fit_percent(&observed.misfit_of(structure)?)?;
            Some((other.channel.clone(), fit))
        });
        fits.min_by(|(_, a), (_, b)| a.total_cmp(b))
    }

    /// The restitution that a prior may be held against: neither a lower bound nor none at all.
    fn usual_restitution(&self) -> Option<f64> {
        self.tested_restitution.filter(|e| *e > 0.0 && !self.rebound_is_cut)
    }

    /// Samples of each acceleration, and how many independent ones its filter lets through.
    fn compared_waves(&self) -> impl Iterator<Item = ComparedWave> {
        let (from_s, to_s) = self.window_s();
        self.acceleration.waves.iter().map(move |wave| {
            let filter = wave.measurement.filter.as_ref();
            let most = filter.map(|filter| 2.0 * filter.noise_bandwidth_hz(wave.measurement.dt_s) * (to_s - from_s));
            ComparedWave { samples: wave.samples.len(), most_independent: most.unwrap_or(f64::INFINITY) }
        })
    }

    fn candidate(&self, assessed: &AssessedCandidate<'_>, class: EnergyClass, near: f64) -> InTest {
        let structure = assessed.candidate.model.released().structure().ok();
        let misfit = |observed: &Observation| observed.misfit_of(structure.as_ref()?);
        let impact = self.acceleration.impact_of(self.wave());
        let speed = impact.speed_m_per_s;
        let loaded = structure.as_ref().and_then(|structure| impact.structure(structure));
        let events = loaded.as_ref().and_then(|structure| structure.events(speed, HORIZON_S).ok());
        let of_compartment = events.as_ref().and_then(|events| events.last());
        let rebound = of_compartment.and_then(|events| events.rebound_velocity_m_per_s);
        let crush = of_compartment.and_then(|events| events.dynamic_crush_m.zip(events.time_of_dynamic_crush_s));
        let of_displacement = misfit(&self.displacement);
        let observed = self.observed_by(structure.as_ref().map_or(1, |structure| structure.masses_kg().len()));
        let of_acceleration = misfit(&observed).map(|misfit| without_shift(&observed, &misfit));
        let least = of_acceleration.as_deref().and_then(|misfit| self.least(assessed, &observed, (misfit, near)));
        let (misfit, inside) = least.map_or((of_acceleration, Vec::new()), |(least, inside)| (Some(least), inside));
        InTest {
            slow_misfit: misfit.as_ref().map(|misfit| slow_misfit(&observed, misfit)),
            misfit,
            inside,
            fit_percent: of_displacement.as_ref().and_then(|misfit| self.displacement.fit_percent(misfit)),
            worst_sensor: structure.as_ref().and_then(|structure| self.worst_sensor(structure)),
            restitution: rebound.map(|rebound| -rebound / speed),
            own_test: self.own_test(crush, rebound.map_or(0.0, |rebound| -rebound / speed)),
            force_misfit_percent: self
                .wall
                .as_ref()
                .zip(loaded.as_ref())
                .and_then(|(wall, structure)| wall.misfit_percent(structure, speed)),
            crush_error_at_lower_speeds: of_displacement
                .filter(|_| class == EnergyClass::Plastic)
                .and_then(|misfit| self.crush_error_at_lower_speeds(&misfit)),
        }
    }

    /// How a model with this dynamic crush, m, this time of it, s, and this restitution misses the events of the test.
    fn own_test(&self, crush: Option<(f64, f64)>, restitution: f64) -> OwnTestErrors {
        let Some((crush_m, time_s)) = crush else { return OwnTestErrors::default() };
        let share = |model: f64, test: f64| Some(model / test - 1.0).filter(|error| error.is_finite());
        OwnTestErrors {
            crush: self.dynamic_crush.and_then(|(of_test, _)| share(crush_m, of_test)),
            time: self.dynamic_crush.and_then(|(_, of_test)| share(time_s, of_test)),
            restitution: self.tested_restitution.map(|of_test| {
                let error = restitution - of_test;
                if self.rebound_is_cut { error.min(0.0) } else { error }
            }),
        }
    }

    /// The least misfit of the acceleration and what stands on no bound there, where it is below this one and the noise
    /// before the event is not far from that.
    fn least(
        &self,
        AssessedCandidate { candidate, record }: &AssessedCandidate<'_>,
        observed: &Observation,
        (misfit, near): (&[f64], f64),
    ) -> Option<(Vec<f64>, Vec<String>)> {
        let sum = |misfit: &[f64]| misfit.iter().map(|e| e * e).sum::<f64>();
        let near = near * self.noise()?;
        if sum(misfit) > misfit.len() as f64 * near * near {
            return None;
        }
        let bounds = candidate.fit.as_ref().map_or(&[][..], |fit| &fit.active_bounds);
        let free: Vec<&str> = record.asked().filter(|name| !bounds.iter().any(|bound| bound == name)).collect();
        let model = candidate.model.released();
        let from = |start: &Model| least_without_shift(observed, start, &free);
        let own = from(&model).map(|misfit| (misfit, Vec::new()));
        let least = candidate.assessed.as_ref().and_then(|assessed| assessed.assessment.least_misfit.as_ref());
        let assessed = least.and_then(|LeastMisfit { parameters, inside }| {
            let there = model.changed(parameters.iter().map(|(name, value)| (name.as_str(), *value)))?;
            Some((from(&there)?, inside.clone()))
        });
        let lower = own.into_iter().chain(assessed).filter(|(least, _)| sum(least) < sum(misfit));
        lower.min_by(|(a, _), (b, _)| sum(a).total_cmp(&sum(b)))
    }

    fn crush_error_at_lower_speeds(&self, misfit: &[f64]) -> Option<f64> {
        let wave = &self.displacement.waves[0];
        let model: Vec<f64> = wave.samples.iter().zip(misfit).map(|(x, misfit)| x + misfit).collect();
        let spacing_s = wave.time_s(1) - wave.time_s(0);
        crush_error_at_lower_speeds(&wave.samples, &model, spacing_s, self.displacement.impact_speed_m_per_s)
    }
}

/// Numbers that the record was asked for; of a candidate that nobody assessed all but its masses.
fn free_numbers(AssessedCandidate { candidate, record }: &AssessedCandidate<'_>) -> usize {
    match record.asked().count() {
        0 => {
            let is_mass = |name: &str| candidate.model.parameter_kind(name) == Some(ParameterKind::Mass);
            record.parameters.keys().filter(|name| !is_mass(name)).count()
        }
        asked => asked,
    }
}
