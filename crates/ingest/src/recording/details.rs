//! Facts about the test from several places: the record, its sidecar, flags. The later beats the earlier, and says so.

use crumple_artifact::records::{DamageV1, VehicleV1};
use crumple_signal::unit::{Dimension, parse_value};
use crumple_signal::value::{Mass, Speed, Time};
use crumple_signal::{
    ANOTHER_VEHICLE, About, Note, Notes, Overlap, QuantityKind, TestKind, VEHICLE_KG, Weight, is_mass_of_a_vehicle,
    remarks,
};

use crate::recording::stated_contact::TimeZero;
use crate::{IngestError, IngestSettings, Place, Result, refuse};

/// A fact and where it is stated.
#[derive(Debug, Clone, PartialEq)]
pub struct Stated<T> {
    /// The value.
    pub value: T,
    /// Where it stands, in words: `line 3 of crash.csv`, `VEHTWT`.
    pub from: String,
}

/// What the record says of the test.
#[derive(Debug, Clone, Default)]
pub struct Details {
    /// Title of the test.
    pub title: Option<Stated<String>>,
    /// Vehicle, in words.
    pub vehicle: Option<Stated<String>>,
    /// Barrier, in words.
    pub barrier: Option<Stated<String>>,
    /// Test mass, kg.
    pub mass_kg: Option<Stated<f64>>,
    /// Speed just before contact, m/s, positive.
    pub impact_speed_m_per_s: Option<Stated<f64>>,
    /// What was tested.
    pub kind: Option<Stated<TestKind>>,
    /// How it met what it hit.
    pub overlap: Option<Stated<Overlap>>,
    /// Time of first contact on the file's axis, s.
    pub time_zero_s: Option<Stated<f64>>,
    /// What was measured on the vehicle afterwards.
    pub damage: Option<DamageV1>,
    /// The vehicles of a test with several; empty for one.
    pub vehicles: Vec<VehicleV1>,
    /// Speed at which they approach each other, m/s.
    pub closing_speed_m_per_s: Option<f64>,
    /// What the record says of the impact speed and is not taken, and why, in words.
    pub speed_not_taken: Option<String>,
    /// The record is of a kind that has no crash pulse (an event data recorder's velocity change, say): mass, speed and
    /// pulse may be missing.
    pub no_pulse: bool,
    /// Facts that have no field of their own: static crush, laboratory, date.
    pub facts: Vec<String>,
}

/// What comments of a file state, by the names of the sidecar's keys.
#[derive(Debug, Clone, Default)]
pub struct CommentFacts {
    /// Facts with fields of their own.
    pub details: Details,
    /// Unit of acceleration columns that state none.
    pub unit: Option<Stated<String>>,
    /// Unit of the time column.
    pub time_unit: Option<Stated<String>>,
    /// Remarks on lines that look like facts and are not.
    pub notes: Notes,
}

