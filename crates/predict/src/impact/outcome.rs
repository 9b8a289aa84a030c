//! What comes out of an impact, and how far it reaches beyond what was tested.

use crumple_lumped::{HORIZON_S, Instants, Motion, Node, Structure};
use crumple_metrics::{OlcOptions, olc};
use crumple_signal::{Cfc, Signal, through_class};

use crate::error::PredictError;

/// How long a motion is followed after the rebound: occupants are still on their way.
pub(crate) const AFTER_REBOUND_S: f64 = 0.05;
/// How long a motion is followed where there is no rebound.
pub(crate) const WITHOUT_REBOUND_S: f64 = 0.25;
/// Zero acceleration before contact, as a laboratory records it: the filter looks ahead.
const BEFORE_CONTACT_S: f64 = 0.04;
/// Channel frequency class of vehicle structures.
const CLASS: Cfc = Cfc::Cfc60;

/// The numbers of an outcome, in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Dynamic crush, m.
    DynamicCrush,
    /// Its time, s.
    TimeOfDynamicCrush,
    /// Change of velocity up to the rebound, m/s.
    DeltaV,
    /// Coefficient of restitution.
    Restitution,
    /// Largest deceleration through CFC 60, m/s².
    Peak,
    /// Occupant load criterion, m/s².
    Olc,
    /// Crush of both fronts at common velocity, m.
    MutualCrush,
    /// What of it is the partner's, m.
    PartnerCrush,
    /// Change of the partner's velocity, m/s.
    PartnerDeltaV,
    /// Largest deceleration of the partner's compartment through CFC 60, m/s².
    PartnerPeak,
    /// Occupant load criterion of the partner, m/s².
    PartnerOlc,
    /// Largest deceleration of the occupant, m/s².
    OccupantPeak,
    /// Largest way of the occupant ahead of the compartment, m.
    OccupantExcursion,
    /// Share of the occupant's energy taken by riding down.
    RideDown,
}

/// Whose front a number depends on in the first place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    /// The vehicle's.
    Own,
    /// The partner's.
    Partner,
    /// The sum of both.
    Both,
}

/// How many numbers an outcome has.
pub(crate) const QUANTITIES: usize = Quantity::ALL.len();

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 14] = [
        Self::DynamicCrush,
        Self::TimeOfDynamicCrush,
        Self::DeltaV,
        Self::Restitution,
        Self::Peak,
        Self::Olc,
        Self::MutualCrush,
        Self::PartnerCrush,
        Self::PartnerDeltaV,
        Self::PartnerPeak,
        Self::PartnerOlc,
        Self::OccupantPeak,
        Self::OccupantExcursion,
        Self::RideDown,
    ];

    /// Its field in the record of a prediction.
    pub fn field(self) -> &'static str {
        match self {
            Self::DynamicCrush => "dynamic_crush_m",
            Self::TimeOfDynamicCrush => "time_of_dynamic_crush_s",
            Self::DeltaV => "delta_v_m_per_s",
            Self::Restitution => "coefficient_of_restitution",
            Self::Peak => "peak_acceleration_m_per_s2",
            Self::Olc => "olc_m_per_s2",
            Self::MutualCrush => "collision.mutual_crush_m",
            Self::PartnerCrush => "collision.partner_crush_m",
            Self::PartnerDeltaV => "collision.partner_delta_v_m_per_s",
            Self::PartnerPeak => "collision.partner_peak_acceleration_m_per_s2",
            Self::PartnerOlc => "collision.partner_olc_m_per_s2",
            Self::OccupantPeak => "occupant.peak_acceleration_m_per_s2",
            Self::OccupantExcursion => "occupant.largest_excursion_m",
            Self::RideDown => "occupant.ride_down_share",
        }
    }

    /// By which power it changes with the crush at the same energy: a softer structure stops later and at a lower
    /// force, and what comes back goes as that force. A change of velocity goes as one plus the restitution.
    pub(crate) fn power_of_crush(self, restitution: f64) -> f64 {
        match self {
            Self::DynamicCrush | Self::TimeOfDynamicCrush | Self::MutualCrush | Self::PartnerCrush => 1.0,
            Self::Peak | Self::Olc | Self::PartnerPeak | Self::PartnerOlc | Self::OccupantPeak | Self::Restitution => {
                -1.0
            }
            Self::DeltaV | Self::PartnerDeltaV => -restitution / (1.0 + restitution),
            Self::OccupantExcursion | Self::RideDown => 0.0,
        }
    }

    /// Least and largest value that is possible beside this one and this restitution.
    pub(crate) fn possible(self, value: f64, restitution: f64) -> (f64, f64) {
        // A vehicle at a wall loses its speed and at most gains as much again.
        let plain = value / (1.0 + restitution);
        match self {
            Self::Restitution => (0.0, 1.0),
            // Negative where the vehicle is pushed back before the occupant stops. The restraint takes the rest.
            Self::RideDown => (f64::NEG_INFINITY, 1.0),
            Self::DeltaV | Self::PartnerDeltaV => (plain.min(2.0 * plain), plain.max(2.0 * plain)),
            _ => (0.0, f64::INFINITY),
        }
    }

    /// Whose crush that is.
    pub(crate) fn side(self) -> Side {
        match self {
            Self::MutualCrush => Side::Both,
            Self::PartnerCrush | Self::PartnerDeltaV | Self::PartnerPeak | Self::PartnerOlc => Side::Partner,
            _ => Side::Own,
        }
    }

    /// The number of the vehicle's own impact on a wall that moves with this one.
    pub(crate) fn of_own(self) -> Option<Self> {
        match self {
            Self::MutualCrush => Some(Self::DynamicCrush),
            Self::OccupantPeak => Some(Self::Peak),
            _ => Self::ALL[..6].contains(&self).then_some(self),
        }
    }

    /// The same of the partner's own impact on a wall.
    pub(crate) fn of_partner(self) -> Option<Self> {
        match self {
            Self::MutualCrush | Self::PartnerCrush => Some(Self::DynamicCrush),
            Self::PartnerDeltaV => Some(Self::DeltaV),
            Self::PartnerPeak => Some(Self::Peak),
            Self::PartnerOlc => Some(Self::Olc),
            Self::TimeOfDynamicCrush | Self::Restitution => Some(self),
            _ => None,
        }
    }
}

