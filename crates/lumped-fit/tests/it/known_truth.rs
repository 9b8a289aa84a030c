//! Every record with known lumped parameters: from the exact signal, and seen through filter and integration.

use std::collections::BTreeMap;
use std::path::Path;

use crumple_lumped::{DoubleSpringMassDamper, Elastoplastic, Kelvin, Maxwell, Model, Nonlinear1, Nonlinear2};
use crumple_lumped_fit::{
    Assessment, AssessmentOptions, Candidate, FollowedEvents, InputUncertainty, MassSplit, MeasureModel, Minimum,
    Observation, Repetition, SolveSettings, TestData, fit_as_measured, free_parameters, propagate, solve,
};
use crumple_signal::{Displacement, IntegrationRule, Measurement, Notes, Signal, TwoPassFilter};
use crumple_testkit::{KnownTruth, known_truths, known_truths_in, other_records, write_known_truth};
use serde_json::Value;

const RELEASING: Model = Model::Elastoplastic(Elastoplastic {
    mass_kg: 873.0,
    loading_stiffness_n_per_m: 321_944.0,
    unloading_stiffness_n_per_m: 36_084_417.0,
    release: true,
});

/// A record made here, sampled as those of the folder are.
fn made(model: Model, v0: f64) -> Truth {
    let folder = tempfile::tempdir().unwrap();
    write_known_truth(folder.path(), "made", &model, v0).unwrap();
    Truth::read(&known_truths_in(folder.path())[0]).unwrap()
}

/// Springs and dampers with the scale of their kind: what is near zero is known to a share of that.
fn scales(truth: &Truth) -> BTreeMap<String, f64> {
    free_parameters(&truth.model, truth.v0, truth.crush).iter().map(|p| (p.name.to_string(), p.scale)).collect()
}

fn mass(model: &Model) -> f64 {
    model.parameters().iter().filter(|(name, _)| name.ends_with("_kg")).map(|(_, kg)| kg).sum()
}

/// Largest deviation, relative to the true value; one of zero, to the scale of its kind.
fn distance(found: &Model, truth: &Truth, wanted: &Model) -> f64 {
    let (found, wanted) = (found.parameters(), wanted.parameters());
    scales(truth)
        .iter()
        .map(|(name, scale)| {
            let unit = if wanted[name] == 0.0 { *scale } else { wanted[name].abs() };
            (found[name] - wanted[name]).abs() / unit
        })
        .fold(0.0, f64::max)
}

/// The models that give the record: the truth, and its dual. The dual that a file states must be that.
fn equals(truth: &Truth) -> Result<Vec<Model>, String> {
    let Model::DoubleSpringMassDamper(double) = &truth.model else { return Ok(vec![truth.model.clone()]) };
    let dual = double.dual();
    let found = [dual.k1_n_per_m, dual.k2_n_per_m, dual.c1_n_s_per_m, dual.c2_n_s_per_m];
    for (stated, found) in truth.stated_dual.iter().flatten().zip(found) {
        // Three roundings of a product.
        if (stated - found).abs() > 1e-12 * found.abs() {
            return Err(format!("{}: its dual has {stated}, found {found}", truth.record));
        }
    }
    Ok(vec![truth.model.clone(), Model::DoubleSpringMassDamper(dual)])
}

/// What `check` says of every record of a folder that a lumped model made; panics with all that failed.
fn walk(records: &[KnownTruth], check: impl Fn(&Truth) -> Result<(), String>) {
    let of = |known: &KnownTruth| Truth::read(known).and_then(|truth| check(&truth)).err();
    let failed: Vec<String> = records.iter().filter(|known| known.is_lumped()).filter_map(of).collect();
    assert!(failed.is_empty(), "{} records failed:\n{}", failed.len(), failed.join("\n"));
}

fn require(holds: bool, say: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(say()) }
}

#[test]
fn every_record_gives_its_parameters_back_from_the_exact_signal() {
    walk(&known_truths(), comes_back_from_the_exact_signal);
}

