use crumple_signal::{Notes, Sampled};
use serde::Serialize;

use crate::{Cfc, Class, Coefficients, FilterError, Mode, ZeroLevel, filter_both_ways, pre_event, samples_added};

/// How channels are filtered.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Settings {
    /// Class to filter to; default CFC 60.
    #[serde(rename = "cfc")]
    pub class: Class,
    /// Standard; default ISO 6487.
    pub mode: Mode,
    /// Zero level; default: the mean before the event is removed.
    pub zero_level: ZeroLevel,
}

impl Default for Settings {
    fn default() -> Self {
        Self { class: Class::Cfc(Cfc::Cfc60), mode: Mode::default(), zero_level: ZeroLevel::default() }
    }
}

/// The filter that was run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Applied {
    /// Its class.
    pub cfc: Cfc,
    /// Its difference equation, and the standard it was made after.
    pub coefficients: Coefficients,
    /// Samples mirrored at each end.
    pub samples_added: usize,
}

/// A filtered channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Filtered {
    /// The result, on the grid of the record.
    pub samples: Sampled,
    /// The filter; `None`: none was asked for, or the channel is already of the class or a lower one.
    pub applied: Option<Applied>,
    /// Zero level that was subtracted before filtering, unit of the samples.
    pub zero_level_removed: f64,
    /// What a reader should know.
    pub notes: Notes,
}

/// Removes the zero level of a channel, then filters it to a class.
///
/// `already_cfc` is the class the channel carries. One at or below the class asked for passes through with a note:
/// filtering again would lower its cut-off, and nothing brings lost frequencies back. Without 10 ms of pre-event data
/// the zero level is left alone, with a warning. Refuses a sampling rate below ten times the class (SAE J211-1),
/// notes one below twenty times.
pub fn filter(samples: &Sampled, already_cfc: Option<u16>, settings: &Settings) -> Result<Filtered, FilterError> {
    let mut notes = Notes::new();
    let zero_level_removed = zero_level(samples, settings.zero_level, &mut notes)?;

    let cfc = match (settings.class, already_cfc) {
        (Class::Cfc(cfc), Some(already)) if already <= cfc.number() => {
            notes.info(format!("already cfc {already}, passed through unfiltered"));
            None
        }
        (Class::Cfc(cfc), _) => Some(cfc),
        (Class::None, _) => None,
    };
    let (values, applied) = match cfc {
        Some(cfc) => {
            check_rate(samples, cfc)?;
            let coefficients = Coefficients::new(cfc, settings.mode, samples.dt_s());
            note_low_rate(samples, cfc, &coefficients, &mut notes);
            let output = filter_both_ways(samples.samples(), zero_level_removed, &coefficients)?;
            (output, Some(Applied { cfc, coefficients, samples_added: samples_added(samples.len(), &coefficients) }))
        }
        None => (samples.samples().iter().map(|x| x - zero_level_removed).collect(), None),
    };
    let samples = Sampled::new(samples.t0_s(), samples.dt_s(), values).map_err(FilterError::Result)?;
    Ok(Filtered { samples, applied, zero_level_removed, notes })
}

fn zero_level(samples: &Sampled, rule: ZeroLevel, notes: &mut Notes) -> Result<f64, FilterError> {
    let ZeroLevel::PreEvent(window) = rule else { return Ok(0.0) };
    match pre_event(samples, window)? {
        Some(found) => Ok(found.mean),
        None => {
            notes.warning(format!(
                "zero level not removed: less than 10 ms of data between {:.1} ms and {:.1} ms",
                1e3 * window.from_s,
                1e3 * window.to_s
            ));
            Ok(0.0)
        }
    }
}

fn check_rate(samples: &Sampled, cfc: Cfc) -> Result<(), FilterError> {
    let (rate_hz, needed_hz) = (samples.rate_hz(), cfc.lowest_rate_hz());
    // An interval typed in decimals gives a rate that is off by its last digit.
    if rate_hz < needed_hz * (1.0 - 1e-9) {
        return Err(FilterError::Rate { rate_hz, cfc, needed_hz });
    }
    Ok(())
}

