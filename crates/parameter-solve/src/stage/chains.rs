//! What a person states: chains of the pipeline file, `[parameter-solve.chain.<name>]`, and own models. The table, and
//! the fits of both.

use crumple_lumped::{Chain, ModelKind, OwnModel, ParameterKind};
use crumple_lumped_fit::{
    Candidate, Observation, ObservedWave, SensorPlace, SolveError, Stated, StatedChain, StatedElement, StatedMass,
    fit_own_model,
};
use crumple_numerics::estimation::work::determined;
use crumple_signal::{About, Note, Weight, remarks};
use crumple_stage::records::EventsV1;
use crumple_stage::{
    Inputs, NumberOfTable, Output, RefuseExt, Refused, TakenNumbers, option, read_chain, total_mass_remark,
};
use serde::Serialize;
use toml::Value;

use crate::stage::AtSearchLimit;
use crate::stage::assess::{assess_each, assess_fit};
use crate::stage::inputs::{see, sensor_wave, stated_places};
use crate::stage::own_models::StatedLaw;
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

/// What is fitted: a chain, or an own model.
struct StatedModel<'a> {
    name: &'a str,
    /// `chain/<name>`, `own/<name>`.
    id: String,
    masses: Vec<String>,
    /// Whether the last mass is an occupant, behind the compartment: whether a chain calls it so.
    has_occupant: bool,
    /// Where it is stated.
    place: String,
    law: Law<'a>,
}

/// Its law.
enum Law<'a> {
    Chain(&'a FittedChain),
    Own(&'a StatedLaw),
}

impl<'a> StatedModel<'a> {
    fn of_chain(chain: &'a FittedChain) -> Self {
        let masses = chain.masses.clone();
        Self {
            name: &chain.name,
            id: format!("{}/{}", ModelKind::Chain, chain.name),
            has_occupant: masses.len() > 1 && masses.last().is_some_and(|name| name == "occupant"),
            masses,
            place: format!("[parameter-solve.chain.{}] of the pipeline file", chain.name),
            law: Law::Chain(chain),
        }
    }

    fn of_law(stated: &'a StatedLaw) -> Self {
        Self {
            name: &stated.name,
            id: format!("{}/{}", ModelKind::Own, stated.name),
            has_occupant: false,
            masses: stated.law.mass_names(),
            place: "docs/how-to/own-model.md".to_owned(),
            law: Law::Own(stated),
        }
    }

    fn fit(&self, total_kg: Option<f64>, observed: &Observation, starts: usize) -> Result<Vec<Candidate>, SolveError> {
        match self.law {
            Law::Chain(chain) => chain.stated(total_kg).fit(observed, starts),
            Law::Own(stated) => fit_own_model(&stated.law, total_kg, observed, starts),
        }
    }

    /// Where its law stands, in words.
    fn stated_where(&self) -> &'static str {
        match self.law {
            Law::Chain(_) => "stated in the pipeline",
            Law::Own(_) => "stated in a model file",
        }
    }

    /// Why no start of an own model moved.
    fn fault(&self, total_kg: Option<f64>, speed_m_per_s: f64) -> Option<String> {
        let Law::Own(stated) = self.law else { return None };
        let start = OwnModel::at_start(stated.law.clone(), total_kg.unwrap_or(0.0)).ok()?;
        Some(start.fault_at(speed_m_per_s).unwrap_or_else(|| "no start has a motion that can be followed".to_owned()))
    }
}

/// `chain/light` in a sentence: `chain light`.
pub(super) fn called(id: &str) -> String {
    id.strip_prefix("chain/").map_or_else(|| id.to_owned(), |name| format!("chain {name}"))
}

/// A sensor on a mass of the chain.
struct Sensor {
    channel: String,
    place: SensorPlace,
}