/// Every candidate of the record's own model from a displacement that starts `first_s` after contact, and was measured
/// so; `None`: exact.
fn candidates(
    truth: &Truth,
    (first_s, measurement): (f64, Option<Measurement>),
    samples: Vec<f64>,
    events: &FollowedEvents,
) -> Vec<Candidate> {
    let kind = truth.model.kind();
    let displacement = Signal::<Displacement>::new(first_s, truth.dt_s, samples).unwrap();
    let test = TestData {
        mass_kg: mass(&truth.model),
        impact_speed_m_per_s: truth.v0,
        time_of_dynamic_crush_s: truth.t_m.map(|_| events.time_of_dynamic_crush_s),
        dynamic_crush_m: truth.t_m.map(|_| events.dynamic_crush_m),
        coefficient_of_restitution: truth.restitution.map(|_| events.coefficient_of_restitution),
        time_of_rebound_s: truth.t_rebound.filter(|_| measurement.is_some()),
        displacement: Some(&displacement),
        measurement,
        sensors: &[],
    };
    let split = match &truth.model {
        Model::DoubleSpringMassDamper(m) => MassSplit::Both(m.m1_kg, m.m2_kg),
        _ => MassSplit::FrontFraction(0.25),
    };
    let settings = SolveSettings { models: vec![kind], split, ..SolveSettings::default() };
    solve(&test, &settings, &mut Notes::new()).unwrap()
}

fn comes_back_from_the_exact_signal(truth: &Truth) -> Result<(), String> {
    let record = &truth.record;
    let response = truth.model.respond(truth.v0, truth.dt_s, truth.samples).unwrap();
    let events = FollowedEvents {
        time_of_dynamic_crush_s: truth.t_m.unwrap_or(0.0),
        dynamic_crush_m: truth.crush,
        coefficient_of_restitution: truth.restitution.unwrap_or(0.0),
    };
    let found = candidates(truth, (0.0, None), response.compartment().displacement_m.clone(), &events);
    for wanted in &equals(truth)? {
        let nearest =
            found.iter().map(|candidate| distance(&candidate.model, truth, wanted)).fold(f64::INFINITY, f64::min);
        eprintln!("{record}: {nearest:.1e} from the exact signal");
        // The acceptance limit. Rounding of the record (1e-16) times the sensitivities is far below it, but for four
        // real poles (condition up to 1e6 and more) and the spring of 4 N/m between springs of 2e5 N/m.
        require(nearest <= 1e-6, || format!("{record}: {nearest:e} from the exact signal: {found:?}"))?;
    }
    Ok(())
}

/// CFC 60 as the filter stage designs it: ISO 6487 Annex A, 1.25/0.6 times the class, bilinear.
fn cfc_60(dt_s: f64) -> TwoPassFilter {
    let wa = (std::f64::consts::PI * 60.0 * 1.25 / 0.6 * dt_s).tan();
    let d = 1.0 + std::f64::consts::SQRT_2 * wa + wa * wa;
    let a0 = wa * wa / d;
    let coefficients =
        [a0, 2.0 * a0, a0, -2.0 * (wa * wa - 1.0) / d, (-1.0 + std::f64::consts::SQRT_2 * wa - wa * wa) / d];
    TwoPassFilter { coefficients, samples_added: (0.01 / dt_s).round() as usize }
}

fn measurement(truth: &Truth) -> Measurement {
    Measurement {
        dt_s: truth.dt_s,
        first_s: truth.first_s,
        samples: truth.before + truth.samples,
        filter: Some(cfc_60(truth.dt_s)),
        from_contact: false,
        rule: Some(IntegrationRule::Trapezoid),
        before_event: None,
    }
}

/// The record of a model through CFC 60, with a wave laid over it.
fn observed(truth: &Truth, to_s: f64, error: impl Fn(f64) -> f64) -> Observation {
    let measurement = measurement(truth);
    let mut x = measurement.displacement(&truth.model, truth.v0, measurement.samples - 1).unwrap();
    for (k, x) in x.iter_mut().enumerate() {
        *x += error(measurement.time_s(k));
    }
    let record = Signal::<Displacement>::new(measurement.first_s, truth.dt_s, x).unwrap();
    Observation::new(&record, measurement, truth.v0, (0.0, to_s), 250).unwrap()
}

