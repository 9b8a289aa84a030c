//! Clocks of waveforms: time vectors, intervals, dates.

use std::collections::BTreeMap;

use crumple_signal::value::Time;
use crumple_signal::{About, Notes, Weight, remarks};

use crate::error::Question;
use crate::formats::remarks::{Resampled, TimeChannels};
use crate::formats::text::column_names::Unit;
use crate::formats::waveform::channel::{Label, Waveform, is_named_time};
use crate::recording::content::list;
use crate::time::{Grid, Instant, Kind, LinearInterpolation, OnGrid, Timed, Times};
use crate::{IngestError, IngestSettings, Place, Result};

/// Longest sampling interval of a crash record, s: 50 samples a second show two or three of a pulse. A longer one is a
/// default, as LabVIEW and DIAdem write an increment of 1 where they know none.
const LONGEST_INTERVAL_S: f64 = 0.02;

/// The channel of times of a group.
struct Clock {
    index: usize,
    title: String,
    samples: usize,
    grid: Result<Grid>,
    /// When the grid's t = 0 is, where the file says it.
    origin: Option<Instant>,
    /// Where its channels are brought to a uniform rate.
    resampling: Option<Resampling>,
    /// Channels with another number of samples, by that number.
    cut: BTreeMap<usize, Vec<String>>,
    /// Channels whose own steps say something else, and are not used.
    overruled: Vec<String>,
    /// Channels whose interval is one that programs write where they know none.
    defaults: Vec<String>,
    /// Channels whose own steps say something else, and are used.
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

/// The grid of a channel, and when its t = 0 is, where the file says it.
pub type TimeOfChannel = (Grid, Option<Instant>);

/// What is asked about the time of a channel.
pub struct Asked<'a> {
    pub file: &'a str,
    pub id: &'a str,
    pub group: &'a str,
    /// Start and interval of its own, s.
    pub steps: Option<(f64, f64)>,
    /// When the time of these is 0.
    pub origin: Option<Instant>,
    /// It is a motion, which is integrated: an interval that no crash is recorded at makes kilometres of it.
    pub is_motion: bool,
}

