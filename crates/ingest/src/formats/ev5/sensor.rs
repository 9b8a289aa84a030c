//! Where a sensor sits, in words, and how good a place that is for the crash pulse.

use crumple_signal::Axis;
use crumple_signal::iso13499::{IsoCode, Parts};

use crate::formats::ev5::specification::Curve;
use crate::recording::content::Fitness;

/// `vehicle, left rear seat crossmember`; `driver, head`; `barrier, load cell F-01`. The part before the comma is
/// `vehicle`, `vehicle 2`, `barrier` or an occupant.
pub fn location(curve: &Curve) -> String {
    let who = owner(curve);
    let what =
        curve.comment.as_deref().and_then(|c| words_of_comment(c, curve)).or_else(|| attachment(&curve.attachment));
    match what {
        Some(what) => format!("{who}, {what}"),
        None if curve.attachment.is_empty() => who,
        None => format!("{who}, {}", curve.attachment),
    }
}

fn owner(curve: &Curve) -> String {
    let of_vehicle = if curve.vehicle > 1 { format!(" of vehicle {}", curve.vehicle) } else { String::new() };
    match (curve.vehicle, curve.location.as_str()) {
        (0, _) => "barrier".to_owned(),
        (1, "" | "NA") => "vehicle".to_owned(),
        (n, "" | "NA") => format!("vehicle {n}"),
        (_, "01" | "1") => format!("driver{of_vehicle}"),
        (_, "02" | "2") => format!("front passenger{of_vehicle}"),
        (_, seat) => format!("occupant {seat}{of_vehicle}"),
    }
}

/// The comment is often the only readable location: `LEFT REAR SEAT CROSSMEMBER XR`, `BARRIER F-01 Fx: No valid data`.
fn words_of_comment(comment: &str, curve: &Curve) -> Option<String> {
    let comment = comment.split(':').next().unwrap_or(comment);
    let is_axis = |word: &str| {
        let word = word.to_ascii_uppercase();
        let bare = word.strip_suffix(['R', 'G', 'L']).unwrap_or(&word);
        matches!(bare, "X" | "Y" | "Z" | "FX" | "FY" | "FZ" | "MX" | "MY" | "MZ")
    };
    let mut words: Vec<&str> = comment.split_whitespace().collect();
    while words.last().is_some_and(|last| is_axis(last)) {
        words.pop();
    }
    if curve.vehicle == 0 && words.first().is_some_and(|w| w.eq_ignore_ascii_case("barrier")) {
        words[0] = "load cell";
        return (words.len() > 1).then(|| words.join(" "));
    }
    if words.first().is_some_and(|w| matches!(w.to_ascii_uppercase().as_str(), "DRIVER" | "PASSENGER")) {
        words.remove(0);
    }
    (!words.is_empty()).then(|| words.join(" ").to_lowercase())
}

/// Attachment codes of the guide that are met on vehicle structures and dummies: in words; main and fine locations of
/// ISO/TS 13499, empty where the tables have no counterpart.
const ATTACHMENTS: [(&str, &str, &str, [&str; 3]); 18] = [
    ("FLLR", "rear floor, left", "FORA", ["LE", "RE", "00"]),
    ("FLRR", "rear floor, right", "FORA", ["RI", "RE", "00"]),
    ("FLLF", "front floor, left", "", [""; 3]),
    ("FLRF", "front floor, right", "", [""; 3]),
    ("DSLF", "left front sill", "SILB", ["LE", "FR", "00"]),
    ("DSRF", "right front sill", "SILB", ["RI", "FR", "00"]),
    ("DSLR", "left rear sill", "SILB", ["LE", "RE", "00"]),
    ("DSRR", "right rear sill", "SILB", ["RI", "RE", "00"]),
    ("VECG", "vehicle centre of gravity", "VEHC", ["CG", "00", "00"]),
    ("ENGN", "engine", "ENGN", ["00", "00", "00"]),
    ("HDCG", "head", "HEAD", ["CG", "00", "00"]),
    ("NEKU", "upper neck", "NECK", ["UP", "00", "00"]),
    ("CHST", "chest", "CHST", ["00", "00", "00"]),
    ("PVCN", "pelvis", "PELV", ["00", "00", "00"]),
    ("FMRL", "left femur", "FEMR", ["LE", "00", "00"]),
    ("FMRR", "right femur", "FEMR", ["RI", "00", "00"]),
    ("SHBT", "shoulder belt", "", [""; 3]),
    ("LPBO", "lap belt", "", [""; 3]),
];

fn attachment(code: &str) -> Option<String> {
    let words = ATTACHMENTS.iter().find(|(other, ..)| *other == code).map(|(_, words, ..)| (*words).to_owned());
    let cell = || code.strip_prefix("LC").filter(|cell| !cell.is_empty()).map(|cell| format!("load cell {cell}"));
    words.or_else(cell)
}

/// Manufacturer and range of the transducer.
pub fn words(curve: &Curve) -> Option<String> {
    let range = curve.range.map(|range| format!("range {range} {}", curve.y_unit));
    let parts: Vec<String> = curve.manufacturer.clone().into_iter().chain(range).collect();
    (!parts.is_empty()).then(|| parts.join(", "))
}

