//! Predictions as lines for a person, in the units that are shown.

use crumple_signal::display::{shown, unit_shown};
use crumple_signal::key_quantities::{G_PER_M_PER_S2, KM_PER_H_PER_M_PER_S, MILLI};
use crumple_stage::numbers::Rounding;
use crumple_stage::records::PredictionV1;

/// A number of a record in the unit of its column, with the digits that its interval supports; `-` where there is none.
fn number(record: &PredictionV1, name: &str, value: Option<f64>, metric: Metric) -> String {
    let (factor, decimals, _) = shown(metric);
    value.map_or_else(|| "-".to_owned(), |value| rounding(record, name, (factor, decimals)).show(factor * value))
}

fn rounding(record: &PredictionV1, name: &str, (factor, decimals): (f64, usize)) -> Rounding {
    let interval = record.intervals.iter().find(|interval| interval.name == name);
    Rounding::of_quantity(interval.map(|ends| (factor * ends.low, factor * ends.high)), decimals)
}

/// Factor from SI, decimals and unit of a metric column.
type Metric = (f64, usize, &'static str);

const CRUSH: Metric = (MILLI, 0, "mm");
const SPEED: Metric = (KM_PER_H_PER_M_PER_S, 1, "km/h");
const MASS: Metric = (1.0, 1, "kg");
const PEAK: Metric = (G_PER_M_PER_S2, 1, "g");

/// A number with so many decimals in its column.
fn cell(value: f64, metric: Metric) -> String {
    let (factor, decimals, _) = shown(metric);
    format!("{:.decimals$}", factor * value)
}

/// With its unit behind it.
fn with_unit(value: Option<f64>, metric: Metric) -> String {
    let number = value.map_or_else(|| "-".to_owned(), |value| cell(value, metric));
    format!("{number} {}", shown(metric).2)
}

/// A prediction that was written.
pub struct Row {
    pub speed_m_per_s: f64,
    pub record: PredictionV1,
}

/// What stands before a speed that was asked for.
const ASKED: &str = "> ";

/// Titles of the columns of [`line`]; `marks`: some speeds were asked for beside standing ones.
pub fn header(marks: bool) -> String {
    format!(
        "{}{:>6} {:>7} {:>8} {:>15} {:>6} {:>7} {:>6} {:>6}  candidate{}",
        if marks { "  " } else { "" },
        unit_shown("km/h"),
        unit_shown("kg"),
        format!("crush {}", unit_shown("mm")),
        "90 %",
        "t_m ms",
        format!("dv {}", unit_shown("km/h")),
        "peak g",
        "e",
        if marks { ", > asked for" } else { "" },
    )
}

/// One prediction. `asked`: whether its speed was asked for, where the header has marks.
pub fn line(record: &PredictionV1, asked: Option<bool>) -> String {
    let name = "dynamic_crush_m";
    let interval = record.intervals.iter().find(|interval| interval.name == name).map_or_else(
        || "-".to_owned(),
        |ends| {
            let (factor, decimals, _) = shown(CRUSH);
            let [low, high] =
                [ends.low, ends.high].map(|end| rounding(record, name, (factor, decimals)).show(factor * end));
            format!("{low} to {high}")
        },
    );
    let names = if record.names.is_empty() { String::new() } else { format!(" ({})", record.names.join(", ")) };
    let mark = match asked {
        None => "",
        Some(true) => ASKED,
        Some(false) => "  ",
    };
    format!(
        "{mark}{:>6} {:>7} {:>8} {:>15} {:>6} {:>7} {:>6} {:>6}  {}{names}{}",
        cell(record.impact_speed_m_per_s, SPEED),
        cell(record.mass_kg, MASS),
        number(record, name, record.dynamic_crush_m, CRUSH),
        interval,
        number(record, "time_of_dynamic_crush_s", record.time_of_dynamic_crush_s, (MILLI, 1, "ms")),
        number(record, "delta_v_m_per_s", record.delta_v_m_per_s, SPEED),
        number(record, "peak_acceleration_m_per_s2", record.peak_acceleration_m_per_s2, PEAK),
        number(record, "coefficient_of_restitution", record.coefficient_of_restitution, (1.0, 2, "")),
        record.candidate,
        if record.extrapolates { ", extrapolates" } else { "" },
    )
}

/// A line each for the collision with a partner and for the occupant.
pub fn partner_and_occupant(record: &PredictionV1) -> Vec<String> {
    const LENGTH: Metric = (MILLI, 1, "mm");
    const ENERGY: Metric = (1e-3, 1, "kJ");
    let collision = record.collision.as_ref().map(|both| {
        format!(
            "        closing {}, common {}; mutual crush {}, partner {}; energy {} and {}; partner {}, dv {}, peak {}; \
             after {} and {}",
            with_unit(Some(both.closing_speed_m_per_s), SPEED),
            with_unit(both.common_velocity_m_per_s, SPEED),
            with_unit(both.mutual_crush_m, LENGTH),
            with_unit(both.partner_crush_m, LENGTH),
            with_unit(both.absorbed_j, ENERGY),
            with_unit(both.partner_absorbed_j, ENERGY),
            with_unit(Some(both.partner_mass_kg), (1.0, 0, "kg")),
            with_unit(both.partner_delta_v_m_per_s, SPEED),
            with_unit(both.partner_peak_acceleration_m_per_s2, PEAK),
            with_unit(both.velocity_after_m_per_s, SPEED),
            with_unit(both.partner_velocity_after_m_per_s, SPEED),
        )
    });
    let occupant = record.occupant.as_ref().map(|occupant| {
        format!(
            "        occupant: peak {} at {}, excursion {}, ride-down {}",
            with_unit(Some(occupant.peak_acceleration_m_per_s2), PEAK),
            with_unit(Some(occupant.time_of_peak_s), (1e3, 1, "ms")),
            with_unit(Some(occupant.largest_excursion_m), CRUSH),
            with_unit(occupant.ride_down_share, (1e2, 0, "%")),
        )
    });
    collision.into_iter().chain(occupant).collect()
}

/// Crush of the first candidate over speed and mass, where several of both were asked for.
pub fn what_if(rows: &[Row]) -> Vec<String> {
    let Some(first) = rows.first() else { return Vec::new() };
    let candidate = &first.record.candidate;
    let own: Vec<&Row> = rows.iter().filter(|row| row.record.candidate == *candidate).collect();
    let (mut speeds, mut masses): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    for row in &own {
        if !speeds.contains(&row.speed_m_per_s) {
            speeds.push(row.speed_m_per_s);
        }
        if !masses.contains(&row.record.mass_kg) {
            masses.push(row.record.mass_kg);
        }
    }
    if speeds.len() < 2 || masses.len() < 2 {
        return Vec::new();
    }
    let cell = |speed: f64, mass: f64| {
        let row = own.iter().find(|row| row.speed_m_per_s == speed && row.record.mass_kg == mass);
        let crush = row.and_then(|row| row.record.dynamic_crush_m);
        format!("{:>9}", crush.map_or_else(|| "-".to_owned(), |crush| cell(crush, (MILLI, 1, "mm"))))
    };
    let head: String = masses.iter().map(|mass| format!("{:>9}", with_unit(Some(*mass), (1.0, 0, "kg")))).collect();
    let mut lines = vec![format!("crush in {}, {candidate}:", unit_shown("mm")), format!("{:>11}{head}", "")];
    lines.extend(speeds.iter().map(|speed| {
        let cells: String = masses.iter().map(|mass| cell(*speed, *mass)).collect();
        format!("{:>11}{cells}", with_unit(Some(*speed), SPEED))
    }));
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(speed_m_per_s: f64, mass_kg: f64, crush: f64) -> Row {
        let record = PredictionV1 {
            candidate: "kelvin/closed-form/1".to_owned(),
            impact_speed_m_per_s: speed_m_per_s,
            mass_kg,
            dynamic_crush_m: Some(crush),
            ..PredictionV1::default()
        };
        Row { speed_m_per_s, record }
    }

    #[test]
    fn a_table_of_speed_and_mass_needs_several_of_both() {
        let rows = [row(10.0, 1000.0, 0.4), row(12.5, 1000.0, 0.5), row(10.0, 1200.0, 0.44), row(12.5, 1200.0, 0.55)];
        assert_eq!(what_if(&rows[..2]), Vec::<String>::new());
        let lines = what_if(&rows);
        assert_eq!(lines[0], "crush in mm, kelvin/closed-form/1:");
        assert_eq!(lines[1], "             1000 kg  1200 kg");
        assert_eq!(lines[2], "  36.0 km/h    400.0    440.0");
        assert_eq!(lines[3], "  45.0 km/h    500.0    550.0");
    }

    #[test]
    fn what_is_not_reached_is_a_stroke() {
        let mut never = row(10.0, 1000.0, 0.4).record;
        never.dynamic_crush_m = None;
        let plain = line(&never, None);
        assert!(plain.starts_with("  36.0  1000.0        -               -"), "{plain}");
        assert_eq!(line(&never, Some(true)), format!("> {plain}"));
        assert_eq!(line(&never, Some(false)), format!("  {plain}"));
        // Figures stand below their titles, marked or not.
        let ends = |text: &str| text.find("crush mm").map(|at| at + 8);
        assert_eq!(ends(&header(true)), ends(&header(false)).map(|end| end + 2));
    }
}
