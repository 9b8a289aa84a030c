//! The driving and the answering waveforms of a stage run, cut to one window.

use crumple_identify::IoData;
use crumple_signal::{QuantityKind, Sampled, TestDescription};
use crumple_stage::{Inputs, RefuseExt, Refused, Wave};

use crate::options::{BeyondEra, Settings};
use crate::window;

/// What a user may do about waveforms that do not fit.
const HINT: &str = "name other waveforms with --inputs and --outputs";

/// One waveform of the window.
pub struct Cut {
    /// Id of the waveform.
    pub id: String,
    /// What it measures.
    pub quantity: QuantityKind,
    /// Its samples in the window.
    pub sampled: Sampled,
}

impl Cut {
    fn new(id: String, wave: &Wave, settings: &Settings, inputs: &Inputs) -> anyhow::Result<Self> {
        Ok(Self { quantity: wave.quantity, sampled: window(&wave.sampled, settings, inputs)?, id })
    }

    /// `displacement of channel 93/displacement, m`.
    pub fn describe(&self) -> String {
        format!("{} {}, {}", self.quantity.name(), self.id, self.quantity.si_unit())
    }
}

/// Waveforms sampled together.
pub struct Record {
    /// What drives; empty: nothing does.
    pub drives: Vec<Cut>,
    /// What answers, at least one.
    pub answers: Vec<Cut>,
    /// Their samples.
    pub data: IoData,
}

impl Record {
    /// Descriptions of all inputs, separated by semicolons.
    pub fn input(&self) -> String {
        if self.drives.is_empty() { "none (free motion)".to_owned() } else { described(&self.drives) }
    }

    /// Descriptions of all outputs.
    pub fn output(&self) -> String {
        described(&self.answers)
    }

    /// Whether there is one input and one output.
    pub fn single(&self) -> bool {
        self.drives.len() == 1 && self.answers.len() == 1
    }
}

fn described(cuts: &[Cut]) -> String {
    cuts.iter().map(Cut::describe).collect::<Vec<_>>().join("; ")
}

/// The first answering waveform: as asked for, else the displacement of the pulse.
pub fn output(settings: &Settings, beyond: &BeyondEra, test: &TestDescription, inputs: &Inputs) -> anyhow::Result<Cut> {
    let mut outputs = outputs(settings, beyond, test, inputs)?;
    Ok(outputs.swap_remove(0))
}

fn outputs(
    settings: &Settings,
    beyond: &BeyondEra,
    test: &TestDescription,
    inputs: &Inputs,
) -> anyhow::Result<Vec<Cut>> {
    if beyond.outputs.is_empty() {
        let id = format!("{}/displacement", crate::channel(settings, test)?);
        let wave = inputs.wave(&id)?;
        return Ok(vec![Cut::new(id, wave, settings, inputs)?]);
    }
    beyond.outputs.iter().map(|id| Cut::new(id.clone(), inputs.wave(id)?, settings, inputs)).collect()
}

/// Inputs and outputs, sampled together.
pub fn record(
    settings: &Settings,
    beyond: &BeyondEra,
    test: &TestDescription,
    inputs: &Inputs,
) -> anyhow::Result<Record> {
    let answers = outputs(settings, beyond, test, inputs)?;
    let ids = match &beyond.inputs[..] {
        [] => vec![crate::channel(settings, test)?.to_owned()],
        [none] if none == "none" => Vec::new(),
        several => several.to_vec(),
    };
    let drives = ids
        .into_iter()
        .map(|id| {
            let wave = inputs.wave(&id)?;
            Cut::new(id, wave, settings, inputs)
        })
        .collect::<anyhow::Result<Vec<_>>>()?;
    let first = &answers[0];
    for other in drives.iter().chain(&answers[1..]) {
        together(other, first)?;
    }
    let samples = |cuts: &[Cut]| cuts.iter().map(|cut| cut.sampled.samples().to_vec()).collect();
    let data = IoData::new(samples(&drives), samples(&answers), first.sampled.dt_s()).refuse_with_hint(HINT)?;
    Ok(Record { drives, answers, data })
}

fn together(one: &Cut, other: &Cut) -> anyhow::Result<()> {
    let (u, y) = (&one.sampled, &other.sampled);
    let dt = y.dt_s();
    let apart = (u.t0_s() - y.t0_s()).abs() > 1e-6 * dt || (u.dt_s() / dt - 1.0).abs() > 1e-9;
    if apart || u.len() != y.len() {
        return Err(Refused::new(format!(
            "waveforms {} and {} are not sampled together: {} samples of {} s from {} s, and {} of {} s from {} s",
            one.id,
            other.id,
            u.len(),
            u.dt_s(),
            u.t0_s(),
            y.len(),
            dt,
            y.t0_s()
        ))
        .hint("name waveforms of one time base with --inputs and --outputs, or a window that all have")
        .into());
    }
    Ok(())
}
