//! Units of time: as stated, else by the steps where those tell it.

use crumple_signal::unit::{Dimension, choices, factor};
use crumple_signal::{About, Notes, Weight, remarks};

use crate::recording::details::Stated;
use crate::time::grid::{median_step, shortest};
use crate::{IngestError, IngestSettings, Place, Result, refuse};

/// What to do about a unit that is none of time.
const HINT: &str = "if the unit is wrong, --time-unit ms (or s, us, ns, min, h, d) says so";

/// The factor to s of a unit stated by `from`, of times that stand at `place`.
pub fn stated_unit(place: impl std::fmt::Display, symbol: &str, from: &str) -> Result<f64> {
    let found = || format!("{symbol:?}, stated by {from}, is no unit of time");
    factor(symbol, Dimension::Time).ok_or_else(|| unit_error(place, found()))
}

pub fn unit_error(place: impl std::fmt::Display, found: impl std::fmt::Display) -> IngestError {
    IngestError::content(place, found, format!("one of {}", choices(Dimension::Time)), HINT)
}

/// The factor to s where nothing states it: that of [`IngestSettings::tried_time_unit`]; else, with a note, days since
/// 1900 (Excel) or the year 0 (MATLAB) by their size, or s for steps of 1e-7 to 0.02, those of a recorder: in ms they
/// would be sampled at 50 kHz to 10 GHz. `whose` are the stamps of a column or channel, which needs `expected`. Errors:
/// other steps. Steps of 0.02 to 20 are those of a building in s, of a crash in ms, and of a shock in us.
pub fn unit_from_steps(
    file: &str,
    whose: &str,
    expected: &str,
    times: &[f64],
    settings: &IngestSettings,
    notes: &mut Notes,
) -> Result<f64> {
    if let Some(symbol) = settings.tried_time_unit {
        return stated_unit(file, symbol, "a trial");
    }
    let step = median_step(times);
    let first = times.first().copied().unwrap_or(0.0);
    // As seconds they would be sampled at 4 MHz and more.
    let is_serial = ((2e4..8e4).contains(&first) || (7e5..8e5).contains(&first)) && (1e-12..2.4e-7).contains(&step);
    let (symbol, factor) = match step {
        _ if is_serial => ("d", 86_400.0),
        1e-7..0.02 => ("s", 1.0),
        _ => {
            let steps = format!("{whose} has steps of {}", shortest(step, 1e-9 * step));
            return Err(IngestError::unit_of_time(file, steps, expected, &units_by_rate(step)));
        }
    };
    notes.push(AssumedTimeUnit { column: whose.to_owned(), unit: symbol, step });
    Ok(factor)
}

/// What to add where the steps do not tell the unit: each unit with the rate that it gives, if that is one of a
/// recorder, 1 Hz (a slow logger) to 4 MHz.
fn units_by_rate(step: f64) -> String {
    let rates = ["s", "ms", "us", "ns"].into_iter().filter_map(|symbol| {
        let rate_hz = 1.0 / (step * factor(symbol, Dimension::Time)?);
        (1.0..=4e6).contains(&rate_hz).then(|| format!("--time-unit {symbol} (sampled at {})", in_hz(rate_hz)))
    });
    match rates.reduce(|list, next| format!("{list} or {next}")) {
        Some(units) => format!("add {units}, whichever it is"),
        None => "add --time-unit ns (or us, ms, s, min, h, d), whichever it is".to_owned(),
    }
}

/// A rate with three digits.
fn in_hz(rate_hz: f64) -> String {
    let (rate, unit) = match rate_hz {
        ..1e3 => (rate_hz, "Hz"),
        1e3..1e6 => (rate_hz / 1e3, "kHz"),
        _ => (rate_hz / 1e6, "MHz"),
    };
    let digits = 10_f64.powf(2.0 - rate.log10().floor());
    format!("{} {unit}", (rate * digits).round() / digits)
}

/// Refuses a comment that states another unit of time than the header.
pub fn contradicts(file: &str, title: &str, factor: f64, stated: &Stated<String>) -> Result<()> {
    let of_comment = stated_unit(Place::file(file), &stated.value, &stated.from)?;
    if of_comment == factor {
        return Ok(());
    }
    refuse(
        Place::file(file).in_column(title),
        format!("its name states another unit of time than {}, {:?}", stated.from, stated.value),
        "one unit",
        "correct the one that is wrong, or --time-unit says which counts",
    )
}

remarks! {
    /// Remarks of units of time.
    pub REMARKS;

    /// No unit of time is stated; the steps of the times tell it.
    CR116 AssumedTimeUnit { column: String, unit: &'static str, step: f64 }
    bears on (About::Time, Weight::None)
    decided "The median step is read. Steps of 1e-7 to 0.02 are s: in ms they would be sampled at 50 kHz to 10 GHz. \
             Smaller steps of numbers as large as dates of Excel or MATLAB are days. Any other step is asked about."
    means "Delta-v grows with the unit of time, and crush with its square."
    remedy "nothing, if the sampling rate is that of the recorder; else state the unit by --time-unit"
    says format!(
        "no unit of time is stated for {column}: {unit} is assumed, because the steps are {step:.6}. --time-unit \
         overrides"
    );
}
