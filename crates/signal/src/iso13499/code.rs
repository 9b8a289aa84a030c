//! The 16-character channel code of ISO/TS 13499 (ISO-MME), as laboratories write it.
//!
//! Test object, position, main location (4), three fine locations (2 each), physical dimension (2), direction, filter
//! class: `11HEADCGCGH3ACXA`. The word tables hold the codes met in vehicle tests; a code that is not in them keeps its
//! letters. Written codes differ from the rule in known ways ([`IsoCode::parse`]); remarks say how
//! they were read.

use std::fmt;

use super::filter_class::FilterClass;
use super::wildcard::wildcard;
use super::words::{fine_location_words, is_dummy_location, main_location_words, position_words};
use crate::{Axis, QuantityKind};

/// A code of sixteen characters: capital letters, digits, `?` for what is not known, `_` where a writer left a place
/// open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct IsoCode([u8; 16]);

/// Why a text is no channel code.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CodeError {
    /// Too long or too short.
    #[error("{text:?} has {length} characters, a channel code has 16")]
    Length {
        /// What was found.
        text: String,
        /// How long it is.
        length: usize,
    },
    /// Something else than letters and digits.
    #[error("{text:?} holds {found:?}, a channel code has letters and digits")]
    Character {
        /// What was found.
        text: String,
        /// The first such character.
        found: char,
    },
}
/// The parts a code is built of. Each text is cut or filled with zeros to its width.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Parts<'a> {
    /// 1: test object, `1` for vehicle 1, `B` for the barrier.
    pub object: char,
    /// 2: position, `0` for none, `1` front left.
    pub position: char,
    /// 3-6.
    pub main: &'a str,
    /// 7-8, 9-10, 11-12.
    pub fine: [&'a str; 3],
    /// 13-14: physical dimension.
    pub dimension: &'a str,
    /// 15: `X`, `Y`, `Z`, `R` or `0`.
    pub direction: char,
    /// 16: filter class letter.
    pub filter: char,
}

impl IsoCode {
    /// Reads a code as written, with remarks on where it departs from the rule.
    ///
    /// Besides the rule: small letters; `_` for open places; a suffix from the seventeenth character on that starts
    /// with `_`, `.` or a blank (`..ACXD_NoName1`); fifteen characters without filter class; thirteen and fourteen
    /// without test object and position (`VEHC0000__VEX`).
    pub fn parse(text: &str) -> Result<(Self, Vec<String>), CodeError> {
        let mut remarks = Vec::new();
        let written = text.trim();
        let mut code = written.to_ascii_uppercase();
        if let Some(tail) = code.get(16..).filter(|tail| tail.starts_with(['_', '.', ' '])) {
            remarks.push(format!("suffix {tail:?} of code {written:?} is left off"));
            code.truncate(16);
        }
        let length = code.chars().count();
        if let Some(found) = code.chars().find(|c| !(c.is_ascii_alphanumeric() || matches!(c, '_' | '?'))) {
            return Err(CodeError::Character { text: abbreviated(written), found });
        }
        let filled = match length {
            16 => code,
            15 => format!("{code}?"),
            14 => format!("??{code}"),
            13 => format!("??{code}?"),
            _ => return Err(CodeError::Length { text: abbreviated(written), length }),
        };
        if length < 16 {
            let missing = match length {
                15 => "filter class",
                14 => "test object and position",
                _ => "test object, position and filter class",
            };
            remarks.push(format!("code {written:?} has {length} characters: taken as one without {missing}, {filled}"));
        }
        if filled.contains('_') {
            remarks.push(format!("code {written:?} has places left open by \"_\""));
        }
        let mut bytes = [b'?'; 16];
        bytes.copy_from_slice(&filled.as_bytes()[..16]);
        Ok((Self(bytes), remarks))
    }

