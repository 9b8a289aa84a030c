//! A candidate in its own test: what it reaches there, how its parameters may be off, what the record answers for.

use std::collections::BTreeMap;
use std::f64::consts::LN_2;

use crumple_lumped::Model;
use crumple_lumped_fit::EnergyClass;
use nalgebra::{DMatrix, SymmetricEigen};
use rayon::prelude::*;

use crate::error::PredictError;
use crate::impact::candidate::{Candidate, TestedImpact};
use crate::impact::made_test::{FeltOverEnergy, MadeTest};
use crate::impact::outcome::{Outcome, QUANTITIES, Quantity, Reach, Side, Wave, through_cfc_60};
use crate::impact::partner::{CollisionOutcome, PreparedSetup};

/// Largest standard deviation along a direction, of the logarithms: a factor of 2. The record says nothing along a
/// direction that is wider, the range of vehicles does.
const WIDEST: f64 = LN_2;
/// Standard deviations of the logarithms below this move nothing.
const NOTHING: f64 = 1e-9;

/// One direction: one standard deviation of it, as factors of the parameters.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Direction {
    /// One standard deviation up, and down.
    pub ends: [BTreeMap<String, f64>; 2],
    /// Whether it is as wide as it may be, and not as wide as the record says.
    pub limited: bool,
}

/// The directions of a candidate.
#[derive(Debug, Clone, PartialEq)]
pub struct Directions(pub(crate) Vec<Direction>);

impl Directions {
    /// Principal directions of the covariance of the logarithms, `s_i = sd_i/|p_i|` with the correlations as measured,
    /// and one for each open parameter that has no deviation.
    ///
    /// A parameter at zero, the limit of what is physical, stays there: the others are conditioned on it. A direction
    /// wider than a factor of 2 is limited to it.
    pub fn of(candidate: &Candidate) -> Self {
        let Some(spread) = &candidate.spread else { return Self(Vec::new()) };
        let (names, covariance) = log_covariance(candidate).unwrap_or((Vec::new(), DMatrix::zeros(0, 0)));
        let value = |name: &str| candidate.value(name).unwrap_or(0.0);
        let deviation = |name: &str| spread.standard_deviation.get(name).copied().filter(|d| d.is_finite() && *d > 0.0);
        let mut directions = principal(&names, covariance);
        let parameters = candidate.model.as_ref().map(Model::parameters).unwrap_or_default();
        let others = parameters.keys().filter(|name| {
            let is_open = spread.open.contains(name);
            value(name) != 0.0 && !names.contains(*name) && (is_open || deviation(name).is_some())
        });
        for name in others {
            let known = deviation(name).map(|d| d / value(name).abs()).filter(|_| !spread.open.contains(name));
            directions.push(direction(std::slice::from_ref(name), &[1.0], known.unwrap_or(f64::INFINITY)));
        }
        Self(directions)
    }

    /// How many of them are limited.
    pub fn limited(&self) -> usize {
        self.0.iter().filter(|direction| direction.limited).count()
    }
}

/// The parameters of a candidate with a deviation, and the covariance of their logarithms; a parameter at zero stays
/// there, and the others are conditioned on it. `None` where nothing is known of them.
pub(crate) fn log_covariance(candidate: &Candidate) -> Option<(Vec<String>, DMatrix<f64>)> {
    let spread = candidate.spread.as_ref()?;
    let value = |name: &str| candidate.value(name).unwrap_or(0.0);
    let deviation = |name: &str| spread.standard_deviation.get(name).copied().filter(|d| d.is_finite() && *d > 0.0);
    let rows = spread.order.iter().enumerate().filter(|(_, name)| deviation(name).is_some());
    let (at_zero, free): (Vec<_>, Vec<_>) = rows.partition(|(_, name)| value(name) == 0.0);
    let correlation = |rows: &[(usize, &String)], columns: &[(usize, &String)]| {
        DMatrix::from_fn(rows.len(), columns.len(), |i, j| {
            let (row, column) = (rows[i].0, columns[j].0);
            let stated = spread.correlation.get(row).and_then(|row| row.get(column));
            stated.copied().unwrap_or(if row == column { 1.0 } else { 0.0 })
        })
    };
    let mut covariance = correlation(&free, &free);
    if let Some(inverse) = correlation(&at_zero, &at_zero).try_inverse() {
        let across = correlation(&free, &at_zero);
        covariance -= &across * inverse * across.transpose();
    }
    let scale: Vec<f64> = free.iter().map(|(_, name)| deviation(name).unwrap_or(0.0) / value(name).abs()).collect();
    for (i, j) in (0..scale.len()).flat_map(|i| (0..scale.len()).map(move |j| (i, j))) {
        covariance[(i, j)] *= scale[i] * scale[j];
    }
    Some((free.into_iter().map(|(_, name)| name.clone()).collect(), covariance))
}