/// The axis by its letter; global (`XG`) and local (`XL`) alike.
pub fn axis(curve: &Curve) -> Option<Axis> {
    match curve.axis.as_str() {
        "XG" | "XL" | "X" => Some(Axis::X),
        "YG" | "YL" | "Y" => Some(Axis::Y),
        "ZG" | "ZL" | "Z" => Some(Axis::Z),
        "RES" | "RS" => Some(Axis::Resultant),
        _ => None,
    }
}

/// How well an accelerometer serves as the crash pulse of vehicle `vehicle`: along x on its structure, at a place that
/// moves with the passenger compartment. `None` for any other place, the engine first of all.
pub fn fitness(curve: &Curve, vehicle: u32) -> Option<Fitness> {
    let on_structure = matches!(curve.location.as_str(), "" | "NA") && curve.vehicle == vehicle;
    if curve.sensor != "AC" || !on_structure || axis(curve) != Some(Axis::X) {
        return None;
    }
    let comment = curve.comment.as_deref().unwrap_or_default().to_ascii_uppercase();
    let says = |words: &[&str]| words.iter().any(|w| comment.contains(w));
    let code = curve.attachment.as_str();
    if code == "ENGN"
        || says(&["ENGINE", "CALIPER", "BRAKE", "BUMPER", "RADIATOR", "STEERING", "INSTRUMENT PANEL", "DASH"])
    {
        return None;
    }
    let (place, why) = if matches!(code, "FLLR" | "FLRR") || says(&["REAR SEAT", "REAR FLOOR", "REAR CROSSMEMBER"]) {
        (0, "rear-seat crossmember or rear floor")
    } else if matches!(code, "DSLR" | "DSRR") || (says(&["SILL"]) && says(&["REAR"])) {
        (1, "rear sill")
    } else if matches!(code, "DSLF" | "DSRF") || says(&["SILL"]) {
        (2, "sill")
    } else if says(&["B-PILLAR", "B PILLAR", "BPILLAR"]) {
        (3, "B-pillar")
    } else if code == "VECG" || says(&["VEHICLE CG", "CENTER OF GRAVITY", "CENTRE OF GRAVITY"]) {
        (4, "vehicle centre of gravity")
    } else {
        return None;
    };
    Some(Fitness { redundant: curve.channel_status == "R", place, why })
}

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
    let direction = match axis(curve) {
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
    let code = curve.attachment.as_str();
    if let Some((_, _, main, fine)) = ATTACHMENTS.iter().find(|(other, ..)| *other == code) {
        let fine = match code {
            "ENGN" if comment.contains("TOP") => ["TP", "00", "00"],
            "ENGN" if comment.contains("BOTTOM") => ["BO", "00", "00"],
            _ => *fine,
        };
        return (!main.is_empty()).then_some((*main, fine));
    }
    let digits = code.strip_prefix("LC").filter(|d| d.len() == 4 && d.bytes().all(|b| b.is_ascii_digit()))?;
    Some(("LOMA", [&digits[..2], &digits[2..], "00"]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(attachment: &str, comment: &str) -> Curve {
        Curve {
            vehicle: 1,
            sensor: "AC".to_owned(),
            location: "NA".to_owned(),
            attachment: attachment.to_owned(),
            axis: "XG".to_owned(),
            comment: (!comment.is_empty()).then(|| comment.to_owned()),
            ..Curve::default()
        }
    }

    #[test]
    fn locations_are_words() {
        assert_eq!(location(&curve("FLLR", "LEFT REAR SEAT CROSSMEMBER XR")), "vehicle, left rear seat crossmember");
        assert_eq!(location(&curve("FLLR", "")), "vehicle, rear floor, left");
        assert_eq!(location(&curve("QQQQ", "")), "vehicle, QQQQ");
        let driver = Curve { location: "01".to_owned(), ..curve("HDCG", "DRIVER HEAD X") };
        assert_eq!(location(&driver), "driver, head");
        let cell = Curve { vehicle: 0, ..curve("LC0601", "BARRIER F-01 Fx: No valid data") };
        assert_eq!(location(&cell), "barrier, load cell F-01");
    }

    #[test]
    fn places_are_ranked_and_the_engine_never_taken() {
        let place = |code, comment| fitness(&curve(code, comment), 1).map(|f| f.place);
        assert_eq!(place("FLLR", ""), Some(0));
        assert_eq!(place("OTHR", "LEFT REAR SEAT CROSSMEMBER X"), Some(0));
        assert_eq!(place("DSLR", ""), Some(1));
        assert_eq!(place("OTHR", "LEFT B-PILLAR BASE X"), Some(3));
        assert_eq!(place("VECG", ""), Some(4));
        assert_eq!(place("ENGN", "TOP OF ENGINE X"), None);
        assert_eq!(place("OTHR", "TOP OF ENGINE X"), None);
        assert_eq!(place("OTHR", "RIGHT FRONT BRAKE CALIPER X"), None);
        assert_eq!(fitness(&curve("FLLR", ""), 2), None);
    }

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
