//! How far two numbers may be apart.

use super::unit::Unit;

/// `a` and `b` are the same if `|a - b| <= abs + rel * scale`.
///
/// The scale is `max(|a|, |b|)`; for a sample the largest magnitude of its waveform, for a number in a list or matrix
/// of numbers the largest in it, for a part of a complex number the larger part: a small value that came out of large
/// ones carries their rounding error, not its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Absolute part, in the unit of the number.
    pub abs: f64,
    /// Relative part.
    pub rel: f64,
}

impl Tolerance {
    /// Equal numbers only.
    pub const ZERO: Self = Self { abs: 0.0, rel: 0.0 };
    /// Not compared at all.
    pub const ANY: Self = Self { abs: f64::INFINITY, rel: 0.0 };

    /// What an engineer calls the same: 0.1 ms, 1 mm, 0.01 m/s, else 0.5 %.
    pub(crate) fn engineering(place: &str, unit: Option<Unit>) -> Self {
        match unit {
            // A sampling interval is not a time of an event.
            Some(Unit::Second) if place.ends_with("sample_time_s") => tolerance(0.0, 1e-9),
            Some(Unit::Second) => tolerance(1e-4, 0.0),
            Some(Unit::Metre) => tolerance(1e-3, 0.0),
            Some(Unit::MetrePerSecond) => tolerance(1e-2, 0.0),
            None => tolerance(1e-9, 5e-3),
        }
    }

    /// Whether nothing is compared.
    pub fn is_any(self) -> bool {
        self.abs.is_infinite()
    }

    /// Whether two numbers are the same within it.
    pub fn allows(self, a: f64, b: f64, scale: f64) -> bool {
        (a - b).abs() <= self.abs + self.rel * scale
    }
}

pub(crate) const fn tolerance(abs: f64, rel: f64) -> Tolerance {
    Tolerance { abs, rel }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every figure is a power of two, so that the limits are exact.
    #[test]
    fn both_parts_add_up_and_the_relative_one_refers_to_the_scale() {
        let both = tolerance(0.5, 0.25);
        assert!(both.allows(10.0, 11.5, 4.0), "0.5 + 0.25 * 4 is 1.5");
        assert!(!both.allows(10.0, 11.5, 3.9));
        assert!(!both.allows(10.0, 11.75, 4.0));
        assert!(tolerance(0.5, 0.0).allows(1e6, 1e6 + 0.5, 1e6));
        assert!(!tolerance(0.5, 0.0).allows(1e6, 1e6 + 0.625, 1e6));
        assert!(tolerance(0.0, 0.25).allows(-4.0, -3.0, 4.0) && !tolerance(0.0, 0.25).allows(-4.0, -2.5, 4.0));
        assert!(Tolerance::ANY.allows(0.0, 1e300, 0.0) && !Tolerance::ZERO.allows(0.0, f64::MIN_POSITIVE, 1.0));
    }
}
