//! One candidate in one impact: its numbers, and the variances of each of them.

use std::collections::BTreeMap;

use crumple_lumped::{Occupant, OccupantMotion, Structure};
use crumple_lumped_fit::EnergyClass;
use rayon::prelude::*;

use crate::error::PredictError;
use crate::impact::candidate::Scenario;
use crate::impact::outcome::{Energy, Outcome, QUANTITIES, Quantity, Reach, Side, Wave, energy};
use crate::impact::partner::{CollisionOutcome, Opponent, PreparedSetup, collision};
use crate::intervals::sources::{
    HALF_WIDTH, Inputs, Interval, Place, PreparedPartner, Variances, by_extrapolation, by_inputs_of_test,
    by_masses_in_front, by_rate_effect, interval,
};
use crate::intervals::tested::{
    COARSE_S, Direction, OwnTest, RecordFactors, SAMPLING_S, STEP, Tested, TestedFront, at_crush, half_difference,
    relative,
};

/// What the test of a vehicle supports of a prediction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Support {
    /// Element, from 1, and factor of its compression beyond the tested one.
    pub beyond: Option<(usize, f64)>,
    /// Whether forces that depend on a rate are asked for beyond the tested rates.
    pub faster: bool,
    /// Directions of the parameters that the record leaves open.
    pub limited: usize,
    /// Adequate models whose difference is in the intervals.
    pub models: usize,
}

/// What a candidate says of an impact.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// Mass of the vehicle, kg.
    pub mass_kg: f64,
    /// Its numbers.
    pub outcome: Outcome,
    /// Their intervals, in the order of [`Quantity::ALL`].
    pub intervals: [Option<Interval>; QUANTITIES],
    /// Whether the record of the test answers for the peak, within what was tested; `None`: it shows none.
    pub peak_by_record: Option<bool>,
    /// The same of restitution and change of velocity.
    pub rebound_by_record: Option<bool>,
    /// Where the energy goes, of both vehicles together; `None`: it never stops.
    pub energy: Option<Energy>,
    /// The motion.
    pub wave: Wave,
    /// What a collision makes of both; `None`: the wall.
    pub collision: Option<CollisionOutcome>,
    /// The occupant's motion; `None` without one.
    pub occupant: Option<OccupantMotion>,
    /// What the test supports of it.
    pub support: Support,
    /// What the partner's test supports; `None` of a wall or a barrier.
    pub partner_support: Option<Support>,
}

/// One candidate in one impact.
pub(crate) struct Impact<'a> {
    pub tested: &'a Tested<'a>,
    pub partner: &'a PreparedPartner<'a>,
    pub setting: PreparedSetup<'a>,
    pub scenario: Scenario,
    /// Whether the answer is the mean of all models by their weights, of which this one weighs most.
    pub leads: bool,
    /// The occupant at the ends of what is not known of its restraint.
    pub occupant_ends: &'a [[Occupant; 2]],
}

/// What a front of one side makes unsure of its crush: relative standard deviations by a rate effect, by the force
/// beyond the tested crush, by masses in front of the compartment and by the inputs of its test, and the crush, m.
#[derive(Clone, Copy, Default)]
struct CrushUncertainty {
    shares: [f64; 4],
    crush_m: f64,
    /// By how much more than the crush its time, and the force at its end, depend on the force beyond the tested crush.
    late: f64,
    end: f64,
    /// That force over the peak.
    of_peak: f64,
}

/// Place of what lies beyond the tested crush among the shares.
const EXTRAPOLATION: usize = 1;

impl CrushUncertainty {
    /// By how much more than the crush a number depends on the force beyond the tested crush.
    fn beyond(&self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::TimeOfDynamicCrush => self.late,
            Quantity::Peak | Quantity::PartnerPeak => self.end * self.of_peak,
            Quantity::Restitution | Quantity::DeltaV | Quantity::PartnerDeltaV => self.end,
            _ => 1.0,
        }
    }
}

/// Energy that the fronts of an impact take, J, and the masses behind them, kg.
#[derive(Clone, Copy)]
struct Taken {
    own_j: f64,
    partner_j: f64,
    masses_kg: [f64; 2],
}

