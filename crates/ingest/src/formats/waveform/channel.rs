//! A waveform as a LabVIEW or DIAdem file has it.

use crate::formats::text::column_names::Unit;
use crate::formats::waveform::label::{is_named_time, label};

/// An instant by the clock of a recorder, in two parts: one number of seconds since 1904 resolves half a microsecond.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instant {
    /// Whole seconds since the epoch of the file.
    pub seconds: i64,
    /// What is added to them, s.
    pub fraction_s: f64,
}

impl Instant {
    /// Seconds from `earlier` to this instant.
    pub fn since(self, earlier: Self) -> f64 {
        self.seconds.wrapping_sub(earlier.seconds) as f64 + (self.fraction_s - earlier.fraction_s)
    }

    /// The instant `s` seconds later.
    #[must_use]
    pub fn plus(self, s: f64) -> Self {
        Self { fraction_s: self.fraction_s + s, ..self }
    }
}

/// A channel as its file has it.
#[derive(Debug, Clone)]
pub struct Waveform {
    /// Its group; empty where the format has none.
    pub group: String,
    /// Its name, perhaps with the unit.
    pub name: String,
    /// The unit as stated; empty: not stated, or in the name.
    pub unit: String,
    /// Time of the first sample and the interval, in the unit of the X axis.
    pub steps: Option<(f64, f64)>,
    /// Factor of the unit of the X axis to s.
    pub step_unit_s: f64,
    /// When the time of the steps is 0, where the file says it.
    pub origin: Option<Instant>,
    /// The samples are stamps of a clock, in s from this one on.
    pub first_stamp: Option<Instant>,
    /// What the steps are steps of, if not of time.
    pub not_time: Option<String>,
    /// A remark.
    pub comment: Option<String>,
    /// The samples, or why they are not to be had.
    pub values: Result<Vec<f64>, String>,
}

impl Waveform {
    /// A channel without samples.
    pub fn new(group: impl Into<String>, name: impl Into<String>) -> Self {
        Self {
            group: group.into(),
            name: name.into(),
            unit: String::new(),
            steps: None,
            step_unit_s: 1.0,
            origin: None,
            first_stamp: None,
            not_time: None,
            comment: None,
            values: Ok(Vec::new()),
        }
    }

    /// Takes start and interval of the X axis (`wf_start_offset`, `wf_increment`) for time, in s unless another unit of
    /// time is stated. An axis with the unit or the name of something else is none of time.
    pub fn set_steps(&mut self, steps: Option<(f64, f64)>, x_name: &str, x_unit: &str) {
        if steps.is_none() {
            return;
        }
        let axis = label(x_name, x_unit);
        let says_nothing = x_unit.is_empty() && (x_name.is_empty() || x_name.to_lowercase().starts_with('x'));
        match axis.unit {
            Unit::Time(factor) => (self.steps, self.step_unit_s) = (steps, factor),
            Unit::Unstated if says_nothing || is_named_time(&axis.name) => self.steps = steps,
            _ => {
                let unit = if x_unit.is_empty() { String::new() } else { format!(" in {x_unit}") };
                self.not_time = Some(format!("its X axis is {x_name:?}{unit}, not time"));
            }
        }
    }
}

impl Waveform {
    /// Takes the samples, times of the day, for times in s from the first one on, which is at `first`.
    pub fn set_stamps(&mut self, first: Option<Instant>) {
        let Some(first) = first else { return };
        self.first_stamp = Some(first);
        "s".clone_into(&mut self.unit);
    }
}

/// Names with commas between, at most 12.
pub fn list<S: AsRef<str>>(names: &[S]) -> String {
    let shown: Vec<&str> = names.iter().take(12).map(AsRef::as_ref).collect();
    let more = names.len() - shown.len();
    if more == 0 { shown.join(", ") } else { format!("{} and {more} more", shown.join(", ")) }
}
