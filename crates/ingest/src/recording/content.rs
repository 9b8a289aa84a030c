//! What a reader makes of a file: channels, their waves, their quality, where they stand.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use crumple_artifact::records::QualityV1;
use crumple_signal::{
    About, Channel, ChannelStatus, MovingStart, Notes, PreEvent, QuantityKind, Sampled, Weight, moving_start,
    pre_event, remarks,
};

use crate::recording::details::Details;

/// Fewer samples than this are no crash record.
pub const MINIMUM_SAMPLES: usize = 50;

/// How the pulse is found when nobody names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PulseRule {
    /// The only candidate; several are asked about.
    OnlyOne,
    /// The fittest candidate.
    Fittest,
}

/// Everything a reader reads.
#[derive(Debug, Clone)]
pub struct Recording {
    /// The test's facts.
    pub details: Details,
    /// All channels the file lists, in its order.
    pub channels: Vec<ReadChannel>,
    /// How the pulse is found.
    pub pulse_rule: PulseRule,
    /// The format defines t = 0 as first contact.
    pub contact_at_zero: bool,
    /// Remarks of the reader.
    pub notes: Notes,
}

/// A channel and its samples.
#[derive(Debug, Clone)]
pub struct ReadChannel {
    /// Identity and state.
    pub channel: Channel,
    /// Samples in SI; `None` where the file lists the channel without data.
    pub wave: Option<Sampled>,
    /// Largest distance of a time stamp from the uniform grid, in intervals.
    pub jitter: f64,
    /// How well the channel serves as the crash pulse; `None`: only if asked for.
    pub fitness: Option<Fitness>,
    /// Other names under which the channel may be asked for.
    pub aliases: Vec<String>,
    /// Where it is attached by the record's own code: `DSLF`, `VECG`.
    pub attachment: Option<String>,
    /// Why its file cannot be read, with file and line, where it is here.
    pub unread: Option<String>,
    /// The lines of its samples, where they stand in a text with other channels.
    pub lines: Option<Arc<LineNumbers>>,
}

impl ReadChannel {
    /// A channel without samples, neither named otherwise nor fit for the pulse.
    pub fn new(channel: Channel) -> Self {
        Self {
            channel,
            wave: None,
            jitter: 0.0,
            fitness: None,
            aliases: Vec::new(),
            attachment: None,
            unread: None,
            lines: None,
        }
    }

    /// A channel whose file is here and cannot be read: listed without data, the reason in its comment.
    pub fn without_readable_file(mut channel: Channel, reason: String) -> Self {
        channel.status = ChannelStatus::Absent;
        channel.comment = Some(format!("its file is not read: {reason}"));
        Self { unread: Some(reason), ..Self::new(channel) }
    }
}

/// Order among candidates for the pulse: smaller is better; equal ones are settled by the order of channels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Fitness {
    /// A second sensor at the place of a primary one.
    pub redundant: bool,
    /// Rank of the place on the vehicle.
    pub place: u8,
    /// Why the place ranks as it does, in words.
    pub why: &'static str,
}

impl Fitness {
    /// That of an acceleration which has no rival; none of another quantity.
    pub(crate) fn of_only(quantity: QuantityKind, why: &'static str) -> Option<Self> {
        (quantity == QuantityKind::Acceleration).then_some(Self { redundant: false, place: 0, why })
    }
}

/// Ids of channels, each once: the second `a` is `a-2`.
#[derive(Default)]
pub(crate) struct Ids {
    taken: BTreeSet<String>,
    next_copy: BTreeMap<String, usize>,
}

impl Ids {
    /// The id, or one with a number behind it.
    pub(crate) fn unique(&mut self, base: &str) -> String {
        let mut id = base.to_owned();
        let copy = self.next_copy.entry(id.clone()).or_insert(2);
        while !self.taken.insert(id.clone()) {
            id = format!("{base}-{copy}");
            *copy += 1;
        }
        id
    }
}

/// Names with commas between, at most 12.
pub(crate) fn list<S: AsRef<str>>(names: &[S]) -> String {
    list_of(names, 12)
}

