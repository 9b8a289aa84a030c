//! The languages: their phrases, their numbers, and what fills the places in a text.

mod words;

pub use words::{Language, fill};
