//! Follows every candidate through the measurement of the record and says how well its parameters are known.

use std::collections::BTreeMap;

use crumple_lumped::{DoubleSpringMassDamper, Model, ModelKind, Nonlinear1};
use crumple_parameter_solve::{
    Candidate, FitQuantity, FreeParameter, InputUncertainty, IntegrationRule, JudgeOptions, Judgement, Measurement,
    Method, Observed, Propagation, Refined, TwoPassFilter, free_parameters, judge, propagate, refine,
};
use crumple_signal::{Acceleration, Displacement};
use crumple_stage::records::{ChannelFilterV1, EventsV1, ProfileV1, ReplicatesV1, UncertaintyV1};
use crumple_stage::{Inputs, Output, RefuseExt, Wave};
use rayon::prelude::*;
use serde::Serialize;

use crate::options::StageSettings;

/// What is judged beyond the covariance; part of the settings.
#[derive(Debug, Clone, Serialize)]
pub struct Judging {
    pub profile: bool,
    pub bootstrap: usize,
    pub mass_uncertainty_kg: f64,
    pub speed_uncertainty_m_per_s: f64,
    pub bias_uncertainty_m_per_s2: f64,
    pub time_zero_uncertainty_s: f64,
    pub repetitions: usize,
}

/// Error of a displacement whose filter is not known, m: what CFC 60 does to the jump at contact.
const UNKNOWN_FILTER_M: f64 = 1e-5;
/// Two pairs of double models closer than this, in logarithms, are one.
const SAME: f64 = 1e-3;
/// A fit under side conditions gives way to the minimum where that meets them to this, of crush and its time: the filter
/// itself moves the time of a crush that ends steeply by 0.1 ms and more.
const CONDITIONS: f64 = 5e-3;

/// Both ends of an interval.
type Ends = (Option<f64>, Option<f64>);

/// The verdict on one candidate.
#[derive(Debug, Clone)]
pub struct Judged {
    judgement: Judgement,
    propagation: Option<Propagation>,
    through_filter: bool,
}

/// What all candidates share.
struct Scene<'a> {
    settings: &'a StageSettings,
    events: &'a EventsV1,
    displacement: crumple_signal::Signal<Displacement>,
    measurement: Measurement,
    /// Whether the filter of the record is known: only then a fit gives way to the minimum seen through it.
    known: bool,
    mass_kg: Option<f64>,
    impact_speed_m_per_s: f64,
    crush_m: f64,
}

/// Refines the fits among `candidates` and judges all of them; double pairs that turn out equal, or worse than the record
/// can tell, are taken out. The result goes with the candidates.
pub fn judge_all(
    candidates: &mut Vec<Candidate>,
    settings: &StageSettings,
    input: &Inputs,
    events: &EventsV1,
    mass_kg: Option<f64>,
    out: &mut Output,
) -> anyhow::Result<Vec<Option<Judged>>> {
    let none = vec![None; candidates.len()];
    let wave = input.wave_if(&format!("{}/displacement", events.channel));
    let Some(displacement) = wave.map(Wave::signal::<Displacement>).transpose().refuse()? else { return Ok(none) };
    let (Some(crush_m), Some(impact_speed_m_per_s)) = (
        events.dynamic_crush_m,
        events.impact_speed_m_per_s.or(input.test().ok().and_then(|test| test.impact_speed_m_per_s)),
    ) else {
        return Ok(none);
    };
    let (measurement, known) = measurement(input, events, &displacement)?;
    let scene = Scene { settings, events, displacement, measurement, known, mass_kg, impact_speed_m_per_s, crush_m };
    if !known {
        out.notes().info(
            "the filter of the record is not known here (give the artifact of crumple-filter too): models are fitted as if \
             the displacement had none",
        );
    }
    let refined: Vec<Option<(Observed, Refined)>> =
        candidates.par_iter().map(|candidate| scene.refine(candidate)).collect();
    let mut judged: Vec<Option<Judged>> = candidates
        .par_iter()
        .zip(&refined)
        .map(|(candidate, refined)| refined.as_ref().and_then(|(o, r)| scene.judge(candidate, o, r)))
        .collect();
    for (candidate, found) in candidates.iter_mut().zip(&refined) {
        if let Some((_, refined)) = found
            && scene.gives_way(candidate, refined)
        {
            adopt(candidate, refined);
        }
    }
    pair_up(candidates, &mut judged, &scene, out);
    Ok(judged)
}

