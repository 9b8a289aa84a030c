//! What a reader finds in a file, before flags and choices are applied.

use crumple_signal::{Channel, Notes, Sampled};

/// Fewer samples than this are no crash record.
pub const MINIMUM_SAMPLES: usize = 50;

/// Begins the comment of a channel whose file is here and cannot be read.
pub const NOT_READ: &str = "its file is not read: ";

/// A channel and its samples.
#[derive(Debug, Clone)]
pub struct Found {
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
}

impl Found {
    /// Why its file could not be read, with file and line, if it is here.
    pub fn unread(&self) -> Option<&str> {
        self.channel.comment.as_deref().filter(|_| self.wave.is_none())?.strip_prefix(NOT_READ)
    }
}

/// Order among candidates for the pulse: smaller is better; equal ones are settled by the order of channels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Fitness {
    /// A twin of a primary sensor.
    pub redundant: bool,
    /// Rank of the place on the vehicle.
    pub place: u8,
    /// Why the place ranks as it does, in words.
    pub why: &'static str,
}

/// A fact and where it is stated.
#[derive(Debug, Clone, PartialEq)]
pub struct Stated<T> {
    /// The value.
    pub value: T,
    /// Where it stands, in words: `line 3 of crash.csv`, `VEHTWT`.
    pub from: String,
}

/// What the record says of the test.
#[derive(Debug, Clone, Default)]
pub struct Details {
    /// Title of the test.
    pub title: Option<Stated<String>>,
    /// Vehicle, in words.
    pub vehicle: Option<Stated<String>>,
    /// Barrier, in words.
    pub barrier: Option<Stated<String>>,
    /// Test mass, kg.
    pub mass_kg: Option<Stated<f64>>,
    /// Speed just before contact, m/s, positive.
    pub impact_speed_m_per_s: Option<Stated<f64>>,
    /// Time of first contact on the file's axis, s.
    pub time_zero_s: Option<Stated<f64>>,
    /// What the record says of the impact speed and is not taken, and why, in words.
    pub speed_not_taken: Option<String>,
    /// The record is of a kind that has no crash pulse (an event data recorder's velocity change, say): mass, speed and pulse
    /// may be missing.
    pub no_pulse: bool,
    /// Facts that have no field of their own: static crush, laboratory, date.
    pub facts: Vec<String>,
}

/// How the pulse is found when nobody names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PulseRule {
    /// The only candidate; several are asked about.
    OnlyOne,
    /// The fittest candidate.
    Fittest,
}

/// Everything a reader finds.
#[derive(Debug, Clone)]
pub struct Recording {
    /// The test's facts.
    pub details: Details,
    /// All channels the file lists, in its order.
    pub channels: Vec<Found>,
    /// How the pulse is found.
    pub pulse_rule: PulseRule,
    /// The format defines t = 0 as first contact.
    pub contact_at_zero: bool,
    /// Remarks of the reader.
    pub notes: Notes,
}
