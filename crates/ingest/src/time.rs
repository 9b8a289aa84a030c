//! Time of samples: units, grids, resampling, time zero.
//!
//! The uniform time grid of printed time stamps.
//!
//! Printed times are rounded, so neither their differences nor `(t_last - t_first)/(n - 1)` is the recorder's interval
//! to the last bit. The rule here: the interval is the decimal number with the fewest significant digits that agrees
//! with the first and the last stamp within their printed resolution `q`, i.e. within `q/(n - 1)`; for up to six
//! digits, within 1e-12 of it at least. Stamps `-0.0200, -0.0199, ...` give exactly `1e-4` s; stamps with 18 digits at
//! 20.0027797 us keep what they say. The first stamp is taken as printed.
//!
//! A record is uniform if every step differs from the interval by less than 1e-3 of it (crash-pulse practice for
//! filtering), or if the stamps are coarsely printed (`q` up to half an interval) and every stamp lies within `q` of
//! the grid: 16 kHz printed to the microsecond.
//!
//! Samples at uneven times on a uniform grid, by linear interpolation, where a person asks for it (`--resample`).
//!
//! Between two samples the signal is taken for a straight line: the error is up to h²/8 times the second derivative, h
//! the step. Frequencies near half the rate are damped; nothing is filtered.

use crumple_metrics::held_crossing;
use crumple_signal::unit::{Dimension, choices, factor};
use crumple_signal::value::Frequency;
use crumple_signal::{About, Notes, STANDARD_GRAVITY_M_PER_S2, Sampled, SignalError, Weight};

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
    notes.info(format!(
        "no unit of time is stated for {whose}: {symbol} is assumed, because the steps are {step:.6}. --time-unit \
         overrides"
    ));
    Ok(factor)
}

