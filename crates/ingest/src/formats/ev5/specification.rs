//! The EV5 text: sections of records, fields split by `|`.
//!
//! NHTSA Test Reference Guide, Volume I (vehicle tests), version 5.

use std::collections::BTreeSet;

use crate::formats::ev5::fields::Fields;
use crate::formats::ev5::records::{Barrier, Curve, Test, Vehicle};
use crate::formats::text::lines::decode;
use crate::{IngestError, Place};

/// What is read of an EV5 file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Specification {
    /// The test.
    pub test: Test,
    /// Its vehicles, one or two.
    pub vehicles: Vec<Vehicle>,
    /// The barrier, if there is one.
    pub barrier: Option<Barrier>,
    /// All listed curves, in the order of the file.
    pub curves: Vec<Curve>,
    /// Lines of the instrumentation section that cannot be read, with the reason.
    pub unread_lines: Vec<(usize, String)>,
    /// Whether the text ends as it should, with `----- END -----`.
    pub is_complete: bool,
}

/// Whether a line opens a section, and which: `----- TEST -----`, `-----TEST-----`.
fn section(line: &str) -> Option<&str> {
    let line = line.trim();
    (line.starts_with("-----") && line.ends_with("-----"))
        .then(|| line.trim_matches('-').trim())
        .filter(|key| !key.is_empty() && key.len() < 40)
}

/// Whether the text starts like an EV5 file, comments aside.
pub fn recognises(head: &[u8]) -> bool {
    decode(head)
        .trim_start_matches('\u{feff}')
        .lines()
        .map(str::trim)
        .find(|line| !line.is_empty() && !line.starts_with('#'))
        .is_some_and(|line| section(line) == Some("EV5"))
}

/// Reads the text. Tolerant of missing fields, blanks and unknown sections; the sections TEST, VEHICLE and
/// INSTRUMENTATION must be there.
pub fn parse(file: &str, bytes: &[u8]) -> Result<Specification, IngestError> {
    let text = decode(bytes);
    let mut specification = Specification::default();
    let mut current = "";
    let mut seen = Vec::new();
    let mut numbers = BTreeSet::new();
    for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let line_number = index + 1;
        if line.trim().is_empty() || line.starts_with('#') {
            continue;
        }
        if let Some(key) = section(line) {
            current = key;
            seen.push(key);
            if key == "END" {
                specification.is_complete = true;
                break;
            }
            continue;
        }
        let fields = Fields::split(line);
        match current {
            "TEST" => specification.test = Test::new(&fields),
            "VEHICLE" => {
                let next = specification.vehicles.len() + 1;
                specification.vehicles.push(Vehicle::new(&fields, next));
            }
            "BARRIER" => specification.barrier = Some(Barrier::new(&fields)),
            "INSTRUMENTATION" => match Curve::new(&fields) {
                Ok(curve) if !numbers.insert(curve.number) => {
                    specification.unread_lines.push((line_number, format!("curve {} is listed again", curve.number)));
                }
                Ok(curve) => specification.curves.push(curve),
                Err(reason) => specification.unread_lines.push((line_number, reason)),
            },
            _ => {}
        }
    }
    for key in ["TEST", "VEHICLE", "INSTRUMENTATION"] {
        if !seen.contains(&key) {
            return Err(IngestError::content(
                Place::file(file),
                format!("no section ----- {key} -----"),
                "an EV5 file with the sections TEST, VEHICLE and INSTRUMENTATION",
                "the file may be cut short: download it again",
            ));
        }
    }
    if specification.curves.is_empty() {
        let (line, reason) =
            specification.unread_lines.first().cloned().unwrap_or((0, "the section is empty".to_owned()));
        let place = if line > 0 { Place::line(file, line) } else { Place::file(file) };
        return Err(IngestError::content(
            place,
            format!("no curve in the section INSTRUMENTATION: {reason}"),
            "a line of 20 fields for each curve, split by |",
            "the file may be damaged: download it again",
        ));
    }
    Ok(specification)
}
