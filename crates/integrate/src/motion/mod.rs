//! From acceleration to velocity and displacement: rule of summation, start, drift.

pub mod drift;
pub mod integration;
pub mod rule;
pub mod start;
