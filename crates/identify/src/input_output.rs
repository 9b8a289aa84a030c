//! The driving and the answering waveforms of a stage run, cut to one window.

use crumple_identify::IoData;
use crumple_signal::{QuantityKind, Sampled, TestDescription};
use crumple_stage::{Inputs, RefuseExt, Refused, Wave};

use crate::beyond_era::BeyondEra;
use crate::options::Settings;
use crate::{Window, window};

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
    /// Samples after the window that are kept for validation.
    pub kept: Vec<f64>,
    /// Class of the filter it went through, if known: that of the channel it was made from.
    pub cfc: Option<u16>,
}

impl Cut {
    /// The window of a waveform.
    pub fn new(
        id: String,
        wave: &Wave,
        settings: &Settings,
        test: &TestDescription,
        inputs: &Inputs,
    ) -> anyhow::Result<Self> {
        let Window { used, kept } = window(&wave.sampled, settings, inputs)?;
        let channel = id.split('/').next().unwrap_or(&id);
        let cfc = test.channel(&id).or_else(|| test.channel(channel)).and_then(|c| c.cfc);
        Ok(Self { quantity: wave.quantity, sampled: used, kept, cfc, id })
    }

    /// All samples, those kept for validation too.
    pub fn whole(&self) -> Vec<f64> {
        self.sampled.samples().iter().chain(&self.kept).copied().collect()
    }

    /// First time of the samples kept for validation, s.
    pub fn kept_from_s(&self) -> Option<f64> {
        (!self.kept.is_empty()).then(|| self.sampled.time_s(self.sampled.len()))
    }

    /// `displacement of channel 93/displacement, m`.
    pub fn describe(&self) -> String {
        format!("{} {}, {}", self.quantity.name(), self.id, self.quantity.si_unit())
    }

    /// Errors unless the other has the same times; `hint` says what to do.
    pub fn together_with(&self, other: &Self, hint: &str) -> anyhow::Result<()> {
        let (u, y) = (&self.sampled, &other.sampled);
        let dt = y.dt_s();
        let apart = (u.t0_s() - y.t0_s()).abs() > 1e-6 * dt || (u.dt_s() / dt - 1.0).abs() > 1e-9;
        let (here, there) = (u.len() + self.kept.len(), y.len() + other.kept.len());
        if apart || u.len() != y.len() || here != there {
            return Err(Refused::new(format!(
                "waveforms {} and {} are not sampled together: {here} samples of {} s from {} s, and {there} of {dt} s from {} s",
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

/// Waveforms sampled together.
pub struct Record {
    /// What drives; empty: nothing does.
    pub drives: Vec<Cut>,
    /// What answers, at least one.
    pub answers: Vec<Cut>,
    /// Their samples in the window.
    pub data: IoData,
    /// The same with those after it that are kept for validation.
    pub whole: IoData,
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

    /// All waveforms, the answering ones first.
    pub fn cuts(&self) -> Vec<&Cut> {
        self.answers.iter().chain(&self.drives).collect()
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
        return cuts(vec![format!("{}/displacement", crate::channel(settings, test)?)], settings, test, inputs);
    }
    cuts(beyond.outputs.clone(), settings, test, inputs)
}

fn cuts(ids: Vec<String>, settings: &Settings, test: &TestDescription, inputs: &Inputs) -> anyhow::Result<Vec<Cut>> {
    ids.into_iter()
        .map(|id| {
            let wave = inputs.wave(&id)?;
            Cut::new(id, wave, settings, test, inputs)
        })
        .collect()
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
    let drives = cuts(ids, settings, test, inputs)?;
    let first = &answers[0];
    for other in drives.iter().chain(&answers[1..]) {
        let hint = "name waveforms of one time base with --inputs and --outputs, or a window that all have";
        other.together_with(first, hint)?;
    }
    let data = |samples: &dyn Fn(&Cut) -> Vec<f64>| {
        let of = |cuts: &[Cut]| cuts.iter().map(samples).collect();
        IoData::new(of(&drives), of(&answers), first.sampled.dt_s()).refuse_with_hint(HINT)
    };
    let (used, whole) = (data(&|cut| cut.sampled.samples().to_vec())?, data(&Cut::whole)?);
    Ok(Record { drives, answers, data: used, whole })
}
