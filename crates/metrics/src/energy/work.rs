use crumple_signal::{Acceleration, Displacement, Signal};

use crate::metric::grid::same_grid;
use crate::{DynamicCrush, MetricsError};

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
