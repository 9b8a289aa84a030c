//! The figures of the page, one file each. A figure whose record is absent is left out.
//! Uses drawing, results and text.

pub mod all;
pub mod bode;
pub mod elements;
pub mod force;
pub mod mass_split;
pub mod models;
pub mod motion;
pub mod poles;
pub mod responses;
pub mod sensors;
pub mod singular_values;
pub mod stabilisation;