/// Reads `key: value` from comment lines. Keys: mass, impact speed, vehicle, title, barrier, unit, time unit, time
/// zero, in any case, with blanks, `_` or `-` between the words. Prose is left alone: only a line that starts with a
/// key and a colon counts. Two lines that state different values are refused, unless `over` states the fact.
pub fn from_comments<'a>(
    file: &str,
    comments: impl Iterator<Item = (usize, &'a str)>,
    over: &IngestSettings,
) -> Result<CommentFacts> {
    let mut facts = CommentFacts::default();
    for (line, text) in comments {
        let Some((key, value)) = text.split_once(':') else { continue };
        let key: String = key.to_lowercase().chars().filter(|c| !matches!(c, ' ' | '_' | '-' | '\t')).collect();
        let value = value.trim().trim_end_matches([',', ';']).trim();
        if value.is_empty() {
            continue;
        }
        let from = format!("line {line} of {file}");
        let place = || Place::line(file, line);
        let words = Stated { value: value.to_owned(), from: from.clone() };
        let CommentFacts { details, unit, time_unit, notes } = &mut facts;
        match key.as_str() {
            "vehicle" => state_once(&mut details.vehicle, words, over.vehicle.is_some(), place, "--vehicle")?,
            "title" => state_once(&mut details.title, words, over.title.is_some(), place, "--title")?,
            "barrier" => state_once(&mut details.barrier, words, over.barrier.is_some(), place, "--barrier")?,
            "unit" => state_once(unit, words, over.unit.is_some(), place, "--unit")?,
            "timeunit" => state_once(time_unit, words, over.time_unit.is_some(), place, "--time-unit")?,
            "mass" | "impactspeed" | "timezero" => {
                let (dimension, slot, is_over, flag) = match key.as_str() {
                    "mass" => (Dimension::Mass, &mut details.mass_kg, over.mass.is_some(), "--mass"),
                    "impactspeed" => (
                        Dimension::Signal(QuantityKind::Velocity),
                        &mut details.impact_speed_m_per_s,
                        over.impact_speed.is_some(),
                        "--impact-speed",
                    ),
                    _ => (Dimension::Time, &mut details.time_zero_s, over.time_zero.is_some(), "--time-zero"),
                };
                let is_number = |word: &str| word.parse::<f64>().is_ok();
                let is_value = value.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.'))
                    || value.split_whitespace().next().is_some_and(is_number);
                let parsed = if is_value { parse_value(value, dimension).map(Some) } else { Ok(None) };
                // What a flag states may be wrong in the file.
                let parsed = parsed.or_else(|error| if is_over { Ok(None) } else { Err(error) }).map_err(|error| {
                    IngestError::content(
                        Place::line(file, line),
                        error.to_string(),
                        format!("a {} with its unit", dimension.name()),
                        "correct the comment line, or remove it and use the flag",
                    )
                })?;
                if let Some(value) = parsed {
                    // 873 kg and 0.873 t are one mass.
                    let same = slot.as_ref().is_some_and(|old| (old.value - value).abs() <= 1e-9 * value.abs());
                    if !same {
                        let show = |si: f64| match dimension {
                            Dimension::Signal(_) => format!("{} km/h", (3.6e6 * si).round() / 1e6),
                            _ => format!("{si} {}", dimension.si_unit()),
                        };
                        let of = |stated: &Stated<f64>| Stated { value: show(stated.value), from: stated.from.clone() };
                        let stated = Stated { value, from };
                        state_once(&mut slot.as_ref().map(of), of(&stated), is_over, place, flag)?;
                        *slot = Some(stated);
                    }
                } else {
                    notes.push(NotAValue { from, text: text.to_owned() });
                }
            }
            _ => {}
        }
    }
    Ok(facts)
}

/// Puts a statement into its place, which another line must not have filled otherwise.
fn state_once(
    slot: &mut Option<Stated<String>>,
    stated: Stated<String>,
    is_over: bool,
    place: impl Fn() -> Place,
    flag: &str,
) -> Result<()> {
    if let Some(old) = slot.as_ref().filter(|old| old.value != stated.value && !is_over) {
        return refuse(
            place(),
            format!("{}, but {} says {}", stated.value, old.from, old.value),
            "one value for each fact",
            format!("remove the line that is wrong, or {flag} says which counts"),
        );
    }
    *slot = Some(stated);
    Ok(())
}

/// A layer of statements, and where the remarks on it go.
struct Layer<'a> {
    from: &'a str,
    notes: &'a mut Notes,
}

impl Layer<'_> {
    /// Puts a value over the one below; where they differ, `remark` says so.
    fn put<T: PartialEq>(
        &mut self,
        below: &mut Option<Stated<T>>,
        value: Option<T>,
        remark: impl FnOnce(&Stated<T>, &Stated<T>) -> Note,
    ) {
        let (Some(value), from) = (value, self.from.to_owned()) else { return };
        let stated = Stated { value, from };
        if let Some(old) = below.as_ref().filter(|old| old.value != stated.value) {
            self.notes.push(remark(&stated, old));
        }
        *below = Some(stated);
    }
}

