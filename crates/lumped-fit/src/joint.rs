//! One model for several tests: the waves of all of them side by side, each with its own speed, mass and filter.

use crumple_lumped::{CrushedStructure, Model, ModelKind, ParameterKind};
use crumple_numerics::estimation::work::determined;
use crumple_signal::{About, Measurement, Note, Notes, Sampled, Severity, Value, Weight, remarks};
use rayon::prelude::*;

use crate::candidate::{Candidate, Fit, Method, Minimum, bounds_remark};
use crate::error::SolveError;
use crate::fit::as_measured::{fit_as_measured, fit_nearby};
use crate::parameters::{FitParameter, Map, free_parameters};
use crate::record::observation::{Impact, Observation, ObservedWave};
use crate::record::sensor::{FitQuantity, TestData};
use crate::solvers::closed_forms::USUAL_RESTITUTION;
use crate::solvers::table::{SolveSettings, mass_count, solve};

/// Rounds of finding noise levels and minimum in turn, and the change of a weight that is worth another one.
const WEIGHINGS: usize = 4;
const WORTH_ANOTHER: f64 = 0.01;

/// Noise levels of the tests, as shares of their waves, lie within this factor of their mean: a curve with many knots
/// could follow one test to rounding, and nothing of the others would count.
const LEVELS: f64 = 2.0;

/// The unloading stiffness while a curve is fitted, over that of its start: no sample up to dynamic crush depends on
/// it, and a curve must not be steeper.
const STIFF: f64 = 100.0;

/// A test that goes into a joint fit.
#[derive(Debug, Clone, Copy)]
pub struct JointTest<'a> {
    /// Its name, for records and notes.
    pub name: &'a str,
    /// What is known of it.
    pub data: TestData<'a>,
    /// Acceleration of the pulse and how it was measured; `None`: not at hand.
    pub acceleration: Option<(&'a Sampled, Measurement)>,
}

/// Fits every model of one mass that the settings ask for to all tests together: one set of parameters, and for each
/// test its own speed, mass, window, filter and noise level.
///
/// Starts are what the solvers find for each test alone; the minimum is that of the sum of the squared misfits as
/// measured, of the displacements, for curves also of the accelerations. Waves count alike at first, as shares of their
/// size, then by their misfits there, in turn with the fit, within a factor of 2 of the mean of their quantity.
/// Force-deflection curves have the knots of the test with the deepest crush,
/// unloading by the restitution of all, and a free rate factor where [`RateFactorSource::of`] says so.
///
/// Candidates hold the mass of the test with the deepest crush. What cannot be fitted is left out with a note.
/// Deterministic for any number of threads. Errors: a test without meaning, as for [`solve`].
pub fn fit_together(
    tests: &[JointTest<'_>],
    settings: &SolveSettings,
    notes: &mut Notes,
) -> Result<Vec<Candidate>, SolveError> {
    let mut settings = settings.clone();
    let chains: Vec<ModelKind> = settings.models.iter().copied().filter(|kind| mass_count(*kind) > 1).collect();
    settings.models.retain(|kind| mass_count(*kind) == 1);
    if !chains.is_empty() {
        notes.push(ChainsNotJoint { models: chains.iter().map(ToString::to_string).collect() });
    }
    let alone = tests.iter().map(|test| of_one(test, &settings, notes)).collect::<Result<Vec<_>, _>>()?;
    let speeds: Vec<f64> = tests.iter().map(|test| test.data.impact_speed_m_per_s).collect();
    let joint = Joint { tests, rate: RateFactorSource::of(&speeds) };
    let mut candidates = Vec::new();
    for kind in &settings.models {
        let of_kind: Vec<Vec<&Candidate>> = alone
            .iter()
            .map(|of_test| of_test.iter().filter(|c| c.model.kind() == *kind && c.minimum.is_some()).collect())
            .collect();
        if let Some(without) = of_kind.iter().position(Vec::is_empty) {
            notes.push(NoFitOfOneTest { model: kind.to_string(), test: tests[without].name.to_owned() });
            continue;
        }
        let fit = |(k, starts): (usize, &Vec<Start>)| {
            let (observed, names) = joint.waves(&of_kind)?;
            // A fit to each test from each start may cost that much.
            let fits = tests.len() * starts.len() * settings.searches();
            joint.candidate(starts, (observed.limited(fits), names), k + 1)
        };
        let fitted = determined(|| joint.starts(&of_kind).par_iter().enumerate().filter_map(fit).collect::<Vec<_>>());
        let reason = match &fitted {
            Err(reason) => Some(reason.to_string()),
            Ok(candidates) if candidates.is_empty() => Some("no set of parameters has a finite response".to_owned()),
            Ok(_) => None,
        };
        if let Some(reason) = reason {
            notes.push(NotJoint { model: kind.to_string(), reason });
        }
        let mut fitted = fitted.unwrap_or_default();
        fitted.iter_mut().filter_map(|candidate| candidate.minimum.as_mut()).for_each(Minimum::release_work);
        candidates.extend(fitted);
    }
    Ok(candidates)
}

/// What a test alone gives; its warnings under its name.
fn of_one(test: &JointTest<'_>, settings: &SolveSettings, notes: &mut Notes) -> Result<Vec<Candidate>, SolveError> {
    let mut own = Notes::new();
    let candidates = solve(&test.data, settings, &mut own)?;
    for note in own.iter().filter(|note| note.severity == Severity::Warning) {
        let mut note = note.clone().within(&format!("{} alone: ", test.name), "");
        note.values.push(("test", Value::Text(test.name.to_owned())));
        // It concerns what is made of all tests, whatever model it is of.
        notes.push(note.bears_on(About::Model(String::new()), Weight::Slight));
    }
    Ok(candidates)
}

/// A model and its free numbers.
type Start = (Model, Vec<FitParameter>);

/// The tests, and what they say of the rate factor.
struct Joint<'a> {
    tests: &'a [JointTest<'a>],
    rate: RateFactorSource,
}