/// Names with commas between, at most so many.
pub(crate) fn list_of<S: AsRef<str>>(names: &[S], most: usize) -> String {
    let shown: Vec<&str> = names.iter().take(most).map(AsRef::as_ref).collect();
    let more = names.len() - shown.len();
    if more == 0 { shown.join(", ") } else { format!("{} and {more} more", shown.join(", ")) }
}

/// Says that its laboratory doubts a channel.
pub(crate) fn note_doubts(channel: &Channel, notes: &mut Notes) {
    if matches!(channel.status, ChannelStatus::Questionable | ChannelStatus::Failed) {
        let comment = channel.comment.as_deref().unwrap_or("without a comment");
        let (id, status) = (channel.id.clone(), channel.status.to_string());
        notes.push(Doubted { id, status, comment: comment.to_owned() });
    }
}

/// A channel's samples and what was measured on them.
#[derive(Debug, Clone)]
pub struct Wave {
    /// Id of the channel.
    pub id: String,
    /// What is measured.
    pub quantity: QuantityKind,
    /// Samples in SI, t = 0 at first contact.
    pub samples: Sampled,
    /// State as read.
    pub quality: Quality,
}

/// Dropouts are looked for up to this time, s.
const ACTIVE_UNTIL_S: f64 = 0.150;
/// Length of the end of a record that is looked at for drift, s.
const END_S: f64 = 0.020;

/// State of a channel as read.
#[derive(Debug, Clone, PartialEq)]
pub struct Quality {
    /// `None` without 10 ms of data before the event.
    pub pre_event: Option<PreEvent>,
    /// Whether gravity may change what it reads.
    pub feels_gravity: bool,
    /// Of an acceleration that falls or brakes before contact.
    pub moving: Option<MovingStart>,
    /// What stands of it in the artifact.
    pub record: QualityV1,
}

impl Quality {
    /// The level that is no motion, where the record shows it: that at rest, or before the event.
    pub fn zero_level(&self) -> Option<f64> {
        self.moving.map(|moving| moving.rest_level).or(self.pre_event.map(|before| before.zero_level))
    }
}

/// Measures a channel whose t = 0 is the event.
///
/// Zero level and noise floor: mean and standard deviation of the raw samples from -50 ms to -10 ms ([`pre_event`]).
///
/// `feels_gravity`: it may fall or brake before contact.
pub fn measure(wave: &Sampled, time_jitter: f64, feels_gravity: bool) -> Quality {
    let pre_event = pre_event(wave);
    let moving = pre_event.filter(|_| feels_gravity).and_then(|before| moving_start(wave, &before));
    let samples = wave.samples();
    let (minimum, maximum) =
        samples.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
    let (minimum, maximum) = if samples.is_empty() { (0.0, 0.0) } else { (minimum, maximum) };
    let zero = moving.map(|moving| moving.rest_level).or(pre_event.map(|p| p.zero_level)).unwrap_or(0.0);
    let step = smallest_step(samples, minimum, maximum);
    let (constant_run, constant_run_from_s) = constant_run(wave, minimum, maximum, zero, step);
    let record = QualityV1 {
        zero_level: pre_event.map(|before| before.zero_level),
        noise_floor: pre_event.map(|before| before.noise_floor),
        pre_event_from_s: pre_event.map(|before| before.from_s),
        pre_event_to_s: pre_event.map(|before| before.to_s),
        sample_rate_hz: wave.rate_hz(),
        time_jitter,
        minimum,
        maximum,
        clipped_run: clipped_run(samples, minimum, maximum, zero, step),
        constant_run: Some(constant_run),
        constant_run_from_s,
        end_level: end_level(wave, zero),
        rest_level: moving.map(|moving| moving.rest_level),
    };
    Quality { pre_event, feels_gravity, moving, record }
}

/// A value that is lost, or cut off, lies this many steps of the sensor from its neighbours. A motion that is rounded
/// to steps stays below: the top of a parabola that rounds to one value over L samples falls by at most 4 steps in the
/// next L/2, noise of a step each way adds 2.
const STEPS_OF_A_JUMP: f64 = 6.0;
/// Differences below this share of the range are rounding of a unit, no step.
const ROUNDING: f64 = 1e-9;

/// The smallest difference of neighbours, which is the step of a sensor that rounds; 0 where all are equal.
fn smallest_step(samples: &[f64], minimum: f64, maximum: f64) -> f64 {
    let differences = samples.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let smallest = differences.filter(|step| *step > ROUNDING * (maximum - minimum)).fold(f64::INFINITY, f64::min);
    if smallest.is_finite() { smallest } else { 0.0 }
}