fn principal(names: &[String], covariance: DMatrix<f64>) -> Vec<Direction> {
    if names.is_empty() || covariance.iter().any(|c| !c.is_finite()) {
        return Vec::new();
    }
    let eigen = SymmetricEigen::new(covariance);
    (0..names.len())
        .map(|i| (eigen.eigenvalues[i].max(0.0).sqrt(), eigen.eigenvectors.column(i)))
        .filter(|(deviation, _)| *deviation > NOTHING)
        .map(|(deviation, along)| direction(names, along.as_slice(), deviation))
        .collect()
}

/// One standard deviation along a vector of unit length, limited.
fn direction(names: &[String], along: &[f64], deviation: f64) -> Direction {
    let limited = deviation > WIDEST;
    let step = deviation.min(WIDEST);
    let end =
        |sign: f64| names.iter().zip(along).map(|(name, part)| (name.clone(), (sign * step * part).exp())).collect();
    Direction { ends: [end(1.0), end(-1.0)], limited }
}

/// Sampling interval of the waves, s: 10 kHz, as a laboratory records.
pub(crate) const SAMPLING_S: f64 = 1e-4;
/// What a relative error of the force at the end of the crush does to its time: of a constant force the last tenth of
/// the way takes a third of the time, and its time goes as one over the force.
const TIME_BY_FORCE: f64 = 0.3;
/// Restitution below which a model is plastic and its own says nothing at any speed: the record's stands for it.
const LEAST_RESTITUTION: f64 = 0.01;

/// A model in its own test, and the test.
#[derive(Debug, Clone)]
pub(crate) struct OwnTest<'a> {
    pub outcome: Outcome,
    /// Its masses, kg.
    pub mass_kg: f64,
    class: EnergyClass,
    felt: Option<FeltOverEnergy>,
    made: &'a MadeTest,
}

impl<'a> OwnTest<'a> {
    /// Lets the candidate meet the wall at the speed of its test; with its motion. Errors: a response that leaves the
    /// range of numbers.
    pub fn new(candidate: &Candidate, test: &'a TestedImpact) -> Result<(Self, Wave), PredictError> {
        let structure = candidate.structure(None)?;
        let (outcome, wave) = PreparedSetup::default().impact(&structure, test.speed_m_per_s, SAMPLING_S)?;
        let felt = wave.compartment().and_then(|motion| {
            let braking: Vec<f64> =
                through_cfc_60(&motion.acceleration_m_per_s2, wave.dt_s)?.iter().map(|a| -a).collect();
            FeltOverEnergy::new(test.speed_m_per_s, &motion.velocity_m_per_s, &braking)
        });
        Ok((
            Self {
                outcome,
                mass_kg: structure.masses_kg().iter().sum(),
                felt,
                made: &test.made,
                class: candidate.class(),
            },
            wave,
        ))
    }

    /// What the record shows over what the model shows, of the largest deceleration until both have taken this energy,
    /// J, in an impact of this mass; where one of them shows nothing, `None`.
    fn peak(&self, energy_j: f64, mass_kg: f64) -> Option<PeakByRecord> {
        let largest = |felt: Option<&FeltOverEnergy>| felt?.largest_until(energy_j / self.mass_kg);
        let (made, model) = (largest(self.made.felt.as_ref())?, largest(self.felt.as_ref())?);
        let at_the_end = |felt: Option<&FeltOverEnergy>| felt?.at_the_end();
        let ends = at_the_end(self.made.felt.as_ref()).zip(at_the_end(self.felt.as_ref()));
        let end = ends.map_or(1.0, |(made, model)| made / model);
        Some(PeakByRecord { made, model, end, mass_ratio: mass_kg / self.mass_kg })
    }

