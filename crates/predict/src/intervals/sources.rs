//! Everything that makes a predicted number unsure, as variances, and the interval they come to.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use crumple_lumped_fit::{ONE_MASS_RATE_S_PER_M, RATE_PRIOR_S_PER_M};

use crate::error::PredictError;
use crate::impact::candidate::{Candidate, Partner, Scenario};
use crate::impact::outcome::Quantity;
use crate::impact::partner::Opponent;
use crate::intervals::tested::{OwnTest, Tested};

/// Share of cases that an interval is to hold.
pub const INTERVAL_LEVEL: f64 = 0.9;
/// Half width of it in standard deviations of a normal distribution.
pub use crumple_signal::HALF_OF_90_PERCENT as HALF_WIDTH;
/// Standard deviation of the rate effect of vehicle structures, s/m: force grows by 0.8 +- 0.5 % per m/s (Cowper &
/// Symonds for mild steel 1.1 to 1.2 %, for crushed square tubes 0.6 %).
const RATE_DEVIATION: f64 = 0.005;
/// The same of one mass in place of a vehicle: what masses in front of the compartment take off the rate effect is
/// uncertain as well.
const ONE_MASS_DEVIATION: f64 = 0.006;
/// What a rate effect that the model lacks, or does not know better, does to crush at another speed: `2 r/3` for each
/// m/s. A curve read at one speed holds the mean factor `1 + 2 r v0/3` of that speed (one mass, constant force).
const CRUSH_BY_RATE: f64 = 2.0 / 3.0;
/// Beyond the tested crush it does 1.5 times that: towards its end the curve read at one speed is too flat.
const BEYOND_TESTED: f64 = 1.5;
/// Masses in front of the compartment, which one mass leaves out, are stopped before it: part of the early force of the
/// test is missing from its curve, another part at another speed. So the crush at lower speeds is off by 0.04 `q` +
/// 0.02 `q²`, with `q` the tested crush over this one, less 1: made cars of two and three masses, a front mass of 12 to
/// 35 %, root mean square of the error.
const IN_FRONT: [f64; 2] = [0.04, 0.02];
/// A mass that is added to the compartment is a larger share of what it stops than of the whole, by the share in front:
/// a tenth of the relative change of mass is what the crush may miss.
const IN_FRONT_BY_MASS: f64 = 0.1;
/// Standard deviation of a factor between 0 and 2 of the slope beyond the tested crush.
const SLOPE_DEVIATION: f64 = 0.577_350_269_189_625_8;

/// Standard deviations of the inputs.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Inputs {
    /// Of the impact speed, m/s.
    pub speed_m_per_s: f64,
    /// Of the mass, kg.
    pub mass_kg: f64,
    /// Root mean square of what tests that were left out were missed by, in the standard deviations of those
    /// predictions; zero where none was left out.
    pub left_out: f64,
}

/// An interval of a predicted number.
#[derive(Debug, Clone, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// What is in it.
    pub by: String,
}

/// Least share of the variance that is named.
const NAMED: f64 = 0.005;

/// What is not known, each with its name.
const SOURCES: [&str; 10] = [
    "parameters",
    "speed",
    "mass",
    "models",
    "rate effect",
    "extrapolation",
    "masses in front",
    "inputs of the test",
    "restraint",
    "misfit of the test",
];

/// Place of what the record measured no better among them.
const INPUTS_OF_TEST: usize = 7;

/// Variances of one number in the order of [`SOURCES`].
pub(crate) type Variances = [f64; 10];

/// Where an impact lies to the own test of a vehicle, by its crush.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Place {
    /// Within [`OWN_TEST`] of its crush.
    OwnTest,
    /// Below it.
    Below,
    /// Beyond it, or where nobody knows.
    Beyond,
}

/// Share by which the crush of an impact may differ from that of the test, to be its own: no record knows more.
const OWN_TEST: f64 = 0.01;

impl Place {
    /// Of an impact with this crush over that of the test; `None`: one of both does not stop.
    pub fn of(crush: Option<f64>) -> Self {
        match crush {
            Some(crush) if (crush - 1.0).abs() <= OWN_TEST => Self::OwnTest,
            Some(crush) if crush < 1.0 => Self::Below,
            _ => Self::Beyond,
        }
    }

