//! The comparison as text for people.

pub mod head;
pub mod headline;
pub mod text;
