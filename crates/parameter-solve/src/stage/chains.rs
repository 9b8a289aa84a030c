//! The chains that a pipeline file states, `[parameter-solve.chain.<name>]`: the table, and the fits.

use crumple_lumped::{Chain, ParameterKind};
use crumple_lumped_fit::{
    Candidate, Observation, ObservedWave, SensorPlace, Stated, StatedChain, StatedElement, StatedMass,
};
use crumple_numerics::estimation::work::determined;
use crumple_signal::{About, Note, Weight};
use crumple_stage::records::EventsV1;
use crumple_stage::{
    Inputs, NumberOfTable, Output, RefuseExt, Refused, TakenNumbers, option, read_chain, total_mass_remark,
};
use serde::Serialize;
use toml::Value;

use crate::stage::assess::{assess_each, assess_fit};
use crate::stage::inputs::{see, sensor_wave, stated_places};
use crate::stage::settings::StageSettings;

// The table: a chain of masses of which some numbers are to be found.

/// A chain to be fitted, in SI.
#[derive(Debug, Clone, Serialize)]
pub struct FittedChain {
    pub name: String,
    /// Names of the masses, from the barrier on.
    pub masses: Vec<String>,
    pub elements: Vec<StatedElement>,
}

impl FittedChain {
    /// Reads the table; whether its numbers make sense together is seen when the total mass is known.
    pub fn read(name: &str, table: &Value) -> anyhow::Result<Self> {
        let (_, masses) = read_chain("parameter-solve", name, table, &[], TakenNumbers::GivenOrFree)?;
        let law = |points: Vec<(f64, NumberOfTable)>| {
            points.into_iter().filter_map(|(knot, value)| Some((knot, stated(value)?))).collect()
        };
        let (masses, elements) = masses
            .into_iter()
            .map(|mass| {
                let element = StatedElement {
                    mass_kg: stated(mass.mass_kg).map_or(StatedMass::Rest, StatedMass::Own),
                    stiffness: law(mass.stiffness_n_per_m),
                    damping: law(mass.damping_n_s_per_m),
                };
                (mass.name, element)
            })
            .unzip();
        Ok(Self { name: name.to_owned(), masses, elements })
    }

    /// Whether its last mass is an occupant, behind the compartment: whether it is called so.
    pub fn has_occupant(&self) -> bool {
        self.masses.len() > 1 && self.masses.last().is_some_and(|name| name == "occupant")
    }

    /// What is fitted.
    pub fn stated(&self, total_mass_kg: Option<f64>) -> StatedChain {
        StatedChain { elements: self.elements.clone(), total_mass_kg }
    }
}

/// A number of the table for the fit; `None` for the mass that is the rest.
fn stated(number: NumberOfTable) -> Option<Stated> {
    match number {
        NumberOfTable::Given(value) => Some(Stated::Fixed(value)),
        NumberOfTable::Free { start, lower, upper } => Some(Stated::Free { start, lower, upper }),
        NumberOfTable::Rest => None,
    }
}

// The fits.

/// A sensor on a mass of the chain.
struct Sensor {
    channel: String,
    place: SensorPlace,
}

/// Candidates of every chain, assessed.
pub fn fit_chains(
    settings: &StageSettings,
    input: &Inputs,
    events: Option<&EventsV1>,
    out: &mut Output,
) -> anyhow::Result<Vec<Candidate>> {
    if settings.chain.is_empty() {
        return Ok(Vec::new());
    }
    let events = events.ok_or_else(|| input.missing("/events"))?;
    let test = input.test()?;
    let total_kg = settings.mass_kg.or(test.mass_kg);
    let speed = events.impact_speed_m_per_s.or(test.impact_speed_m_per_s).ok_or_else(|| {
        Refused::new("neither the events nor the test have an impact speed").hint(option(
            "ingest",
            "impact-speed",
            "35km/h",
        ))
    })?;
    settings.assessment.check(total_kg, speed)?;
    let mut candidates = Vec::new();
    for chain in &settings.chain {
        let (observed, sensors) = waves(chain, settings, input, events, speed, out)?;
        let hint = format!("see [parameter-solve.chain.{}] of the pipeline file", chain.name);
        let (stated, starts) = (chain.stated(total_kg), settings.solve.fit_starts);
        let limited = observed.clone().limited(settings.solve.searches());
        let fitted = determined(|| stated.fit(&limited, starts)).unwrap_or_else(|reason| {
            let about = About::Model(format!("chain/{}", chain.name));
            out.notes().concern(about, Weight::Marked, format!("chain {}: {reason}", chain.name));
            Ok(Vec::new())
        });
        let mut fitted = fitted.refuse_with_hint(hint)?;
        fitted.iter_mut().for_each(|fitted| fitted.stated = Some(chain.name.clone()));
        let mass_kg = |candidate: &Candidate| total_kg.unwrap_or_else(|| candidate.model.masses_kg().iter().sum());
        let asked = &settings.assessment;
        assess_each(&mut fitted, asked, out, |candidate| assess_fit(candidate, asked, Some(mass_kg(candidate))));
        warn_of_what_is_undecided(chain, &fitted, out);
        if let Some(text) = total_kg.zip(fitted.first()).and_then(|(kg, c)| total_mass_remark(&c.model.masses_kg(), kg))
        {
            let text = format!("chain {}: {text}", chain.name);
            out.notes().concern(About::Mass, Weight::Marked, text);
        }
        for candidate in &mut fitted {
            note_what_is_missing(candidate, settings, out);
            name_sensors(candidate, &sensors);
            candidate.notes =
                notes(chain, candidate, &observed, &sensors, total_kg).into_iter().map(Note::info).collect();
        }
        candidates.extend(fitted);
    }
    Ok(candidates)
}