/// Puts the statements of a sidecar or of flags over those of the record.
pub fn apply(details: &mut Details, settings: &IngestSettings, from: &str, notes: &mut Notes) {
    let mut layer = Layer { from, notes };
    let (speed, zero) =
        (settings.impact_speed.map(Speed::si), settings.time_zero.and_then(TimeZero::stated).map(Time::si));
    let words = |what: &'static str| {
        move |new: &Stated<String>, old: &Stated<String>| {
            let [value, other] = [new, old].map(|stated| format!("{:?}", stated.value));
            OtherWords { what, value, from: new.from.clone(), other_from: old.from.clone(), other }.into()
        }
    };
    let number = |what: &'static str, unit: &'static str| {
        move |new: &Stated<f64>, old: &Stated<f64>| {
            let (from, other_from) = (new.from.clone(), old.from.clone());
            OtherNumber { what, value: new.value, unit, from, other_from, other: old.value }.into()
        }
    };
    layer.put(&mut details.title, settings.title.clone(), words("title"));
    layer.put(&mut details.vehicle, settings.vehicle.clone(), words("vehicle"));
    layer.put(&mut details.barrier, settings.barrier.clone(), words("barrier"));
    layer.put(&mut details.kind, settings.kind, |new, old| {
        let [value, other] = [new, old].map(|stated| stated.value.name().to_owned());
        OtherWords { what: "kind", value, from: new.from.clone(), other_from: old.from.clone(), other }.into()
    });
    layer.put(&mut details.overlap, settings.overlap, |new, old| {
        let [value, other] = [new, old].map(|stated| stated.value.name().to_owned());
        OtherWords { what: "overlap", value, from: new.from.clone(), other_from: old.from.clone(), other }.into()
    });
    layer.put(&mut details.mass_kg, settings.mass.map(Mass::si), number("mass", "kg"));
    layer.put(&mut details.impact_speed_m_per_s, speed, number(IMPACT_SPEED, "m/s"));
    layer.put(&mut details.time_zero_s, zero, number("time zero", "s"));
}

const IMPACT_SPEED: &str = "impact speed";

/// A number of a statement as people have it: speeds in km/h.
fn shown(value: f64, unit: &str) -> String {
    if unit == "m/s" { format!("{} km/h", (3.6e3 * value).round() / 1e3) } else { format!("{value} {unit}") }
}

/// Checks that mass and impact speed are usable where they are stated. A speed of 0 is one: the vehicle stands.
pub fn check(file: &str, details: &Details) -> Result<()> {
    let mass = details.mass_kg.as_ref();
    let speed = details.impact_speed_m_per_s.as_ref();
    let wrong_mass = mass.filter(|s| !(s.value > 0.0 && s.value.is_finite()));
    let wrong_speed = speed.filter(|s| !(s.value >= 0.0 && s.value.is_finite()));
    for (what, stated) in [("mass", wrong_mass), ("impact speed", wrong_speed)] {
        if let Some(Stated { value, from }) = stated {
            return Err(IngestError::not_stated(
                file,
                format!("a usable {what}: {from} gives {value}"),
                if what == "mass" { "a positive value" } else { "a value of 0 or more" },
                "give it by its flag: --mass 1500kg, --impact-speed 50km/h",
            ));
        }
    }
    Ok(())
}

/// Notes which of mass and impact speed is not stated, what cannot be had without it, and how to state it.
///
/// `from_rest`: the pulse pushes the vehicle forward, as on a sled or from behind; it needs no impact speed.
pub fn note_missing(details: &Details, has_comments: bool, from_rest: bool, notes: &mut Notes) {
    let line = |line: &str| has_comments.then(|| line.to_owned());
    if details.impact_speed_m_per_s.is_none() {
        let reason = details.speed_not_taken.clone();
        if from_rest {
            notes.push(FromRest { reason });
        } else {
            notes.push(NoImpactSpeed { reason, header_line: line("impact speed: 50 km/h") });
        }
    }
    if details.mass_kg.is_none() {
        notes.push(NoMass { header_line: line("mass: 1500 kg") });
    }
}

/// What is found of a fact that is not taken, in brackets.
fn in_brackets(reason: Option<&String>) -> String {
    reason.map_or_else(String::new, |reason| format!(" ({reason})"))
}

/// The other way to state a fact that is missing.
fn or_line(header_line: Option<&String>) -> String {
    header_line.map_or_else(String::new, |line| format!(", or a header line \"# {line}\""))
}

