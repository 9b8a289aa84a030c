//! An occupant behind a restraint, in a vehicle that is slowed down by a pulse.
//!
//! The vehicle is the base and its pulse is given: that the occupant pushes back on it is left out. All is seen from a
//! frame that keeps the impact speed, in which everything starts from rest.

use crate::error::positive;
use crate::motion::collision::{ElementEvent, Extremum};
use crate::series::step::{Series, integral, product, value};
use crate::series::walk::walk;
use crate::series::zeros::{falls, largest};
use crate::structure::connected_masses::Structure;
use crate::structure::elements::force_deflection::ForceDeflection;
use crate::{CrashPulse, Drive, LumpedError};

/// An occupant and what holds it.
#[derive(Debug, Clone, PartialEq)]
pub struct Occupant {
    /// The mass that the restraint holds, kg.
    pub mass_kg: f64,
    /// The restraint; its gap is the slack.
    pub restraint: ForceDeflection,
}

/// What becomes of an occupant.
#[derive(Debug, Clone, PartialEq)]
pub struct OccupantMotion {
    /// When the slack is used up, s, and the relative speed then, m/s.
    pub contact: Option<[f64; 2]>,
    /// Largest deceleration by the restraint, m/s².
    pub peak_deceleration: Extremum,
    /// Largest way ahead of the vehicle, m.
    pub largest_excursion: Extremum,
    /// Permanent set of the restraint, m.
    pub permanent_set_m: f64,
    /// Work done on the restraint up to the end, J.
    pub work_of_restraint_j: f64,
    /// Speed ahead of the vehicle at the end, m/s.
    pub relative_speed_end_m_per_s: f64,
    /// Way ahead of the vehicle at the end, m.
    pub excursion_end_m: f64,
    /// Speed of the vehicle over ground at the end, m/s.
    pub vehicle_speed_end_m_per_s: f64,
    /// The occupant's stop over ground.
    pub stop: Option<OccupantStop>,
}

/// Where an occupant stops over ground, and what stopped it. Both shares together are one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OccupantStop {
    /// When, s.
    pub time_s: f64,
    /// Share of its energy taken by riding down with the vehicle, `(2/v0²) integral of F/m v_vehicle dt`.
    pub ridedown_share: f64,
    /// Share taken by the restraint.
    pub restraint_share: f64,
}

impl Occupant {
    /// The motion up to `until_s` in a vehicle of this impact speed, m/s, under a pulse of deceleration.
    ///
    /// Errors: a mass, speed or end that is not positive, a pulse that is none, a motion that cannot be followed.
    pub fn ride(
        &self,
        pulse: &CrashPulse,
        impact_speed_m_per_s: f64,
        until_s: f64,
    ) -> Result<OccupantMotion, LumpedError> {
        positive("impact_speed_m_per_s", impact_speed_m_per_s)?;
        positive("until_s", until_s)?;
        let structure = Structure::row(&[self.mass_kg], [vec![self.restraint.clone().into()]])?;
        let drive = Drive::BasePulse(pulse.reversed());
        structure.check_drive(&drive)?;
        let law = structure.connections()[0].element.law();
        let v0 = impact_speed_m_per_s;
        let of_energy = 2.0 / (self.mass_kg * v0 * v0);
        let mut motion = OccupantMotion {
            contact: (self.restraint.gap_m() == 0.0).then_some([0.0; 2]),
            peak_deceleration: Extremum::default(),
            largest_excursion: Extremum::default(),
            permanent_set_m: 0.0,
            work_of_restraint_j: 0.0,
            relative_speed_end_m_per_s: 0.0,
            excursion_end_m: 0.0,
            vehicle_speed_end_m_per_s: v0,
            stop: None,
        };
        let (mut moves_on, mut ridedown_j) = (true, 0.0);
        walk(&structure, &drive, until_s, until_s, &[], |step, _| {
            let (link, start_s, length_s) = (&step.links[0], step.start_s, step.length_s);
            for entry in &step.entered {
                if law.event(&entry.before, &entry.after) == Some(ElementEvent::Contact) {
                    motion.contact.get_or_insert([start_s, link.w[0]]);
                }
            }
            let force = link.series(&link.law);
            let over_ground = |v: &Series| -> Series { std::array::from_fn(|k| v[k] + if k == 0 { v0 } else { 0.0 }) };
            let [occupant, vehicle] = [0, 1].map(|node| over_ground(&step.nodes[node].v));
            let power = |speed: &Series| -> Series { std::array::from_fn(|k| product(&force, speed, k)) };
            let (restraint, ridedown) = (power(&link.w), power(&vehicle));
            let deceleration: Series = force.map(|term| term / self.mass_kg);
            largest(&deceleration, |x| x, start_s, length_s, &mut motion.peak_deceleration);
            largest(&link.u, |x| x, start_s, length_s, &mut motion.largest_excursion);
            if motion.stop.is_none()
                && let Some(tau) = falls(&occupant, length_s, &mut moves_on)
            {
                motion.stop = Some(OccupantStop {
                    time_s: start_s + tau,
                    ridedown_share: of_energy * (ridedown_j + integral(&ridedown, tau)),
                    restraint_share: of_energy * (motion.work_of_restraint_j + integral(&restraint, tau)),
                });
            }
            motion.work_of_restraint_j += integral(&restraint, length_s);
            ridedown_j += integral(&ridedown, length_s);
            motion.permanent_set_m = step.branches[0].set;
            motion.relative_speed_end_m_per_s = value(&link.w, length_s);
            motion.excursion_end_m = value(&link.u, length_s);
            motion.vehicle_speed_end_m_per_s = value(&vehicle, length_s);
            true
        })?;
        Ok(motion)
    }
}
