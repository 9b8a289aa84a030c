//! Reads a crash record as users have it and writes it in SI units.
//!
//! [`Bundle::open`] reads the files of a record into memory (of a long table its start only); [`ingest`] makes a test
//! description, waveforms and their quality of them, and depends on their bytes and [`Settings`] alone. Formats are
//! recognised by content: [`recognise::READERS`]. Nothing is guessed: what a record does not say is asked for by name, and
//! what is chosen (the pulse, a unit of time) is said in a note. Nothing is corrected either: zero level, time zero,
//! clipping, dropouts and drift are reported. [`list()`] makes the table of channels alone.

mod archive;
mod bundle;
mod checks;
mod code_name;
mod compartment;
mod details;
mod diadem;
mod error;
mod ev5;
mod foreign;
mod grid;
mod ingest;
mod iso_mme;
mod list;
mod lvm;
mod mcap_file;
mod messages;
mod polarity;
mod protobuf;
mod pulse;
mod quality;
pub mod recognise;
mod recording;
mod ros_bag;
mod selection;
mod settings;
mod sidecar;
mod stage;
mod table;
mod tdm;
mod tdms;
mod time_unit;
mod time_zero;
mod twins;
mod uneven;
mod unused;
mod waveform;

pub use bundle::{Bundle, LargeFile, NamedBytes};
pub use error::{IngestError, Place};
pub use ingest::{Ingested, Wave, ingest};
pub use list::{Cli as ListCli, Line, list, run as list_channels};
pub use quality::Quality;
pub use recording::{Details, Fitness, Found, PulseRule, Recording, Stated};
pub use settings::{Profile, Settings, Sign};
pub use stage::Ingest;