    /// Relative standard deviation of the peak of the record by this one of the crush, where it has taken this energy,
    /// J. Energy goes as the square of the crush, as on a straight curve.
    pub fn peak_by_crush(&self, energy_j: f64, deviation: f64) -> f64 {
        let largest = |share: f64| self.made.felt.as_ref()?.largest_until(share * energy_j / self.mass_kg);
        let three =
            largest((1.0 - 2.0 * deviation).max(LEAST_SHARE)).zip(largest(1.0)).zip(largest(1.0 + 2.0 * deviation));
        three.map_or(0.0, |((low, own), high)| 0.5 * (high - low) / own)
    }

    /// The same of the coefficient of restitution, that of the model at least [`LEAST_RESTITUTION`].
    fn restitution(&self) -> Option<f64> {
        let model = self.outcome.get(Quantity::Restitution)?.max(LEAST_RESTITUTION);
        Some(self.made.coefficient_of_restitution?.max(0.0) / model)
    }

    /// Whether the record answers for a number.
    pub fn is_by_record(&self, quantity: Quantity) -> bool {
        match quantity {
            Quantity::Peak | Quantity::PartnerPeak => self.felt.is_some() && self.made.felt.is_some(),
            Quantity::Restitution | Quantity::DeltaV | Quantity::PartnerDeltaV => self.restitution().is_some(),
            _ => false,
        }
    }

    /// Relative misfit of a number. The time of the crush and what comes back go by the force at the end of the crush
    /// as well, which lies elsewhere at another speed: by the misfit of the force over the crush, and beyond the tested
    /// crush by the waves of that force.
    pub fn misfit(&self, quantity: Quantity, restitution: f64, beyond: bool) -> f64 {
        match quantity {
            Quantity::DynamicCrush => self.misfit_of(quantity),
            Quantity::TimeOfDynamicCrush => self.misfit_of(quantity).hypot(TIME_BY_FORCE * self.misfit_of_force(false)),
            Quantity::Peak => self.peak(f64::INFINITY, self.mass_kg).map_or(0.0, |peak| 1.0 - peak.model / peak.made),
            Quantity::Restitution | Quantity::DeltaV => {
                quantity.power_of_crush(restitution) * self.misfit_of_force(beyond)
            }
            _ => 0.0,
        }
    }

    fn misfit_of(&self, quantity: Quantity) -> f64 {
        let pair = self.outcome.get(quantity).zip(self.made.get(quantity));
        pair.filter(|(_, made)| *made != 0.0).map_or(0.0, |(model, made)| model / made - 1.0)
    }

    /// Of a plastic structure beyond the tested crush at least the waves of the force.
    fn misfit_of_force(&self, beyond: bool) -> f64 {
        let both = self.made.felt.as_ref().zip(self.felt.as_ref());
        let misfit = both.and_then(|(made, model)| made.misfit(model)).unwrap_or(0.0);
        let waves = both.filter(|_| beyond && self.class == EnergyClass::Plastic).and_then(|(made, _)| made.waves());
        misfit.max(waves.unwrap_or(0.0))
    }
}

/// The largest decelerations of a record and of its model until an energy is taken, m/s², and the ratio of both at the
/// end of the test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PeakByRecord {
    made: f64,
    model: f64,
    end: f64,
    /// Mass of the impact over that of the test.
    mass_ratio: f64,
}

impl PeakByRecord {
    /// The peak of an impact in which the model has this one. One of a force larger than in the test is felt beyond it,
    /// where the end of the record says how far the model is off, and an early or late wave of it does not.
    fn of(self, model: f64) -> f64 {
        let grows = model * self.mass_ratio > self.model * (1.0 + GROWS);
        if grows { (self.end * model).max(self.made / self.mass_ratio) } else { self.made / self.model * model }
    }
}

/// Least share of an energy up to which a peak is read: a crush that is hardly known says nothing of less.
const LEAST_SHARE: f64 = 0.05;

/// Relative rise of a peak that is no rounding of a response.
const GROWS: f64 = 1e-3;

