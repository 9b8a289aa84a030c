//! A waveform as a LabVIEW or DIAdem file has it.

use crate::formats::text::column_names::Unit;
use crate::formats::waveform::label::{is_named_time, label};

/// A channel as its file has it.
#[derive(Debug, Clone)]
pub struct Waveform {
    /// Its group; empty where the format has none.
    pub group: String,
    /// Its name, perhaps with the unit.
    pub name: String,
    /// The unit as stated; empty: not stated, or in the name.
    pub unit: String,
    /// Time of the first sample and the interval, s.
    pub steps: Option<(f64, f64)>,
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
            not_time: None,
            comment: None,
            values: Ok(Vec::new()),
        }
    }

    /// Takes start and interval of the X axis (`wf_start_offset`, `wf_increment`) for time, in s unless another unit of
    /// time is stated. An axis with the unit or the name of something else is none of time.
    pub fn set_steps(&mut self, steps: Option<(f64, f64)>, x_name: &str, x_unit: &str) {
        let Some((start, interval)) = steps else { return };
        let axis = label(x_name, x_unit);
        let says_nothing = x_unit.is_empty() && (x_name.is_empty() || x_name.to_lowercase().starts_with('x'));
        match axis.unit {
            Unit::Time(factor) => self.steps = Some((start * factor, interval * factor)),
            Unit::Unstated if says_nothing || is_named_time(&axis.name) => {
                self.steps = Some((start, interval));
            }
            _ => {
                let unit = if x_unit.is_empty() { String::new() } else { format!(" in {x_unit}") };
                self.not_time = Some(format!("its X axis is {x_name:?}{unit}, not time"));
            }
        }
    }
}

/// Names with commas between, at most 12.
pub fn list<S: AsRef<str>>(names: &[S]) -> String {
    let shown: Vec<&str> = names.iter().take(12).map(AsRef::as_ref).collect();
    let more = names.len() - shown.len();
    if more == 0 { shown.join(", ") } else { format!("{} and {more} more", shown.join(", ")) }
}
