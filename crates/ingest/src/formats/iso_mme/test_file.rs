//! The test file `.mme`: what it says of the test.

use crumple_signal::unit::{Dimension, parse_value};
use crumple_signal::{Notes, QuantityKind};

use crate::IngestSettings;
use crate::formats::iso_mme::header::{Header, number};
use crate::recording::details::{Details, Stated};

/// A bare speed above this, m/s (162 km/h), is not taken: it may be in km/h.
const FASTEST_BARE_M_PER_S: f64 = 45.0;
/// Facts carried along at most.
const FACT_LIMIT: usize = 100;

/// Title, vehicle, mass and speed of the test object asked for, everything else as facts. Mass and speed are found by
/// words in the keyword, since keywords differ between laboratories; what was taken is noted.
pub fn details(file: &str, header: &Header, settings: &IngestSettings, notes: &mut Notes) -> Details {
    let object = settings.vehicle_number.unwrap_or(1);
    let words = |keyword: &str| {
        header.text(keyword).map(|v| Stated { value: v.to_owned(), from: format!("{file}, {keyword}") })
    };
    let mass_kg = quantity(file, header, object, &["mass", "weight"], Dimension::Mass, notes);
    let speed =
        quantity(file, header, object, &["velocity", "speed"], Dimension::Signal(QuantityKind::Velocity), notes);
    let mut speed_not_taken = None;
    let impact_speed_m_per_s = speed.filter(|stated| {
        let taken = stated.value.abs() <= FASTEST_BARE_M_PER_S;
        if !taken {
            speed_not_taken =
                Some(format!("{} is {} without a unit, in m/s faster than a crash test", stated.from, stated.value));
            notes.warning(format!(
                "{} is {} m/s, faster than a crash test: not taken, state --impact-speed",
                stated.from, stated.value
            ));
        }
        taken
    });
    let impact_speed_m_per_s = impact_speed_m_per_s.map(|s| Stated { value: s.value.abs(), ..s });
    let mut facts = header.others(&["title"]);
    if facts.len() > FACT_LIMIT {
        notes.info(format!("{} further lines of {file} are left out", facts.len() - FACT_LIMIT));
        facts.truncate(FACT_LIMIT);
    }
    Details {
        title: words("title"),
        vehicle: words(&format!("name of test object {object}")).or_else(|| words("name of test object")),
        barrier: words("barrier").or_else(|| words("type of barrier")),
        mass_kg,
        impact_speed_m_per_s,
        speed_not_taken,
        facts,
        ..Details::default()
    }
}

/// The first value, not zero, of a keyword with one of the words that belongs to the test object; a keyword without
/// a number belongs to object 1. A bare number is in SI, as ISO/TS 13499 has it.
fn quantity(
    file: &str,
    header: &Header,
    object: u32,
    words: &[&str],
    dimension: Dimension,
    notes: &mut Notes,
) -> Option<Stated<f64>> {
    let mut fits: Vec<(bool, &str, &str)> = header
        .entries()
        .filter(|(keyword, _)| {
            keyword.split(|c: char| !c.is_alphanumeric()).any(|word| words.contains(&word))
                && !keyword.contains("angular")
        })
        .filter_map(|(keyword, value)| {
            let numbered: Option<u32> =
                keyword.split(|c: char| !c.is_ascii_digit()).find_map(|digits| digits.parse().ok());
            (numbered.unwrap_or(1) == object).then_some((numbered.is_none(), keyword, value))
        })
        .collect();
    fits.sort_by_key(|(unnumbered, ..)| *unnumbered);
    for (_, keyword, value) in fits {
        let (si, how) = match number(value) {
            Some(bare) => (bare, format!(" (no unit: taken as {})", dimension.si_unit())),
            None => match parse_value(value, dimension) {
                Ok(si) => (si, String::new()),
                Err(error) => {
                    notes.info(format!("{file}, {keyword}: {error}: not taken"));
                    continue;
                }
            },
        };
        if si == 0.0 {
            continue;
        }
        notes.info(format!("{} is taken from {file}, {keyword:?}: {value}{how}", dimension.name()));
        return Some(Stated { value: si, from: format!("{file}, {keyword}") });
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> (Details, Vec<String>) {
        let mut notes = Notes::new();
        let header = Header::parse("t.mme", text.as_bytes()).unwrap();
        (details("t.mme", &header, &IngestSettings::default(), &mut notes), notes.to_texts())
    }

    #[test]
    fn mass_and_speed_of_the_first_object_are_found_by_words() {
        let (details, notes) = read(
            "Title :frontal\nMass test object 2 :900\nMass test object 1 :1719\nVelocity test object 1 :57.09 \
             km/h\nName of test object 1 :car\nOdd key :kept\n",
        );
        assert_eq!((details.mass_kg.unwrap().value, details.vehicle.unwrap().value.as_str()), (1719.0, "car"));
        assert!((details.impact_speed_m_per_s.unwrap().value - 57.09 / 3.6).abs() < 1e-12);
        assert!(details.facts.contains(&"Odd key: kept".to_owned()));
        assert_eq!(notes[0], "mass is taken from t.mme, \"mass test object 1\": 1719 (no unit: taken as kg)");
    }

    #[test]
    fn a_bare_speed_that_may_be_in_km_per_h_is_not_taken() {
        let (details, notes) = read("Velocity test object 1 :57.09\n");
        assert_eq!(details.impact_speed_m_per_s, None);
        assert!(notes.iter().any(|n| n.contains("state --impact-speed")), "{notes:?}");
        assert_eq!(read("Velocity test object 1 :-15.6\n").0.impact_speed_m_per_s.unwrap().value, 15.6);
        assert_eq!(
            read("Velocity test object 1 :NOVALUE\nAngular velocity :3\nFilter speedup :3\n").0.impact_speed_m_per_s,
            None
        );
    }
}
