//! An element alone, led along a path at given rates: its law without any motion of masses.

use crate::error::{finite, positive};
use crate::series::step::{integral, product};
use crate::series::walk::Walk;
use crate::structure::connected_masses::{Connection, Element, Node, Strain, Structure};
use crate::{Drive, LumpedError, Start};

/// A part of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    /// Deflection at its end, m.
    pub to_m: f64,
    /// Rate of the deflection on it, m/s, of the sign of the way.
    pub rate_m_per_s: f64,
}

/// The end of a leg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathPoint {
    /// Force, N.
    pub force_n: f64,
    /// Work done on the element so far, J.
    pub work_j: f64,
    /// Permanent set after its last turn, m.
    pub permanent_set_m: f64,
}

/// Leads an element from zero deflection leg by leg; rates jump between them.
///
/// Errors: numbers that are not finite, a rate that does not lead to its end.
pub fn lead(element: &Element, legs: &[Leg]) -> Result<Vec<PathPoint>, LumpedError> {
    // A compression of zero may leave a gap open: deflections are counted from contact.
    let contact_m = -element.law().deflection(&Strain::default());
    let connection = Connection { front: Node::Wall, rear: Node::Mass(0), element: element.clone() };
    let structure = Structure::new(vec![1.0], vec![connection])?;
    let first = legs.first().map_or(0.0, |leg| leg.rate_m_per_s);
    finite("rate_m_per_s", first)?;
    let start = Start::Each { positions_m: vec![contact_m], velocities_m_per_s: vec![first] };
    let mut walk = Walk::new(&structure, &start, &[]);
    // An endless inertia: no force changes the speed.
    walk.step.per_mass[0] = 0.0;
    let (mut from_m, mut work_j) = (0.0, 0.0);
    let mut points = Vec::with_capacity(legs.len());
    for leg in legs {
        finite("to_m", leg.to_m)?;
        let duration_s = (leg.to_m - from_m) / leg.rate_m_per_s;
        positive("duration of a leg", duration_s)?;
        walk.step.nodes[0].v[0] = leg.rate_m_per_s;
        let end_s = walk.step.start_s + duration_s;
        walk.follow(&Drive::Impact(0.0), end_s, end_s, |step, _| {
            let (link, force) = (&step.links[0], step.force(0));
            let power = std::array::from_fn(|k| product(&force, &link.w, k));
            work_j += integral(&power, step.length_s);
            true
        })?;
        walk.step.nodes[0].x[0] = contact_m + leg.to_m;
        walk.step.expand();
        let force_n = walk.step.force_at(0, 0.0);
        points.push(PathPoint { force_n, work_j, permanent_set_m: walk.step.branches[0].set });
        from_m = leg.to_m;
    }
    Ok(points)
}
