//! What each candidate brings into the choice: its misfit as measured, its restitution, what the record does not
//! identify.

use crumple_lumped::{Model, ModelKind, ParameterKind};
use crumple_lumped_fit::{
    Candidate, ComparedCandidate, ComparedRecord, EnergyClass, Evaluation, Evidence, FitQuantity, Impact, LeastMisfit,
    MeasuredTest, Measurement, Observation, ObservedWave, OtherMass, OwnTestErrors, SLOW_HZ, SensorPlace, WallForce,
    affects_predictions, evaluate,
};
use crumple_signal::{Notes, Sampled};
use crumple_stage::Inputs;
use crumple_stage::records::{Certainty, EvaluationV1, EventsV1};
use rayon::prelude::*;

use crate::stage::inputs::{Displaced, displacement_of, motion};
use crate::stage::options::PlacedSensor;
use crate::stage::records::AssessedCandidate;
use crate::stage::settings::StageSettings;

/// Share of the largest force at a knot, spring or damper of a model below which another is none.
const NO_FORCE: f64 = 1e-3;

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
    /// What candidates are evaluated by; its other sensors are in the order of their waves.
    measured: MeasuredTest,
    /// Its mass, kg: where several tests stand side by side, each has its own; else it is that of the candidates.
    mass_kg: f64,
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
            others.push(OtherMass { channel: channel.clone(), place: *place, displacement });
        }
        let wall = input.wall_force()?.and_then(|(force, steps)| {
            let to_s = events.end_of_contact_s(force.end_s());
            WallForce::new(&force, steps, to_s).ok()
        });
        Ok(acceleration.zip(displacement).map(|(acceleration, displacement)| Self {
            tests: vec![ComparedTest {
                acceleration,
                channel: channel.clone(),
                measured: MeasuredTest {
                    displacement,
                    other_sensors: others,
                    dynamic_crush: events.dynamic_crush_m.zip(events.time_of_dynamic_crush_s),
                    restitution: events.coefficient_of_restitution,
                    rebound_is_cut: events.still_separating,
                    wall,
                },
                mass_kg,
            }],
        }))
    }

    /// Several tests side by side, each with its own mass.
    pub fn of_several(each: Vec<Self>) -> Self {
        let mut tests: Vec<ComparedTest> = each.into_iter().flat_map(|comparison| comparison.tests).collect();
        for test in &mut tests {
            let impact = Impact { speed_m_per_s: test.acceleration.impact_speed_m_per_s, mass_kg: Some(test.mass_kg) };
            for wave in test.acceleration.waves.iter_mut().chain(&mut test.measured.displacement.waves) {
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
            let others = test.measured.other_sensors.iter().map(|other| other.channel.clone());
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
        let first = &self.tests[0];
        let of_first = ComparedRecord::of(first.wave(), first.slow_noise());
        let of_shares = ComparedRecord { rms: 1.0, noise: 0.0, ..of_first };
        ComparedRecord {
            restitution: geometric_mean(self.tests.iter().filter_map(ComparedTest::usual_restitution)),
            ..if self.tests.len() == 1 { of_first } else { of_shares }
        }
    }

    /// A candidate beside each of the tests.
    pub fn evaluate(&self, candidate: &Candidate) -> Vec<Evaluation> {
        let model = candidate.model.released();
        let of_test = |test: &ComparedTest| evaluate(&model, mass_of(candidate, &test.channel), &test.measured);
        self.tests.iter().map(of_test).collect()
    }

    /// The evaluation as its candidate carries it: of one test.
    pub fn evaluation_record(&self, evaluations: &[Evaluation]) -> Option<EvaluationV1> {
        let ([test], [evaluation]) = (&self.tests[..], evaluations) else { return None };
        let (from_s, to_s) = test.measured.window_s();
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

    /// What the candidates bring, in their order.
    pub fn candidates(&self, assessed: &[&AssessedCandidate<'_>]) -> Vec<ComparedCandidate> {
        assessed.par_iter().map(|candidate| self.candidate(candidate)).collect()
    }

    fn candidate(&self, assessed: &AssessedCandidate<'_>) -> ComparedCandidate {
        let AssessedCandidate { candidate, record, evaluations } = assessed;
        let model = &candidate.model;
        let each: Vec<InTest> = self.tests.iter().map(|test| test.of(assessed)).collect();
        let one = self.tests.len() == 1;
        let unit = |test: &ComparedTest| if one { 1.0 } else { test.wave().size() };
        let misfits = self.tests.iter().zip(&each).map(|(test, in_test)| Some(in_test.misfit? / unit(test)));
        let misfits: Option<Vec<f64>> = misfits.collect();
        let evidence =
            self.tests.iter().zip(&each).map(|(test, in_test)| Some((in_test.evidence.clone()?, unit(test))));
        let evidence: Option<Vec<_>> = evidence.collect();
        let fits: Option<Vec<f64>> = evaluations.iter().map(|of_test| of_test.fit_as_measured_percent).collect();
        let restitutions: Option<Vec<f64>> = evaluations.iter().map(|of_test| of_test.restitution).collect();
        let of_events: Vec<OwnTestErrors> = evaluations.iter().map(|of_test| of_test.own_test).collect();
        let crush_errors: Option<Vec<f64>> =
            evaluations.iter().map(|of_test| of_test.crush_error_at_lower_speeds).collect();
        let force_misfits = evaluations.iter().filter_map(|of_test| of_test.force_misfit_percent);
        let worst_sensors = evaluations.iter().filter_map(|of_test| of_test.worst_sensor.clone());
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
            class: EnergyClass::of(model),
            parameters: free_numbers(assessed).len().max(unidentified.len()),
            unidentified,
            is_assessed: record.asked().next().is_some(),
            order_of_magnitude: record.parameters_of(Certainty::OrderOfMagnitude).len(),
            affects_other_speeds,
            on_bound: bounds.iter().filter(|name| !is_limit(name) && !is_inside(name)).cloned().collect(),
            physical: record.physical,
            misfit: misfits
                .map(|each| (each.iter().map(|misfit| misfit * misfit).sum::<f64>() / each.len() as f64).sqrt()),
            evidence: evidence.and_then(Evidence::side_by_side),
            // The worst of several: a model is to follow all.
            fit_percent: fits.and_then(|fits| fits.into_iter().reduce(f64::min)),
            worst_sensor: worst_sensors.min_by(|(_, a), (_, b)| a.total_cmp(b)),
            restitution: restitutions.and_then(|each| match each[..] {
                [one] => Some(one),
                _ => geometric_mean(each.into_iter()),
            }),
            // The largest of the tests that have such a force.
            force_misfit_percent: force_misfits.reduce(f64::max),
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

/// What a candidate misses of the accelerations of one test.
struct InTest {
    /// Root mean square of the misfit.
    misfit: Option<f64>,
    evidence: Option<Evidence>,
    /// Parameters that stand on no bound at the least misfit.
    inside: Vec<String>,
}

/// Index of the mass that the fit of a candidate put a channel on; `None`: the fit does not say.
fn mass_of(candidate: &Candidate, channel: &str) -> Option<usize> {
    candidate.fit.as_ref()?.sensors.iter().find(|sensor| sensor.channel == channel)?.mass.checked_sub(1)
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

    /// The accelerations as a candidate meets them: a sensor on a mass that it does not have moves with its
    /// compartment, as in a rigid body.
    fn observed_by(&self, candidate: &Candidate) -> Observation {
        let mut observed = self.acceleration.clone();
        observed.waves[0].mass = mass_of(candidate, &self.channel);
        let masses = candidate.model.masses_kg().len();
        for (wave, other) in observed.waves.iter_mut().skip(1).zip(&self.measured.other_sensors) {
            wave.mass = other.place.mass(masses);
        }
        observed
    }

    /// The restitution that a prior may be held against: neither a lower bound nor none at all.
    fn usual_restitution(&self) -> Option<f64> {
        self.measured.restitution.filter(|e| *e > 0.0 && !self.measured.rebound_is_cut)
    }

    /// Standard deviation of the noise below 60 Hz: of white noise behind the filter, its share of the band.
    fn slow_noise(&self) -> f64 {
        let measurement = &self.wave().measurement;
        let filter = measurement.filter.as_ref();
        let band_hz = filter.map_or(0.5 / measurement.dt_s, |filter| filter.noise_bandwidth_hz(measurement.dt_s));
        self.noise().map_or(0.0, |noise| noise * (SLOW_HZ / band_hz).min(1.0).sqrt())
    }

    /// What the record says of a candidate, at the least misfit of the acceleration where that is known.
    fn of(&self, assessed: &AssessedCandidate<'_>) -> InTest {
        let candidate = assessed.candidate;
        let observed = self.observed_by(candidate);
        let model = candidate.model.released();
        let sum = |model: &Model| observed.misfit(model).map(|misfit| misfit.iter().map(|e| e * e).sum::<f64>());
        let own = sum(&model);
        let least = candidate.assessed.as_ref().and_then(|assessed| assessed.assessment.least_misfit.as_ref());
        let least = least.and_then(|LeastMisfit { parameters, inside }| {
            let there = model.changed(parameters.iter().map(|(name, value)| (name.as_str(), *value)))?;
            let lower = sum(&there).filter(|lower| own.is_none_or(|own| *lower < own))?;
            Some((there, lower, inside.clone()))
        });
        let bounds = candidate.fit.as_ref().map_or(&[][..], |fit| &fit.active_bounds);
        let free = free_numbers(assessed);
        let free: Vec<&str> = free.into_iter().filter(|name| !bounds.iter().any(|bound| bound == name)).collect();
        let (start, sum, inside) = match least {
            Some((there, lower, inside)) => (there, Some(lower), inside),
            None => (model, own, Vec::new()),
        };
        let samples = observed.rows() as f64;
        InTest {
            misfit: sum.map(|sum| (sum / samples).sqrt()),
            evidence: Evidence::new(&observed, &start, &free),
            inside,
        }
    }
}

/// Numbers that the record was asked for; of a candidate that nobody assessed all but its masses.
fn free_numbers<'a>(AssessedCandidate { candidate, record, .. }: &'a AssessedCandidate<'_>) -> Vec<&'a str> {
    let is_mass = |name: &str| candidate.model.parameter_kind(name) == Some(ParameterKind::Mass);
    match record.asked().count() {
        0 => record.parameters.keys().map(String::as_str).filter(|name| !is_mass(name)).collect(),
        _ => record.asked().collect(),
    }
}
