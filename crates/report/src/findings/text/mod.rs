//! Names as people write them, and text made safe for Markdown; languages and phrases are those of `crumple-report`.

pub mod markdown;
pub mod names;
pub mod parameters;
