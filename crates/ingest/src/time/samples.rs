//! The times of samples as a file has them, and the uniform grid that they are.

use crumple_signal::{About, Notes, Weight, remarks};

use crate::recording::details::Stated;
use crate::recording::settings;
use crate::time::grid::median_step;
use crate::time::resampling::{OnGrid, on_grid};
use crate::time::stamps::resolution_of_stamps;
use crate::time::unit::{contradicts, stated_unit, unit_error, unit_from_steps};
use crate::{IngestSettings, Place, Result, refuse};

/// Times of a calendar are larger than this, s (three years); they count from the first one.
pub const CALENDAR_S: f64 = 1e8;
/// 3000 years, s: what is larger is no date.
const NO_DATE_S: f64 = 1e11;

/// What the numbers of times are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// Seconds of a clock, from the first one on.
    Clock,
    /// Whole numbers that count from this one on.
    From(i64),
    /// Numbers that are printed with at most so many digits.
    Printed(u32),
    /// Numbers of a binary file.
    Binary,
}

/// The unit that the label of times states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LabelUnit {
    /// None.
    Unstated,
    /// One of time, with its factor to s.
    Time(f64),
    /// Another one.
    Other,
}

/// A column or a channel of times, which increase, at least two.
#[derive(Debug)]
pub struct Times<'a> {
    pub values: Vec<f64>,
    pub kind: Kind,
    pub file: &'a str,
    /// Column or channel, as errors name it.
    pub title: &'a str,
    /// The same as notes name it.
    pub whose: &'a str,
    /// The unit of its label.
    pub unit: LabelUnit,
    /// The unit that the file states elsewhere.
    pub comment: Option<&'a Stated<String>>,
    /// What a label with a unit looks like.
    pub expected: &'a str,
}

/// Times on a uniform grid.
#[derive(Debug)]
pub struct Timed {
    pub on_grid: OnGrid,
    /// Where the grid counts from, s, where the times are those of a calendar.
    pub origin_s: Option<f64>,
    /// The grid counts from the first time, which is one of a clock.
    pub is_of_a_clock: bool,
}

impl Times<'_> {
    /// The grid of the times, in s. `place` is that of a sample.
    ///
    /// # Errors
    /// A unit that is none of time or that the steps do not tell, times that are not finite, uneven ones.
    pub fn timed(
        mut self,
        settings: &IngestSettings,
        place: impl Fn(usize) -> Place,
        notes: &mut Notes,
    ) -> Result<Timed> {
        // A stated unit says that the numbers are of that.
        let is_stated =
            settings.time_unit.is_some() || matches!(self.unit, LabelUnit::Time(_)) || self.comment.is_some();
        if matches!(self.kind, Kind::Printed(_) | Kind::Binary)
            && !is_stated
            && let Some(from_first) = packed_clock(&self.values)
        {
            self.values = from_first;
            self.kind = Kind::Clock;
            notes.push(PackedClock { column: self.whose.to_owned() });
        }
        if self.kind == Kind::Clock && settings.time_unit.is_some() {
            settings::warn("--time-unit", &format!("the times of {} are those of a clock", self.whose), notes);
        }
        let unit_s = if self.kind == Kind::Clock { 1.0 } else { self.unit_s(settings, notes)? };
        let mut resolution_s = self.resolution(unit_s);
        let origin_s = match self.kind {
            Kind::From(first) => Some(first as f64 * unit_s),
            _ => from_first(&mut self.values, unit_s, &mut resolution_s),
        };
        // By division where that is exact: 20 ms are 0.02 s to the last bit.
        let inverse = (1.0 / unit_s).round();
        self.values.iter_mut().for_each(|t| if unit_s < 1.0 { *t /= inverse } else { *t *= unit_s });
        if let Some(k) = self.values.iter().position(|t| !t.is_finite()) {
            return refuse(place(k), "a time that is not finite", "finite times", "export it again");
        }
        let on_grid = on_grid(&self.values, resolution_s, settings, place)?;
        Ok(Timed { on_grid, origin_s, is_of_a_clock: self.kind == Kind::Clock })
    }

    /// Resolution of the numbers, s.
    fn resolution(&self, unit_s: f64) -> f64 {
        let largest = self.values.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        match self.kind {
            Kind::Clock => resolution_of_stamps(&self.values),
            Kind::From(_) => unit_s,
            // The last digit of the most finely printed stamp, seen from the largest.
            Kind::Printed(digits) => 10_f64.powf(largest.log10().floor() - f64::from(digits.max(1)) + 1.0) * unit_s,
            Kind::Binary if self.values.iter().all(|x| f64::from(*x as f32) == *x) => {
                largest * f64::from(f32::EPSILON) * unit_s
            }
            Kind::Binary => 0.0,
        }
    }

    /// The factor of the unit to s: of the flag, the label, what the file states elsewhere, else by the steps.
    fn unit_s(&self, settings: &IngestSettings, notes: &mut Notes) -> Result<f64> {
        let place = || Place::file(self.file).in_column(self.title);
        if let Some(symbol) = &settings.time_unit {
            let flag = stated_unit(place(), symbol, "--time-unit or the sidecar")?;
            if matches!(self.unit, LabelUnit::Time(of_label) if of_label != flag) {
                notes.push(AnotherTimeUnit { unit: symbol.clone(), column: self.whose.to_owned() });
            }
            return Ok(flag);
        }
        match (self.unit, self.comment) {
            (LabelUnit::Time(factor), comment) => {
                comment.map_or(Ok(()), |stated| contradicts(self.file, self.title, factor, stated))?;
                Ok(factor)
            }
            (LabelUnit::Other, _) => {
                Err(unit_error(place(), "the header of the time column states a unit that is not a time"))
            }
            (LabelUnit::Unstated, Some(stated)) => stated_unit(place(), &stated.value, &stated.from),
            (LabelUnit::Unstated, None) => {
                unit_from_steps(self.file, self.whose, self.expected, &self.values, settings, notes)
            }
        }
    }
}

