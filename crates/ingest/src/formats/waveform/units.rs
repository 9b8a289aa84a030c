//! Units of waveforms: stated, or at the end of the name; by flag where neither is known.

use crumple_signal::unit::{self, Dimension, choices};
use crumple_signal::{Notes, QuantityKind};

use crate::formats::text::column_names::{self, Unit, names_acceleration};
use crate::formats::waveform::Waveform;
use crate::formats::waveform::clock::Clocks;
use crate::recording::unheeded_flags;
use crate::{IngestError, Place, Settings};

const ACCELERATION: Dimension = Dimension::Signal(QuantityKind::Acceleration);

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
    let (bare, in_name) = column_names::split_unit(&title.replace('\\', "/"));
    let in_name = match in_name {
        Unit::Unknown(symbol) => known(&symbol),
        unit => unit,
    };
    // `Femur (Good)`: what is no unit belongs to the name.
    let name = if matches!(in_name, Unit::Unknown(_) | Unit::Unstated) { title.clone() } else { bare };
    let unit = if stated.trim().is_empty() { in_name } else { known(stated) };
    Label { title, name, unit }
}

/// A unit by its symbol, or by the word that LabVIEW writes for it.
fn known(symbol: &str) -> Unit {
    let symbol = unit::without_brackets(symbol).replace('\\', "/");
    let of = |symbol: &str| match unit::factor(symbol, Dimension::Time) {
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
    of(&symbol).or_else(|| of(word)).unwrap_or(Unit::Unknown(symbol))
}

/// Quantity and factor to SI of every waveform; [`QuantityKind::Other`] and 1 where no unit is known.
///
/// `--unit` is for the channel asked for and for those named for acceleration, or for the only one.
pub fn kinds(
    file: &str,
    waveforms: &[Waveform],
    labels: &[Label],
    clocks: &Clocks,
    wanted: Option<usize>,
    settings: &Settings,
    notes: &mut Notes,
) -> Result<Vec<(QuantityKind, f64)>, IngestError> {
    let stated = settings.unit.as_deref().map(|symbol| acceleration_unit(file, symbol)).transpose()?;
    let data: Vec<usize> = (0..waveforms.len()).filter(|k| !clocks.is_clock(*k)).collect();
    let is_acceleration = |k: usize| matches!(labels[k].unit, Unit::Signal(QuantityKind::Acceleration, _));
    let accelerations = data.iter().filter(|k| is_acceleration(**k)).count();
    let is_target =
        |k: usize| speaks_of_acceleration(&labels[k].title) || wanted.map_or(data.len() == 1, |wanted| wanted == k);
    let mut kinds = vec![(QuantityKind::Other, 1.0); waveforms.len()];
    for &k in &data {
        kinds[k] = match (&labels[k].unit, stated) {
            (Unit::Signal(QuantityKind::Acceleration, f), Some(over))
                if *f != over && (wanted == Some(k) || accelerations == 1) =>
            {
                notes.warning(format!(
                    "the unit of channel {} is {f} m/s^2 by the file, {over} m/s^2 by the flag or sidecar: that is used",
                    labels[k].title
                ));
                (QuantityKind::Acceleration, over)
            }
            (Unit::Signal(kind, f), _) => (*kind, *f),
            (Unit::Unstated | Unit::Unknown(_), Some(f)) if is_target(k) => (QuantityKind::Acceleration, f),
            _ => (QuantityKind::Other, 1.0),
        };
    }
    if let Some(factor) = stated
        && !data.iter().any(|k| kinds[*k] == (QuantityKind::Acceleration, factor))
    {
        unheeded_flags::note(
            "--unit",
            "the channels state units of their own; --channel names the one that is meant",
            notes,
        );
    }
    let lacks_unit = |k: usize| matches!(labels[k].unit, Unit::Unstated | Unit::Unknown(_)) && stated.is_none();
    let ask = match wanted {
        Some(wanted) => Some(wanted).filter(|k| lacks_unit(*k)),
        None if accelerations == 0 => {
            data.iter().copied().find(|k| lacks_unit(*k) && speaks_of_acceleration(&labels[*k].title))
        }
        None => None,
    };
    match ask {
        Some(k) => Err(no_unit(file, &labels[k])),
        None => Ok(kinds),
    }
}

/// Whether a title names acceleration; `Femur (Acceptable)` does not.
fn speaks_of_acceleration(title: &str) -> bool {
    let other_words = ["accept", "accur", "access", "accum", "accord"];
    names_acceleration(&other_words.iter().fold(title.to_lowercase(), |title, word| title.replace(word, "")))
}

fn no_unit(file: &str, label: &Label) -> IngestError {
    let found = match &label.unit {
        Unit::Unknown(symbol) => format!("unit {symbol:?} is not known"),
        _ => "no unit is stated".to_owned(),
    };
    IngestError::content(
        Place::file(file).in_column(label.title.clone()),
        found,
        format!("a unit of acceleration: {}", choices(ACCELERATION)),
        "add --unit g or --unit m/s^2, whichever it is: a unit is never guessed from the numbers",
    )
}

fn acceleration_unit(file: &str, symbol: &str) -> Result<f64, IngestError> {
    unit::factor(symbol, ACCELERATION).ok_or_else(|| {
        IngestError::content(
            Place::file(file),
            format!("{symbol:?}, stated by --unit or the sidecar, is no unit of acceleration"),
            format!("one of {}", choices(ACCELERATION)),
            "use --unit g or --unit m/s^2",
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_words_that_start_alike_are_no_acceleration() {
        assert!(speaks_of_acceleration("Head Acc X") && speaks_of_acceleration("IIWPG Acceleration"));
        assert!(!speaks_of_acceleration("Femur (Acceptable)") && !speaks_of_acceleration("accuracy"));
    }

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
            let found = label(title, stated);
            assert_eq!((found.name.as_str(), &found.unit), (name, &unit), "{title}");
        }
    }
}
