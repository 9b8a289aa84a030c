//! An impact in its setting: against the wall or a partner, with an occupant or without.

use crumple_lumped::{
    FrontToFront, HORIZON_S, Instants, Meeting, MeetingState, Motion, Occupant, OccupantMotion, Structure,
};

use crate::error::PredictError;
use crate::impact::outcome::{
    AFTER_REBOUND_S, Energy, Outcome, Quantity, WITHOUT_REBOUND_S, Wave, at_wall, let_go, occupant_load, peak,
};
use crate::impact::restraint::ride;

/// What a vehicle meets, and who sits in it.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct PreparedSetup<'a> {
    /// `None`: the wall.
    pub opponent: Option<&'a Opponent>,
    pub occupant: Option<&'a Occupant>,
}

impl<'a> PreparedSetup<'a> {
    /// The same with another opponent.
    pub fn against(self, opponent: Option<&'a Opponent>) -> Self {
        Self { opponent, ..self }
    }

    /// The impact of a structure at a speed, sampled at `dt_s`. Errors: a response that leaves the range of numbers, no
    /// closing speed.
    pub fn impact(&self, structure: &Structure, speed: f64, dt_s: f64) -> Result<(Outcome, Wave), PredictError> {
        let (outcome, wave) = match self.opponent {
            None => at_wall(structure, speed, dt_s)?,
            Some(opponent) => collide(structure, speed, opponent, dt_s)?,
        };
        Ok((self.with_occupant(outcome, &wave, speed)?, wave))
    }

    /// An outcome with the numbers of the occupant in a compartment of this motion. Errors: a motion that cannot be
    /// followed.
    pub fn with_occupant(&self, mut outcome: Outcome, wave: &Wave, speed: f64) -> Result<Outcome, PredictError> {
        if let Some(motion) = self.ride(wave, speed)? {
            outcome.0[Quantity::OccupantPeak as usize] = Some(motion.peak_deceleration.value);
            outcome.0[Quantity::OccupantExcursion as usize] = Some(motion.largest_excursion.value);
            outcome.0[Quantity::RideDown as usize] = motion.stop.map(|stop| stop.ridedown_share);
        }
        Ok(outcome)
    }

    /// The occupant in the compartment of this motion; `None` without one, or where the compartment gains speed.
    pub fn ride(&self, wave: &Wave, speed: f64) -> Result<Option<OccupantMotion>, PredictError> {
        let Some((occupant, compartment)) = self.occupant.zip(wave.compartment()) else { return Ok(None) };
        let Some(common) = wave.common_velocity_m_per_s() else { return Ok(None) };
        ride(occupant, compartment, wave.dt_s, speed - common)
    }
}

/// What a vehicle runs into, or what runs into it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Opponent {
    /// Its masses and what is in front of them; no element on the wall: rigid.
    pub structure: Structure,
    /// Its speed towards the vehicle, m/s.
    pub speed_m_per_s: f64,
}

/// What a collision makes of one of the two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyOutcome {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Velocity before, m/s; both on one axis, positive in the direction of the vehicle.
    pub velocity_before_m_per_s: f64,
    /// Velocity of the compartment after the fronts have parted, m/s.
    pub velocity_after_m_per_s: Option<f64>,
    /// Energy its structure has taken until common velocity, stored or not, J.
    pub absorbed_j: Option<f64>,
    /// Speed at which its mass has that energy, m/s.
    pub energy_equivalent_speed_m_per_s: Option<f64>,
}

/// What a collision makes of both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CollisionOutcome {
    /// Closing speed, m/s.
    pub closing_speed_m_per_s: f64,
    /// Common velocity of the compartments, m/s.
    pub common_velocity_m_per_s: Option<f64>,
    /// The vehicle.
    pub own: BodyOutcome,
    /// The other.
    pub partner: BodyOutcome,
    /// Momentum of all masses before and after, N·s.
    pub momentum_n_s: [f64; 2],
    /// Mass that lies between the fronts, kg, where they are no element in series.
    pub contact_mass_kg: Option<f64>,
    /// Whether both fronts crush at the same force, so that their shares are open.
    pub is_share_open: bool,
    /// Where the energy goes until common velocity.
    pub energy: Option<Energy>,
}

/// Displacement of the two compartments and where the fronts meet, m.
struct Places {
    own: f64,
    contact: f64,
    partner: f64,
}

fn places(joined: &FrontToFront, at: &MeetingState) -> Places {
    let displacement = |mass: usize| at.masses[mass].displacement_m;
    let largest_m = at.largest_m.last().copied().unwrap_or(0.0);
    Places {
        own: displacement(joined.own().end - 1),
        contact: joined.contact_m(displacement, largest_m),
        partner: displacement(joined.partner().end - 1),
    }
}

