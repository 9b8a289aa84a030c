//! Numbers of a run that an index shows, in the units of people.

use crumple_drawing::numbers::{G_PER_M_PER_S2, KILO, KM_PER_H_PER_M_PER_S, MILLI};

use super::run_summary::RunSummary;

/// A number of a run.
#[derive(Debug, Clone, Copy)]
pub struct Quantity {
    /// In words.
    pub name: &'static str,
    /// As the head of a column has it.
    pub symbol: &'static str,
    /// Unit on the page; empty: none.
    pub unit: &'static str,
    /// Its value in that unit.
    pub of: fn(&RunSummary) -> Option<f64>,
}

/// Test mass.
pub const MASS: Quantity = Quantity { name: "test mass", symbol: "mass", unit: "kg", of: |run| run.test.mass_kg };
/// Impact speed.
pub const SPEED: Quantity = Quantity {
    name: "impact speed",
    symbol: "speed",
    unit: "km/h",
    of: |run| Some(KM_PER_H_PER_M_PER_S * run.test.impact_speed_m_per_s?),
};
/// Model year.
pub const YEAR: Quantity =
    Quantity { name: "model year", symbol: "year", unit: "", of: |run| Some(run.model_year()? as f64) };
/// Dynamic crush.
pub const CRUSH: Quantity = Quantity {
    name: "dynamic crush",
    symbol: "C",
    unit: "mm",
    of: |run| Some(MILLI * run.events.as_ref()?.dynamic_crush_m?),
};
/// Time of dynamic crush.
pub const TIME_OF_CRUSH: Quantity = Quantity {
    name: "time of dynamic crush",
    symbol: "t<sub>m</sub>",
    unit: "ms",
    of: |run| Some(MILLI * run.events.as_ref()?.time_of_dynamic_crush_s?),
};
/// Change of velocity: as a recorder kept it, else over the event.
pub const DELTA_V: Quantity = Quantity {
    name: "change of velocity",
    symbol: "Δv",
    unit: "km/h",
    of: |run| {
        let of_event = || run.events.as_ref()?.delta_v_m_per_s;
        Some(KM_PER_H_PER_M_PER_S * run.metric("maximum_delta_v").or_else(of_event)?)
    },
};
/// Largest deceleration of the filtered pulse.
pub const PEAK: Quantity = Quantity {
    name: "peak deceleration",
    symbol: "peak",
    unit: "g",
    of: |run| Some(G_PER_M_PER_S2 * run.metric("peak_acceleration")?),
};
/// Occupant load criterion.
pub const OLC: Quantity = Quantity {
    name: "occupant load criterion",
    symbol: "OLC",
    unit: "g",
    of: |run| Some(G_PER_M_PER_S2 * run.metric("olc")?),
};
/// Coefficient of restitution.
pub const RESTITUTION: Quantity = Quantity {
    name: "coefficient of restitution",
    symbol: "e",
    unit: "",
    of: |run| run.events.as_ref()?.coefficient_of_restitution,
};
/// Stiffness of the Kelvin model.
pub const STIFFNESS: Quantity = Quantity {
    name: "Kelvin stiffness",
    symbol: "k Kelvin",
    unit: "kN/m",
    of: |run| Some(KILO * run.parameter("kelvin", "stiffness_n_per_m")?),
};

impl Quantity {
    /// Name and unit, plain text.
    pub fn label(&self) -> String {
        if self.unit.is_empty() { self.name.to_owned() } else { format!("{}, {}", self.name, self.unit) }
    }
}
