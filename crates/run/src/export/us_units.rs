//! Tables with units of the United States: the endings of columns, and rows that name their unit.

use crumple_signal::unit::{Dimension, factor};

use crate::table::{Cell, Table};
use Dimension::{Damping, Mass, Signal, Stiffness};
use crumple_signal::QuantityKind::{Acceleration, Displacement, Force, Velocity};

/// Ending of a column in SI, SI unit, what stands in their places, and what both measure. Longer endings first.
const UNITS: [(&str, &str, &str, &str, Dimension); 7] = [
    ("_m_per_s2", "m/s^2", "_g", "g", Signal(Acceleration)),
    ("_n_s_per_m", "N·s/m", "_lbf_s_per_in", "lbf*s/in", Damping),
    ("_n_per_m", "N/m", "_lbf_per_in", "lbf/in", Stiffness),
    ("_m_per_s", "m/s", "_mph", "mph", Signal(Velocity)),
    ("_kg", "kg", "_lb", "lb", Mass),
    ("_m", "m", "_in", "in", Signal(Displacement)),
    ("_n", "N", "_lbf", "lbf", Signal(Force)),
];

/// US units in one SI unit; 1 where the program knows neither.
fn ratio(us: &str, dimension: Dimension) -> f64 {
    factor(us, dimension).map_or(1.0, |si| 1.0 / si)
}

/// The same table with mph, in, lb, lbf and g in its numbers and in the names of its columns.
pub(super) fn in_us_units(mut table: Table) -> Table {
    let mut factors = vec![1.0; table.columns.len()];
    for ((name, _), factor) in table.columns.iter_mut().zip(&mut factors) {
        if let Some((ending, _, us_ending, us, of)) = UNITS.iter().find(|(ending, ..)| name.ends_with(ending)) {
            let renamed = format!("{}{us_ending}", &name[..name.len() - ending.len()]);
            let unit = table.units.iter_mut().find(|(column, _)| column == name);
            if let Some(unit) = unit {
                *unit = (renamed.clone(), us);
            }
            (*name, *factor) = (renamed, ratio(us, *of));
        }
    }
    let place = table.columns.iter().position(|(name, _)| name == "unit");
    for row in &mut table.rows {
        let of_row = place.and_then(|place| match &row[place] {
            Cell::Text(unit) => UNITS.iter().find(|(_, si, ..)| *si == &**unit),
            _ => None,
        });
        if let (Some(place), Some((.., us, _))) = (place, of_row) {
            row[place] = Cell::Text((*us).into());
        }
        let of_row = of_row.map_or(1.0, |(.., us, of)| ratio(us, *of));
        for (cell, factor) in row.iter_mut().zip(&factors) {
            if let Cell::Number(number) = cell {
                *number *= factor * of_row;
            }
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Kind::{Number, Text};
    use crate::table::columns;
    use crumple_signal::STANDARD_GRAVITY_M_PER_S2;

    #[test]
    fn columns_and_rows_have_units_of_the_united_states() {
        let speed = columns(&[("impact_speed_m_per_s", Number), ("time_s", Number), ("crush_m", Number)]);
        let table = in_us_units(Table::new("a", speed, vec![vec![0.447_04.into(), 2.0.into(), 0.0254.into()]]));
        let names: Vec<&str> = table.columns.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["impact_speed_mph", "time_s", "crush_in"]);
        let number = |cell: &Cell| if let Cell::Number(number) = cell { *number } else { f64::NAN };
        let row: Vec<f64> = table.rows[0].iter().map(number).collect();
        // Rounding of one multiplication.
        assert!((row[0] - 1.0).abs() < 1e-15 && row[1] == 2.0 && (row[2] - 1.0).abs() < 1e-15, "{row:?}");

        let of_rows = columns(&[("name", Text), ("value", Number), ("unit", Text)]);
        let peak = vec!["peak".into(), STANDARD_GRAVITY_M_PER_S2.into(), "m/s^2".into()];
        let count = vec!["count".into(), 3.0.into(), "1".into()];
        let table = in_us_units(Table::new("b", of_rows, vec![peak, count]));
        assert!((number(&table.rows[0][1]) - 1.0).abs() < 1e-15 && table.rows[0][2] == Cell::Text("g".into()));
        assert_eq!(table.rows[1][1..], [Cell::Number(3.0), Cell::Text("1".into())]);
    }
}
