//! Bounds of springs and dampers of chains in a search: one set of bounds for the fits of two, three and any number of
//! masses.
//!
//! `M` is the mass of the vehicle, kg, and `T` the length of the window, s. A spring is counted in units of
//! `M (π/2T)²`, N/m: an undamped mass `M` on a spring of one unit stops after `T`. A damper is counted in units of
//! `M/T`, N·s/m.

use std::f64::consts::FRAC_PI_2;

/// Smallest and largest spring, in its unit.
pub(crate) const SPRING_BOUNDS: (f64, f64) = (1e-4, 1e4);
/// Between these a search starts: structures that stop a car within the window.
pub(crate) const SPRING_STARTS: (f64, f64) = (0.2, 30.0);
/// Smallest and largest damper, in its unit.
pub(crate) const DAMPER_BOUNDS: (f64, f64) = (1e-5, 1e3);
/// Between these a search starts.
pub(crate) const DAMPER_STARTS: (f64, f64) = (0.01, 3.0);

/// Largest spring, N/m, and damper, N s/m, that a search gives a chain of this mass over a window of this length.
pub fn largest_of_chain(mass_kg: f64, length_s: f64) -> (f64, f64) {
    let rate = FRAC_PI_2 / length_s;
    (SPRING_BOUNDS.1 * mass_kg * rate * rate, DAMPER_BOUNDS.1 * mass_kg / length_s)
}
