//! Modes of an identified model: how much the data support each, how alike their shapes are, how sure their
//! frequencies.

pub(crate) mod identified_mode;
pub(crate) mod mode_deviations;
pub(crate) mod mode_shape;
pub(crate) mod pole_kind;
