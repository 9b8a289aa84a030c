//! Identified models, and what speaks for or against them, as records of the artifact.

pub mod acceptance;
pub mod discrete_model;
pub mod evidence;
pub mod poles;
pub mod realization;
pub mod responses;
pub mod results;
pub mod selection;
pub mod stabilization;
pub mod state_space;
pub mod transfer_function_array;
pub mod transfer_function_task;
