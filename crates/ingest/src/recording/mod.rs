//! What a record says: channels, test details, settings of a person, quality as measured.

pub mod channel_selection;
pub mod content;
pub mod details;
pub mod line_numbers;
pub mod quality;
pub mod read_channel;
pub mod settings;
pub mod unheeded_flags;
pub mod wave;