    /// By what the half width of an interval is multiplied, so that nine in ten hold the truth where the sources do not
    /// add up to what a model misses: split conformal prediction (V. Vovk, A. Gammerman & G. Shafer, *Algorithmic
    /// Learning in a Random World*, 2005). Measured with all factors 1: 90 % quantiles of error over half width of 312
    /// made cars at 40 and 48 km/h, and at 64 and 72 km/h, that no table of the docs counts (`testkit
    /// prediction-benchmark --cars 8 --first 1000`, 2000, 3000), the mean of the three and the two, rounded up to a
    /// tenth and none below 1. A rerun prints what is missing beside them.
    pub fn cover_factor(self, quantity: Quantity) -> f64 {
        let [below, beyond] = match quantity {
            Quantity::DynamicCrush | Quantity::PartnerCrush => [1.0, 1.1],
            Quantity::TimeOfDynamicCrush => [1.1, 1.1],
            Quantity::Peak | Quantity::PartnerPeak => [1.2, 1.6],
            Quantity::DeltaV | Quantity::PartnerDeltaV | Quantity::Restitution => [1.3, 1.2],
            _ => [1.0, 1.0],
        };
        match self {
            Self::OwnTest => 1.0,
            Self::Below => below,
            Self::Beyond => beyond,
        }
    }
}

/// The interval about a value, symmetric within what is possible; `None` beyond the range of numbers. `cover_factor`:
/// see [`Place::cover_factor`].
///
/// `measured_deviation`: no number is surer than the record that it is from measured it.
///
/// Where tests that were left out were missed by more than their intervals say, `left_out` above 1, it is wider by that
/// ratio: R. T. Birge, *The Calculation of Errors by the Method of Least Squares*, Phys. Rev. 40, 1932.
pub(crate) fn interval(
    value: f64,
    variances: &Variances,
    measured_deviation: f64,
    (least, most): (f64, f64),
    (left_out, cover_factor): (f64, f64),
) -> Option<Interval> {
    let mut variances = *variances;
    let of_model: f64 = variances.iter().sum();
    variances[INPUTS_OF_TEST] += (measured_deviation * measured_deviation - of_model).max(0.0);
    let total: f64 = variances.iter().sum();
    if !(value.is_finite() && total.is_finite()) {
        return None;
    }
    let wider = left_out.max(1.0);
    let half = wider * cover_factor * HALF_WIDTH * total.sqrt();
    let shares = SOURCES.iter().zip(&variances).filter(|(_, variance)| **variance >= NAMED * total && total > 0.0);
    let shares: Vec<String> =
        shares.map(|(name, variance)| format!("{name} {:.0} %", 100.0 * variance / total)).collect();
    let mut by = match shares.len() {
        0 => "nothing that is known to be uncertain".to_owned(),
        _ => format!("{} of the variance", shares.join(", ")),
    };
    if wider > 1.0 {
        let _infallible = write!(by, "; wider by {wider:.2}, as tests that were left out were missed");
    }
    Some(Interval { low: (value - half).max(least), high: (value + half).min(most), by })
}

/// Relative standard deviation of the crush by a rate effect that the model lacks, `sqrt(r² + s²) 2/3 |v - v_test|`,
/// 1.5 times that beyond the tested crush. A model with the mean effect as a prior of its own (`has_one`) misses
/// `s` alone.
pub(crate) fn by_rate_effect(speed: f64, tested: f64, beyond: bool, has_one: bool, one_mass: bool) -> f64 {
    let (effect, deviation) =
        if one_mass { (ONE_MASS_RATE_S_PER_M, ONE_MASS_DEVIATION) } else { (RATE_PRIOR_S_PER_M, RATE_DEVIATION) };
    let size = if has_one { deviation } else { effect.hypot(deviation) };
    let factor = if beyond { BEYOND_TESTED } else { 1.0 };
    factor * CRUSH_BY_RATE * size * (speed - tested).abs()
}

/// Relative standard deviation of the crush by masses in front of the compartment that one mass leaves out: `crush` is
/// the crush over the tested one, `mass` the mass over that of the test.
pub(crate) fn by_masses_in_front(crush: f64, mass: f64) -> f64 {
    let slower = (1.0 / crush - 1.0).max(0.0);
    (slower * (IN_FRONT[0] + IN_FRONT[1] * slower)).hypot(IN_FRONT_BY_MASS * (mass - 1.0))
}

/// Relative standard deviation of the crush by what the inputs of the test leave unsure of its own, m: as much at every
/// lower crush, for time zero shifts all alike, and in proportion beyond the tested one, as by the gain.
pub(crate) fn by_inputs_of_test(deviation_m: f64, crush_m: f64, tested_m: f64) -> f64 {
    deviation_m / crush_m.min(tested_m)
}

