//! The waveforms of a run: which ones, which window of them, how they are scaled.

use crumple_signal::{About, Note, QuantityKind, Sampled, TestDescription, Weight, remarks};
use crumple_stage::records::{ChannelFilterV1, EventsV1};
use crumple_stage::{Inputs, RefuseExt, Refused, Wave, option, program};
use crumple_sysid::{EraError, FilterEdge, IoData, MarkovParameters, Realization, end_of_contact, straight_line};

use crate::stage::options::settings::InputOutputSettings;
use crate::stage::options::settings::Settings;

// Inputs and outputs of a run: waveforms sampled together, in one window.

/// What a user may do about waveforms that do not fit.
fn other_waveforms() -> String {
    format!("name other waveforms with {} and {}", flag("inputs"), flag("outputs"))
}

/// A flag of this stage as its user types it.
pub fn flag(name: &str) -> String {
    crumple_stage::flag("identify", name)
}

/// What to do where the window holds too little: "widen the window (--from, --to)".
pub fn widen_the_window() -> String {
    format!("widen the window ({}, {})", flag("from"), flag("to"))
}

/// What a user may do about a record without a crash pulse.
fn no_pulse() -> String {
    format!("name what drives with {} and what answers with {}", flag("inputs"), flag("outputs"))
}

/// Frequency times width at which a moving average leaves 1/√2: root of `sin(πx)/(πx) = 1/√2`.
const MOVING_AVERAGE_EDGE: f64 = 0.442_946;

/// A waveform within the window of the run.
pub struct WindowedWave {
    /// Id of the waveform.
    pub id: String,
    /// What it measures.
    pub quantity: QuantityKind,
    /// Its samples in the window.
    pub sampled: Sampled,
    /// Samples after the window that are kept for validation.
    pub kept: Vec<f64>,
    /// Edges of the filter it went through, if known: that of the channel it was made from.
    pub edges: Vec<FilterEdge>,
    /// Level and slope a sample that were subtracted from all samples.
    pub removed: (f64, f64),
    /// Decay rate of the exponential window that it was multiplied with, 1/s; 0: there was none.
    pub window_per_s: f64,
}

impl WindowedWave {
    /// The window of a waveform.
    pub fn new(id: String, wave: &Wave, source: Source<'_>) -> anyhow::Result<Self> {
        let Window { used, kept } = window(&wave.sampled, source)?;
        let channel = id.split('/').next().unwrap_or(&id);
        let edges = match source.inputs.record_if::<ChannelFilterV1>(&format!("/filter/{channel}"))? {
            Some(record) => edges_of(&record),
            None => Vec::new(),
        };
        let cfc = source.test.channel(&id).or_else(|| source.test.channel(channel)).and_then(|c| c.cfc);
        // Without a filter of ours, the class that the record came with.
        let edges = if edges.is_empty() { cfc.into_iter().map(FilterEdge::of_class).collect() } else { edges };
        let window_per_s = source.settings.window_per_s.unwrap_or(0.0);
        Ok(Self { quantity: wave.quantity, sampled: used, kept, edges, id, removed: (0.0, 0.0), window_per_s })
    }

    /// All samples, those kept for validation too.
    pub fn whole(&self) -> Vec<f64> {
        self.sampled.samples().iter().chain(&self.kept).copied().collect()
    }

    /// First time of the samples kept for validation, s.
    pub fn kept_from_s(&self) -> Option<f64> {
        (!self.kept.is_empty()).then(|| self.sampled.time_s(self.sampled.len()))
    }

    /// `displacement 93/displacement, m`.
    pub fn describe(&self) -> String {
        format!("{} {}, {}", self.quantity.name(), self.id, self.quantity.si_unit())
    }

    /// Subtracts the mean over the samples that a model is identified from, also from those kept.
    fn remove_mean(&mut self) -> anyhow::Result<()> {
        let mean = self.sampled.samples().iter().sum::<f64>() / self.sampled.len().max(1) as f64;
        self.remove(mean, 0.0)
    }

    /// The same with the straight line through them.
    fn remove_trend(&mut self) -> anyhow::Result<()> {
        let (intercept, slope) = straight_line(self.sampled.samples());
        self.remove(intercept, slope)
    }

