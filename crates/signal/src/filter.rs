//! Filters one channel: zero level, sampling rate, filter, and what a reader should know.

use serde::Serialize;

use crate::butterworth::sections_extension;
use crate::zero_phase::Report;
use crate::{
    About, Butterworth, Cfc, CfcMode, Class, Coefficients, CorridorPoint, Design, FilterError, Notes, Phase,
    PreEventWindow, STANDARD_GRAVITY_M_PER_S2, Sampled, Weight, corridor, filter_both_ways_into, pre_event_within,
    remarks, run_sections, samples_added,
};

/// What is done about the zero level of a channel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ZeroLevel {
    /// The samples stay as they are.
    None,
    /// The mean of the pre-event samples is subtracted.
    PreEvent(PreEventWindow),
    /// Of an acceleration in free fall before the event its level at rest, which is subtracted
    /// ([`moving_start`](crate::moving_start)).
    AtRest(f64),
}

impl Default for ZeroLevel {
    fn default() -> Self {
        Self::PreEvent(PreEventWindow::USUAL)
    }
}

/// How channels are filtered.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FilterSettings {
    /// Class to filter to; default CFC 60.
    #[serde(rename = "cfc")]
    pub class: Class,
    /// Standard; default ISO 6487.
    pub mode: CfcMode,
    /// Zero level; default: the mean before the event is removed.
    pub zero_level: ZeroLevel,
    /// A filter in the place of the class; default: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub butterworth: Option<Butterworth>,
}

impl Default for FilterSettings {
    fn default() -> Self {
        Self {
            class: Class::Cfc(Cfc::Cfc60),
            mode: CfcMode::default(),
            zero_level: ZeroLevel::default(),
            butterworth: None,
        }
    }
}

/// The filter that was run.
#[derive(Debug, Clone, PartialEq)]
pub enum Applied {
    /// That of a class.
    Class {
        /// The class.
        cfc: Cfc,
        /// Its difference equation, and the standard it was made after.
        coefficients: Coefficients,
        /// Samples mirrored at each end.
        samples_added: usize,
    },
    /// A Butterworth filter.
    Butterworth {
        /// Its sections.
        design: Design,
        /// Samples mirrored at each end.
        samples_added: usize,
    },
}

impl Applied {
    /// The class, if it is the filter of one.
    pub fn cfc(&self) -> Option<Cfc> {
        match self {
            Self::Class { cfc, .. } => Some(*cfc),
            _ => None,
        }
    }

    /// Samples mirrored at each end.
    pub fn samples_added(&self) -> usize {
        match self {
            Self::Class { samples_added, .. } | Self::Butterworth { samples_added, .. } => *samples_added,
        }
    }

    /// The name used in artifacts.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Class { coefficients, .. } => coefficients.mode().name(),
            Self::Butterworth { .. } => "butterworth-low",
        }
    }

    /// How it was run.
    pub fn phase(&self) -> Phase {
        match self {
            Self::Butterworth { design, .. } => design.asked.phase,
            Self::Class { .. } => Phase::Zero,
        }
    }
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

/// Removes the zero level of a channel, then filters it: to a class, or by the filter that takes its place.
///
/// The zero level goes first: the filter is linear, but the extension of the ends and the start of a pass react to an
/// offset. The result has the grid of `samples` and their unit.
///
/// `already_cfc` is the class the channel carries. One at or below the class asked for passes through with a note:
/// filtering again would lower its cut-off, and nothing brings lost frequencies back. Without 10 ms of pre-event data
/// the zero level is left alone, with a warning. Refuses a sampling rate below ten times the class (SAE J211-1),
/// notes one below twenty times, warns of a response outside the limits of the class. With
/// [`FilterSettings::butterworth`] the class is not looked at: neither the one asked for nor the one the channel
/// carries.
///
/// The area of the record is kept but for its ends: the crush from CFC 60 and from CFC 180 agrees within 0.2 mm on
/// four real channels. Rounding is about 1e-13 of the largest sample.
///
/// # Errors
/// A zero-level window that ends before it starts; a rate below ten times the class; fewer than four samples; a
/// Butterworth filter that cannot be designed ([`Butterworth::design`]); samples so large that the result is not
/// finite.
pub fn filter(samples: &Sampled, already_cfc: Option<u16>, settings: &FilterSettings) -> Result<Filtered, FilterError> {
    filter_reporting(samples, already_cfc, settings, &|_| ())
}

