//! The force on the wall, as a wave like that of any sensor.
//!
//! What the wall feels of a model is `-Σ m_i a_i` over its masses, whatever joins them. It goes through the filter of
//! the load cells before it is compared, so it is kept as the motion of one more body behind the masses, which has the
//! force in the place of its acceleration.

use crumple_lumped::{Instants, LumpedError, Motion, Place, Sensitivity, Structure};

use crate::FitQuantity;

/// The waves of this quantity that a structure has after an impact, and their derivatives by the parameters at
/// `places`: of the force on the wall the accelerations, and the wall behind the last mass.
pub(crate) fn response_of(
    quantity: FitQuantity,
    structure: &Structure,
    v0_m_per_s: f64,
    at: &Instants,
    places: &[Place],
) -> Result<Sensitivity, LumpedError> {
    let response = structure.sensitivity_of(quantity.waves(), v0_m_per_s, at, places)?;
    Ok(match quantity {
        FitQuantity::Force => with_wall_force(response, structure.masses_kg(), places),
        _ => response,
    })
}

/// The motion of this mass; `None` for `mass`, or beyond the last: of the last, the compartment or the wall behind it.
pub(crate) fn motion_of(motions: &[Motion], mass: Option<usize>) -> Option<&Motion> {
    mass.and_then(|mass| motions.get(mass)).or(motions.last())
}

/// The response with the wall behind its masses, kg: the force `-Σ m_i a_i`, N, and its derivatives.
fn with_wall_force(mut response: Sensitivity, masses_kg: &[f64], places: &[Place]) -> Sensitivity {
    let force_of = |motions: &[Motion]| -> Vec<f64> {
        let samples = motions.first().map_or(0, |motion| motion.acceleration_m_per_s2.len());
        let at = |k: usize| -masses_kg.iter().zip(motions).map(|(m, x)| m * x.acceleration_m_per_s2[k]).sum::<f64>();
        (0..samples).map(at).collect()
    };
    let wall = |force: Vec<f64>| Motion { acceleration_m_per_s2: force, ..Motion::default() };
    for (place, derivative) in places.iter().zip(&mut response.derivatives) {
        let mut force = force_of(derivative);
        // More mass at the same acceleration.
        if let Place::Mass(mass) = place
            && let Some(motion) = response.motions.get(*mass)
        {
            force.iter_mut().zip(&motion.acceleration_m_per_s2).for_each(|(force, a)| *force -= a);
        }
        derivative.push(wall(force));
    }
    let force = force_of(&response.motions);
    response.motions.push(wall(force));
    response
}
