//! Reads a crash record as users have it and writes it in SI units.
//!
//! [`Bundle::open`] reads the files of a record into memory (of a long table its start only); [`ingest`] makes a test
//! description, waveforms and their quality of them, and depends on their bytes and [`IngestSettings`] alone. Formats
//! are recognised by content: [`READERS`]. Nothing is guessed: what a record does not say is asked for by name, and
//! what is chosen (the pulse, contact) is noted. Contact is settled here: after it every time is in seconds from it.
//! Nothing is corrected: zero level, clipping, dropouts and drift are reported. [`list()`] makes the table of channels
//! alone.

mod checks {
    //! What is noted about the channels: quality, time grids, sensors that should agree, units and signs exchanged.
    //! Corrects nothing.

    pub mod channel_quality;
    pub mod exchanges;
}
mod contact;
mod error;
mod files {
    //! The disk: a record's files, folders and zip archives into memory, the sidecar beside them. Only this module uses
    //! std::fs.

    pub mod digests;
    pub mod open;
    pub mod zip;
}
mod formats;
mod impact;
mod ingest;
mod kind;
mod listing;
mod pulse;
mod recording {
    //! What a record says: channels, test details, settings of a person, quality as measured.

    pub mod content;
    pub mod details;
    pub mod preamble;
    pub mod scale;
    pub mod settings;
    pub mod stated_contact;
    pub mod unit_system;
}
mod stage;
mod time;
mod wall;

pub(crate) use error::{GAPS_ARE_NOT_FILLED, Place, check_size, refuse, refuse_channel, refuse_path, refuse_size};
pub use error::{IngestError, Refusal, Result};
pub use files::digests::RecordDigests;
pub use files::open::is_simulation;
pub use formats::reader::{Bundle, FILE_LIMIT, LargeFile, NamedBytes, Open, ReadSeek, Reader, ShowProgress};
pub use formats::registry::{READERS, is_ending_of_a_record};
pub use ingest::{Ingested, ingest};
pub use listing::{ListedChannel, list};
pub use recording::content::{Fitness, LineNumbers, PulseRule, Quality, ReadChannel, Recording, Wave};
pub use recording::details::{Details, Stated};
pub use recording::settings::{BodyPlace, IngestSettings, Profile, Sign};
pub use recording::stated_contact::{ContactRule, TimeZero};
pub use recording::unit_system::{DrivingAxis, Evidence, UnitSystem, Units};
pub use stage::PROGRAM;