impl Joint<'_> {
    /// Models of single tests with their free numbers, from which one candidate each is fitted: where knots follow from
    /// the test, those of the deepest crush, one by one; else those of all tests for one candidate.
    ///
    /// Where a rate factor is fitted, the curve has as many knots as the record of one test carries or, since each
    /// further test passes each crush at another speed, as many again. Fewer there are not: the rate factor would stand
    /// for bends that a curve lacks (on exact records of 0.02 s/m with 6, 4 and 3 knots: 0.020, 0.022, 0.035).
    fn starts(&self, of_kind: &[Vec<&Candidate>]) -> Vec<Vec<Start>> {
        let starts = |of_test: &Vec<&Candidate>| -> Vec<Start> {
            let minima = of_test.iter().filter_map(|candidate| candidate.minimum.as_ref());
            minima.map(|minimum| (minimum.model.clone(), minimum.free.clone())).collect()
        };
        let Some(kind) = of_kind.iter().flatten().next().map(|candidate| candidate.model.kind()) else {
            return Vec::new();
        };
        if !kind.parameters().iter().any(|parameter| parameter.of_the_test) {
            return vec![of_kind.iter().flat_map(starts).collect()];
        }
        let mut each = starts(&of_kind[JointTest::deepest(self.tests)]);
        if self.rate.index(kind).is_some() {
            each.truncate(1);
            let finer: Vec<Start> = each.iter().filter_map(|(model, _)| self.with_more_knots(model)).collect();
            each.splice(0..0, finer);
        }
        each.into_iter().map(|start| vec![start]).collect()
    }

    /// The same curve with a knot in the middle of every piece but the last, whose slope goes on beyond, and the first,
    /// which ends early, where forces rise. `None` where that is too many.
    fn with_more_knots(&self, model: &Model) -> Option<Start> {
        let Model::ForceDeflection(curve) = model else { return None };
        let knots = curve.knots();
        let middle = |a: &(f64, f64), b: &(f64, f64)| (0.5 * (a.0 + b.0), 0.5 * (a.1 + b.1));
        let (last, others) = knots.split_last()?;
        let (_, risen) = others.split_first()?;
        let early = risen.first()?;
        let finer: Vec<(f64, f64)> = std::iter::once(*early)
            .chain(risen.iter().zip(&risen[1..]).flat_map(|(a, b)| [middle(a, b), *b]))
            .chain([*last])
            .collect();
        let (stiffness, rate) = (curve.unloading_stiffness_n_per_m, curve.rate_s_per_m);
        let model = Model::ForceDeflection(CrushedStructure::new(curve.mass_kg, &finer, stiffness, rate).ok()?);
        let deepest = self.tests.get(JointTest::deepest(self.tests))?.data;
        let free = free_parameters(&model, deepest.impact_speed_m_per_s, deepest.dynamic_crush_m?);
        Some((model, free))
    }

    /// The waves of all tests that a model was fitted to, test after test, and the name of the test of each.
    fn waves(&self, of_kind: &[Vec<&Candidate>]) -> Option<(Observation, Vec<String>)> {
        let (mut waves, mut names) = (Vec::new(), Vec::new());
        for (test, candidates) in self.tests.iter().zip(of_kind) {
            let TestData { impact_speed_m_per_s: speed_m_per_s, mass_kg, .. } = test.data;
            let impact = Some(Impact { speed_m_per_s, mass_kg: Some(mass_kg) });
            let candidate = candidates.first()?;
            let of_test = &candidate.minimum.as_ref()?.observed.waves;
            let curve = matches!(candidate.model, Model::ForceDeflection(_));
            let acceleration = if curve { acceleration(test, of_test.first()?) } else { None };
            let of_test = of_test.iter().cloned().chain(acceleration);
            waves.extend(of_test.map(|wave| ObservedWave { impact, ..wave }));
            names.resize(waves.len(), test.name.to_owned());
        }
        let mut observed = Observation { impact_speed_m_per_s: self.tests.first()?.data.impact_speed_m_per_s, waves };
        let sizes: Vec<f64> = observed.waves.iter().map(ObservedWave::size).collect();
        observed.weigh(&sizes, 0.0);
        Some((observed, names))
    }

    /// The best fit from these starts to waves of tests with these names.
    fn candidate(
        &self,
        starts: &[Start],
        (mut observed, names): (Observation, Vec<String>),
        index: usize,
    ) -> Option<Candidate> {
        let fits: Vec<Minimum> = starts.par_iter().filter_map(|start| self.fit(start, &observed)).collect();
        let mut best = fits.into_iter().min_by(|a, b| a.rmse_m().total_cmp(&b.rmse_m()))?;
        for _ in 0..WEIGHINGS {
            if !observed.weigh(&bounded_levels(&observed, &best.misfit_m), WORTH_ANOTHER) {
                break;
            }
            best = fit_nearby(&best.model, &best.free, &observed)?;
        }
        if let Model::ForceDeflection(structure) = &best.model {
            let data: Vec<&TestData<'_>> = self.tests.iter().map(|test| &test.data).collect();
            let model = Model::ForceDeflection(with_restitution(structure, &data)?);
            best = fit_nearby(&model, &best.free, &observed)?;
        }
        Some(self.worded(best, names, index))
    }

    /// The fit from one start.
    fn fit(&self, (model, free): &Start, observed: &Observation) -> Option<Minimum> {
        let model = self.in_the_deepest_test(model)?;
        match self.rate.index(model.kind()) {
            Some(index) => {
                let free: Vec<FitParameter> = free.iter().cloned().chain([free_rate(model.kind(), index)]).collect();
                fit_nearby(&model, &free, observed)
            }
            None if matches!(model, Model::ForceDeflection(_)) => fit_nearby(&model, free, observed),
            None => fit_as_measured(&model, free, observed),
        }
    }

    /// A model of one test with the mass of the deepest crush, its damper up to the fastest, and stiff in unloading.
    fn in_the_deepest_test(&self, model: &Model) -> Option<Model> {
        let (names, mut values) = (model.kind().parameter_names(), model.values());
        for (name, value) in names.iter().zip(&mut values) {
            match *name {
                "mass_kg" => *value = self.tests.get(JointTest::deepest(self.tests))?.data.mass_kg,
                "v0_m_per_s" => {
                    *value = self.tests.iter().map(|test| test.data.impact_speed_m_per_s).fold(*value, f64::max);
                }
                _ => {}
            }
        }
        match model.with_values(&values).ok()? {
            Model::ForceDeflection(mut structure) => {
                structure.unloading_stiffness_n_per_m *= STIFF;
                Some(Model::ForceDeflection(structure))
            }
            model => Some(model),
        }
    }

    /// A minimum as a candidate, with the error in each test.
    fn worded(&self, minimum: Minimum, names: Vec<String>, index: usize) -> Candidate {
        let model = minimum.model.clone();
        let active_bounds = minimum.names_on_bound().collect();
        let observed = &minimum.observed;
        let names = names.into_iter().map(|name| (name, 1)).collect();
        let descent = (minimum.iterations, minimum.evaluations, minimum.stop_reason);
        let rmse = observed.rmse(&minimum.misfit_m);
        let fit = Fit::of_waves(observed, &rmse, names, descent, active_bounds);
        let mut notes = vec![Note::info(format!(
            "fitted to {} tests together, each with its own speed and mass; mass {} kg is that of {}",
            self.tests.len(),
            model.value("mass_kg").unwrap_or_default(),
            self.tests.get(JointTest::deepest(self.tests)).map_or("", |test| test.name)
        ))];
        notes.extend(self.rate.remark(&model).map(Note::info));
        notes.extend(bounds_remark(&model, &fit.active_bounds).map(Note::info));
        let candidate = Candidate::new(model, Method::DirectFit, index, notes);
        Candidate { fit: Some(fit), minimum: Some(minimum), ..candidate }
    }
}

