//! The driving and the answering waveform of a stage run, cut to one window.

use crumple_identify::IoData;
use crumple_signal::{QuantityKind, Sampled, TestDescription};
use crumple_stage::{Inputs, RefuseExt, Refused, Wave};

use crate::options::{BeyondEra, Settings};
use crate::{Window, window};

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
    fn new(
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
}

/// The answering waveform: as asked for, else the displacement of the pulse.
pub fn output(settings: &Settings, beyond: &BeyondEra, test: &TestDescription, inputs: &Inputs) -> anyhow::Result<Cut> {
    let id = match &beyond.output_channel {
        Some(id) => id.clone(),
        None => format!("{}/displacement", crate::channel(settings, test)?),
    };
    let wave = inputs.wave(&id)?;
    Cut::new(id, wave, settings, test, inputs)
}

/// Input and output of the window and of what is kept after it.
pub fn whole(drive: &Cut, answer: &Cut, data: &IoData) -> anyhow::Result<IoData> {
    Ok(IoData::single(drive.whole(), answer.whole(), data.sample_time_s())?)
}

/// Input and output, sampled together.
pub fn pair(
    settings: &Settings,
    beyond: &BeyondEra,
    test: &TestDescription,
    inputs: &Inputs,
) -> anyhow::Result<(Cut, Cut, IoData)> {
    let answer = output(settings, beyond, test, inputs)?;
    let id = match &beyond.input_channel {
        Some(id) => id.clone(),
        None => crate::channel(settings, test)?.to_owned(),
    };
    let wave = inputs.wave(&id)?;
    let drive = Cut::new(id, wave, settings, test, inputs)?;
    let (u, y) = (&drive.sampled, &answer.sampled);
    let dt = y.dt_s();
    let apart = (u.t0_s() - y.t0_s()).abs() > 1e-6 * dt || (u.dt_s() / dt - 1.0).abs() > 1e-9;
    if apart || u.len() != y.len() {
        return Err(Refused::new(format!(
            "waveforms {} and {} are not sampled together: {} samples of {} s from {} s, and {} of {} s from {} s",
            drive.id,
            answer.id,
            u.len(),
            u.dt_s(),
            u.t0_s(),
            y.len(),
            dt,
            y.t0_s()
        ))
        .hint("name waveforms of one time base with --input-channel and --output-channel, or a window that both have")
        .into());
    }
    let data = IoData::single(u.samples().to_vec(), y.samples().to_vec(), dt)
        .refuse_with_hint("name other waveforms with --input-channel and --output-channel")?;
    Ok((drive, answer, data))
}