    /// Builds a code. Characters that no code has become `?`.
    pub fn build(parts: &Parts) -> Self {
        let mut bytes = [b'0'; 16];
        let mut put = |from: usize, width: usize, text: &str| {
            for (k, c) in text.chars().take(width).enumerate() {
                let c = c.to_ascii_uppercase();
                bytes[from + k] = if c.is_ascii_alphanumeric() { c as u8 } else { b'?' };
            }
        };
        put(0, 1, &parts.object.to_string());
        put(1, 1, &parts.position.to_string());
        put(2, 4, parts.main);
        for (k, fine) in parts.fine.iter().enumerate() {
            put(6 + 2 * k, 2, fine);
        }
        put(12, 2, parts.dimension);
        put(14, 1, &parts.direction.to_string());
        put(15, 1, &parts.filter.to_string());
        Self(bytes)
    }

    /// The sixteen characters.
    pub fn as_str(&self) -> &str {
        // Only ASCII gets in.
        std::str::from_utf8(&self.0).unwrap_or("????????????????")
    }

    fn part(&self, from: usize, to: usize) -> &str {
        &self.as_str()[from..to]
    }

    /// 1: the test object.
    pub fn object(&self) -> char {
        char::from(self.0[0])
    }

    /// 2: the position.
    pub fn position(&self) -> char {
        char::from(self.0[1])
    }

    /// 3-6: the main location.
    pub fn main_location(&self) -> &str {
        self.part(2, 6)
    }

    /// Whether the main location is in the table of words.
    pub fn has_known_location(&self) -> bool {
        main_location_words(self.main_location()).is_some()
    }

    /// 7-8, 9-10 and 11-12: the fine locations.
    pub fn fine_locations(&self) -> [&str; 3] {
        [self.part(6, 8), self.part(8, 10), self.part(10, 12)]
    }

    /// 13-14: the physical dimension.
    pub fn dimension(&self) -> &str {
        self.part(12, 14)
    }

    /// Whether a fine location says the sensor is a redundant one.
    pub fn redundant(&self) -> bool {
        self.fine_locations().contains(&"RD")
    }

    /// The quantity of the dimension, if it is one that signals have here, and its name in words.
    pub fn quantity(&self) -> (Option<QuantityKind>, &'static str) {
        use QuantityKind as Q;
        match self.dimension() {
            "AC" => (Some(Q::Acceleration), "acceleration"),
            "VE" => (Some(Q::Velocity), "velocity"),
            "VA" => (Some(Q::Velocity), "velocity, integrated from acceleration"),
            "VD" => (Some(Q::Velocity), "velocity, differentiated from displacement"),
            "DS" => (Some(Q::Displacement), "displacement"),
            "DV" => (Some(Q::Displacement), "displacement, integrated from velocity"),
            "DC" => (Some(Q::Displacement), "distance"),
            "AA" => (Some(Q::AngularAcceleration), "angular acceleration"),
            "AV" => (Some(Q::AngularVelocity), "angular velocity"),
            "AN" => (Some(Q::Angle), "angle"),
            "FO" => (Some(Q::Force), "force"),
            "MO" => (Some(Q::Moment), "moment"),
            "PR" => (Some(Q::Pressure), "pressure"),
            "VO" => (Some(Q::Voltage), "voltage"),
            "EN" => (None, "energy"),
            "IM" => (None, "impulse"),
            "MA" => (None, "mass"),
            "TI" => (None, "time"),
            "EV" => (None, "event"),
            "ST" => (None, "strain"),
            _ => (None, "not known"),
        }
    }

    /// 15: the axis. Digits 1, 2 and 3 are x, y and z, see [`polarity_remark`](Self::polarity_remark).
    pub fn axis(&self) -> Option<Axis> {
        match self.0[14] {
            b'X' | b'1' => Some(Axis::X),
            b'Y' | b'2' => Some(Axis::Y),
            b'Z' | b'3' => Some(Axis::Z),
            b'R' => Some(Axis::Resultant),
            _ => None,
        }
    }

