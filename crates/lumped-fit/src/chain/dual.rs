//! The dual of a fitted chain of two masses: the same masses and the same motion of the last one, other springs and
//! dampers.
//!
//! With `mu = (m1 + m2)/m2` the dual has `k1' = mu k2`, `k2' = k1/mu` and dampers alike: it exchanges front and rear.
//! A sensor on the last mass alone cannot tell the two apart, see [`DoubleSpringMassDamper::dual`].

use crumple_lumped::{Chain, DoubleSpringMassDamper, PiecewiseLinear};

use crate::Observation;
use crate::chain::coordinates::ChainCoordinates;

/// Where the dual of a solution is.
#[derive(Debug, Clone, PartialEq)]
pub enum ChainDual {
    /// It is another solution, by its place from 1.
    Solution(usize),
    /// It is no such chain as was stated: a number that was given, or a bound, decides.
    NotAsStated(Chain),
}

/// Two chains whose coordinates are nearer than this are one.
const SAME: f64 = 1e-6;

/// The dual chain; `None` for any but two masses with constant coefficients.
pub(crate) fn dual(chain: &Chain) -> Option<Chain> {
    let ([m1_kg, m2_kg], [k1, k2], [c1, c2]) = (chain.masses_kg(), chain.springs(), chain.dampers()) else {
        return None;
    };
    let double = DoubleSpringMassDamper {
        m1_kg: *m1_kg,
        m2_kg: *m2_kg,
        k1_n_per_m: k1.as_constant()?,
        k2_n_per_m: k2.as_constant()?,
        c1_n_s_per_m: c1.as_constant()?,
        c2_n_s_per_m: c2.as_constant()?,
    }
    .dual();
    let laws = |values: [f64; 2]| values.map(PiecewiseLinear::constant);
    let (springs, dampers) =
        (laws([double.k1_n_per_m, double.k2_n_per_m]), laws([double.c1_n_s_per_m, double.c2_n_s_per_m]));
    Chain::new(&[double.m1_kg, double.m2_kg], &springs, &dampers).ok()
}

/// The values of the springs, then of the dampers, from the barrier on; `None` where a law has knots.
fn constants(chain: &Chain) -> Option<Vec<f64>> {
    chain.springs().iter().chain(chain.dampers()).map(PiecewiseLinear::as_constant).collect()
}

/// Whether all waves are of the last mass. Only then does a chain of two have an equivalent dual.
pub(crate) fn sees_the_last_only(waves: &Observation, masses: usize) -> bool {
    waves.waves.iter().all(|wave| wave.mass.is_none_or(|mass| mass + 1 == masses))
}

/// The dual of a minimum, where it has one.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum DualOf {
    /// At these coordinates of the stated chain.
    At(Vec<f64>),
    /// Outside of what was stated.
    Outside(Chain),
}

/// The dual of the chain at `theta`; `None` where it has none, or is its own.
pub(crate) fn dual_of(coordinates: &ChainCoordinates, chain: &Chain, theta: &[f64]) -> Option<DualOf> {
    let dual = dual(chain)?;
    // By value, not by name: a law with knots of one value is a constant under another name.
    let (own, other) = (constants(chain)?, constants(&dual)?);
    if own.iter().zip(&other).all(|(value, other)| (value - other).abs() <= SAME * value.abs()) {
        return None;
    }
    Some(match coordinates.point(&dual) {
        Some(point) if point.len() == theta.len() => DualOf::At(point),
        _ => DualOf::Outside(dual),
    })
}
