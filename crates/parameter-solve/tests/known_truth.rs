//! Every record with known lumped parameters: from the exact signal, and seen through filter and integration.

#![allow(clippy::unwrap_used, reason = "a failing helper is a failing test")]

use std::collections::BTreeMap;

use crumple_lumped::{DoubleSpringMassDamper, Elastoplastic, Kelvin, Maxwell, Model, Nonlinear1, Nonlinear2};
use crumple_parameter_solve::{
    Evidence, InputUncertainty, IntegrationRule, JudgeOptions, MassSplit, Measurement, Observed, SolveSettings,
    TwoPassFilter, free_parameters, judge, perturbed, propagate, refine, repeat, solve,
};
use crumple_signal::{Displacement, Notes, Signal};
use crumple_testkit::{KnownTruth, known_truths, known_truths_in, other_records, write_known_truth};

struct Truth {
    record: String,
    dt_s: f64,
    /// Samples from contact on, and before it.
    samples: usize,
    before: usize,
    model: Model,
    v0: f64,
    /// Scale of the displacement: the dynamic crush, or where the model never stops the largest displacement of the record.
    crush: f64,
    /// None where the model never stops.
    t_m: Option<f64>,
    /// None where the model has no rebound.
    t_rebound: Option<f64>,
    restitution: Option<f64>,
}

impl Truth {
    /// Time after contact of the last sample.
    fn end_s(&self) -> f64 {
        (self.samples - 1) as f64 * self.dt_s
    }
}

/// Every record of the folder that a lumped model made.
fn truths() -> Vec<Truth> {
    known_truths().iter().filter(|known| known.is_lumped()).map(truth).collect()
}

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
    truth(&known_truths_in(folder.path())[0])
}

fn truth(known: &KnownTruth) -> Truth {
    let value = &known.truth;
    let p = &value["parameters"];
    let n = |key: &str| p[key].as_f64().unwrap();
    let list = |key: &str| -> Vec<f64> { p[key].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect() };
    let e = |key: &str| value["expected"][key].as_f64();
    let crush_of_the_record = e("C");
    // The last knot of a nonlinear model that never stops stays where the truth has it.
    let last_knot = |list: &[f64]| crush_of_the_record.unwrap_or(list[list.len() - 1]);
    let model = match known.model() {
        "kelvin" => Model::Kelvin(Kelvin { mass_kg: n("m"), stiffness_n_per_m: n("k"), damping_n_s_per_m: n("c") }),
        "maxwell" => Model::Maxwell(Maxwell { mass_kg: n("m"), stiffness_n_per_m: n("k"), damping_n_s_per_m: n("c") }),
        "elastoplastic" => Model::Elastoplastic(Elastoplastic {
            mass_kg: n("m"),
            loading_stiffness_n_per_m: n("k_E"),
            unloading_stiffness_n_per_m: n("k_P"),
            release: p["release"].as_bool().unwrap_or(false),
        }),
        "double" => Model::DoubleSpringMassDamper(DoubleSpringMassDamper {
            m1_kg: n("m1"),
            m2_kg: n("m2"),
            k1_n_per_m: n("k1"),
            k2_n_per_m: n("k2"),
            c1_n_s_per_m: n("c1"),
            c2_n_s_per_m: n("c2"),
        }),
        "nonlinear" => {
            // A fit puts the last knot of the spring at the dynamic crush, and the line up to there is the same: its value at
            // that place is what can come back.
            let (kx, mut k, cv, c) = (list("k_knots"), list("k_values"), list("c_knots"), list("c_values"));
            let crush = last_knot(&kx);
            let (i, j) = (k.len() - 2, k.len() - 1);
            k[j] = k[i] + (k[j] - k[i]) * (crush - kx[i]) / (kx[j] - kx[i]);
            if k.len() == 2 {
                Model::Nonlinear1(Nonlinear1 {
                    mass_kg: n("m"),
                    k1_n_per_m: k[0],
                    k2_n_per_m: k[1],
                    c1_n_s_per_m: c[0],
                    c2_n_s_per_m: c[1],
                    c3_n_s_per_m: c[2],
                    v_thresh_m_per_s: cv[1],
                    crush_m: crush,
                    v0_m_per_s: cv[2],
                })
            } else {
                Model::Nonlinear2(Nonlinear2 {
                    mass_kg: n("m"),
                    k1_n_per_m: k[0],
                    k2_n_per_m: k[1],
                    k3_n_per_m: k[2],
                    x1_m: kx[1],
                    c1_n_s_per_m: c[0],
                    c2_n_s_per_m: c[1],
                    c3_n_s_per_m: c[2],
                    c4_n_s_per_m: c[3],
                    v1_m_per_s: cv[1],
                    v2_m_per_s: cv[2],
                    crush_m: crush,
                    v0_m_per_s: cv[3],
                })
            }
        }
        other => panic!("{}: a model {other} is not known here", known.name),
    };
    let v0 = value["v0_m_s"].as_f64().unwrap();
    let sampling = |key: &str| value["sampling"][key].as_u64().unwrap() as usize;
    let before = sampling("trigger_sample_index");
    let (dt_s, samples) = (1.0 / value["sampling"]["rate_hz"].as_f64().unwrap(), sampling("samples") - before);
    let largest = || {
        let response = model.respond(v0, dt_s, samples).unwrap();
        response.compartment().displacement_m.iter().copied().fold(0.0, f64::max)
    };
    Truth {
        record: known.name.clone(),
        dt_s,
        samples,
        before,
        crush: crush_of_the_record.unwrap_or_else(largest),
        model,
        v0,
        t_m: e("t_m"),
        t_rebound: e("t_rebound"),
        restitution: e("v_rebound").map(|v| -v / v0),
    }
}

