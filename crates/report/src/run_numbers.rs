//! Numbers of a run that an index and the figures of a fleet show.

use std::ops::Deref;

use crumple_signal::key_quantities::{self as table, KeyQuantity};

use crate::findings::Summary;

/// A number of a run, and where its summary has it.
#[derive(Debug, Clone, Copy)]
pub struct RunNumber {
    quantity: KeyQuantity,
    of: fn(&Summary) -> Option<f64>,
}

impl Deref for RunNumber {
    type Target = KeyQuantity;

    fn deref(&self) -> &KeyQuantity {
        &self.quantity
    }
}

impl RunNumber {
    /// Its value in the unit of people.
    pub fn value(&self, summary: &Summary) -> Option<f64> {
        Some(self.shown().0 * (self.of)(summary)?)
    }
}

/// Test mass.
pub const MASS: RunNumber = RunNumber { quantity: table::MASS, of: |run| run.test.mass_kg };
/// Impact speed.
pub const SPEED: RunNumber = RunNumber { quantity: table::SPEED, of: |run| run.test.impact_speed_m_per_s };
/// Model year.
pub const YEAR: RunNumber = RunNumber { quantity: table::YEAR, of: |run| Some(run.model_year()? as f64) };
/// Dynamic crush.
pub const CRUSH: RunNumber = RunNumber { quantity: table::CRUSH, of: |run| run.events.as_ref()?.dynamic_crush_m };
/// Time of dynamic crush.
pub const TIME_OF_CRUSH: RunNumber =
    RunNumber { quantity: table::TIME_OF_CRUSH, of: |run| run.events.as_ref()?.time_of_dynamic_crush_s };
/// Change of velocity: as a recorder kept it, else over the event.
pub const DELTA_V: RunNumber = RunNumber {
    quantity: table::DELTA_V,
    of: |run| run.metric(table::MAXIMUM_DELTA_V.key).or_else(|| run.events.as_ref()?.delta_v_m_per_s),
};
/// Largest magnitude of the filtered acceleration.
pub const PEAK: RunNumber = RunNumber { quantity: table::PEAK, of: |run| run.metric(table::PEAK.key) };
/// Occupant load criterion.
pub const OLC: RunNumber = RunNumber { quantity: table::OLC, of: |run| run.metric(table::OLC.key) };
/// Coefficient of restitution.
pub const RESTITUTION: RunNumber =
    RunNumber { quantity: table::RESTITUTION, of: |run| run.events.as_ref()?.coefficient_of_restitution };
/// Stiffness of the Kelvin model.
pub const STIFFNESS: RunNumber =
    RunNumber { quantity: table::STIFFNESS, of: |run| run.parameter("kelvin", "stiffness_n_per_m") };