/// Relative standard deviation of the crush by the force beyond the tested one: its slope times a factor between 0 and
/// 2.
///
/// With `F` the force at the end, `s` the slope and `d` the crush beyond the test, a factor `f` takes `(f - 1) s d²/2`
/// more energy, so the crush is `(f - 1) s d²/(2 F)` shorter. `s` is at least the mean slope `F/C`: a curve that has
/// been flat may rise. `beyond` is the ratio of the crush to the tested one, `slope` is `s C/F`.
pub(crate) fn by_extrapolation(beyond: f64, slope: f64) -> f64 {
    let share = 1.0 - 1.0 / beyond.max(1.0);
    0.5 * SLOPE_DEVIATION * slope.abs().max(1.0) * share * share
}

/// Least weight of a model that counts: what it says at most, three times the answer, moves a mean by half a percent.
const LEAST_WEIGHT: f64 = 2e-3;

/// Places of the models that a prediction is the mean of, heaviest first, and their weights, which sum to 1; none where
/// nobody chose.
pub fn weights(candidates: &[Candidate]) -> Vec<(usize, f64)> {
    let all: f64 = candidates.iter().map(|candidate| candidate.weight).sum();
    let of = |candidate: &Candidate| candidate.weight / all;
    let mut counted: Vec<(usize, f64)> =
        candidates.iter().map(of).enumerate().filter(|(_, weight)| *weight >= LEAST_WEIGHT).collect();
    counted.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let sum: f64 = counted.iter().map(|(_, weight)| weight).sum();
    counted.into_iter().map(|(k, weight)| (k, weight / sum)).collect()
}

/// The partner as every impact needs it.
pub(crate) struct PreparedPartner<'a> {
    pub partner: &'a Partner,
    /// Of a vehicle its candidate in its own test.
    pub tested: Option<Tested<'a>>,
    /// Its adequate models with their weights.
    others: Vec<(&'a Candidate, OwnTest<'a>, f64)>,
}

impl<'a> PreparedPartner<'a> {
    /// Lets a vehicle meet the wall of its test. Errors: a response that leaves the range of numbers.
    pub fn new(partner: &'a Partner) -> Result<Self, PredictError> {
        let Partner::Vehicle { candidates, place, test, .. } = partner else {
            return Ok(Self { partner, tested: None, others: Vec::new() });
        };
        let own = |(k, weight)| Some((&candidates[k], OwnTest::new(&candidates[k], test).ok()?.0, weight));
        let others = weights(candidates).into_iter().filter_map(own).collect();
        Ok(Self { partner, tested: Some(Tested::new(&candidates[*place], test)?), others })
    }

    /// The mass asked for, kg; `None`: that of its test.
    fn mass_kg(&self) -> Option<f64> {
        match self.partner {
            Partner::Vehicle { mass_kg, .. } => *mass_kg,
            _ => None,
        }
    }

    /// The opponent in a scenario; `None`: the wall. Errors: a mass that leaves its compartment none.
    pub fn opponent(&self, scenario: Scenario) -> Result<Option<Opponent>, PredictError> {
        let structure = match (self.partner, &self.tested) {
            (Partner::Barrier(structure), _) => structure.clone(),
            (_, Some(tested)) => tested.candidate.structure(self.mass_kg())?,
            _ => return Ok(None),
        };
        Ok(Some(Opponent { structure, speed_m_per_s: scenario.partner_speed_m_per_s }))
    }

    /// The opponent with some parameters multiplied by factors.
    pub fn changed(&self, opponent: &Opponent, factors: &BTreeMap<String, f64>) -> Option<Opponent> {
        let structure = self.tested.as_ref()?.candidate.changed(factors, self.mass_kg())?;
        Some(Opponent { structure, ..*opponent })
    }

    /// The opponent, if it is a vehicle, with its mass multiplied by a factor.
    pub fn heavier(&self, opponent: &Opponent, factor: f64) -> Option<Opponent> {
        let mass_kg: f64 = opponent.structure.masses_kg().iter().sum();
        let structure = self.tested.as_ref()?.candidate.structure(Some(factor * mass_kg)).ok()?;
        Some(Opponent { structure, ..*opponent })
    }