/// The measurement of the displacement, and whether its filter is known.
fn measurement(
    input: &Inputs,
    events: &EventsV1,
    displacement: &crumple_signal::Signal<Displacement>,
) -> anyhow::Result<(Measurement, bool)> {
    let record: Option<ChannelFilterV1> = input.record_if(&format!("/filter/{}", events.channel))?;
    let acceleration = input
        .wave_if(&events.channel)
        .map(Wave::signal::<Acceleration>)
        .transpose()
        .refuse()?
        .filter(|wave| (wave.dt_s() - displacement.dt_s()).abs() <= 1e-9 * wave.dt_s());
    let (dt_s, t0_s, samples) = match &acceleration {
        Some(wave) => (wave.dt_s(), wave.t0_s(), wave.len()),
        None => (displacement.dt_s(), displacement.t0_s(), displacement.len()),
    };
    let rule = match events.rule.as_deref() {
        Some("forward-euler") => IntegrationRule::ForwardEuler,
        _ => IntegrationRule::Trapezoid,
    };
    let filter = record.as_ref().and_then(|record| {
        let class = record.mode.starts_with("iso6487") || record.mode.starts_with("sae");
        let coefficients: [f64; 5] = record.coefficients.clone().try_into().ok()?;
        (class && record.cfc.is_some())
            .then_some(TwoPassFilter { coefficients, samples_added: record.samples_added as usize })
    });
    let untouched = record.as_ref().is_some_and(|record| record.coefficients.is_empty() && record.width_s.is_none());
    let unfiltered = untouched && input.test().ok().and_then(|t| t.channel(&events.channel)?.cfc).is_none();
    let as_sampled = record.as_ref().is_some_and(|r| r.resampled_to_hz.is_none());
    let known = acceleration.is_some()
        && as_sampled
        && (filter.is_some() || unfiltered)
        && matches!(events.rule.as_deref(), None | Some("trapezoid" | "forward-euler"));
    let measurement = Measurement {
        dt_s,
        first_s: t0_s - events.time_zero_s,
        samples,
        filter: filter.filter(|_| known),
        from_contact: events.start.as_deref() != Some("record-start"),
        rule,
    };
    Ok((measurement, known))
}

