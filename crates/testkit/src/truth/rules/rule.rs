//! A rule: what stands in the places of a sentence, and what must be true where it is said.

use serde_json::Value;

use crate::truth::known::Impact;
use crate::truth::run::Made;
use crate::truth::shown::{Shown, numbers};
use crate::truth::template::{Place, Said};

/// Where something is said.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Surface {
    /// The sentences on top of page and console.
    Top,
    /// Printed by the run.
    Console,
    /// The first screen of the page.
    Page,
    /// `summary.json`: warnings, notes, reasons.
    Summary,
}

impl Surface {
    /// In the table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Top => "verdict",
            Self::Console => "console",
            Self::Page => "first screen",
            Self::Summary => "summary",
        }
    }
}

/// A sentence in its run.
#[derive(Debug, Clone, Copy)]
pub struct Spot<'a> {
    /// The run.
    pub made: &'a Made,
    /// Where it is said.
    pub surface: Surface,
    /// What it is about there: the key of a card, the candidate of a picture, the stage of a note.
    pub key: &'a str,
}

/// What must be true where a sentence stands; else what it contradicts.
pub type Check = fn(&Said, &Spot<'_>) -> Result<(), String>;

/// What one template claims.
#[derive(Clone, Copy)]
pub struct Rule {
    /// `subject.name` of a text of `phrases`, or `note.name`, `page.name` of a sentence made elsewhere.
    pub template: &'static str,
    /// The sentence, where it is not one of `phrases`.
    pub text: &'static str,
    /// What stands in its places.
    pub places: &'static [(&'static str, Place)],
    /// What must be true.
    pub check: Check,
}

/// A rule of a text of `phrases`.
pub const fn rule(template: &'static str, places: &'static [(&'static str, Place)], check: Check) -> Rule {
    Rule { template, text: "", places, check }
}

/// A rule of a sentence that is made elsewhere.
pub const fn says(
    template: &'static str,
    text: &'static str,
    places: &'static [(&'static str, Place)],
    check: Check,
) -> Rule {
    Rule { template, text, places, check }
}

/// `Err(what)` unless it holds.
pub fn holds(condition: bool, what: impl FnOnce() -> String) -> Result<(), String> {
    if condition { Ok(()) } else { Err(what()) }
}

/// Its places say all that it claims: [`Place::At`] is compared wherever it stands.
pub fn places_alone(_: &Said, _: &Spot<'_>) -> Result<(), String> {
    Ok(())
}

/// Every number of the sentence stands in the summary or in a record of the artifacts, rounded as it is shown.
pub fn numbers_of_records(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    for filled in said.places.values().filter(|filled| filled.said.is_none()) {
        for shown in numbers(&filled.text) {
            holds(is_in_records(spot.made, &shown), || format!("{} stands in no record", filled.text))?;
        }
    }
    Ok(())
}

/// Counts of things are in records as lengths of lists, so small whole numbers are not looked for.
const COUNT: f64 = 20.0;

/// Factors of the units of columns, and of ends of intervals, which are said once.
const FACTORS: [f64; 7] = [1.0, 1e3, 3.6, 1.0 / 9.806_65, 1e-3, 100.0, 1.0 / std::f64::consts::TAU];

/// Numbers of definitions: the end of an event by 49 CFR 563 (20 ms of at most 0.8 km/h), a deceleration that counts as
/// contact (0.5 g for 3 ms), the ways of OLC (65 mm free, 235 mm in all), levels, the first 150 ms.
const OF_DEFINITIONS: [f64; 11] = [49.0, 563.0, 0.8, 20.0, 0.5, 3.0, 0.065, 0.235, 90.0, 95.0, 150.0];

/// Whether a number is one of a record, in its unit or in that of its column.
pub fn is_in_records(made: &Made, shown: &Shown) -> bool {
    let plain = shown.without_unit();
    let is_count = shown.factor == 1.0 && shown.decimals == 0 && shown.value.abs() <= COUNT;
    is_count
        || OF_DEFINITIONS.contains(&shown.value)
        || made.all_numbers.iter().any(|number| {
            let is_own = |factor: f64| plain.is_of(number * factor) || plain.is_of(-number * factor);
            if shown.factor == 1.0 { FACTORS.into_iter().any(is_own) } else { is_own(shown.factor) || is_own(1.0) }
        })
}

