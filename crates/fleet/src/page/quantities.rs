//! What the page shows of each run.

use crumple_signal::STANDARD_GRAVITY_M_PER_S2;

use crate::tables::rows::Row;
use crate::tables::summary::model_year;

/// A number of a run.
#[derive(Clone, Copy)]
pub(crate) struct Quantity {
    /// In words.
    pub(crate) name: &'static str,
    /// Unit on the page.
    pub(crate) unit: &'static str,
    /// Its value in that unit.
    pub(crate) of: fn(&Row) -> Option<f64>,
}

/// Test mass.
pub(crate) const MASS: Quantity =
    Quantity { name: "test mass", unit: "kg", of: |row| row.summary.as_ref()?.test.mass_kg };
/// Impact speed.
pub(crate) const SPEED: Quantity = Quantity {
    name: "impact speed",
    unit: "km/h",
    of: |row| Some(3.6 * row.summary.as_ref()?.test.impact_speed_m_per_s?),
};
/// Model year.
pub(crate) const YEAR: Quantity = Quantity {
    name: "model year",
    unit: "",
    of: |row| Some(model_year(row.summary.as_ref()?.test.vehicle.as_deref()?)? as f64),
};
/// Dynamic crush.
pub(crate) const CRUSH: Quantity = Quantity {
    name: "dynamic crush",
    unit: "mm",
    of: |row| Some(1e3 * row.summary.as_ref()?.events.as_ref()?.dynamic_crush_m?),
};
/// Occupant load criterion.
pub(crate) const OLC: Quantity = Quantity {
    name: "OLC",
    unit: "g",
    of: |row| Some(row.summary.as_ref()?.metric("olc")? / STANDARD_GRAVITY_M_PER_S2),
};
/// Stiffness of the Kelvin model.
pub(crate) const STIFFNESS: Quantity = Quantity {
    name: "Kelvin stiffness",
    unit: "kN/m",
    of: |row| Some(1e-3 * row.summary.as_ref()?.parameter("kelvin", "stiffness_n_per_m")?),
};
/// Coefficient of restitution.
pub(crate) const RESTITUTION: Quantity = Quantity {
    name: "restitution",
    unit: "",
    of: |row| row.summary.as_ref()?.events.as_ref()?.coefficient_of_restitution,
};

impl Quantity {
    /// Name and unit.
    pub(crate) fn label(&self) -> String {
        if self.unit.is_empty() { self.name.to_owned() } else { format!("{}, {}", self.name, self.unit) }
    }
}
