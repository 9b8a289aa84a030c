//! The languages: their phrases, their numbers, and what fills the places in a text.
//! Uses names and phrases.

mod words;

pub use words::{Language, fill};
