//! Fits the chains that a pipeline file states.

use std::collections::BTreeMap;

use crumple_lumped::{Chain, ParameterKind};
use crumple_lumped_fit::{
    ChainAssessment, ChainAssessmentOptions, ChainDual, ChainSolution, LinearisedUncertainty, Observation,
    ObservedWave, RESOLUTION_M, SensorPlace, assess_chain, errors_in_words, fit_chain, note_of_errors,
};
use crumple_signal::Sampled;
use crumple_stage::records::{CandidateV1, EventsV1, FitV1, SensorFitV1, UncertaintyV1};
use crumple_stage::{Inputs, Output, RefuseExt, Refused, total_mass_remark};

use crate::stage::inputs::measurement::{UNKNOWN_FILTER_M, measurement};
use crate::stage::inputs::motions::motion;
use crate::stage::options::chain_table::FittedChain;
use crate::stage::options::settings::StageSettings;
use crate::stage::records::uncertainty::{
    Ends, bootstrap_record, linearised, profile_record, propagation_record, summary_text,
};

/// A sensor on a mass of the chain.
struct Sensor {
    channel: String,
    place: SensorPlace,
    mass: usize,
    /// Whether its filter is known.
    known: bool,
}

/// Candidates of every chain, with their ids.
pub fn fit_chains(
    settings: &StageSettings,
    input: &Inputs,
    out: &mut Output,
) -> anyhow::Result<Vec<(String, CandidateV1)>> {
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
        let known = sensors.iter().all(|sensor| sensor.known);
        let hint = || format!("see [parameter-solve.chain.{}] of the pipeline file", chain.name);
        let stated = chain.stated(total_kg);
        let solutions = fit_chain(&stated, &observed, known, settings.solve.fit_starts).refuse_with_hint(hint())?;
        warn_of_open_parameters(chain, &solutions, out);
        if let Some(text) =
            total_kg.zip(solutions.first()).and_then(|(kg, s)| total_mass_remark(s.chain.masses_kg(), kg))
        {
            out.notes().warning(format!("chain {}: {text}", chain.name));
        }
        for (k, solution) in solutions.iter().enumerate() {
            let assessment = assess_chain(&stated, &observed, known, solution, &asked).refuse_with_hint(hint())?;
            let id = chain.id(k + 1);
            let without = [
                ("profiled", asked.options.profile && assessment.profile.is_empty()),
                ("bootstrapped", asked.options.bootstrap > 0 && assessment.bootstrap.is_none()),
                ("repeated with uncertain inputs", asked.inputs.any() && assessment.propagation.is_none()),
            ];
            for (what, _) in without.iter().filter(|(_, missing)| *missing) {
                out.notes().warning(format!("{id}: not {what}, too few fits near its minimum converged"));
            }
            let text = summary_text(&id, &assessment.profile, assessment.propagation.as_ref(), ToString::to_string);
            if !text.is_empty() {
                out.summary(text);
            }
            let subject = (chain, solution, &assessment, total_kg);
            records.push((id, record(subject, &observed, &sensors, &events.channel)));
        }
    }
    Ok(records)
}

