//! Points of distributions that intervals and tests need, from the crate `statrs`.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};

/// Degrees of freedom above which Student's distribution is taken as the normal one: they differ by 2e-6 there.
const NORMAL_FROM: f64 = 1e6;

/// The factor of a 95 % interval by Student's distribution; fewer than one degree of freedom count as one.
pub fn student_95(freedom: f64) -> f64 {
    let normal = || Normal::standard().inverse_cdf(0.975);
    if freedom >= NORMAL_FROM {
        return normal();
    }
    // A number of degrees that is none cannot be taken either.
    StudentsT::new(0.0, 1.0, freedom.max(1.0)).map_or_else(|_| normal(), |t| t.inverse_cdf(0.975))
}

/// 95 % point of chi-square with `n` degrees of freedom, positive; not a number otherwise.
pub fn chi_square_95(n: f64) -> f64 {
    ChiSquared::new(n).map_or(f64::NAN, |chi_square| chi_square.inverse_cdf(0.95))
}

/// The normal distribution function.
pub fn normal_distribution(z: f64) -> f64 {
    Normal::standard().cdf(z)
}

/// The shortest interval that holds 95 % of a normal distribution and a value, as its two ends: below and above the
/// mean, in units of 1.96 deviations. `value`: how far it is above the mean, in the same unit.
pub fn shortest_with(value: f64) -> (f64, f64) {
    let normal = student_95(f64::INFINITY);
    if value.abs() <= 1.0 {
        return (1.0, 1.0);
    }
    let other = Normal::standard().inverse_cdf(0.95 + normal_distribution(-normal * value.abs())) / normal;
    if value < 0.0 { (-value, other) } else { (other, value) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_those_of_the_tables() {
        // To the last printed digit: Abramowitz & Stegun, tables 26.10, 26.8, 26.1.
        for (freedom, wanted) in [(1.0, 12.706), (2.0, 4.303), (6.0, 2.447), (20.0, 2.086), (60.0, 2.000), (1e9, 1.960)]
        {
            assert!((student_95(freedom) - wanted).abs() < 5e-4, "{freedom}: {}", student_95(freedom));
        }
        assert_eq!(student_95(0.3), student_95(1.0));
        assert!((student_95(f64::INFINITY) - 1.959_964).abs() < 5e-7);
        for (n, wanted) in [(1.0, 3.841_46), (2.0, 5.991_46), (10.0, 18.307_0), (50.0, 67.504_8)] {
            assert!((chi_square_95(n) - wanted).abs() < 1e-4, "{n}: {}", chi_square_95(n));
        }
        assert!((normal_distribution(1.0) - 0.841_344_746).abs() < 1e-9 && normal_distribution(0.0) == 0.5);
    }

    #[test]
    fn an_interval_with_a_value_far_from_the_mean_still_holds_95_percent() {
        let normal = student_95(f64::INFINITY);
        // As it is where the value is inside, one-sided where that is far.
        assert_eq!(shortest_with(0.7), (1.0, 1.0));
        let (below, above) = shortest_with(-3.0);
        assert!(below == 3.0 && (above - 1.644_854 / normal).abs() < 1e-6, "{above}");
        let (below, above) = shortest_with(1.2);
        let held = normal_distribution(normal * above) - normal_distribution(-normal * below);
        assert!(above == 1.2 && (held - 0.95).abs() < 1e-9, "{below} {above}");
    }
}
