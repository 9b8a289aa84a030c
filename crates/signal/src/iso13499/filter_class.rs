//! The filter class of a channel code: its last character.

use std::fmt;

/// What the last character says of the filter the data went through.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FilterClass {
    /// A channel frequency class: 1000, 600, 180 or 60. `old` where filtered after ISO 6487:1987 or J211:1988.
    Cfc {
        /// The class.
        class: u16,
        /// By the older editions.
        old: bool,
    },
    /// Not filtered: `0`, or a place left open.
    Unfiltered,
    /// Filtered above CFC 1000 by the recorder: `P`.
    PreFiltered,
    /// Another filter, in words.
    Other(&'static str),
    /// Not stated: `?`, or a letter that is not in the table.
    Unknown,
}

impl FilterClass {
    /// The class number, where the data are filtered to a class.
    pub fn cfc(self) -> Option<u16> {
        match self {
            Self::Cfc { class, .. } => Some(class),
            _ => None,
        }
    }
}

impl fmt::Display for FilterClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cfc { class, old: false } => write!(f, "CFC {class}"),
            Self::Cfc { class, old: true } => write!(f, "CFC {class} by ISO 6487:1987 or J211:1988"),
            Self::Unfiltered => f.write_str("unfiltered"),
            Self::PreFiltered => f.write_str("pre-filtered above CFC 1000"),
            Self::Other(words) => f.write_str(words),
            Self::Unknown => f.write_str("not stated"),
        }
    }
}
