//! What labels of pages have in common in English and German.

mod same_in_german;

pub use same_in_german::SAME_IN_GERMAN;