/// Numbers in the order of [`Quantity::ALL`]; what the model never reaches is `None`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Outcome(pub [Option<f64>; QUANTITIES]);

impl Outcome {
    /// One of its numbers.
    pub fn get(&self, quantity: Quantity) -> Option<f64> {
        self.0[quantity as usize]
    }
}

/// Where the energy of an impact goes, J.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Energy {
    /// Kinetic energy of all masses at contact.
    pub at_impact_j: f64,
    /// Kinetic energy of all masses when the compartment stops, or has the velocity of the partner's.
    pub at_rest_j: f64,
}

/// The motion of an impact.
#[derive(Debug, Clone, PartialEq)]
pub struct Wave {
    /// Sampling interval, s; sample 0 is contact.
    pub dt_s: f64,
    /// Motion of every mass up to the rebound, and free after it; the last is the compartment.
    pub motions: Vec<Motion>,
    /// The same of the partner, on the same axis, from its front to its compartment; none at the wall.
    pub partner: Vec<Motion>,
    /// Where the fronts meet, m; none at the wall.
    pub contact_m: Vec<f64>,
}

impl Wave {
    /// The compartment's.
    pub fn compartment(&self) -> Option<&Motion> {
        self.motions.last()
    }

    /// Velocity at which the compartments stop each other, between samples linear; at the wall zero. `None`: they do
    /// not.
    pub(crate) fn common_velocity_m_per_s(&self) -> Option<f64> {
        let Some(partner) = self.partner.last() else { return Some(0.0) };
        let own = &self.compartment()?.velocity_m_per_s;
        let relative = |k: usize| own[k] - partner.velocity_m_per_s[k];
        let k = (1..own.len()).find(|k| relative(*k) <= 0.0)?;
        let share = relative(k - 1) / (relative(k - 1) - relative(k));
        Some(own[k - 1] + share * (own[k] - own[k - 1]))
    }

    /// Displacement of the masses of the vehicle, or of its partner in its own direction, from where the fronts meet.
    pub(crate) fn crush_of_masses(&self, side: Side) -> Vec<Vec<f64>> {
        let (motions, sign) = if side == Side::Partner { (&self.partner, -1.0) } else { (&self.motions, 1.0) };
        let from = |k: usize| self.contact_m.get(k).copied().unwrap_or(0.0);
        let of =
            |motion: &Motion| motion.displacement_m.iter().enumerate().map(|(k, x)| sign * (x - from(k))).collect();
        motions.iter().map(of).collect()
    }
}

