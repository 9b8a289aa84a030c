//! Speed from damage: the line of barrier tests, the speed of a damaged vehicle, the closing speed of two.

use crumple_numerics::estimation::statistics::student_95;

use crate::energy::{CrushStiffness, DamageProfile, energy_equivalent_speed};

// The line V = b0 + b1·C of barrier tests.

/// A frontal test against a rigid barrier, after which the crush was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BarrierTest {
    /// Mass of the vehicle, kg.
    pub mass_kg: f64,
    /// Width of the damage, m.
    pub width_m: f64,
    /// Impact speed, m/s.
    pub impact_speed_m_per_s: f64,
    /// Mean of the residual crush over the width, m.
    pub mean_crush_m: f64,
}

/// Impact speed over residual crush, `V = b0 + b1·C`, with the mass a width that makes a stiffness of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImpactLine {
    /// Speed without damage, m/s.
    pub b0_m_per_s: f64,
    /// Slope, 1/s.
    pub b1_per_s: f64,
    /// Mass over the width of the damage, kg/m: the mean of the tests.
    pub mass_per_width_kg_per_m: f64,
    /// How far the tests scatter about the line; `None`: they show none.
    pub scatter: Option<LineScatter>,
}

/// Scatter of barrier tests about their line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineScatter {
    /// Standard deviation of the speed of one test about the line, m/s.
    pub deviation_m_per_s: f64,
    /// Tests less fitted coefficients.
    pub freedom: usize,
    /// Variance of b0, m²/s²; 0 where b0 is held.
    b0_variance: f64,
    /// Covariance of b0 and b1, m/s².
    covariance: f64,
    /// Variance of b1, 1/s².
    b1_variance: f64,
}

impl LineScatter {
    /// Half width of a 95 % interval by Student's distribution, of a variance.
    fn half_width(&self, variance: f64) -> f64 {
        student_95(self.freedom as f64) * variance.max(0.0).sqrt()
    }

    /// Variance of a number by its derivatives to b0 and b1.
    fn variance(&self, by_b0: f64, by_b1: f64) -> f64 {
        let mixed = 2.0 * by_b0 * by_b1 * self.covariance;
        by_b0 * by_b0 * self.b0_variance + mixed + by_b1 * by_b1 * self.b1_variance
    }
}

/// Why tests give no line.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ImpactLineError {
    /// A mass, width, speed or crush is not positive.
    #[error("test {number}: mass, width, impact speed and residual crush must be positive")]
    NotPositive {
        /// From 1 on.
        number: usize,
    },
    /// Fewer tests than coefficients.
    #[error("{tests} test(s) for {coefficients} coefficients")]
    TooFew {
        /// Tests.
        tests: usize,
        /// Coefficients to fit.
        coefficients: usize,
    },
    /// The tests have the same crush, so no slope.
    #[error("all tests have the same residual crush")]
    SameCrush,
    /// The speed does not rise with the crush.
    #[error("the impact speed does not rise with the residual crush: b1 = {b1_per_s:.2} 1/s")]
    NotRising {
        /// The slope.
        b1_per_s: f64,
    },
    /// The line has no crush at a speed below zero.
    #[error("the line of the tests meets zero crush at {b0_m_per_s:.2} m/s, below zero")]
    NegativeSpeed {
        /// The intercept.
        b0_m_per_s: f64,
    },
}

/// Crushes that differ by less than this share of their mean are the same: a tape reads 10 mm of 1 m.
const SAME_CRUSH_SHARE: f64 = 0.01;

