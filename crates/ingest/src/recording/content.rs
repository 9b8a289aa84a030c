//! What a reader reads in a file, before flags and choices are applied.

use crumple_signal::Notes;

use crate::recording::details::Details;
use crate::recording::read_channel::ReadChannel;

/// Fewer samples than this are no crash record.
pub const MINIMUM_SAMPLES: usize = 50;

/// How the pulse is found when nobody names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PulseRule {
    /// The only candidate; several are asked about.
    OnlyOne,
    /// The fittest candidate.
    Fittest,
}

/// Everything a reader reads.
#[derive(Debug, Clone)]
pub struct Recording {
    /// The test's facts.
    pub details: Details,
    /// All channels the file lists, in its order.
    pub channels: Vec<ReadChannel>,
    /// How the pulse is found.
    pub pulse_rule: PulseRule,
    /// The format defines t = 0 as first contact.
    pub contact_at_zero: bool,
    /// Remarks of the reader.
    pub notes: Notes,
}