/// The collision of a structure with an opponent, sampled at `dt_s`: as at the wall, but seen from the other
/// compartment. Crush, its time and the parting are those of the exact motion: the first zero of the relative velocity
/// of the compartments, and of their relative acceleration after it. Errors: no closing speed, a response that leaves
/// the range of numbers.
pub(crate) fn collide(
    own: &Structure,
    speed: f64,
    opponent: &Opponent,
    dt_s: f64,
) -> Result<(Outcome, Wave), PredictError> {
    let joined = FrontToFront::new(own, speed, &opponent.structure, opponent.speed_m_per_s)?;
    let closing = speed + opponent.speed_m_per_s;
    let Meeting { common, parting } = joined.meeting(HORIZON_S)?;
    let end_s = parting.as_ref().map_or(WITHOUT_REBOUND_S, |parting| parting.time_s + AFTER_REBOUND_S);
    let samples = (end_s / dt_s).ceil() as usize + 1;
    let mut motions = joined.structure().motions_at(joined.start(), &Instants { first_s: 0.0, dt_s, samples })?;
    if let Some(parting) = &parting {
        motions.iter_mut().for_each(|motion| let_go(motion, parting.time_s, dt_s));
    }
    let contact_m = contact_path(&joined, &motions, samples);
    let partner = motions[joined.partner()].to_vec();
    let wave = Wave { dt_s, motions: motions.split_off(joined.own().start), partner, contact_m };
    let places = common.as_ref().map(|common| places(&joined, common));
    let after = |mass: usize| parting.as_ref().map(|parting| parting.masses[mass].velocity_m_per_s);
    let (own_after, partner_after) = (after(joined.own().end - 1), after(joined.partner().end - 1));
    let [own_reading, partner_reading] =
        [(wave.compartment(), speed, 1.0), (wave.partner.last(), -opponent.speed_m_per_s, -1.0)]
            .map(|(motion, start, sign)| motion.map(|motion| as_at_the_wall(motion, start, sign, closing, dt_s)));
    let mut outcome = Outcome::default();
    let mut set = |quantity: Quantity, value: Option<f64>| outcome.0[quantity as usize] = value;
    set(Quantity::DynamicCrush, places.as_ref().map(|places| places.own - places.contact));
    set(Quantity::TimeOfDynamicCrush, common.as_ref().map(|common| common.time_s));
    set(Quantity::DeltaV, own_after.map(|after| (after - speed).abs()));
    set(Quantity::Restitution, own_after.zip(partner_after).map(|(own, partner)| (partner - own) / closing));
    set(Quantity::Peak, own_reading.as_ref().and_then(|motion| peak(motion, dt_s)));
    set(Quantity::Olc, own_reading.as_ref().and_then(|motion| occupant_load(motion, closing, dt_s)));
    set(Quantity::MutualCrush, places.as_ref().map(|places| places.own - places.partner));
    set(Quantity::PartnerCrush, places.as_ref().map(|places| places.contact - places.partner));
    set(Quantity::PartnerDeltaV, partner_after.map(|after| (after + opponent.speed_m_per_s).abs()));
    set(Quantity::PartnerPeak, partner_reading.as_ref().and_then(|motion| peak(motion, dt_s)));
    set(Quantity::PartnerOlc, partner_reading.as_ref().and_then(|motion| occupant_load(motion, closing, dt_s)));
    Ok((outcome, wave))
}

/// Where the fronts meet at every sample.
fn contact_path(joined: &FrontToFront, motions: &[Motion], samples: usize) -> Vec<f64> {
    let mut largest_m = 0.0_f64;
    let last = joined.structure().connections().last();
    let ends = last.map(|connection| (connection.front, connection.rear));
    let place = |node, k: usize| match node {
        crumple_lumped::Node::Mass(mass) => motions[mass].displacement_m[k],
        crumple_lumped::Node::Wall => 0.0,
    };
    (0..samples)
        .map(|k| {
            largest_m = ends.map_or(0.0, |(front, rear)| largest_m.max(place(rear, k) - place(front, k)));
            joined.contact_m(|mass| motions[mass].displacement_m[k], largest_m)
        })
        .collect()
}

/// A motion as that of a vehicle that meets a wall at the closing speed: turned into its own direction, seen from a
/// frame in which it comes with all of it. What a sensor feels, and how far an occupant goes, does not depend on the
/// frame.
fn as_at_the_wall(motion: &Motion, start: f64, sign: f64, closing: f64, dt_s: f64) -> Motion {
    let more = closing - sign * start;
    let turned = |samples: &[f64]| samples.iter().map(|x| sign * x).collect::<Vec<f64>>();
    let mut seen = Motion {
        displacement_m: turned(&motion.displacement_m),
        velocity_m_per_s: turned(&motion.velocity_m_per_s),
        acceleration_m_per_s2: turned(&motion.acceleration_m_per_s2),
    };
    seen.velocity_m_per_s.iter_mut().for_each(|v| *v += more);
    seen.displacement_m.iter_mut().enumerate().for_each(|(k, x)| *x += more * k as f64 * dt_s);
    seen
}