/// Says what was asked for beyond the covariance and could not be computed.
fn note_what_is_missing(candidate: &Candidate, settings: &StageSettings, out: &mut Output) {
    let asked = &settings.assessment;
    let inner = candidate.assessed.as_ref().map(|assessed| &assessed.assessment);
    let repeated = candidate.assessed.as_ref().is_some_and(|assessed| assessed.propagation.is_some());
    let without = [
        ("profiled", asked.profile && inner.is_none_or(|inner| inner.profile.is_empty())),
        ("bootstrapped", asked.bootstrap > 0 && inner.is_none_or(|inner| inner.bootstrap.is_none())),
        ("repeated with uncertain inputs", asked.inputs.any() && !repeated),
    ];
    for (what, _) in without.iter().filter(|(_, missing)| *missing) {
        let text = format!("{}: not {what}, too few fits near its minimum converged", candidate.id());
        out.notes().concern(About::Model(candidate.id()), Weight::Slight, text);
    }
}

fn name_sensors(candidate: &mut Candidate, sensors: &[Sensor]) {
    for (of_fit, sensor) in candidate.fit.iter_mut().flat_map(|fit| &mut fit.sensors).zip(sensors) {
        of_fit.channel.clone_from(&sensor.channel);
    }
}

/// Warnings on what the record does not decide.
fn warn_of_what_is_undecided(chain: &FittedChain, fitted: &[Candidate], out: &mut Output) {
    let duals = fitted.iter().filter(|candidate| candidate.equivalent_to.is_some()).count() / 2;
    let sets = fitted.len() - duals;
    let about = || About::Model(format!("chain/{}", chain.name));
    let mut warn = |text: String| {
        out.notes().concern(about(), Weight::Marked, format!("chain {}: {text}", chain.name));
    };
    if sets > 1 {
        warn(format!("the parameters are not identifiable from this record: {sets} sets fit within 1 % of the best"));
    }
    let Some(best) = fitted.first() else { return };
    [unidentified(best), on_bound(best), dual(best)].into_iter().flatten().for_each(&mut warn);
    if best.division_undecided {
        warn(DIVISION.to_owned());
    }
}

fn on_bound(candidate: &Candidate) -> Option<String> {
    let bounds = &candidate.fit.as_ref()?.active_bounds;
    let text = || format!("parameters at a search limit, not identifiable from this record: {}", bounds.join(", "));
    (!bounds.is_empty()).then(text)
}

/// The note where masses were fitted to one sensor on the last mass.
const DIVISION: &str = "masses were fitted to a sensor on the last mass alone: with any noise the record does not \
    determine how they divide; give a mass, or name a sensor on another mass with --sensors";

/// What the dual is, in words.
fn dual(candidate: &Candidate) -> Option<String> {
    let same = "the same masses and the same motion of the last one";
    if let Some(id) = candidate.equivalent_id() {
        return Some(format!(
            "its dual {id} has {same}: a sensor on the mass next to the barrier decides between them"
        ));
    }
    let other = candidate.excluded_dual.as_ref()?.parameters();
    let springs = other.iter().filter(|(name, _)| Chain::parameter_kind(name) != Some(ParameterKind::Mass));
    let springs: Vec<String> = springs.map(|(name, value)| format!("{name} {value:.1}")).collect();
    let springs = springs.join(", ");
    Some(format!("its dual ({springs}) has {same} and is left out by what was given or by a bound, not by the record"))
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
    for sensor in stated_places(settings, &events.channel) {
        let place = sensor.place;
        // A chain is fitted to motions; how far it misses the wall's force is scored.
        if place == SensorPlace::Wall {
            continue;
        }
        let mass = if chain.has_occupant() { place.mass_before_occupant(masses) } else { place.mass(masses) };
        let Some(mass) = mass else {
            out.notes().info(format!(
                "chain {}: sensor {} is on the {place}, which this chain does not have: not fitted",
                chain.name, sensor.channel
            ));
            continue;
        };
        let wave = sensor_wave(settings, input, events, sensor, mass_kg)?;
        let record = &wave.record;
        let end_s = record.end_s();
        let to_s = settings.solve.fit_to_s.or(events.time_of_dynamic_crush_s).unwrap_or(end_s);
        let window = (settings.solve.fit_from_s, to_s);
        let what = (Some(mass), quantity);
        let samples = settings.solve.fit_samples;
        let observed = ObservedWave::new(record, what, wave.measurement, window, samples)
            .refuse_with_hint(see(&["fit-from", "fit-to"]))?;
        waves.push(observed);
        sensors.push(Sensor { channel: wave.channel, place });
    }
    Ok((Observation { impact_speed_m_per_s, waves }, sensors))
}

