//! Name and unit of a waveform from its title and its stated unit.

use crumple_signal::unit::{self, Dimension};

use crate::formats::text::column_names::{Unit, is_time_name, split_unit};

/// Name and unit of a waveform.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// The name, whole.
    pub title: String,
    /// The name without a unit in it.
    pub name: String,
    /// The unit.
    pub unit: Unit,
}

/// Takes the stated unit, else one in the name: `Acceleration (g)`, `DeltaV (m\s)`. DIAdem allows no `/` in a name.
pub fn label(title: &str, stated: &str) -> Label {
    let title = title.trim().to_owned();
    let (bare, in_name) = split_unit(&title.replace('\\', "/"));
    let in_name = match in_name {
        Unit::Unknown(symbol) => unit_of_symbol(&symbol),
        unit => unit,
    };
    // `Femur (Good)`: what is no unit belongs to the name.
    let name = if matches!(in_name, Unit::Unknown(_) | Unit::Unstated) { title.clone() } else { bare };
    let unit = if stated.trim().is_empty() { in_name } else { unit_of_symbol(stated) };
    Label { title, name, unit }
}

/// A unit by its symbol, or by the word that LabVIEW writes for it.
fn unit_of_symbol(symbol: &str) -> Unit {
    let symbol = unit::without_brackets(symbol).replace('\\', "/");
    let unit = |symbol: &str| match unit::factor(symbol, Dimension::Time) {
        Some(factor) => Some(Unit::Time(factor)),
        None => unit::signal_unit(symbol).map(|(kind, factor)| Unit::Signal(kind, factor)),
    };
    let word = symbol.to_lowercase();
    let word = match word.as_str() {
        "newton" | "newtons" => "N",
        "pascal" | "pascals" => "Pa",
        "radians" => "rad",
        // Short symbols differ by case: mg and Mg.
        word if word.len() > 3 => word,
        _ => "",
    };
    unit(&symbol).or_else(|| unit(word)).unwrap_or(Unit::Unknown(symbol))
}

/// `Time`, `t`, `IIWPG Time`: time stands first or last.
pub fn is_named_time(name: &str) -> bool {
    let last = name.rsplit([' ', '_', '-', '.']).next().unwrap_or(name);
    is_time_name(name) || (last.len() > 1 && is_time_name(last))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_signal::QuantityKind;

    #[test]
    fn units_are_stated_or_stand_in_the_name() {
        use QuantityKind::{Acceleration, Force, Velocity, Voltage};
        for (title, stated, name, unit) in [
            ("IIWPG Acceleration (g)", "", "IIWPG Acceleration", Unit::Signal(Acceleration, 9.806_65)),
            ("DeltaV (m\\s)", " ", "DeltaV", Unit::Signal(Velocity, 1.0)),
            ("Delta V (km\\h)", "", "Delta V", Unit::Signal(Velocity, 1.0 / 3.6)),
            ("IIWPG Time (sec)", "", "IIWPG Time", Unit::Time(1.0)),
            ("Response (Trigger)", "m/s^2", "Response (Trigger)", Unit::Signal(Acceleration, 1.0)),
            ("a [m\\s^2]", "g", "a", Unit::Signal(Acceleration, 9.806_65)),
            ("Excitation", "Newtons", "Excitation", Unit::Signal(Force, 1.0)),
            ("Voltage", "Volts", "Voltage", Unit::Signal(Voltage, 1.0)),
            ("Femur (Good)", "", "Femur (Good)", Unit::Unknown("Good".to_owned())),
            ("Acceleration_0", "", "Acceleration_0", Unit::Unstated),
            ("10VEHC0000__ACXD", "", "10VEHC0000__ACXD", Unit::Unstated),
            ("Acc (m/(s*s))", "", "Acc", Unit::Signal(Acceleration, 1.0)),
            ("Acc [m\\(s^2)]", "", "Acc", Unit::Signal(Acceleration, 1.0)),
            ("Acc", "m/(s*s)", "Acc", Unit::Signal(Acceleration, 1.0)),
            ("Acc", "[m/(s^2)]", "Acc", Unit::Signal(Acceleration, 1.0)),
            ("x", "furlong", "x", Unit::Unknown("furlong".to_owned())),
        ] {
            let label = label(title, stated);
            assert_eq!((label.name.as_str(), &label.unit), (name, &unit), "{title}");
        }
    }
}
