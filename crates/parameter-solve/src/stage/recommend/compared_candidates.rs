//! What each candidate brings into the choice: its misfit as measured, its restitution, what the record leaves open.

use crumple_lumped::{ParameterKind, parameter_kind, structure_of};
use crumple_lumped_fit::{
    ComparedCandidate, ComparedRecord, EnergyClass, FitQuantity, Impact, LeastMisfit, Measurement, Observation,
    ObservedWave, WallForce, crush_error_at_lower_speeds,
};
use crumple_signal::{Displacement, Sampled};
use crumple_stage::records::{CandidateV1, Certainty, EventsV1};
use crumple_stage::{Inputs, RefuseExt, Wave};
use rayon::prelude::*;

use crate::stage::inputs::motions::motion;
use crate::stage::options::settings::StageSettings;
use crate::stage::recommend::felt::is_felt;

/// A crash is over in two seconds or never.
const HORIZON_S: f64 = 2.0;

/// Share of the largest force at a knot, spring or damper of a model below which another is none.
const NO_FORCE: f64 = 1e-3;

/// A misfit beyond so many times the noise before the event is not explained by it wherever its least lies: fits to the
/// displacement of made records of three masses missed the acceleration by eight times its least at most.
const NEAR_NOISE: f64 = 10.0;

/// Parameters of which the bound is another parameter of the same model, by the side constraints of its paper: `k1 <=
/// k2`, `c1 >= c2 >= c3`. On it the two are one number, which says something of the vehicle.
const ORDERED: [(&str, &str); 3] =
    [("nonlinear-1", "k2_n_per_m"), ("nonlinear-1", "c1_n_s_per_m"), ("nonlinear-1", "c2_n_s_per_m")];

/// A candidate with what its record does not say.
#[derive(Debug)]
pub struct Submitted {
    pub id: String,
    pub record: CandidateV1,
    /// Whether masses were fitted that this record does not divide.
    pub division_undecided: bool,
    /// Where the acceleration is met best, where that is known.
    pub least_misfit: Option<LeastMisfit>,
}

/// The records that all candidates are compared with, from contact to dynamic crush: one test, or several whose
/// evidence adds up.
pub struct Comparison {
    tests: Vec<ComparedTest>,
}

/// The record of one test.
struct ComparedTest {
    /// Acceleration of the pulse: what the evidence is of.
    acceleration: Observation,
    /// Displacement of the pulse: what closest means.
    displacement: Observation,
    tested_restitution: Option<f64>,
    /// Its mass, kg: where several tests stand side by side, each has its own; else it is that of the candidates.
    mass_kg: f64,
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
            tests: vec![ComparedTest { acceleration, displacement, tested_restitution, mass_kg, wall }],
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

    /// The compared window, s after time zero: the longest of several.
    pub fn window_s(&self) -> (f64, f64) {
        let ends = self.tests.iter().map(ComparedTest::window_s);
        ends.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or_default()
    }

    /// Samples compared.
    pub fn samples(&self) -> usize {
        self.tests.iter().map(|test| test.wave().samples.len()).sum()
    }

    /// Whether the models are sampled and filtered as the records were.
    pub fn is_as_measured(&self) -> bool {
        self.tests.iter().all(|test| test.acceleration.is_as_measured())
    }

    /// The records in numbers. Those of several tests are shares of the root mean square of each.
    pub fn record(&self) -> ComparedRecord {
        ComparedRecord {
            rms: if self.tests.len() == 1 { self.tests[0].wave().size() } else { 1.0 },
            most_samples: self.tests.iter().map(ComparedTest::most_samples).sum(),
            noise: match &self.tests[..] {
                [test] => test.noise(),
                _ => None,
            },
            restitution: geometric_mean(self.tests.iter().filter_map(|test| test.tested_restitution)),
        }
    }

    /// What the candidates bring, in their order.
    pub fn candidates(&self, submitted: &[&Submitted]) -> Vec<ComparedCandidate> {
        submitted.par_iter().map(|candidate| self.candidate(candidate)).collect()
    }