/// Springs and dampers with the scale of their kind: what is near zero is known to a share of that.
fn scales(truth: &Truth) -> BTreeMap<&'static str, f64> {
    free_parameters(&truth.model, truth.v0, truth.crush, true).iter().map(|p| (p.name, p.scale)).collect()
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
            let unit = if wanted[*name] == 0.0 { *scale } else { wanted[*name].abs() };
            (found[*name] - wanted[*name]).abs() / unit
        })
        .fold(0.0, f64::max)
}

/// The models that give the record: the truth, and its dual.
fn equals(model: &Model) -> Vec<Model> {
    match model {
        Model::DoubleSpringMassDamper(double) => vec![*model, Model::DoubleSpringMassDamper(double.dual())],
        other => vec![*other],
    }
}

#[test]
fn every_record_gives_its_parameters_back_from_the_exact_signal() {
    for truth in truths() {
        comes_back_from_the_exact_signal(&truth);
    }
}

fn comes_back_from_the_exact_signal(truth: &Truth) {
    let record = &truth.record;
    let kind = truth.model.kind();
    let response = truth.model.respond(truth.v0, truth.dt_s, truth.samples).unwrap();
    let exact = response.compartment().displacement_m.clone();
    let displacement = Signal::<Displacement>::new(0.0, truth.dt_s, exact).unwrap();
    let evidence = Evidence {
        mass_kg: mass(&truth.model),
        impact_speed_m_per_s: truth.v0,
        time_of_dynamic_crush_s: truth.t_m,
        dynamic_crush_m: truth.t_m.map(|_| truth.crush),
        coefficient_of_restitution: truth.restitution,
        time_zero_s: 0.0,
        time_of_rebound_s: None,
        displacement: Some(&displacement),
        sensors: &[],
    };
    let split = match &truth.model {
        Model::DoubleSpringMassDamper(m) => MassSplit::Both(m.m1_kg, m.m2_kg),
        _ => MassSplit::FrontFraction(0.25),
    };
    let settings = SolveSettings { models: vec![kind], split, ..SolveSettings::default() };
    let candidates = solve(&evidence, &settings, &mut Notes::new()).unwrap();
    let wanted = equals(&truth.model);
    for wanted in &wanted {
        let nearest = candidates.iter().map(|c| distance(&c.model, truth, wanted)).fold(f64::INFINITY, f64::min);
        eprintln!("{record}: {nearest:.1e} from the exact signal");
        // The acceptance limit. Rounding of the record (1e-16) times the sensitivities is far below it, but for four real
        // poles (condition up to 1e6 and more) and the spring of 4 N/m between springs of 2e5 N/m.
        assert!(nearest <= 1e-6, "{record}: {nearest:e} {candidates:?}");
    }
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
        first_s: -(truth.before as f64) * truth.dt_s,
        samples: truth.before + truth.samples,
        filter: Some(cfc_60(truth.dt_s)),
        from_contact: false,
        rule: IntegrationRule::Trapezoid,
    }
}