    fn remove(&mut self, level: f64, slope: f64) -> anyhow::Result<()> {
        let at = |k: usize| level + slope * k as f64;
        let used = self.sampled.len();
        let rest = self.sampled.samples().iter().enumerate().map(|(k, x)| x - at(k)).collect();
        self.sampled = Sampled::new(self.sampled.t0_s(), self.sampled.dt_s(), rest)?;
        self.kept.iter_mut().enumerate().for_each(|(k, x)| *x -= at(used + k));
        self.removed = (level, slope);
        Ok(())
    }

    /// What was subtracted.
    pub fn removed(&self) -> Option<Note> {
        let (level, slope) = self.removed;
        let (waveform, unit) = (self.id.clone(), self.unit().to_owned());
        match (level, slope) {
            (0.0, 0.0) => None,
            (mean, 0.0) => Some(Removed { waveform, mean: Some(mean), slope_per_s: None, unit }.into()),
            _ => {
                let slope_per_s = Some(slope / self.sampled.dt_s());
                Some(Removed { waveform, mean: None, slope_per_s, unit }.into())
            }
        }
    }

    /// The unit; nothing where it is 1.
    pub fn unit(&self) -> &'static str {
        Some(self.quantity.si_unit()).filter(|unit| *unit != "1").unwrap_or_default()
    }

    /// Errors unless the other has the same times; `hint` says what to do.
    pub fn require_same_times(&self, other: &Self, hint: &str) -> anyhow::Result<()> {
        let (u, y) = (&self.sampled, &other.sampled);
        let dt = y.dt_s();
        let apart = (u.t0_s() - y.t0_s()).abs() > 1e-6 * dt || (u.dt_s() / dt - 1.0).abs() > 1e-9;
        let (samples, other_samples) = (u.len() + self.kept.len(), y.len() + other.kept.len());
        if apart || u.len() != y.len() || samples != other_samples {
            return Err(Refused::new(format!(
                "waveforms {} and {} are not sampled together: {samples} samples of {} s from {} s, and \
                 {other_samples} of {dt} s from {} s",
                self.id,
                other.id,
                u.dt_s(),
                u.t0_s(),
                y.t0_s()
            ))
            .hint(hint)
            .into());
        }
        Ok(())
    }
}

/// A unit behind a blank; nothing where there is none.
pub fn behind_blank(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

/// Edges of the filter that the first waveform with a filter went through.
pub fn filter_edges<'a>(waves: impl IntoIterator<Item = &'a WindowedWave>) -> &'a [FilterEdge] {
    waves.into_iter().map(|wave| &wave.edges[..]).find(|edges| !edges.is_empty()).unwrap_or_default()
}

/// Edges (-3 dB) of the filter of a channel: of a class, of a Butterworth filter as it was run, or of a moving average.
fn edges_of(record: &ChannelFilterV1) -> Vec<FilterEdge> {
    let butterworth = |hz: &f64| FilterEdge { hz: *hz, filter: format!("{} filter", record.mode) };
    let class = record.cfc.map(FilterEdge::of_class);
    let average = record.width_s.map(|width_s| FilterEdge {
        hz: MOVING_AVERAGE_EDGE / width_s,
        filter: format!("moving average over {width_s} s"),
    });
    let all = record.cutoff_hz.iter().map(butterworth).chain(class).chain(average);
    all.filter(|edge| edge.hz.is_finite() && edge.hz > 0.0).collect()
}

/// Waveforms sampled together.
pub struct Record {
    /// What drives; empty: nothing does.
    pub inputs: Vec<WindowedWave>,
    /// What answers, at least one.
    pub outputs: Vec<WindowedWave>,
    /// Their samples in the window.
    pub data: IoData,
    /// The same with those after it that are kept for validation.
    pub whole: IoData,
    /// Time by which the inputs act late, s, if they do.
    pub delay_s: Option<f64>,
    /// What was done to the samples, for the notes of every model.
    pub remarks: Vec<Note>,
    /// Frequencies of machines that run, rad/s.
    pub harmonics_rad_per_s: Vec<f64>,
}

impl Record {
    /// Descriptions of all inputs, separated by semicolons.
    pub fn input(&self) -> String {
        if self.inputs.is_empty() { "none (free motion)".to_owned() } else { described(&self.inputs) }
    }

    /// Descriptions of all outputs.
    pub fn output(&self) -> String {
        described(&self.outputs)
    }

    /// Whether there is one input and one output.
    pub fn single(&self) -> bool {
        self.inputs.len() == 1 && self.outputs.len() == 1
    }