/// Takes the first one from times of a calendar, in a unit of `unit_s`: their differences keep what the numbers
/// resolve. Returns what was taken, s; `None` where the times are small.
fn from_first(times: &mut [f64], unit_s: f64, resolution_s: &mut f64) -> Option<f64> {
    let first = *times.first().filter(|first| (CALENDAR_S..NO_DATE_S).contains(&(first.abs() * unit_s)))?;
    // Two units in the last place of the numbers, which a calendar makes coarse.
    *resolution_s += 2.0 * f64::EPSILON * first.abs() * unit_s;
    times.iter_mut().for_each(|t| *t -= first);
    Some(first * unit_s)
}

/// Seconds from the first time of a clock that is packed into a number, hhmmss.sss, as loggers of satellite positions
/// write it. `None` where no minute turns, so that the numbers may be seconds, or one is no time of a day, or a turn is
/// no step like the others.
fn packed_clock(times: &[f64]) -> Option<Vec<f64>> {
    let minute = |t: f64| (t / 100.0).floor();
    let seconds = |t: f64| -> Option<f64> {
        let (hours, minutes, seconds) = ((t / 1e4).floor(), minute(t) % 100.0, t % 100.0);
        let is_time = (0.0..24.0).contains(&hours) && minutes < 60.0 && seconds < 60.0;
        is_time.then_some(3600.0 * hours + 60.0 * minutes + seconds)
    };
    let turns: Vec<usize> = (1..times.len()).filter(|k| minute(times[*k]) != minute(times[*k - 1])).collect();
    if turns.is_empty() {
        return None;
    }
    let of_day: Vec<f64> = times.iter().map(|t| seconds(*t)).collect::<Option<_>>()?;
    let usual_s = median_step(&of_day);
    let is_even = |k: &usize| (of_day[*k] - of_day[*k - 1] - usual_s).abs() < 0.5 * usual_s;
    turns.iter().all(is_even).then(|| of_day.iter().map(|t| t - of_day[0]).collect())
}

remarks! {
    /// Remarks of the times of samples.
    pub REMARKS;

    /// The times are a clock that is packed into a number.
    CR114 PackedClock { column: String }
    bears on (About::Time, Weight::None)
    decided "No unit is stated, all numbers are times of a day as hhmmss, and where a minute turns the step is as long \
             as the others."
    means "Times are seconds from the first sample. Read as plain numbers they would jump at every minute."
    remedy "nothing; --time-unit s takes the numbers for seconds"
    says format!("the times of {column} are those of a clock packed into a number, hhmmss");

    /// The flag states another unit of time than the label of the times.
    CR115 AnotherTimeUnit { unit: String, column: String }
    bears on (About::Time, Weight::Marked)
    decided "The unit of --time-unit, or of the sidecar, is compared with the unit of the label. The flag is used."
    means "If the label is right, delta-v is wrong by the ratio of both units and crush by its square."
    remedy "leave --time-unit out if the label is right"
    says format!("--time-unit {unit} is not the unit that the label of {column} states");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_that_is_packed_into_a_number_counts_seconds_over_the_minute() {
        let packed = [100_259.998, 100_259.999, 100_300.0, 100_300.001];
        let found = packed_clock(&packed).unwrap();
        assert!(found.iter().enumerate().all(|(k, t)| (t - 1e-3 * k as f64).abs() < 1e-9), "{found:?}");
        let hours = [95_958.0, 95_959.0, 100_000.0, 100_001.0];
        assert_eq!(packed_clock(&hours), Some(vec![0.0, 1.0, 2.0, 3.0]));
        // Seconds, also those that pass a hundred; a day has no hour 31; no minute turns.
        assert_eq!(packed_clock(&[99.98, 99.99, 100.0, 100.01]), None);
        assert_eq!(packed_clock(&[158.0, 159.0, 160.0, 161.0]), None);
        assert_eq!(packed_clock(&[310_259.999, 310_300.0, 310_300.001]), None);
        assert_eq!(packed_clock(&[100_259.1, 100_259.2, 100_259.3]), None);
    }
}