impl JointTest<'_> {
    /// The place of the test with the deepest crush, the first of several: the one that a joint model is counted from.
    pub fn deepest(tests: &[Self]) -> usize {
        let depth = |k: &usize| tests[*k].data.dynamic_crush_m.unwrap_or(0.0);
        (0..tests.len()).max_by(|a, b| depth(a).total_cmp(&depth(b)).then(b.cmp(a))).unwrap_or(0)
    }
}

/// The acceleration of a test over the window of its displacement; `None` where it is not at hand.
///
/// A displacement says little of single knots: two sums smooth what they do. Of one test the fit starts near the curve
/// that is read off it; the curve of several is held by their forces at equal crush.
fn acceleration(test: &JointTest<'_>, displacement: &ObservedWave) -> Option<ObservedWave> {
    let (record, measurement) = test.acceleration?;
    let window_s = displacement.window_s();
    let (what, samples) = ((displacement.mass, FitQuantity::Acceleration), displacement.samples.len());
    ObservedWave::new(record, what, measurement, window_s, samples).ok()
}

/// Root mean square misfits of the waves, as shares of their sizes within a factor of the mean of their quantity.
fn bounded_levels(observed: &Observation, misfit: &[f64]) -> Vec<f64> {
    let sizes: Vec<f64> = observed.waves.iter().map(ObservedWave::size).collect();
    let shares: Vec<f64> = observed.rmse(misfit).iter().zip(&sizes).map(|(rmse, size)| rmse / size).collect();
    let mean_of = |quantity: FitQuantity| {
        let of_quantity = observed.waves.iter().zip(&shares).filter(|(wave, _)| wave.quantity == quantity);
        let logarithms: Vec<f64> = of_quantity.map(|(_, share)| share.max(f64::MIN_POSITIVE).ln()).collect();
        (logarithms.iter().sum::<f64>() / logarithms.len() as f64).exp()
    };
    let level = |((wave, share), size): ((&ObservedWave, &f64), &f64)| {
        let mean = mean_of(wave.quantity);
        share.clamp(mean / LEVELS, mean * LEVELS) * size
    };
    observed.waves.iter().zip(&shares).zip(&sizes).map(level).collect()
}

