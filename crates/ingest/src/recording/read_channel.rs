//! A channel as a reader reads it, before flags and choices are applied.

use crumple_signal::{Channel, Sampled};

/// Begins the comment of a channel whose file is here and cannot be read.
pub const NOT_READ: &str = "its file is not read: ";

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
}

impl ReadChannel {
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
