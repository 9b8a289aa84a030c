//! Two vehicles, one mass each, front against front; a moving barrier is one of them.

use crate::motion::collision::ElementEvent;
use crate::motion::mass_motion::HORIZON_S;
use crate::response::collisions::CollisionQuestions;
use crate::structure::connected_masses::{Connection, Node, Structure};
use crate::structure::force_deflection::ForceDeflection;
use crate::{Drive, LumpedError, Start};

/// A vehicle or a moving barrier.
#[derive(Debug, Clone, PartialEq)]
pub struct Partner {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Velocity, m/s, on one axis for both.
    pub velocity_m_per_s: f64,
    /// Its front: no rate factor, a curve that never falls.
    pub front: ForceDeflection,
}

/// What becomes of a partner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PartnerOutcome {
    /// Crush of its front at common velocity, m.
    pub crush_m: f64,
    /// Work of its front up to there, J.
    pub energy_j: f64,
    /// What of that is plastic, J.
    pub plastic_j: f64,
    /// Permanent set, m.
    pub permanent_set_m: f64,
    /// Velocity after separation, m/s.
    pub velocity_end_m_per_s: f64,
    /// Size of the change of its velocity, m/s.
    pub delta_v_m_per_s: f64,
    /// Speed at which its mass has the energy of its front, m/s.
    pub energy_equivalent_speed_m_per_s: f64,
}

/// A collision of two partners.
#[derive(Debug, Clone, PartialEq)]
pub struct PartnerCollision {
    /// Common velocity, m/s.
    pub common_velocity_m_per_s: f64,
    /// Its time, s.
    pub time_of_common_velocity_s: f64,
    /// Crush of both fronts then, gaps not counted, m.
    pub mutual_crush_m: f64,
    /// Force then, the largest, N.
    pub peak_force_n: f64,
    /// Relative velocity after over that before.
    pub coefficient_of_restitution: f64,
    /// When the fronts part, s.
    pub separation_s: f64,
    /// Momentum after separation, N·s.
    pub momentum_n_s: f64,
    /// Both, in the order given.
    pub partners: [PartnerOutcome; 2],
    /// Whether both fronts stop on plateaus of the same force, so that their shares of the crush are open: they are
    /// taken in proportion.
    pub is_share_open: bool,
}

/// The collision of `first`, which is the faster, with `second` in front of it.
///
/// Errors: a mass that is not positive, no closing speed, fronts that cannot stand in series, partners that do not
/// separate within two seconds.
pub fn collide(first: &Partner, second: &Partner) -> Result<PartnerCollision, LumpedError> {
    let closing = first.velocity_m_per_s - second.velocity_m_per_s;
    crate::error::positive("closing speed", closing)?;
    let fronts = first.front.in_series(&second.front)?;
    let connection = Connection { front: Node::Mass(0), rear: Node::Mass(1), element: fronts.element.clone().into() };
    let structure = Structure::new(vec![second.mass_kg, first.mass_kg], vec![connection])?;
    let start = Start::at_velocities(vec![second.velocity_m_per_s, first.velocity_m_per_s]);
    let questions = CollisionQuestions { seen_from: Node::Mass(0), ..CollisionQuestions::default() };
    let collision = structure.collision(&Drive::Start(start), HORIZON_S, &questions)?;
    let opened = collision.events.iter().rev().find(|(_, _, event)| *event == ElementEvent::Open);
    let (Some(turn), Some((separation_s, _, _))) = (&collision.turn, opened) else {
        return Err(LumpedError::ChainDiverges { time_s: HORIZON_S });
    };
    let then = turn.moment.elements[0];
    let velocities = [1, 0].map(|mass| collision.end.masses[mass].velocity_m_per_s);
    let crush = fronts.shared(then.deflection_m);
    let outcome = |i: usize| {
        let partner = [first, second][i];
        let energy_j = partner.front.static_work_j(crush[i]);
        let stored_j = 0.5 * then.force_n * then.force_n / partner.front.unloading_n_per_m();
        PartnerOutcome {
            crush_m: crush[i],
            energy_j,
            plastic_j: energy_j - stored_j,
            permanent_set_m: crush[i] - then.force_n / partner.front.unloading_n_per_m(),
            velocity_end_m_per_s: velocities[i],
            delta_v_m_per_s: (velocities[i] - partner.velocity_m_per_s).abs(),
            energy_equivalent_speed_m_per_s: (2.0 * energy_j / partner.mass_kg).sqrt(),
        }
    };
    Ok(PartnerCollision {
        common_velocity_m_per_s: turn.moment.masses[1].velocity_m_per_s,
        time_of_common_velocity_s: turn.moment.time_s,
        mutual_crush_m: then.deflection_m,
        peak_force_n: then.force_n,
        coefficient_of_restitution: (velocities[1] - velocities[0]) / closing,
        separation_s: *separation_s,
        momentum_n_s: collision.momentum_n_s(&collision.end),
        partners: [0, 1].map(outcome),
        is_share_open: fronts.is_share_open(then.deflection_m),
    })
}