/// [`filter`] with a report of progress: a record of n samples is 2·n of work, one n for each pass. A filter that takes
/// the place of the class, and a channel that passes through, report all of it at the end.
pub fn filter_reporting(
    samples: &Sampled,
    already_cfc: Option<u16>,
    settings: &FilterSettings,
    report: Report<'_>,
) -> Result<Filtered, FilterError> {
    let mut notes = Notes::new();
    let zero_level_removed = zero_level(samples, settings.zero_level, &mut notes)?;
    let results = |values| Sampled::new(samples.t0_s(), samples.dt_s(), values).map_err(FilterError::Result);
    if let Some(asked) = settings.butterworth {
        let design = asked.design(samples.dt_s())?;
        if asked.phase == Phase::Causal {
            notes.push(Causal {});
        }
        let filtered = results(run_sections(samples.samples(), zero_level_removed, &design))?;
        report(2 * samples.len() as u64);
        let samples_added = sections_extension(samples.len(), &design);
        let applied = Some(Applied::Butterworth { design, samples_added });
        return Ok(Filtered { samples: filtered, applied, zero_level_removed, notes });
    }

    let cfc = match (settings.class, already_cfc) {
        (Class::Cfc(cfc), Some(already)) if already <= cfc.number() => {
            notes.push(AlreadyFiltered { class: already });
            None
        }
        (Class::Cfc(cfc), _) => Some(cfc),
        (Class::None, _) => None,
    };
    let Some(cfc) = cfc else {
        report(2 * samples.len() as u64);
        let samples = match zero_level_removed {
            0.0 => samples.clone(),
            zero => results(samples.samples().iter().map(|x| x - zero).collect())?,
        };
        return Ok(Filtered { samples, applied: None, zero_level_removed, notes });
    };
    check_rate(samples, cfc)?;
    let coefficients = Coefficients::new(cfc, settings.mode, samples.dt_s());
    note_low_rate(samples, cfc, &coefficients, &mut notes);
    for point in corridor(cfc, &coefficients).iter().filter(|point| !point.is_inside()) {
        let CorridorPoint { gain_db, frequency_hz, lower_db, upper_db } = *point;
        notes.push(OutsideCorridor { class: cfc.number(), gain_db, frequency_hz, lower_db, upper_db });
    }
    let mut output = Vec::new();
    filter_both_ways_into(samples.samples(), zero_level_removed, &coefficients, &mut output, report)?;
    let applied = Applied::Class { cfc, coefficients, samples_added: samples_added(samples.len(), &coefficients) };
    Ok(Filtered { samples: results(output)?, applied: Some(applied), zero_level_removed, notes })
}