/// The record of a model through CFC 60, with a wave laid over it.
fn observed(truth: &Truth, to_s: f64, error: impl Fn(f64) -> f64) -> Observed {
    let measurement = measurement(truth);
    let mut x = measurement.displacement(&truth.model, truth.v0, measurement.samples - 1).unwrap();
    for (k, x) in x.iter_mut().enumerate() {
        *x += error(measurement.time_s(k));
    }
    let record = Signal::<Displacement>::new(measurement.first_s, truth.dt_s, x).unwrap();
    Observed::new(&record, 0.0, measurement, truth.v0, (0.0, to_s), 250).unwrap()
}

#[test]
fn a_model_followed_through_the_filter_comes_back_from_five_percent_away() {
    for truth in truths() {
        let record = &truth.record;
        let unloading = matches!(truth.model, Model::Elastoplastic(_));
        let seen =
            observed(&truth, truth.t_rebound.filter(|_| unloading).or(truth.t_m).unwrap_or(truth.end_s()), |_| 0.0);
        let free = free_parameters(&truth.model, truth.v0, truth.crush, true);
        let mut values = truth.model.parameters();
        for (k, parameter) in free.iter().enumerate() {
            *values.get_mut(parameter.name).unwrap() *= if k % 2 == 0 { 1.05 } else { 0.97 };
        }
        let mut start = Model::from_parameters(truth.model.kind(), &values).unwrap();
        if let (Model::Elastoplastic(start), Model::Elastoplastic(of)) = (&mut start, &truth.model) {
            start.release = of.release;
        }
        let found = refine(&start, &free, &seen).unwrap();
        let judged = judge(&found, None, &seen, JudgeOptions::default()).unwrap();
        eprintln!("{record}: rms {:.1e} m, rank {} {:?}", found.rmse_m(), judged.rank, judged.weakest_direction);
        // The record and the model went the same way, so nothing but rounding is left; four real poles and ten
        // parameters leave valleys of 1e-10 m that no descent leaves.
        assert!(found.rmse_m() < 1e-8, "{record}: {}", found.rmse_m());
        assert_eq!(judged.rank, free.len());
        let wanted = truth.model.parameters();
        for (name, (low, high)) in &judged.interval {
            let inside = low.is_none_or(|low| low <= wanted[*name]) && high.is_none_or(|high| wanted[*name] <= high);
            assert!(inside, "{record} {name}: {} in {low:?} {high:?}", wanted[*name]);
        }
        for row in &judged.correlation {
            assert!(row.iter().all(|r| r.abs() <= 1.0));
        }
    }
}

#[test]
fn profile_and_bootstrap_agree_with_the_linear_interval_where_the_model_is_well_determined() {
    let truth = made(Model::Kelvin(Kelvin { mass_kg: 1200.0, stiffness_n_per_m: 3.5e5, damping_n_s_per_m: 9e3 }), 13.4);
    // A tenth of a millimetre, four swings in the window.
    let seen = observed(&truth, truth.t_m.unwrap(), |t| 1e-4 * (300.0 * t).sin());
    let free = free_parameters(&truth.model, truth.v0, truth.crush, true);
    let found = refine(&truth.model, &free, &seen).unwrap();
    let judged = judge(&found, None, &seen, JudgeOptions { profile: true, bootstrap: 200 }).unwrap();
    let again = judge(&found, None, &seen, JudgeOptions { profile: true, bootstrap: 200 }).unwrap();
    assert_eq!(judged, again, "seeded and collected by index");
    let bootstrap = judged.bootstrap.as_ref().unwrap();
    let wanted = truth.model.parameters();
    for profile in &judged.profile {
        let (low, high) = judged.interval[profile.parameter];
        let width = (high.unwrap() / low.unwrap()).ln();
        assert!(profile.identifiable());
        let of_profile = (profile.high.unwrap() / profile.low.unwrap()).ln();
        let (low, high) = bootstrap.interval[profile.parameter];
        let of_bootstrap = (high.unwrap() / low.unwrap()).ln();
        eprintln!("{}: linear {width:.2e}, profile {of_profile:.2e}, bootstrap {of_bootstrap:.2e}", profile.parameter);
        // Three ways to count a dozen independent samples: they agree in size, not in digits.
        assert!(of_profile / width > 0.2 && of_profile / width < 5.0, "{of_profile} {width}");
        assert!(of_bootstrap / width > 0.1 && of_bootstrap / width < 5.0, "{of_bootstrap} {width}");
        let value = wanted[profile.parameter];
        assert!(profile.low.unwrap() <= value && value <= profile.high.unwrap());
        assert!(profile.points.windows(2).all(|w| w[0].0 < w[1].0), "values rise");
    }
}

