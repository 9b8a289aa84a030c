//! The unit of time stamps: as stated, else as their steps suggest.

use crumple_signal::Notes;
use crumple_signal::unit::{Dimension, choices, factor};

use crate::time::grid;
use crate::{IngestError, Place};

/// What to do about a unit that is none of time.
const HINT: &str =
    "export the times in s, ms or us; if they are and the unit is wrong, --time-unit ms (or s, us) says so";

/// The factor to s of a unit stated by `from`, of times that stand at `place`.
pub fn stated_unit(place: Place, symbol: &str, from: &str) -> Result<f64, IngestError> {
    let found = || format!("{symbol:?}, stated by {from}, is no unit of time");
    factor(symbol, Dimension::Time).ok_or_else(|| unit_error(place, found()))
}

/// An error that says what was found in place of a unit of time.
pub fn unit_error(place: Place, found: impl Into<String>) -> IngestError {
    IngestError::content(place, found, format!("one of {}", choices(Dimension::Time)), HINT)
}

/// The factor to s where nothing states it, with a note: steps of 1e-7 to 0.02 are those of a recorder in s, longer
/// ones up to 20 those of one in ms. `whose` are the stamps of a column or channel, which needs `expected`. Errors:
/// other steps.
pub fn unit_from_steps(
    file: &str,
    whose: &str,
    expected: &str,
    times: &[f64],
    notes: &mut Notes,
) -> Result<f64, IngestError> {
    let step = grid::median_step(times);
    let (symbol, factor) = match step {
        1e-7..0.02 => ("s", 1.0),
        0.02..=20.0 => ("ms", 1e-3),
        _ => {
            return Err(IngestError::NotStated {
                file: file.to_owned(),
                what: format!("the unit of time: {whose} has steps of {step}"),
                expected: expected.to_owned(),
                hint: "add --time-unit s, ms or us".to_owned(),
            });
        }
    };
    notes.info(format!(
        "no unit of time is stated for {whose}: taken as {symbol}, since the steps are {step:.6}; --time-unit overrides"
    ));
    Ok(factor)
}