impl Taken {
    /// Of a collision; at the wall all of it.
    fn of(both: Option<&CollisionOutcome>, kinetic_j: f64, masses_kg: [f64; 2]) -> Self {
        let Some(both) = both else { return Self { own_j: kinetic_j, partner_j: 0.0, masses_kg } };
        let [own_j, partner_j] = [&both.own, &both.partner].map(|body| body.absorbed_j.unwrap_or(0.0));
        Self { own_j, partner_j, masses_kg }
    }

    fn by_record(self, own: &OwnTest<'_>, partner: Option<&OwnTest<'_>>) -> RecordFactors {
        let [own_kg, partner_kg] = self.masses_kg;
        let own = TestedFront { test: own, energy_j: self.own_j, mass_kg: own_kg };
        let partner = partner.map(|test| TestedFront { test, energy_j: self.partner_j, mass_kg: partner_kg });
        RecordFactors::new(own, partner, self.partner_j)
    }
}

/// Variance of a number among models, by their weights, about the answer. A model without it leaves its weight to those
/// of the others.
fn spread(models: &[(Outcome, f64)], quantity: Quantity, value: f64) -> f64 {
    let of = models.iter().filter_map(|(model, weight)| Some((*weight, (model.get(quantity)? - value).powi(2))));
    let (weights, squares) = of.fold((0.0, 0.0), |(sum, all), (weight, square)| (sum + weight, all + weight * square));
    if weights > 0.0 { squares * models.iter().map(|(_, weight)| weight).sum::<f64>() / weights } else { 0.0 }
}