    /// The opponent as each of its adequate models, with their weights.
    pub fn others(&self, opponent: &Opponent) -> Vec<(Opponent, &OwnTest<'a>, f64)> {
        let of = |candidate: &Candidate| {
            Some(Opponent { structure: candidate.structure(self.mass_kg()).ok()?, ..*opponent })
        };
        self.others.iter().filter_map(|(candidate, own, weight)| Some((of(candidate)?, own, *weight))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_lumped::{Kelvin, Model};

    #[test]
    fn an_interval_is_as_wide_as_the_root_of_its_variances() {
        let within = (0.0, f64::INFINITY);
        let variances = [9e-4, 0.0, 0.0, 16e-4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let own = interval(0.5, &variances, 0.03, within, (0.0, 1.0)).unwrap();
        // 5 % of standard deviation.
        assert!((own.high - 0.5 - HALF_WIDTH * 0.05).abs() < 1e-12 && (own.low + own.high - 1.0).abs() < 1e-12);
        assert_eq!(own.by, "parameters 36 %, models 64 % of the variance");
        // The record measured it no better than to 0.1.
        let measured = interval(0.5, &variances, 0.1, within, (0.0, 1.0)).unwrap();
        assert!((measured.high - 0.5 - HALF_WIDTH * 0.1).abs() < 1e-12, "{measured:?}");
        assert_eq!(measured.by, "parameters 9 %, models 16 %, inputs of the test 75 % of the variance");
        let ends = interval(0.9, &[1.0; 10], 0.0, (0.0, 1.0), (0.0, 1.0)).map(|interval| (interval.low, interval.high));
        assert_eq!(ends, Some((0.0, 1.0)));
        let wider =
            interval(0.5, &variances, 0.03, within, (0.0, Place::of(Some(0.7)).cover_factor(Quantity::Peak))).unwrap();
        assert!((wider.high - 0.5 - 1.2 * HALF_WIDTH * 0.05).abs() < 1e-12, "{wider:?}");
        let places = [Some(0.98), Some(1.005), Some(1.02), None].map(Place::of);
        assert_eq!(places, [Place::Below, Place::OwnTest, Place::Beyond, Place::Beyond]);
        assert_eq!(Place::OwnTest.cover_factor(Quantity::Peak), 1.0);
        assert_eq!(interval(f64::NAN, &[0.0; 10], 0.0, within, (0.0, 1.0)), None);
    }

    #[test]
    fn the_rate_effect_of_one_percent_is_that_of_a_constant_force() {
        // At r = 1 %, 40 km/h after 56: a rate-free curve errs by 3 % of crush; here r is the root of 0.8^2 + 0.5^2 %.
        let at_40 = by_rate_effect(40.0 / 3.6, 56.0 / 3.6, false, false, false);
        assert!((at_40 - 0.89e-4_f64.sqrt() * 2.0 / 3.0 * 16.0 / 3.6).abs() < 1e-12, "{at_40}");
        assert_eq!(by_rate_effect(15.0, 15.0, true, false, true), 0.0);
        // Beyond the tested crush 1.5 times that.
        let beyond = by_rate_effect(40.0 / 3.6, 56.0 / 3.6, true, false, false);
        assert!((beyond / at_40 - 1.5).abs() < 1e-12, "{beyond}");
        // One mass with the prior of its own: 0.6 %.
        let of_one = by_rate_effect(40.0 / 3.6, 56.0 / 3.6, false, true, true);
        assert!((of_one / at_40 - 0.6 / 0.89_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn what_stands_in_front_is_missed_at_lower_crush_and_at_other_masses() {
        assert_eq!(by_masses_in_front(1.3, 1.0), 0.0);
        // Half of the crush: 4 + 2 %; a fifth less mass at the same crush: 2 %.
        assert!((by_masses_in_front(0.5, 1.0) - 0.06).abs() < 1e-12);
        assert!((by_masses_in_front(1.0, 0.8) - 0.02).abs() < 1e-12);
    }

    #[test]
    fn a_flat_end_and_a_steep_one_differ_as_the_slope() {
        assert_eq!(by_extrapolation(0.9, 3.0), 0.0);
        assert!((by_extrapolation(1.25, 2.0) - 0.5 * SLOPE_DEVIATION * 2.0 * 0.04).abs() < 1e-12);
        assert_eq!(by_extrapolation(1.25, 0.0), by_extrapolation(1.25, 1.0));
    }

    #[test]
    fn models_count_by_their_weight_and_one_of_a_thousandth_does_not() {
        let candidate = |weight: f64| Candidate {
            id: "kelvin/direct-fit/1".to_owned(),
            model: Ok(Model::Kelvin(Kelvin { mass_kg: 1.0, stiffness_n_per_m: 1.0, damping_n_s_per_m: 1.0 })),
            spread: None,
            weight,
        };
        let shares = weights(&[0.1, 0.0, 0.3, 1e-4].map(candidate));
        assert_eq!(shares.iter().map(|(k, _)| *k).collect::<Vec<_>>(), [2, 0]);
        assert!((shares[0].1 - 0.75).abs() < 1e-12 && (shares[1].1 - 0.25).abs() < 1e-12, "{shares:?}");
        assert!(weights(&[candidate(0.0)]).is_empty());
    }
}