remarks! {
    /// Remarks of filters.
    pub REMARKS;

    /// The filter runs one way, so that events come late.
    CR210 Causal {}
    bears on (About::Motion, Weight::Marked)
    decided "The pipeline asks for it (filter.phase). ISO 6487 and SAE J211-1 filter forward and backward."
    means "Times and crush are not those of the vehicle: every event is late by the delay of the filter."
    remedy "leave filter.phase out, unless an on-line filter is to be imitated"
    says "the filter is causal: events come late, times and crush are not those of the vehicle";

    /// The channel was filtered to this class, or a lower one, before it was recorded.
    CR211 AlreadyFiltered { class: u16 }
    bears on (About::Pulse, Weight::None)
    decided "The file states the class of the channel (ISO 13499, NHTSA)."
    means "Filtering it again would lower its peaks. It passes through as it is."
    remedy "nothing; --cfc with a lower class filters further"
    says format!("already CFC {class}, passed through unfiltered");

    /// The response of the filter leaves the corridor of its class.
    CR212 OutsideCorridor {
        class: u16, gain_db: f64, frequency_hz: f64, lower_db: Option<f64>, upper_db: f64
    }
    bears on (About::Pulse, Weight::Slight)
    decided "The gain of both passes at the sampling rate is compared with the limits of SAE J211-1."
    means "Peaks differ from those of another laboratory by as much as the gain does."
    remedy "record faster, or take the coefficients of the standard: filter.mode"
    says {
        let lower = lower_db.map_or_else(|| "none".to_owned(), |lower| format!("{lower:+.1}"));
        format!(
            "response {gain_db:.2} dB at {frequency_hz:.1} Hz is outside the limits of CFC {class} ({lower} to \
             {upper_db:+.1} dB)"
        )
    };

    /// The vehicle falls or brakes before contact, and zero is the level at rest.
    CR213 LevelAtRest { level_g: f64 }
    bears on (About::Pulse, Weight::None)
    decided "Ingest found an acceleration before contact that is one of gravity or of braking, and a level before it."
    means "The mean before contact would be taken for an error of the sensor, and the crush would be wrong by it."
    remedy "nothing; --zero-level none keeps all of it"
    says format!("it falls or brakes before contact: zero is the level at rest, {level_g:+.2} g");

    /// The first samples are exactly zero: the recorder was muted.
    CR214 Muted { samples: usize }
    bears on (About::Pulse, Weight::None)
    decided "A sensor has noise: a run of samples that are exactly 0 at the beginning was not measured."
    means "These samples are not counted in the zero level."
    remedy "nothing"
    says format!("the first {samples} samples are exactly 0, the recorder was muted: not counted in the zero level");

    /// The zero level was not removed, since too little was recorded before contact.
    CR215 ZeroLevelKept { from_s: f64, to_s: f64 }
    bears on (About::Pulse, Weight::Slight)
    decided "Less than 10 ms of samples lie in the window before contact: a mean of fewer is noise of the sensor."
    means "An offset of the sensor stays in: 0.1 g change the velocity by 0.1 m/s and the crush by 5 mm in 100 ms."
    remedy "state a window that holds samples at rest (filter.zero_level), or take an earlier trigger"
    says format!(
        "zero level not removed: less than 10 ms of data between {:.1} ms and {:.1} ms",
        1e3 * from_s,
        1e3 * to_s
    );

    /// The sampling rate is low for the class, so that the filter is not quite that of the class.
    CR216 LowRate { rate_hz: f64, ratio: f64, class: u16, half_power_hz: f64, of_fast_sampling_hz: f64 }
    bears on (About::Pulse, Weight::None)
    decided "Below twenty times the class the -3 dB point moves by more than 1.3 %; SAE J211-1 asks for ten times."
    means "The filter lets a little more through than that of the same signal sampled faster."
    remedy "record at twenty times the class, or ask for a lower class"
    says format!(
        "the sampling rate {rate_hz:.0} Hz is only {ratio:.1} times CFC {class}: the -3 dB point is at \
         {half_power_hz:.1} Hz instead of {of_fast_sampling_hz:.1} Hz"
    );
}

/// The level to subtract, unit of the samples. 0 with a warning where the record covers less than 10 ms of the window,
/// because a level guessed from the pulse would be worse than none; a muted recorder is noted.
fn zero_level(samples: &Sampled, rule: ZeroLevel, notes: &mut Notes) -> Result<f64, FilterError> {
    let window = match rule {
        ZeroLevel::None => return Ok(0.0),
        ZeroLevel::AtRest(rest_level) => {
            notes.push(LevelAtRest { level_g: rest_level / STANDARD_GRAVITY_M_PER_S2 });
            return Ok(rest_level);
        }
        ZeroLevel::PreEvent(PreEventWindow { from_s, to_s }) if to_s < from_s => {
            return Err(FilterError::Window { from_s, to_s });
        }
        ZeroLevel::PreEvent(window) => window,
    };
    match pre_event_within(samples, window) {
        Some(pre_event) => {
            if pre_event.muted > 0 {
                notes.push(Muted { samples: pre_event.muted });
            }
            Ok(pre_event.zero_level)
        }
        None => {
            notes.push(ZeroLevelKept { from_s: window.from_s, to_s: window.to_s });
            Ok(0.0)
        }
    }
}