/// Warnings on what the record does not decide.
fn warn_of_open_parameters(chain: &FittedChain, solutions: &[ChainSolution], out: &mut Output) {
    let duals = solutions.iter().filter(|s| matches!(s.dual, Some(ChainDual::Solution(_)))).count() / 2;
    let sets = solutions.len() - duals;
    let mut warn = |text: String| out.notes().warning(format!("chain {}: {text}", chain.name));
    if sets > 1 {
        warn(format!(
            "{sets} parameter sets fit within 1 % as well as the best; the record does not determine the parameters"
        ));
    }
    let Some(best) = solutions.first() else { return };
    if let Some(text) = open(best) {
        warn(text);
    }
    if !best.on_bound.is_empty() {
        warn(format!("on a bound of the search, not determined by the record: {}", best.on_bound.join(", ")));
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
    let mut places = settings.places.clone();
    if !places.iter().any(|(place, _)| *place == SensorPlace::Compartment) {
        places.insert(0, (SensorPlace::Compartment, events.channel.clone()));
    }
    let masses = chain.masses.len();
    let mass_kg = settings.mass_kg.or(input.test()?.mass_kg).unwrap_or(1.0);
    let (mut waves, mut sensors) = (Vec::new(), Vec::new());
    for (place, channel) in places {
        let Some(mass) = place.mass(masses) else {
            out.notes().info(format!(
                "chain {}: sensor {channel} is on the {place}, which this chain does not have: not fitted",
                chain.name
            ));
            continue;
        };
        let record: Sampled = motion(input, &channel, quantity, mass_kg)?;
        let (measured, known) = measurement(input, events, &channel, &record)?;
        let end_s = record.end_s() - events.time_zero_s;
        let to_s = settings.solve.fit_to_s.or(events.time_of_dynamic_crush_s).unwrap_or(end_s);
        let window = (settings.solve.fit_from_s, to_s);
        let what = (Some(mass), quantity);
        let mut wave =
            ObservedWave::new(&record, what, events.time_zero_s, measured, window, settings.solve.fit_samples)
                .refuse_with_hint("see --fit-from and --fit-to")?;
        if !known {
            wave.resolution *= UNKNOWN_FILTER_M / RESOLUTION_M;
        }
        waves.push(wave);
        sensors.push(Sensor { channel, place, mass, known });
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
    let weakest = linearised.weakest_direction.as_ref().filter(|_| linearised.rank < linearised.order.len());
    let weakest = weakest.map_or_else(String::new, |words| format!("; {words}"));
    Some(format!(
        "the record determines {} directions of {} free numbers; without an interval: {}{weakest}",
        linearised.rank,
        linearised.order.len(),
        open.join(", ")
    ))
}

fn record(
    (chain, solution, assessment, total_kg): (&FittedChain, &ChainSolution, &ChainAssessment, Option<f64>),
    observed: &Observation,
    sensors: &[Sensor],
    pulse: &str,
) -> CandidateV1 {
    let parameters = solution.chain.parameters();
    let (from_s, to_s) = (observed.waves[0].time_s(0), observed.waves[0].time_s(observed.waves[0].samples.len() - 1));
    let quantity = observed.waves[0].quantity;
    let given: Vec<&str> = parameters.keys().filter(|name| !solution.free.contains(name)).map(String::as_str).collect();
    let mut notes = vec![
        format!("masses from the barrier on: {}", chain.masses.join(", ")),
        format!("stated in the pipeline; fitted: {}", solution.free.join(", ")),
    ];
    if !given.is_empty() {
        notes.push(format!("given: {}", given.join(", ")));
    }
    notes.push(format!("fitted to {quantity} from {:.2} ms to {:.2} ms after time zero", 1e3 * from_s, 1e3 * to_s));
    if sensors.len() > 1 {
        let errors = sensors.iter().zip(&solution.rmse);
        let errors = errors.map(|(s, rmse)| (*rmse, quantity, s.channel.as_str(), s.place.to_string()));
        notes.push(note_of_errors(&errors_in_words(errors), None));
    }
    if !sensors.iter().all(|sensor| sensor.known) {
        notes.push("the filter of a sensor is not known: fitted as if its record had none".to_owned());
    }
    if !solution.on_bound.is_empty() {
        notes.push(format!("on a bound, not determined by the record: {}", solution.on_bound.join(", ")));
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
        fit: Some(FitV1 {
            channel: pulse.to_owned(),
            quantity: quantity.name().to_owned(),
            from_s,
            to_s,
            samples: solution.samples as u64,
            rmse: solution.rmse[0],
            iterations: solution.iterations,
            evaluations: solution.evaluations,
            stop_reason: solution.stop_reason.name().to_owned(),
            active_bounds: solution.on_bound.clone(),
            sensors: sensors
                .iter()
                .zip(solution.rmse.iter().zip(&solution.noise))
                .map(|(sensor, (rmse, noise))| SensorFitV1 {
                    channel: sensor.channel.clone(),
                    mass: sensor.mass as u32 + 1,
                    quantity: quantity.name().to_owned(),
                    rmse: *rmse,
                    noise: *noise,
                })
                .collect(),
        }),
        uncertainty: Some(uncertainty(solution, assessment, sensors)),
        notes,
    }
}

fn uncertainty(solution: &ChainSolution, assessment: &ChainAssessment, sensors: &[Sensor]) -> UncertaintyV1 {
    let method = linearised(sensors.iter().all(|sensor| sensor.known));
    let Some(known) = &solution.linearised else {
        // Everything that was free stays open.
        let open: BTreeMap<String, Option<f64>> = solution.free.iter().map(|name| (name.clone(), None)).collect();
        return UncertaintyV1 { method, interval_low: open.clone(), interval_high: open, ..UncertaintyV1::default() };
    };
    let LinearisedUncertainty { standard_deviation, order, correlation, weakest_direction, .. } = known.clone();
    let side = |subject: fn(&Ends) -> Option<f64>| {
        known.interval.iter().map(|(name, ends)| (name.clone(), subject(ends))).collect()
    };
    UncertaintyV1 {
        method,
        standard_deviation,
        condition: known.condition,
        interval_low: side(|ends| ends.0),
        interval_high: side(|ends| ends.1),
        order,
        correlation,
        rank: Some(known.rank as u32),
        weakest_direction,
        effective_samples: Some(known.effective_samples),
        profile: assessment.profile.iter().map(profile_record).collect(),
        bootstrap: assessment.bootstrap.as_ref().map(bootstrap_record),
        propagation: assessment.propagation.as_ref().map(|p| propagation_record(p, "fit")),
    }
}