impl ImpactLine {
    /// Least squares of the impact speed over the mean residual crush. With `held_b0_m_per_s` the line goes through
    /// that speed at zero crush, and one test is enough.
    ///
    /// The scatter is that of independent normal errors of one variance (any text on linear regression, e.g. Draper &
    /// Smith, *Applied Regression Analysis*, chapter 1); as many tests as coefficients have none.
    pub fn fit(tests: &[BarrierTest], held_b0_m_per_s: Option<f64>) -> Result<Self, ImpactLineError> {
        let is_positive = |test: &BarrierTest| {
            let values = [test.mass_kg, test.width_m, test.impact_speed_m_per_s, test.mean_crush_m];
            values.iter().all(|x| x.is_finite() && *x > 0.0)
        };
        if let Some(index) = tests.iter().position(|test| !is_positive(test)) {
            return Err(ImpactLineError::NotPositive { number: index + 1 });
        }
        let coefficients = if held_b0_m_per_s.is_some() { 1 } else { 2 };
        let freedom = tests.len().checked_sub(coefficients);
        let freedom = freedom.ok_or(ImpactLineError::TooFew { tests: tests.len(), coefficients })?;
        let n = tests.len() as f64;
        let mean = |value: fn(&BarrierTest) -> f64| tests.iter().map(value).sum::<f64>() / n;
        let (crush, speed) = (mean(|test| test.mean_crush_m), mean(|test| test.impact_speed_m_per_s));
        // About the means, or about the point that is held.
        let (c0, v0) = held_b0_m_per_s.map_or((crush, speed), |b0| (0.0, b0));
        let (mut squares, mut products) = (0.0, 0.0);
        for test in tests {
            let c = test.mean_crush_m - c0;
            squares += c * c;
            products += c * (test.impact_speed_m_per_s - v0);
        }
        if squares <= n * (SAME_CRUSH_SHARE * crush).powi(2) {
            return Err(ImpactLineError::SameCrush);
        }
        let b1_per_s = products / squares;
        let b0_m_per_s = held_b0_m_per_s.unwrap_or(speed - b1_per_s * crush);
        if b1_per_s <= 0.0 {
            return Err(ImpactLineError::NotRising { b1_per_s });
        }
        if b0_m_per_s < 0.0 {
            return Err(ImpactLineError::NegativeSpeed { b0_m_per_s });
        }
        let residual = |test: &BarrierTest| test.impact_speed_m_per_s - b0_m_per_s - b1_per_s * test.mean_crush_m;
        let variance = tests.iter().map(|test| residual(test).powi(2)).sum::<f64>() / freedom as f64;
        let b1_variance = variance / squares;
        let is_held = held_b0_m_per_s.is_some();
        let scatter = LineScatter {
            deviation_m_per_s: variance.sqrt(),
            freedom,
            b0_variance: if is_held { 0.0 } else { variance / n + crush * crush * b1_variance },
            covariance: if is_held { 0.0 } else { -crush * b1_variance },
            b1_variance,
        };
        let mass_per_width_kg_per_m = mean(|test| test.mass_kg / test.width_m);
        Ok(Self { b0_m_per_s, b1_per_s, mass_per_width_kg_per_m, scatter: (freedom > 0).then_some(scatter) })
    }

    /// From A and B: the line that they stand for at a mass a width. `None` unless B and the mass a width are positive
    /// and A is not negative.
    pub fn from_coefficients(a_n_per_m: f64, b_n_per_m2: f64, mass_per_width_kg_per_m: f64) -> Option<Self> {
        let b1_per_s = (b_n_per_m2 / mass_per_width_kg_per_m).sqrt();
        let b0_m_per_s = a_n_per_m / (mass_per_width_kg_per_m * b1_per_s);
        let line = Self { b0_m_per_s, b1_per_s, mass_per_width_kg_per_m, scatter: None };
        line.stiffness().map(|_| line)
    }

    /// A, B and G. `None` unless mass a width and slope are positive and b0 is not negative.
    pub fn stiffness(&self) -> Option<CrushStiffness> {
        CrushStiffness::from_impact_line(self.mass_per_width_kg_per_m, 1.0, self.b0_m_per_s, self.b1_per_s)
    }

    /// 95 % interval of b0, m/s. `None` where the tests show no scatter or b0 is held.
    pub fn b0_interval(&self) -> Option<[f64; 2]> {
        let scatter = self.scatter.filter(|scatter| scatter.b0_variance > 0.0)?;
        Some(around(self.b0_m_per_s, scatter.half_width(scatter.b0_variance)))
    }

