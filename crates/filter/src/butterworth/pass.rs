//! What a Butterworth filter lets pass, its order, and how it is run.

use serde::{Deserialize, Serialize};

/// Highest order offered. The overshoot after a jump grows with the order: 4 % for order 2 in one pass, 19 % for 12.
pub const HIGHEST_ORDER: usize = 12;

/// What passes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pass {
    /// Everything below a frequency, Hz.
    Low(f64),
    /// Everything above a frequency, Hz.
    High(f64),
    /// Everything between two frequencies, Hz.
    Band(f64, f64),
}

/// How the filter is run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Phase {
    /// Forward and backward: no phase, twice the attenuation of one pass; the cut-off is that of both passes.
    #[default]
    Zero,
    /// Forward only, as an instrument does: events come late.
    Causal,
}

impl Phase {
    /// The name used in artifacts.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Zero => "zero",
            Self::Causal => "causal",
        }
    }
}

/// A Butterworth filter in the words of whoever asks for it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Butterworth {
    /// What passes; the frequencies are where the filter as run leaves 1/√2 of the amplitude (-3.01 dB).
    pub pass: Pass,
    /// Poles of one pass; a band has twice as many.
    pub order: usize,
    /// How it is run.
    pub phase: Phase,
}

impl Pass {
    /// The cut-off, or both, lower first as stated, Hz.
    pub fn frequencies_hz(self) -> Vec<f64> {
        match self {
            Self::Low(f) | Self::High(f) => vec![f],
            Self::Band(low, high) => vec![low, high],
        }
    }

    /// The name used in artifacts.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Low(_) => "butterworth-low",
            Self::High(_) => "butterworth-high",
            Self::Band(..) => "butterworth-band",
        }
    }
}