    /// All waveforms, the answering ones first.
    pub fn waves(&self) -> Vec<&WindowedWave> {
        self.outputs.iter().chain(&self.inputs).collect()
    }
}

fn described(waves: &[WindowedWave]) -> String {
    waves.iter().map(WindowedWave::describe).collect::<Vec<_>>().join("; ")
}

/// The first answering waveform: as asked for, else the displacement of the pulse, or the channel where that is no
/// acceleration.
pub fn output(source: Source<'_>, input_output: &InputOutputSettings) -> anyhow::Result<WindowedWave> {
    let mut outputs = outputs(source, input_output)?;
    Ok(outputs.swap_remove(0))
}

fn outputs(source: Source<'_>, input_output: &InputOutputSettings) -> anyhow::Result<Vec<WindowedWave>> {
    if input_output.outputs.is_empty() {
        let channel = channel(source, &no_pulse())?;
        let answer =
            if answers_itself(source, channel) { channel.to_owned() } else { format!("{channel}/displacement") };
        return waves(vec![answer], source);
    }
    waves(input_output.outputs.clone(), source)
}

/// Whether a channel is its own answer: it is measured as another quantity than an acceleration, and nothing drives it.
fn answers_itself(source: Source<'_>, channel: &str) -> bool {
    source.inputs.wave_if(channel).is_some_and(|wave| wave.quantity != QuantityKind::Acceleration)
}

/// The windows of waveforms, any quantity, without the mean or the straight line that is to be removed.
pub fn waves(ids: Vec<String>, source: Source<'_>) -> anyhow::Result<Vec<WindowedWave>> {
    let asked = source.settings.input_output.as_ref();
    ids.into_iter()
        .map(|id| {
            let wave = find_wave(&id, source)?;
            let mut wave = WindowedWave::new(id, wave, source)?;
            match asked {
                Some(asked) if asked.remove_trend => wave.remove_trend()?,
                Some(asked) if asked.remove_mean => wave.remove_mean()?,
                _ => {}
            }
            Ok(wave)
        })
        .collect()
}

/// A waveform by its id. Where no channel of the test has that name, the error lists the waveforms that there are.
fn find_wave<'a>(id: &str, source: Source<'a>) -> anyhow::Result<&'a Wave> {
    let Source { test, inputs, .. } = source;
    let channel = id.split('/').next().unwrap_or(id);
    match inputs.wave_if(id) {
        Some(wave) => Ok(wave),
        // A known channel whose waveform another stage writes.
        None if test.channel(channel).is_some() || inputs.waves().next().is_none() => inputs.wave(id),
        None => {
            let names: Vec<&str> = inputs.waves().map(|(id, _)| id).collect();
            let text = format!("there is no waveform {id:?}, the inputs hold: {}", names.join(", "));
            Err(Refused::new(text)
                .hint(format!("name one of them with {} or {}", flag("inputs"), flag("outputs")))
                .into())
        }
    }
}

/// Inputs and outputs, sampled together.
pub fn record(source: Source<'_>, input_output: &InputOutputSettings) -> anyhow::Result<Record> {
    let mut outputs = outputs(source, input_output)?;
    let ids = match &input_output.inputs[..] {
        [] => {
            let channel = channel(source, &no_pulse())?;
            // Nothing drives what answers by itself.
            let is_free = input_output.outputs.is_empty() && answers_itself(source, channel);
            if is_free { Vec::new() } else { vec![channel.to_owned()] }
        }
        [none] if none == "none" => Vec::new(),
        several => several.to_vec(),
    };
    let mut inputs = waves(ids, source)?;
    let is_asked = input_output.remove_mean || input_output.remove_trend;
    if input_output.remove_mean_unless_crash && !is_asked && !source.is_of_a_crash() {
        outputs.iter_mut().chain(&mut inputs).try_for_each(WindowedWave::remove_mean)?;
    }
    let remarks = outputs.iter().chain(&inputs).filter_map(WindowedWave::removed).collect();
    let first = &outputs[0];
    for other in inputs.iter().chain(&outputs[1..]) {
        let (inputs, outputs) = (flag("inputs"), flag("outputs"));
        let hint = format!("name waveforms of one time base with {inputs} and {outputs}, or a window that all have");
        other.require_same_times(first, &hint)?;
    }
    let data = |samples: &dyn Fn(&WindowedWave) -> Vec<f64>| {
        let signals_of = |waves: &[WindowedWave]| waves.iter().map(samples).collect();
        IoData::new(signals_of(&inputs), signals_of(&outputs), first.sampled.dt_s()).refuse_with_hint(other_waveforms())
    };
    let (used, whole) = (data(&|wave| wave.sampled.samples().to_vec())?, data(&WindowedWave::whole)?);
    let delay_s =
        (input_output.delay > 0 && !inputs.is_empty()).then(|| input_output.delay as f64 * first.sampled.dt_s());
    let harmonics_rad_per_s = input_output.harmonics_rad_per_s.clone();
    Ok(Record { inputs, outputs, data: used, whole, delay_s, remarks, harmonics_rad_per_s })
}

