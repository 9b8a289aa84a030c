//! What the verdict says of one model for several tests.

use crate::drawing::numbers::KM_PER_H_PER_M_PER_S;
use crate::drawing::span;
use crate::words;

use crate::findings::results::joint::JointTests;

/// Which tests, and how far each is off what the others say of it.
pub fn several_tests(joint: &JointTests) -> String {
    let names: Vec<&str> = joint.tests.iter().map(|test| test.test.name.as_str()).collect();
    let speeds: Vec<f64> =
        joint.tests.iter().map(|test| KM_PER_H_PER_M_PER_S * test.test.impact_speed_m_per_s).collect();
    let (low, high) = span(&speeds).unwrap_or_default();
    let speeds = words::between(&words::cell(low, 1, "km/h"), &words::quantity(high, 1, "km/h"));
    let fitted = format!("One model was fitted to {} tests at {speeds}: {}.", names.len(), names.join(", "));
    let against: Vec<_> = joint.tests.iter().filter_map(|test| test.against()).collect();
    let errors = against.iter().filter_map(|against| against.dynamic_crush_error_percent);
    let Some(largest) = errors.max_by(|a, b| a.abs().total_cmp(&b.abs())) else { return fitted };
    let held = against.iter().filter(|against| against.held.iter().any(|name| name == "dynamic_crush_m")).count();
    let (worst, predicted) = (words::quantity(largest.abs(), 1, "%"), against.len());
    format!(
        "{fitted} Each predicted from the others, the crush is off by {worst} at most; {held} of {predicted} lie in \
         the 90 % interval."
    )
}

/// `ka (−23.3 %) and kb (+30.1 %)`: the tests that the others miss; nothing without any.
pub fn missed(joint: &JointTests) -> Option<String> {
    let named = |(name, error): (&str, f64)| format!("{name} ({})", words::deviation(error, 1, "%"));
    let names: Vec<String> = joint.missed().into_iter().map(named).collect();
    (!names.is_empty()).then(|| names.join(" and "))
}
