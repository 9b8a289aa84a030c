//! Channels of waveforms: identity, label, one time axis for all.

use std::collections::BTreeMap;

use crumple_signal::unit::{self, Dimension};
use crumple_signal::{About, Notes, Weight, remarks};

use crate::formats::text::column_names::{Unit, is_time_name, split_unit};
use crate::recording::content::{Ids, ReadChannel, list};
use crate::time::Instant;
use crate::{IngestError, Place, Result, time};

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
    pub comment: Option<String>,
    /// The samples, or why they are not to be had.
    pub values: Result<Vec<f64>, String>,
    /// What to do where they are not to be had.
    pub remedy: &'static str,
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
            remedy: "export the channel as CSV, or as plain numbers of this format",
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

    /// Takes the samples, times of the day, for times in s from the first one on, which is at `first`.
    pub fn set_stamps(&mut self, first: Option<Instant>) {
        let Some(first) = first else { return };
        self.first_stamp = Some(first);
        "s".clone_into(&mut self.unit);
    }
}

/// `group.channel`, the unit left out, each once: letters, digits, `_`, `-` and `.`; anything else becomes `_`, so that
/// an id can be a part of a topic and of a file name.
pub fn ids(waveforms: &[Waveform], labels: &[Label]) -> Vec<String> {
    let mut ids = Ids::default();
    let id = |(k, (waveform, label)): (usize, (&Waveform, &Label))| {
        let (group, name) = (clean(&waveform.group), clean(&label.name));
        let name = if name.is_empty() { format!("channel_{}", k + 1) } else { name };
        ids.unique(&if group.is_empty() { name } else { format!("{group}.{name}") })
    };
    waveforms.iter().zip(labels).enumerate().map(id).collect()
}

/// Letters, digits, `_`, `-` and `.`; anything else becomes `_`.
pub fn clean(name: &str) -> String {
    let mut clean = String::new();
    for c in name.chars().take(80) {
        if c.is_alphanumeric() || matches!(c, '_' | '-' | '.') {
            clean.push(c);
        } else if !clean.is_empty() && !clean.ends_with('_') {
            clean.push('_');
        }
    }
    clean.trim_end_matches(['_', '.']).trim_start_matches('.').to_owned()
}

/// Name with and without unit, with and without group, and the number from 1. A name that two channels have is none.
pub fn aliases(waveforms: &[Waveform], labels: &[Label]) -> Vec<Vec<String>> {
    let names_of = |(k, (waveform, label)): (usize, (&Waveform, &Label))| {
        let mut names = vec![label.title.clone(), label.name.clone()];
        if !waveform.group.is_empty() {
            names.extend([&label.title, &label.name].map(|name| format!("{}/{name}", waveform.group)));
        }
        names.push((k + 1).to_string());
        names.sort();
        names.dedup();
        names
    };
    let mut all: Vec<Vec<String>> = waveforms.iter().zip(labels).enumerate().map(names_of).collect();
    let mut uses: BTreeMap<String, usize> = BTreeMap::new();
    for name in all.iter().flatten() {
        *uses.entry(name.to_lowercase()).or_default() += 1;
    }
    for names in &mut all {
        names.retain(|name| uses.get(&name.to_lowercase()) == Some(&1));
    }
    all
}

/// The waveform asked for: by its id, then by an alias, case aside.
pub fn find(wanted: &str, ids: &[String], aliases: &[Vec<String>]) -> Option<usize> {
    let wanted = wanted.trim();
    let same = |name: &String| name.to_lowercase() == wanted.to_lowercase();
    let exact = ids.iter().position(|id| id == wanted);
    exact.or_else(|| ids.iter().position(same)).or_else(|| aliases.iter().position(|names| names.iter().any(same)))
}

/// Name and unit of a waveform.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    pub title: String,
    /// The name without a unit in it.
    pub name: String,
    pub unit: Unit,
}

/// Takes the stated unit, else one in the name: `Acceleration (g)`, `DeltaV (m\s)`. DIAdem allows no `/` in a name.
pub fn label(title: &str, stated: &str) -> Label {
    let title = title.trim().to_owned();
    let (bare, in_name) = split_unit(&title.replace('\\', "/"));
    let in_name = match in_name {
        Unit::Unknown(symbol) => unit_of_symbol(&symbol),
        unit => unit,
    };
    // `Femur (Good)`: what is no unit belongs to the name.
    let name = if matches!(in_name, Unit::Unknown(_) | Unit::Unstated) { title.clone() } else { bare };
    let unit = if stated.trim().is_empty() { in_name } else { unit_of_symbol(stated) };
    Label { title, name, unit }
}