/// The channels of times of a file, by group.
pub struct Clocks {
    by_group: BTreeMap<String, Clock>,
    /// Channels of times that cannot be read, by group: title and reason.
    unread: BTreeMap<String, (String, String)>,
    /// Which waveforms hold times.
    pub are_times: Vec<bool>,
    /// Interval that a person states for channels without any, s.
    stated_interval_s: Option<f64>,
    /// Whether that was used.
    pub is_stated_used: bool,
    /// A record of anything, or a list: an interval is taken as the file has it.
    is_any_interval_right: bool,
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
        let mut clocks = Self {
            by_group: BTreeMap::new(),
            unread: BTreeMap::new(),
            are_times: vec![false; waveforms.len()],
            stated_interval_s: settings.sample_time.map(Time::si).filter(|dt| *dt > 0.0 && dt.is_finite()),
            is_stated_used: false,
            is_any_interval_right: settings.listing || settings.allow_missing.unwrap_or(false),
        };
        for (k, (waveform, label)) in waveforms.iter().zip(labels).enumerate() {
            let named = match label.unit {
                Unit::Time(_) => true,
                Unit::Unstated => is_named_time(&label.name),
                Unit::Signal(..) | Unit::Unknown(_) => false,
            };
            if !named {
                continue;
            }
            let values = match &waveform.values {
                Ok(values) if values.is_empty() => continue,
                Ok(values) if values.len() > 1 && values.windows(2).all(|pair| pair[1] > pair[0]) => values,
                unread => {
                    let reason = unread.as_ref().err().map_or("its values do not increase", String::as_str);
                    let unread = (label.title.clone(), reason.to_owned());
                    clocks.unread.entry(waveform.group.clone()).or_insert(unread);
                    continue;
                }
            };
            clocks.are_times[k] = true;
            if clocks.by_group.contains_key(&waveform.group) {
                continue;
            }
            let fitted = grid_of(file, label, waveform.first_stamp.is_some(), values, settings, notes);
            let (grid, first, resampling) = match fitted {
                Ok((grid, first, resampling)) => (Ok(grid), first, resampling),
                Err(error) => (Err(error), None, None),
            };
            let clock = Clock {
                index: k,
                title: label.title.clone(),
                samples: values.len(),
                grid,
                origin: waveform.first_stamp.or(first).or(waveform.origin),
                resampling,
                cut: BTreeMap::new(),
                overruled: Vec::new(),
                defaults: Vec::new(),
                differ: Vec::new(),
            };
            clocks.by_group.insert(waveform.group.clone(), clock);
        }
        clocks
    }

    /// Whether any waveform holds times.
    pub fn are_any(&self) -> bool {
        !self.by_group.is_empty()
    }

    /// The time of a channel: of the channel of times in its group where that has as many samples or the channel has
    /// no steps that make sense, else its own steps, else the interval that a person states. `values` are cut to the
    /// shorter of both.
    pub fn grid(&mut self, asked: &Asked, values: &mut Vec<f64>) -> Result<TimeOfChannel> {
        let makes_sense = |dt_s: f64| !asked.is_motion || self.is_any_interval_right || dt_s <= LONGEST_INTERVAL_S;
        let own = asked.steps.map(|(t0_s, dt_s)| Grid { t0_s, dt_s, jitter: 0.0 });
        let sensible = own.filter(|grid| makes_sense(grid.dt_s));
        if let Some(group) = self.group_of_clock(asked, own.is_none() || sensible.is_none(), values.len())
            && let Some(clock) = self.by_group.get_mut(&group)
        {
            let differs = own.is_some_and(|own| clock.differs(&own, values.len()));
            let may_lead = clock.grid.is_ok() && clock.samples == values.len() && asked.is_motion;
            match sensible {
                Some(own) if !(differs && may_lead) => {
                    if differs {
                        clock.differ.push(asked.id.to_owned());
                    }
                    return Ok((own, asked.origin));
                }
                _ if clock.grid.is_ok() || self.stated_interval_s.is_none() => {
                    let ids = if sensible.is_some() { &mut clock.overruled } else { &mut clock.defaults };
                    if differs {
                        ids.push(asked.id.to_owned());
                    }
                    return clock.time_of(asked.id, values);
                }
                _ => {}
            }
        }
        if let Some(own) = sensible {
            return Ok((own, asked.origin));
        }
        if let Some(dt_s) = self.stated_interval_s {
            self.is_stated_used = true;
            let t0_s = own.map_or(0.0, |own| own.t0_s / own.dt_s * dt_s);
            return Ok((Grid { t0_s, dt_s, jitter: 0.0 }, asked.origin));
        }
        Err(self.no_time(asked, own))
    }

    /// The group whose channel of times is that of a channel: its own, else, where it needs one, that of the only
    /// clock of the file, if it has as many samples.
    fn group_of_clock(&self, asked: &Asked, needs_one: bool, samples: usize) -> Option<String> {
        if self.by_group.contains_key(asked.group) {
            return Some(asked.group.to_owned());
        }
        let mut clocks = self.by_group.iter().filter(|_| needs_one && !self.unread.contains_key(asked.group));
        match (clocks.next(), clocks.next()) {
            (Some((group, clock)), None) if clock.samples == samples => Some(group.clone()),
            _ => None,
        }
    }

    /// The question for the interval of a channel that has none that makes sense.
    fn no_time(&self, asked: &Asked, own: Option<Grid>) -> IngestError {
        let unread = self.unread.get(asked.group);
        let found = match (own, unread) {
            (_, Some((title, reason))) => format!("the channel of times {title} is not read: {reason}"),
            (Some(own), None) => format!(
                "a sampling interval of {} s and no channel of times: no crash is recorded so slowly, and programs \
                 write an increment of 1 where they know none",
                own.dt_s
            ),
            (None, None) => {
                "no time: neither a sampling interval (wf_increment, Delta_X) nor a channel of times in its group"
                    .to_owned()
            }
        };
        IngestError::content(
            Place::file(asked.file).in_column(asked.id),
            found,
            format!("the times of the samples: a channel of times, or an interval of {LONGEST_INTERVAL_S} s at most"),
            "state the sampling interval, such as --sample-time 100us",
        )
        .asking(Question::Interval)
    }

    /// Whether any channels were brought to a uniform rate.
    pub fn resamples(&self) -> bool {
        self.by_group.values().any(|clock| clock.resampling.as_ref().is_some_and(|r| r.used))
    }

    /// What became of the channels of times.
    pub fn notes(&self, notes: &mut Notes) {
        for clock in self.by_group.values() {
            for (samples, ids) in &clock.cut {
                let (times, of_times) = (clock.title.clone(), clock.samples);
                notes.push(LengthsDiffer { times, of_times, channels: list(ids), samples: *samples });
            }
            if let Some(Resampling { words, used: true, .. }) = &clock.resampling {
                let (times, words) = (Some(clock.title.clone()), words.clone());
                notes.push(Resampled { topic: None, times, count: None, words });
            }
            for (ids, used) in [(&clock.overruled, "the channel of times"), (&clock.differ, "the steps")] {
                if !ids.is_empty() {
                    notes.push(TimesAgainstSteps { times: clock.title.clone(), channels: list(ids), used });
                }
            }
        }
        for clock in self.by_group.values().filter(|clock| !clock.defaults.is_empty()) {
            notes.push(DefaultInterval { channels: list(&clock.defaults), times: clock.title.clone() });
        }
        let mut names: Vec<(usize, &str)> = self.by_group.values().map(|c| (c.index, c.title.as_str())).collect();
        names.sort_unstable();
        if !names.is_empty() {
            let names: Vec<&str> = names.into_iter().map(|(_, name)| name).collect();
            notes.push(TimeChannels { names: list(&names), pairs: None });
        }
    }
}