/// The number in a place is this one, rounded as it is shown.
pub fn shows(said: &Said, place: &str, si: Option<f64>, what: &str) -> Result<(), String> {
    let shown = said.number(place).ok_or_else(|| format!("{what}: {:?} is no number", said.text(place)))?;
    let si = si.ok_or_else(|| format!("{what}: there is no such number, and {} is said", said.text(place)))?;
    holds(shown.is_of(si) || shown.is_of(-si), || format!("{what} is {} in SI, and {} is said", si, said.text(place)))
}

/// The truth of the test that was made, of a sound record of a vehicle.
pub fn own_test(made: &Made) -> Option<Impact> {
    let known = &made.known;
    known.impact(known.speed_m_per_s?, known.mass_kg?).filter(|_| known.is_sound && made.is_of_a_vehicle())
}

/// Whether a record is a sound one of a vehicle as cars are: it rebounds at a third of its speed at most. A spring that
/// stays attached, and so pulls its mass back, may be asked about.
pub fn is_like_a_car(made: &Made) -> bool {
    own_test(made).is_some_and(|truth| truth.restitution <= 0.3)
}

/// What a candidate misses of its own test, by what the summary has of both: dynamic crush beyond 3.5 %, restitution
/// beyond 0.1, time beyond 5 %, or that it stops. The limits are those of what the project calls adequate.
pub fn misses_its_own_test(made: &Made, candidate: &Value) -> Option<String> {
    // One that is recommended although it misses more says so, and for what it is.
    let is_excused = made.summary["recommended"] == candidate["id"]
        && made.rated(candidate).is_some_and(|rated| {
            let missed = &rated.missed_events;
            !rated.adequate && !missed.is_empty() && missed.iter().all(|event| event != "dynamic_crush")
        });
    misses_its_own_crush(made, candidate).or_else(|| misses_time_or_rebound(made, candidate).filter(|_| !is_excused))
}

fn event(made: &Made, candidate: &Value, name: &str) -> Option<(f64, f64)> {
    let of_model = candidate.pointer(&format!("/simulation/{name}")).and_then(Value::as_f64);
    of_model.zip(made.number(&format!("/events/{name}")))
}

fn misses_its_own_crush(made: &Made, candidate: &Value) -> Option<String> {
    made.number("/events/dynamic_crush_m").filter(|_| !candidate["simulation"].is_null())?;
    let Some((own, crush)) = event(made, candidate, "dynamic_crush_m") else {
        return Some("it does not stop".to_owned());
    };
    let off = 100.0 * (own / crush - 1.0);
    (off.abs() > 3.5).then(|| format!("its crush is off by {off:.1} %"))
}

/// The same of the events beside the crush.
pub fn misses_time_or_rebound(made: &Made, candidate: &Value) -> Option<String> {
    let (own, time) = event(made, candidate, "time_of_dynamic_crush_s")?;
    let off = 100.0 * (own / time - 1.0);
    if off.abs() > 5.0 {
        return Some(format!("its time of crush is off by {off:.1} %"));
    }
    let (own, restitution) = event(made, candidate, "coefficient_of_restitution")?;
    let off = own - restitution;
    // Of a rebound that the record cuts off, what it shows is a lower bound.
    let is_off = if is_rebound_cut(made) { off < -0.1 } else { off.abs() > 0.1 };
    is_off.then(|| format!("its restitution is off by {off:.2}"))
}

/// Whether the velocity of the pulse is lowest at its end.
pub fn is_rebound_cut(made: &Made) -> bool {
    let velocity = made.waves.get(&format!("{}/velocity", made.text("/test/channel")));
    velocity.is_some_and(|wave| {
        let samples = wave.sampled.samples();
        let lowest = samples.iter().copied().fold(f64::INFINITY, f64::min);
        // After the contact the velocity is constant to rounding.
        let first = samples.iter().position(|v| *v <= lowest + 1e-6);
        lowest < 0.0 && first.is_some_and(|first| first + 2 >= samples.len())
    })
}
