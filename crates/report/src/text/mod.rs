//! Names as people write them, languages, and text made safe for Markdown.
//! Uses no other room.

pub mod language;
pub mod markdown;
pub mod names;
pub mod parameters;
pub mod phrases;
