//! Channel codes of ISO/TS 13499 (ISO-MME): the code and its fields, word tables, filter classes, patterns.

mod code;
mod filter_class;
mod wildcard;
mod words;

pub use code::{CodeError, IsoCode, Parts};
pub use filter_class::FilterClass;
pub use wildcard::wildcard;