/// A unit by its symbol, or by the word that LabVIEW writes for it.
fn unit_of_symbol(symbol: &str) -> Unit {
    let symbol = unit::without_brackets(symbol).replace('\\', "/");
    let unit = |symbol: &str| match unit::factor(symbol, Dimension::Time) {
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
    unit(&symbol).or_else(|| unit(word)).unwrap_or(Unit::Unknown(symbol))
}

/// `Time`, `t`, `IIWPG Time`: time stands first or last.
pub fn is_named_time(name: &str) -> bool {
    let last = name.rsplit([' ', '_', '-', '.']).next().unwrap_or(name);
    is_time_name(name) || (last.len() > 1 && is_time_name(last))
}

/// Channels that start farther apart than this are not of one event, s.
const ONE_EVENT_S: f64 = 60.0;
/// A shift below this part of an interval is rounding of the clock.
const ROUNDING: f64 = 1e-3;

/// Shifts channels so that all have the axis of the one that starts first. `origins`: when the t = 0 of each is, by the
/// clock of the file; a channel that has none keeps its times.
///
/// Channels more than a minute apart are of different events: none is shifted then, with a warning.
pub fn align(
    file: &str,
    channels: &mut [(usize, ReadChannel)],
    origins: &[Option<Instant>],
    notes: &mut Notes,
) -> Result<()> {
    let start = |(channel, origin): (&(usize, ReadChannel), &Option<Instant>)| {
        let t0_s = channel.1.wave.as_ref()?.t0_s();
        origin.map(|origin| (origin, origin.plus(t0_s), channel.1.channel.id.clone()))
    };
    let starts: Vec<(Instant, Instant, String)> = channels.iter().zip(origins).filter_map(start).collect();
    let Some((axis, first, name)) = starts.iter().min_by(|a, b| a.1.since(b.1).total_cmp(&0.0)) else {
        return Ok(());
    };
    let apart_s = starts.iter().map(|(_, start, _)| start.since(*first)).fold(0.0, f64::max);
    if apart_s > ONE_EVENT_S {
        notes.push(StartsApart { apart_s });
        return Ok(());
    }
    let mut shifted = Vec::new();
    for ((_, read), origin) in channels.iter_mut().zip(origins) {
        let (Some(origin), Some(wave)) = (origin, &read.wave) else { continue };
        let later_s = origin.since(*axis);
        if later_s.abs() <= ROUNDING * wave.dt_s() {
            continue;
        }
        let moved = time::shift(wave, -later_s).map_err(|error| {
            let place = Place::file(file).in_column(read.channel.id.clone());
            IngestError::content(place, error.to_string(), "times in range", "correct the start time of the channel")
        })?;
        read.wave = Some(moved);
        shifted.push(format!("{} {:+.3} ms", read.channel.id, 1e3 * later_s));
    }
    if !shifted.is_empty() {
        notes.push(StartsDiffer { first: name.clone(), shifts: list(&shifted) });
    }
    Ok(())
}

remarks! {
    /// Remarks of the starts of waveforms.
    pub REMARKS;

    /// Channels start so far apart that they are not of one event.
    CR060 StartsApart { apart_s: f64 }
    bears on (About::Record, Weight::Slight)
    decided "The clock of the file says when each channel starts; one event starts within 60 s."
    means "No channel is moved: times of different channels cannot be compared."
    remedy "export the channels of one event into a file of their own"
    says format!(
        "channels start at times of the day up to {apart_s:.3} s apart: they are not of one event, and each keeps its \
         own axis"
    );

    /// Channels start at different times, and were brought to one axis.
    CR061 StartsDiffer { first: String, shifts: String }
    bears on (About::Record, Weight::None)
    decided "The clock of the file says when each channel starts. A shift below a thousandth of the interval is \
             rounding of that clock."
    means "Samples stay as they are. Times of all channels count from the same moment."
    remedy "nothing; --time-zero counts on the axis of the channel that starts first"
    says format!(
        "channels start at different times: all use the axis of {first}, which starts first ({shifts}). --time-zero \
         counts on that axis"
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_signal::QuantityKind;

    #[test]
    fn ids_are_unique_and_names_unambiguous() {
        let waveforms: Vec<Waveform> =
            [("A b", "acc (g)"), ("A b", "acc [m/s^2]"), ("C", "acc (g)"), ("", "Dev0/Ai0"), ("", "//")]
                .map(|(group, name)| Waveform::new(group, name))
                .into();
        let labels: Vec<Label> = waveforms.iter().map(|w| label(&w.name, "")).collect();
        let ids = ids(&waveforms, &labels);
        assert_eq!(ids, ["A_b.acc", "A_b.acc-2", "C.acc", "Dev0_Ai0", "channel_5"]);
        let aliases = aliases(&waveforms, &labels);
        let find = |wanted| find(wanted, &ids, &aliases);
        assert_eq!(find("a b/acc (g)"), Some(0));
        assert_eq!(find("acc [m/s^2]"), Some(1));
        assert_eq!(find("c/acc"), Some(2));
        assert_eq!(find("dev0/ai0"), Some(3));
        assert_eq!((find("acc"), find("acc (g)"), find("3")), (None, None, Some(2)));
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
            let label = label(title, stated);
            assert_eq!((label.name.as_str(), &label.unit), (name, &unit), "{title}");
        }
    }
}
