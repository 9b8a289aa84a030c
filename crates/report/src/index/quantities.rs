//! Numbers of a run that an index shows, in the units of people.

use crate::drawing::numbers::{G_PER_M_PER_S2, KILO, KM_PER_H_PER_M_PER_S, MILLI};
use crate::phrases::PHRASES;
use crate::phrases::RunTexts;

use super::run_summary::RunSummary;

/// A number of a run.
#[derive(Debug, Clone, Copy)]
pub struct Quantity {
    /// In words, and as the head of a column has it.
    names: fn(&'static RunTexts) -> [&'static str; 2],
    /// Unit on the page; empty: none.
    pub unit: &'static str,
    /// Its value in that unit.
    pub of: fn(&RunSummary) -> Option<f64>,
}

/// Test mass.
pub const MASS: Quantity = Quantity { names: |t| [t.mass_name, t.mass], unit: "kg", of: |run| run.test.mass_kg };
/// Impact speed.
pub const SPEED: Quantity = Quantity {
    names: |t| [t.speed_name, t.speed],
    unit: "km/h",
    of: |run| Some(KM_PER_H_PER_M_PER_S * run.test.impact_speed_m_per_s?),
};
/// Model year.
pub const YEAR: Quantity =
    Quantity { names: |t| [t.year_name, t.year], unit: "", of: |run| Some(run.model_year()? as f64) };
/// Dynamic crush.
pub const CRUSH: Quantity = Quantity {
    names: |t| [t.crush_name, t.crush],
    unit: "mm",
    of: |run| Some(MILLI * run.events.as_ref()?.dynamic_crush_m?),
};
/// Time of dynamic crush.
pub const TIME_OF_CRUSH: Quantity = Quantity {
    names: |t| [t.time_name, t.time],
    unit: "ms",
    of: |run| Some(MILLI * run.events.as_ref()?.time_of_dynamic_crush_s?),
};
/// Change of velocity: as a recorder kept it, else over the event.
pub const DELTA_V: Quantity = Quantity {
    names: |t| [t.change_name, t.change],
    unit: "km/h",
    of: |run| {
        let of_event = || run.events.as_ref()?.delta_v_m_per_s;
        Some(KM_PER_H_PER_M_PER_S * run.metric("maximum_delta_v").or_else(of_event)?)
    },
};
/// Largest deceleration of the filtered pulse.
pub const PEAK: Quantity = Quantity {
    names: |t| [t.peak_name, t.peak],
    unit: "g",
    of: |run| Some(G_PER_M_PER_S2 * run.metric("peak_acceleration")?),
};
/// Occupant load criterion.
pub const OLC: Quantity =
    Quantity { names: |t| [t.olc_name, t.olc], unit: "g", of: |run| Some(G_PER_M_PER_S2 * run.metric("olc")?) };
/// Coefficient of restitution.
pub const RESTITUTION: Quantity = Quantity {
    names: |t| [t.restitution_name, t.restitution],
    unit: "",
    of: |run| run.events.as_ref()?.coefficient_of_restitution,
};
/// Stiffness of the Kelvin model.
pub const STIFFNESS: Quantity = Quantity {
    names: |t| [t.stiffness_name, t.stiffness],
    unit: "kN/m",
    of: |run| Some(KILO * run.parameter("kelvin", "stiffness_n_per_m")?),
};

impl Quantity {
    /// In words.
    pub fn name(&self) -> &'static str {
        (self.names)(&PHRASES.runs)[0]
    }

    /// As the head of a column has it, HTML.
    pub fn symbol(&self) -> &'static str {
        (self.names)(&PHRASES.runs)[1]
    }

    /// Name and unit, plain text.
    pub fn label(&self) -> String {
        let name = self.name();
        if self.unit.is_empty() { name.to_owned() } else { format!("{name}, {}", self.unit) }
    }
}
