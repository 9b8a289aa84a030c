//! Values that a person types: a profile, a test, a line, coefficients, each with units.

use std::ffi::OsString;

use crumple_metrics::BarrierTest;
use crumple_signal::QuantityKind;
use crumple_signal::unit::{Dimension, parse_value};
use crumple_stage::program;

const LENGTH: Dimension = Dimension::Signal(QuantityKind::Displacement);
const SPEED: Dimension = Dimension::Signal(QuantityKind::Velocity);
const ANGLE: Dimension = Dimension::Signal(QuantityKind::Angle);
/// Stiffness a width: a force over two lengths.
const STIFFNESS_A_WIDTH: Dimension = Dimension::Signal(QuantityKind::Pressure);

/// Most stations of a profile.
const MOST_STATIONS: usize = 12;

/// The line that was typed with `added` flags, to be typed in its place.
pub(super) fn line_with(words: &[OsString], added: &[String]) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./,=:+^@%".contains(c);
    let word = |word: &OsString| {
        let word = word.to_string_lossy();
        if !word.is_empty() && word.chars().all(is_plain) { word.into_owned() } else { format!("\"{word}\"") }
    };
    let line = std::iter::once(program("damage")).chain(words.iter().map(word)).chain(added.iter().cloned());
    line.collect::<Vec<_>>().join(" ")
}

/// Residual crush at stations of equal spacing, m.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Profile(pub(super) Vec<f64>);

/// `b0`, `b1` and, where they are stated, mass and width of the tests that they are from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Line {
    pub(super) b0_m_per_s: f64,
    pub(super) b1_per_s: f64,
    pub(super) mass_and_width: Option<(f64, f64)>,
}

/// A and B.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Coefficients {
    pub(super) a_n_per_m: f64,
    pub(super) b_n_per_m2: f64,
}

fn value(text: &str, dimension: Dimension) -> Result<f64, String> {
    parse_value(text, dimension).map_err(|error| error.to_string())
}

fn positive(text: &str, dimension: Dimension) -> Result<f64, String> {
    let value = value(text, dimension)?;
    if value > 0.0 { Ok(value) } else { Err(format!("{text:?} is not above zero")) }
}

fn not_negative(text: &str, dimension: Dimension) -> Result<f64, String> {
    let value = value(text, dimension)?;
    if value >= 0.0 { Ok(value) } else { Err(format!("{text:?} is below zero")) }
}

/// A mass, kg.
pub(super) fn mass(text: &str) -> Result<f64, String> {
    positive(text, Dimension::Mass)
}

/// Longest width, crush or yaw radius of a vehicle, m: more is a unit mistyped.
const LONGEST_M: f64 = 10.0;

/// A width or a yaw radius, m.
pub(super) fn length(text: &str) -> Result<f64, String> {
    of_a_vehicle(text, positive(text, LENGTH))
}

/// A length that a vehicle may have. An example in m would be followed as it stands.
fn of_a_vehicle(text: &str, length: Result<f64, String>) -> Result<f64, String> {
    let length = length.map_err(|problem| match text.trim().parse::<f64>() {
        Ok(_) => format!("{text:?} has no unit: write {text}cm, {text}mm, {text}in or {text}m"),
        Err(_) => problem,
    })?;
    if length <= LONGEST_M { Ok(length) } else { Err(format!("{text:?} is {length} m, longer than any vehicle")) }
}

/// A lever arm, m; its side does not count.
pub(super) fn lever(text: &str) -> Result<f64, String> {
    value(text, LENGTH).map(f64::abs)
}

/// A speed, m/s.
pub(super) fn speed(text: &str) -> Result<f64, String> {
    not_negative(text, SPEED)
}

/// The angle of the principal force, rad, at most 45°.
pub(super) fn angle(text: &str) -> Result<f64, String> {
    if text.trim().parse::<f64>().is_ok() {
        return Err(format!("{text:?} has no unit: write {text}deg"));
    }
    let angle = value(text, ANGLE)?;
    // 45 deg as a product of roundings.
    let limit = std::f64::consts::FRAC_PI_4;
    if angle.abs() > limit * (1.0 + 1e-12) {
        return Err(format!("{text:?} is above 45 deg, where the factor 1 + tan² of the angle no longer holds"));
    }
    Ok(angle.clamp(-limit, limit))
}

/// A coefficient of restitution, a number without unit.
pub(super) fn restitution(text: &str) -> Result<f64, String> {
    let e: f64 = text.trim().parse().map_err(|_| format!("{text:?} is no number, e.g. 0.1"))?;
    if (0.0..1.0).contains(&e) { Ok(e) } else { Err(format!("{text:?} is not from 0 up to below 1")) }
}

/// What semicolons part, or commas where there are none: a comma is then that of a decimal.
fn parts_of(text: &str) -> Vec<&str> {
    let mark = if text.contains(';') { ';' } else { ',' };
    text.split(mark).map(str::trim).collect()
}

/// `10,25,38,40,31,12 cm`: a unit behind the last value holds for those without one.
pub(super) fn profile(text: &str) -> Result<Profile, String> {
    let parts = parts_of(text);
    let last = parts.last().copied().unwrap_or_default();
    // No unit of length has a digit.
    let unit = last.rsplit(|c: char| c.is_ascii_digit() || c == '.').next().unwrap_or_default();
    if unit.is_empty() && parts.iter().all(|part| part.parse::<f64>().is_ok()) {
        return Err(format!("{text:?} has no unit: write {text}cm, {text}mm or {text}in"));
    }
    let with_unit = |part: &&str| match part.bytes().all(|byte| byte.is_ascii_digit() || b".,+-".contains(&byte)) {
        true => of_a_vehicle(part, not_negative(&format!("{part}{unit}"), LENGTH)),
        false => of_a_vehicle(part, not_negative(part, LENGTH)),
    };
    let crush_m = parts.iter().map(with_unit).collect::<Result<Vec<f64>, String>>()?;
    if !(2..=MOST_STATIONS).contains(&crush_m.len()) {
        return Err(format!("{} station(s), expected 2 to {MOST_STATIONS}, e.g. 10,25,38,40,31,12 cm", crush_m.len()));
    }
    Ok(Profile(crush_m))
}