/// Whether a run of equal samples, first and last included, is left by a jump within `reach` samples of it; the ends of
/// the record are none.
fn jumps(samples: &[f64], [first, last]: [usize; 2], reach: usize, step: f64) -> bool {
    let is_far = |k: Option<usize>| {
        k.and_then(|k| samples.get(k)).is_some_and(|x| (x - samples[first]).abs() > STEPS_OF_A_JUMP * step)
    };
    is_far(first.checked_sub(reach)) || is_far(last.checked_add(reach))
}

/// Runs of equal samples: first and last sample.
fn equal_runs(samples: &[f64]) -> impl Iterator<Item = [usize; 2]> {
    let mut first = 0;
    samples.chunk_by(|a, b| a == b).map(move |run| {
        let from = first;
        first += run.len();
        [from, first - 1]
    })
}

/// The longest run of equal samples that is left by a jump while the signal is active: from the first to the last
/// sample after time zero, up to 150 ms, that is farther from the zero level than a tenth of the range. Runs at the
/// extremes are clipping and not counted here.
fn constant_run(wave: &Sampled, minimum: f64, maximum: f64, zero: f64, step: f64) -> (u64, Option<f64>) {
    let from = wave.index_at_or_after(0.0);
    let window = &wave.samples()[from..wave.index_at_or_after(ACTIVE_UNTIL_S).max(from)];
    let far = |x: &f64| (x - zero).abs() > 0.1 * (maximum - minimum);
    let (Some(start), Some(end)) = (window.iter().position(far), window.iter().rposition(far)) else {
        return (0, None);
    };
    let start = from + start;
    let (mut longest, mut at) = (1, start);
    for run in equal_runs(&wave.samples()[start..=from + end]) {
        let [first, last] = run.map(|k| start + k);
        let (length, x) = (last - first + 1, wave.samples()[first]);
        let is_extreme = far(&x) && (x == minimum || x == maximum);
        if length > longest && !is_extreme && jumps(wave.samples(), [first, last], 1, step) {
            (longest, at) = (length, first);
        }
    }
    (longest as u64, Some(wave.time_s(at)))
}

fn end_level(wave: &Sampled, zero: f64) -> Option<f64> {
    let from = wave.index_at_or_after(wave.end_s() - END_S);
    let window = wave.samples().get(from..).filter(|w| w.len() >= 2 && from > 0)?;
    Some(window.iter().sum::<f64>() / window.len() as f64 - zero).filter(|level| level.is_finite())
}

/// The longest run of equal samples at an extreme, where a recorder ran into its range. An extreme near the zero level
/// is the quiet part of a one-sided pulse and not counted: it must lie at least a tenth of the range away. Nor is a top
/// that a coarse sensor rounds: half a run away from it, the samples are then still near.
fn clipped_run(samples: &[f64], minimum: f64, maximum: f64, zero: f64, step: f64) -> u64 {
    let far = 0.1 * (maximum - minimum);
    let counts = |x: f64| far > 0.0 && (x == minimum || x == maximum) && (x - zero).abs() > far;
    let runs = equal_runs(samples).filter(|[first, _]| counts(samples[*first]));
    let cut = runs.filter(|[first, last]| jumps(samples, [*first, *last], (last - first).div_ceil(2).max(1), step));
    cut.map(|[first, last]| (last - first + 1) as u64).max().unwrap_or(0)
}

/// Line numbers of rows, as runs of rows on consecutive lines: a few bytes for a table without comments, however long.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct LineNumbers {
    /// First row of a run, and its line.
    runs: Vec<(usize, usize)>,
    rows: usize,
}

impl LineNumbers {
    /// Those of rows that are numbered from 1.
    pub fn of_rows(rows: usize) -> Self {
        Self { runs: vec![(0, 1)], rows }
    }

    /// Adds a row.
    #[inline]
    pub fn push(&mut self, line: usize) {
        let follows = self.runs.last().is_some_and(|(row, first)| first + (self.rows - row) == line);
        if !follows {
            self.runs.push((self.rows, line));
        }
        self.rows += 1;
    }