// The rate factor of a structure: what tests at different speeds say of it, and a prior where they do not.

/// Ratio of the fastest to the slowest impact from which a rate factor is fitted. The force at equal crush differs by
/// `r` times the difference of the speeds there: at 56 and 50 km/h by 2 % for `r` of 1 % per m/s, about what a zero
/// level that is off by 1 % of the peak makes of it.
const APART: f64 = 1.1;

/// One unit of its coordinate, s/m: the size that vehicles have.
const UNIT_S_PER_M: f64 = 0.01;

/// The largest that is looked for, s/m: beyond foams and hydraulic dampers.
const LARGEST_S_PER_M: f64 = 0.2;

/// Where the rate factor of a joint fit comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RateFactorSource {
    /// The speeds are far enough apart: it is fitted.
    Fitted,
    /// They are not, and it stays the prior of a single test.
    Prior {
        /// Fastest over slowest impact.
        ratio: f64,
    },
}

impl RateFactorSource {
    /// Whether impacts at these speeds tell the rate factor: the fastest at least a tenth above the slowest.
    pub fn of(speeds_m_per_s: &[f64]) -> Self {
        let fastest = speeds_m_per_s.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let slowest = speeds_m_per_s.iter().copied().fold(fastest, f64::min);
        let ratio = fastest / slowest;
        // Speeds as read off a record are never exactly those of the order.
        if ratio >= APART { Self::Fitted } else { Self::Prior { ratio } }
    }