/// A front in an impact: its own test, the energy that it takes, J, and the mass behind it, kg.
#[derive(Clone, Copy)]
pub(crate) struct TestedFront<'a> {
    pub test: &'a OwnTest<'a>,
    pub energy_j: f64,
    pub mass_kg: f64,
}

/// What the records of both vehicles make of the answers of their models: each multiplied by what the record shows over
/// what the model shows in its own test. So it is the record's where the same energy is taken, and of a model that is
/// right its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RecordFactors {
    /// Of the peak; `None`: the record says nothing of it.
    pub peak: Option<PeakByRecord>,
    /// Factor of the restitution, of at least [`LEAST_RESTITUTION`]; the product is 1 at most.
    pub restitution: Option<f64>,
    partner_peak: Option<PeakByRecord>,
}

impl RecordFactors {
    /// Of the vehicle, and of its partner: a face or the wall has no test. What comes back in a collision is of each
    /// front as its share of the energy.
    pub fn new(own: TestedFront<'_>, partner: Option<TestedFront<'_>>, barrier_j: f64) -> Self {
        let peak = |front: TestedFront<'_>| front.test.peak(front.energy_j, front.mass_kg);
        let (factor, taken) = (own.test.restitution(), own.energy_j);
        let of_partner = |front: TestedFront<'_>| (front.test.restitution().unwrap_or(1.0), front.energy_j);
        let other = partner.map_or((1.0, barrier_j), of_partner);
        let of_both = |factor: f64| {
            let squares = factor * factor * taken + other.0 * other.0 * other.1;
            if taken + other.1 > 0.0 { (squares / (taken + other.1)).sqrt() } else { factor }
        };
        Self { peak: peak(own), restitution: factor.map(of_both), partner_peak: partner.and_then(peak) }
    }

    /// The answers of a model as the records leave them.
    pub fn of(&self, model: &Outcome) -> Outcome {
        let mut outcome = *model;
        let by_velocity = self.change_of_velocity(model);
        outcome.0[Quantity::Restitution as usize] = self.rebound(model).map(|(_, e)| e);
        for (quantity, peak) in [(Quantity::Peak, self.peak), (Quantity::PartnerPeak, self.partner_peak)] {
            let value = &mut outcome.0[quantity as usize];
            *value = value.zip(peak).map(|(value, peak)| peak.of(value)).or(*value);
        }
        for quantity in [Quantity::DeltaV, Quantity::PartnerDeltaV] {
            let value = &mut outcome.0[quantity as usize];
            *value = value.map(|value| by_velocity * value);
        }
        outcome
    }

    /// The restitution of a model, and as the records leave it.
    fn rebound(&self, model: &Outcome) -> Option<(f64, f64)> {
        let e = model.get(Quantity::Restitution)?;
        Some((e, self.restitution.map_or(e, |factor| (factor * e.max(LEAST_RESTITUTION)).min(1.0))))
    }

    /// Factor of every change of velocity: it goes as one plus the restitution.
    fn change_of_velocity(&self, model: &Outcome) -> f64 {
        self.rebound(model).map_or(1.0, |(e, by_record)| (1.0 + by_record) / (1.0 + e))
    }

