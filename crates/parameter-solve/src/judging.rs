//! Follows every candidate through the measurement of the record and says how well its parameters are known.

use crumple_lumped::{Elastoplastic, Model, Nonlinear1};
use crumple_parameter_solve::{
    Candidate, FreeParameter, InputUncertainty, JudgeOptions, Measurement, Method, Observed, Refined, free_parameters,
    judge, propagate, refine,
};
use crumple_signal::{Displacement, Signal};
use crumple_stage::records::EventsV1;
use crumple_stage::{Inputs, Output, RefuseExt, Wave};
use rayon::prelude::*;
use serde::Serialize;

use crate::measured::measurement;
use crate::options::StageSettings;
use crate::pairs::{FitKind, pair_up};
use crate::verdict::Judged;

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
/// A fit under side conditions gives way to the minimum where that meets them to this, of crush and its time: the filter
/// itself moves the time of a crush that ends steeply by 0.1 ms and more.
const CONDITIONS: f64 = 5e-3;

/// What all candidates share.
struct Scene<'a> {
    settings: &'a StageSettings,
    events: &'a EventsV1,
    displacement: Signal<Displacement>,
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
            if let Model::Elastoplastic(model) = candidate.model {
                let chosen =
                    if model.release { "leaves the barrier at rebound" } else { "stays attached and swings on" };
                candidate
                    .notes
                    .push(format!("the model {chosen}: fits the record up to rebound better than the other way"));
            }
        }
    }
    if scene.known {
        pair_up(candidates, &mut judged, out);
    }
    Ok(judged)
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
                let both =
                    [true, false].map(|release| with(&Model::Elastoplastic(Elastoplastic { release, ..*model })));
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
