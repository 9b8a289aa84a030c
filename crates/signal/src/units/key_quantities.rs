//! The numbers that people ask for first: what they are called and how they are shown. Console, page, index, comparison
//! and diff read this table.

use super::display;
use crate::STANDARD_GRAVITY_M_PER_S2;

/// m/s² in g.
pub const G_PER_M_PER_S2: f64 = 1.0 / STANDARD_GRAVITY_M_PER_S2;
/// m/s in km/h.
pub const KM_PER_H_PER_M_PER_S: f64 = 3.6;
/// m in mm, s in ms.
pub const MILLI: f64 = 1e3;
/// N in kN, J in kJ, N/m in kN/m.
pub const KILO: f64 = 1e-3;

/// A number of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KeyQuantity {
    /// Its name in records, that of the metric where it is one.
    pub key: &'static str,
    /// In words.
    pub name: &'static str,
    /// As its card on the page has it.
    pub title: &'static str,
    /// As its line on the console has it; empty: it has none there.
    pub console: &'static str,
    /// As the head of a column has it.
    pub symbol: &'static str,
    /// Unit that metric pages have; empty: none. [`shown`](Self::shown) is that of the reader.
    pub unit: &'static str,
    /// From SI to that unit.
    pub factor: f64,
    /// Decimals that are true of it.
    pub decimals: usize,
}