/// Masses of cars and vans, kg, of which one may have been meant.
const CAR_KG: std::ops::RangeInclusive<f64> = 500.0..=5_000.0;

/// Questions a mass that no vehicle has and that a file states or contradicts, and says which unit would make it that
/// of a car. One that a person typed, with its unit, is taken, with a note.
pub fn question_mass(details: &Details, is_typed: bool, notes: &mut Notes) {
    let Some(Stated { value, from }) = details.mass_kg.as_ref().filter(|mass| !is_mass_of_a_vehicle(mass.value)) else {
        return;
    };
    let (mass_kg, from) = (*value, from.clone());
    if is_typed {
        notes.push(TypedMass { mass_kg });
        return;
    }
    let units = [("t", 1e3), ("kg or g", 1e-3)];
    let meant = units.into_iter().find(|(_, factor)| CAR_KG.contains(&(mass_kg * factor)));
    let (unit, meant_kg) = meant.map(|(unit, factor)| (unit, mass_kg * factor)).unzip();
    notes.push_first(MassOfNoVehicle { mass_kg, from, unit, meant_kg });
}

/// Whether nothing but the vehicle gives way, so that its speed can be held against its pulse.
pub fn is_alone(details: &Details) -> bool {
    let is_vehicle = |barrier: &Stated<String>| barrier.value == ANOTHER_VEHICLE;
    details.vehicles.len() < 2 && !details.barrier.as_ref().is_some_and(is_vehicle)
}