/// Up to where a record is compared: its rebound for the model that shows its unloading there, else its dynamic crush,
/// else its end.
fn window_end_s(truth: &Truth) -> f64 {
    let unloading = matches!(truth.model, Model::Elastoplastic(_));
    truth.t_rebound.filter(|_| unloading).or(truth.t_m).unwrap_or(truth.end_s()).min(truth.end_s())
}

#[test]
fn a_model_followed_through_the_filter_comes_back_from_five_percent_away() {
    walk(&known_truths(), comes_back_from_five_percent_away);
}

fn comes_back_from_five_percent_away(truth: &Truth) -> Result<(), String> {
    let record = &truth.record;
    let seen = observed(truth, window_end_s(truth), |_| 0.0);
    let free = free_parameters(&truth.model, truth.v0, truth.crush);
    let mut values = truth.model.parameters();
    for (k, parameter) in free.iter().enumerate() {
        *values.get_mut(&*parameter.name).unwrap() *= if k % 2 == 0 { 1.05 } else { 0.97 };
    }
    let mut start = Model::from_parameters(truth.model.kind(), &values).unwrap();
    if let (Model::Elastoplastic(start), Model::Elastoplastic(of)) = (&mut start, &truth.model) {
        start.release = of.release;
    }
    let found = fit_as_measured(&start, &free, &seen).unwrap();
    let assessed = found.assess(None, AssessmentOptions::default()).unwrap();
    eprintln!("{record}: rms {:.1e} m, rank {} {:?}", found.rmse_m(), assessed.rank, assessed.weakest_direction);
    // The record and the model went the same way, so nothing but rounding is left; four real poles and ten
    // parameters leave valleys of 1e-10 m that no descent leaves.
    require(found.rmse_m() < 1e-8, || format!("{record}: {} m from five percent away", found.rmse_m()))?;
    require(assessed.rank == free.len(), || format!("{record}: rank {} of {}", assessed.rank, free.len()))?;
    stands_inside(&assessed, &truth.model).map_err(|fault| format!("{record}: {fault}"))?;
    let small = assessed.correlation.iter().flatten().all(|r| r.abs() <= 1.0);
    require(small, || format!("{record}: correlations {:?}", assessed.correlation))
}

/// The truth inside every 95 % interval.
fn stands_inside(assessed: &Assessment, wanted: &Model) -> Result<(), String> {
    let wanted = wanted.parameters();
    for (name, (low, high)) in &assessed.interval {
        let inside = low.is_none_or(|low| low <= wanted[name]) && high.is_none_or(|high| wanted[name] <= high);
        require(inside, || format!("{name}: {} in {low:?} {high:?}", wanted[name]))?;
    }
    Ok(())
}

#[test]
fn every_record_gives_its_parameters_back_through_cfc_60() {
    walk(&known_truths(), comes_back_through_cfc_60);
}

/// The events of the filtered record, and the minimum seen through the filter that every candidate carries.
fn comes_back_through_cfc_60(truth: &Truth) -> Result<(), String> {
    let record = &truth.record;
    let way = measurement(truth);
    let x = way.displacement(&truth.model, truth.v0, way.samples - 1).unwrap();
    let signal = Signal::<Displacement>::new(way.first_s, way.dt_s, x.clone()).unwrap();
    let whole = Observation::new(&signal, way, truth.v0, (0.0, truth.end_s()), usize::MAX).unwrap();
    let events = FollowedEvents::of(&whole).unwrap_or(FollowedEvents {
        time_of_dynamic_crush_s: 0.0,
        dynamic_crush_m: truth.crush,
        coefficient_of_restitution: 0.0,
    });
    let found: Vec<(Minimum, Assessment)> = candidates(truth, (way.first_s, Some(way)), x, &events)
        .into_iter()
        .filter_map(|candidate| {
            let minimum = candidate.minimum?;
            let assessed = minimum.assess(None, AssessmentOptions::default())?;
            Some((minimum, assessed))
        })
        .collect();
    for wanted in &equals(truth)? {
        let faults: Vec<String> =
            found.iter().filter_map(|(refined, assessed)| holds(refined, assessed, wanted).err()).collect();
        require(faults.len() < found.len(), || format!("{record} through CFC 60: {}", faults.join("; ")))?;
    }
    Ok(())
}