    /// 95 % interval of b1, 1/s.
    pub fn b1_interval(&self) -> Option<[f64; 2]> {
        self.scatter.map(|scatter| around(self.b1_per_s, scatter.half_width(scatter.b1_variance)))
    }
}

fn around(value: f64, half_width: f64) -> [f64; 2] {
    [value - half_width, value + half_width]
}

// The speed of one vehicle.

/// A vehicle with its damage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DamagedVehicle<'a> {
    /// Mass as in the crash, kg.
    pub mass_kg: f64,
    /// Width of the damage, m.
    pub width_m: f64,
    /// Residual crush at stations of equal spacing over the width, m.
    pub crush_m: &'a [f64],
    /// Angle of the principal force from the normal of the damaged side, rad.
    pub force_angle_rad: f64,
}

/// What the damage of one vehicle says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DamageSpeed {
    /// Mean of the crush over the width, m.
    pub mean_crush_m: f64,
    /// Energy with the force normal to the side, J.
    pub normal_energy_j: f64,
    /// `1 + tan²α`.
    pub angle_factor: f64,
    /// Energy, J.
    pub energy_j: f64,
    /// Equivalent barrier speed `sqrt(2E/m)`, m/s.
    pub barrier_speed_m_per_s: f64,
    /// Half width of its 95 % interval by b0 and b1, m/s.
    pub speed_half_width_m_per_s: Option<f64>,
    /// The same with the scatter of one test about the line: where one more vehicle of this kind lies, m/s.
    pub one_vehicle_half_width_m_per_s: Option<f64>,
    /// Force at the largest crush along its direction, `L (A + B C)/cos α`, N.
    pub peak_force_n: f64,
}

impl DamageSpeed {
    /// Half width of the 95 % interval of the energy, J: `m v` times that of the speed.
    pub fn energy_half_width_j(&self) -> Option<f64> {
        let mass_times_speed = 2.0 * self.energy_j / self.barrier_speed_m_per_s;
        self.speed_half_width_m_per_s.map(|half_width| mass_times_speed * half_width)
    }
}

/// Crush energy, equivalent barrier speed and force of a damaged vehicle (Campbell 1974; CRASH3).
///
/// The speed is `sqrt(k (b0² + 2 b0 b1 C + b1² C²))` with the means of crush and of its square over the width, and `k`
/// the mass a width of the tests times width and angle factor over the mass. For an even profile and a vehicle like
/// the tests it is `b0 + b1·C`, so that the interval is exact; else the derivatives carry it. `Err` says why there is
/// none.
pub fn damage_speed(line: &ImpactLine, vehicle: &DamagedVehicle<'_>) -> Result<DamageSpeed, String> {
    let positive = |x: f64| x.is_finite() && x > 0.0;
    if !positive(vehicle.mass_kg) {
        return Err("the mass must be positive".to_owned());
    }
    let stiffness = line.stiffness().ok_or("b0 must not be negative, b1 must be positive")?;
    let energy = |angle: f64| {
        let energy = stiffness.energy(vehicle.width_m, vehicle.crush_m, angle);
        energy.value.ok_or(energy.definition)
    };
    let energy_j = energy(vehicle.force_angle_rad)?;
    let normal_energy_j = energy(0.0)?;
    if !energy_j.is_finite() {
        return Err("the crush energy is beyond all numbers".to_owned());
    }
    let profile = DamageProfile::new(vehicle.crush_m).ok_or("stations are fewer than two")?;
    let (crush, square) = (profile.mean_m(), profile.mean_square_m2());
    let angle_factor = 1.0 + vehicle.force_angle_rad.tan().powi(2);
    let scale = line.mass_per_width_kg_per_m * vehicle.width_m * angle_factor / vehicle.mass_kg;
    let speed = energy_equivalent_speed(vehicle.mass_kg, energy_j);
    let (b0, b1) = (line.b0_m_per_s, line.b1_per_s);
    let (by_b0, by_b1) = (scale * (b0 + b1 * crush) / speed, scale * (b0 * crush + b1 * square) / speed);
    let half_width = |of_one: bool| {
        let scatter = line.scatter?;
        let own = if of_one { scale * scatter.deviation_m_per_s.powi(2) } else { 0.0 };
        Some(scatter.half_width(scatter.variance(by_b0, by_b1) + own)).filter(|width| width.is_finite())
    };
    let force = vehicle.width_m * (stiffness.a_n_per_m + stiffness.b_n_per_m2 * crush);
    Ok(DamageSpeed {
        mean_crush_m: crush,
        normal_energy_j,
        angle_factor,
        energy_j,
        barrier_speed_m_per_s: speed,
        speed_half_width_m_per_s: half_width(false),
        one_vehicle_half_width_m_per_s: half_width(true),
        peak_force_n: force / vehicle.force_angle_rad.cos(),
    })
}