/// What the record does not identify, in words.
fn unidentified(candidate: &Candidate) -> Option<String> {
    let assessment = &candidate.assessed.as_ref()?.assessment;
    let without = assessment.interval.iter().filter(|(_, ends)| **ends == (None, None));
    let without: Vec<&str> = without.map(|(name, _)| name.as_str()).collect();
    if without.is_empty() {
        return None;
    }
    let weakest = assessment.weakest_direction.as_ref().filter(|_| assessment.rank < assessment.parameters.len());
    let weakest = weakest.map_or_else(String::new, |words| format!("; {words}"));
    Some(format!(
        "the record determines {} directions of {} free numbers; without an interval: {}{weakest}",
        assessment.rank,
        assessment.parameters.len(),
        without.join(", ")
    ))
}

/// What stands in the record of a fitted chain, in words.
fn notes(
    chain: &FittedChain,
    candidate: &Candidate,
    observed: &Observation,
    sensors: &[Sensor],
    total_kg: Option<f64>,
) -> Vec<String> {
    let (Some(fit), Some(minimum)) = (&candidate.fit, &candidate.minimum) else { return Vec::new() };
    let (quantity, from_ms, to_ms) = (fit.quantity, 1e3 * fit.from_s, 1e3 * fit.to_s);
    let (parameters, free) = (candidate.model.parameters(), minimum.free_names());
    let given: Vec<&str> = parameters.keys().filter(|name| !free.contains(name)).map(String::as_str).collect();
    let mut notes = vec![
        format!("masses from the barrier on: {}", chain.masses.join(", ")),
        format!("stated in the pipeline; fitted: {}", free.join(", ")),
    ];
    if !given.is_empty() {
        notes.push(format!("given: {}", given.join(", ")));
    }
    notes.push(format!("fitted to {quantity} from {from_ms:.2} ms to {to_ms:.2} ms after time zero"));
    if sensors.len() > 1 {
        notes.push(fit.errors_remark(sensors.iter().map(|sensor| sensor.place)));
    }
    if !observed.is_as_measured() {
        notes.push("the filter of a sensor is not known: fitted as if its record had none".to_owned());
    }
    if !fit.active_bounds.is_empty() {
        notes.push(format!("parameters at a search limit, not identifiable: {}", fit.active_bounds.join(", ")));
    }
    notes.extend(unidentified(candidate));
    notes.extend(dual(candidate));
    notes.extend(candidate.division_undecided.then(|| DIVISION.to_owned()));
    notes.extend(total_kg.and_then(|kg| total_mass_remark(&candidate.model.masses_kg(), kg)));
    notes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_the_table_are_those_of_the_fit() {
        let text = r#"masses = [
            { name = "engine", mass = "250 kg", stiffness = [["0 mm", "free"], ["200 mm", "350 kN/m"]] },
            { mass = "rest", stiffness = { start = "1 MN/m", lower = "100 kN/m" }, damping = "free" },
        ]"#;
        let chain = FittedChain::read("car", &Value::Table(text.parse().unwrap())).unwrap();
        assert_eq!(chain.masses, ["engine", "m2"]);
        let free = Stated::Free { start: None, lower: None, upper: None };
        assert_eq!(chain.elements[0].mass_kg, StatedMass::Own(Stated::Fixed(250.0)));
        assert_eq!(chain.elements[0].stiffness, [(0.0, free), (0.2, Stated::Fixed(3.5e5))]);
        assert_eq!(chain.elements[0].damping, [(0.0, Stated::Fixed(0.0))]);
        assert_eq!(chain.elements[1].mass_kg, StatedMass::Rest);
        let bounded = Stated::Free { start: Some(1e6), lower: Some(1e5), upper: None };
        assert_eq!((chain.elements[1].stiffness[0].1, chain.elements[1].damping[0].1), (bounded, free));
    }
}