/// Within 2 %, or the half width that the judgement states where that is larger; and the truth inside the interval.
fn holds(refined: &Minimum, assessed: &Assessment, wanted: &Model) -> Result<(), String> {
    let wanted = at_crush_of(wanted, &refined.model);
    let (of_truth, of_fit) = (wanted.parameters(), refined.model.parameters());
    for (name, (low, high)) in &assessed.interval {
        let (truth, value) = (of_truth[name], of_fit[name]);
        let low = low.map_or(f64::INFINITY, |low| value - low);
        let stated = high.map_or(f64::INFINITY, |high| high - value).max(low);
        let allowed = stated.max(0.02 * truth.abs());
        require((value - truth).abs() <= allowed, || format!("{name} is {value}, {truth} within {allowed}"))?;
    }
    stands_inside(assessed, &wanted)
}

/// The nonlinear model with its last spring knot moved along its line to the crush of another, where a fit has it.
fn at_crush_of(model: &Model, other: &Model) -> Model {
    let crush = other.parameters().get("crush_m").copied();
    match (model.clone(), crush) {
        (Model::Nonlinear1(mut m), Some(crush)) => {
            m.k2_n_per_m = m.k1_n_per_m + (m.k2_n_per_m - m.k1_n_per_m) * crush / m.crush_m;
            m.crush_m = crush;
            Model::Nonlinear1(m)
        }
        (Model::Nonlinear2(mut m), Some(crush)) => {
            m.k3_n_per_m = m.k2_n_per_m + (m.k3_n_per_m - m.k2_n_per_m) * (crush - m.x1_m) / (m.crush_m - m.x1_m);
            m.crush_m = crush;
            Model::Nonlinear2(m)
        }
        (other, _) => other,
    }
}

#[test]
fn profile_and_bootstrap_agree_with_the_linear_interval_where_the_model_is_well_determined() {
    let truth = made(Model::Kelvin(Kelvin { mass_kg: 1200.0, stiffness_n_per_m: 3.5e5, damping_n_s_per_m: 9e3 }), 13.4);
    // A tenth of a millimetre, four swings in the window.
    let seen = observed(&truth, truth.t_m.unwrap(), |t| 1e-4 * (300.0 * t).sin());
    let free = free_parameters(&truth.model, truth.v0, truth.crush);
    let found = fit_as_measured(&truth.model, &free, &seen).unwrap();
    let assessed = found.assess(None, AssessmentOptions { profile: true, bootstrap: 200 }).unwrap();
    let again = found.assess(None, AssessmentOptions { profile: true, bootstrap: 200 }).unwrap();
    assert_eq!(assessed, again, "seeded and collected by index");
    let bootstrap = assessed.bootstrap.as_ref().unwrap();
    let wanted = truth.model.parameters();
    for profile in &assessed.profile {
        let (low, high) = assessed.interval[&profile.parameter];
        let width = (high.unwrap() / low.unwrap()).ln();
        assert!(profile.identifiable());
        let of_profile = (profile.high.unwrap() / profile.low.unwrap()).ln();
        let (low, high) = bootstrap.interval[&profile.parameter];
        let of_bootstrap = (high.unwrap() / low.unwrap()).ln();
        eprintln!("{}: linear {width:.2e}, profile {of_profile:.2e}, bootstrap {of_bootstrap:.2e}", profile.parameter);
        // Three ways to count a dozen independent samples: they agree in size, not in digits.
        assert!(of_profile / width > 0.2 && of_profile / width < 5.0, "{of_profile} {width}");
        assert!(of_bootstrap / width > 0.1 && of_bootstrap / width < 5.0, "{of_bootstrap} {width}");
        let value = wanted[&profile.parameter];
        assert!(profile.low.unwrap() <= value && value <= profile.high.unwrap());
        assert!(profile.points.windows(2).all(|w| w[0].0 < w[1].0), "values rise");
    }
}