/// Levels above this share of the root mean square about them are named.
const NAMED_LEVEL: f64 = 1.0;

/// What may be wrong with waveforms that lie far from zero: a linear model has no constant. `None` of a crash, where
/// the level of a motion is its result, and where the mean is removed.
pub fn level_note(source: Source<'_>) -> anyhow::Result<Option<Note>> {
    let Some(input_output) = source.settings.input_output.as_ref().filter(|_| !source.is_of_a_crash()) else {
        return Ok(None);
    };
    if input_output.remove_mean || input_output.remove_mean_unless_crash || input_output.remove_trend {
        return Ok(None);
    }
    // Where the waveforms are refused, the methods have said so.
    let Ok(record) = record(source, input_output) else { return Ok(None) };
    let levels: Vec<String> = record.waves().into_iter().filter_map(level_in_words).collect();
    Ok((!levels.is_empty()).then(|| FarFromZero { levels }.into()))
}

/// `y is 5.1 V, 12 times its standard deviation`, where that is much.
fn level_in_words(wave: &WindowedWave) -> Option<String> {
    let samples = wave.sampled.samples();
    let mean_of = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / samples.len() as f64;
    let mean = mean_of(&mut samples.iter().copied());
    let deviation = mean_of(&mut samples.iter().map(|x| (x - mean).powi(2))).sqrt();
    (deviation > 0.0 && mean.abs() > NAMED_LEVEL * deviation).then(|| {
        let (id, times) = (&wave.id, mean.abs() / deviation);
        format!("{id} is {mean:.4}{}, {times:.1} times its standard deviation", behind_blank(wave.unit()))
    })
}

// Waveforms of several quantities, scaled so that ERA can take them together.

/// The samples of waveforms as ERA is given them: of different quantities each divided by its root mean square, for
/// sequences count by their size.
pub struct ScaledWaves<'a> {
    waves: &'a [WindowedWave],
    /// Divisors and the divided samples; empty where the quantity is one.
    scales: Vec<f64>,
    scaled: Vec<Vec<f64>>,
}

impl<'a> ScaledWaves<'a> {
    /// Of waveforms sampled together, at least one.
    pub fn new(waves: &'a [WindowedWave]) -> Self {
        if waves.iter().all(|wave| wave.quantity == waves[0].quantity) {
            return Self { waves, scales: Vec::new(), scaled: Vec::new() };
        }
        let scales: Vec<f64> = waves.iter().map(|wave| root_mean_square(wave.sampled.samples())).collect();
        let divided = |(wave, scale): (&WindowedWave, &f64)| wave.sampled.samples().iter().map(|x| x / scale).collect();
        let scaled = waves.iter().zip(&scales).map(divided).collect();
        Self { waves, scales, scaled }
    }

    /// One a waveform.
    pub fn slices(&self) -> Vec<&[f64]> {
        if self.scaled.is_empty() {
            return self.waves.iter().map(|wave| wave.sampled.samples()).collect();
        }
        self.scaled.iter().map(Vec::as_slice).collect()
    }

    /// The same as Markov parameters of one impulse.
    pub fn markov(&self) -> Result<MarkovParameters<'_>, EraError> {
        MarkovParameters::new(self.slices(), 1)
    }

    /// Other samples of the same waveforms, divided alike.
    pub fn divided(&self, samples: &[Vec<f64>]) -> Vec<Vec<f64>> {
        if self.scales.is_empty() {
            return samples.to_vec();
        }
        samples.iter().zip(&self.scales).map(|(y, scale)| y.iter().map(|x| x / scale).collect()).collect()
    }

    /// The model of the samples as they are.
    pub fn unscaled(&self, model: Realization) -> Realization {
        if self.scales.is_empty() { model } else { model.with_outputs_times(&self.scales) }
    }
}

