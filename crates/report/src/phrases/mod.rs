//! All texts of pages, Markdown and console, and numbers as people write them.

pub mod phrases;
pub mod words;

pub use phrases::PHRASES;