    /// What the direction says of the sign, where it departs from SAE J211. NHTSA writes 1 for data that follow J211,
    /// so the digit decides nothing.
    pub fn polarity_remark(&self) -> Option<String> {
        let axis = match self.0[14] {
            b'1' => "x",
            b'2' => "y",
            b'3' => "z",
            _ => return None,
        };
        Some(format!(
            "direction {} means {axis} with a sign other than SAE J211; some laboratories write it for J211 data: \
             check the sign",
            char::from(self.0[14])
        ))
    }

    /// 16: the filter class.
    pub fn filter_class(&self) -> FilterClass {
        let cfc = |class| FilterClass::Cfc { class, old: false };
        let old = |class| FilterClass::Cfc { class, old: true };
        match self.0[15] {
            b'A' => cfc(1000),
            b'B' => cfc(600),
            b'C' => cfc(180),
            b'D' => cfc(60),
            b'E' => old(1000),
            b'F' => old(600),
            b'G' => old(180),
            b'H' => old(60),
            b'0' | b'_' => FilterClass::Unfiltered,
            b'P' => FilterClass::PreFiltered,
            b'L' => FilterClass::Other("filtered to CFC 20"),
            b'Q' => FilterClass::Other("filtered below CFC 60"),
            b'S' => FilterClass::Other("special filter"),
            b'1' => FilterClass::Other("NHTSA FIR100 filter"),
            b'2' | b'3' => FilterClass::Other("mixed filters"),
            b'V' => FilterClass::Other("from video"),
            b'X' => FilterClass::Other("a constant"),
            _ => FilterClass::Unknown,
        }
    }

    /// Where the sensor sits, in words: `vehicle, crossmember, left, rear`;
    /// `occupant front left, head, centre of gravity`. The part before the first comma says whose it is.
    pub fn location(&self) -> String {
        let mut words = vec![self.owner()];
        if self.main_location() != "VEHC" {
            words.push(
                main_location_words(self.main_location())
                    .map_or_else(|| self.main_location().trim_matches(['_', '0', '?']).to_owned(), str::to_owned),
            );
        }
        for (k, fine) in self.fine_locations().into_iter().enumerate() {
            let open = fine.bytes().all(|b| matches!(b, b'0' | b'_' | b'?'));
            // The third fine location names the dummy, or repeats the place.
            let repeated = k > 0 && self.fine_locations()[..k].contains(&fine);
            if !open && !repeated {
                words.push(fine_location_words(fine).map_or_else(|| fine.to_owned(), str::to_owned));
            }
        }
        words.retain(|word| !word.is_empty());
        words.join(", ")
    }

    fn owner(&self) -> String {
        let position = position_words(self.position());
        if is_dummy_location(self.main_location()) {
            return position.map_or_else(|| "occupant".to_owned(), |words| format!("occupant {words}"));
        }
        let object = match self.object() {
            '1' | '?' => "vehicle".to_owned(),
            n @ '2'..='9' => format!("vehicle {n}"),
            'B' => "barrier".to_owned(),
            'M' => "barrier, mobile".to_owned(),
            'S' => "sled".to_owned(),
            'P' => "pendulum".to_owned(),
            'H' => "linear impactor".to_owned(),
            'D' => "dummy".to_owned(),
            'C' => "component".to_owned(),
            'T' => "test rig".to_owned(),
            _ => "other test object".to_owned(),
        };
        position.map_or_else(|| object.clone(), |words| format!("{object}, {words}"))
    }

    /// Whether the code fits a pattern in which `?` stands for one character and `*` for any number of them.
    pub fn matches(&self, pattern: &str) -> bool {
        wildcard(pattern, self.as_str())
    }
}