/// 1 for silence.
fn root_mean_square(samples: &[f64]) -> f64 {
    let largest = samples.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    if largest == 0.0 {
        return 1.0;
    }
    let sum: f64 = samples.iter().map(|x| (x / largest).powi(2)).sum();
    largest * (sum / samples.len() as f64).sqrt()
}

// What the waveforms of a run are taken from.

/// Settings, test and artifacts of a run.
#[derive(Clone, Copy)]
pub struct Source<'a> {
    /// Settings of the stage.
    pub settings: &'a Settings,
    /// The test that the artifacts are of.
    pub test: &'a TestDescription,
    /// The artifacts read.
    pub inputs: &'a Inputs,
}

impl Source<'_> {
    /// Whether the record is of a crash: it has a pulse, or its events. Any other record has inputs and outputs.
    pub fn is_of_a_crash(&self) -> bool {
        self.test.pulse_channel().is_ok() || self.inputs.record_if::<EventsV1>("/events").ok().flatten().is_some()
    }
}

// The window of a run: its channel, where it starts, and the samples in it.

/// Start of the window, s after time zero, and how it was found where that is not simply `--from`.
pub fn window_start(source: Source<'_>) -> anyhow::Result<(f64, Option<FreeDecayStart>)> {
    let Source { settings, test, inputs } = source;
    let Some(share) = settings.hankel.as_ref().and_then(|hankel| hankel.free_decay_share) else {
        return Ok((settings.from_s, None));
    };
    let events = inputs.record_if::<EventsV1>("/events")?;
    if share == 0.0 {
        let Some(events) = events else {
            return Err(Refused::new("free decay from separation on, but there is no topic /events")
                .hint(format!(
                    "add the artifact of {}, or give a share of the peak, e.g. {}",
                    program("integrate"),
                    option("identify", "free-decay", "5%")
                ))
                .into());
        };
        let Some(time_s) = events.time_of_rebound_s else {
            return Err(Refused::new("the record of /events shows no time of rebound, hence no separation")
                .hint(format!(
                    "give a share of the peak, e.g. {}, or {}",
                    option("identify", "free-decay", "5%"),
                    flag("from")
                ))
                .into());
        };
        let start_s = time_s.max(settings.from_s);
        return Ok((start_s, Some(FreeDecayStart { start_s, channel: None, peak_percent: None })));
    }
    // The crash pulse is the channel that the events were read from.
    let pulse = match &events {
        Some(events) => &events.channel,
        None => &test.pulse_channel().refuse_with_hint(format!("give the start as a time with {}", flag("from")))?.id,
    };
    let wave = &inputs.wave(pulse)?.sampled;
    let first = wave.index_at_or_after(settings.from_s);
    let end = settings.to_s.map_or(wave.len(), |to| wave.index_at_or_after(to + wave.dt_s() / 2.0));
    let force = wave.slice(first, end);
    let Some(after) = end_of_contact(force.samples(), share) else {
        return Err(Refused::new(format!(
            "channel {pulse} does not stay under {} % of its peak before the window ends: there is no free decay",
            100.0 * share
        ))
        .hint(format!("give a larger share, a later {}, or the start as a time with {}", flag("to"), flag("from")))
        .into());
    };
    let start_s = force.t0_s() + after as f64 * force.dt_s();
    let (channel, peak_percent) = (Some(pulse.clone()), Some(100.0 * share));
    Ok((start_s, Some(FreeDecayStart { start_s, channel, peak_percent })))
}

/// The channel asked for, else the crash pulse; `hint` tells what to name where there is none.
pub fn channel<'a>(source: Source<'a>, hint: &str) -> anyhow::Result<&'a str> {
    match &source.settings.channel {
        Some(id) => Ok(id),
        None => Ok(&source.test.pulse_channel().refuse_with_hint(hint)?.id),
    }
}

/// The samples of a record that a model is identified from, and those after them that are kept for validation.
pub struct Window {
    /// Identified from.
    pub used: Sampled,
    /// What follows, if samples are kept for validation: no gap between.
    pub kept: Vec<f64>,
}