/// What the collision makes of both. Errors: as [`collide`].
pub(crate) fn collision(own: &Structure, speed: f64, opponent: &Opponent) -> Result<CollisionOutcome, PredictError> {
    let joined = FrontToFront::new(own, speed, &opponent.structure, opponent.speed_m_per_s)?;
    let Meeting { common, parting } = joined.meeting(HORIZON_S)?;
    let absorbed = common.as_ref().map(|common| joined.absorbed_j(common)).transpose()?;
    let masses = joined.structure().masses_kg();
    let momentum = |velocity: &dyn Fn(usize) -> f64| (0..masses.len()).map(|i| masses[i] * velocity(i)).sum::<f64>();
    let kinetic =
        |velocity: &dyn Fn(usize) -> f64| (0..masses.len()).map(|i| 0.5 * masses[i] * velocity(i).powi(2)).sum::<f64>();
    let before = |mass: usize| joined.velocities_m_per_s()[mass];
    let at = |state: &MeetingState, mass: usize| state.masses[mass].velocity_m_per_s;
    let body = |structure: &Structure, velocity_before_m_per_s: f64, last: usize, side: usize| {
        let mass_kg: f64 = structure.masses_kg().iter().sum();
        // A rigid body has taken nothing but rounding.
        let absorbed_j = absorbed.map(|both| both[side].max(0.0));
        BodyOutcome {
            mass_kg,
            velocity_before_m_per_s,
            velocity_after_m_per_s: parting.as_ref().map(|state| at(state, last)),
            absorbed_j,
            energy_equivalent_speed_m_per_s: absorbed_j.map(|energy| (2.0 * energy / mass_kg).sqrt()),
        }
    };
    let (own_last, partner_last) = (joined.own().end - 1, joined.partner().end - 1);
    let end = parting.as_ref().or(common.as_ref());
    Ok(CollisionOutcome {
        closing_speed_m_per_s: speed + opponent.speed_m_per_s,
        common_velocity_m_per_s: common.as_ref().map(|common| at(common, own_last)),
        own: body(own, speed, own_last, 0),
        partner: body(&opponent.structure, -opponent.speed_m_per_s, partner_last, 1),
        momentum_n_s: [momentum(&before), end.map_or_else(|| momentum(&before), |end| momentum(&|i| at(end, i)))],
        contact_mass_kg: joined.contact_mass_kg(),
        is_share_open: common
            .as_ref()
            .is_some_and(|common| joined.is_share_open(common.largest_m.last().copied().unwrap_or(0.0))),
        energy: common
            .as_ref()
            .map(|common| Energy { at_impact_j: kinetic(&before), at_rest_j: kinetic(&|i| at(common, i)) }),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::impact::outcome::at_wall;
    use crumple_lumped::{Elastoplastic, Model};

    #[test]
    fn equals_meet_as_at_the_wall_at_half_the_closing_speed_however_it_is_split() {
        let model = Elastoplastic {
            mass_kg: 1000.0,
            loading_stiffness_n_per_m: 4e5,
            unloading_stiffness_n_per_m: 1.6e7,
            release: true,
        };
        let structure = Model::Elastoplastic(model).structure().unwrap();
        let (wall, _) = at_wall(&structure, 15.0, 1e-4).unwrap();
        for (speed, partner_speed) in [(15.0, 15.0), (30.0, 0.0), (0.0, 30.0), (25.0, 5.0)] {
            let opponent = Opponent { structure: structure.clone(), speed_m_per_s: partner_speed };
            let (outcome, _) = collide(&structure, speed, &opponent, 1e-4).unwrap();
            let pairs = [
                (Quantity::DynamicCrush, Quantity::DynamicCrush),
                (Quantity::PartnerCrush, Quantity::DynamicCrush),
                (Quantity::TimeOfDynamicCrush, Quantity::TimeOfDynamicCrush),
                (Quantity::DeltaV, Quantity::DeltaV),
                (Quantity::PartnerDeltaV, Quantity::DeltaV),
                (Quantity::Restitution, Quantity::Restitution),
                (Quantity::Peak, Quantity::Peak),
                (Quantity::PartnerPeak, Quantity::Peak),
            ];
            for (quantity, at_wall) in pairs {
                let (value, expected) = (outcome.get(quantity).unwrap(), wall.get(at_wall).unwrap());
                // The motions are exact; what is left is rounding, and that of the samples at the parting.
                assert!((value / expected - 1.0).abs() < 1e-8, "{quantity:?}: {value}, expected {expected}");
            }
            let both = collision(&structure, speed, &opponent).unwrap();
            assert!((both.momentum_n_s[1] - both.momentum_n_s[0]).abs() < 1e-6);
            let energy = both.energy.unwrap();
            let absorbed = both.own.absorbed_j.unwrap() + both.partner.absorbed_j.unwrap();
            assert!((absorbed - (energy.at_impact_j - energy.at_rest_j)).abs() < 1e-6 * absorbed);
            // Each has its own energy at half the closing speed.
            assert!((both.own.energy_equivalent_speed_m_per_s.unwrap() - 15.0).abs() < 1e-8);
            assert!((both.common_velocity_m_per_s.unwrap() - 0.5 * (speed - partner_speed)).abs() < 1e-8);
        }
    }
}
