//! A candidate in its own test: what it reaches there, and what its open parameters would change in it.

use rayon::prelude::*;

use crate::error::PredictError;
use crate::impact::candidate::Candidate;
use crate::impact::outcome::{Outcome, QUANTITIES, Quantity, Side, Wave};
use crate::impact::reach::Reach;
use crate::impact::scenario::TestedImpact;
use crate::impact::setting::Setting;
use crate::intervals::directions::Directions;
use crate::intervals::own_test::OwnTest;

/// Sampling interval of impacts that only a difference is taken of.
pub(crate) const COARSE_S: f64 = 2e-4;

/// Relative step of speed and mass for their derivatives.
pub(crate) const STEP: f64 = 0.01;

/// A candidate with the directions of its parameters, in the test that it is from.
pub(crate) struct Tested<'a> {
    pub candidate: &'a Candidate,
    pub test: &'a TestedImpact,
    pub directions: Directions,
    pub reach: Reach,
    /// What it says of its test, beside the record.
    pub own: OwnTest<'a>,
    /// How many masses it has.
    pub masses: usize,
    /// Deceleration of the compartment at the end of the crush, m/s².
    pub deceleration: Option<f64>,
    /// How much longer the crush is at a higher speed, s.
    pub crush_by_speed_s: f64,
    /// For each direction the relative changes of the numbers in the test.
    pub changes: Vec<[f64; QUANTITIES]>,
}

impl<'a> Tested<'a> {
    /// Lets the candidate meet the wall at the speed of its test. Errors: a response that leaves the range of numbers.
    pub fn new(candidate: &'a Candidate, test: &'a TestedImpact) -> Result<Self, PredictError> {
        let directions = Directions::of(candidate);
        let (structure, speed) = (candidate.structure(None)?, test.speed_m_per_s);
        let (own, wave) = OwnTest::new(candidate, test)?;
        let at = |factors: &_| {
            let structure = candidate.changed(factors, None).ok()?;
            Some(Setting::default().impact(&structure, speed, COARSE_S).ok()?.0)
        };
        let changes = directions
            .0
            .par_iter()
            .map(|direction| {
                let [up, down] = &direction.ends;
                relative(half_difference(at(up), at(down)), &own.outcome)
            })
            .collect();
        let crush_at = |factor: f64| {
            let (outcome, _) = Setting::default().impact(&structure, factor * speed, COARSE_S).ok()?;
            outcome.get(Quantity::DynamicCrush)
        };
        let ends = crush_at(1.0 + STEP).zip(crush_at(1.0 - STEP));
        let crush_by_speed_s = ends.map_or(0.0, |(up, down)| (up - down) / (2.0 * STEP * speed));
        let reach = Reach::new(&structure, &wave, Side::Own, speed);
        let deceleration = at_crush(&wave, Side::Own, &own.outcome);
        let masses = structure.masses_kg().len();
        Ok(Self { candidate, test, directions, reach, own, masses, deceleration, crush_by_speed_s, changes })
    }
}

impl Tested<'_> {
    /// Standard deviation of the crush at the speed of the test by the inputs of the test, m; its speed is known to
    /// `speed_m_per_s`.
    ///
    /// The record's own interval is that of the crush that was reached, whatever the speed was. An error `d` of the
    /// stated speed makes the record's crush wrong by `t d`, `t` its time, and leaves the crush at the stated speed
    /// wrong by `(t - dC/dv) d` alone: the faster test has the longer crush.
    pub fn crush_deviation_m(&self, speed_m_per_s: f64) -> f64 {
        let time_s = self.own.outcome.get(Quantity::TimeOfDynamicCrush).unwrap_or(0.0);
        let slope_s = self.crush_by_speed_s;
        let by_speed = speed_m_per_s * speed_m_per_s * slope_s * (2.0 * time_s - slope_s);
        (self.test.crush_deviation_m.powi(2) - by_speed.max(0.0)).max(0.0).sqrt()
    }
}

/// Deceleration of a compartment at the dynamic crush, m/s².
pub(crate) fn at_crush(wave: &Wave, side: Side, outcome: &Outcome) -> Option<f64> {
    let sample = (outcome.get(Quantity::TimeOfDynamicCrush)? / wave.dt_s) as usize;
    let acceleration = |motion: &crumple_lumped::Motion| motion.acceleration_m_per_s2.get(sample).copied();
    match side {
        Side::Partner => acceleration(wave.partner.last()?),
        _ => acceleration(wave.compartment()?).map(|a| -a),
    }
}

/// Half the difference of two outcomes; zero where one of them lacks the number.
pub(crate) fn half_difference(up: Option<Outcome>, down: Option<Outcome>) -> [f64; QUANTITIES] {
    let (up, down) = (up.unwrap_or_default(), down.unwrap_or_default());
    std::array::from_fn(|q| up.0[q].zip(down.0[q]).map_or(0.0, |(up, down)| 0.5 * (up - down)))
}

/// Changes over the numbers themselves.
pub(crate) fn relative(changes: [f64; QUANTITIES], outcome: &Outcome) -> [f64; QUANTITIES] {
    std::array::from_fn(|q| outcome.0[q].filter(|value| *value != 0.0).map_or(0.0, |value| changes[q] / value))
}
