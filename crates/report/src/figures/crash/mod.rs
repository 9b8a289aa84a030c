//! Figures of the crash: the motion, the candidates over it, other sensors, forces, divisions of the mass.
//! Uses drawing, results and text.

pub mod elements;
pub mod force;
pub mod mass_split;
pub mod models;
pub mod motion;
pub mod sensors;
