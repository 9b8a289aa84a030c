//! Quantities, their units, values that a person types with a unit, and stated uncertainties.

pub mod gravity;
pub mod key_quantities;
pub mod quantity;
pub mod uncertain;
pub mod unit;
pub mod value;