remarks! {
    /// Remarks of what is stated about the test.
    pub REMARKS;

    /// A comment line begins like a fact and has no value with a unit.
    CR102 NotAValue { from: String, text: String }
    bears on (About::Record, Weight::Slight)
    decided "A comment line that begins with mass, impact speed or time zero and a colon is a fact: a number and its \
             unit come behind the colon."
    means "The line is ignored. Where nothing else states the fact, it is missing."
    remedy "write the line as \"# mass: 1500 kg\", or state the fact by its flag: --mass, --impact-speed, --time-zero"
    says format!("{from} says {text:?}: not a value with a unit, ignored");

    /// Two places state another mass, impact speed or time zero.
    CR103 OtherNumber {
        what: &'static str, value: f64, unit: &'static str, from: String, other_from: String, other: f64
    }
    bears on (
        match *what {
            "mass" => About::Mass,
            IMPACT_SPEED => About::ImpactSpeed,
            _ => About::Time,
        },
        Weight::None
    )
    decided "A flag beats the sidecar file, which beats the record. The values are compared in SI units."
    means "All results use the first value of the sentence. Forces grow with the mass, energy with the square of the \
           speed."
    remedy "leave the flag or the line of the sidecar out if the record is right"
    says format!("{what} is {} by {from}; {other_from} says {}", shown(*value, unit), shown(*other, unit));

    /// Two places state another title, vehicle, barrier or kind of test.
    CR104 OtherWords { what: &'static str, value: String, from: String, other_from: String, other: String }
    bears on (About::Record, Weight::None)
    decided "A flag beats the sidecar file, which beats the record."
    means "Reports show the first of both. A kind that is no vehicle, and a barrier that is another vehicle, also \
           decide which results are made."
    remedy "leave the flag or the line of the sidecar out if the record is right"
    says format!("{what} is {value} by {from}; {other_from} says {other}");

    /// No impact speed is stated, and the pulse pushes the vehicle forward.
    CR105 FromRest { reason: Option<String> }
    bears on (About::ImpactSpeed, Weight::None)
    decided "The acceleration gains more than 0.25 m/s in the first 150 ms, as on a sled or in a hit from behind."
    means "Velocity is the change from time zero. Delta-v and the pulse hold; there is no crush and no restitution."
    remedy "nothing for a motion from rest; else state the speed by --impact-speed"
    says format!(
        "no impact speed is stated{}. The pulse is positive, as of a sled or a hit from behind: velocity is the change \
         from time zero",
        in_brackets(reason.as_ref())
    );

    /// No impact speed is stated.
    CR106 NoImpactSpeed { reason: Option<String>, header_line: Option<String> }
    bears on (About::ImpactSpeed, Weight::Decisive)
    decided "No flag, no sidecar file and no fact of the record states it. In brackets: what was found and not taken."
    means "The pulse and the change of velocity hold. There is no crush, no restitution and no model."
    remedy "add --impact-speed with its unit: --impact-speed 50km/h"
    says format!(
        "no impact speed is stated{}. For crush, restitution and models add --impact-speed 50km/h{}",
        in_brackets(reason.as_ref()),
        or_line(header_line.as_ref())
    );

    /// No mass is stated.
    CR107 NoMass { header_line: Option<String> }
    bears on (About::Mass, Weight::Decisive)
    decided "No flag, no sidecar file and no fact of the record states it."
    means "Pulse, velocity and crush hold: they need no mass. There is no force, energy, stiffness or model."
    remedy "add --mass with its unit: --mass 1500kg"
    says format!(
        "no mass is stated. For force, energy, stiffness and models add --mass 1500kg{}",
        or_line(header_line.as_ref())
    );

    /// No vehicle has the mass that was typed.
    CR108 TypedMass { mass_kg: f64 }
    bears on (About::Mass, Weight::None)
    decided "Vehicles have 200 kg to 60,000 kg: from a light quadricycle to a lorry with its load. The mass was typed \
             with its unit, and the record states none of a vehicle."
    means "The mass is used as it was typed, for a component, say. Of a body that falls its weight is left out."
    remedy "nothing, if the unit is right"
    says {
        // What is lighter than any vehicle may have been dropped.
        let falls = if mass_kg < VEHICLE_KG.start() {
            "; in a vertical fall its weight acts as well: models and crush leave the weight out"
        } else {
            ""
        };
        format!("the mass of {mass_kg} kg is none of a vehicle and taken as typed{falls}")
    };

    /// No vehicle has the mass that is stated.
    CR109 MassOfNoVehicle { mass_kg: f64, from: String, unit: Option<&'static str>, meant_kg: Option<f64> }
    bears on (About::Mass, Weight::Decisive)
    decided "Vehicles have 200 kg to 60,000 kg: from a light quadricycle to a lorry with its load. In brackets: the \
             unit that would make it the mass of a car or a van, 500 kg to 5,000 kg."
    means "Force, energy, stiffness and damping are wrong by the same factor as the mass. Velocity and crush hold."
    remedy "state the mass with its unit: --mass 1500kg"
    says {
        let meant = unit.zip(*meant_kg);
        let meant = meant.map_or_else(String::new, |(unit, kg)| format!(" ({kg:.0} kg if {unit} is meant)"));
        format!(
            "the mass is {mass_kg} kg by {from}, which no vehicle has{meant}: force, energy, stiffness and damping \
             grow with it; --mass states another"
        )
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facts(lines: &[&str]) -> Result<CommentFacts> {
        let lines = lines.iter().enumerate().map(|(k, line)| (k + 1, *line));
        from_comments("a.csv", lines, &IngestSettings::default())
    }

    #[test]
    fn keys_are_read_in_any_spelling() {
        let facts = facts(&["Mass: 873 kg", "IMPACT_SPEED : 36 km/h", "time zero: 12 ms", "vehicle: a: b"]).unwrap();
        assert_eq!(facts.details.mass_kg.unwrap().value, 873.0);
        assert_eq!(facts.details.impact_speed_m_per_s.unwrap().value, 10.0);
        assert_eq!(facts.details.time_zero_s.unwrap().value, 0.012);
        assert_eq!(facts.details.vehicle.unwrap().value, "a: b");
    }

    #[test]
    fn prose_is_not_parsed() {
        let facts =
            facts(&["initial velocity v0 = 13.4 m/s, crush x", "the mass: 5 kg", "mass: see the report"]).unwrap();
        assert!(facts.details.mass_kg.is_none() && facts.details.impact_speed_m_per_s.is_none());
        assert_eq!(facts.notes.to_texts().len(), 1);
    }

    #[test]
    fn a_bare_number_is_asked_back() {
        let error = facts(&["mass: 873"]).unwrap_err().to_string();
        assert!(error.starts_with("a.csv, line 1: \"873\" has no unit"), "{error}");
    }

    #[test]
    fn what_is_missing_is_named_with_what_it_is_for() {
        let texts = |details: &Details, from_rest| {
            let mut notes = Notes::new();
            note_missing(details, true, from_rest, &mut notes);
            notes.to_texts()
        };
        let frontal = texts(&Details::default(), false);
        assert!(
            frontal[0].contains("--impact-speed 50km/h, or a header line \"# impact speed: 50 km/h\""),
            "{frontal:?}"
        );
        assert!(frontal[1].contains("no mass is stated. For force, energy"), "{frontal:?}");
        let sled = texts(&Details::default(), true);
        assert!(sled[0].contains("as of a sled") && !sled[0].contains("--impact-speed"), "{sled:?}");
        assert!(texts(&facts(&["mass: 873 kg", "impact speed: 0 km/h"]).unwrap().details, false).is_empty());
    }

    #[test]
    fn lines_that_contradict_each_other_are_refused_with_both() {
        let error = facts(&["mass: 873 kg", "title: a", "Mass: 900 kg"]).unwrap_err();
        assert_eq!(error.to_string(), "a.csv, line 3: 900 kg, but line 1 of a.csv says 873 kg");
        for lines in [
            ["impact speed: 35 km/h", "impact_speed: 36 km/h"],
            ["unit: g", "unit: m/s^2"],
            ["vehicle: a", "vehicle: b"],
        ] {
            assert!(facts(&lines).unwrap_err().hint().starts_with("remove the line that is wrong, or --"), "{lines:?}");
        }
        // The same mass in other units is no contradiction, and a flag settles one.
        assert_eq!(facts(&["mass: 873 kg", "mass: 0.873 t"]).unwrap().details.mass_kg.unwrap().value, 873.0);
        let flag = IngestSettings { mass: Some("900kg".parse().unwrap()), ..IngestSettings::default() };
        from_comments("a.csv", [(1, "mass: 873 kg"), (2, "mass: 900 kg")].into_iter(), &flag).unwrap();
    }

    #[test]
    fn a_mass_that_no_vehicle_has_is_questioned() {
        let question = |mass: &str| {
            let mut notes = Notes::new();
            question_mass(&facts(&[mass]).unwrap().details, false, &mut notes);
            notes.to_texts().concat()
        };
        assert!(question("mass: 1.5 kg").contains("(1500 kg if t is meant)"));
        assert!(question("mass: 1500000 kg").contains("(1500 kg if kg or g is meant)"));
        assert!(question("mass: 1500 t").contains("(1500 kg if kg or g is meant)"));
        assert!(question("mass: 100000 kg").contains("which no vehicle has"));
        for mass in ["mass: 873 kg", "mass: 250 kg", "mass: 40 t"] {
            assert_eq!(question(mass), "");
        }
    }

    #[test]
    fn a_mass_that_was_typed_is_no_doubt() {
        let mut details = facts(&["mass: 873 kg"]).unwrap().details;
        let settings = IngestSettings { mass: Some("4.8kg".parse().unwrap()), ..IngestSettings::default() };
        apply(&mut details, &settings, "flag", &mut Notes::new());
        let mut notes = Notes::new();
        question_mass(&details, true, &mut notes);
        assert!(notes.to_texts().concat().contains("leave the weight out"));
        let is_harmless = |note: &Note| note.bearing.as_ref().is_some_and(|bearing| bearing.weight == Weight::None);
        assert!(notes.iter().all(is_harmless), "it changes nothing");
    }

    #[test]
    fn a_flag_beats_the_file_and_says_so() {
        let mut details = facts(&["mass: 873 kg"]).unwrap().details;
        let settings = IngestSettings { mass: Some("900kg".parse().unwrap()), ..IngestSettings::default() };
        let mut notes = Notes::new();
        apply(&mut details, &settings, "flag", &mut notes);
        assert_eq!(details.mass_kg.unwrap().value, 900.0);
        assert_eq!(notes.to_texts(), ["mass is 900 kg by flag; line 1 of a.csv says 873 kg"]);
    }
}
