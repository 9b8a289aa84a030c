//! Work of the pulse, average stiffness, crush energy.

use std::ops::RangeInclusive;

use crumple_signal::{Acceleration, Displacement, Signal};

use crate::metric::definitions::{CRASH3_A, CRASH3_B, CRASH3_G, CRUSH_ENERGY};
use crate::metric::value::same_grid;
use crate::{DynamicCrush, Metric, MetricsError};

/// Average stiffness k = m·v0²/C², N/m: the linear spring that stores the impact energy at the dynamic crush.
pub fn average_stiffness(mass_kg: f64, impact_speed_m_per_s: f64, dynamic_crush_m: f64) -> f64 {
    mass_kg * impact_speed_m_per_s * impact_speed_m_per_s / (dynamic_crush_m * dynamic_crush_m)
}

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

// Residual crush at stations of equal spacing over the width of the damage, straight between them.

/// Residual crush at two stations or more, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DamageProfile<'a>(&'a [f64]);

impl<'a> DamageProfile<'a> {
    /// From left to right. `None` with fewer than two stations, or with a crush that is negative or not finite.
    pub fn new(crush_m: &'a [f64]) -> Option<Self> {
        (crush_m.len() >= 2 && crush_m.iter().all(|c| c.is_finite() && *c >= 0.0)).then_some(Self(crush_m))
    }

    /// Mean over the width, m: the ends count half.
    pub fn mean_m(&self) -> f64 {
        self.0.windows(2).map(|c| 0.5 * (c[0] + c[1])).sum::<f64>() / (self.0.len() - 1) as f64
    }

    /// Mean of the square over the width, m²: `(p² + pq + q²)/3` over every span.
    pub fn mean_square_m2(&self) -> f64 {
        let spans = self.0.windows(2).map(|c| (c[0] * c[0] + c[0] * c[1] + c[1] * c[1]) / 3.0);
        spans.sum::<f64>() / (self.0.len() - 1) as f64
    }
}

// KW400 and the initial stiffness: what the force of a wall over the vehicle's displacement says of its front.

/// Where KW400 begins, m: below it the front covers are crushed.
pub const KW400_FROM_M: f64 = 0.025;

/// Where KW400 ends, m.
pub const KW400_TO_M: f64 = 0.4;

/// Where the line of the initial stiffness ends, m.
pub const INITIAL_TO_M: f64 = 0.2;

/// Stiffnesses from a wall's force over the displacement of the compartment.
///
/// The text that defines KW400 was not seen: three readings of its name are given, each gives back the stiffness of a
/// linear spring or says by how much it misses it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallStiffness {
    /// Work from 25 to 400 mm, J.
    pub work_j: f64,
    /// `2 W/(0.4² - 0.025²)`, N/m: the linear spring with that work between the same ends.
    pub kw400_n_per_m: f64,
    /// The same work over the whole square, `2 W/0.4²`, N/m.
    pub kw400_full_square_n_per_m: f64,
    /// Work from 0 to 400 mm over the whole square, N/m.
    pub kw400_from_zero_n_per_m: f64,
    /// Slope of the line through the force from 25 to 200 mm with the least squares over the displacement, N/m.
    pub initial_n_per_m: f64,
    /// Slope of such a line through the origin, N/m.
    pub initial_through_origin_n_per_m: f64,
}

/// The stiffnesses of a force, N, over a displacement, m, straight between samples; of the way in alone: up to the
/// first sample at or beyond 400 mm. `None` where the displacement does not reach 400 mm or does not begin at 25 mm or
/// less, where lists differ in length or are not finite.
///
/// The work is an integral over the displacement, not over the time, so the sampling does not weigh. Both lists are to
/// be of the same filter class.
pub fn wall_stiffness(displacement_m: &[f64], force_n: &[f64]) -> Option<WallStiffness> {
    let way_in = way_in(displacement_m, force_n)?;
    let (x, force) = (&displacement_m[way_in.clone()], &force_n[way_in]);
    let moments = |from: f64, to: f64| moments(x, force, from, to);
    let work_j = moments(KW400_FROM_M, KW400_TO_M)[0];
    let square = |x: f64| 0.5 * x * x;
    let cube = |x: f64| x * x * x / 3.0;
    // Of the line F = a + k x: normal equations over the displacement.
    let (from, to) = (KW400_FROM_M, INITIAL_TO_M);
    let [area, moment] = moments(from, to);
    let (length, first, second) = (to - from, square(to) - square(from), cube(to) - cube(from));
    Some(WallStiffness {
        work_j,
        kw400_n_per_m: work_j / (square(KW400_TO_M) - square(KW400_FROM_M)),
        kw400_full_square_n_per_m: work_j / square(KW400_TO_M),
        kw400_from_zero_n_per_m: moments(0.0, KW400_TO_M)[0] / square(KW400_TO_M),
        initial_n_per_m: (moment - first * area / length) / (second - first * first / length),
        initial_through_origin_n_per_m: moment / second,
    })
}

