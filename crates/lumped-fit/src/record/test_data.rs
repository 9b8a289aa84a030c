//! The data of a test that solvers start from.

use crumple_signal::{Displacement, Signal};

use crate::{Measurement, Sensor};

/// The data of a test: mass, speed, crash events and records.
///
/// Times are seconds after time zero unless stated otherwise. An event that the record does not show is `None`: a
/// vehicle that never stops has no dynamic crush, one that is recorded too shortly no rebound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TestData<'a> {
    /// Test mass, kg.
    pub mass_kg: f64,
    /// Speed at contact, m/s.
    pub impact_speed_m_per_s: f64,
    /// Time of dynamic crush after time zero, s, if the velocity reaches zero.
    pub time_of_dynamic_crush_s: Option<f64>,
    /// Dynamic crush, m.
    pub dynamic_crush_m: Option<f64>,
    /// Coefficient of restitution, if the record shows the rebound.
    pub coefficient_of_restitution: Option<f64>,
    /// Time zero on the axis of the displacement record, s.
    pub time_zero_s: f64,
    /// Time of rebound after time zero, s, if the record shows it.
    pub time_of_rebound_s: Option<f64>,
    /// Displacement of the compartment.
    pub displacement: Option<&'a Signal<Displacement>>,
    /// How it was measured; `None`: not known, the motion itself is compared.
    pub measurement: Option<Measurement>,
    /// Sensors to fit instead of it; none: the compartment's displacement.
    pub sensors: &'a [Sensor<'a>],
}