/// The even crush at which a front bears a force, m: `(F/L - A)/B`. `None` where the force does not crush it.
pub fn crush_by_force(stiffness: &CrushStiffness, width_m: f64, force_n: f64) -> Option<f64> {
    let crush_m = (force_n / width_m - stiffness.a_n_per_m) / stiffness.b_n_per_m2;
    Some(crush_m).filter(|crush| crush.is_finite() && *crush >= 0.0)
}

// The speed of two vehicles.

/// What a crush energy holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CrushEnergy {
    /// The kinetic energy of the approach, which is stored and lost at the largest crush. A line of *impact* speeds
    /// over crush gives this one.
    OfApproach,
    /// What is lost for good, `1 - e²` of it.
    Lost,
}

/// One of two vehicles that collide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CollidedVehicle {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Crush energy, J.
    pub energy_j: f64,
    /// Half width of its interval, J.
    pub energy_half_width_j: Option<f64>,
    /// `k²/(k² + h²)` of the yaw radius k and the lever arm h of the force; 1 for a central impact.
    pub effective_mass_share: f64,
}

/// The speeds of a collision by the damage of both vehicles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CollisionSpeed {
    /// Closing speed along the force where the vehicles touch, m/s.
    pub closing_speed_m_per_s: f64,
    /// Changes of velocity of both centres of mass, m/s.
    pub delta_v_m_per_s: [f64; 2],
    /// Half widths of 95 % intervals over the values: the same share for all three speeds.
    pub half_width_share: Option<f64>,
}

/// `k²/(k² + h²)`: the share of a mass that a force with the lever arm h meets where it acts, at a yaw radius k.
pub fn effective_mass_share(yaw_radius_m: f64, lever_m: f64) -> f64 {
    yaw_radius_m * yaw_radius_m / (yaw_radius_m * yaw_radius_m + lever_m * lever_m)
}

