//! The end of the contact force, where a free decay begins.

/// Index of the first sample after the last one at which `force` reaches `share` of its largest magnitude: from there
/// on the force is smaller for good. `None` for a force that is zero throughout, or still that large at the last
/// sample.
///
/// `force` may be a barrier force or the deceleration of a vehicle, which is that force over its mass. A share of the
/// peak is a rule, not a measurement: too small and noise or a late ripple of the filter decides, too large and the
/// force still drives the motion that is taken for free. From 2 to 10 % is usual.
pub fn end_of_contact(force: &[f64], share: f64) -> Option<usize> {
    let peak = force.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
    let last = force.iter().rposition(|f| f.abs() > 0.0 && f.abs() >= share * peak)?;
    (last + 1 < force.len()).then_some(last + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn begins_after_the_last_large_sample() {
        let force = [0.0, 5.0, -10.0, 0.2, 1.0, 0.3, -0.2, 0.0];
        assert_eq!(end_of_contact(&force, 0.1), Some(5));
        assert_eq!(end_of_contact(&force, 0.5), Some(3));
        assert_eq!(end_of_contact(&force, 0.0), Some(7));
        assert_eq!(end_of_contact(&[0.0; 4], 0.1), None);
        assert_eq!(end_of_contact(&[0.0, 1.0, 2.0], 0.1), None);
    }
}
