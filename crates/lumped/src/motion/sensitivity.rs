//! Instants at which a motion is wanted, and motions with their derivatives by parameters.

use crate::motion::mass_motion::Motion;

/// Instants `first_s + k dt_s`, k = 0 .. `samples`, after contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instants {
    /// First instant, s.
    pub first_s: f64,
    /// Their spacing, s.
    pub dt_s: f64,
    /// Their number.
    pub samples: usize,
}

/// Motions and what a parameter changes in them.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivity {
    /// Motion of every mass, from the barrier on.
    pub motions: Vec<Motion>,
    /// `derivatives[p][mass]`: derivative of that motion by the p-th parameter asked for, per its unit.
    pub derivatives: Vec<Vec<Motion>>,
}