impl Scene<'_> {
    fn window(&self, candidate: &Candidate) -> Option<(f64, f64)> {
        if let (Model::Elastoplastic(_), Some(rebound)) = (&candidate.model, self.events.time_of_rebound_s) {
            // The unloading shows between dynamic crush and rebound only.
            return Some((self.settings.solve.fit_from_s, rebound));
        }
        match &candidate.fit {
            Some(fit) => Some((fit.from_s, fit.to_s)),
            None => Some((
                self.settings.solve.fit_from_s,
                self.settings.solve.fit_to_s.or(self.events.time_of_dynamic_crush_s)?,
            )),
        }
    }

    fn refine(&self, candidate: &Candidate) -> Option<(Observed, Refined)> {
        if candidate.method == Method::CoefficientMatching || candidate.of_sensors() || candidate.is_second_of_pair() {
            return None;
        }
        let window = self.window(candidate)?;
        let mut observed = Observed::new(
            &self.displacement,
            self.events.time_zero_s,
            self.measurement,
            self.impact_speed_m_per_s,
            window,
            self.settings.solve.fit_samples,
        )
        .ok()?;
        if !self.known {
            observed.resolution_m = UNKNOWN_FILTER_M;
        }
        let with = |model: &Model| {
            let mut free = free_parameters(model, self.impact_speed_m_per_s, self.crush_m, true);
            free.retain(|parameter| !held(candidate).any(|name| name == parameter.name));
            refine(model, &free, &observed)
        };
        let found = match &candidate.model {
            // Whether the vehicle leaves the barrier or swings on: what fits the record better.
            Model::Elastoplastic(model) => {
                let both = [true, false]
                    .map(|release| with(&Model::Elastoplastic(crumple_lumped::Elastoplastic { release, ..*model })));
                both.into_iter().flatten().min_by(|a, b| a.rmse_m().total_cmp(&b.rmse_m()))
            }
            model => with(model),
        }?;
        Some((observed, found))
    }

    /// Whether the candidate is a fit that the minimum through the filter replaces.
    fn gives_way(&self, candidate: &Candidate, refined: &Refined) -> bool {
        if !self.known || candidate.method != Method::DirectFit {
            return false;
        }
        match &refined.model {
            Model::Nonlinear1(model) => self.meets_conditions(model),
            _ => true,
        }
    }

    /// The side conditions of the first nonlinear model.
    fn meets_conditions(&self, model: &Nonlinear1) -> bool {
        let events = Model::Nonlinear1(*model).events(self.impact_speed_m_per_s).ok();
        let crush = events.as_ref().and_then(|e| e.dynamic_crush_m);
        let time = events.as_ref().and_then(|e| e.time_of_dynamic_crush_s).zip(self.events.time_of_dynamic_crush_s);
        let ordered = model.k1_n_per_m <= model.k2_n_per_m
            && model.c1_n_s_per_m >= model.c2_n_s_per_m
            && model.c2_n_s_per_m >= model.c3_n_s_per_m;
        ordered
            && crush.is_some_and(|crush| (crush / self.crush_m - 1.0).abs() <= CONDITIONS)
            && time.is_some_and(|(found, wanted)| (found / wanted - 1.0).abs() <= CONDITIONS)
    }

    fn judge(&self, candidate: &Candidate, observed: &Observed, refined: &Refined) -> Option<Judged> {
        let asked = &self.settings.judging;
        let options = JudgeOptions { profile: asked.profile, bootstrap: asked.bootstrap };
        let given = (!self.gives_way(candidate, refined)).then_some(&candidate.model);
        let mut judgement = judge(refined, given, observed, options)?;
        judgement.interval.extend(held(candidate).map(|name| (name, (None, None))));
        let inputs = InputUncertainty {
            mass_kg: asked.mass_uncertainty_kg,
            impact_speed_m_per_s: asked.speed_uncertainty_m_per_s,
            bias_m_per_s2: asked.bias_uncertainty_m_per_s2,
            time_zero_s: asked.time_zero_uncertainty_s,
        };
        let free: Vec<FreeParameter> = refined.free.clone();
        let propagation = match self.mass_kg {
            Some(mass_kg) if inputs.any() => {
                propagate(&refined.model, &free, observed, mass_kg, &inputs, asked.repetitions)
            }
            _ => None,
        };
        Some(Judged { judgement, propagation, through_filter: self.known })
    }
}

/// Parameters that the search left on a bound, other than zero: that value is the bound's, so it is held and has no interval.
fn held(candidate: &Candidate) -> impl Iterator<Item = &'static str> {
    let values = candidate.model.parameters();
    let names = candidate.fit.as_ref().map_or(&[][..], |fit| &fit.active_bounds);
    names.iter().copied().filter(move |name| values.get(*name).is_some_and(|value| *value != 0.0))
}

/// A fit takes the values of the minimum.
fn adopt(candidate: &mut Candidate, refined: &Refined) {
    candidate.model = refined.model;
    if let Some(fit) = &mut candidate.fit {
        fit.rmse = refined.rmse_m();
        fit.iterations += refined.iterations;
        fit.evaluations += refined.evaluations;
        fit.stop_reason = refined.stop_reason;
        // What was held stays named; a zero may have been left.
        fit.active_bounds.retain(|name| refined.free.iter().all(|p| p.name != *name));
        let stopped = refined.free.iter().zip(&refined.on_bound).filter(|(_, held)| **held).map(|(p, _)| p.name);
        fit.active_bounds.extend(stopped);
    }
}

trait FitKind {
    /// A double model fitted to the displacement of the compartment alone: one of a pair, or its own dual.
    fn is_double(&self) -> bool;
    /// The second of a pair, which follows from the first.
    fn is_second_of_pair(&self) -> bool;
    /// Fitted to something else than that displacement: it has its own uncertainty.
    fn of_sensors(&self) -> bool;
}

impl FitKind for Candidate {
    fn is_double(&self) -> bool {
        self.model.kind() == ModelKind::DoubleSpringMassDamper && self.method == Method::DirectFit && !self.of_sensors()
    }

