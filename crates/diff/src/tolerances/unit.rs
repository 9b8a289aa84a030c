//! The unit of a number in a record, read off the field's name: names carry units.

use serde_json::Value;

/// Units for which engineers have a tolerance of their own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Unit {
    Second,
    Metre,
    MetrePerSecond,
}

impl Unit {
    /// From a field name such as `dynamic_crush_m`; the fields `value`, `low` and `high` take the unit beside them.
    pub(crate) fn of_field(key: &str, beside: Option<&Value>) -> Option<Self> {
        if matches!(key, "value" | "low" | "high") {
            return Self::from_symbol(beside?.as_str()?);
        }
        if key.ends_with("_m_per_s") {
            Some(Self::MetrePerSecond)
        } else if key.ends_with("_per_m") || key.ends_with("_per_s") {
            None
        } else if key.ends_with("_m") {
            Some(Self::Metre)
        } else if key.ends_with("_s") {
            Some(Self::Second)
        } else {
            None
        }
    }

    /// From an SI symbol such as `m/s`.
    pub(crate) fn from_symbol(symbol: &str) -> Option<Self> {
        match symbol {
            "s" => Some(Self::Second),
            "m" => Some(Self::Metre),
            "m/s" => Some(Self::MetrePerSecond),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn names_tell_the_unit() {
        let unit_of = |key| Unit::of_field(key, None);
        assert_eq!(unit_of("dynamic_crush_m"), Some(Unit::Metre));
        assert_eq!(unit_of("time_of_dynamic_crush_s"), Some(Unit::Second));
        assert_eq!(unit_of("delta_v_m_per_s"), Some(Unit::MetrePerSecond));
        for other in ["stiffness_n_per_m", "damping_n_s_per_m", "re_per_s", "im_rad_per_s", "mass_kg", "value"] {
            assert_eq!(unit_of(other), None, "{other}");
        }
        assert_eq!(Unit::of_field("value", Some(&json!("m/s"))), Some(Unit::MetrePerSecond));
        assert_eq!(Unit::of_field("value", Some(&json!("m/s^2"))), None);
    }
}
