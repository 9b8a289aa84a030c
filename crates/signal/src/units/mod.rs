//! Quantities, their units, values that a person types with a unit, and stated uncertainties.
//! Uses no other room.

pub mod gravity;
pub mod quantity;
pub mod uncertain;
pub mod unit;
pub mod value;