/// The impact of a structure on the wall, sampled at `dt_s`.
///
/// Crush, its time and the rebound are those of the exact motion of the compartment: the first zero of its velocity,
/// and of its acceleration after it, where a real contact opens. After it the wave goes on free of force. The peak is
/// read from the sampled acceleration through CFC 60, as a laboratory would. Errors: a response that leaves the range
/// of numbers.
pub(crate) fn at_wall(structure: &Structure, speed: f64, dt_s: f64) -> Result<(Outcome, Wave), PredictError> {
    let events = structure.events(speed, HORIZON_S)?.pop().unwrap_or_default();
    let end_s = events.time_of_rebound_s.map_or(WITHOUT_REBOUND_S, |t| t + AFTER_REBOUND_S);
    let samples = (end_s / dt_s).ceil() as usize + 1;
    let mut motions = structure.motions_at(speed, &Instants { first_s: 0.0, dt_s, samples })?;
    if let Some(rebound_s) = events.time_of_rebound_s {
        motions.iter_mut().for_each(|motion| let_go(motion, rebound_s, dt_s));
    }
    let wave = Wave { dt_s, motions, partner: Vec::new(), contact_m: Vec::new() };
    let restitution = events.rebound_velocity_m_per_s.map(|rebound| -rebound / speed);
    let numbers = [
        events.dynamic_crush_m,
        events.time_of_dynamic_crush_s,
        restitution.map(|e| speed * (1.0 + e)),
        restitution,
        wave.compartment().and_then(|motion| peak(motion, dt_s)),
        wave.compartment().and_then(|motion| occupant_load(motion, speed, dt_s)),
    ];
    let mut outcome = Outcome::default();
    outcome.0[..numbers.len()].copy_from_slice(&numbers);
    Ok((outcome, wave))
}

/// Kinetic energies of an impact. `None`: the compartment never stops.
pub(crate) fn energy(structure: &Structure, speed: f64, outcome: &Outcome) -> Result<Option<Energy>, PredictError> {
    let Some(first_s) = outcome.get(Quantity::TimeOfDynamicCrush) else { return Ok(None) };
    let at_rest = structure.motions_at(speed, &Instants { first_s, dt_s: 1e-4, samples: 1 })?;
    let masses = structure.masses_kg();
    let at_rest_j = masses.iter().zip(&at_rest).map(|(m, motion)| 0.5 * m * motion.velocity_m_per_s[0].powi(2)).sum();
    Ok(Some(Energy { at_impact_j: 0.5 * masses.iter().sum::<f64>() * speed * speed, at_rest_j }))
}

/// From the rebound on no force acts.
pub(crate) fn let_go(motion: &mut Motion, rebound_s: f64, dt_s: f64) {
    let from = (rebound_s / dt_s).ceil() as usize;
    let Some((&x, &v)) = motion.displacement_m.get(from).zip(motion.velocity_m_per_s.get(from)) else { return };
    for k in from..motion.displacement_m.len() {
        motion.displacement_m[k] = x + v * (k - from) as f64 * dt_s;
        motion.velocity_m_per_s[k] = v;
        motion.acceleration_m_per_s2[k] = 0.0;
    }
}

/// An acceleration from contact on through CFC 60, as a laboratory records it: zero before.
pub(crate) fn through_cfc_60(acceleration: &[f64], dt_s: f64) -> Option<Vec<f64>> {
    let before = (BEFORE_CONTACT_S / dt_s).round() as usize;
    let mut samples = vec![0.0; before];
    samples.extend_from_slice(acceleration);
    let mut filtered = through_class(&samples, dt_s, CLASS)?;
    Some(filtered.split_off(before))
}

/// Largest deceleration through CFC 60.
pub(crate) fn peak(motion: &Motion, dt_s: f64) -> Option<f64> {
    let filtered = through_cfc_60(&motion.acceleration_m_per_s2, dt_s)?;
    filtered.into_iter().map(|a| -a).reduce(f64::max).filter(|peak| *peak > 0.0)
}

pub(crate) fn occupant_load(motion: &Motion, speed: f64, dt_s: f64) -> Option<f64> {
    let velocity = Signal::new(0.0, dt_s, motion.velocity_m_per_s.clone()).ok()?;
    let displacement = Signal::new(0.0, dt_s, motion.displacement_m.clone()).ok()?;
    olc(&velocity, &displacement, speed, OlcOptions::default()).ok()?.value
}

