//! The ISO 13499 code of a curve, built from SENTYP, SENLOC, SENATT, AXIS and the pre-filter.

use crumple_signal::Axis;
use crumple_signal::iso13499::{IsoCode, Parts};

use crate::formats::ev5::records::Curve;
use crate::formats::ev5::sensor;

/// The code, or `None` where a field has no counterpart in the tables: none is invented.
///
/// The direction is a letter, since data from version 4 of the guide on follow SAE J211; NHTSA's own codes have the
/// digit. The filter class is `P` where a pre-filter is stated, `?` else. A redundant sensor has `RD` in the first open
/// fine location after the first.
pub fn code(curve: &Curve) -> Option<IsoCode> {
    let (main, mut fine) = place(curve)?;
    let dimension = match curve.sensor.as_str() {
        "AC" => "AC",
        "AV" => "AV",
        "AA" => "AA",
        "AD" => "AN",
        "DS" => "DS",
        "LC" if curve.y_unit.eq_ignore_ascii_case("NWM") => "MO",
        "LC" => "FO",
        _ => return None,
    };
    let direction = match sensor::axis(curve) {
        Some(Axis::X) => 'X',
        Some(Axis::Y) => 'Y',
        Some(Axis::Z) => 'Z',
        Some(Axis::Resultant) => 'R',
        None => '0',
    };
    let object = match curve.vehicle {
        0 => 'B',
        n => char::from_digit(n, 10)?,
    };
    let position = match curve.location.as_str() {
        "" | "NA" => '0',
        "01" | "1" => '1',
        "02" | "2" => '3',
        _ => return None,
    };
    if curve.channel_status == "R"
        && let Some(open) = fine[1..].iter_mut().find(|part| **part == "00")
    {
        *open = "RD";
    }
    let filter = if curve.prefilter_hz.is_some() { 'P' } else { '?' };
    Some(IsoCode::build(&Parts { object, position, main, fine, dimension, direction, filter }))
}

fn place(curve: &Curve) -> Option<(&'static str, [&str; 3])> {
    let comment = curve.comment.as_deref().unwrap_or_default().to_ascii_uppercase();
    Some(match curve.attachment.as_str() {
        "FLLR" => ("FORA", ["LE", "RE", "00"]),
        "FLRR" => ("FORA", ["RI", "RE", "00"]),
        "DSLF" => ("SILB", ["LE", "FR", "00"]),
        "DSRF" => ("SILB", ["RI", "FR", "00"]),
        "DSLR" => ("SILB", ["LE", "RE", "00"]),
        "DSRR" => ("SILB", ["RI", "RE", "00"]),
        "VECG" => ("VEHC", ["CG", "00", "00"]),
        "ENGN" if comment.contains("TOP") => ("ENGN", ["TP", "00", "00"]),
        "ENGN" if comment.contains("BOTTOM") => ("ENGN", ["BO", "00", "00"]),
        "ENGN" => ("ENGN", ["00", "00", "00"]),
        "HDCG" => ("HEAD", ["CG", "00", "00"]),
        "NEKU" => ("NECK", ["UP", "00", "00"]),
        "CHST" => ("CHST", ["00", "00", "00"]),
        "PVCN" => ("PELV", ["00", "00", "00"]),
        "FMRL" => ("FEMR", ["LE", "00", "00"]),
        "FMRR" => ("FEMR", ["RI", "00", "00"]),
        cell => {
            let digits = cell.strip_prefix("LC").filter(|d| d.len() == 4 && d.bytes().all(|b| b.is_ascii_digit()))?;
            ("LOMA", [&digits[..2], &digits[2..], "00"])
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code_of(vehicle: u32, sensor: &str, attachment: &str, status: &str, comment: &str) -> Option<String> {
        let curve = Curve {
            vehicle,
            sensor: sensor.to_owned(),
            location: "NA".to_owned(),
            attachment: attachment.to_owned(),
            axis: "XG".to_owned(),
            channel_status: status.to_owned(),
            prefilter_hz: Some(2800.0),
            comment: Some(comment.to_owned()),
            ..Curve::default()
        };
        code(&curve).map(|c| c.to_string())
    }

    #[test]
    fn codes_are_those_of_the_tables() {
        let is = |found: Option<String>, code: &str| assert_eq!(found.as_deref(), Some(code));
        is(code_of(1, "AC", "FLLR", "P", ""), "10FORALERE00ACXP");
        is(code_of(1, "AC", "FLLR", "R", ""), "10FORALERERDACXP");
        is(code_of(1, "AC", "VECG", "R", ""), "10VEHCCGRD00ACXP");
        is(code_of(1, "AC", "ENGN", "P", "BOTTOM OF ENGINE X"), "10ENGNBO0000ACXP");
        is(code_of(0, "LC", "LC0116", "P", ""), "B0LOMA011600FOXP");
        assert_eq!(code_of(1, "AC", "OTHR", "P", "somewhere"), None);
        assert_eq!(code_of(1, "ET", "FLLR", "P", ""), None);
    }
}
