//! Time of waveforms: a step at each channel, else the channel of times in the same group.

use std::collections::BTreeMap;

use crumple_signal::Notes;

use crate::formats::text::column_names::Unit;
use crate::formats::waveform::channel::{Waveform, list};
use crate::formats::waveform::label::{Label, is_named_time};
use crate::time::grid::{self, Grid, GridError};
use crate::time::resampling::{self, LinearInterpolation};
use crate::time::time_unit;
use crate::{IngestError, IngestSettings, Place};

/// The channel of times of a group.
struct Clock {
    /// Index of the waveform.
    index: usize,
    title: String,
    samples: usize,
    grid: Result<Grid, IngestError>,
    /// Where its channels are brought to a uniform rate.
    resampling: Option<Resampling>,
    /// Channels with another number of samples, by that number.
    cut: BTreeMap<usize, Vec<String>>,
    /// Channels that have steps of their own which differ.
    differ: Vec<String>,
}

/// A uniform rate for the channels of a clock.
struct Resampling {
    interpolation: LinearInterpolation,
    /// Rate and jitter in words.
    words: String,
    /// A channel was brought to it.
    used: bool,
}

/// The channels of times of a file, by group.
pub struct Clocks {
    by_group: BTreeMap<String, Clock>,
    /// Which waveforms hold times.
    are_times: Vec<bool>,
}

impl Clocks {
    /// A channel holds times if its unit is one of time, or its name is time and it has none, and its values increase.
    /// The first of a group is its clock.
    pub fn find(
        file: &str,
        waveforms: &[Waveform],
        labels: &[Label],
        settings: &IngestSettings,
        notes: &mut Notes,
    ) -> Self {
        let mut clocks = Self { by_group: BTreeMap::new(), are_times: vec![false; waveforms.len()] };
        for (k, (waveform, label)) in waveforms.iter().zip(labels).enumerate() {
            let Ok(values) = &waveform.values else { continue };
            let named = match label.unit {
                Unit::Time(_) => true,
                Unit::Unstated => is_named_time(&label.name),
                Unit::Signal(..) | Unit::Unknown(_) => false,
            };
            if !named || values.len() < 2 || !values.windows(2).all(|pair| pair[1] > pair[0]) {
                continue;
            }
            clocks.are_times[k] = true;
            if clocks.by_group.contains_key(&waveform.group) {
                continue;
            }
            let fitted = grid_of(file, label, values, settings, notes);
            let (grid, resampling) = match fitted {
                Ok((grid, resampling)) => (Ok(grid), resampling),
                Err(error) => (Err(error), None),
            };
            let clock = Clock {
                index: k,
                title: label.title.clone(),
                samples: values.len(),
                grid,
                resampling,
                cut: BTreeMap::new(),
                differ: Vec::new(),
            };
            clocks.by_group.insert(waveform.group.clone(), clock);
        }
        clocks
    }

    /// Whether waveform `k` holds times.
    pub fn is_clock(&self, k: usize) -> bool {
        self.are_times[k]
    }

    /// The grid of channel `id`: its own steps, else those of the clock of its group; then to the shorter of the two.
    pub fn grid(
        &mut self,
        file: &str,
        id: &str,
        group: &str,
        steps: Option<(f64, f64)>,
        values: &mut Vec<f64>,
    ) -> Result<Grid, IngestError> {
        let clock = self.by_group.get_mut(group);
        if let Some((t0_s, dt_s)) = steps {
            if let Some(clock) = clock
                && let Ok(grid) = &clock.grid
            {
                let end = |t0: f64, dt: f64| t0 + (values.len().min(clock.samples) - 1) as f64 * dt;
                let off = (grid.t0_s - t0_s).abs().max((end(grid.t0_s, grid.dt_s) - end(t0_s, dt_s)).abs());
                if off > 0.5 * dt_s {
                    clock.differ.push(id.to_owned());
                }
            }
            return Ok(Grid { t0_s, dt_s, jitter: 0.0 });
        }
        let Some(clock) = clock else {
            return Err(IngestError::content(
                Place::file(file).in_column(id),
                "no time: neither a sampling interval (wf_increment, Delta_X) nor a channel of times in its group",
                "one of them",
                "export the channel with its time",
            ));
        };
        if clock.samples != values.len() {
            clock.cut.entry(values.len()).or_default().push(id.to_owned());
            values.truncate(clock.samples);
        }
        if let Some(resampling) = &mut clock.resampling {
            resampling.used = true;
            *values = resampling.interpolation.apply(values.len(), |k| values[k]);
        }
        clock.grid.clone()
    }

