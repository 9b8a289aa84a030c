//! What each candidate brings into the choice: its misfit as measured, its restitution, what the record does not
//! identify; and the choice among all.

use crumple_lumped::{Model, ModelKind, ParameterKind};
use rayon::prelude::*;

use crate::candidate::{Candidate, LeastMisfit};
use crate::evaluation::{Evaluation, MeasuredTest, evaluate};
use crate::record::observation::{Impact, Observation, ObservedWave};
use crate::selection::choice::{CandidateSelection, choose};
use crate::selection::compared::{ComparedCandidate, EnergyClass, OwnTestErrors, SelectionRules};
use crate::selection::evidence::{Evidence, SLOW_HZ};
use crate::selection::other_speeds::affecting_predictions;
use crate::selection::rating::ComparedRecord;

/// Share of the largest force at a knot, spring or damper of a model below which another is none.
const NO_FORCE: f64 = 1e-3;

/// Parameters of which the bound is another parameter of the same model, by the side constraints of its paper: `k1 <=
/// k2`, `c1 >= c2 >= c3`. On it the two are one number, which says something of the vehicle.
const ORDERED: (ModelKind, [&str; 3]) = (ModelKind::Nonlinear1, ["k2_n_per_m", "c1_n_s_per_m", "c2_n_s_per_m"]);

/// The records that all candidates are compared with, from contact to dynamic crush: one test, or several whose
/// evidence adds up.
#[derive(Debug)]
pub struct Comparison {
    tests: Vec<ComparedTest>,
}

/// The record of one test.
#[derive(Debug)]
struct ComparedTest {
    /// Accelerations of the pulse and of the sensors on other masses.
    acceleration: Observation,
    /// What candidates are evaluated by.
    measured: MeasuredTest,
}

/// A candidate beside each of the tests that candidates are compared with.
#[derive(Debug)]
pub struct EvaluatedCandidate<'a> {
    /// The candidate.
    pub candidate: &'a Candidate,
    /// How well its numbers are known.
    pub known: KnownNumbers,
    /// One for each of the tests.
    pub evaluations: Vec<Evaluation>,
}

/// What the records say of the numbers of a candidate, by name.
#[derive(Debug, Clone, Default)]
pub struct KnownNumbers {
    /// Numbers that the records were asked for; none of a candidate that nobody assessed.
    pub asked: Vec<String>,
    /// Of these, what they do not determine.
    pub open: Vec<String>,
    /// How many of the others they tell to an order of magnitude only.
    pub order_of_magnitude: usize,
}

impl EvaluatedCandidate<'_> {
    /// Numbers that the record was asked for; of a candidate that nobody assessed all but its masses.
    fn free_numbers(&self) -> Vec<String> {
        let model = &self.candidate.model;
        let is_mass = |name: &String| model.parameter_kind(name) == Some(ParameterKind::Mass);
        if self.known.asked.is_empty() {
            return model.parameters().into_keys().filter(|name| !is_mass(name)).collect();
        }
        self.known.asked.clone()
    }
}

/// The candidates of a run beside its tests, and the choice among them.
#[derive(Debug)]
pub struct Solution {
    /// What was counted of each that took part.
    pub compared: Vec<ComparedCandidate>,
    /// The choice, by their places.
    pub selection: CandidateSelection,
}

impl Comparison {
    /// One test. `None`: it has no acceleration.
    pub fn of_one(measured: MeasuredTest) -> Option<Self> {
        Some(Self { tests: vec![ComparedTest::new(measured)?] })
    }

    /// Several tests side by side, each with its own mass, kg. `None`: one of them has no acceleration.
    pub fn of_several(tests: Vec<(MeasuredTest, f64)>) -> Option<Self> {
        let side_by_side = |(measured, mass_kg): (MeasuredTest, f64)| {
            let mut test = ComparedTest::new(measured)?;
            let speed_m_per_s = test.acceleration.impact_speed_m_per_s;
            for wave in test.acceleration.waves.iter_mut().chain(&mut test.measured.displacement.waves) {
                wave.impact = Some(Impact { speed_m_per_s, mass_kg: Some(mass_kg) });
            }
            Some(test)
        };
        Some(Self { tests: tests.into_iter().map(side_by_side).collect::<Option<_>>()? })
    }

    /// The compared test; `None` of several.
    pub fn test(&self) -> Option<&MeasuredTest> {
        let [test] = &self.tests[..] else { return None };
        Some(&test.measured)
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
            std::iter::once(test.measured.channel.clone()).chain(others).collect::<Vec<_>>()
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
        let of_test =
            |test: &ComparedTest| evaluate(&model, mass_of(candidate, &test.measured.channel), &test.measured);
        self.tests.iter().map(of_test).collect()
    }

