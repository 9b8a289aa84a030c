//! An artifact as plain text and numbers, and back, so that any language can be a stage.

pub mod layout;
pub mod pack;
pub mod unpack;
