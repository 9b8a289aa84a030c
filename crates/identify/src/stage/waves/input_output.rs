//! Inputs and outputs of a run: waveforms sampled together, in one window.

use crumple_signal::{About, Note, QuantityKind, Sampled, Weight};
use crumple_stage::records::ChannelFilterV1;
use crumple_stage::{RefuseExt, Refused, Wave};
use crumple_sysid::{FilterEdge, IoData};

use crate::stage::options::input_output::InputOutputSettings;
use crate::stage::waves::source::Source;
use crate::stage::waves::window::{Window, channel, window};

/// What a user may do about waveforms that do not fit.
const HINT: &str = "name other waveforms with --inputs and --outputs";

/// What a user may do about a record without a crash pulse.
const NO_PULSE: &str = "name what drives with --inputs and what answers with --outputs";

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
        Ok(Self { quantity: wave.quantity, sampled: used, kept, edges, id })
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

    /// Subtracts the mean over the samples that a model is identified from, also from those kept; says which.
    pub fn remove_mean(&mut self) -> anyhow::Result<String> {
        let mean = self.sampled.samples().iter().sum::<f64>() / self.sampled.len().max(1) as f64;
        let centred = self.sampled.samples().iter().map(|x| x - mean).collect();
        self.sampled = Sampled::new(self.sampled.t0_s(), self.sampled.dt_s(), centred)?;
        self.kept.iter_mut().for_each(|x| *x -= mean);
        Ok(format!(
            "the mean of the samples identified from, {mean:.6e} {}, was removed from {}",
            self.quantity.si_unit(),
            self.id
        ))
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
    pub remarks: Vec<String>,
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

/// The first answering waveform: as asked for, else the displacement of the pulse.
pub fn output(source: Source<'_>, input_output: &InputOutputSettings) -> anyhow::Result<WindowedWave> {
    let mut outputs = outputs(source, input_output)?;
    Ok(outputs.swap_remove(0))
}

fn outputs(source: Source<'_>, input_output: &InputOutputSettings) -> anyhow::Result<Vec<WindowedWave>> {
    if input_output.outputs.is_empty() {
        let pulse = channel(source, NO_PULSE)?;
        return waves(vec![format!("{pulse}/displacement")], source);
    }
    waves(input_output.outputs.clone(), source)
}

/// The windows of waveforms, any quantity.
pub fn waves(ids: Vec<String>, source: Source<'_>) -> anyhow::Result<Vec<WindowedWave>> {
    ids.into_iter()
        .map(|id| {
            let wave = find_wave(&id, source)?;
            WindowedWave::new(id, wave, source)
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
            Err(Refused::new(text).hint("name one of them with --inputs or --outputs").into())
        }
    }
}

/// Inputs and outputs, sampled together.
pub fn record(source: Source<'_>, input_output: &InputOutputSettings) -> anyhow::Result<Record> {
    let mut outputs = outputs(source, input_output)?;
    let ids = match &input_output.inputs[..] {
        [] => vec![channel(source, NO_PULSE)?.to_owned()],
        [none] if none == "none" => Vec::new(),
        several => several.to_vec(),
    };
    let mut inputs = waves(ids, source)?;
    let mut remarks = Vec::new();
    if input_output.remove_mean {
        for wave in outputs.iter_mut().chain(&mut inputs) {
            remarks.push(wave.remove_mean()?);
        }
    }
    let first = &outputs[0];
    for other in inputs.iter().chain(&outputs[1..]) {
        let hint = "name waveforms of one time base with --inputs and --outputs, or a window that all have";
        other.require_same_times(first, hint)?;
    }
    let data = |samples: &dyn Fn(&WindowedWave) -> Vec<f64>| {
        let signals_of = |waves: &[WindowedWave]| waves.iter().map(samples).collect();
        IoData::new(signals_of(&inputs), signals_of(&outputs), first.sampled.dt_s()).refuse_with_hint(HINT)
    };
    let (used, whole) = (data(&|wave| wave.sampled.samples().to_vec())?, data(&WindowedWave::whole)?);
    let delay_s =
        (input_output.delay > 0 && !inputs.is_empty()).then(|| input_output.delay as f64 * first.sampled.dt_s());
    Ok(Record { inputs, outputs, data: used, whole, delay_s, remarks })
}

/// Levels above this share of the root mean square about them are named.
const NAMED_LEVEL: f64 = 1.0;

/// What may be wrong with waveforms that lie far from zero: a linear model has no constant. `None` of a crash, where
/// the level of a motion is its result, and where the mean is removed.
pub fn level_note(source: Source<'_>) -> anyhow::Result<Option<Note>> {
    let Some(input_output) = source.settings.input_output.as_ref().filter(|_| !source.is_of_a_crash()) else {
        return Ok(None);
    };
    if input_output.remove_mean {
        return Ok(None);
    }
    // Where the waveforms are refused, the methods have said so.
    let Ok(record) = record(source, input_output) else { return Ok(None) };
    let levels: Vec<String> = record.waves().into_iter().filter_map(level_in_words).collect();
    let text = format!(
        "the mean of {}: a linear model has no constant; if the level is no part of the motion, add --remove-mean",
        levels.join(", of ")
    );
    Ok((!levels.is_empty()).then(|| Note::warning(text).bears_on(About::IdentifiedModels, Weight::Marked)))
}

/// `y is 5.1 V, 12 times its standard deviation`, where that is much.
fn level_in_words(wave: &WindowedWave) -> Option<String> {
    let samples = wave.sampled.samples();
    let mean_of = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / samples.len() as f64;
    let mean = mean_of(&mut samples.iter().copied());
    let deviation = mean_of(&mut samples.iter().map(|x| (x - mean).powi(2))).sqrt();
    (deviation > 0.0 && mean.abs() > NAMED_LEVEL * deviation).then(|| {
        // A number without a unit has the unit 1.
        let unit = Some(wave.quantity.si_unit()).filter(|unit| *unit != "1").map(|unit| format!(" {unit}"));
        let (id, times) = (&wave.id, mean.abs() / deviation);
        format!("{id} is {mean:.4}{}, {times:.1} times its standard deviation", unit.unwrap_or_default())
    })
}