/// What to add where the steps do not tell the unit: each unit with the rate that it gives, if that is one of a
/// recorder, 1 Hz (a slow logger) to 4 MHz.
fn units_by_rate(step: f64) -> String {
    let rates = ["s", "ms", "us"].into_iter().filter_map(|symbol| {
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

/// Largest accepted deviation of a step from the interval, as a fraction of it.
pub const STEP_TOLERANCE: f64 = 1e-3;

/// A uniform grid and how well the stamps fit it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Time of the first sample, s.
    pub t0_s: f64,
    /// Interval, s.
    pub dt_s: f64,
    /// Largest distance of a stamp from the grid, in intervals.
    pub jitter: f64,
}

/// Why stamps do not form a grid. `index` is that of the later of two samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GridError {
    /// A stamp equals the one before.
    Repeated { index: usize },
    /// A stamp is earlier than the one before.
    Backwards { index: usize },
    /// A step is too far from the interval of the record.
    Uneven { index: usize, step_s: f64, dt_s: f64 },
}

/// Fits a grid to time stamps in seconds, at least two. `resolution_s` is the printed resolution of the stamps.
pub fn fit(times_s: &[f64], resolution_s: f64) -> Result<Grid, GridError> {
    for (k, pair) in times_s.windows(2).enumerate() {
        if pair[1] <= pair[0] {
            let index = k + 1;
            let is_repeated = pair[1] == pair[0];
            return Err(if is_repeated { GridError::Repeated { index } } else { GridError::Backwards { index } });
        }
    }
    let n = times_s.len();
    let (first, last) = (times_s[0], times_s[n - 1]);
    let largest = first.abs().max(last.abs());
    // Two units in the last place for the parse of each end.
    let resolution = resolution_s.max(2.0 * f64::EPSILON * largest);
    let steps = (n - 1) as f64;
    let dt = shortest((last - first) / steps, resolution / steps);
    let mut jitter = 0.0_f64;
    let mut worst_step = (0, 0.0_f64);
    for (k, time) in times_s.iter().enumerate() {
        jitter = jitter.max((time - (first + k as f64 * dt)).abs());
        if k > 0 {
            let off = (time - times_s[k - 1] - dt).abs();
            if off > worst_step.1 {
                worst_step = (k, off);
            }
        }
    }
    let even = worst_step.1 <= STEP_TOLERANCE * dt + 4.0 * f64::EPSILON * largest;
    let coarse = resolution <= 0.5 * dt && jitter <= resolution * (1.0 + 1e-6);
    if !(even || coarse) {
        let index = worst_step.0;
        let (step_s, dt_s) = (times_s[index] - times_s[index - 1], median_step(times_s));
        return Err(GridError::Uneven { index, step_s, dt_s });
    }
    Ok(Grid { t0_s: first, dt_s: dt, jitter: jitter / dt })
}

/// The decimal number with the fewest significant digits within `tolerance` of `x` (positive); `x` itself if none is.
///
/// A number of up to six digits is also taken within 1e-12 of `x`: stamps made by adding up the interval carry that
/// much rounding even where they are printed to 18 digits.
fn shortest(x: f64, tolerance: f64) -> f64 {
    (0..17)
        .filter_map(|digits| format!("{x:.digits$e}").parse::<f64>().ok().map(|round| (digits, round)))
        .find(|(digits, round)| {
            let slack = if *digits < 6 { tolerance.max(1e-12 * x) } else { tolerance };
            (round - x).abs() <= slack && *round > 0.0
        })
        .map_or(x, |(_, round)| round)
}

/// Median of the steps, s; of a million steps spread evenly over a longer record.
pub fn median_step(times_s: &[f64]) -> f64 {
    let stride = (times_s.len() >> 20).max(1);
    let mut steps: Vec<f64> = times_s.windows(2).step_by(stride).map(|pair| pair[1] - pair[0]).collect();
    if steps.is_empty() {
        return 0.0;
    }
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Most samples that resampling may make.
const RESAMPLED_LIMIT: f64 = 1e8;

/// Largest distance of a stamp from the grid of its mean step, in steps.
pub fn jitter(times: &[f64]) -> f64 {
    let n = times.len();
    let dt = (times[n - 1] - times[0]) / (n - 1) as f64;
    times.iter().enumerate().map(|(k, t)| (t - times[0] - k as f64 * dt).abs() / dt).fold(0.0, f64::max)
}

/// Largest difference of a step from the median step, as a fraction of that.
pub fn step_jitter(times: &[f64], median_s: f64) -> f64 {
    times.windows(2).map(|pair| (pair[1] - pair[0] - median_s).abs() / median_s).fold(0.0, f64::max)
}

/// A rate in Hz near that of the steps, with three digits at most, to be typed.
pub fn rate_to_type(step_s: f64) -> f64 {
    let rate = 1.0 / step_s;
    let unit = 10_f64.powf((rate.log10().floor() - 2.0).max(0.0));
    ((rate / unit).round() * unit).max(1.0)
}

/// For each instant of a uniform grid from the first sample on: the sample before it, and the part of the way to the
/// next.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearInterpolation {
    positions: Vec<usize>,
    parts: Vec<f64>,
}

impl LinearInterpolation {
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Values on the grid from `count` samples, up to the last instant they reach.
    pub fn apply(&self, count: usize, read: impl Fn(usize) -> f64) -> Vec<f64> {
        let inside = self.positions.iter().zip(&self.parts).take_while(|(k, _)| **k + 1 < count);
        inside.map(|(k, part)| read(*k) + part * (read(k + 1) - read(*k))).collect()
    }
}

/// The interpolation from `times`, which increase, at `rate_hz`; `None` if that gives no usable number of samples.
pub fn resample(times: &[f64], rate_hz: f64) -> Option<LinearInterpolation> {
    let span = times[times.len() - 1] - times[0];
    let count = (span * rate_hz + 1e-9).floor() + 1.0;
    if !(rate_hz > 0.0 && (2.0..=RESAMPLED_LIMIT).contains(&count)) {
        return None;
    }
    let (mut positions, mut parts) = (Vec::new(), Vec::new());
    let mut k = 0;
    for i in 0..count as usize {
        let t = times[0] + i as f64 / rate_hz;
        while k + 2 < times.len() && times[k + 1] <= t {
            k += 1;
        }
        positions.push(k);
        parts.push(((t - times[k]) / (times[k + 1] - times[k])).clamp(0.0, 1.0));
    }
    Some(LinearInterpolation { positions, parts })
}

/// Stamps on a uniform grid.
#[derive(Debug)]
pub struct OnGrid {
    pub grid: Grid,
    /// How samples are brought to it; `None` where they lie on it.
    pub interpolation: Option<LinearInterpolation>,
    /// To which rate they are brought, and how uneven they were.
    pub words: String,
    /// It was not asked for: only a list takes such samples.
    pub lacks_a_rate: bool,
}

/// The grid of stamps, in s, at least two, that increase: as they are, or at the rate of `--resample`; for a list at
/// the median of uneven steps. `place` is that of a stamp. Errors: uneven ones, where no rate is asked for.
pub fn on_grid(
    times: &[f64],
    resolution_s: f64,
    settings: &IngestSettings,
    place: impl Fn(usize) -> Place,
) -> Result<OnGrid> {
    let median_s = median_step(times);
    let jitter_of_steps = || step_jitter(times, median_s);
    let advised = rate_to_type(median_s);
    let rate = match (settings.resample, fit(times, resolution_s)) {
        (Some(rate), _) => rate,
        (None, Ok(grid)) => {
            return Ok(OnGrid { grid, interpolation: None, words: String::new(), lacks_a_rate: false });
        }
        (None, Err(GridError::Uneven { .. })) if settings.listing => Frequency::from_si(1.0 / median_s),
        (None, Err(GridError::Uneven { index, step_s, dt_s })) => {
            let jitter = format!("jitter, max|dt - median|/median: {:.3}", jitter_of_steps());
            let found = format!("a step of {step_s:.9} s, where the median is {dt_s:.9} s ({jitter})");
            let expected = format!("equal steps within {STEP_TOLERANCE} of the interval");
            let hint = format!(
                "a gap is better exported again; for uneven sampling --resample {advised}Hz brings it to a uniform \
                 rate by linear interpolation"
            );
            return refuse(place(index), found, expected, hint);
        }
        (None, Err(GridError::Repeated { index } | GridError::Backwards { index })) => {
            return refuse(place(index), "a time that does not increase", "times that do", "sort them");
        }
    };
    let interpolation = resample(times, rate.si()).ok_or_else(|| {
        IngestError::content(
            place(0),
            format!("--resample {rate} gives no usable number of samples"),
            "a rate near that of the samples",
            format!("give --resample {advised}Hz"),
        )
    })?;
    let words = format!(
        "to {rate} by linear interpolation, as asked: {} samples (jitter {:.3}, max|dt - median|/median, median \
         {median_s:.6} s)",
        interpolation.len(),
        jitter_of_steps()
    );
    let grid = Grid { t0_s: times[0], dt_s: 1.0 / rate.si(), jitter: jitter(times) };
    Ok(OnGrid { grid, interpolation: Some(interpolation), words, lacks_a_rate: settings.resample.is_none() })
}

/// Times of a calendar are larger than this, s (three years); they count from the first one.
pub const CALENDAR_S: f64 = 1e8;

/// Takes the first one from times of a calendar, in a unit of `unit_s`: their differences keep what the numbers
/// resolve. Returns what was taken, s; `None` where the times are small.
pub fn from_first(times: &mut [f64], unit_s: f64, resolution_s: &mut f64) -> Option<f64> {
    // 3000 years: what is larger is no date.
    let first = *times.first().filter(|first| (CALENDAR_S..1e11).contains(&(first.abs() * unit_s)))?;
    // Two units in the last place of the numbers, which a calendar makes coarse.
    *resolution_s += 2.0 * f64::EPSILON * first.abs() * unit_s;
    times.iter_mut().for_each(|t| *t -= first);
    Some(first * unit_s)
}

/// `x * factor`, by division where that is exact: 20 ms are 0.02 s to the last bit.
pub fn scale(times: &mut [f64], factor: f64) {
    let inverse = (1.0 / factor).round();
    times.iter_mut().for_each(|t| if factor < 1.0 { *t /= inverse } else { *t *= factor });
}

/// Level of the threshold rule, m/s^2 (0.5 g).
const THRESHOLD_M_PER_S2: f64 = 0.5 * STANDARD_GRAVITY_M_PER_S2;
/// Held for 3 ms it changes the velocity by 106 km/h, over a crush of 44 mm: no structure of a vehicle does.
const IMPLAUSIBLE_M_PER_S2: f64 = 1e3 * STANDARD_GRAVITY_M_PER_S2;
/// The same samples with the file's time `zero_s` as t = 0.
pub fn shift(wave: &Sampled, zero_s: f64) -> Result<Sampled, SignalError> {
    // To the picosecond, so that 0.02 - 0.012 is 0.008.
    wave.starting_at(((wave.t0_s() - zero_s) * 1e12).round() / 1e12)
}

/// A note if the smoothed pulse rises clearly before or after t = 0.
pub fn check(pulse: &Sampled, zero_level: Option<f64>, notes: &mut Notes) {
    let zero_level = zero_level.unwrap_or(0.0);
    let crossing = |m_per_s2: f64| held_crossing(pulse, zero_level, m_per_s2);
    let largest = pulse.samples().iter().fold(0.0_f64, |largest, a| largest.max((a - zero_level).abs()));
    if largest >= IMPLAUSIBLE_M_PER_S2 && crossing(IMPLAUSIBLE_M_PER_S2).is_some() {
        let largest_g = largest / STANDARD_GRAVITY_M_PER_S2;
        let text = format!(
            "the pulse stays above 1000 g for 3 ms (largest {largest_g:.0} g), no vehicle does: check its channel and \
             unit"
        );
        notes.concern(About::Pulse, Weight::Decisive, text);
    }
    if crossing(THRESHOLD_M_PER_S2).is_none() {
        notes.concern(
            About::Pulse,
            Weight::Decisive,
            "the pulse never exceeds 0.5 g for 3 ms: check its channel and unit",
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn printed(t0: f64, dt: f64, n: usize, decimals: usize) -> Vec<f64> {
        (0..n).map(|k| format!("{:.decimals$}", t0 + k as f64 * dt).parse().unwrap()).collect()
    }

    #[test]
    fn printed_rates_come_back_exactly() {
        for (dt, decimals) in [(1e-4, 4), (1e-4, 6), (5e-5, 5), (6.25e-5, 6), (1e-3, 3), (1e-6, 6), (1.25e-5, 7)] {
            let grid = fit(&printed(-0.02, dt, 2701, decimals), 10_f64.powf(-(decimals as f64))).unwrap();
            assert_eq!((grid.t0_s, grid.dt_s), (-0.02, dt), "{decimals} decimals");
        }
    }

    #[test]
    fn an_odd_interval_is_kept() {
        let dt = 2.000_277_970_813_059_3e-5;
        let times: Vec<f64> = (0..1439).map(|k| k as f64 * dt).collect();
        let grid = fit(&times, 1e-20).unwrap();
        // The ends are rounded to half a unit in the last place each.
        assert!((grid.dt_s / dt - 1.0).abs() < 4.0 * f64::EPSILON, "{}", grid.dt_s);
    }

    #[test]
    fn a_missing_sample_is_found_however_coarse_the_print() {
        for decimals in [4, 6] {
            let mut times = printed(0.0, 1e-4, 2000, decimals);
            times.remove(1000);
            let error = fit(&times, 10_f64.powf(-(decimals as f64))).unwrap_err();
            assert!(matches!(error, GridError::Uneven { index: 1000, .. }), "{error:?}");
        }
    }

    #[test]
    fn order_is_checked_first() {
        assert_eq!(fit(&[0.0, 1.0, 1.0, 2.0], 1e-3), Err(GridError::Repeated { index: 2 }));
        assert_eq!(fit(&[0.0, 1.0, 0.5, 2.0], 1e-3), Err(GridError::Backwards { index: 2 }));
    }

    #[test]
    fn resampling_is_linear_and_keeps_the_ends() {
        let times = [0.0, 0.9, 2.1, 3.0];
        let interpolation = resample(&times, 1.0).unwrap();
        // A straight line comes back exactly but for rounding.
        let line = interpolation.apply(4, |k| times[k]);
        assert!(line.iter().enumerate().all(|(k, t)| (t - k as f64).abs() < 1e-15), "{line:?}");
        assert_eq!((interpolation.len(), resample(&times, 0.0), resample(&times, 1e30)), (4, None, None));
        // A channel that ends early is not prolonged.
        assert_eq!(interpolation.apply(3, |k| times[k]).len(), 3);
    }

    #[test]
    fn the_jitter_is_that_of_steps_against_their_median() {
        let times = [0.0, 1.0, 2.0, 3.25, 4.0];
        assert_eq!(step_jitter(&times, 1.0), 0.25);
        assert_eq!((rate_to_type(1.0003e-4), rate_to_type(0.0499), rate_to_type(7.0)), (10_000.0, 20.0, 1.0));
    }

    #[test]
    fn a_shift_keeps_round_times() {
        let wave = Sampled::new(0.02, 1e-4, vec![0.0; 10]).unwrap();
        assert_eq!(shift(&wave, 0.012).unwrap().t0_s(), 0.008);
    }

    #[test]
    fn the_zero_level_agrees_with_another_implementation() {
        // 0.35 g offset, half sine of -22 g and 90 ms from t = 0, 10 kHz from -50 ms; an independent script gives 0.35
        // g from 401 samples.
        let g = STANDARD_GRAVITY_M_PER_S2;
        let at = |t: f64| {
            0.35 - if (0.0..=0.09).contains(&t) { 22.0 * (std::f64::consts::PI * t / 0.09).sin() } else { 0.0 }
        };
        let wave = Sampled::new(-0.05, 1e-4, (0..2501).map(|k| g * at(f64::from(k - 500) * 1e-4)).collect()).unwrap();
        let pre = crate::recording::content::measure(&wave, 0.0, true).pre_event.unwrap();
        assert!((pre.zero_level / g - 0.35).abs() < 1e-9 && pre.samples == 401);
    }
}