/// Refuses a rate below ten times the class, with 1e-9 of slack for the rounding of `1/dt`.
fn check_rate(samples: &Sampled, cfc: Cfc) -> Result<(), FilterError> {
    let (rate_hz, needed_hz) = (samples.rate_hz(), cfc.lowest_rate_hz());
    // An interval typed in decimals gives a rate that is off by its last digit.
    if rate_hz < needed_hz * (1.0 - 1e-9) {
        return Err(FilterError::Rate { rate_hz, cfc, needed_hz });
    }
    Ok(())
}

/// Says, below twenty times the class, where the -3 dB point of both passes lies at this rate (Hz) and where it lies
/// for fast sampling, CFC/0.6: at twenty times it is 1.3 % too high, at ten times 5 %.
fn note_low_rate(samples: &Sampled, cfc: Cfc, coefficients: &Coefficients, notes: &mut Notes) {
    let ratio = samples.rate_hz() / cfc.frequency_hz();
    if ratio < 20.0 * (1.0 - 1e-9) {
        notes.push(LowRate {
            rate_hz: samples.rate_hz(),
            ratio,
            class: cfc.number(),
            half_power_hz: coefficients.half_power_frequency_hz(),
            of_fast_sampling_hz: cfc.frequency_hz() / 0.6,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_a_window_that_ends_before_it_starts() {
        let zero_level = ZeroLevel::PreEvent(PreEventWindow { from_s: -0.01, to_s: -0.05 });
        let settings = FilterSettings { zero_level, ..FilterSettings::default() };
        let error = filter(&record(10_000.0, 2000), None, &settings).unwrap_err();
        assert_eq!(error.to_string(), "the zero level window ends at -0.05 s, before it starts at -0.01 s");
    }

    fn record(rate_hz: f64, n: usize) -> Sampled {
        let dt_s = 1.0 / rate_hz;
        Sampled::new(-0.05, dt_s, (0..n).map(|k| 3.0 - (0.1 * k as f64).sin()).collect()).unwrap()
    }

    #[test]
    fn refuses_400_hz_for_cfc_60_with_the_rate_it_needs() {
        let error = filter(&record(400.0, 200), None, &FilterSettings::default()).unwrap_err();
        assert_eq!(
            error.to_string(),
            "a sampling rate of 400 Hz is too low for CFC 60, which needs at least 600 Hz (10 times the class)"
        );
    }

    #[test]
    fn takes_exactly_ten_times_the_class_and_notes_it() {
        let notes = filter(&record(600.0, 200), None, &FilterSettings::default()).unwrap().notes.to_texts();
        assert_eq!(
            notes,
            ["the sampling rate 600 Hz is only 10.0 times CFC 60: the -3 dB point is at 105.4 Hz instead of 100.0 Hz"]
        );
        assert!(filter(&record(1200.0, 200), None, &FilterSettings::default()).unwrap().notes.is_empty());
    }

    #[test]
    fn a_channel_of_the_class_or_below_passes_through_and_one_above_is_filtered() {
        let raw = record(10_000.0, 2000);
        let untouched = FilterSettings { zero_level: ZeroLevel::None, ..FilterSettings::default() };
        for already in [30, 60] {
            let result = filter(&raw, Some(already), &untouched).unwrap();
            assert_eq!(result.samples, raw);
            assert_eq!(result.notes.to_texts(), [format!("already CFC {already}, passed through unfiltered")]);
        }
        let result = filter(&raw, Some(180), &untouched).unwrap();
        assert_eq!(result.applied.and_then(|applied| applied.cfc()), Some(Cfc::Cfc60));
        assert_ne!(result.samples, raw);
    }

    #[test]
    fn a_butterworth_filter_takes_the_place_of_the_class() {
        let asked = Butterworth { cutoff_hz: 100.0, order: 4, phase: Phase::Causal };
        let settings = FilterSettings { butterworth: Some(asked), ..FilterSettings::default() };
        let result = filter(&record(10_000.0, 2000), Some(60), &settings).unwrap();
        let applied = result.applied.unwrap();
        assert_eq!((applied.name(), applied.phase(), applied.samples_added()), ("butterworth-low", Phase::Causal, 0));
        assert!(result.notes.to_texts()[0].starts_with("warning: the filter is causal"));
    }

    #[test]
    fn no_class_only_removes_the_zero_level() {
        let raw = Sampled::new(-0.05, 1e-3, vec![2.5; 100]).unwrap();
        let result = filter(&raw, None, &FilterSettings { class: Class::None, ..FilterSettings::default() }).unwrap();
        assert_eq!((result.zero_level_removed, result.applied), (2.5, None));
        assert!(result.samples.samples().iter().all(|x| *x == 0.0));
    }

    #[test]
    fn a_record_without_pre_event_data_keeps_its_zero_level_with_a_warning() {
        let raw = Sampled::new(0.0, 1e-4, vec![2.5; 100]).unwrap();
        let result = filter(&raw, None, &FilterSettings::default()).unwrap();
        assert_eq!(result.zero_level_removed, 0.0);
        assert_eq!(
            result.notes.to_texts(),
            ["warning: zero level not removed: less than 10 ms of data between -50.0 ms and -10.0 ms"]
        );
    }

    #[test]
    fn after_a_free_fall_zero_is_the_level_at_rest() {
        let g = STANDARD_GRAVITY_M_PER_S2;
        let level = |k: i32| if k < 500 { -g } else { 0.0 };
        let record = Sampled::new(-0.5, 1e-3, (0..1000).map(level).collect()).unwrap();
        let removed = |zero_level| {
            let settings = FilterSettings { class: Class::None, zero_level, ..FilterSettings::default() };
            let filtered = filter(&record, None, &settings).unwrap();
            (filtered.zero_level_removed, filtered.notes.to_texts())
        };
        let (level, notes) = removed(ZeroLevel::AtRest(0.0));
        assert_eq!(level, 0.0);
        assert_eq!(notes, ["it falls or brakes before contact: zero is the level at rest, +0.00 g"]);
        // Of a force the level before the event is zero, whatever comes after.
        let (level, notes) = removed(ZeroLevel::default());
        assert!((level + g).abs() < 1e-12 && notes.is_empty(), "{notes:?}");
    }

    #[test]
    fn a_muted_start_is_left_out_of_the_zero_level_and_said() {
        let at = |k: usize| if k < 200 { 0.0 } else { 2.5 };
        let raw = Sampled::new(-0.05, 1e-4, (0..3500).map(at).collect()).unwrap();
        let result = filter(&raw, None, &FilterSettings { class: Class::None, ..FilterSettings::default() }).unwrap();
        assert_eq!(result.zero_level_removed, 2.5);
        assert_eq!(
            result.notes.to_texts(),
            ["the first 200 samples are exactly 0, the recorder was muted: not counted in the zero level"]
        );
    }

    #[test]
    fn samples_near_the_largest_number_are_an_error_and_no_infinity() {
        let raw = Sampled::new(0.0, 1e-4, vec![f64::MAX, -f64::MAX, f64::MAX, -f64::MAX, f64::MAX]).unwrap();
        assert!(matches!(filter(&raw, None, &FilterSettings::default()), Err(FilterError::Result(_))));
    }
}
