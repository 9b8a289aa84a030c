//! Fits the chains that a pipeline file states.

use crumple_parameter_solve::{
    ChainKnowledge, ChainSolution, FitQuantity, Observed, Place, RESOLUTION_M, SeenWave, fit_chain,
};
use crumple_signal::Sampled;
use crumple_stage::records::{CandidateV1, EventsV1, FitV1, SensorFitV1, UncertaintyV1};
use crumple_stage::{Inputs, Output, RefuseExt, Refused};

use crate::chain_table::FittedChain;
use crate::judging::UNKNOWN_FILTER_M;
use crate::measured::measurement;
use crate::stage::motion;
use crate::stage_settings::StageSettings;
use crate::verdict::Ends;

/// A sensor on a mass of the chain.
struct Sensor {
    channel: String,
    place: Place,
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
    let flags = settings.judging.flags();
    let mut found = Vec::new();
    for chain in &settings.chain {
        if !flags.is_empty() {
            out.notes().warning(format!(
                "{} without effect on chain {}: its intervals are those of the linearisation",
                flags.join(", "),
                chain.name
            ));
        }
        let (observed, sensors) = waves(chain, settings, input, &events, speed, out)?;
        let known = sensors.iter().all(|sensor| sensor.known);
        let solutions = fit_chain(&chain.stated(total_kg), &observed, known, settings.solve.fit_starts)
            .refuse_with_hint(format!("see [parameter-solve.chain.{}] of the pipeline file", chain.name))?;
        if solutions.len() > 1 {
            out.notes().warning(format!(
                "chain {}: {} parameter sets fit within 1 % as well as the best; the record does not determine the parameters",
                chain.name,
                solutions.len()
            ));
        }
        if let Some(text) = solutions.first().and_then(open) {
            out.notes().warning(format!("chain {}: {text}", chain.name));
        }
        for (k, solution) in solutions.iter().enumerate() {
            found.push((chain.id(k + 1), record(chain, solution, &observed, &sensors, &events.channel)));
        }
    }
    Ok(found)
}

/// The waves to fit, and the sensors they are of.
fn waves(
    chain: &FittedChain,
    settings: &StageSettings,
    input: &Inputs,
    events: &EventsV1,
    impact_speed_m_per_s: f64,
    out: &mut Output,
) -> anyhow::Result<(Observed, Vec<Sensor>)> {
    let quantity = settings.solve.quantity;
    let mut places = settings.places.clone();
    if !places.iter().any(|(place, _)| *place == Place::Compartment) {
        places.insert(0, (Place::Compartment, events.channel.clone()));
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
        let mut wave = SeenWave::new(&record, what, events.time_zero_s, measured, window, settings.solve.fit_samples)
            .refuse_with_hint("see --fit-from and --fit-to")?;
        if !known {
            wave.resolution *= UNKNOWN_FILTER_M / RESOLUTION_M;
        }
        waves.push(wave);
        sensors.push(Sensor { channel, place, mass, known });
    }
    Ok((Observed { impact_speed_m_per_s, waves }, sensors))
}

/// What the record leaves open, in words.
fn open(solution: &ChainSolution) -> Option<String> {
    let knowledge = solution.knowledge.as_ref()?;
    let open: Vec<&str> =
        knowledge.interval.iter().filter(|(_, ends)| **ends == (None, None)).map(|(name, _)| name.as_str()).collect();
    if open.is_empty() {
        return None;
    }
    let weakest = knowledge.weakest_direction.as_ref().filter(|_| knowledge.rank < knowledge.order.len());
    let weakest = weakest.map_or_else(String::new, |words| format!("; {words}"));
    Some(format!(
        "the record determines {} directions of {} free numbers; without an interval: {}{weakest}",
        knowledge.rank,
        knowledge.interval.len(),
        open.join(", ")
    ))
}

fn record(
    chain: &FittedChain,
    solution: &ChainSolution,
    observed: &Observed,
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
        let errors: Vec<String> = sensors
            .iter()
            .zip(&solution.rmse)
            .map(|(sensor, rmse)| {
                let (value, unit) = match quantity {
                    FitQuantity::Displacement => (1e3 * rmse, "mm"),
                    other => (*rmse, other.unit()),
                };
                format!("{value:.4} {unit} at {} ({})", sensor.channel, sensor.place)
            })
            .collect();
        notes.push(format!(
            "root mean square errors {}; residuals weighted by the noise level of each sensor",
            errors.join(", ")
        ));
    }
    if !sensors.iter().all(|sensor| sensor.known) {
        notes.push("the filter of a sensor is not known: fitted as if its record had none".to_owned());
    }
    if !solution.on_bound.is_empty() {
        notes.push(format!("on a bound, not determined by the record: {}", solution.on_bound.join(", ")));
    }
    notes.extend(open(solution));
    CandidateV1 {
        model: "chain".to_owned(),
        method: chain.name.clone(),
        parameters,
        physical: solution.chain.is_passive(),
        equivalent_to: None,
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
        uncertainty: solution.knowledge.as_ref().map(|known| uncertainty(known, sensors)),
        notes,
    }
}

fn uncertainty(known: &ChainKnowledge, sensors: &[Sensor]) -> UncertaintyV1 {
    let side =
        |of: fn(&Ends) -> Option<f64>| known.interval.iter().map(|(name, ends)| (name.clone(), of(ends))).collect();
    UncertaintyV1 {
        method: if sensors.iter().all(|sensor| sensor.known) {
            "linearised about the minimum seen through the record's filter, autocorrelated residuals".to_owned()
        } else {
            "linearised about the minimum, autocorrelated residuals".to_owned()
        },
        standard_deviation: known.standard_deviation.clone(),
        condition: known.condition,
        interval_low: side(|ends| ends.0),
        interval_high: side(|ends| ends.1),
        order: known.order.clone(),
        correlation: known.correlation.clone(),
        rank: Some(known.rank as u32),
        weakest_direction: known.weakest_direction.clone(),
        effective_samples: Some(known.effective_samples),
        ..UncertaintyV1::default()
    }
}
