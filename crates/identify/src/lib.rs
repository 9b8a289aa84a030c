//! The stage `identify`: linear models from a crash pulse. The estimators are those of `crumple-sysid`.

mod stage;

/// The program.
pub const PROGRAM: crumple_stage::Program = crumple_stage::Program::of_stage::<stage::Identify>();