    /// Whether any channels were brought to a uniform rate.
    pub fn resamples(&self) -> bool {
        self.by_group.values().any(|clock| clock.resampling.as_ref().is_some_and(|r| r.used))
    }

    /// What became of the channels of times.
    pub fn notes(&self, notes: &mut Notes) {
        for clock in self.by_group.values() {
            for (samples, ids) in &clock.cut {
                notes.warning(format!(
                    "the channel of times {} has {} samples, {} {samples}: the shorter length is used",
                    clock.title,
                    clock.samples,
                    list(ids)
                ));
            }
            if let Some(Resampling { words, used: true, .. }) = &clock.resampling {
                notes.warning(format!("channels timed by {} are resampled {words}", clock.title));
            }
            if !clock.differ.is_empty() {
                notes.warning(format!(
                    "the channel of times {} differs from the steps that {} have of their own: those are used",
                    clock.title,
                    list(&clock.differ)
                ));
            }
        }
        let mut names: Vec<(usize, &str)> = self.by_group.values().map(|c| (c.index, c.title.as_str())).collect();
        names.sort_unstable();
        if !names.is_empty() {
            let names: Vec<&str> = names.into_iter().map(|(_, name)| name).collect();
            notes.info(format!("{} holds the times of the others and is not a channel", list(&names)));
        }
    }
}

fn grid_of(
    file: &str,
    label: &Label,
    values: &[f64],
    settings: &IngestSettings,
    notes: &mut Notes,
) -> Result<(Grid, Option<Resampling>), IngestError> {
    let place = || Place::file(file).in_column(label.title.clone());
    let unit = match (&settings.time_unit, &label.unit) {
        (Some(symbol), _) => time_unit::stated_unit(place(), symbol, "--time-unit or the sidecar")?,
        (None, Unit::Time(factor)) => *factor,
        (None, _) => time_unit::unit_from_steps(file, &label.title, "a unit of the channel, such as s", values, notes)?,
    };
    let inverse = (1.0 / unit).round();
    let times: Vec<f64> = values.iter().map(|t| if unit < 1.0 { t / inverse } else { t * unit }).collect();
    if times.iter().any(|t| !t.is_finite()) {
        return Err(IngestError::content(place(), "a time that is not finite", "finite times", "export it again"));
    }
    if let Some(rate) = settings.resample {
        let interpolation = resampling::resample(&times, rate.si()).ok_or_else(|| {
            IngestError::content(
                place(),
                format!("--resample {rate} gives no usable number of samples"),
                "a rate near that of the samples",
                format!("give --resample {}Hz", resampling::rate_to_type(grid::median_step(&times))),
            )
        })?;
        let jitter = resampling::step_jitter(&times, grid::median_step(&times));
        let words =
            format!("to {rate} by linear interpolation, as asked (jitter {jitter:.3}, max|dt - median|/median)");
        let grid = Grid { t0_s: times[0], dt_s: 1.0 / rate.si(), jitter: resampling::jitter(&times) };
        return Ok((grid, Some(Resampling { interpolation, words, used: false })));
    }
    let fitted = grid::fit(&times, single_precision(values) * unit).map_err(|error| {
        let found = match error {
            GridError::Repeated { index } => format!("sample {index} repeats a time"),
            GridError::Backwards { index } => format!("time runs backwards at sample {index}"),
            GridError::Uneven { index, step_s, dt_s } => {
                format!(
                    "a step of {step_s:.9} s before sample {index}, where the median is {dt_s:.9} s (jitter, \
                     max|dt - median|/median: {:.3})",
                    resampling::step_jitter(&times, dt_s)
                )
            }
        };
        IngestError::content(
            place(),
            found,
            format!("equal steps within {} of the interval", grid::STEP_TOLERANCE),
            format!(
                "a gap is better exported again; for uneven sampling --resample {}Hz brings it to a uniform rate by \
                 linear interpolation",
                resampling::rate_to_type(grid::median_step(&times))
            ),
        )
    })?;
    Ok((fitted, None))
}

/// Resolution of times that were stored in single precision; 0 if they were not.
fn single_precision(values: &[f64]) -> f64 {
    let single = values.iter().all(|x| f64::from(*x as f32) == *x);
    let largest = values.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    if single { largest * f64::from(f32::EPSILON) } else { 0.0 }
}
