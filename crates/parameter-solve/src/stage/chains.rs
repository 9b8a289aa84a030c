//! Fits the chains that a pipeline file states.

use crumple_signal::{About, Weight};
use std::collections::BTreeMap;

use crumple_lumped::{Chain, ParameterKind};
use crumple_lumped_fit::{
    ChainAssessmentOptions, ChainDual, ChainSolution, Observation, ObservedWave, SensorPlace, assess_chain,
    errors_in_words, fit_chain, note_of_errors,
};
use crumple_stage::records::{CandidateV1, EventsV1, UncertaintyV1};
use crumple_stage::{Inputs, Output, RefuseExt, Refused, total_mass_remark};

use crate::stage::assess::CandidateAssessment;
use crate::stage::inputs::{sensor_wave, stated_places};
use crate::stage::options::chain_table::FittedChain;
use crate::stage::options::settings::StageSettings;
use crate::stage::records::fit_record;
use crate::stage::records::{linearised, summary_text, uncertainty_record};

/// A sensor on a mass of the chain.
struct Sensor {
    channel: String,
    place: SensorPlace,
}

/// A candidate of a chain.
pub struct ChainCandidate {
    pub id: String,
    pub record: CandidateV1,
    /// Whether masses were fitted that this record does not divide.
    pub division_undecided: bool,
}

/// Candidates of every chain.
pub fn fit_chains(settings: &StageSettings, input: &Inputs, out: &mut Output) -> anyhow::Result<Vec<ChainCandidate>> {
    if settings.chain.is_empty() {
        return Ok(Vec::new());
    }
    let events: EventsV1 = input.record("/events")?;
    let test = input.test()?;
    let total_kg = settings.mass_kg.or(test.mass_kg);
    let speed = events.impact_speed_m_per_s.or(test.impact_speed_m_per_s).ok_or_else(|| {
        Refused::new("neither the events nor the test have an impact speed")
            .hint("--impact-speed 35km/h at crumple-ingest")
    })?;
    settings.assessment.check(total_kg, speed)?;
    let assessment = &settings.assessment;
    let asked = ChainAssessmentOptions {
        options: assessment.options(),
        inputs: assessment.inputs(),
        repetitions: assessment.repetitions,
    };
    let mut records = Vec::new();
    for chain in &settings.chain {
        let (observed, sensors) = waves(chain, settings, input, &events, speed, out)?;
        let hint = || format!("see [parameter-solve.chain.{}] of the pipeline file", chain.name);
        let stated = chain.stated(total_kg);
        let solutions = fit_chain(&stated, &observed, settings.solve.fit_starts).refuse_with_hint(hint())?;
        warn_of_open_parameters(chain, &solutions, out);
        if let Some(text) =
            total_kg.zip(solutions.first()).and_then(|(kg, s)| total_mass_remark(s.chain.masses_kg(), kg))
        {
            let text = format!("chain {}: {text}", chain.name);
            out.notes().concern(About::Mass, Weight::Marked, text);
        }
        for (k, solution) in solutions.iter().enumerate() {
            let found = assess_chain(&stated, &observed, solution, &asked).refuse_with_hint(hint())?;
            let id = chain.id(k + 1);
            let assessed = found.assessment.map(|assessment| CandidateAssessment {
                assessment,
                propagation: found.propagation,
                repeated: "fit",
                through_filter: observed.is_as_measured(),
                front_mass_uncertainty: 0.0,
            });
            let (inner, repeated) = (
                assessed.as_ref().map(|assessed| &assessed.assessment),
                assessed.as_ref().is_some_and(|assessed| assessed.propagation.is_some()),
            );
            let without = [
                ("profiled", asked.options.profile && inner.is_none_or(|inner| inner.profile.is_empty())),
                ("bootstrapped", asked.options.bootstrap > 0 && inner.is_none_or(|inner| inner.bootstrap.is_none())),
                ("repeated with uncertain inputs", asked.inputs.any() && !repeated),
            ];
            for (what, _) in without.iter().filter(|(_, missing)| *missing) {
                let text = format!("{id}: not {what}, too few fits near its minimum converged");
                out.notes().concern(About::Model(id.clone()), Weight::Slight, text);
            }
            let text = assessed.as_ref().map(|assessed| summary_text(&id, assessed, str::to_owned));
            if let Some(text) = text.filter(|text| !text.is_empty()) {
                out.summary(text);
            }
            let subject = (chain, solution, assessed.as_ref(), total_kg);
            let record = record(subject, &observed, &sensors, &events.channel);
            records.push(ChainCandidate { id, record, division_undecided: solution.division_undecided });
        }
    }
    Ok(records)
}

