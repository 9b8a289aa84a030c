//! Stiffness coefficients of CRASH3 from a barrier test.

use crate::Metric;
use crate::energy::damage_profile::DamageProfile;
use crate::metric::definitions::{CRASH3_A, CRASH3_B, CRASH3_G, CRUSH_ENERGY};

/// Speed of no damage where it is not known, m/s: 5 mph.
pub const NO_DAMAGE_SPEED_M_PER_S: f64 = 2.2352;

/// Stiffness of a vehicle's front after Campbell: `F/L = A + B·C`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrushStiffness {
    /// Force a width at which crush begins, N/m.
    pub a_n_per_m: f64,
    /// Stiffness a width, N/m².
    pub b_n_per_m2: f64,
    /// Energy a width absorbed without crush, `A²/(2B)`, N.
    pub g_n: f64,
    /// Impact speed over residual crush, 1/s, of the line `V = b0 + b1·C_res`.
    pub b1_per_s: f64,
}

impl CrushStiffness {
    /// From the line `V = b0 + b1·C_res` of barrier tests: `A = m·b0·b1/L`, `B = m·b1²/L`, `G = A²/(2B)`.
    ///
    /// C is the residual crush, not the dynamic one. `None` unless mass, width and b1 are positive and b0 is not
    /// negative. Campbell (1974), CRASH3.
    pub fn from_impact_line(mass_kg: f64, width_m: f64, b0_m_per_s: f64, b1_per_s: f64) -> Option<Self> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        if !(positive(mass_kg) && positive(width_m) && positive(b1_per_s) && b0_m_per_s >= 0.0) {
            return None;
        }
        let a_n_per_m = mass_kg * b0_m_per_s * b1_per_s / width_m;
        let b_n_per_m2 = mass_kg * b1_per_s * b1_per_s / width_m;
        let g_n = mass_kg * b0_m_per_s * b0_m_per_s / (2.0 * width_m);
        let stiffness = Self { a_n_per_m, b_n_per_m2, g_n, b1_per_s };
        [a_n_per_m, b_n_per_m2, g_n].iter().all(|x| x.is_finite()).then_some(stiffness)
    }

    /// From one barrier test, `b1 = (v0 - b0)/C_res`; b0 is 2.2352 m/s (5 mph) unless it is known.
    pub fn from_barrier_test(
        mass_kg: f64,
        width_m: f64,
        impact_speed_m_per_s: f64,
        residual_crush_m: f64,
        b0_m_per_s: f64,
    ) -> Option<Self> {
        Self::from_impact_line(mass_kg, width_m, b0_m_per_s, (impact_speed_m_per_s - b0_m_per_s) / residual_crush_m)
    }

    /// A, B and G as metrics.
    pub fn metrics(&self) -> [Metric; 3] {
        [
            Metric::with_value(&CRASH3_A, self.a_n_per_m),
            Metric::with_value(&CRASH3_B, self.b_n_per_m2),
            Metric::with_value(&CRASH3_G, self.g_n),
        ]
    }

    /// From one barrier test with its damage profile, so that the test's own energy comes out exactly for an uneven
    /// profile too: `v0² = b0² + 2 b0 b1 C + b1² C²`, with the means of crush and of its square over the width.
    pub fn from_energy(
        mass_kg: f64,
        width_m: f64,
        impact_speed_m_per_s: f64,
        profile: DamageProfile<'_>,
        b0_m_per_s: f64,
    ) -> Option<Self> {
        let (mean, square) = (profile.mean_m(), profile.mean_square_m2());
        let (half, rest) = (b0_m_per_s * mean, impact_speed_m_per_s.powi(2) - b0_m_per_s.powi(2));
        // The larger root of `square b1² + 2 half b1 - rest`, without a difference of its terms.
        let b1_per_s = rest / (half + (half * half + square * rest).sqrt());
        Self::from_impact_line(mass_kg, width_m, b0_m_per_s, b1_per_s)
    }

    /// Energy of a damage profile over a width, J, times `1 + tan²α` for a principal force at α from the normal, at
    /// most 45°: `L (A C + B C²/2 + G)` with the means of crush and of its square. For six stations that is CRASH3's
    /// `(L/5)·{(A/2)(C1 + 2(C2+…+C5) + C6) + (B/6)[C1² + 2(C2²+…+C5²) + C6² + C1C2 + … + C5C6] + 5G}`.
    pub fn energy(&self, width_m: f64, crush_m: &[f64], force_angle_rad: f64) -> Metric {
        if !force_angle_rad.is_finite() || force_angle_rad.abs() > std::f64::consts::FRAC_PI_4 {
            return Metric::absent(&CRUSH_ENERGY, "the angle of the principal force is above 45 degrees");
        }
        let profile = DamageProfile::new(crush_m).filter(|_| width_m.is_finite() && width_m > 0.0);
        let Some(profile) = profile else {
            let reason = "a crush is negative or not finite, stations are fewer than two, or the width is not positive";
            return Metric::absent(&CRUSH_ENERGY, reason);
        };
        let by_crush = self.a_n_per_m * profile.mean_m() + 0.5 * self.b_n_per_m2 * profile.mean_square_m2();
        Metric::with_value(&CRUSH_ENERGY, width_m * (by_crush + self.g_n) * (1.0 + force_angle_rad.tan().powi(2)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_even_profile_absorbs_the_energy_of_its_speed() {
        // Uniform crush C: E = m·(b0 + b1·C)²/2.
        let (m, l, b0, b1) = (1500.0, 1.6, 2.2352, 24.0);
        let stiffness = CrushStiffness::from_impact_line(m, l, b0, b1).unwrap();
        let energy = stiffness.energy(l, &[0.4; 6], 0.0).value.unwrap();
        assert!((energy / (m * (b0 + b1 * 0.4_f64).powi(2) / 2.0) - 1.0).abs() < 1e-14);
        assert_eq!(
            CrushStiffness::from_barrier_test(m, l, b0 + b1 * 0.5, 0.5, b0).map(|s| s.a_n_per_m.round()),
            Some(50292.0)
        );
        let oblique = stiffness.energy(l, &[0.4; 6], std::f64::consts::FRAC_PI_4).value.unwrap();
        assert!((oblique / energy - 2.0).abs() < 1e-14);
    }

    #[test]
    fn an_uneven_profile_gives_the_energy_of_its_own_test_back() {
        let (m, l, v0, b0, crush) = (1450.0, 1.55, 13.9, 2.2352, [0.1, 0.3, 0.55, 0.6]);
        let stiffness = CrushStiffness::from_energy(m, l, v0, DamageProfile::new(&crush).unwrap(), b0).unwrap();
        let energy = stiffness.energy(l, &crush, 0.0).value.unwrap();
        assert!((energy / (0.5 * m * v0 * v0) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn impossible_damage_is_absent() {
        let stiffness = CrushStiffness { a_n_per_m: 1.0, b_n_per_m2: 1.0, g_n: 1.0, b1_per_s: 1.0 };
        assert!(stiffness.energy(1.6, &[0.4; 6], 1.0).value.is_none());
        assert!(stiffness.energy(1.6, &[-0.4; 6], 0.0).value.is_none());
        assert!(stiffness.energy(1.6, &[f64::NAN; 6], 0.0).value.is_none());
        assert_eq!(CrushStiffness::from_barrier_test(1500.0, 1.6, 10.0, 0.0, 2.0), None);
    }
}