fn note_low_rate(samples: &Sampled, cfc: Cfc, coefficients: &Coefficients, notes: &mut Notes) {
    let ratio = samples.rate_hz() / cfc.frequency_hz();
    if ratio < 20.0 * (1.0 - 1e-9) {
        notes.info(format!(
            "sampling rate {:.0} Hz is only {ratio:.1} times cfc {cfc}: \
             the -3 dB point lies at {:.1} Hz instead of {:.1} Hz",
            samples.rate_hz(),
            coefficients.half_power_frequency_hz(),
            cfc.frequency_hz() / 0.6,
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(rate_hz: f64, n: usize) -> Sampled {
        let dt_s = 1.0 / rate_hz;
        Sampled::new(-0.05, dt_s, (0..n).map(|k| 3.0 - (0.1 * k as f64).sin()).collect()).unwrap()
    }

    #[test]
    fn refuses_400_hz_for_cfc_60_with_the_rate_it_needs() {
        let error = filter(&record(400.0, 200), None, &Settings::default()).unwrap_err();
        assert_eq!(
            error.to_string(),
            "sampling rate 400 Hz is too low for cfc 60: at least 600 Hz (10 times the class) is needed"
        );
    }

    #[test]
    fn takes_exactly_ten_times_the_class_and_notes_it() {
        let notes = filter(&record(600.0, 200), None, &Settings::default()).unwrap().notes.to_texts();
        assert_eq!(
            notes,
            ["sampling rate 600 Hz is only 10.0 times cfc 60: the -3 dB point lies at 105.4 Hz instead of 100.0 Hz"]
        );
        assert!(filter(&record(1200.0, 200), None, &Settings::default()).unwrap().notes.is_empty());
    }

    #[test]
    fn a_channel_of_the_class_or_below_passes_through_and_one_above_is_filtered() {
        let raw = record(10_000.0, 2000);
        let untouched = Settings { zero_level: ZeroLevel::None, ..Settings::default() };
        for already in [30, 60] {
            let result = filter(&raw, Some(already), &untouched).unwrap();
            assert_eq!(result.samples, raw);
            assert_eq!(result.notes.to_texts(), [format!("already cfc {already}, passed through unfiltered")]);
        }
        let result = filter(&raw, Some(180), &untouched).unwrap();
        assert_eq!(result.applied.map(|applied| applied.cfc), Some(Cfc::Cfc60));
        assert_ne!(result.samples, raw);
    }

    #[test]
    fn no_class_only_removes_the_zero_level() {
        let raw = Sampled::new(-0.05, 1e-3, vec![2.5; 100]).unwrap();
        let result = filter(&raw, None, &Settings { class: Class::None, ..Settings::default() }).unwrap();
        assert_eq!((result.zero_level_removed, result.applied), (2.5, None));
        assert!(result.samples.samples().iter().all(|x| *x == 0.0));
    }

    #[test]
    fn a_record_without_pre_event_data_keeps_its_zero_level_with_a_warning() {
        let raw = Sampled::new(0.0, 1e-4, vec![2.5; 100]).unwrap();
        let result = filter(&raw, None, &Settings::default()).unwrap();
        assert_eq!(result.zero_level_removed, 0.0);
        assert_eq!(
            result.notes.to_texts(),
            ["warning: zero level not removed: less than 10 ms of data between -50.0 ms and -10.0 ms"]
        );
    }

    #[test]
    fn samples_near_the_largest_number_are_an_error_and_no_infinity() {
        let raw = Sampled::new(0.0, 1e-4, vec![f64::MAX, -f64::MAX, f64::MAX, -f64::MAX, f64::MAX]).unwrap();
        assert!(matches!(filter(&raw, None, &Settings::default()), Err(FilterError::Result(_))));
    }
}