#[test]
fn a_parameter_without_effect_has_an_open_profile() {
    // Up to the dynamic crush an elastoplastic model does not know how it will unload.
    let truth = made(RELEASING, 9.7222);
    let seen = observed(&truth, 0.02, |t| 1e-4 * (300.0 * t).sin());
    let free = free_parameters(&truth.model, truth.v0, truth.crush);
    let found = fit_as_measured(&truth.model, &free, &seen).unwrap();
    let assessed = found.assess(None, AssessmentOptions { profile: true, bootstrap: 0 }).unwrap();
    let profile = assessed.profile.iter().find(|p| p.parameter == "unloading_stiffness_n_per_m").unwrap();
    assert!(!profile.identifiable(), "{profile:?}");
    let loading = assessed.profile.iter().find(|p| p.parameter == "loading_stiffness_n_per_m").unwrap();
    assert!(loading.identifiable(), "{loading:?}");
}

#[test]
fn uncertain_inputs_move_the_parameters_as_the_closed_form_says() {
    let truth =
        made(Model::Kelvin(Kelvin { mass_kg: 873.0, stiffness_n_per_m: 321_905.0, damping_n_s_per_m: 0.0 }), 9.7222);
    let seen = observed(&truth, truth.t_m.unwrap(), |_| 0.0);
    let free = free_parameters(&truth.model, truth.v0, truth.crush);
    let base = Repetition::perturbed(&seen, 0.0, 0.0, 0.0, 0.0).unwrap().fit(&truth.model, &free).unwrap();
    assert!((base["stiffness_n_per_m"] / 321_905.0 - 1.0).abs() < 1e-9);
    // k = m (v0/C)²: proportional to the mass.
    let heavier = Repetition::perturbed(&seen, 0.01, 0.0, 0.0, 0.0).unwrap().fit(&truth.model, &free).unwrap();
    assert!((heavier["stiffness_n_per_m"] / base["stiffness_n_per_m"] - 1.01).abs() < 1e-9);
    // Crush: δC = t_m δv0 to first order, seen from the first sample 20 ms earlier minus what re-zeroing takes.
    let faster = Repetition::perturbed(&seen, 0.0, 0.03, 0.0, 0.0).unwrap().fit(&truth.model, &free).unwrap();
    let gained = faster["dynamic_crush_m"] - base["dynamic_crush_m"];
    // The model takes up part of the error by its damper: the size is that of the table, not its digits.
    assert!((gained / (0.03 * truth.t_m.unwrap()) - 1.0).abs() < 0.5, "{gained}");
    let inputs = InputUncertainty { mass_kg: 8.73, ..InputUncertainty::default() };
    let spread = propagate(&truth.model, &free, &seen, 873.0, &inputs, 200).unwrap();
    // One percent, from 200 draws: its own relative uncertainty is 1/sqrt(400) = 5 %, three of them allowed.
    let relative = spread.standard_deviation["stiffness_n_per_m"] / 321_905.0;
    assert!((relative / 0.01 - 1.0).abs() < 0.15, "{relative}");
    assert_eq!(spread, propagate(&truth.model, &free, &seen, 873.0, &inputs, 200).unwrap());
}

/// Records of other parameters, and two of them as a faster sampling has them.
fn others(folder: &Path) -> Vec<KnownTruth> {
    for (name, model, v0) in other_records() {
        write_known_truth(folder, name, &model, v0).unwrap();
    }
    let mut records = known_truths_in(folder);
    let mut faster: Vec<KnownTruth> =
        records.iter().filter(|r| ["kelvin", "double-light-front"].contains(&r.name.as_str())).cloned().collect();
    for record in &mut faster {
        record.name.push_str(" at 20 kHz");
        record.truth["sampling"] =
            serde_json::json!({ "rate_hz": 20_000, "t_first_s": -0.01, "samples": 3_200, "trigger_sample_index": 200 });
    }
    records.extend(faster);
    records
}

#[test]
fn records_of_other_parameters_and_sampling_come_back_from_the_exact_signal() {
    let folder = tempfile::tempdir().unwrap();
    walk(&others(folder.path()), comes_back_from_the_exact_signal);
}

#[test]
fn records_of_other_parameters_and_sampling_come_back_through_cfc_60() {
    let folder = tempfile::tempdir().unwrap();
    walk(&others(folder.path()), comes_back_through_cfc_60);
}