/// Warnings on what the record does not decide.
fn warn_of_open_parameters(chain: &FittedChain, solutions: &[ChainSolution], out: &mut Output) {
    let duals = solutions.iter().filter(|s| matches!(s.dual, Some(ChainDual::Solution(_)))).count() / 2;
    let sets = solutions.len() - duals;
    let about = || About::Model(format!("chain/{}", chain.name));
    let mut warn = |text: String| {
        out.notes().concern(about(), Weight::Marked, format!("chain {}: {text}", chain.name));
    };
    if sets > 1 {
        warn(format!(
            "{sets} parameter sets fit within 1 % as well as the best; the record does not determine the parameters"
        ));
    }
    let Some(best) = solutions.first() else { return };
    if let Some(text) = open(best) {
        warn(text);
    }
    if !best.fit.active_bounds.is_empty() {
        warn(format!("on a bound of the search, not determined by the record: {}", best.fit.active_bounds.join(", ")));
    }
    if let Some(text) = dual(chain, best) {
        warn(text);
    }
    if best.division_undecided {
        warn(DIVISION.to_owned());
    }
}

/// The note where masses were fitted to one sensor on the last mass.
const DIVISION: &str = "masses were fitted to a sensor on the last mass alone: with any noise the record does not \
    determine how they divide; give a mass, or name a sensor on another mass with --sensors";

/// What the dual is, in words.
fn dual(chain: &FittedChain, solution: &ChainSolution) -> Option<String> {
    let same = "the same masses and the same motion of the last one";
    Some(match solution.dual.as_ref()? {
        ChainDual::Solution(place) => format!(
            "its dual {} has {same}: a sensor on the mass next to the barrier decides between them",
            chain.id(*place)
        ),
        ChainDual::NotAsStated(other) => {
            let springs: Vec<String> = other
                .parameters()
                .iter()
                .filter(|(name, _)| Chain::parameter_kind(name) != Some(ParameterKind::Mass))
                .map(|(name, value)| format!("{name} {value:.1}"))
                .collect();
            format!(
                "its dual ({}) has {same} and is left out by what was given or by a bound, not by the record",
                springs.join(", ")
            )
        }
    })
}

/// The waves to fit, and the sensors they are of.
fn waves(
    chain: &FittedChain,
    settings: &StageSettings,
    input: &Inputs,
    events: &EventsV1,
    impact_speed_m_per_s: f64,
    out: &mut Output,
) -> anyhow::Result<(Observation, Vec<Sensor>)> {
    let quantity = settings.solve.quantity;
    let masses = chain.masses.len();
    let mass_kg = settings.mass_kg.or(input.test()?.mass_kg).unwrap_or(1.0);
    let (mut waves, mut sensors) = (Vec::new(), Vec::new());
    for (place, channel) in stated_places(settings, &events.channel) {
        // A chain is fitted to motions; how far it misses the wall's force is scored.
        if place == SensorPlace::Wall {
            continue;
        }
        let mass = if chain.has_occupant() { place.mass_before_occupant(masses) } else { place.mass(masses) };
        let Some(mass) = mass else {
            out.notes().info(format!(
                "chain {}: sensor {channel} is on the {place}, which this chain does not have: not fitted",
                chain.name
            ));
            continue;
        };
        let wave = sensor_wave(settings, input, events, (place, channel), mass_kg)?;
        let record = &wave.record;
        let end_s = record.end_s() - events.time_zero_s;
        let to_s = settings.solve.fit_to_s.or(events.time_of_dynamic_crush_s).unwrap_or(end_s);
        let window = (settings.solve.fit_from_s, to_s);
        let what = (Some(mass), quantity);
        let samples = settings.solve.fit_samples;
        let observed = ObservedWave::new(record, what, events.time_zero_s, wave.measurement, window, samples)
            .refuse_with_hint("see --fit-from and --fit-to")?;
        waves.push(observed);
        sensors.push(Sensor { channel: wave.channel, place });
    }
    Ok((Observation { impact_speed_m_per_s, waves }, sensors))
}