    /// The velocities after a collision that belong to them.
    pub fn after(&self, both: &mut CollisionOutcome, model: &Outcome) {
        let factor = self.change_of_velocity(model);
        for body in [&mut both.own, &mut both.partner] {
            let before = body.velocity_before_m_per_s;
            body.velocity_after_m_per_s = body.velocity_after_m_per_s.map(|after| before + factor * (after - before));
        }
    }
}

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
            let structure = candidate.changed(factors, None)?;
            Some(PreparedSetup::default().impact(&structure, speed, COARSE_S).ok()?.0)
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
            let (outcome, _) = PreparedSetup::default().impact(&structure, factor * speed, COARSE_S).ok()?;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::impact::candidate::ParameterSpread;
    use crumple_lumped::Kelvin;

    fn kelvin(damping: f64, deviations: [f64; 2], correlation: f64) -> Candidate {
        let names = ["stiffness_n_per_m", "damping_n_s_per_m"].map(str::to_owned);
        Candidate {
            id: "kelvin/direct-fit/1".to_owned(),
            model: Ok(Model::Kelvin(Kelvin { mass_kg: 1e3, stiffness_n_per_m: 4e5, damping_n_s_per_m: damping })),
            spread: Some(ParameterSpread {
                standard_deviation: names.iter().cloned().zip(deviations).collect(),
                order: names.to_vec(),
                correlation: vec![vec![1.0, correlation], vec![correlation, 1.0]],
                open: Vec::new(),
            }),
            weight: 0.0,
        }
    }

    #[test]
    fn directions_give_the_covariance_back() {
        let directions = Directions::of(&kelvin(1e4, [2e4, 1e3], -0.8));
        assert_eq!((directions.0.len(), directions.limited()), (2, 0));
        let log = |d: &Direction, name: &str| d.ends[0][name].ln();
        let sum = |a: &str, b: &str| directions.0.iter().map(|d| log(d, a) * log(d, b)).sum::<f64>();
        let [k, c] = ["stiffness_n_per_m", "damping_n_s_per_m"];
        // (2e4/4e5)^2, (1e3/1e4)^2, -0.8 of the product of the roots.
        assert!((sum(k, k) - 2.5e-3).abs() < 1e-12 && (sum(c, c) - 1e-2).abs() < 1e-12);
        assert!((sum(k, c) + 0.8 * 5e-3).abs() < 1e-12);
        let up_and_down = &directions.0[0].ends;
        assert!((up_and_down[0][k] * up_and_down[1][k] - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_damper_at_zero_stays_and_the_spring_is_conditioned_on_it() {
        let directions = Directions::of(&kelvin(0.0, [2e4, 1e3], -0.8));
        assert_eq!(directions.0.len(), 1);
        // 0.05 sqrt(1 - 0.8^2) = 0.03.
        assert!((directions.0[0].ends[0]["stiffness_n_per_m"].ln().abs() - 0.03).abs() < 1e-12);
    }

    #[test]
    fn what_the_record_leaves_open_is_known_to_a_factor_of_2() {
        let mut open = kelvin(1e4, [2e4, 9e4], 0.0);
        let directions = Directions::of(&open);
        assert_eq!(directions.limited(), 1);
        let widest = directions.0.iter().find(|d| d.limited).unwrap();
        assert!((widest.ends[0]["damping_n_s_per_m"].ln().abs() - LN_2).abs() < 1e-9);
        let spread = open.spread.as_mut().unwrap();
        (spread.order, spread.correlation) = (Vec::new(), Vec::new());
        spread.standard_deviation.clear();
        spread.open = vec!["damping_n_s_per_m".to_owned()];
        assert_eq!(Directions::of(&open).limited(), 1);
        open.spread = None;
        assert_eq!(Directions::of(&open).0.len(), 0);
    }

    #[test]
    fn no_record_makes_a_model_rebound_faster_than_it_came() {
        let with = |e: f64| {
            let mut outcome = Outcome::default();
            outcome.0[Quantity::Restitution as usize] = Some(e);
            outcome.0[Quantity::DeltaV as usize] = Some(10.0 * (1.0 + e));
            outcome
        };
        let made = |e: f64| MadeTest { coefficient_of_restitution: Some(e), ..MadeTest::default() };
        let answer = |own_e: f64, made: &MadeTest, e: f64| {
            let class = EnergyClass::Plastic;
            let own = OwnTest { outcome: with(own_e), mass_kg: 1e3, class, felt: None, made };
            let front = TestedFront { test: &own, energy_j: 1e5, mass_kg: own.mass_kg };
            let outcome = RecordFactors::new(front, None, 0.0).of(&with(e));
            [Quantity::Restitution, Quantity::DeltaV].map(|quantity| outcome.get(quantity).unwrap())
        };
        let is_near =
            |found: [f64; 2], e: f64| (found[0] - e).abs() < 1e-12 && (found[1] - 10.0 * (1.0 + e)).abs() < 1e-12;
        assert!(is_near(answer(0.15, &made(0.3), 0.2), 0.4));
        // A factor of 4 stops at 1.
        assert!(is_near(answer(0.15, &made(0.6), 0.3), 1.0));
        // A plastic model has the restitution of the record.
        assert!(is_near(answer(1e-4, &made(0.12), 3e-4), 0.12));
        assert!(is_near(answer(0.0, &made(0.12), 0.0), 0.12));
    }
}
