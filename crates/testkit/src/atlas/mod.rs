//! The atlas: published figures of the field beside what the programs give of real and made records.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::atlas::readings::{READINGS, Reading};
use crate::atlas::runs::Runs;

pub use crate::atlas::page::page;
pub use crate::atlas::pulses::found_of_pulses;

mod page;
mod pulses;
mod readings;
mod runs;

/// A published figure.
#[derive(Debug, Deserialize)]
pub struct Figure {
    /// Name in the atlas.
    pub id: String,
    /// What was measured.
    pub quantity: String,
    /// Unit of the numbers; `1`: a ratio.
    #[serde(default)]
    pub unit: String,
    /// The figure, where it is one number.
    pub value: Option<f64>,
    /// Least and largest of the spread.
    pub low: Option<f64>,
    /// Largest of the spread.
    pub high: Option<f64>,
    /// What the spread is.
    pub spread: Option<String>,
    /// Number of tests, where it is stated.
    pub n: Option<u32>,
    /// Where it is published.
    pub source: String,
    /// How it was seen: `text`, `abstract`, `quoted` by another work, `computed` from published data, or `memory`.
    pub certainty: String,
    /// What counts as a hit where the spread does not say it: one car lies among cars, a median in the interval of the
    /// median. An end that is null is open.
    pub accept: Option<[Option<f64>; 2]>,
    /// Why that counts.
    pub accepted_by: Option<String>,
    /// Why nothing that lies at hand can be compared with it.
    pub not_run: Option<String>,
}

/// A pulse of a regulation with what follows from its corners.
#[derive(Debug, Deserialize)]
pub struct Pulse {
    /// Name in the atlas.
    pub id: String,
    /// Corners: time, s, and deceleration, g.
    #[serde(default)]
    pub points_s_g: Vec<[f64; 2]>,
    /// In the place of corners.
    pub half_sine: Option<HalfSine>,
    /// Change of velocity that the regulation demands beside the corners, ft/s.
    pub demanded_ft_s: Option<f64>,
    /// What it is a pulse of.
    pub conditions: String,
    /// Where its corners are published.
    pub source: String,
    /// As that of a [`Figure`].
    pub certainty: String,
    /// What an independent computation gives: 10 kHz, CFC 60, by numpy.
    pub expected: Reduced,
}

/// Half a period of a sine.
#[derive(Debug, Clone, Copy, Deserialize)]
pub struct HalfSine {
    /// Peak, g.
    pub peak_g: f64,
    /// Duration, s.
    pub duration_s: f64,
}

/// What follows from a pulse.
#[derive(Debug, Clone, Copy, Deserialize)]
pub struct Reduced {
    /// Change of velocity, m/s.
    pub delta_v_m_per_s: f64,
    /// Peak behind CFC 60, g.
    pub peak_g: f64,
    /// Way to the stop, m.
    pub stroke_m: Option<f64>,
    /// Occupant load criterion, g.
    pub olc_g: Option<f64>,
}

/// All that is published.
#[derive(Debug, Deserialize)]
pub struct Atlas {
    /// Figures of tests.
    pub figures: Vec<Figure>,
    /// Pulses of regulations.
    pub pulses: Vec<Pulse>,
}

impl Atlas {
    /// What `figures.json` beside this file holds. Errors: it is no such file.
    pub fn read() -> serde_json::Result<Self> {
        serde_json::from_str(include_str!("figures.json"))
    }

    fn figure(&self, id: &str) -> Option<&Figure> {
        self.figures.iter().find(|figure| figure.id == id)
    }
}

/// What the programs give for one figure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Found {
    /// Name of the figure or pulse.
    pub figure: String,
    /// The record or records; of a pulse the quantity.
    pub of: String,
    /// The number, in the unit of the figure.
    pub value: f64,
    /// Its interval, where that is what is compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interval: Option<[f64; 2]>,
    /// Whether it is what was published.
    pub hit: bool,
}

/// Why the atlas cannot be made.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Runs everything that can be run by the programs in `bin`, in a folder of its own. Errors: the reference records are
/// not here, a program fails, a run leaves no such number.
pub fn found(atlas: &Atlas, bin: &Path, folder: &Path) -> Result<Vec<Found>, Failure> {
    let mut all = found_of_pulses(&atlas.pulses, bin, &folder.join("pulses"))?;
    let runs = Runs::made(bin, folder)?;
    for reading in READINGS {
        all.push(judged(atlas, reading, &runs)?);
    }
    Ok(all)
}

fn judged(atlas: &Atlas, reading: &Reading, runs: &Runs) -> Result<Found, Failure> {
    let figure = atlas.figure(reading.figure).ok_or(format!("no figure {}", reading.figure))?;
    let missing = || format!("{} of {}: the run leaves no such number", reading.figure, reading.of);
    let (value, interval) = (reading.take)(runs).ok_or_else(missing)?;
    let hit = match (interval, figure.value) {
        (Some([low, high]), Some(published)) => low <= published && published <= high,
        _ => {
            let [low, high] = figure.accept.unwrap_or([figure.low, figure.high]);
            low.is_none_or(|low| low <= value) && high.is_none_or(|high| value <= high)
        }
    };
    Ok(Found { figure: reading.figure.to_owned(), of: reading.of.to_owned(), value, interval, hit })
}

/// What was a hit in an earlier atlas and is none now.
pub fn lost<'a>(before: &'a [Found], now: &[Found]) -> Vec<&'a Found> {
    let is_hit =
        |one: &Found| now.iter().any(|other| (&other.figure, &other.of, other.hit) == (&one.figure, &one.of, true));
    before.iter().filter(|one| one.hit && !is_hit(one)).collect()
}

/// The figures of misses that no reason is given for.
pub fn misses_without_reason(found: &[Found]) -> Vec<&Found> {
    found.iter().filter(|one| !one.hit && page::reason(one).is_empty()).collect()
}