/// What the record leaves open, in words.
fn open(solution: &ChainSolution) -> Option<String> {
    let linearised = solution.linearised.as_ref()?;
    let open: Vec<&str> =
        linearised.interval.iter().filter(|(_, ends)| **ends == (None, None)).map(|(name, _)| name.as_str()).collect();
    if open.is_empty() {
        return None;
    }
    let weakest = linearised.weakest_direction.as_ref().filter(|_| linearised.rank < linearised.parameters.len());
    let weakest = weakest.map_or_else(String::new, |words| format!("; {words}"));
    Some(format!(
        "the record determines {} directions of {} free numbers; without an interval: {}{weakest}",
        linearised.rank,
        linearised.parameters.len(),
        open.join(", ")
    ))
}

fn record(
    (chain, solution, assessed, total_kg): (&FittedChain, &ChainSolution, Option<&CandidateAssessment>, Option<f64>),
    observed: &Observation,
    sensors: &[Sensor],
    pulse: &str,
) -> CandidateV1 {
    let parameters = solution.chain.parameters();
    let mut fit = solution.fit.clone();
    for (of_fit, sensor) in fit.sensors.iter_mut().zip(sensors) {
        of_fit.channel.clone_from(&sensor.channel);
    }
    let (quantity, from_ms, to_ms) = (fit.quantity, 1e3 * fit.from_s, 1e3 * fit.to_s);
    let given: Vec<&str> = parameters.keys().filter(|name| !solution.free.contains(name)).map(String::as_str).collect();
    let mut notes = vec![
        format!("masses from the barrier on: {}", chain.masses.join(", ")),
        format!("stated in the pipeline; fitted: {}", solution.free.join(", ")),
    ];
    if !given.is_empty() {
        notes.push(format!("given: {}", given.join(", ")));
    }
    notes.push(format!("fitted to {quantity} from {from_ms:.2} ms to {to_ms:.2} ms after time zero"));
    if sensors.len() > 1 {
        let errors = sensors.iter().zip(&fit.sensors);
        let errors = errors.map(|(s, fit)| (fit.rmse, quantity, s.channel.as_str(), s.place.to_string()));
        notes.push(note_of_errors(&errors_in_words(errors), None));
    }
    if !observed.is_as_measured() {
        notes.push("the filter of a sensor is not known: fitted as if its record had none".to_owned());
    }
    if !fit.active_bounds.is_empty() {
        notes.push(format!("on a bound, not determined by the record: {}", fit.active_bounds.join(", ")));
    }
    notes.extend(open(solution));
    notes.extend(dual(chain, solution));
    notes.extend(solution.division_undecided.then(|| DIVISION.to_owned()));
    notes.extend(total_kg.and_then(|kg| total_mass_remark(solution.chain.masses_kg(), kg)));
    let equivalent_to = match solution.dual {
        Some(ChainDual::Solution(place)) => Some(chain.id(place)),
        _ => None,
    };
    CandidateV1 {
        model: "chain".to_owned(),
        method: chain.name.clone(),
        parameters,
        physical: solution.chain.is_passive(),
        equivalent_to,
        fit: Some(fit_record(&fit, pulse)),
        uncertainty: Some(assessed.map_or_else(|| open_record(solution, observed), uncertainty_record)),
        notes,
    }
}

/// Everything that was free stays open.
fn open_record(solution: &ChainSolution, observed: &Observation) -> UncertaintyV1 {
    let method = linearised(observed.is_as_measured());
    let open: BTreeMap<String, Option<f64>> = solution.free.iter().map(|name| (name.clone(), None)).collect();
    UncertaintyV1 { method, interval_low: open.clone(), interval_high: open, ..UncertaintyV1::default() }
}