/// The part of the record that is used. The window counts from contact, as the times of the record do.
pub fn window(record: &Sampled, source: Source<'_>) -> anyhow::Result<Window> {
    let settings = source.settings;
    // Half a sample of room for the rounding of times.
    let (from_s, rule) = window_start(source)?;
    let room_s = if rule.is_some() { record.dt_s() / 2.0 } else { 0.0 };
    let first = record.index_at_or_after(from_s - room_s);
    // The sample at `to` itself belongs to the window.
    let end = settings.to_s.map_or(record.len(), |to| record.index_at_or_after(to + record.dt_s() / 2.0));
    let by_time = settings.validate_from_s.map_or(end, |from| end.min(record.index_at_or_after(from)));
    // The sample at the share is the first of those kept.
    let by_share = |share: f64| first + (share * end.saturating_sub(first) as f64).ceil() as usize;
    let used = settings.validate_from_share.map_or(by_time, |share| end.min(by_share(share)));
    let keeps_some = settings.validate_from_s.is_some() || settings.validate_from_share.is_some();
    let kept = record.slice(used.max(first), end).samples().to_vec();
    let end = settings.samples.map_or(used, |count| used.min(first.saturating_add(count)));
    let window = record.slice(first, end);
    if window.is_empty() {
        return Err(Refused::new(format!(
            "the window from {} s holds no sample: the record runs from {:.6} s to {:.6} s",
            settings.from_s,
            record.t0_s(),
            record.end_s()
        ))
        .hint(format!("{} and {} take times inside the record", flag("from"), flag("to")))
        .into());
    }
    if keeps_some && (kept.is_empty() || end < used) {
        return Err(Refused::new("no sample is left for the validation, or --samples ends before it begins")
            .hint(format!("{} takes a time inside the window, without {}", flag("validate-from"), flag("samples")))
            .into());
    }
    let kept = if keeps_some { kept } else { Vec::new() };
    Ok(Window { used: window, kept })
}

remarks! {
    /// Remarks of waveforms and of their window.
    pub REMARKS;

    /// The mean, or a straight line, was removed from a waveform before the models were fitted.
    CR424 Removed { waveform: String, mean: Option<f64>, slope_per_s: Option<f64>, unit: String }
    bears on (About::IdentifiedModels, Weight::None)
    decided "--remove-mean or --remove-trend asks for it, or --methods auto does on a record of inputs and outputs. \
             The samples that are identified from give the level."
    means "The models are those of the motion about this level. Simulated outputs have the level added again."
    remedy "nothing; --remove-mean=false keeps the level"
    says {
        let unit = behind_blank(unit);
        match (mean, slope_per_s) {
            (Some(mean), _) => {
                format!("the mean of the samples identified from, {mean:.6}{unit}, was removed from {waveform}")
            }
            (None, slope_per_s) => format!(
                "the straight line through the samples identified from, slope {:.6}{unit}/s, was removed from \
                 {waveform}",
                slope_per_s.unwrap_or_default()
            ),
        }
    };

    /// Waveforms lie far from zero, and a linear model has no constant.
    CR425 FarFromZero { levels: Vec<String> }
    bears on (About::IdentifiedModels, Weight::Marked)
    decided "The mean is larger than the standard deviation about it, and neither --remove-mean nor --remove-trend is \
             given."
    means "The models spend poles on the level. Frequencies, damping ratios and fits are off."
    remedy "add --remove-mean, unless the level is part of the motion"
    says format!(
        "the mean of {}: a linear model has no constant; if the level is no part of the motion, add --remove-mean",
        levels.join(", of ")
    );

    /// The window starts where the contact force has ended.
    CR426 FreeDecayStart { start_s: f64, channel: Option<String>, peak_percent: Option<f64> }
    bears on (About::IdentifiedModels, Weight::None)
    decided "--free-decay asks for it: at the rebound of /events, or where the pulse stays under the share of its peak."
    means "The models are those of the free motion behind the contact. The contact is not in them."
    remedy "nothing; --from states another start, leave --free-decay out for the whole record"
    says match (channel, peak_percent) {
        (Some(channel), Some(percent)) => format!(
            "free decay from {start_s:.5} s on, after the last sample of channel {channel} with {percent} % of its peak"
        ),
        _ => format!(
            "free decay from {start_s:.5} s on, the time of the rebound velocity, when the vehicle parts from the \
             barrier"
        ),
    };
}
