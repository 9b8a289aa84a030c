//! Facts about the test from several places: the record, its sidecar, flags. The later beats the earlier, and says so.

use crumple_signal::QuantityKind;
use crumple_signal::unit::{Dimension, parse_value};
use crumple_signal::value::{Mass, Speed, Time};
use crumple_signal::{About, Notes, Weight};

use crate::{IngestError, IngestSettings, Place};

/// A fact and where it is stated.
#[derive(Debug, Clone, PartialEq)]
pub struct Stated<T> {
    /// The value.
    pub value: T,
    /// Where it stands, in words: `line 3 of crash.csv`, `VEHTWT`.
    pub from: String,
}

/// Residual crush of the vehicle, measured after the test.
#[derive(Debug, Clone, PartialEq)]
pub struct Damage {
    /// At stations of equal spacing over the width of the damage, left to right, m; negative: bulged out.
    pub residual_crush_m: Vec<f64>,
    /// Width of the damage, m.
    pub damage_width_m: Option<f64>,
    /// Width of the vehicle, m.
    pub vehicle_width_m: Option<f64>,
    /// Collision deformation classification (SAE J224).
    pub classification: Option<String>,
    /// The fields that these are from.
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
    /// Time of first contact on the file's axis, s.
    pub time_zero_s: Option<Stated<f64>>,
    /// What was measured on the vehicle afterwards.
    pub damage: Option<Damage>,
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
/// key and a colon counts.
pub fn from_comments<'a>(
    file: &str,
    comments: impl Iterator<Item = (usize, &'a str)>,
) -> Result<CommentFacts, IngestError> {
    let mut facts = CommentFacts::default();
    for (line, text) in comments {
        let Some((key, value)) = text.split_once(':') else { continue };
        let key: String = key.to_lowercase().chars().filter(|c| !matches!(c, ' ' | '_' | '-' | '\t')).collect();
        let value = value.trim().trim_end_matches([',', ';']).trim();
        if value.is_empty() {
            continue;
        }
        let from = format!("line {line} of {file}");
        let words = || Some(Stated { value: value.to_owned(), from: from.clone() });
        let details = &mut facts.details;
        match key.as_str() {
            "vehicle" => details.vehicle = words(),
            "title" => details.title = words(),
            "barrier" => details.barrier = words(),
            "unit" => facts.unit = words(),
            "timeunit" => facts.time_unit = words(),
            "mass" | "impactspeed" | "timezero" => {
                let (dimension, slot) = match key.as_str() {
                    "mass" => (Dimension::Mass, &mut details.mass_kg),
                    "impactspeed" => (Dimension::Signal(QuantityKind::Velocity), &mut details.impact_speed_m_per_s),
                    _ => (Dimension::Time, &mut details.time_zero_s),
                };
                if value.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.')) {
                    let value = parse_value(value, dimension).map_err(|error| {
                        IngestError::content(
                            Place::line(file, line),
                            error.to_string(),
                            format!("a {} with its unit", dimension.name()),
                            "correct the comment line, or remove it and use the flag",
                        )
                    })?;
                    *slot = Some(Stated { value, from });
                } else {
                    facts.notes.warning(format!("{from} says {text:?}: not a value with a unit, ignored"));
                }
            }
            _ => {}
        }
    }
    Ok(facts)
}

/// One layer of statements over another; a differing value below is noted. `show` writes a value for people.
pub fn overrule<T: PartialEq>(
    below: &mut Option<Stated<T>>,
    value: Option<T>,
    from: &str,
    what: &str,
    show: impl Fn(&T) -> String,
    notes: &mut Notes,
) {
    let Some(value) = value else { return };
    if let Some(old) = below.as_ref().filter(|old| old.value != value) {
        notes.info(format!("{what} is {} by {from}; {} says {}", show(&value), old.from, show(&old.value)));
    }
    *below = Some(Stated { value, from: from.to_owned() });
}