impl Impact<'_> {
    /// The numbers with their intervals; `others` are those of the adequate models, with their weights. Errors: a
    /// response that leaves the range of numbers, no closing speed.
    pub fn prediction(
        &self,
        inputs: Inputs,
        others: &[(Outcome, &OwnTest<'_>, f64)],
    ) -> Result<Prediction, PredictError> {
        let structure = self.tested.candidate.structure(self.scenario.mass_kg)?;
        let speed = self.scenario.speed_m_per_s;
        let mass_kg: f64 = structure.masses_kg().iter().sum();
        let (model, wave) = self.setting.impact(&structure, speed, SAMPLING_S)?;
        let mut both = self.setting.opponent.map(|opponent| collision(&structure, speed, opponent)).transpose()?;
        let partner_others = self.partner_others(&structure);
        let own_speed = both.map_or(Some(speed), |both| both.own.energy_equivalent_speed_m_per_s).unwrap_or(speed);
        let own = self.support(self.tested, &structure, &wave, Side::Own, own_speed, others.len());
        let partner =
            self.partner.tested.as_ref().zip(self.setting.opponent).zip(both).map(|((tested, opponent), both)| {
                let speed = both.partner.energy_equivalent_speed_m_per_s.unwrap_or(both.closing_speed_m_per_s);
                let models = partner_others.len();
                (tested, speed, self.support(tested, &opponent.structure, &wave, Side::Partner, speed, models))
            });
        let partner_kg = self.setting.opponent.map_or(0.0, |other| other.structure.masses_kg().iter().sum());
        let taken = Taken::of(both.as_ref(), 0.5 * mass_kg * speed * speed, [mass_kg, partner_kg]);
        let partner_own = self.partner.tested.as_ref().map(|tested| &tested.own);
        let by_record = taken.by_record(&self.tested.own, partner_own);
        let outcome = by_record.of(&model);
        both.iter_mut().for_each(|both| by_record.after(both, &model));
        let [of_vehicle, of_partner] = self.by_records(taken, others, &partner_others);
        let mixed = if self.leads { mean([&of_vehicle, &of_partner], &outcome) } else { outcome };
        let others = [of_vehicle, of_partner].concat();
        let variances = self.by_parameters(&structure, &outcome);
        let by_speed = self.by_speed(&structure, inputs.speed_m_per_s);
        let by_mass = self.by_mass(mass_kg, inputs.mass_kg);
        let by_restraint = self.by_restraint(&wave);
        let known = inputs.speed_m_per_s;
        let is_beyond = [Some(own), partner.as_ref().map(|(_, _, support)| *support)]
            .map(|support| support.is_some_and(|support| support.beyond.is_some()));
        let own_doubt =
            crush_uncertainty(self.tested, (own_speed, mass_kg, known), is_beyond[0], &wave, &outcome, Side::Own);
        let partner_doubt = partner.as_ref().map_or_else(CrushUncertainty::default, |(tested, speed, _)| {
            crush_uncertainty(tested, (*speed, partner_kg, known), is_beyond[1], &wave, &outcome, Side::Partner)
        });
        // Of the model in both, since it may miss its test by more than makes another place.
        let over_tested = |tested: &Tested<'_>, crush: Option<f64>| {
            Place::of(crush.zip(tested.own.outcome.get(Quantity::DynamicCrush)).map(|(crush, tested)| crush / tested))
        };
        let places = [
            over_tested(self.tested, outcome.get(Quantity::DynamicCrush)),
            partner
                .as_ref()
                .map_or(Place::Beyond, |(tested, ..)| over_tested(tested, outcome.get(Quantity::PartnerCrush))),
        ];
        let of = |quantity: Quantity, crush_deviation: f64| {
            let value = mixed.get(quantity)?;
            let q = quantity as usize;
            let models = spread(&others, quantity, value);
            let restitution = outcome.get(Quantity::Restitution).unwrap_or(0.0);
            let [rate, force, in_front, record] = by_crush([own_doubt, partner_doubt], (quantity, value), restitution);
            let is_beyond = is_beyond[usize::from(quantity.side() == Side::Partner)];
            let misfit = self.by_misfit(quantity, &model, &outcome, is_beyond);
            // The peak that is read off the record is as unsure as the crush up to which it is read.
            let of_crush = match quantity {
                Quantity::Peak => self.tested.own.peak_by_crush(taken.own_j, crush_deviation),
                _ => 0.0,
            };
            let misfit = misfit + (of_crush * value).powi(2);
            let all: Variances =
                [variances[q], by_speed[q], by_mass[q], models, rate, force, in_front, record, by_restraint[q], misfit];
            let possible = quantity.possible(value, outcome.get(Quantity::Restitution).unwrap_or(0.0));
            let measured = match quantity.side() {
                Side::Own => self.tested.test.made.deviation_of(quantity, value),
                _ => 0.0,
            };
            let factor = places[usize::from(quantity.side() == Side::Partner)].cover_factor(quantity);
            interval(value, &all, measured, possible, (inputs.left_out, factor))
        };
        let crush = of(Quantity::DynamicCrush, 0.0).zip(mixed.get(Quantity::DynamicCrush));
        let deviation =
            crush.map_or(0.0, |(interval, crush)| 0.5 * (interval.high - interval.low) / HALF_WIDTH / crush);
        let intervals = Quantity::ALL.map(|quantity| of(quantity, deviation));
        let energy = match &both {
            Some(both) => both.energy,
            None => energy(&structure, speed, &outcome)?,
        };
        let occupant = self.setting.ride(&wave, speed)?;
        let partner_support = partner.map(|(_, _, support)| support);
        Ok(Prediction {
            mass_kg,
            outcome: mixed,
            intervals,
            peak_by_record: by_record.peak.map(|_| !is_beyond.contains(&true)),
            rebound_by_record: by_record.restitution.map(|_| !is_beyond.contains(&true)),
            energy,
            wave,
            collision: both,
            occupant,
            support: own,
            partner_support,
        })
    }

    /// The numbers of the other models of the vehicle, and of its partner, as the records leave them, with their
    /// weights.
    fn by_records(
        &self,
        taken: Taken,
        of_vehicle: &[(Outcome, &OwnTest<'_>, f64)],
        of_partner: &[(Outcome, &OwnTest<'_>, f64)],
    ) -> [Vec<(Outcome, f64)>; 2] {
        let partner_own = self.partner.tested.as_ref().map(|tested| &tested.own);
        let vehicle =
            of_vehicle.iter().map(|(other, own, weight)| (taken.by_record(own, partner_own).of(other), *weight));
        let partner = of_partner
            .iter()
            .map(|(other, own, weight)| (taken.by_record(&self.tested.own, Some(own)).of(other), *weight));
        [vehicle.collect(), partner.collect()]
    }

    fn support(
        &self,
        tested: &Tested<'_>,
        structure: &Structure,
        wave: &Wave,
        side: Side,
        speed: f64,
        models: usize,
    ) -> Support {
        let reach = Reach::new(structure, wave, side, speed);
        let faster = tested.candidate.depends_on_rate() && reach.is_faster(&tested.reach);
        Support { beyond: reach.beyond(&tested.reach), faster, limited: tested.directions.limited(), models }
    }

    /// Variance by what the model misses in its own test: of the peak that of the test, of the rebound what the record
    /// has corrected, too.
    fn by_misfit(&self, quantity: Quantity, model: &Outcome, outcome: &Outcome, beyond: bool) -> f64 {
        let Some((value, before)) = outcome.get(quantity).zip(model.get(quantity)) else { return 0.0 };
        let (tested, in_test) = match quantity.side() {
            Side::Partner => (self.partner.tested.as_ref(), quantity.of_partner()),
            _ => (Some(self.tested), quantity.of_own().filter(|other| *other == quantity)),
        };
        let restitution = outcome.get(Quantity::Restitution).unwrap_or(0.0);
        let misfit = tested.zip(in_test).map_or(0.0, |(tested, q)| value * tested.own.misfit(q, restitution, beyond));
        let is_peak = in_test == Some(Quantity::Peak);
        if is_peak { misfit.powi(2) } else { (value - before).hypot(misfit).powi(2) }
    }

    /// The numbers where the opponent is another, coarsely sampled.
    fn against(&self, structure: &Structure, opponent: Option<Opponent>) -> Option<Outcome> {
        let opponent = opponent?;
        let setting = self.setting.against(Some(&opponent));
        Some(setting.impact(structure, self.scenario.speed_m_per_s, COARSE_S).ok()?.0)
    }

    /// The numbers where the partner is another of its adequate models, with their weights.
    fn partner_others(&self, structure: &Structure) -> Vec<(Outcome, &OwnTest<'_>, f64)> {
        let Some(opponent) = self.setting.opponent else { return Vec::new() };
        let others = self.partner.others(opponent);
        others
            .into_par_iter()
            .filter_map(|(other, own, weight)| {
                let setting = self.setting.against(Some(&other));
                Some((setting.impact(structure, self.scenario.speed_m_per_s, SAMPLING_S).ok()?.0, own, weight))
            })
            .collect()
    }

    /// Variances by the parameters of both vehicles.
    fn by_parameters(&self, structure: &Structure, outcome: &Outcome) -> [f64; QUANTITIES] {
        let own = |factors: &BTreeMap<String, f64>| {
            let structure = self.tested.candidate.changed(factors, self.scenario.mass_kg)?;
            Some(self.setting.impact(&structure, self.scenario.speed_m_per_s, COARSE_S).ok()?.0)
        };
        let of_own = along_directions(self.tested, outcome, own, Quantity::of_own);
        let Some((tested, opponent)) = self.partner.tested.as_ref().zip(self.setting.opponent) else { return of_own };
        let partner =
            |factors: &BTreeMap<String, f64>| self.against(structure, self.partner.changed(opponent, factors));
        let of_partner = along_directions(tested, outcome, partner, Quantity::of_partner);
        std::array::from_fn(|q| of_own[q] + of_partner[q])
    }

    /// Variances of what becomes of the occupant by the restraint.
    fn by_restraint(&self, wave: &Wave) -> [f64; QUANTITIES] {
        let at = |occupant: &Occupant| {
            let setting = PreparedSetup { occupant: Some(occupant), ..self.setting };
            setting.with_occupant(Outcome::default(), wave, self.scenario.speed_m_per_s).ok()
        };
        let changes = self.occupant_ends.iter().map(|[up, down]| half_difference(at(up), at(down)));
        changes.fold([0.0; QUANTITIES], |sum, change| std::array::from_fn(|q| sum[q] + change[q] * change[q]))
    }

    /// Variances by the speeds of both, of each that moves.
    fn by_speed(&self, structure: &Structure, deviation: f64) -> [f64; QUANTITIES] {
        let (speed, partner_speed) = (self.scenario.speed_m_per_s, self.scenario.partner_speed_m_per_s);
        let own =
            by_step(deviation / speed, |factor| Some(self.setting.impact(structure, factor * speed, COARSE_S).ok()?.0));
        let partner = by_step(deviation / partner_speed, |factor| {
            let opponent = self.setting.opponent?.clone();
            self.against(structure, Some(Opponent { speed_m_per_s: factor * partner_speed, ..opponent }))
        });
        std::array::from_fn(|q| own[q] + partner[q])
    }

    /// Variances by the masses of both vehicles; that of a barrier is exact.
    fn by_mass(&self, mass_kg: f64, deviation: f64) -> [f64; QUANTITIES] {
        let own = by_step(deviation / mass_kg, |factor| {
            let structure = self.tested.candidate.structure(Some(factor * mass_kg)).ok()?;
            Some(self.setting.impact(&structure, self.scenario.speed_m_per_s, COARSE_S).ok()?.0)
        });
        let Some(opponent) = self.setting.opponent.filter(|_| self.partner.tested.is_some()) else { return own };
        let partner_kg: f64 = opponent.structure.masses_kg().iter().sum();
        let structure = self.tested.candidate.structure(self.scenario.mass_kg).ok();
        let partner = by_step(deviation / partner_kg, |factor| {
            self.against(structure.as_ref()?, self.partner.heavier(opponent, factor))
        });
        std::array::from_fn(|q| own[q] + partner[q])
    }
}

/// Variances of a number by what the fronts of both sides make unsure of the crush.
fn by_crush(doubts: [CrushUncertainty; 2], (quantity, value): (Quantity, f64), restitution: f64) -> [f64; 4] {
    [0, 1, 2, 3].map(|k| {
        let power = quantity.power_of_crush(restitution);
        let scaled = |doubt: &CrushUncertainty| {
            let more = if k == EXTRAPOLATION { doubt.beyond(quantity) } else { 1.0 };
            (power * more * doubt.shares[k] * value).powi(2)
        };
        match quantity.side() {
            Side::Own => scaled(&doubts[0]),
            Side::Partner => scaled(&doubts[1]),
            Side::Both => doubts.iter().map(|doubt| (doubt.shares[k] * doubt.crush_m).powi(2)).sum(),
        }
    })
}

/// The mean of the models of a vehicle by their weights, and of its partner's, each number of those that have it; where
/// there are none, the answer of one.
fn mean(models: [&[(Outcome, f64)]; 2], own: &Outcome) -> Outcome {
    let shift = |models: &[(Outcome, f64)], q: usize, own: f64| {
        let having = || models.iter().filter_map(|(outcome, weight)| Some((outcome.0[q]?, *weight)));
        let sum: f64 = having().map(|(_, weight)| weight).sum();
        if sum > 0.0 { having().map(|(x, weight)| weight * (x - own)).sum::<f64>() / sum } else { 0.0 }
    };
    Outcome(std::array::from_fn(|q| {
        own.0[q].map(|own| own + models.iter().map(|models| shift(models, q, own)).sum::<f64>())
    }))
}

/// Variances along the directions of a candidate. What the record leaves open moves the test itself too, where the
/// record holds it fast: of an open direction only what it changes beyond that counts. `in_test` names the number of
/// the test that holds a number of the impact.
fn along_directions(
    tested: &Tested<'_>,
    outcome: &Outcome,
    at: impl Fn(&BTreeMap<String, f64>) -> Option<Outcome> + Sync,
    in_test: fn(Quantity) -> Option<Quantity>,
) -> [f64; QUANTITIES] {
    let pairs: Vec<(&Direction, &[f64; QUANTITIES])> = tested.directions.0.iter().zip(&tested.changes).collect();
    let changes: Vec<[f64; QUANTITIES]> = pairs
        .into_par_iter()
        .map(|(direction, changes)| {
            let [up, down] = &direction.ends;
            let difference = half_difference(at(up), at(down));
            let here = relative(difference, outcome);
            let held = Quantity::ALL.map(|quantity| in_test(quantity).map_or(0.0, |other| changes[other as usize]));
            std::array::from_fn(|q| {
                let is_held = direction.limited || tested.own.is_by_record(Quantity::ALL[q]);
                if is_held { (here[q] - held[q]) * outcome.0[q].unwrap_or(0.0) } else { difference[q] }
            })
        })
        .collect();
    std::array::from_fn(|q| changes.iter().map(|change| change[q] * change[q]).sum())
}

/// Variances by a relative standard deviation of an input, from a difference of one percent; of an input of zero none.
fn by_step(deviation: f64, at: impl Fn(f64) -> Option<Outcome>) -> [f64; QUANTITIES] {
    if deviation == 0.0 || !deviation.is_finite() {
        return [0.0; QUANTITIES];
    }
    half_difference(at(1.0 + STEP), at(1.0 - STEP)).map(|change| (change / STEP * deviation).powi(2))
}

/// How much more the time of the crush, and the force at its end, depend on the slope of the force beyond the tested
/// crush than the crush does, and that force over the peak.
///
/// With `F` the force there, `k` an error of its slope and `d` the way from there on, the way is shorter by `k d/2F` of
/// itself, its time by `2/3` of `k d/F` (an oscillator that starts against `F`, to first order in `k`), and the force
/// at the end is larger by `k d/F`.
fn at_the_end(wave: &Wave, side: Side, outcome: &Outcome, crush_m: f64, tested_m: f64) -> (f64, f64, f64) {
    let share = 1.0 - tested_m / crush_m;
    let time_s = outcome.get(Quantity::TimeOfDynamicCrush);
    let displacements = wave.crush_of_masses(side);
    let passed = displacements.last().and_then(|of| of.iter().position(|x| *x >= tested_m));
    let late = time_s.zip(passed).map_or(1.0, |(t, k)| 4.0 / 3.0 * (1.0 - k as f64 * wave.dt_s / t) / share);
    let peak = if side == Side::Partner { Quantity::PartnerPeak } else { Quantity::Peak };
    let of_peak = at_crush(wave, side, outcome).zip(outcome.get(peak)).map_or(1.0, |(end, peak)| end / peak);
    (late.max(1.0), 2.0 / share, of_peak.clamp(0.0, 1.0))
}

/// What the front of one side makes unsure: `speed` is that of an impact on a wall with the energy it takes, `mass_kg`
/// the mass of the side; the speed of its test is known to the third number.
fn crush_uncertainty(
    tested: &Tested<'_>,
    (speed, mass_kg, known_m_per_s): (f64, f64, f64),
    beyond: bool,
    wave: &Wave,
    outcome: &Outcome,
    side: Side,
) -> CrushUncertainty {
    let candidate = tested.candidate;
    let one_mass = tested.masses == 1;
    let rate = if candidate.depends_on_rate() || candidate.rate_factor_is_fitted() {
        0.0
    } else {
        by_rate_effect(speed, tested.test.nearest_m_per_s(speed), beyond, candidate.has_rate_factor(), one_mass)
    };
    let crush = if side == Side::Partner { Quantity::PartnerCrush } else { Quantity::DynamicCrush };
    let (crush_m, tested_m) = (outcome.get(crush), tested.own.outcome.get(Quantity::DynamicCrush));
    let pair = crush_m.zip(tested_m).filter(|(crush, tested)| crush > tested && *tested > 0.0);
    let (late, end, of_peak) =
        pair.map_or((1.0, 1.0, 1.0), |(crush, tested_m)| at_the_end(wave, side, outcome, crush, tested_m));
    // By the slope of the force from the tested crush on to the one predicted.
    let extrapolation = pair.map_or(0.0, |(crush, tested_m)| {
        let ends = at_crush(wave, side, outcome).zip(tested.deceleration).filter(|(here, _)| *here > 0.0);
        let slope = ends.map_or(1.0, |(here, there)| (1.0 - there / here) / (1.0 - tested_m / crush));
        by_extrapolation(crush / tested_m, slope)
    });
    let in_front = crush_m
        .zip(tested_m)
        .filter(|(crush, _)| *crush > 0.0 && one_mass && candidate.class() == EnergyClass::Plastic)
        .map_or(0.0, |(crush, tested_m)| by_masses_in_front(crush / tested_m, mass_kg / tested.own.mass_kg));
    let record = crush_m.zip(tested_m).filter(|(crush, tested)| *crush > 0.0 && *tested > 0.0);
    let record = record
        .map_or(0.0, |(crush, tested_m)| by_inputs_of_test(tested.crush_deviation_m(known_m_per_s), crush, tested_m));
    let shares = [rate, extrapolation, in_front, record];
    CrushUncertainty { shares, crush_m: crush_m.unwrap_or(0.0), late, end, of_peak }
}