/// `1400kg,56km/h,48cm,150cm`.
pub(super) fn test(text: &str) -> Result<BarrierTest, String> {
    let parts = parts_of(text);
    let [mass_kg, speed, crush, width] = parts[..] else {
        return Err(format!("{text:?} is not mass, impact speed, mean residual crush and width, e.g. {TEST}"));
    };
    Ok(BarrierTest {
        mass_kg: mass(mass_kg)?,
        impact_speed_m_per_s: positive(speed, SPEED)?,
        mean_crush_m: length(crush)?,
        width_m: length(width)?,
    })
}

/// How a test is typed.
pub(super) const TEST: &str = "1400kg,56km/h,48cm,150cm";

/// `2.2m/s,25/s` or `2.2m/s,25/s,1400kg,150cm`.
pub(super) fn line(text: &str) -> Result<Line, String> {
    let parts = parts_of(text);
    let (b0, b1, of) = match parts[..] {
        [b0, b1] => (b0, b1, None),
        [b0, b1, mass_kg, width] => (b0, b1, Some((mass(mass_kg)?, length(width)?))),
        _ => return Err(format!("{text:?} is not b0 and b1, e.g. 2.2m/s,25/s or 2.2m/s,25/s,1400kg,150cm")),
    };
    let (b0_m_per_s, b1_per_s) = (speed(b0)?, positive(b1, Dimension::Frequency)?);
    Ok(Line { b0_m_per_s, b1_per_s, mass_and_width: of })
}

/// `55kN/m,400kN/m^2`.
pub(super) fn coefficients(text: &str) -> Result<Coefficients, String> {
    let parts = parts_of(text);
    let [a, b] = parts[..] else { return Err(format!("{text:?} is not A and B, e.g. 55kN/m,400kN/m^2")) };
    let a_n_per_m = not_negative(a, Dimension::Stiffness)?;
    let no_b = |_| match b.parse::<f64>() {
        Ok(_) => format!("{b:?} has no unit: write {a},{b}kN/m^2 or {a},{b}lb/in^2"),
        Err(_) => format!("{b:?} is no B above zero with its unit, e.g. 400kN/m^2 or 60lb/in^2"),
    };
    Ok(Coefficients { a_n_per_m, b_n_per_m2: positive(b.trim(), STIFFNESS_A_WIDTH).map_err(no_b)? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_profile_has_one_unit_or_one_each() {
        assert_eq!(profile("10,25, 38 cm"), Ok(Profile(vec![0.1, 0.25, 0.38])));
        assert_eq!(profile("10cm;250 mm;0.5m"), Ok(Profile(vec![0.1, 0.25, 0.5])));
        assert_eq!(profile("10,5;25,3;38,1cm"), Ok(Profile(vec![0.105, 0.253, 0.381])));
        assert_eq!(profile("50,1e2mm"), Ok(Profile(vec![0.05, 0.1])));
        for wrong in ["10,20", "10cm", "10,-2 cm", "10,x cm", "1,2,3,4,5,6,7,8,9,10,11,12,13 cm", "", "10 kg,3 kg"] {
            assert!(profile(wrong).is_err(), "{wrong}");
        }
        assert!(profile("10,20").unwrap_err().contains("has no unit"));
    }

    #[test]
    fn stiffness_is_typed_by_tests_line_or_coefficients() {
        let typed = test(TEST).unwrap();
        assert_eq!((typed.mass_kg, typed.mean_crush_m, typed.width_m), (1400.0, 0.48, 1.5));
        assert_eq!(line("2m/s, 25/s").unwrap().mass_and_width, None);
        assert_eq!(line("7.2 km/h,25 1/s,1.4t,1.5m").unwrap().mass_and_width, Some((1400.0, 1.5)));
        assert_eq!(coefficients("55kN/m,400kN/m²"), Ok(Coefficients { a_n_per_m: 55e3, b_n_per_m2: 400e3 }));
        let pounds = coefficients("350 lb/in, 70 lb/in^2").unwrap();
        // By hand: 350 lbf/in are 61.3 kN/m, 70 psi are 483 kPa.
        assert!((pounds.a_n_per_m - 61_294.0).abs() < 1.0 && (pounds.b_n_per_m2 - 482_633.0).abs() < 1.0);
        for wrong in ["55,400", "55kN/m", "55kN/m,400kN/m", "-1kN/m,400kPa", "55kN/m,0kPa"] {
            assert!(coefficients(wrong).is_err(), "{wrong}");
        }
        assert!(line("2m/s").is_err() && test("1400kg,56km/h,48cm").is_err());
    }

    #[test]
    fn angles_end_at_45_degrees() {
        assert_eq!(angle("45deg"), Ok(std::f64::consts::FRAC_PI_4));
        assert!(angle("-15deg").is_ok() && angle("46deg").is_err() && angle("15").is_err());
        assert!(restitution("0").is_ok() && restitution("1").is_err() && restitution("0.1m").is_err());
    }
}
