//! What crushed structures of one mass and of two take for granted where the record does not tell.

/// Rate factor of a vehicle's structure, s/m, where no test tells: mild steel columns of 60 to 100 mm between 40 and
/// 64 km/h have 0.006 to 0.012 by the law of Cowper and Symonds.
pub const RATE_PRIOR_S_PER_M: f64 = 0.008;
/// The same of one mass in place of a vehicle, over the speed of its compartment: less 0.004 s/m for the masses in
/// front of it. They are stopped before it, which takes energy that one mass does not have, and more of it at a higher
/// speed: cars of two masses on plastic structures without rate effect, a front mass of 15 to 35 %, look like one mass
/// whose force falls by 0.2 to 0.6 % for each m/s.
pub const ONE_MASS_RATE_S_PER_M: f64 = 0.004;
/// Restitution of a full frontal test near 56 km/h, where the record does not show the rebound: 0.1 to 0.2.
pub(crate) const USUAL_RESTITUTION: f64 = 0.15;
/// Time between two knots, s: half a period of what CFC 60 passes of a wave, with as much again for noise.
pub(crate) const KNOT_SPACING_S: f64 = 0.009;