/// Closing speed and delta-v from the crush energies of both vehicles.
///
/// With the effective masses `μ = γ m` the energy of the approach is `v² μ1 μ2/(2 (μ1 + μ2))`, and the impulse is
/// `(1 + e) v μ1 μ2/(μ1 + μ2)`. With e = 0 that is CRASH3's `ΔV1 = sqrt(2 γ1 E/(m1 (1 + γ1 m1/(γ2 m2))))`. Energies
/// that are lost for good are `1 - e²` of those of the approach. The errors of both energies are taken as independent.
/// `None` unless masses and the sum of the energies are positive and `0 <= e < 1`.
pub fn collision_speed(
    vehicles: [CollidedVehicle; 2],
    restitution: f64,
    energy: CrushEnergy,
) -> Option<CollisionSpeed> {
    let sum = vehicles[0].energy_j + vehicles[1].energy_j;
    let effective = vehicles.map(|vehicle| vehicle.effective_mass_share * vehicle.mass_kg);
    let positive = |x: f64| x.is_finite() && x > 0.0;
    let masses = vehicles.map(|vehicle| vehicle.mass_kg);
    let is_possible = masses.iter().chain(&effective).all(|mass| positive(*mass)) && positive(sum);
    if !is_possible || !(0.0..1.0).contains(&restitution) {
        return None;
    }
    let reduced = effective[0] * effective[1] / (effective[0] + effective[1]);
    let share = match energy {
        CrushEnergy::OfApproach => 1.0,
        CrushEnergy::Lost => 1.0 - restitution * restitution,
    };
    let closing_speed_m_per_s = (2.0 * sum / (reduced * share)).sqrt();
    let impulse = (1.0 + restitution) * closing_speed_m_per_s * reduced;
    let half_width = vehicles[0].energy_half_width_j.zip(vehicles[1].energy_half_width_j);
    Some(CollisionSpeed {
        closing_speed_m_per_s,
        delta_v_m_per_s: masses.map(|mass| impulse / mass),
        // A speed goes with the root of the energy.
        half_width_share: half_width.map(|(first, second)| first.hypot(second) / (2.0 * sum)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_numerics::estimation::random::RandomNumbers;

    fn tests_on(line: &[(f64, f64)]) -> Vec<BarrierTest> {
        let test = |&(mean_crush_m, impact_speed_m_per_s): &(f64, f64)| BarrierTest {
            mass_kg: 1500.0,
            width_m: 1.5,
            impact_speed_m_per_s,
            mean_crush_m,
        };
        line.iter().map(test).collect()
    }

    fn line(b0_m_per_s: f64, b1_per_s: f64, mass_per_width_kg_per_m: f64) -> ImpactLine {
        ImpactLine { b0_m_per_s, b1_per_s, mass_per_width_kg_per_m, scatter: None }
    }

    fn close(value: f64, exact: f64, share: f64) {
        assert!((value / exact - 1.0).abs() < share, "{value} is not {exact}");
    }

    /// By hand: crush 1, 2, 3, speed 3, 4, 6: slope 3/2, intercept 4/3, residuals 1/6, -1/3, 1/6.
    #[test]
    fn three_tests_by_hand() {
        let fit = ImpactLine::fit(&tests_on(&[(1.0, 3.0), (2.0, 4.0), (3.0, 6.0)]), None).unwrap();
        close(fit.b1_per_s, 1.5, 1e-14);
        close(fit.b0_m_per_s, 4.0 / 3.0, 1e-14);
        let scatter = fit.scatter.unwrap();
        close(scatter.deviation_m_per_s, (1.0_f64 / 6.0).sqrt(), 1e-13);
        // 12.7062 of one degree of freedom: tables of Student's distribution.
        let half = 12.706_204_736 * (1.0_f64 / 12.0).sqrt();
        close(fit.b1_interval().unwrap()[1], 1.5 + half, 1e-9);
        let half = 12.706_204_736 * (1.0_f64 / 18.0 + 4.0 / 12.0).sqrt();
        close(fit.b0_interval().unwrap()[1], 4.0 / 3.0 + half, 1e-9);
        close(fit.mass_per_width_kg_per_m, 1000.0, 1e-15);
    }

    #[test]
    fn two_tests_have_a_line_without_interval() {
        let fit = ImpactLine::fit(&tests_on(&[(0.3, 9.2), (0.5, 14.2)]), None).unwrap();
        close(fit.b1_per_s, 25.0, 1e-12);
        close(fit.b0_m_per_s, 1.7, 1e-12);
        assert_eq!((fit.scatter, fit.b0_interval(), fit.b1_interval()), (None, None, None));
        // With b0 held there is one degree of freedom; b0 has no interval.
        let held = ImpactLine::fit(&tests_on(&[(0.3, 9.2), (0.5, 14.2)]), Some(2.0)).unwrap();
        close(held.b1_per_s, (0.3 * 7.2 + 0.5 * 12.2) / 0.34, 1e-14);
        assert!(held.b0_interval().is_none() && held.b1_interval().is_some());
        // One test, as from_barrier_test has it.
        let one = ImpactLine::fit(&tests_on(&[(0.5, 14.2)]), Some(2.2)).unwrap();
        let same = CrushStiffness::from_barrier_test(1500.0, 1.5, 14.2, 0.5, 2.2).unwrap();
        close(one.stiffness().unwrap().b_n_per_m2, same.b_n_per_m2, 1e-14);
    }

    #[test]
    fn tests_without_a_line_say_why() {
        let error = |points: &[(f64, f64)]| ImpactLine::fit(&tests_on(points), None).unwrap_err();
        assert_eq!(error(&[(0.4, 12.0)]), ImpactLineError::TooFew { tests: 1, coefficients: 2 });
        assert_eq!(error(&[(0.4, 12.0), (0.402, 13.0)]), ImpactLineError::SameCrush);
        assert!(matches!(error(&[(0.4, 12.0), (0.5, 11.0)]), ImpactLineError::NotRising { .. }));
        assert!(matches!(error(&[(0.4, 5.0), (0.5, 10.0)]), ImpactLineError::NegativeSpeed { .. }));
        assert_eq!(error(&[(0.4, 12.0), (-0.1, 13.0)]), ImpactLineError::NotPositive { number: 2 });
        assert_eq!(error(&[(f64::NAN, 12.0), (0.1, 13.0)]), ImpactLineError::NotPositive { number: 1 });
    }

    /// Closed form: `m (b0 + b1 C)²/2`, and the speed of the line.
    #[test]
    fn an_even_profile_has_the_speed_of_the_line() {
        let line = line(2.2352, 24.0, 1500.0 / 1.6);
        for stations in 2..=12 {
            let crush = vec![0.4; stations];
            let vehicle = DamagedVehicle { mass_kg: 1500.0, width_m: 1.6, crush_m: &crush, force_angle_rad: 0.0 };
            let speed = damage_speed(&line, &vehicle).unwrap();
            close(speed.barrier_speed_m_per_s, 2.2352 + 24.0 * 0.4, 1e-14);
            close(speed.energy_j, 750.0 * (2.2352_f64 + 9.6).powi(2), 1e-14);
            let oblique = damage_speed(&line, &DamagedVehicle { force_angle_rad: 0.5, ..vehicle }).unwrap();
            close(oblique.energy_j, speed.energy_j / 0.5_f64.cos().powi(2), 1e-13);
            close(oblique.normal_energy_j, speed.energy_j, 1e-15);
        }
    }

    /// Published formula of six stations, `crash3-p` of the reference metrics, a second way there.
    #[test]
    fn six_stations_as_crash3_writes_them() {
        let crush = [0.3, 0.35, 0.4, 0.42, 0.38, 0.3];
        let vehicle = DamagedVehicle { mass_kg: 1500.0, width_m: 1.6, crush_m: &crush, force_angle_rad: 0.0 };
        let line = line(2.2352, 24.0, 1500.0 / 1.6);
        let stiffness = line.stiffness().unwrap();
        close(stiffness.a_n_per_m, 50292.0, 1e-12);
        close(stiffness.b_n_per_m2, 540_000.0, 1e-12);
        close(stiffness.g_n, 2341.9308, 1e-12);
        let speed = damage_speed(&line, &vehicle).unwrap();
        close(speed.energy_j, 93_228.113_28, 1e-10);
        close(speed.barrier_speed_m_per_s, 11.149_177_146_3, 1e-10);
    }

    /// Quoted constant of `A = k W b0 b1/L` in lb, in, mph: 0.8023 (pycrash prints 0.802).
    #[test]
    fn the_constant_of_a_and_b_in_pounds_and_inches() {
        let (pound, inch, mph) = (0.453_592_37, 0.0254, 0.44704);
        let stiffness = line(5.0 * mph, 1.2 * mph / inch, 3500.0 * pound / (60.0 * inch)).stiffness().unwrap();
        let pound_force = pound * 9.80665;
        close(stiffness.a_n_per_m / (pound_force / inch) / (3500.0 * 5.0 * 1.2 / 60.0), 0.8023, 1e-4);
        let b = stiffness.b_n_per_m2 / (pound_force / inch / inch);
        close(b / (3500.0 * 1.2 * 1.2 / 60.0), 0.8023, 1e-4);
    }

    #[test]
    fn impossible_vehicles_have_no_speed() {
        let vehicle = DamagedVehicle { mass_kg: 1500.0, width_m: 1.6, crush_m: &[0.4; 2], force_angle_rad: 0.0 };
        let line = line(2.0, 25.0, 950.0);
        for wrong in [
            DamagedVehicle { mass_kg: 0.0, ..vehicle },
            DamagedVehicle { width_m: -1.6, ..vehicle },
            DamagedVehicle { crush_m: &[0.4], ..vehicle },
            DamagedVehicle { crush_m: &[1e200; 2], ..vehicle },
            DamagedVehicle { force_angle_rad: 0.8, ..vehicle },
        ] {
            assert!(damage_speed(&line, &wrong).is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn coefficients_and_line_are_one_another() {
        let line = line(2.0, 25.0, 950.0);
        let stiffness = line.stiffness().unwrap();
        let back = ImpactLine::from_coefficients(stiffness.a_n_per_m, stiffness.b_n_per_m2, 950.0).unwrap();
        close(back.b0_m_per_s, 2.0, 1e-14);
        close(back.b1_per_s, 25.0, 1e-14);
        assert!(ImpactLine::from_coefficients(1.0, 0.0, 950.0).is_none());
        assert!(ImpactLine::from_coefficients(-1.0, 1.0, 950.0).is_none());
    }

    /// Published inputs, `crash3-pair` of the atlas (a guide book's A and B; its result computed independently).
    #[test]
    fn the_crush_of_the_second_car_by_force_balance() {
        let lines = [(84_008.342_75, 359_906.330_7), (62_310.127_9, 234_421.748)]
            .map(|(a, b)| ImpactLine::from_coefficients(a, b, 900.0).unwrap());
        let vehicle = |crush_m| DamagedVehicle { mass_kg: 1400.0, width_m: 1.0, crush_m, force_angle_rad: 0.0 };
        let first = damage_speed(&lines[0], &vehicle(&[0.3556, 0.3556])).unwrap();
        close(first.peak_force_n, 211_991.034, 1e-7);
        let crush = crush_by_force(&lines[1].stiffness().unwrap(), 1.0, first.peak_force_n).unwrap();
        close(crush, 0.638_511, 1e-5);
        let second = damage_speed(&lines[1], &vehicle(&[crush, crush])).unwrap();
        close(first.energy_j, 62_433.19, 1e-6);
        close(second.energy_j, 95_853.3, 1e-5);
        close(second.peak_force_n, first.peak_force_n, 1e-13);
        assert_eq!(crush_by_force(&lines[0].stiffness().unwrap(), 1.0, 80e3), None);
    }

    fn collided(mass_kg: f64, energy_j: f64) -> CollidedVehicle {
        CollidedVehicle { mass_kg, energy_j, energy_half_width_j: None, effective_mass_share: 1.0 }
    }

    /// `pair-sdof-low` of the atlas: two cars of 3500 lb on a linear spring of 265.93 kN/m, closing at 2.2352 m/s.
    #[test]
    fn two_equal_cars_on_a_linear_spring() {
        let (mass, closing, e, k, crush) = (1587.5733, 2.2352, 0.382_628, 265_930.099, 0.122_119);
        let half = 0.25 * k * crush * crush;
        let speed = collision_speed([collided(mass, half); 2], e, CrushEnergy::OfApproach).unwrap();
        close(speed.closing_speed_m_per_s, closing, 1e-5);
        close(speed.delta_v_m_per_s[0], 1.545_225, 1e-5);
        let lost = half * (1.0 - e * e);
        let same = collision_speed([collided(mass, lost); 2], e, CrushEnergy::Lost).unwrap();
        close(same.closing_speed_m_per_s, speed.closing_speed_m_per_s, 1e-14);
    }

    /// By hand: a car against one of nearly infinite mass is a barrier test, which gives its own speed back.
    #[test]
    fn against_a_wall_the_closing_speed_is_that_of_the_barrier() {
        let energy = 0.5 * 1400.0 * 15.0 * 15.0;
        for e in [0.0, 0.1, 0.3] {
            let speed = collision_speed([collided(1400.0, energy), collided(1e15, 0.0)], e, CrushEnergy::OfApproach);
            let speed = speed.unwrap();
            close(speed.closing_speed_m_per_s, 15.0, 1e-11);
            close(speed.delta_v_m_per_s[0], 15.0 * (1.0 + e), 1e-11);
        }
    }

    /// CRASH3's form with lever arms, e = 0; momentum and energy with restitution.
    #[test]
    fn lever_arms_as_crash3_has_them() {
        let gamma = [effective_mass_share(1.4, 0.6), effective_mass_share(1.5, 0.3)];
        let masses = [1200.0, 1800.0];
        let vehicles = [0, 1].map(|i| CollidedVehicle { effective_mass_share: gamma[i], ..collided(masses[i], 6e4) });
        let speed = collision_speed(vehicles, 0.0, CrushEnergy::OfApproach).unwrap();
        let other = gamma[0] * masses[0] / (gamma[1] * masses[1]);
        let crash3 = (2.0 * gamma[0] * 1.2e5 / (masses[0] * (1.0 + other))).sqrt();
        close(speed.delta_v_m_per_s[0], crash3, 1e-14);
        close(speed.delta_v_m_per_s[0] * masses[0], speed.delta_v_m_per_s[1] * masses[1], 1e-14);
        assert!(collision_speed(vehicles, 1.0, CrushEnergy::OfApproach).is_none());
        assert!(collision_speed([collided(0.0, 1.0); 2], 0.1, CrushEnergy::OfApproach).is_none());
    }

    /// Made lines with normal errors of the speed: of 4000 each interval holds 95 %, within four deviations of a
    /// binomial number (13.8 each, so 3745 to 3855).
    #[test]
    fn intervals_hold_the_truth_as_often_as_they_say() {
        let (b0, b1, deviation, repetitions) = (2.1, 25.0, 0.2, 4000);
        let mut random = RandomNumbers::seeded(20_261_130);
        let mut held = [0; 4];
        for _ in 0..repetitions {
            let points: Vec<(f64, f64)> = [0.25, 0.32, 0.4, 0.47, 0.55]
                .iter()
                .map(|crush| (*crush, b0 + b1 * crush + deviation * random.normal()))
                .collect();
            let Ok(fit) = ImpactLine::fit(&tests_on(&points), None) else { panic!("no line of {points:?}") };
            let vehicle = DamagedVehicle { mass_kg: 1500.0, width_m: 1.5, crush_m: &[0.45; 6], force_angle_rad: 0.0 };
            let speed = damage_speed(&fit, &vehicle).unwrap();
            let (true_speed, estimate) = (b0 + b1 * 0.45, speed.barrier_speed_m_per_s);
            let next = true_speed + deviation * random.normal();
            let is_within = |value: f64, [low, high]: [f64; 2]| low <= value && value <= high;
            let holds = [
                is_within(b0, fit.b0_interval().unwrap()),
                is_within(b1, fit.b1_interval().unwrap()),
                is_within(true_speed, around(estimate, speed.speed_half_width_m_per_s.unwrap())),
                is_within(next, around(estimate, speed.one_vehicle_half_width_m_per_s.unwrap())),
            ];
            for (count, holds) in held.iter_mut().zip(holds) {
                *count += i32::from(holds);
            }
        }
        assert!(held.iter().all(|count| (3745..=3855).contains(count)), "{held:?}");
    }

    #[test]
    fn the_interval_of_a_pair_is_that_of_both_energies() {
        let with = |energy_half_width_j| CollidedVehicle { energy_half_width_j, ..collided(1400.0, 5e4) };
        let both = collision_speed([with(Some(3e3)), with(Some(4e3))], 0.1, CrushEnergy::OfApproach).unwrap();
        // 5 kJ of 100 kJ: half of it for a speed.
        close(both.half_width_share.unwrap(), 0.025, 1e-14);
        let one = collision_speed([with(Some(3e3)), with(None)], 0.1, CrushEnergy::OfApproach).unwrap();
        assert_eq!(one.half_width_share, None);
    }
}
