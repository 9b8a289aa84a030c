//! Mass and impact speed from rows of names and values: above a table, or on another sheet of a workbook.

use crumple_signal::unit::{Dimension, parse_value};
use crumple_signal::{About, Notes, QuantityKind, Weight, remarks};

use crate::recording::details::{Details, Stated};

/// Names of the test mass, small letters without signs between.
const MASS: [&str; 14] = [
    "mass",
    "testmass",
    "vehiclemass",
    "testweight",
    "vehicleweight",
    "weight",
    "masse",
    "testmasse",
    "prüfmasse",
    "fahrzeugmasse",
    "gewicht",
    "testgewicht",
    "massedessai",
    "masa",
];
/// Names of the impact speed.
const SPEED: [&str; 14] = [
    "impactspeed",
    "impactvelocity",
    "testspeed",
    "testvelocity",
    "collisionspeed",
    "speed",
    "velocity",
    "aufprallgeschwindigkeit",
    "anprallgeschwindigkeit",
    "prüfgeschwindigkeit",
    "testgeschwindigkeit",
    "geschwindigkeit",
    "vitessedimpact",
    "velocidaddeimpacto",
];

/// Takes mass and speed from rows, each with where it stands, in words, where nothing else states them. A row is a
/// name, a value, and its unit with the value, in the next cell, or in brackets behind the name: `Masse;1719 kg`,
/// `Test mass [kg],1719`. Other rows are left alone; two that differ state nothing, which is noted, as is a value
/// without a unit.
pub fn take(rows: impl Iterator<Item = (String, Vec<String>)>, details: &mut Details, notes: &mut Notes) {
    let (mut masses, mut speeds) = (Vec::new(), Vec::new());
    for (from, cells) in rows {
        let mut cells = cells.into_iter().map(|cell| cell.trim().to_owned()).filter(|cell| !cell.is_empty());
        let Some(first) = cells.next() else { continue };
        let mut rest: Vec<String> = cells.collect();
        let (first, behind) = first.split_once([':', '=']).map_or((first.as_str(), ""), |(name, value)| (name, value));
        if !behind.trim().is_empty() {
            rest.insert(0, behind.trim().to_owned());
        }
        let (name, unit) = first.split_once(['[', '(']).unwrap_or((first, ""));
        let name: String = name.to_lowercase().chars().filter(|c| c.is_alphanumeric()).collect();
        let (found, dimension) = match name.as_str() {
            name if MASS.contains(&name) => (&mut masses, Dimension::Mass),
            name if SPEED.contains(&name) => (&mut speeds, Dimension::Signal(QuantityKind::Velocity)),
            _ => continue,
        };
        let Some(value) = rest.first() else { continue };
        let next = rest.get(1).map_or("", String::as_str);
        let of_name = unit.trim_end_matches([']', ')']);
        let written = [value.clone(), format!("{value} {of_name}"), format!("{value} {next}")];
        match written.iter().find_map(|text| parse_value(text, dimension).ok()).filter(|x| *x > 0.0) {
            Some(value) => found.push(Stated { value, from }),
            // Words behind such a name are no value.
            None if value.starts_with(|c: char| c.is_ascii_digit()) => {
                let flag = if dimension == Dimension::Mass { "--mass 1500kg" } else { "--impact-speed 50km/h" };
                let (name, value, what) = (first.to_owned(), value.clone(), dimension.name());
                notes.push(NoUnit { from, name, value, what, flag });
            }
            None => {}
        }
    }
    for (what, found, slot) in
        [("mass", masses, &mut details.mass_kg), ("impact speed", speeds, &mut details.impact_speed_m_per_s)]
    {
        let Some(first) = found.first() else { continue };
        match found.iter().find(|other| (other.value - first.value).abs() > 1e-9 * first.value) {
            Some(other) => notes.push(TwoValues { from: first.from.clone(), other_from: other.from.clone(), what }),
            None => {
                slot.get_or_insert_with(|| first.clone());
            }
        }
    }
}

remarks! {
    /// Remarks of rows above a table.
    pub REMARKS;

    /// A row names mass or impact speed, but its value has no unit.
    CR110 NoUnit { from: String, name: String, value: String, what: &'static str, flag: &'static str }
    bears on (About::Record, Weight::None)
    decided "A row is a fact if its first cell names mass or speed. The unit comes with the value, in the next cell, \
             or in brackets behind the name."
    means "The value is not taken. Where nothing else states it, it is missing."
    remedy "state it by the flag of the sentence, or write the unit into the row"
    says format!("{from}: {name} {value} is no {what} with its unit and is not taken; {flag}, for example, states it");

    /// Two rows state another mass or impact speed.
    CR111 TwoValues { from: String, other_from: String, what: &'static str }
    bears on (About::Record, Weight::Slight)
    decided "Values of all rows that name it are compared in SI units; 1e-9 of the value is left for rounding."
    means "None of both is taken. Where nothing else states it, results that need it are missing."
    remedy "state the right one by its flag: --mass or --impact-speed"
    says format!("{from} and {other_from} state another {what}: none is taken, a flag states it");
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taken(rows: &[&[&str]]) -> (Option<f64>, Option<f64>, String) {
        let (mut details, mut notes) = (Details::default(), Notes::new());
        let rows = rows.iter().map(|cells| ("row".to_owned(), cells.iter().map(|c| (*c).to_owned()).collect()));
        take(rows, &mut details, &mut notes);
        let value = |stated: Option<Stated<f64>>| stated.map(|stated| stated.value);
        (value(details.mass_kg), value(details.impact_speed_m_per_s), notes.to_texts().concat())
    }

    #[test]
    fn units_stand_with_the_value_beside_it_or_behind_the_name() {
        for row in
            [&["Masse", "1719 kg"][..], &["Test mass [kg]", "1719"], &["Mass:", "1719", "kg"], &["Mass: 1,7190 t"]]
        {
            assert!((taken(&[row]).0.unwrap() - 1719.0).abs() < 1e-9, "{row:?}");
        }
        for row in [&["Impact Speed", "57,1 km/h"][..], &["v", "1"], &["Geschwindigkeit [km/h]", "57,1"]] {
            let found = taken(&[row]).1;
            assert_eq!(found.is_some(), row[0] != "v", "{row:?}");
            assert!(found.is_none_or(|speed| (3.6 * speed - 57.1).abs() < 1e-9), "{row:?}");
        }
    }

    #[test]
    fn what_is_no_statement_is_left_alone() {
        assert_eq!(
            taken(&[&["Speed", "channel 3"], &["time", "mass"], &["the mass", "5 kg"]]),
            (None, None, String::new())
        );
        assert!(taken(&[&["Mass", "1719"]]).2.contains("is not taken"));
        assert!(taken(&[&["Mass", "1,719 kg"]]).2.contains("is not taken"));
        let two = taken(&[&["Mass", "1719 kg"], &["Weight", "1500 kg"]]);
        assert!(two.0.is_none() && two.2.contains("none is taken"));
        assert_eq!(taken(&[&["Mass", "1719 kg"], &["Weight", "1.719 t"]]).0, Some(1719.0));
    }
}