    /// What the candidates bring, and the choice among them. A candidate that gives the same record as one before it,
    /// its dual, does not take part.
    pub fn solution(&self, candidates: &[EvaluatedCandidate<'_>], rules: &SelectionRules) -> Solution {
        let is_dual = |k: usize| {
            let other = candidates[k].candidate.equivalent_id();
            other.is_some_and(|other| candidates[..k].iter().any(|earlier| earlier.candidate.id() == other))
        };
        let no_dual: Vec<usize> = (0..candidates.len()).filter(|k| !is_dual(*k)).collect();
        let compared: Vec<ComparedCandidate> = no_dual.par_iter().map(|k| self.candidate(&candidates[*k])).collect();
        let selection = choose(&compared, &self.record(), rules);
        Solution { compared, selection }
    }

    fn candidate(&self, evaluated: &EvaluatedCandidate<'_>) -> ComparedCandidate {
        let EvaluatedCandidate { candidate, known, evaluations } = evaluated;
        let model = &candidate.model;
        let each: Vec<InTest> = self.tests.iter().map(|test| test.of(evaluated)).collect();
        let one = self.tests.len() == 1;
        let unit = |test: &ComparedTest| if one { 1.0 } else { test.wave().size() };
        let misfits = self.tests.iter().zip(&each).map(|(test, in_test)| Some(in_test.misfit? / unit(test)));
        let misfits: Option<Vec<f64>> = misfits.collect();
        // All tests are of one set of numbers: of several that of the candidate, of one that of its least misfit.
        let start = if one { each[0].start.clone() } else { model.released() };
        let records = self.tests.iter().map(|test| (test.observed_by(candidate), unit(test)));
        let bounds = candidate.fit.as_ref().map_or(&[][..], |fit| &fit.active_bounds);
        let free = evaluated.free_numbers();
        let not_on_a_bound: Vec<&str> =
            free.iter().map(String::as_str).filter(|name| !bounds.iter().any(|bound| bound == name)).collect();
        let evidence = Evidence::new(&records.collect::<Vec<_>>(), &start, &not_on_a_bound);
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
            let of_kind = model.parameters().into_keys().filter(|name| kind(name) == Some(of));
            of_kind.filter_map(|name| size(&name)).fold(0.0, f64::max)
        };
        let is_zero = |name: &str| {
            let smallest = kind(name).filter(ends_at_zero).map_or(0.0, |of| NO_FORCE * largest(of));
            size(name).is_some_and(|value| value <= smallest)
        };
        let is_ordered = |name: &str| model.kind() == ORDERED.0 && ORDERED.1.contains(&name);
        let is_limit = |name: &str| is_zero(name) || is_ordered(name);
        // What the misfit of the displacement leaves on a bound, a sum of errors, that of the acceleration may know.
        let is_inside = |name: &str| each.iter().any(|in_test| in_test.inside.iter().any(|inside| inside == name));
        let mut unidentified = known.open.clone();
        // A rate factor is free in a fit to several tests alone: however little they say of it, it is more than the
        // prior of one test, and its deviation is in the intervals of predictions.
        let is_rate = |name: &str| kind(name) == Some(ParameterKind::RateFactor);
        let unknown = unidentified.iter().map(String::as_str).filter(|name| !is_rate(name));
        let mut affects_other_speeds = affecting_predictions(candidate, unknown, &speeds);
        if candidate.division_undecided {
            unidentified.push("the division of the mass".to_owned());
            affects_other_speeds.extend(unidentified.last().cloned());
        }
        ComparedCandidate {
            id: candidate.id(),
            model: model.kind().name().to_owned(),
            class: EnergyClass::of(model),
            parameters: free.len().max(unidentified.len()),
            unidentified,
            is_assessed: !known.asked.is_empty(),
            order_of_magnitude: known.order_of_magnitude,
            affects_other_speeds,
            on_bound: bounds.iter().filter(|name| !is_limit(name) && !is_inside(name)).cloned().collect(),
            physical: model.is_physical(),
            misfit: misfits
                .map(|each| (each.iter().map(|misfit| misfit * misfit).sum::<f64>() / each.len() as f64).sqrt()),
            evidence,
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
    /// The model at the least misfit.
    start: Model,
    /// Parameters that stand on no bound at the least misfit.
    inside: Vec<String>,
}

/// Index of the mass that the fit of a candidate put a channel on; `None`: the fit does not say.
fn mass_of(candidate: &Candidate, channel: &str) -> Option<usize> {
    candidate.fit.as_ref()?.sensors.iter().find(|sensor| sensor.channel == channel)?.mass.checked_sub(1)
}

impl ComparedTest {
    fn new(mut measured: MeasuredTest) -> Option<Self> {
        Some(Self { acceleration: measured.acceleration.take()?, measured })
    }

    /// The wave that the evidence is of.
    fn wave(&self) -> &ObservedWave {
        &self.acceleration.waves[0]
    }

    fn window_s(&self) -> (f64, f64) {
        self.wave().window_s()
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
        observed.waves[0].mass = mass_of(candidate, &self.measured.channel);
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
    fn of(&self, evaluated: &EvaluatedCandidate<'_>) -> InTest {
        let candidate = evaluated.candidate;
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
        let (start, sum, inside) = match least {
            Some((there, lower, inside)) => (there, Some(lower), inside),
            None => (model, own, Vec::new()),
        };
        let samples = observed.rows() as f64;
        InTest { misfit: sum.map(|sum| (sum / samples).sqrt()), start, inside }
    }
}