#[test]
fn a_record_that_is_not_understood_fails_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let kelvin = Kelvin { mass_kg: 1200.0, stiffness_n_per_m: 3.5e5, damping_n_s_per_m: 9e3 };
    write_known_truth(folder.path(), "kelvin-x", &Model::Kelvin(kelvin), 13.4).unwrap();
    let known = known_truths_in(folder.path()).remove(0);
    let faulty = |change: fn(&mut Value)| {
        let mut known = known.clone();
        change(&mut known.truth);
        Truth::read(&known).unwrap_err()
    };
    assert_eq!(faulty(|t| t["model"] = "triple".into()), "kelvin-x: a model \"triple\" is not known here");
    assert_eq!(faulty(|t| t["model"] = Value::Null), "kelvin-x: a model \"\" is not known here");
    assert_eq!(faulty(|t| t["parameters"]["k"] = Value::Null), "kelvin-x: parameters.k is missing");
    assert_eq!(faulty(|t| t["sampling"]["rate_hz"] = Value::Null), "kelvin-x: sampling.rate_hz is missing");
    assert_eq!(faulty(|t| t["v0_m_s"] = Value::Null), "kelvin-x: v0_m_s is missing");
}

#[test]
fn a_record_without_dynamic_crush_and_rebound_comes_back_too() {
    // Two real roots: critical at sqrt(k m)/2 = 3.1e4 N·s/m.
    let creeping = Maxwell { mass_kg: 1300.0, stiffness_n_per_m: 3e6, damping_n_s_per_m: 25_000.0 };
    let truth = made(Model::Maxwell(creeping), 14.0);
    assert!(truth.t_m.is_none() && truth.t_rebound.is_none() && truth.restitution.is_none());
    comes_back_from_the_exact_signal(&truth).unwrap();
    comes_back_through_cfc_60(&truth).unwrap();
}

/// Everything that a test takes from a record.
#[derive(Debug, Clone)]
pub struct Truth {
    pub record: String,
    pub dt_s: f64,
    /// First sample, s after contact.
    pub first_s: f64,
    /// Samples from contact on, and before it.
    pub samples: usize,
    pub before: usize,
    pub model: Model,
    pub v0: f64,
    /// Scale of the displacement: the dynamic crush, or where the model never stops the largest displacement of the
    /// record.
    pub crush: f64,
    /// None where the model never stops.
    pub t_m: Option<f64>,
    /// None where the model has no rebound.
    pub t_rebound: Option<f64>,
    pub restitution: Option<f64>,
    /// Another set of parameters that gives the same record, as the file has it.
    pub stated_dual: Option<[f64; 4]>,
}

impl Truth {
    /// Reads the file of a record. What is missing or not known is an error with the record's name.
    pub fn read(known: &KnownTruth) -> Result<Self, String> {
        Self::of(known).map_err(|fault| format!("{}: {fault}", known.name))
    }

    fn of(known: &KnownTruth) -> Result<Self, String> {
        let value = &known.truth;
        let v0 = number(value, "v0_m_s")?;
        let expected = &value["expected"];
        let event = |key: &str| expected[key].as_f64();
        let sampling = &value["sampling"];
        let count = |key: &str| sampling[key].as_u64().map(|n| n as usize).ok_or(format!("sampling.{key} is missing"));
        let before = count("trigger_sample_index")?;
        let dt_s = 1.0 / number(sampling, "rate_hz").map_err(|fault| format!("sampling.{fault}"))?;
        let samples = count("samples")?.checked_sub(before).ok_or("sampling: contact is after the last sample")?;
        let first_s = sampling["t_first_s"].as_f64().unwrap_or(-(before as f64) * dt_s);
        let model = model(known.model(), &value["parameters"], event("C"))?;
        let crush = match event("C") {
            Some(crush) => crush,
            None => {
                let response = model.respond(v0, dt_s, samples).map_err(|error| error.to_string())?;
                response.compartment().displacement_m.iter().copied().fold(0.0, f64::max)
            }
        };
        let dual = &expected["dual_parameters"];
        let stated_dual = ["k1", "k2", "c1", "c2"].map(|key| dual[key].as_f64());
        Ok(Self {
            record: known.name.clone(),
            dt_s,
            first_s,
            samples,
            before,
            crush,
            model,
            v0,
            t_m: event("t_m"),
            t_rebound: event("t_rebound"),
            restitution: event("v_rebound").map(|v| -v / v0),
            stated_dual: match stated_dual {
                [Some(k1), Some(k2), Some(c1), Some(c2)] => Some([k1, k2, c1, c2]),
                _ => None,
            },
        })
    }