/// Candidates of every chain and own model, assessed.
pub fn fit_stated(
    settings: &StageSettings,
    input: &Inputs,
    events: Option<&EventsV1>,
    out: &mut Output,
) -> anyhow::Result<Vec<Candidate>> {
    let stated = settings.chain.iter().map(StatedModel::of_chain).chain(settings.own.iter().map(StatedModel::of_law));
    let stated: Vec<StatedModel<'_>> = stated.collect();
    if stated.is_empty() {
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
    for chain in &stated {
        let (observed, sensors) = waves(chain, settings, input, events, speed, out)?;
        let hint = format!("see {}", chain.place);
        let starts = settings.solve.fit_starts;
        let limited = observed.clone().limited(settings.solve.searches());
        let fitted = determined(|| chain.fit(total_kg, &limited, starts)).unwrap_or_else(|reason| {
            out.notes().push(ChainNotFitted { chain: chain.id.clone(), reason: reason.to_string() });
            Ok(Vec::new())
        });
        let fitted = match (fitted, chain.fault(total_kg, speed)) {
            (Err(SolveError::NoFit { .. }), Some(reason)) => {
                out.notes().push(ChainNotFitted { chain: chain.id.clone(), reason });
                Ok(Vec::new())
            }
            (fitted, _) => fitted,
        };
        let mut fitted = fitted.refuse_with_hint(hint)?;
        fitted.iter_mut().for_each(|fitted| fitted.stated = Some(chain.name.to_owned()));
        let mass_kg = |candidate: &Candidate| total_kg.unwrap_or_else(|| candidate.model.masses_kg().iter().sum());
        let asked = &settings.assessment;
        assess_each(&mut fitted, asked, out, |candidate| assess_fit(candidate, asked, Some(mass_kg(candidate))));
        warn_of_what_is_undecided(chain, &fitted, out);
        if let Some((test_kg, best)) = total_kg.zip(fitted.first())
            && total_mass_remark(&best.model.masses_kg(), test_kg).is_some()
        {
            let (chain, chain_kg) = (chain.id.clone(), best.model.masses_kg().iter().sum::<f64>());
            let difference_percent = 100.0 * (chain_kg / test_kg - 1.0);
            out.notes().push(ChainOfAnotherMass { chain, chain_kg, test_kg, difference_percent });
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
        out.notes().push(NotComputed { id: candidate.id(), what: (*what).to_owned() });
    }
}

fn name_sensors(candidate: &mut Candidate, sensors: &[Sensor]) {
    for (of_fit, sensor) in candidate.fit.iter_mut().flat_map(|fit| &mut fit.sensors).zip(sensors) {
        of_fit.channel.clone_from(&sensor.channel);
    }
}

/// Warnings on what the record does not decide.
fn warn_of_what_is_undecided(chain: &StatedModel<'_>, fitted: &[Candidate], out: &mut Output) {
    let duals = fitted.iter().filter(|candidate| candidate.equivalent_to.is_some()).count() / 2;
    let (sets, notes) = (fitted.len() - duals, out.notes());
    let chain = || chain.id.clone();
    if sets > 1 {
        notes.push(SeveralSetsOfChain { chain: chain(), sets });
    }
    let Some(best) = fitted.first() else { return };
    if let Some(Unidentified { directions, free, names, weakest }) = Unidentified::of(best) {
        notes.push(ChainNotIdentified { chain: chain(), directions, free, names, weakest });
    }
    if let Some(fit) = best.fit.as_ref().filter(|fit| !fit.active_bounds.is_empty()) {
        notes.push(AtSearchLimit { id: chain(), names: fit.active_bounds.join(", ") });
    }
    if let Some((dual, springs)) = dual_of(best) {
        notes.push(DualOfChain { chain: chain(), dual, springs });
    }
    if best.division_undecided {
        notes.push(DivisionUndecided { chain: chain() });
    }
}

/// The note where masses were fitted to one sensor on the last mass.
const DIVISION: &str = "masses were fitted to a sensor on the last mass alone: with any noise the record does not \
    determine how they divide; give a mass, or name a sensor on another mass with --sensors";

/// The dual of a chain: the id of its candidate, or its springs and dampers where it is left out.
fn dual_of(candidate: &Candidate) -> Option<(Option<String>, Vec<String>)> {
    if let Some(id) = candidate.equivalent_id() {
        return Some((Some(id), Vec::new()));
    }
    let other = candidate.excluded_dual.as_ref()?.parameters();
    let springs = other.iter().filter(|(name, _)| Chain::parameter_kind(name) != Some(ParameterKind::Mass));
    Some((None, springs.map(|(name, value)| format!("{name} {value:.1}")).collect()))
}

/// What the dual is, in words.
fn dual_in_words(id: Option<&str>, springs: &[String]) -> String {
    let same = "the same masses and the same motion of the last one";
    match id {
        Some(id) => {
            format!("its dual {id} has {same}: a sensor on the mass next to the barrier decides between them")
        }
        None => format!(
            "its dual ({}) has {same} and is left out by what was given or by a bound, not by the record",
            springs.join(", ")
        ),
    }
}

/// The waves to fit, and the sensors they are of.
fn waves(
    chain: &StatedModel<'_>,
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
        let mass = if chain.has_occupant { place.mass_before_occupant(masses) } else { place.mass(masses) };
        let Some(mass) = mass else {
            let (chain, channel) = (chain.id.clone(), sensor.channel.clone());
            out.notes().push(SensorOffTheChain { chain, channel, place: place.to_string() });
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

/// What the record does not identify.
struct Unidentified {
    /// Directions that the record determines, of so many free numbers.
    directions: usize,
    free: usize,
    /// Those without an interval.
    names: Vec<String>,
    /// The direction determined least, in words, where one is not determined.
    weakest: Option<String>,
}

impl Unidentified {
    fn of(candidate: &Candidate) -> Option<Self> {
        let assessment = &candidate.assessed.as_ref()?.assessment;
        let without = assessment.interval.iter().filter(|(_, ends)| **ends == (None, None));
        let names: Vec<String> = without.map(|(name, _)| name.clone()).collect();
        let (directions, free) = (assessment.rank, assessment.parameters.len());
        let weakest = assessment.weakest_direction.clone().filter(|_| directions < free);
        (!names.is_empty()).then_some(Self { directions, free, names, weakest })
    }

    fn in_words(&self) -> String {
        let Self { directions, free, names, weakest } = self;
        let weakest = weakest.as_ref().map_or_else(String::new, |words| format!("; {words}"));
        let names = names.join(", ");
        format!(
            "the record determines {directions} directions of {free} free numbers; without an interval: \
             {names}{weakest}"
        )
    }
}

/// What stands in the record of a fitted chain, in words.
fn notes(
    chain: &StatedModel<'_>,
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
        format!("{}; fitted: {}", chain.stated_where(), free.join(", ")),
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
    notes.extend(Unidentified::of(candidate).map(|left| left.in_words()));
    notes.extend(dual_of(candidate).map(|(id, springs)| dual_in_words(id.as_deref(), &springs)));
    notes.extend(candidate.division_undecided.then(|| DIVISION.to_owned()));
    notes.extend(total_kg.and_then(|kg| total_mass_remark(&candidate.model.masses_kg(), kg)));
    notes
}

remarks! {
    /// Remarks of stated chains.
    pub REMARKS;

    /// The fit of a stated chain reached its limit of work, or its computation failed.
    CR543 ChainNotFitted { chain: String, reason: String }
    bears on (About::Model(chain.clone()), Weight::Marked)
    decided "A fit may take the work of 250 million samples, some 2.5 s of one processor, and searches with more \
             evaluations in proportion. The fits of an ordinary record take a hundredth of it."
    means "The chain has no candidate. Other chains and models are not touched by it."
    remedy "give some of its numbers, or bound those that are free"
    says format!("{}: {reason}", called(chain));

    /// The masses of a chain do not add up to the mass of the test.
    CR544 ChainOfAnotherMass { chain: String, chain_kg: f64, test_kg: f64, difference_percent: f64 }
    bears on (About::Mass, Weight::Marked)
    decided "The sum of the masses is compared with the mass of the test; 1 % is left."
    means "Stiffness, forces and energies go with the mass. They hold for the masses of the chain, not for the test."
    remedy "make one of the masses \"rest\" in the pipeline file, or correct the mass of the test"
    says {
        let text = total_mass_remark(&[*chain_kg], *test_kg).unwrap_or_default();
        format!("{}: {text}", called(chain))
    };

    /// Profile, bootstrap or repetitions of a chain were asked for and gave no result.
    CR545 NotComputed { id: String, what: String }
    bears on (About::Model(id.clone()), Weight::Slight)
    decided "Each needs fits near the minimum that converge; too few did."
    means "The linearised intervals are all there is. They may be too narrow."
    remedy "give some of the numbers of the chain, or name further sensors"
    says format!("{id}: not {what}, too few fits near its minimum converged");

    /// Several sets of parameters of a chain follow the record as well as the best one.
    CR546 SeveralSetsOfChain { chain: String, sets: usize }
    bears on (About::Model(chain.clone()), Weight::Marked)
    decided "Sets count whose errors are within 1 % of the least; a dual pair counts once."
    means "The motion of the chain holds where sensors are. Any of the sets may be the vehicle."
    remedy "give some of its numbers, or name sensors on further masses"
    says format!(
        "{}: the parameters are not identifiable from this record: {sets} sets fit within 1 % of the best",
        called(chain)
    );

    /// Free numbers of a chain have no interval: the record does not identify them.
    CR547 ChainNotIdentified {
        chain: String, directions: usize, free: usize, names: Vec<String>, weakest: Option<String>
    }
    bears on (About::Model(chain.clone()), Weight::Marked)
    decided "The number of directions is the rank of the sensitivities at the minimum. A number is named where its 95 \
             % interval is open on both sides."
    means "Other values of these numbers follow the record as well. Quote no value for them."
    remedy "give them in the pipeline file, or name sensors on further masses"
    says {
        let (directions, free) = (*directions, *free);
        let left = Unidentified { directions, free, names: names.clone(), weakest: weakest.clone() };
        format!("{}: {}", called(chain), left.in_words())
    };

    /// A chain of two masses has a dual with the same motion of the last mass.
    CR548 DualOfChain { chain: String, dual: Option<String>, springs: Vec<String> }
    bears on (About::Model(chain.clone()), Weight::Marked)
    decided "Two masses with constant springs and dampers have two sets of them with one motion of the last mass \
             (docs/methods/parameter-solve.md)."
    means "Motion and crush hold. The record does not tell which springs and dampers the vehicle has."
    remedy "name a sensor on the mass next to the barrier: sensors"
    says format!("{}: {}", called(chain), dual_in_words(dual.as_deref(), springs));

    /// Masses of a chain were fitted, and one sensor does not show how they divide.
    CR549 DivisionUndecided { chain: String }
    bears on (About::Model(chain.clone()), Weight::Marked)
    decided "Masses are free, and all sensors are on the last mass."
    means "Any division of the mass follows the record: quote none of the masses. The chain is not recommended."
    remedy "give a mass, or name a sensor on another mass: sensors"
    says format!("{}: {DIVISION}", called(chain));

    /// A sensor is on a part that the chain does not have.
    CR550 SensorOffTheChain { chain: String, channel: String, place: String }
    bears on (About::Model(String::new()), Weight::None)
    decided "The place of the sensor is looked for among the masses of the chain."
    means "The chain is fitted without this sensor."
    remedy "nothing, or state the mass in the chain"
    says format!("{}: sensor {channel} is on the {place}, which it does not have: not fitted", called(chain));
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
