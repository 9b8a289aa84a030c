//! What a stage reads and what it writes.

pub mod inputs;
pub mod output;
pub mod overwriting;
pub mod recording_steps;
pub mod run_folder;
pub mod several_tests;
pub mod wall_force;
