//! An impact in its setting: against the wall or a partner, with an occupant or without.

use crumple_lumped::{Occupant, OccupantMotion, Structure};

use crate::error::PredictError;
use crate::impact::occupant::ride;
use crate::impact::outcome::{Outcome, Quantity, Wave, at_wall};
use crate::impact::partner::{Opponent, collide};

/// What a vehicle meets, and who sits in it.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Setting<'a> {
    /// `None`: the wall.
    pub opponent: Option<&'a Opponent>,
    pub occupant: Option<&'a Occupant>,
}

impl<'a> Setting<'a> {
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
