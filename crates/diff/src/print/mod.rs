//! The comparison as text for people.
//! Uses differences; its tests use compare.

pub mod head;
pub mod headline;
pub mod text;