/// The samples of the way in: from the last one at or before contact to the first one at or beyond 400 mm.
fn way_in(displacement_m: &[f64], force_n: &[f64]) -> Option<RangeInclusive<usize>> {
    let all_finite = displacement_m.iter().chain(force_n).all(|x| x.is_finite());
    if displacement_m.len() != force_n.len() || !all_finite {
        return None;
    }
    let end = displacement_m.iter().position(|x| *x >= KW400_TO_M)?;
    let start = displacement_m[..end].iter().rposition(|x| *x <= 0.0).unwrap_or(0);
    (displacement_m[start] <= KW400_FROM_M).then_some(start..=end)
}

/// Average height of force, m: the height at which the force of a wall acts, over the displacement from 25 to 400 mm,
/// each part weighted with its force, `∫M dx / ∫F dx`. `M`, N·m, is the sum of the forces of the cells, each times its
/// height above ground; `F` their sum, N. `None` as [`wall_stiffness`], and where the force does no work.
pub fn average_height_of_force(displacement_m: &[f64], force_n: &[f64], moment_n_m: &[f64]) -> Option<f64> {
    let (of_force, of_moment) = (way_in(displacement_m, force_n)?, way_in(displacement_m, moment_n_m)?);
    let x = &displacement_m[of_force.clone()];
    let work = |values: &[f64]| moments(x, values, KW400_FROM_M, KW400_TO_M)[0];
    let work_j = work(&force_n[of_force]);
    (work_j > 0.0).then(|| work(&moment_n_m[of_moment]) / work_j)
}

/// `∫F dx` and `∫x F dx` between two displacements, of straight lines between samples; before the first sample the
/// force of the first. Pieces that go back count with their sign.
fn moments(x: &[f64], force: &[f64], from: f64, to: f64) -> [f64; 2] {
    let mut sums = [0.0; 2];
    let mut add = |(x0, f0): (f64, f64), (x1, f1): (f64, f64)| {
        let (a, b) = (x0.clamp(from, to), x1.clamp(from, to));
        if a == b {
            return;
        }
        let slope = (f1 - f0) / (x1 - x0);
        let force = |x: f64| f0 + slope * (x - x0);
        let (fa, fb) = (force(a), force(b));
        sums[0] += 0.5 * (b - a) * (fa + fb);
        sums[1] += (b - a) / 6.0 * (a * (2.0 * fa + fb) + b * (fa + 2.0 * fb));
    };
    add((from.min(x[0]), force[0]), (x[0], force[0]));
    for (x, force) in x.windows(2).zip(force.windows(2)) {
        add((x[0], force[0]), (x[1], force[1]));
    }
    sums
}

// Kinetic and absorbed energy, and the work of the pulse.

/// Kinetic energy m·v²/2, J.
pub fn kinetic_energy(mass_kg: f64, speed_m_per_s: f64) -> f64 {
    mass_kg * speed_m_per_s * speed_m_per_s / 2.0
}

/// Energy that does not come back, m·(v0² - v_s²)/2, J.
pub fn absorbed_energy(mass_kg: f64, impact_speed_m_per_s: f64, rebound_velocity_m_per_s: f64) -> f64 {
    kinetic_energy(mass_kg, impact_speed_m_per_s) - kinetic_energy(mass_kg, rebound_velocity_m_per_s)
}

/// Energy-equivalent speed sqrt(2·E/m), m/s: the speed whose kinetic energy is the absorbed (or crush) energy.
pub fn energy_equivalent_speed(mass_kg: f64, energy_j: f64) -> f64 {
    (2.0 * energy_j / mass_kg).sqrt()
}