    /// Index of the rate factor among the values of a model; `None`: it is not fitted, or the model has none.
    pub(crate) fn index(self, kind: ModelKind) -> Option<usize> {
        let place = kind.parameters().iter().position(|p| p.kind == ParameterKind::RateFactor);
        place.filter(|_| self == Self::Fitted)
    }

    /// In words, for a model that has one.
    pub(crate) fn remark(self, model: &Model) -> Option<String> {
        let rate = rate_of(model)?;
        Some(match self {
            Self::Fitted => format!("rate factor {rate:.4} s/m fitted: the tests are at different speeds"),
            Self::Prior { ratio } => format!(
                "rate factor {rate} s/m is a prior, +- 0.005: the fastest test is {:.1} % faster than the slowest, \
                 and less than {:.0} % does not tell it",
                100.0 * (ratio - 1.0),
                100.0 * (APART - 1.0)
            ),
        })
    }
}

/// The rate factor of a model, s/m; `None`: it has none.
fn rate_of(model: &Model) -> Option<f64> {
    let name = model.kind().parameters().iter().find(|p| p.kind == ParameterKind::RateFactor)?.name;
    model.value(name)
}

/// The rate factor, at this index of the values, as a free parameter; its coordinate is a share, so that zero is a
/// value like others.
fn free_rate(kind: ModelKind, index: usize) -> FitParameter {
    let (name, bounds) = (kind.parameter_names()[index].into(), (0.0, LARGEST_S_PER_M / UNIT_S_PER_M));
    FitParameter::of_search((index, name, ParameterKind::RateFactor), Map::Share(UNIT_S_PER_M), bounds, bounds)
}

// The unloading stiffness of a crushed structure from the restitution of several tests.

/// Least unloading stiffness over the steepest slope of the curve: below one, unloading would give back more than was
/// put in.
const STIFFER: f64 = 1.05;

/// The structure with the unloading stiffness `F(C)²/(m v0² e²)` of its tests, the geometric mean of them, at least
/// 1.05 times its steepest slope. `None`: no curve.
pub(crate) fn with_restitution(structure: &CrushedStructure, tests: &[&TestData<'_>]) -> Option<CrushedStructure> {
    let knots = structure.knots();
    let stiffness = |test: &&TestData<'_>, restitution: f64| -> Option<f64> {
        let force = force_at(&knots, test.dynamic_crush_m?)?;
        Some(force * force / (test.mass_kg * (test.impact_speed_m_per_s * restitution).powi(2)))
    };
    let shown = |test: &&TestData<'_>| test.coefficient_of_restitution.filter(|e| *e > 0.0);
    let mut each: Vec<f64> = tests.iter().filter_map(|test| stiffness(test, shown(test)?)).collect();
    if each.is_empty() {
        each = tests.iter().filter_map(|test| stiffness(test, USUAL_RESTITUTION)).collect();
    }
    let mean = (each.iter().map(|k| k.ln()).sum::<f64>() / each.len() as f64).exp();
    let slopes = knots.windows(2).map(|pair| (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0));
    let least = STIFFER * slopes.fold(0.0, f64::max);
    let unloading_stiffness_n_per_m = if mean.is_finite() { mean.max(least) } else { least };
    let mut unloading = *structure;
    unloading.unloading_stiffness_n_per_m = unloading_stiffness_n_per_m;
    Some(unloading).filter(|_| unloading_stiffness_n_per_m > 0.0)
}

/// The force at a deflection, N: straight between knots, the last piece goes on.
fn force_at(knots: &[(f64, f64)], deflection_m: f64) -> Option<f64> {
    let right = knots.partition_point(|(d, _)| *d <= deflection_m).clamp(1, knots.len().checked_sub(1)?);
    let (a, b) = (knots.get(right - 1)?, knots.get(right)?);
    Some(a.1 + (b.1 - a.1) * (deflection_m - a.0) / (b.0 - a.0)).filter(|force| *force > 0.0)
}

