//! The stage `parameter-solve`: springs and dampers of lumped models from the events and motion of a test. The fits are
//! those of `crumple-lumped-fit`.

mod stage;

/// The program.
pub const PROGRAM: crumple_stage::Program = crumple_stage::Program::of_stage::<stage::ParameterSolve>();
