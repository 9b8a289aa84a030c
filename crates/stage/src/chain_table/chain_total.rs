//! Whether the masses of a chain add up to the mass of the test.

/// A chain that is lighter or heavier than the test by more than this share is not the vehicle that was tested; scales
/// and rounded masses stay below.
const TOTAL_MASS_TOLERANCE: f64 = 0.01;

/// What is to be said of a chain whose masses differ from the test's by more than 1 %.
pub fn total_mass_remark(masses_kg: &[f64], test_mass_kg: f64) -> Option<String> {
    let sum: f64 = masses_kg.iter().sum();
    let difference = sum / test_mass_kg - 1.0;
    // Rounding of a sum is no difference.
    if !(difference.abs() > TOTAL_MASS_TOLERANCE + 1e-12 && difference.is_finite()) {
        return None;
    }
    Some(format!(
        "its masses add up to {sum:.1} kg, the test has {test_mass_kg:.1} kg: {:.1} % {} (noted above {:.0} %); its \
         forces and energies are those of its own masses",
        100.0 * difference.abs(),
        if difference > 0.0 { "more" } else { "less" },
        100.0 * TOTAL_MASS_TOLERANCE
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_of_more_than_a_percent_is_said_with_both_masses() {
        assert_eq!(total_mass_remark(&[250.0, 350.0, 900.0], 1500.0), None);
        assert_eq!(total_mass_remark(&[100.0, 890.0], 1000.0), None);
        assert_eq!(
            total_mass_remark(&[250.0, 350.0, 600.0], 1500.0).unwrap(),
            "its masses add up to 1200.0 kg, the test has 1500.0 kg: 20.0 % less (noted above 1 %); its forces \
             and energies are those of its own masses"
        );
        assert!(total_mass_remark(&[1530.0], 1500.0).unwrap().contains("2.0 % more"));
        assert_eq!(total_mass_remark(&[1530.0], 0.0), None);
        assert!(total_mass_remark(&[1012.0], 1000.0).is_some() && total_mass_remark(&[1009.0], 1000.0).is_none());
    }
}
