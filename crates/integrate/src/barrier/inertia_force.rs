//! The force on the barrier as mass times deceleration.

use crumple_signal::{Acceleration, Force, Signal};

use crate::IntegrateError;

/// Barrier force `F = -m·a`, N, positive in compression.
///
/// The force on the whole mass as if it moved with the sensor. Load cells in the barrier read more or less than this
/// by the inertia of the crushed front; the two are compared, not merged.
///
/// One force for each sample, on the same grid; a share of error in mass or gain is the same share of the force. Peaks
/// depend on the frequency class of the acceleration.
///
/// # Errors
/// A mass that is not a positive number; a product that leaves the range of numbers.
pub fn barrier_force(acceleration: &Signal<Acceleration>, mass_kg: f64) -> Result<Signal<Force>, IntegrateError> {
    if !(mass_kg.is_finite() && mass_kg > 0.0) {
        return Err(IntegrateError::Mass(mass_kg));
    }
    // `+ 0.0` turns the -0.0 of a sample at rest into 0.
    let force = acceleration.samples().iter().map(|a| -mass_kg * a + 0.0).collect();
    Ok(Signal::new(acceleration.t0_s(), acceleration.dt_s(), force)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_deceleration_compresses() {
        let a = Signal::new(0.0, 0.5, vec![0.0, -2.0, 1.0]).unwrap();
        assert_eq!(barrier_force(&a, 900.0).unwrap().samples(), [0.0, 1800.0, -900.0]);
        assert!(barrier_force(&a, 0.0).is_err());
    }
}