    /// Time after contact of the last sample.
    pub fn end_s(&self) -> f64 {
        (self.samples - 1) as f64 * self.dt_s
    }
}

fn number(value: &Value, key: &str) -> Result<f64, String> {
    value[key].as_f64().ok_or_else(|| format!("{key} is missing"))
}

/// The model of a file. The last knot of a nonlinear spring stands at the dynamic crush where there is one, where a fit
/// has it: the line up to there is the same, and its value at that place is what can come back.
fn model(kind: &str, p: &Value, crush: Option<f64>) -> Result<Model, String> {
    let n = |key: &str| number(p, key).map_err(|fault| format!("parameters.{fault}"));
    let list = |key: &str| -> Result<Vec<f64>, String> {
        let list = p[key].as_array().ok_or_else(|| format!("parameters.{key} is missing"))?;
        list.iter().map(|x| x.as_f64().ok_or_else(|| format!("parameters.{key} holds {x}"))).collect()
    };
    Ok(match kind {
        "kelvin" => Model::Kelvin(Kelvin { mass_kg: n("m")?, stiffness_n_per_m: n("k")?, damping_n_s_per_m: n("c")? }),
        "maxwell" => {
            Model::Maxwell(Maxwell { mass_kg: n("m")?, stiffness_n_per_m: n("k")?, damping_n_s_per_m: n("c")? })
        }
        "elastoplastic" => Model::Elastoplastic(Elastoplastic {
            mass_kg: n("m")?,
            loading_stiffness_n_per_m: n("k_E")?,
            unloading_stiffness_n_per_m: n("k_P")?,
            release: p["release"].as_bool().unwrap_or(false),
        }),
        "double" => Model::DoubleSpringMassDamper(DoubleSpringMassDamper {
            m1_kg: n("m1")?,
            m2_kg: n("m2")?,
            k1_n_per_m: n("k1")?,
            k2_n_per_m: n("k2")?,
            c1_n_s_per_m: n("c1")?,
            c2_n_s_per_m: n("c2")?,
        }),
        "nonlinear" => {
            let mass_kg = n("m")?;
            let (kx, k) = (list("k_knots")?, list("k_values")?);
            let (cv, c) = (list("c_knots")?, list("c_values")?);
            let at_crush = |i: usize| {
                let end = crush.unwrap_or(kx[i + 1]);
                (end, k[i] + (k[i + 1] - k[i]) * (end - kx[i]) / (kx[i + 1] - kx[i]))
            };
            match (&kx[..], &k[..], &cv[..], &c[..]) {
                ([_, _], [k1, _], [_, knee, last], [c1, c2, c3]) => {
                    let (crush_m, k2_n_per_m) = at_crush(0);
                    Model::Nonlinear1(Nonlinear1 {
                        mass_kg,
                        k1_n_per_m: *k1,
                        k2_n_per_m,
                        c1_n_s_per_m: *c1,
                        c2_n_s_per_m: *c2,
                        c3_n_s_per_m: *c3,
                        v_thresh_m_per_s: *knee,
                        crush_m,
                        v0_m_per_s: *last,
                    })
                }
                ([_, x1, _], [k1, k2, _], [_, v1, v2, last], [c1, c2, c3, c4]) => {
                    let (crush_m, k3_n_per_m) = at_crush(1);
                    Model::Nonlinear2(Nonlinear2 {
                        mass_kg,
                        k1_n_per_m: *k1,
                        k2_n_per_m: *k2,
                        k3_n_per_m,
                        x1_m: *x1,
                        c1_n_s_per_m: *c1,
                        c2_n_s_per_m: *c2,
                        c3_n_s_per_m: *c3,
                        c4_n_s_per_m: *c4,
                        v1_m_per_s: *v1,
                        v2_m_per_s: *v2,
                        crush_m,
                        v0_m_per_s: *last,
                    })
                }
                _ => return Err(format!("no nonlinear model has {} and {} knots", kx.len(), cv.len())),
            }
        }
        other => return Err(format!("a model {other:?} is not known here")),
    })
}