impl Clock {
    /// Whether a grid of `samples` samples is another one than that of the clock, by half an interval at an end.
    fn differs(&self, own: &Grid, samples: usize) -> bool {
        let Ok(grid) = &self.grid else { return false };
        let end = |grid: &Grid| grid.t0_s + (samples.min(self.samples) as f64 - 1.0) * grid.dt_s;
        let off = (grid.t0_s - own.t0_s).abs().max((end(grid) - end(own)).abs());
        off > 0.5 * own.dt_s.min(grid.dt_s)
    }

    /// The time of a channel by this clock; `values` are cut to its length, and resampled where that is asked for.
    fn time_of(&mut self, id: &str, values: &mut Vec<f64>) -> Result<TimeOfChannel> {
        if self.samples != values.len() {
            self.cut.entry(values.len()).or_default().push(id.to_owned());
            values.truncate(self.samples);
        }
        if let Some(resampling) = &mut self.resampling {
            resampling.used = true;
            *values = resampling.interpolation.apply(values.len(), |k| values[k]);
        }
        Ok((self.grid.clone()?, self.origin))
    }
}

/// The grid of a channel of times; the first one, where they are times of a calendar, from which the grid counts; how
/// its channels are brought to the rate that is asked for.
type Fitted = (Grid, Option<Instant>, Option<Resampling>);

fn grid_of(
    file: &str,
    label: &Label,
    are_stamps: bool,
    values: &[f64],
    settings: &IngestSettings,
    notes: &mut Notes,
) -> Result<Fitted> {
    let times = Times {
        values: values.to_vec(),
        // Stamps of a clock are made seconds by the reader.
        kind: if are_stamps { Kind::Clock } else { Kind::Binary },
        file,
        title: &label.title,
        whose: &label.title,
        unit: label.unit.of_times(),
        comment: None,
        expected: "a unit of the channel, such as s",
    };
    let column = Place::file(file).in_column(label.title.clone());
    let of_sample = |k: usize| Place::file(&format!("{column}, sample {k}"));
    let Timed { on_grid: OnGrid { grid, interpolation, words, .. }, origin_s, .. } =
        times.timed(settings, of_sample, notes)?;
    let resampling = interpolation.map(|interpolation| Resampling { interpolation, words, used: false });
    let whole = |s: f64| Instant { seconds: s.floor() as i64, fraction_s: s - s.floor() };
    Ok((grid, origin_s.map(whole), resampling))
}

remarks! {
    /// Remarks of the clocks of waveforms.
    pub REMARKS;

    /// Channels and their times are of different lengths.
    CR062 LengthsDiffer { times: String, of_times: usize, channels: String, samples: usize }
    bears on (About::Record, Weight::Slight)
    decided "The channel of times of the group is compared with the channels that have no steps of their own."
    means "The ends of the longer one are left off. If samples are missing inside, times behind them are wrong."
    remedy "export the group again, with times and samples of one length"
    says format!(
        "the channel of times {times} has {of_times} samples, {channels} {samples}: the shorter length is used"
    );

    /// A channel of times and the steps of the channels say different times.
    CR063 TimesAgainstSteps { times: String, channels: String, used: &'static str }
    bears on (About::Record, Weight::Slight)
    decided "Start and end of both are compared: half an interval is left. The channel of times is used for a motion \
             with as many samples, else the steps."
    means "If the other one is right, times, velocity and crush are wrong by the ratio of both."
    remedy "check the sampling rate against the data sheet of the recorder"
    says {
        let used = if *used == "the steps" { "those are used" } else { "the channel of times is used" };
        format!("the channel of times {times} differs from the steps that {channels} have of their own: {used}")
    };

    /// The interval of channels is the default of the program that wrote the file.
    CR064 DefaultInterval { channels: String, times: String }
    bears on (About::Record, Weight::None)
    decided "An acceleration or velocity with an interval above 0.02 s is none of a crash: LabVIEW and DIAdem write 1 \
             where they know none."
    means "The interval is not used, the channel of times is."
    remedy "nothing"
    says format!(
        "{channels} have an interval that no crash is recorded at (a default of the program that wrote the file): the \
         channel of times {times} is used"
    );
}