    fn candidate(&self, candidate: &Submitted) -> ComparedCandidate {
        let record = &candidate.record;
        let class = EnergyClass::of(&record.model, &record.parameters);
        let each: Vec<InTest> = self.tests.iter().map(|test| test.candidate(candidate, class)).collect();
        let one = self.tests.len() == 1;
        let misfits = self.tests.iter().zip(&each).map(|(test, in_test)| {
            let unit = if one { 1.0 } else { test.wave().size() };
            in_test.misfit.as_ref().map(|misfit| misfit.iter().map(|e| e / unit).collect::<Vec<f64>>())
        });
        let misfit: Option<Vec<Vec<f64>>> = misfits.collect();
        let fits: Option<Vec<f64>> = each.iter().map(|in_test| in_test.fit_percent).collect();
        let restitutions: Option<Vec<f64>> = each.iter().map(|in_test| in_test.restitution).collect();
        let of_crush: Option<Vec<f64>> = each.iter().map(|in_test| in_test.crush_error).collect();
        let crush_errors: Option<Vec<f64>> = each.iter().map(|in_test| in_test.crush_error_at_lower_speeds).collect();
        let force_misfits: Vec<f64> = each.iter().filter_map(|in_test| in_test.force_misfit_percent).collect();
        let speeds: Vec<f64> = self.tests.iter().map(|test| test.acceleration.impact_speed_m_per_s).collect();
        // Forces at knots, springs and dampers end at zero, which a search in logarithms only comes near to.
        let size = |name: &str| record.parameters.get(name).map(|value| value.abs());
        let kind = |name: &str| parameter_kind(&record.model, name);
        let ends_at_zero = |kind: &ParameterKind| {
            matches!(kind, ParameterKind::Force | ParameterKind::Stiffness | ParameterKind::Damping)
        };
        let largest = |of: ParameterKind| {
            record
                .parameters
                .keys()
                .filter(|name| kind(name) == Some(of))
                .filter_map(|name| size(name))
                .fold(0.0, f64::max)
        };
        let is_zero = |name: &str| {
            let smallest = kind(name).filter(ends_at_zero).map_or(0.0, |of| NO_FORCE * largest(of));
            size(name).is_some_and(|value| value <= smallest)
        };
        let is_limit = |name: &str| is_zero(name) || ORDERED.contains(&(record.model.as_str(), name));
        let bounds = record.fit.as_ref().map_or(&[][..], |fit| &fit.active_bounds);
        // What the misfit of the displacement leaves on a bound, a sum of errors, that of the acceleration may know.
        let is_inside = |name: &str| each.iter().any(|in_test| in_test.inside.iter().any(|inside| inside == name));
        let mut open: Vec<String> = record.undetermined().into_iter().map(str::to_owned).collect();
        // A rate factor is free in a fit to several tests alone: however little they say of it, it is more than the
        // prior of one test, and its deviation is in the intervals of predictions.
        let is_rate = |name: &str| parameter_kind(&record.model, name) == Some(ParameterKind::RateFactor);
        let felt = open.iter().filter(|name| !is_rate(name) && is_felt(record, name, &speeds));
        let mut open_and_felt: Vec<String> = felt.cloned().collect();
        if candidate.division_undecided {
            open.push("the division of the mass".to_owned());
            open_and_felt.extend(open.last().cloned());
        }
        ComparedCandidate {
            id: candidate.id.to_owned(),
            class,
            masses: structure_of(&record.model, &record.parameters).map_or(1, |structure| structure.masses_kg().len()),
            parameters: free_numbers(record).max(open.len()),
            open,
            order_of_magnitude: record.parameters_of(Certainty::OrderOfMagnitude).len(),
            open_and_felt,
            on_bound: bounds.iter().filter(|name| !is_limit(name) && !is_inside(name)).cloned().collect(),
            physical: record.physical,
            misfit: misfit.map(|misfits| misfits.concat()),
            // The worst of several: a model is to follow all.
            fit_percent: fits.and_then(|fits| fits.into_iter().reduce(f64::min)),
            restitution: restitutions.and_then(|each| match each[..] {
                [one] => Some(one),
                _ => geometric_mean(each.into_iter()),
            }),
            // The largest of the tests that have such a force.
            force_misfit_percent: force_misfits.into_iter().reduce(f64::max),
            crush_error: of_crush.and_then(|errors| errors.into_iter().reduce(f64::max)),
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
    /// Parameters that stand on no bound at the least misfit.
    inside: Vec<String>,
    force_misfit_percent: Option<f64>,
    fit_percent: Option<f64>,
    restitution: Option<f64>,
    crush_error: Option<f64>,
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

    /// Standard deviation of the acceleration before the event, behind the filter.
    fn noise(&self) -> Option<f64> {
        let before = self.wave().measurement.before_event?;
        Some(before.noise).filter(|noise| *noise > 0.0 && before.noise_samples > 1)
    }

    /// Independent samples that the filter lets through at most.
    fn most_samples(&self) -> f64 {
        let (from_s, to_s) = self.window_s();
        let measurement = &self.wave().measurement;
        let most = measurement.filter.map(|filter| 2.0 * filter.noise_bandwidth_hz(measurement.dt_s) * (to_s - from_s));
        most.unwrap_or(f64::INFINITY)
    }

    fn candidate(&self, candidate: &Submitted, class: EnergyClass) -> InTest {
        let record = &candidate.record;
        let structure = structure_of(&record.model, &record.parameters).ok();
        let misfit = |observed: &Observation| observed.misfit_of(structure.as_ref()?);
        let impact = self.acceleration.impact_of(self.wave());
        let speed = impact.speed_m_per_s;
        let loaded = structure.as_ref().and_then(|structure| impact.structure(structure));
        let events = loaded.as_ref().and_then(|structure| structure.events(speed, HORIZON_S).ok());
        let of_compartment = events.as_ref().and_then(|events| events.last());
        let rebound = of_compartment.and_then(|events| events.rebound_velocity_m_per_s);
        let crush_m = self.displacement.waves[0].samples.iter().copied().fold(0.0, f64::max);
        let crush = of_compartment.and_then(|events| events.dynamic_crush_m);
        let of_displacement = misfit(&self.displacement);
        let of_acceleration = misfit(&self.acceleration);
        let least = of_acceleration.as_deref().and_then(|misfit| self.least(candidate, misfit));
        let (misfit, inside) = least.map_or((of_acceleration, Vec::new()), |(least, inside)| (Some(least), inside));
        InTest {
            misfit,
            inside,
            fit_percent: of_displacement.as_ref().and_then(|misfit| self.displacement.fit_percent(misfit)),
            restitution: rebound.map(|rebound| -rebound / speed),
            crush_error: crush.map(|crush| (crush / crush_m - 1.0).abs()).filter(|error| error.is_finite()),
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

    /// The least misfit of the acceleration and what stands on no bound there, where it is below this one and the noise
    /// before the event is not far from that.
    fn least(&self, candidate: &Submitted, misfit: &[f64]) -> Option<(Vec<f64>, Vec<String>)> {
        let sum = |misfit: &[f64]| misfit.iter().map(|e| e * e).sum::<f64>();
        let near = NEAR_NOISE * self.noise()?;
        if sum(misfit) > misfit.len() as f64 * near * near {
            return None;
        }
        let LeastMisfit { parameters, inside } = candidate.least_misfit.as_ref()?;
        let mut there = candidate.record.parameters.clone();
        there.extend(parameters.clone());
        let least = self.acceleration.misfit_of(&structure_of(&candidate.record.model, &there).ok()?)?;
        (sum(&least) < sum(misfit)).then(|| (least, inside.clone()))
    }

    fn crush_error_at_lower_speeds(&self, misfit: &[f64]) -> Option<f64> {
        let wave = &self.displacement.waves[0];
        let model: Vec<f64> = wave.samples.iter().zip(misfit).map(|(x, misfit)| x + misfit).collect();
        let spacing_s = wave.time_s(1) - wave.time_s(0);
        crush_error_at_lower_speeds(&wave.samples, &model, spacing_s, self.displacement.impact_speed_m_per_s)
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