remarks! {
    /// Remarks of models for several tests.
    pub REMARKS;

    /// Models of several masses are not fitted to several tests.
    CR504 ChainsNotJoint { models: Vec<String> }
    bears on (About::Model(String::new()), Weight::None)
    decided "The joint fit takes models of one mass. Sensors of the compartment do not show how the mass divides."
    means "These models are missing from the joint result. The models of one mass are fitted to all tests."
    remedy "nothing; the run of a single test fits them to that test"
    says format!(
        "{}: not fitted to several tests, because sensors of the compartment do not show the mass split",
        models.join(", ")
    );

    /// One of the tests has no fit of a model, so that none to all tests is made.
    CR505 NoFitOfOneTest { model: String, test: String }
    bears on (About::Model(String::new()), Weight::Slight)
    decided "The joint fit starts from the fits to the single tests. This test has none of the model."
    means "The model is missing from the joint result. Other models are not touched by it."
    remedy "read the remarks that begin with the name of the test, or leave that test out"
    says format!("{model}: not fitted to all tests, {test} alone has no fit of it");

    /// A model was fitted to every test, and the joint fit gave no candidate.
    CR506 NotJoint { model: String, reason: String }
    bears on (About::Model(model.clone()), Weight::Marked)
    decided "No start had a finite response, the computation failed, or it reached its limit. The limit is the work of \
             250 million samples for each start and test, a hundred times what the fits of an ordinary record take."
    means "The model is missing from the joint result. Other models are not touched by it."
    remedy "check mass, impact speed and unit of every test, or leave the model out of models"
    says format!("{model}: not fitted to all tests, {reason}");
}

#[cfg(test)]
mod tests {

    use super::*;

    #[test]
    fn a_tenth_between_the_speeds_tells_the_rate_factor() {
        assert_eq!(RateFactorSource::of(&[15.0, 11.0]), RateFactorSource::Fitted);
        assert_eq!(RateFactorSource::of(&[10.0, 11.0, 10.5]), RateFactorSource::Fitted);
        assert_eq!(RateFactorSource::of(&[15.0, 15.0]), RateFactorSource::Prior { ratio: 1.0 });
        assert!(matches!(RateFactorSource::of(&[15.0, 15.3]), RateFactorSource::Prior { .. }));
        assert_eq!(RateFactorSource::Fitted.index(ModelKind::Kelvin), None);
    }

    fn test(speed: f64, crush_m: f64, restitution: Option<f64>) -> TestData<'static> {
        TestData {
            mass_kg: 1000.0,
            impact_speed_m_per_s: speed,
            time_of_dynamic_crush_s: Some(0.07),
            dynamic_crush_m: Some(crush_m),
            coefficient_of_restitution: restitution,
            time_of_rebound_s: None,
            displacement: None,
            measurement: None,
            sensors: &[],
        }
    }

    #[test]
    fn it_is_the_mean_of_what_the_tests_show_and_never_below_the_curve() {
        // 300 kN from 0.1 m on.
        let curve = CrushedStructure::new(1000.0, &[(0.1, 3e5), (0.6, 3e5)], 1e8, 0.0).unwrap();
        let of = |tests: &[TestData<'_>]| {
            let tests: Vec<&TestData<'_>> = tests.iter().collect();
            with_restitution(&curve, &tests).unwrap().unloading_stiffness_n_per_m
        };
        let [fast, slow] = [test(15.0, 0.5, Some(0.1)), test(10.0, 0.3, Some(0.2))];
        // 9e10/(1000 1.5²) and 9e10/(1000 2²).
        assert!((of(&[fast]) - 4e7).abs() < 1.0 && (of(&[slow]) - 2.25e7).abs() < 1.0);
        assert!((of(&[fast, slow]) - 3e7).abs() < 1.0);
        // A test that shows none has no say; where none shows one, the usual one stands for it.
        assert_eq!(of(&[fast, test(10.0, 0.3, None)]), of(&[fast]));
        assert!((of(&[test(10.0, 0.3, None)]) - 4e7).abs() < 1.0);
        // 1.05 times 3 MN/m.
        assert!((of(&[test(15.0, 0.5, Some(0.9))]) - 3.15e6).abs() < 1.0);
    }
}
