//! Reads a crash record as users have it and writes it in SI units.
//!
//! [`Bundle::open`] reads the files of a record into memory (of a long table its start only); [`ingest`] makes a test
//! description, waveforms and their quality of them, and depends on their bytes and [`IngestSettings`] alone. Formats
//! are recognised by content: [`READERS`]. Nothing is guessed: what a record does not say is asked for by name, and
//! what is chosen (the pulse, a unit of time) is noted. Nothing is corrected either: zero level, time zero,
//! clipping, dropouts and drift are reported. [`list()`] makes the table of channels alone.

mod checks;
mod error;
mod files;
mod formats;
mod ingest;
mod listing;
mod pulse;
mod recording;
mod time;

pub use error::{IngestError, Place};
pub use files::digests::RecordDigests;
pub use formats::reader::{Bundle, LargeFile, NamedBytes, OpenFrom, Reader, ShowProgress};
pub use formats::registry::READERS;
pub use ingest::{Ingested, ingest};
pub use listing::{ListedChannel, list};
pub use recording::content::{PulseRule, Recording};
pub use recording::details::{Details, Stated};
pub use recording::line_numbers::LineNumbers;
pub use recording::quality::Quality;
pub use recording::read_channel::{Fitness, ReadChannel};
pub use recording::settings::{IngestSettings, Profile, Sign};
pub use recording::wave::Wave;