    fn is_second_of_pair(&self) -> bool {
        self.is_double() && self.equivalent_to.is_some_and(|first| first < self.index)
    }

    fn of_sensors(&self) -> bool {
        self.fit.as_ref().is_some_and(|fit| fit.quantity != FitQuantity::Displacement || !fit.sensors.is_empty())
    }
}

/// Gives every double pair its dual again, best pair first; leaves out pairs that came to the same place, and those that the
/// record tells from the best.
fn pair_up(candidates: &mut Vec<Candidate>, judged: &mut Vec<Option<Judged>>, scene: &Scene<'_>, out: &mut Output) {
    if !scene.known {
        return;
    }
    let Some(first) = candidates.iter().position(Candidate::is_double) else { return };
    let count = candidates[first..].iter().take_while(|candidate| candidate.is_double()).count();
    let mut pairs: Vec<(Candidate, Option<Candidate>, Option<Judged>)> = Vec::new();
    let block: Vec<Candidate> = candidates.drain(first..first + count).collect();
    let verdicts: Vec<Option<Judged>> = judged.drain(first..first + count).collect();
    for (a, verdict) in block.iter().zip(verdicts).filter(|(a, _)| !a.is_second_of_pair()) {
        let second = block.iter().find(|b| b.is_second_of_pair() && b.equivalent_to == Some(a.index));
        pairs.push((a.clone(), second.cloned(), verdict));
    }
    let rmse = |c: &Candidate| c.fit.as_ref().map_or(f64::INFINITY, |fit| fit.rmse);
    pairs.sort_by(|(a, ..), (b, ..)| rmse(a).total_cmp(&rmse(b)));
    let best = pairs.first().map_or(0.0, |(a, ..)| rmse(a));
    let before = pairs.len();
    let mut kept: Vec<(Candidate, Option<Candidate>, Option<Judged>)> = Vec::new();
    for pair in pairs {
        let near = |(other, ..): &(Candidate, Option<Candidate>, Option<Judged>)| same(&other.model, &pair.0.model);
        if rmse(&pair.0) <= 1.01 * best + crumple_parameter_solve::RESOLUTION_M && !kept.iter().any(near) {
            kept.push(pair);
        }
    }
    if kept.len() < before {
        out.notes().info(format!(
            "double-spring-mass-damper: seen through the filter of the record {} of the {before} pairs remain",
            kept.len()
        ));
    }
    let mut place = first;
    for (k, (mut a, b, verdict)) in kept.into_iter().enumerate() {
        let Some(mut b) = b else {
            // Its own dual.
            a.index = 2 * k + 1;
            candidates.insert(place, a);
            judged.insert(place, verdict);
            place += 1;
            continue;
        };
        if let Model::DoubleSpringMassDamper(model) = a.model {
            let dual = model.dual();
            b.model = Model::DoubleSpringMassDamper(dual);
            let of_b = verdict.as_ref().map(|v| Judged {
                judgement: v.judgement.of_dual(&b.model, &a.model),
                propagation: None,
                ..v.clone()
            });
            if let (Some(fit), Some(own)) = (&mut b.fit, &a.fit) {
                *fit = own.clone();
                fit.active_bounds.iter_mut().for_each(|name| *name = exchanged(name));
            }
            let mut of_a = verdict;
            let mut of_b = of_b;
            if dual.k1_n_per_m < model.k1_n_per_m {
                std::mem::swap(&mut a.model, &mut b.model);
                std::mem::swap(&mut a.fit, &mut b.fit);
                std::mem::swap(&mut of_a, &mut of_b);
            }
            (a.index, a.equivalent_to) = (2 * k + 1, Some(2 * k + 2));
            (b.index, b.equivalent_to) = (2 * k + 2, Some(2 * k + 1));
            candidates.insert(place, a);
            candidates.insert(place + 1, b);
            judged.insert(place, of_a);
            judged.insert(place + 1, of_b);
            place += 2;
        }
    }
}

fn exchanged(name: &str) -> &'static str {
    match name {
        "k1_n_per_m" => "k2_n_per_m",
        "k2_n_per_m" => "k1_n_per_m",
        "c1_n_s_per_m" => "c2_n_s_per_m",
        _ => "c1_n_s_per_m",
    }
}

