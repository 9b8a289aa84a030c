//! Which poles of an identified model are modes of the record, and which are not.

use std::f64::consts::PI;

use crumple_lti::Complex;

/// A pole within this of zero, times the length of the record, is an integrator: over the record a motion as slow is a
/// constant or a straight line.
const INTEGRATOR: f64 = 0.1;

/// The same of two poles or more that lead from an acceleration to a displacement, where a double integrator is true:
/// noise parts a double pole by the root of what it does to a single one.
const INTEGRATOR_OF_MOTION: f64 = 0.5;

/// What a pole of an identified model is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PoleKind {
    /// A motion of its own, oscillating or not.
    Mode,
    /// At or near zero: a constant or a straight line over the record, as an integrator makes.
    Integrator,
    /// As fast as the sampling or faster, a modulus of `pi/dt` or more: between two samples nobody sees it.
    BeyondNyquist,
}

/// The record that a model was identified from, as far as its poles are concerned.
#[derive(Debug, Clone, Copy)]
pub struct PoleRecord {
    /// Sampling interval, s.
    pub dt_s: f64,
    /// Length, s.
    pub duration_s: f64,
    /// Whether the model leads from an acceleration to a displacement.
    pub of_motion: bool,
}

/// What each continuous pole (1/s, rad/s) of one model is, in their order.
pub fn pole_kinds(poles: &[Complex], record: PoleRecord) -> Vec<PoleKind> {
    let PoleRecord { dt_s, duration_s, of_motion } = record;
    let within = |limit: f64| move |s: &&Complex| s.norm() * duration_s < limit;
    let is_double = of_motion && poles.iter().filter(within(INTEGRATOR_OF_MOTION)).count() > 1;
    let near_zero = within(if is_double { INTEGRATOR_OF_MOTION } else { INTEGRATOR });
    let kind = |s: &Complex| match s {
        // Rounding of pi/dt is no reason to be within the sampling.
        s if s.norm() * dt_s >= PI * (1.0 - 1e-9) => PoleKind::BeyondNyquist,
        s if near_zero(&s) => PoleKind::Integrator,
        _ => PoleKind::Mode,
    };
    poles.iter().map(kind).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(poles: &[(f64, f64)], of_motion: bool) -> Vec<PoleKind> {
        let poles: Vec<Complex> = poles.iter().map(|(re, im)| Complex::new(*re, *im)).collect();
        pole_kinds(&poles, PoleRecord { dt_s: 0.01, duration_s: 2.0, of_motion })
    }

    #[test]
    fn poles_near_zero_are_integrators_of_motion_further_away() {
        use PoleKind::{Integrator, Mode};
        let pair = [(0.0, 0.04), (0.0, -0.04), (-1.0, 9.0), (-1.0, -9.0)];
        assert_eq!(kinds(&pair, false), [Integrator, Integrator, Mode, Mode]);
        let parted = [(0.2, 0.0), (-0.2, 0.0)];
        assert_eq!(kinds(&parted, false), [Mode, Mode]);
        assert_eq!(kinds(&parted, true), [Integrator, Integrator]);
        // One alone is none.
        assert_eq!(kinds(&[(-0.2, 0.0), (-1.0, 0.0)], true), [Mode, Mode]);
        assert_eq!(kinds(&[(0.0, 0.0), (-1.0, 0.0)], false), [Integrator, Mode]);
    }

    #[test]
    fn a_pole_at_or_beyond_the_nyquist_frequency_is_no_mode() {
        let nyquist = PI / 0.01;
        let fast = [(-1.0, nyquist), (-nyquist, 0.0), (-0.8 * nyquist, 0.8 * nyquist)];
        assert_eq!(kinds(&fast, false), [PoleKind::BeyondNyquist; 3]);
        assert_eq!(kinds(&[(-1.0, 0.99 * nyquist)], false), [PoleKind::Mode]);
    }
}