const fn quantity(
    [key, name, symbol]: [&'static str; 3],
    (factor, decimals, unit): (f64, usize, &'static str),
) -> KeyQuantity {
    KeyQuantity { key, name, title: name, console: "", symbol, unit, factor, decimals }
}

/// Test mass.
pub const MASS: KeyQuantity = quantity(["mass", "test mass", "mass"], (1.0, 0, "kg"));
/// Impact speed.
pub const SPEED: KeyQuantity = quantity(["impact_speed", "impact speed", "speed"], (KM_PER_H_PER_M_PER_S, 1, "km/h"));
/// Model year.
pub const YEAR: KeyQuantity = quantity(["model_year", "model year", "year"], (1.0, 0, ""));
/// Dynamic crush.
pub const CRUSH: KeyQuantity =
    quantity(["dynamic_crush", "dynamic crush", "C"], (MILLI, 0, "mm")).called("Dynamic crush C", "dynamic crush");
/// Time of dynamic crush.
pub const TIME_OF_CRUSH: KeyQuantity =
    quantity(["time_of_dynamic_crush", "time of dynamic crush", "tₘ"], (MILLI, 1, "ms"))
        .called("Time of crush tₘ", "time of crush");
/// Change of velocity over the event.
pub const DELTA_V: KeyQuantity = quantity(["delta_v", "change of velocity", "Δv"], (KM_PER_H_PER_M_PER_S, 1, "km/h"))
    .called("Velocity change Δv", "delta-v");
/// The largest change of velocity that a recorder kept.
pub const MAXIMUM_DELTA_V: KeyQuantity =
    quantity(["maximum_delta_v", "maximum change of velocity", "Δv"], (KM_PER_H_PER_M_PER_S, 1, "km/h"))
        .called("Maximum Δv as recorded", "delta-v");
/// When it was reached.
pub const TIME_OF_MAXIMUM_DELTA_V: KeyQuantity =
    quantity(["time_of_maximum_delta_v", "time of the maximum change of velocity", "t"], (MILLI, 0, "ms"))
        .called("Time of maximum Δv", "");
/// The largest change of velocity along y that a recorder kept.
pub const MAXIMUM_LATERAL_DELTA_V: KeyQuantity = quantity(
    ["maximum_lateral_delta_v", "maximum lateral change of velocity", "lateral Δv"],
    (KM_PER_H_PER_M_PER_S, 1, "km/h"),
)
.called("Maximum lateral Δv as recorded", "lateral delta-v");
/// The largest change of velocity along x and y together.
pub const TOTAL_DELTA_V: KeyQuantity =
    quantity(["total_delta_v", "total change of velocity", "total Δv"], (KM_PER_H_PER_M_PER_S, 1, "km/h"))
        .called("Total Δv", "total delta-v");
/// The angle from straight ahead at which the force came.
pub const DIRECTION_OF_FORCE: KeyQuantity =
    quantity(["principal_direction_of_force", "principal direction of force", "PDOF"], (1.0, 0, "°"))
        .called("Direction of force, from ahead", "direction");
/// The speed whose kinetic energy went into deformation, by what a recorder kept.
pub const RECORDED_EES: KeyQuantity =
    quantity(["recorded_ees", "energy-equivalent speed", "EES"], (KM_PER_H_PER_M_PER_S, 1, "km/h"))
        .called("Energy-equivalent speed EES, BEV", "EES");
/// Crush by what a recorder kept.
pub const RECORDED_CRUSH: KeyQuantity =
    quantity(["recorded_crush", "crush from the recorder's table", "C"], (MILLI, 0, "mm"))
        .called("Crush from the table", "crush");
/// Largest magnitude of the filtered acceleration.
pub const PEAK: KeyQuantity =
    quantity(["peak_acceleration", "peak deceleration", "peak"], (G_PER_M_PER_S2, 1, "g")).called("Peak", "peak");
/// Occupant load criterion.
pub const OLC: KeyQuantity =
    quantity(["olc", "occupant load criterion", "OLC"], (G_PER_M_PER_S2, 1, "g")).called("OLC", "OLC");
/// Coefficient of restitution.
pub const RESTITUTION: KeyQuantity =
    quantity(["coefficient_of_restitution", "coefficient of restitution", "e"], (1.0, 2, ""))
        .called("Restitution e", "restitution");
/// Way from contact to the end of the force, of what starts from rest and of a sled.
pub const STROKE: KeyQuantity = quantity(["stroke", "stroke", "s"], (MILLI, 0, "mm")).called("Stroke", "stroke");
/// Head injury criterion over 15 ms.
pub const HIC15: KeyQuantity =
    quantity(["hic15", "head injury criterion, 15 ms", "HIC15"], (1.0, 0, "")).called("HIC15", "");
/// Head injury criterion over 36 ms.
pub const HIC36: KeyQuantity =
    quantity(["hic36", "head injury criterion, 36 ms", "HIC36"], (1.0, 0, "")).called("HIC36", "");
/// Acceleration that lasts 3 ms.
pub const CLIP_3MS: KeyQuantity =
    quantity(["clip_3ms_contiguous", "3 ms clip", "3 ms clip"], (G_PER_M_PER_S2, 1, "g")).called("3 ms clip", "");
/// Stiffness: of the Kelvin model, of a curve as one spring.
pub const STIFFNESS: KeyQuantity = quantity(["stiffness", "Kelvin stiffness", "k"], (KILO, 0, "kN/m"));

/// A number of a name that the table does not have, as records of other programs may.
pub const UNKNOWN: KeyQuantity = quantity(["", "", ""], (1.0, 1, ""));

/// Those that a report has among its key numbers.
const OF_REPORTS: [KeyQuantity; 17] = [
    CRUSH,
    TIME_OF_CRUSH,
    DELTA_V,
    MAXIMUM_DELTA_V,
    TIME_OF_MAXIMUM_DELTA_V,
    MAXIMUM_LATERAL_DELTA_V,
    TOTAL_DELTA_V,
    DIRECTION_OF_FORCE,
    RECORDED_EES,
    RECORDED_CRUSH,
    PEAK,
    OLC,
    RESTITUTION,
    STROKE,
    HIC15,
    HIC36,
    CLIP_3MS,
];

impl KeyQuantity {
    /// The key number of this name.
    pub fn of(key: &str) -> Option<&'static Self> {
        OF_REPORTS.iter().find(|quantity| quantity.key == key)
    }

    /// The same with a title on the page and a label on the console of its own.
    const fn called(self, title: &'static str, console: &'static str) -> Self {
        Self { title, console, ..self }
    }

    /// Factor, decimals and unit, those of the reader.
    pub fn shown(&self) -> (f64, usize, &'static str) {
        display::shown((self.factor, self.decimals, self.unit))
    }

    /// Name and unit, as the title of an axis has them.
    pub fn label(&self) -> String {
        self.with_unit(self.name)
    }

    /// Symbol and unit, as the head of a column has them.
    pub fn head(&self) -> String {
        self.with_unit(self.symbol)
    }

    fn with_unit(&self, text: &str) -> String {
        let (_, _, unit) = self.shown();
        if unit.is_empty() { text.to_owned() } else { format!("{text}, {unit}") }
    }
}