#[test]
fn a_parameter_without_effect_has_an_open_profile() {
    // Up to the dynamic crush an elastoplastic model does not know how it will unload.
    let truth = made(RELEASING, 9.7222);
    let seen = observed(&truth, 0.02, |t| 1e-4 * (300.0 * t).sin());
    let free = free_parameters(&truth.model, truth.v0, truth.crush, true);
    let found = refine(&truth.model, &free, &seen).unwrap();
    let judged = judge(&found, None, &seen, JudgeOptions { profile: true, bootstrap: 0 }).unwrap();
    let profile = judged.profile.iter().find(|p| p.parameter == "unloading_stiffness_n_per_m").unwrap();
    assert!(!profile.identifiable(), "{profile:?}");
    let loading = judged.profile.iter().find(|p| p.parameter == "loading_stiffness_n_per_m").unwrap();
    assert!(loading.identifiable(), "{loading:?}");
}

#[test]
fn uncertain_inputs_move_the_parameters_as_the_closed_form_says() {
    let truth =
        made(Model::Kelvin(Kelvin { mass_kg: 873.0, stiffness_n_per_m: 321_905.0, damping_n_s_per_m: 0.0 }), 9.7222);
    let seen = observed(&truth, truth.t_m.unwrap(), |_| 0.0);
    let free = free_parameters(&truth.model, truth.v0, truth.crush, true);
    let base = repeat(&truth.model, &free, &perturbed(&seen, 0.0, 0.0, 0.0, 0.0)).unwrap();
    assert!((base["stiffness_n_per_m"] / 321_905.0 - 1.0).abs() < 1e-9);
    // k = m (v0/C)²: proportional to the mass.
    let heavier = repeat(&truth.model, &free, &perturbed(&seen, 0.01, 0.0, 0.0, 0.0)).unwrap();
    assert!((heavier["stiffness_n_per_m"] / base["stiffness_n_per_m"] - 1.01).abs() < 1e-9);
    // Crush: δC = t_m δv0 to first order, seen from the first sample 20 ms earlier minus what re-zeroing takes.
    let faster = repeat(&truth.model, &free, &perturbed(&seen, 0.0, 0.03, 0.0, 0.0)).unwrap();
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

#[test]
fn records_of_other_parameters_come_back_from_the_exact_signal() {
    let folder = tempfile::tempdir().unwrap();
    for (name, model, v0) in other_records() {
        write_known_truth(folder.path(), name, &model, v0).unwrap();
    }
    for known in known_truths_in(folder.path()) {
        comes_back_from_the_exact_signal(&truth(&known));
    }
}

#[test]
fn a_record_without_dynamic_crush_and_rebound_comes_back_too() {
    // Two real roots: critical at sqrt(k m)/2 = 3.1e4 N·s/m.
    let creeping = Maxwell { mass_kg: 1300.0, stiffness_n_per_m: 3e6, damping_n_s_per_m: 25_000.0 };
    let truth = made(Model::Maxwell(creeping), 14.0);
    assert!(truth.t_m.is_none() && truth.t_rebound.is_none() && truth.restitution.is_none());
    comes_back_from_the_exact_signal(&truth);
}
