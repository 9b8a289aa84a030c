//! Units of waveforms: stated, or at the end of the name; by flag where neither is known.

use crumple_signal::unit::{self, Dimension, choices};
use crumple_signal::{About, Notes, QuantityKind, Weight};

use crate::formats::text::column_names::{Unit, names_acceleration};
use crate::formats::waveform::channel::Waveform;
use crate::formats::waveform::clock::Clocks;
use crate::formats::waveform::label::Label;
use crate::recording::unheeded_flags;
use crate::{IngestError, IngestSettings, Place};

const ACCELERATION: Dimension = Dimension::Signal(QuantityKind::Acceleration);

/// Quantity and factor to SI of every waveform; [`QuantityKind::Other`] and 1 where no unit is known.
///
/// `--unit` is for the channel asked for and for those named for acceleration, or for the only one.
pub fn quantities(
    file: &str,
    waveforms: &[Waveform],
    labels: &[Label],
    clocks: &Clocks,
    wanted: Option<usize>,
    settings: &IngestSettings,
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
        kinds[k] =
            match (&labels[k].unit, stated) {
                (Unit::Signal(QuantityKind::Acceleration, f), Some(over))
                    if *f != over && (wanted == Some(k) || accelerations == 1) =>
                {
                    notes.concern(About::Pulse, Weight::Marked, format!(
                    "the unit of channel {} is {f} m/s^2 by the file, {over} m/s^2 by the flag or sidecar: that is \
                     used",
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
        unheeded_flags::warn(
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
    match ask.filter(|_| !settings.listing) {
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
}
