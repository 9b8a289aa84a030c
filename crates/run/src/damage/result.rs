//! What `damage` finds, as one object of JSON in SI units. Keys may be added, never renamed within v1.

use crumple_metrics::{CollisionSpeed, CrushEnergy, DamageSpeed, DamagedVehicle};
use serde::Serialize;

use super::stiffness::{FrontStiffness, NoDamageSpeedSource, StiffnessSource};

/// Its schema.
pub(super) const SCHEMA: &str = "crumple.damage.v1";

/// What was found.
#[derive(Debug, Serialize)]
pub(super) struct DamageResult {
    pub(super) schema: &'static str,
    /// Share of cases that an interval holds, if the tests scatter as normal errors do.
    pub(super) interval_level: f64,
    pub(super) vehicle: VehicleResult,
    pub(super) other: Option<VehicleResult>,
    pub(super) collision: Option<CollisionResult>,
    pub(super) warnings: Vec<String>,
    pub(super) assumed: Vec<String>,
}

/// One vehicle.
#[derive(Debug, Serialize)]
pub(super) struct VehicleResult {
    pub(super) stiffness: StiffnessResult,
    pub(super) damage: Option<VehicleDamage>,
}

/// Its stiffness.
#[derive(Debug, Serialize)]
pub(super) struct StiffnessResult {
    pub(super) source: StiffnessSource,
    pub(super) a_n_per_m: f64,
    pub(super) b_n_per_m2: f64,
    pub(super) g_n: f64,
    pub(super) b0_m_per_s: f64,
    pub(super) b0_source: NoDamageSpeedSource,
    pub(super) b1_per_s: f64,
    pub(super) mass_per_width_kg_per_m: f64,
    pub(super) b0_interval_m_per_s: Option<[f64; 2]>,
    pub(super) b1_interval_per_s: Option<[f64; 2]>,
    /// Standard deviation of the speed of one test about the line.
    pub(super) deviation_m_per_s: Option<f64>,
    pub(super) degrees_of_freedom: Option<usize>,
    pub(super) tests: Vec<TestResult>,
}

/// A barrier test.
#[derive(Debug, Serialize)]
pub(super) struct TestResult {
    pub(super) name: String,
    pub(super) mass_kg: f64,
    pub(super) width_m: f64,
    pub(super) impact_speed_m_per_s: f64,
    pub(super) mean_residual_crush_m: f64,
}

/// Where the crush of a vehicle is from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum CrushSource {
    /// Typed.
    Profile,
    /// The even crush at which it bears the force of the other vehicle.
    ForceBalance,
}

/// The damage of a vehicle and its speed.
#[derive(Debug, Clone, Serialize)]
pub(super) struct VehicleDamage {
    pub(super) mass_kg: f64,
    pub(super) width_m: f64,
    pub(super) crush_source: CrushSource,
    pub(super) residual_crush_m: Vec<f64>,
    pub(super) mean_residual_crush_m: f64,
    pub(super) force_angle_rad: f64,
    pub(super) angle_factor: f64,
    pub(super) energy_without_angle_j: f64,
    pub(super) energy_j: f64,
    pub(super) energy_interval_j: Option<[f64; 2]>,
    pub(super) equivalent_barrier_speed_m_per_s: f64,
    pub(super) equivalent_barrier_speed_interval_m_per_s: Option<[f64; 2]>,
    /// Where one more vehicle like the tests lies.
    pub(super) one_vehicle_interval_m_per_s: Option<[f64; 2]>,
    pub(super) peak_force_n: f64,
}

/// What a crush energy holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
pub(super) enum EnergyKind {
    /// The whole energy of the approach, as a line of impact speeds gives it.
    Approach,
    /// What is lost for good, 1 - e² of it.
    Lost,
}

impl From<EnergyKind> for CrushEnergy {
    fn from(kind: EnergyKind) -> Self {
        match kind {
            EnergyKind::Approach => Self::OfApproach,
            EnergyKind::Lost => Self::Lost,
        }
    }
}