impl fmt::Display for IsoCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// The first 40 characters, for a message.
fn abbreviated(text: &str) -> String {
    text.chars().take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> IsoCode {
        IsoCode::parse(text).unwrap().0
    }

    #[test]
    fn every_field_is_decoded() {
        let (code, remarks) = IsoCode::parse("11HEADCGCGH3ACXA").unwrap();
        assert!(remarks.is_empty());
        assert_eq!(code.location(), "occupant front left, head, centre of gravity, Hybrid III 50 %");
        assert_eq!(code.quantity(), (Some(QuantityKind::Acceleration), "acceleration"));
        assert_eq!((code.axis(), code.filter_class().cfc()), (Some(Axis::X), Some(1000)));
        assert_eq!(parsed("10VEHC0000__ACXD").location(), "vehicle");
        assert_eq!(parsed("10SEATLERE00ACXD").location(), "vehicle, seat, left, rear");
        assert_eq!(parsed("20FORALERE00AC1P").location(), "vehicle 2, floor over the rear axle, left, rear");
        assert_eq!(parsed("M0MBARLEMIUPACXP").location(), "barrier, mobile, mobile barrier, left, middle, upper");
        assert_eq!(parsed("10QQQQ000000ACXD").location(), "vehicle, QQQQ");
    }

    #[test]
    fn filter_letters_are_classes() {
        let class = |letter: char| parsed(&format!("10VEHC000000ACX{letter}")).filter_class();
        for (letters, cfc) in [("AE", 1000), ("BF", 600), ("CG", 180), ("DH", 60)] {
            for letter in letters.chars() {
                assert_eq!(class(letter).cfc(), Some(cfc));
            }
        }
        assert_eq!(class('P'), FilterClass::PreFiltered);
        assert_eq!((class('0'), class('_')), (FilterClass::Unfiltered, FilterClass::Unfiltered));
        assert_eq!((class('?'), class('L').cfc()), (FilterClass::Unknown, None));
        assert_eq!(class('H').to_string(), "CFC 60 by ISO 6487:1987 or J211:1988");
    }

    #[test]
    fn codes_that_break_the_rule_are_taken_with_a_remark() {
        for (text, taken) in [
            ("10VEHC0000__ACXD", "10VEHC0000__ACXD"),
            ("10VEHC0000__ACX_", "10VEHC0000__ACX_"),
            ("11HEADCG00__ACR", "11HEADCG00__ACR?"),
            ("VEHC0000__VEX", "??VEHC0000__VEX?"),
            ("10VEHC0000__ACXD_NoName1", "10VEHC0000__ACXD"),
            ("10VEHCTRNK__ACXD", "10VEHCTRNK__ACXD"),
        ] {
            let (code, remarks) = IsoCode::parse(text).unwrap();
            assert_eq!(code.as_str(), taken);
            assert!(!remarks.is_empty(), "{text}");
        }
        assert_eq!(parsed(" 11headcgcgh3acxa ").as_str(), "11HEADCGCGH3ACXA");
    }

    #[test]
    fn other_texts_are_refused() {
        for text in ["", "HEAD", "11HEADCGCGH3ACXA1", "11HEADCGCGH3AC-A", "11HEADCGCGH3AC\u{e9}A", "NOVALUE"] {
            assert!(IsoCode::parse(text).is_err(), "{text}");
        }
        assert_eq!(IsoCode::parse("HEAD").unwrap_err().to_string(), "\"HEAD\" has 4 characters, a channel code has 16");
    }

    #[test]
    fn a_digit_for_the_direction_is_an_axis_and_a_remark_on_the_sign() {
        let code = parsed("10FORALERE00AC1P");
        assert_eq!(code.axis(), Some(Axis::X));
        assert!(code.polarity_remark().unwrap().contains("other than SAE J211"));
        assert_eq!(parsed("10FORALERE00ACXP").polarity_remark(), None);
    }

    #[test]
    fn a_code_is_built_from_its_parts() {
        let parts = Parts {
            object: '1',
            position: '0',
            main: "FORA",
            fine: ["LE", "RE", "RD"],
            dimension: "AC",
            direction: 'X',
            filter: 'P',
        };
        let code = IsoCode::build(&parts);
        assert_eq!(code.as_str(), "10FORALERERDACXP");
        assert!(code.redundant());
        assert_eq!(IsoCode::parse(code.as_str()).unwrap().0, code);
    }
}