/// Work of the barrier force on one kilogram during loading, `-∫ a dx` from the first sample to the dynamic crush,
/// J/kg.
///
/// By the trapezoid in x. For a motion made by the trapezoid it is v0²/2 to the last digits, since then
/// `Δx·ā = v̄·Δv`; forward Euler shows its error here, and a displacement from elsewhere (film, a second sensor) shows
/// whether it belongs to this acceleration. It cannot show a wrong impact speed or zero level: those close as well.
pub fn loading_work_per_kg(
    acceleration: &Signal<Acceleration>,
    displacement: &Signal<Displacement>,
    crush: &DynamicCrush,
) -> Result<f64, MetricsError> {
    same_grid(("the acceleration", acceleration), ("the displacement", displacement))?;
    let (a, x) = (acceleration.samples(), displacement.samples());
    // An event of another motion may lie past the end.
    let last = crush.index.min(a.len() - 1).saturating_sub(1);
    let mut work = 0.0;
    for k in 1..=last {
        work -= (x[k] - x[k - 1]) * (a[k - 1] + a[k]) / 2.0;
    }
    // The last part, from the sample before the zero of velocity to the zero, is shorter than an interval and there
    // x hardly moves: a of its two ends stands for both.
    let a_end = a[(last + 1).min(a.len() - 1)];
    Ok(work - (crush.displacement_m - x[last]) * (a[last] + a_end) / 2.0)
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

    #[test]
    fn means_of_a_wedge() {
        // From 0 to 1: means 1/2 and 1/3.
        let wedge = DamageProfile::new(&[0.0, 0.25, 0.5, 0.75, 1.0]).unwrap();
        assert_eq!(wedge.mean_m(), 0.5);
        assert!((wedge.mean_square_m2() - 1.0 / 3.0).abs() < 1e-15);
        assert!(DamageProfile::new(&[0.3]).is_none() && DamageProfile::new(&[0.3, -0.1]).is_none());
    }

    #[test]
    fn a_linear_spring_has_its_own_stiffness() {
        let x: Vec<f64> = (0..=45).map(|i| 0.01 * f64::from(i)).collect();
        let force: Vec<f64> = x.iter().map(|x| 1.1e6 * x).collect();
        let of = wall_stiffness(&x, &force).unwrap();
        for k in [of.kw400_n_per_m, of.kw400_from_zero_n_per_m, of.initial_n_per_m, of.initial_through_origin_n_per_m] {
            assert!((k / 1.1e6 - 1.0).abs() < 1e-12, "{k}");
        }
        // (0.4² - 0.025²)/0.4².
        assert!((of.kw400_full_square_n_per_m / 1.1e6 - 255.0 / 256.0).abs() < 1e-12);
    }

    #[test]
    fn the_height_of_force_is_that_of_the_rows_weighted_with_their_work() {
        // A lower row of constant force at 0.3 m and an upper one that grows with the way at 0.6 m: work 1e5*0.375 and
        // 1e6*(0.4^2 - 0.025^2)/2 J.
        let x: Vec<f64> = (0..=45).map(|i| 0.01 * f64::from(i)).collect();
        let force: Vec<f64> = x.iter().map(|x| 1e5 + 1e6 * x).collect();
        let moment: Vec<f64> = x.iter().map(|x| 0.3 * 1e5 + 0.6 * 1e6 * x).collect();
        let (lower, upper) = (1e5 * 0.375, 1e6 * (0.4 * 0.4 - 0.025 * 0.025) / 2.0);
        let right = (0.3 * lower + 0.6 * upper) / (lower + upper);
        assert!((average_height_of_force(&x, &force, &moment).unwrap() - right).abs() < 1e-12);
        assert_eq!(average_height_of_force(&x[..30], &force[..30], &moment[..30]), None);
        assert_eq!(average_height_of_force(&x, &vec![0.0; x.len()], &moment), None);
    }

    #[test]
    fn a_front_that_does_not_reach_400_mm_has_none() {
        assert_eq!(wall_stiffness(&[0.0, 0.2, 0.39], &[0.0, 1e5, 2e5]), None);
        assert_eq!(wall_stiffness(&[0.1, 0.5], &[0.0, 1e5]), None);
        assert_eq!(wall_stiffness(&[0.0, 0.5], &[0.0]), None);
        assert_eq!(wall_stiffness(&[0.0, 0.5], &[0.0, f64::NAN]), None);
    }

    #[test]
    fn a_constant_force_does_force_times_crush() {
        // a = -2, v0 = 2: v = 2 - 2t, x = 2t - t².
        let x: Vec<f64> = (0..9).map(|k| k as f64 * 0.25).map(|t| 2.0 * t - t * t).collect();
        let crush = DynamicCrush { time_s: 1.0, displacement_m: 1.0, index: 4 };
        let work = loading_work_per_kg(
            &Signal::new(0.0, 0.25, vec![-2.0; 9]).unwrap(),
            &Signal::new(0.0, 0.25, x).unwrap(),
            &crush,
        );
        assert_eq!(work, Ok(2.0));
        assert_eq!(absorbed_energy(10.0, 2.0, -1.0), 15.0);
    }
}
