//! The stage `filter`: zero level and channel frequency class of every channel. The filters are those of
//! `crumple-signal`.

mod stage;

/// The program.
pub const PROGRAM: crumple_stage::Program = crumple_stage::Program::of_stage::<stage::Filter>();
