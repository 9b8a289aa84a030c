//! A model in its own test beside what the record shows there: what it misses there, its answers elsewhere miss too.

use crumple_lumped_fit::EnergyClass;

use crate::error::PredictError;
use crate::impact::against::MadeTest;
use crate::impact::candidate::Candidate;
use crate::impact::felt::FeltOverEnergy;
use crate::impact::outcome::{Outcome, Quantity, Wave, through_cfc_60};
use crate::impact::partner::CollisionOutcome;
use crate::impact::scenario::TestedImpact;
use crate::impact::setting::Setting;

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
        let (outcome, wave) = Setting::default().impact(&structure, test.speed_m_per_s, SAMPLING_S)?;
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
    /// J; where one of them shows nothing, `None`.
    fn peak(&self, energy_j: f64) -> Option<f64> {
        let until = |felt: Option<&FeltOverEnergy>| felt?.largest_until(energy_j / self.mass_kg);
        Some(until(self.made.felt.as_ref())? / until(self.felt.as_ref())?)
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
            Quantity::Peak => self.peak(f64::INFINITY).map_or(0.0, |factor| 1.0 - 1.0 / factor),
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

/// A front in an impact: its own test, and the energy that it takes, J.
pub(crate) type TestedFront<'a> = (&'a OwnTest<'a>, f64);

/// What the records of both vehicles make of the answers of their models: each multiplied by what the record shows over
/// what the model shows in its own test. So it is the record's where the same energy is taken, and of a model that is
/// right its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RecordFactors {
    /// Factor of the peak; `None`: the record says nothing of it.
    pub peak: Option<f64>,
    /// Factor of the restitution, of at least [`LEAST_RESTITUTION`]; the product is 1 at most.
    pub restitution: Option<f64>,
    partner_peak: Option<f64>,
}

impl RecordFactors {
    /// Of the vehicle, and of its partner: a face or the wall has no test. What comes back in a collision is of each
    /// front as its share of the energy.
    pub fn new(own: TestedFront<'_>, partner: Option<TestedFront<'_>>, barrier_j: f64) -> Self {
        let peak = |(test, energy_j): TestedFront<'_>| test.peak(energy_j);
        let (factor, taken) = (own.0.restitution(), own.1);
        let other = partner.map_or((1.0, barrier_j), |(test, energy_j)| (test.restitution().unwrap_or(1.0), energy_j));
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
        let factors = [
            (Quantity::Peak, self.peak),
            (Quantity::PartnerPeak, self.partner_peak),
            (Quantity::DeltaV, Some(by_velocity)),
            (Quantity::PartnerDeltaV, Some(by_velocity)),
        ];
        for (quantity, factor) in factors {
            let value = &mut outcome.0[quantity as usize];
            *value = value.zip(factor).map(|(value, factor)| factor * value).or(*value);
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

#[cfg(test)]
mod tests {
    use super::*;

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
            let outcome = RecordFactors::new((&own, 1e5), None, 0.0).of(&with(e));
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
