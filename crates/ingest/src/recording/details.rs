//! Facts about the test from several places: the record, its sidecar, flags. The later beats the earlier, and says so.

use crumple_artifact::records::{DamageV1, VehicleV1};
use crumple_signal::unit::{Dimension, parse_value};
use crumple_signal::value::{Mass, Speed, Time};
use crumple_signal::{ANOTHER_VEHICLE, About, Notes, QuantityKind, TestKind, VEHICLE_KG, Weight, is_mass_of_a_vehicle};

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
                    notes.warning(format!("{from} says {text:?}: not a value with a unit, ignored"));
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
    /// Puts a value over the one below; one that differs is noted. `show` writes a value for people.
    fn put<T: PartialEq>(
        &mut self,
        below: &mut Option<Stated<T>>,
        value: Option<T>,
        what: &str,
        show: fn(&T) -> String,
    ) {
        let (Some(value), from) = (value, self.from) else { return };
        if let Some(old) = below.as_ref().filter(|old| old.value != value) {
            self.notes.info(format!("{what} is {} by {from}; {} says {}", show(&value), old.from, show(&old.value)));
        }
        *below = Some(Stated { value, from: from.to_owned() });
    }
}

/// Puts the statements of a sidecar or of flags over those of the record.
pub fn apply(details: &mut Details, settings: &IngestSettings, from: &str, notes: &mut Notes) {
    let (mut layer, text): (_, fn(&String) -> String) = (Layer { from, notes }, |text| format!("{text:?}"));
    let (speed, zero) =
        (settings.impact_speed.map(Speed::si), settings.time_zero.and_then(TimeZero::stated).map(Time::si));
    let km_per_h = |v: &f64| format!("{} km/h", (3.6e3 * v).round() / 1e3);
    layer.put(&mut details.title, settings.title.clone(), "title", text);
    layer.put(&mut details.vehicle, settings.vehicle.clone(), "vehicle", text);
    layer.put(&mut details.barrier, settings.barrier.clone(), "barrier", text);
    layer.put(&mut details.kind, settings.kind, "kind", |kind| kind.name().to_owned());
    layer.put(&mut details.mass_kg, settings.mass.map(Mass::si), "mass", |kg| format!("{kg} kg"));
    layer.put(&mut details.impact_speed_m_per_s, speed, "impact speed", km_per_h);
    layer.put(&mut details.time_zero_s, zero, "time zero", |t| format!("{t} s"));
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
    let lines = |line: &str| if has_comments { format!(", or a header line \"# {line}\"") } else { String::new() };
    if details.impact_speed_m_per_s.is_none() {
        let found = details.speed_not_taken.as_ref().map_or_else(String::new, |found| format!(" ({found})"));
        if from_rest {
            notes.info(format!(
                "no impact speed is stated{found}. The pulse is positive, as of a sled or a hit from behind: velocity \
                 is the change from time zero"
            ));
        } else {
            notes.concern(
                About::ImpactSpeed,
                Weight::Decisive,
                format!(
                    "no impact speed is stated{found}. For crush, restitution and models add --impact-speed 50km/h{}",
                    lines("impact speed: 50 km/h")
                ),
            );
        }
    }
    if details.mass_kg.is_none() {
        notes.concern(
            About::Mass,
            Weight::Decisive,
            format!(
                "no mass is stated. For force, energy, stiffness and models add --mass 1500kg{}",
                lines("mass: 1500 kg")
            ),
        );
    }
}

/// Masses of cars and vans, kg, of which one may have been meant.
const CAR_KG: std::ops::RangeInclusive<f64> = 500.0..=5_000.0;

/// Questions a mass that no vehicle has and that a file states or contradicts, and says which unit would make it that
/// of a car. One that a person typed, with its unit, is taken, with a note.
pub fn question_mass(details: &Details, is_typed: bool, notes: &mut Notes) {
    let Some(Stated { value, from }) = details.mass_kg.as_ref().filter(|mass| !is_mass_of_a_vehicle(mass.value)) else {
        return;
    };
    if is_typed {
        let falls = "; in a vertical fall its weight acts as well: models and crush leave the weight out";
        // What is lighter than any vehicle may have been dropped.
        let falls = if value < VEHICLE_KG.start() { falls } else { "" };
        notes.info(format!("the mass of {value} kg is none of a vehicle and taken as typed{falls}"));
        return;
    }
    let units = [("t", 1e3), ("kg or g", 1e-3)];
    let meant = units.into_iter().find(|(_, factor)| CAR_KG.contains(&(value * factor)));
    let meant =
        meant.map_or_else(String::new, |(unit, factor)| format!(" ({:.0} kg if {unit} is meant)", value * factor));
    let text = format!(
        "the mass is {value} kg by {from}, which no vehicle has{meant}: force, energy, stiffness and damping grow with \
         it; --mass states another"
    );
    notes.concern_first(About::Mass, text);
}

/// Whether nothing but the vehicle gives way, so that its speed can be held against its pulse.
pub fn is_alone(details: &Details) -> bool {
    let is_vehicle = |barrier: &Stated<String>| barrier.value == ANOTHER_VEHICLE;
    details.vehicles.len() < 2 && !details.barrier.as_ref().is_some_and(is_vehicle)
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
        assert!(notes.iter().all(|note| note.bearing.is_none()), "it bears on nothing");
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