    /// Adds the rows of a part whose lines are counted from `line`.
    pub fn append(&mut self, part: &Self, line: usize) {
        for (k, (row, first)) in part.runs.iter().enumerate() {
            let end = part.runs.get(k + 1).map_or(part.rows, |next| next.0);
            self.push(line + first);
            self.rows += end - row - 1;
        }
    }

    /// Number of rows.
    #[expect(clippy::len_without_is_empty, reason = "nobody asks")]
    pub fn len(&self) -> usize {
        self.rows
    }

    /// The line of a row; 0 past the end.
    pub fn of_row(&self, row: usize) -> usize {
        let run = self.runs.partition_point(|(first, _)| *first <= row);
        self.runs.get(run.wrapping_sub(1)).filter(|_| row < self.rows).map_or(0, |(first, line)| line + (row - first))
    }
}

remarks! {
    /// Remarks of single channels.
    pub REMARKS;

    /// The laboratory that recorded a channel doubts it.
    CR101 Doubted { id: String, status: String, comment: String }
    bears on (About::Channel(id.clone()), Weight::Slight)
    decided "The file states the status of every channel and a comment of the laboratory; both are repeated."
    means "The pulse is chosen among valid channels. This one is kept as it was recorded: it may be wrong."
    remedy "do not use this channel before its plot looks right"
    says format!("channel {id} is {status} by its laboratory: {comment}");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_signal::STANDARD_GRAVITY_M_PER_S2;

    #[test]
    fn flat_tops_are_clipping_and_quiet_starts_are_not() {
        let quiet = Sampled::new(-0.02, 1e-3, vec![0.0, 0.0, 0.0, 0.0, -1.0, -3.0, -1.0]).unwrap();
        assert_eq!(measure(&quiet, 0.0, true).record.clipped_run, 0);
        let flat = Sampled::new(0.0, 1e-3, vec![0.0, -3.0, -3.0, -3.0, -3.0, 0.4, 0.0]).unwrap();
        assert_eq!(measure(&flat, 0.0, true).record.clipped_run, 4);
        let dead = Sampled::new(0.0, 1e-3, vec![7.0; 60]).unwrap();
        assert_eq!(measure(&dead, 0.0, true).record.clipped_run, 0);
    }

    /// 20 g over 0.1 s at 10 kHz, with a noise of up to ± half of `noise_g`, through a change and rounded to steps, g.
    fn half_sine(step: f64, noise_g: f64, change: impl Fn(f64, f64) -> f64) -> QualityV1 {
        let samples = (0..3000_i32).map(|k| {
            let t = f64::from(k) * 1e-4 - 0.1;
            let pulse = if (0.0..0.1).contains(&t) { -20.0 * (std::f64::consts::PI * t / 0.1).sin() } else { 0.0 };
            let noise = noise_g * (f64::from(k * 7919 % 1009) / 1009.0 - 0.5);
            (change(t, pulse + noise) / step).round() * step
        });
        measure(&Sampled::new(-0.1, 1e-4, samples.collect()).unwrap(), 0.0, true).record
    }

    #[test]
    fn equal_samples_of_a_coarse_sensor_are_neither_lost_nor_clipped() {
        let cases = [0.001, 0.05, 0.2, 0.5, 1.0].into_iter().flat_map(|step| [(step, 0.1), (step, 0.0)]);
        for (step, noise_g) in cases {
            let half_sine = |step: f64, change: fn(f64, f64) -> f64| half_sine(step, noise_g, change);
            let quality = half_sine(step, |_, a| a);
            assert_eq!((quality.lost_s(), quality.may_be_clipped()), (None, false), "{step} g");
            let lost = half_sine(step, |t, a| if (0.040..0.043).contains(&t) { 0.0 } else { a });
            let [from_s, to_s] = lost.lost_s().unwrap();
            assert!((from_s - 0.040).abs() < 2e-4 && (to_s - 0.043).abs() < 3e-4, "{step} g: {from_s} {to_s}");
            assert!(half_sine(step, |_, a| a.max(-12.0)).may_be_clipped(), "{step} g");
        }
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
        let pre = measure(&wave, 0.0, true).pre_event.unwrap();
        assert!((pre.zero_level / g - 0.35).abs() < 1e-9 && pre.samples == 401);
    }
}
