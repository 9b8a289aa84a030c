//! A channel as a reader reads it, before flags and choices are applied.

use std::sync::Arc;

use crumple_signal::{Channel, ChannelStatus, Sampled};

use crate::recording::line_numbers::LineNumbers;

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