/// What is not counted as beyond: rounding, and the samples between which a largest compression lies.
const BEYOND: f64 = 1.001;

/// How far an impact reaches.
#[derive(Debug, Clone, PartialEq)]
pub struct Reach {
    /// Largest compression of each element, m, in the order of the structure.
    pub compression_m: Vec<f64>,
    /// Impact speed on a wall, or that of the same energy, m/s.
    pub speed_m_per_s: f64,
}

impl Reach {
    /// The reach of an impact in the structure of one side.
    pub(crate) fn new(structure: &Structure, wave: &Wave, side: Side, speed_m_per_s: f64) -> Self {
        let displacements = wave.crush_of_masses(side);
        let place = |node: Node| match node {
            Node::Wall => None,
            Node::Mass(i) => displacements.get(i),
        };
        let at = |displacement: Option<&Vec<f64>>, k: usize| displacement.map_or(0.0, |displacement| displacement[k]);
        let samples = displacements.last().map_or(0, Vec::len);
        let compression_m = structure
            .connections()
            .iter()
            .map(|connection| {
                let (front, rear) = (place(connection.front), place(connection.rear));
                (0..samples).map(|k| at(rear, k) - at(front, k)).fold(0.0, f64::max)
            })
            .collect();
        Self { compression_m, speed_m_per_s }
    }

    /// The largest factor by which a compression goes beyond that of a test, with the number of the element, from 1;
    /// `None`: none does. Elements that carry the same force are compressed alike, which rounding does not order: the
    /// first of them.
    pub fn beyond(&self, tested: &Self) -> Option<(usize, f64)> {
        let pairs = self.compression_m.iter().zip(&tested.compression_m).enumerate();
        let mut factors = pairs
            .filter(|(_, (_, tested))| **tested > 0.0)
            .map(|(k, (asked, tested))| (k + 1, asked / tested))
            .filter(|(_, factor)| *factor > BEYOND);
        let largest = factors.clone().map(|(_, factor)| factor).fold(0.0, f64::max);
        factors.find(|(_, factor)| *factor >= largest * (1.0 - 1e-9))
    }

    /// Whether the speed goes beyond that of a test.
    pub fn is_faster(&self, tested: &Self) -> bool {
        self.speed_m_per_s > BEYOND * tested.speed_m_per_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_lumped::{Elastoplastic, Model};

    #[test]
    fn the_numbers_are_those_of_the_closed_form() {
        let (m, k, unloading, v0) = (1000.0, 4e5, 1.6e7, 15.0);
        let model = Elastoplastic {
            mass_kg: m,
            loading_stiffness_n_per_m: k,
            unloading_stiffness_n_per_m: unloading,
            release: true,
        };
        let structure = Model::Elastoplastic(model).structure().unwrap();
        let (outcome, wave) = at_wall(&structure, v0, 1e-4).unwrap();
        let crush = v0 * f64::sqrt(m / k);
        let close = |quantity: Quantity, expected: f64, tolerance: f64| {
            let value = outcome.get(quantity).unwrap();
            assert!((value / expected - 1.0).abs() < tolerance, "{quantity:?}: {value}, expected {expected}");
        };
        close(Quantity::DynamicCrush, crush, 1e-10);
        close(Quantity::TimeOfDynamicCrush, 0.5 * std::f64::consts::PI * f64::sqrt(m / k), 1e-10);
        let e = f64::sqrt(k / unloading);
        close(Quantity::Restitution, e, 1e-8);
        close(Quantity::DeltaV, v0 * (1.0 + e), 1e-8);
        // The sine falls off within 12 ms after its peak: what CFC 60 makes of that is within the overshoot of one
        // Butterworth pass, 4 %.
        close(Quantity::Peak, k * crush / m, 0.04);
        let energy = energy(&structure, v0, &outcome).unwrap().unwrap();
        assert!((energy.at_impact_j - 112_500.0).abs() < 1e-6 && energy.at_rest_j < 1e-9);
        let last = wave.compartment().unwrap();
        assert!((last.velocity_m_per_s.last().unwrap() + e * v0).abs() < 1e-2 * v0);
        assert_eq!(last.acceleration_m_per_s2.last(), Some(&0.0));
    }
}