/// Puts the statements of a sidecar or of flags over those of the record.
pub fn apply(details: &mut Details, settings: &IngestSettings, from: &str, notes: &mut Notes) {
    let text = |t: &String| format!("{t:?}");
    overrule(&mut details.title, settings.title.clone(), from, "title", text, notes);
    overrule(&mut details.vehicle, settings.vehicle.clone(), from, "vehicle", text, notes);
    overrule(&mut details.barrier, settings.barrier.clone(), from, "barrier", text, notes);
    overrule(&mut details.mass_kg, settings.mass.map(Mass::si), from, "mass", |kg| format!("{kg} kg"), notes);
    overrule(
        &mut details.impact_speed_m_per_s,
        settings.impact_speed.map(Speed::si),
        from,
        "impact speed",
        |v| format!("{v} m/s"),
        notes,
    );
    overrule(
        &mut details.time_zero_s,
        settings.time_zero.map(Time::si),
        from,
        "time zero",
        |t| format!("{t} s"),
        notes,
    );
}

/// Checks that mass and impact speed are stated and sensible. `allow_missing` lets them be unknown, not wrong.
///
/// `comments`: the format has comment lines in which they can be stated.
pub fn require(
    file: &str,
    details: &Details,
    comments: bool,
    allow_missing: bool,
    notes: &mut Notes,
) -> Result<(), IngestError> {
    let mass = details.mass_kg.as_ref();
    let speed = details.impact_speed_m_per_s.as_ref();
    for (what, stated) in [("mass", mass), ("impact speed", speed)] {
        if let Some(Stated { value, from }) = stated.filter(|s| !(s.value > 0.0 && s.value.is_finite())) {
            return Err(IngestError::NotStated {
                file: file.to_owned(),
                what: format!("a usable {what}: {from} gives {value}"),
                expected: "a positive value".to_owned(),
                hint: "give it by its flag: --mass 1500kg, --impact-speed 50km/h".to_owned(),
            });
        }
    }
    let (what, flags, lines) = match (mass, speed) {
        (Some(_), Some(_)) => return Ok(()),
        (None, Some(_)) => ("the mass of the vehicle", "--mass 1500kg", "\"# mass: 1500 kg\""),
        (Some(_), None) => ("the impact speed", "--impact-speed 50km/h", "\"# impact speed: 50 km/h\""),
        (None, None) => (
            "the mass of the vehicle and the impact speed",
            "--mass 1500kg --impact-speed 50km/h",
            "\"# mass: 1500 kg\" and \"# impact speed: 50 km/h\"",
        ),
    };
    if allow_missing {
        let about = if mass.is_none() && speed.is_some() { About::Mass } else { About::ImpactSpeed };
        notes.concern(
            about,
            Weight::Decisive,
            format!(
                "not stated, as allowed: {what}; enough to filter and to identify, not for crush, force or physical \
             parameters"
            ),
        );
        return Ok(());
    }
    let what = match &details.speed_not_taken {
        Some(found) if speed.is_none() => format!("{what} usably: {found}"),
        _ => what.to_owned(),
    };
    let lines = if comments { format!("header lines {lines}, or ") } else { String::new() };
    Err(IngestError::NotStated {
        file: file.to_owned(),
        what,
        expected: format!("{lines}flags, or a sidecar {file}.toml"),
        hint: format!("add {flags} (or --allow-missing, to identify a linear model only)"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facts(lines: &[&str]) -> Result<CommentFacts, IngestError> {
        from_comments("a.csv", lines.iter().enumerate().map(|(k, line)| (k + 1, *line)))
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
    fn what_is_missing_is_named() {
        let error = require("a.csv", &Details::default(), true, false, &mut Notes::new()).unwrap_err();
        assert_eq!(error.to_string(), "a.csv does not state the mass of the vehicle and the impact speed");
        assert!(error.hint().contains("--mass 1500kg --impact-speed 50km/h"));
        assert!(error.expected().unwrap().contains("# mass: 1500 kg"));
        let error = require("a.tdms", &Details::default(), false, false, &mut Notes::new()).unwrap_err();
        assert_eq!(error.expected().unwrap(), "flags, or a sidecar a.tdms.toml");
        let mut notes = Notes::new();
        require("a.csv", &Details::default(), true, true, &mut notes).unwrap();
        assert!(notes.to_texts()[0].starts_with("warning: "));
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