/// Whether two double models, or one and the dual of the other, are one.
fn same(a: &Model, b: &Model) -> bool {
    let (Model::DoubleSpringMassDamper(a), Model::DoubleSpringMassDamper(b)) = (a, b) else { return false };
    let near = |x: &DoubleSpringMassDamper, y: &DoubleSpringMassDamper| {
        [
            x.k1_n_per_m / y.k1_n_per_m,
            x.k2_n_per_m / y.k2_n_per_m,
            x.c1_n_s_per_m / y.c1_n_s_per_m,
            x.c2_n_s_per_m / y.c2_n_s_per_m,
        ]
        .iter()
        .all(|ratio| (ratio - 1.0).abs() < SAME)
    };
    near(a, b) || near(&a.dual(), b)
}

impl Judged {
    /// What goes to the artifact.
    pub fn record(&self) -> UncertaintyV1 {
        let j = &self.judgement;
        let own = |name: &&'static str| (*name).to_owned();
        let finite = |values: &BTreeMap<&'static str, f64>| values.iter().map(|(k, v)| (own(k), *v)).collect();
        let side = |of: fn(&Ends) -> Option<f64>| {
            j.interval.iter().map(|(name, interval)| (own(name), of(interval))).collect()
        };
        UncertaintyV1 {
            method: if self.through_filter {
                "linearised about the minimum seen through the record's filter, autocorrelated residuals".to_owned()
            } else {
                "linearised about the minimum, autocorrelated residuals".to_owned()
            },
            standard_deviation: finite(&j.standard_deviation),
            condition: j.condition,
            interval_low: side(|i| i.0),
            interval_high: side(|i| i.1),
            order: j.parameters.iter().map(own).collect(),
            correlation: j.correlation.clone(),
            rank: Some(j.rank as u32),
            weakest_direction: j.weakest_direction.clone(),
            effective_samples: Some(j.effective_samples),
            profile: j
                .profile
                .iter()
                .map(|p| ProfileV1 {
                    parameter: p.parameter.to_owned(),
                    low: p.low,
                    high: p.high,
                    identifiable: p.identifiable(),
                    values: p.points.iter().map(|(value, _)| *value).collect(),
                    rise: p.points.iter().map(|(_, rise)| *rise).collect(),
                })
                .collect(),
            bootstrap: j.bootstrap.as_ref().map(|b| {
                let ends = |of: fn(&Ends) -> Option<f64>| {
                    b.interval.iter().filter_map(|(name, i)| Some((own(name), of(i)?))).collect()
                };
                ReplicatesV1 {
                    method: format!("block bootstrap of the misfit, blocks of {} samples", b.block),
                    replicates: b.replicates as u64,
                    coverage: 0.95,
                    low: ends(|i| i.0),
                    high: ends(|i| i.1),
                }
            }),
            propagation: self.propagation.as_ref().map(|p| ReplicatesV1 {
                method: "fit repeated with mass, impact speed, zero level and time zero drawn anew".to_owned(),
                replicates: p.repetitions as u64,
                coverage: 0.9,
                low: p.interval_90.iter().map(|(name, (low, _))| (own(name), *low)).collect(),
                high: p.interval_90.iter().map(|(name, (_, high))| (own(name), *high)).collect(),
            }),
        }
    }

    /// What a person should hear at once: parameters that the record does not determine; propagated intervals.
    pub fn line(&self, candidate: &Candidate) -> String {
        let mut parts = Vec::new();
        let open: Vec<&str> =
            self.judgement.profile.iter().filter(|p| !p.identifiable()).map(|p| p.parameter).collect();
        if !open.is_empty() {
            parts.push(format!("not identifiable: {}", open.join(", ")));
        }
        if let Some(p) = &self.propagation
            && let Some((low, high)) = p.interval_90.get("dynamic_crush_m")
        {
            parts.push(format!(
                "{} repetitions with uncertain inputs: crush {:.1} to {:.1} mm (5 to 95 %)",
                p.repetitions,
                1e3 * low,
                1e3 * high
            ));
        }
        if parts.is_empty() { String::new() } else { format!("{}: {}", candidate.id(), parts.join("; ")) }
    }
}