/// The collision of two vehicles.
#[derive(Debug, Serialize)]
pub(super) struct CollisionResult {
    pub(super) restitution: f64,
    pub(super) energy_is: EnergyKind,
    /// `k²/(k² + h²)`; 1 for a central impact.
    pub(super) effective_mass_shares: [f64; 2],
    pub(super) energy_j: f64,
    pub(super) closing_speed_m_per_s: f64,
    pub(super) closing_speed_interval_m_per_s: Option<[f64; 2]>,
    pub(super) delta_v_m_per_s: [f64; 2],
    pub(super) delta_v_intervals_m_per_s: Option<[[f64; 2]; 2]>,
    /// Peak force of the first vehicle over that of the other.
    pub(super) force_ratio: f64,
}

/// The ends around a value; a speed or an energy does not go below zero.
fn ends(value: f64, half_width: f64) -> [f64; 2] {
    [(value - half_width).max(0.0), value + half_width]
}

impl From<&FrontStiffness> for StiffnessResult {
    fn from(front: &FrontStiffness) -> Self {
        let (line, coefficients) = (&front.line, &front.coefficients);
        let tests = front.tests.iter().map(|named| TestResult {
            name: named.name.clone(),
            mass_kg: named.test.mass_kg,
            width_m: named.test.width_m,
            impact_speed_m_per_s: named.test.impact_speed_m_per_s,
            mean_residual_crush_m: named.test.mean_crush_m,
        });
        Self {
            source: front.source,
            a_n_per_m: coefficients.a_n_per_m,
            b_n_per_m2: coefficients.b_n_per_m2,
            g_n: coefficients.g_n,
            b0_m_per_s: line.b0_m_per_s,
            b0_source: front.no_damage_speed,
            b1_per_s: line.b1_per_s,
            mass_per_width_kg_per_m: line.mass_per_width_kg_per_m,
            b0_interval_m_per_s: line.b0_interval(),
            b1_interval_per_s: line.b1_interval(),
            deviation_m_per_s: line.scatter.map(|scatter| scatter.deviation_m_per_s),
            degrees_of_freedom: line.scatter.map(|scatter| scatter.freedom),
            tests: tests.collect(),
        }
    }
}

impl VehicleDamage {
    /// With the speed that was computed from it.
    pub(super) fn new(vehicle: &DamagedVehicle<'_>, crush_source: CrushSource, speed: &DamageSpeed) -> Self {
        // A crush that the force of the other vehicle gave has more errors than those of this stiffness.
        let is_typed = crush_source == CrushSource::Profile;
        let around = |value: f64, half: Option<f64>| half.filter(|_| is_typed).map(|half| ends(value, half));
        let barrier_speed = speed.barrier_speed_m_per_s;
        Self {
            mass_kg: vehicle.mass_kg,
            width_m: vehicle.width_m,
            crush_source,
            residual_crush_m: vehicle.crush_m.to_vec(),
            mean_residual_crush_m: speed.mean_crush_m,
            force_angle_rad: vehicle.force_angle_rad,
            angle_factor: speed.angle_factor,
            energy_without_angle_j: speed.normal_energy_j,
            energy_j: speed.energy_j,
            energy_interval_j: around(speed.energy_j, speed.energy_half_width_j()),
            equivalent_barrier_speed_m_per_s: barrier_speed,
            equivalent_barrier_speed_interval_m_per_s: around(barrier_speed, speed.speed_half_width_m_per_s),
            one_vehicle_interval_m_per_s: around(barrier_speed, speed.one_vehicle_half_width_m_per_s),
            peak_force_n: speed.peak_force_n,
        }
    }
}

impl CollisionResult {
    /// Of the speeds and what they were computed with.
    pub(super) fn new(
        speed: &CollisionSpeed,
        (restitution, energy_is): (f64, EnergyKind),
        effective_mass_shares: [f64; 2],
        damages: [&VehicleDamage; 2],
    ) -> Self {
        let around = |value: f64| speed.half_width_share.map(|share| ends(value, share * value));
        let [first, second] = speed.delta_v_m_per_s.map(around);
        Self {
            restitution,
            energy_is,
            effective_mass_shares,
            energy_j: damages[0].energy_j + damages[1].energy_j,
            closing_speed_m_per_s: speed.closing_speed_m_per_s,
            closing_speed_interval_m_per_s: around(speed.closing_speed_m_per_s),
            delta_v_m_per_s: speed.delta_v_m_per_s,
            delta_v_intervals_m_per_s: first.zip(second).map(|(first, second)| [first, second]),
            force_ratio: damages[0].peak_force_n / damages[1].peak_force_n,
        }
    }
}
