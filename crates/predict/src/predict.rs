//! Predictions of several candidates for several impacts.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::error::PredictError;
use crate::impact::candidate::Candidate;
use crate::impact::outcome::{Energy, Outcome, Quantity, Wave, energy, impact};
use crate::impact::reach::Reach;
use crate::intervals::directions::{Direction, Directions};
use crate::intervals::models::weights;
use crate::intervals::sources::{Inputs, Interval, Variances, by_extrapolation, by_rate_effect, interval};

/// Sampling interval of the waves, s: 10 kHz, as a laboratory records.
const SAMPLING_S: f64 = 1e-4;
/// Sampling interval of impacts that only a difference is taken of.
const COARSE_S: f64 = 2e-4;
/// Relative step of speed and mass for their derivatives.
const STEP: f64 = 0.01;

/// The test that the candidates are from; of several the one with the deepest crush.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TestedImpact {
    /// Its impact speed, m/s.
    pub speed_m_per_s: f64,
    /// Slowest and fastest test, m/s; of one test its speed twice.
    pub range_m_per_s: (f64, f64),
}

/// An impact to be predicted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scenario {
    /// Impact speed, m/s, positive.
    pub speed_m_per_s: f64,
    /// Mass of the vehicle, kg; `None`: that of the test.
    pub mass_kg: Option<f64>,
}

/// What a candidate says of an impact.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// Mass of the vehicle, kg.
    pub mass_kg: f64,
    /// Its numbers.
    pub outcome: Outcome,
    /// Their intervals, in the order of [`Quantity::ALL`].
    pub intervals: [Option<Interval>; 6],
    /// Where the energy goes; `None`: it never stops.
    pub energy: Option<Energy>,
    /// The motion.
    pub wave: Wave,
    /// Element, from 1, and factor of its compression beyond the tested one.
    pub beyond: Option<(usize, f64)>,
    /// Whether forces that depend on a rate are asked for beyond the tested rates.
    pub faster: bool,
    /// Directions of its parameters that the record leaves open.
    pub limited: usize,
    /// Adequate models whose difference is in the intervals.
    pub models: usize,
}

/// The candidate in the test itself.
struct AtTest {
    reach: Reach,
    outcome: Outcome,
    /// Largest force over the mass at the end of the crush, m/s².
    deceleration: Option<f64>,
    /// For each direction the relative changes of the numbers in the test.
    changes: Vec<[f64; 6]>,
}

/// Lets every candidate named by its place meet every impact: for each impact, in their order, what each of the named
/// says, in theirs.
///
/// Intervals of a candidate are about its own value: parameters and inputs by differences of one standard deviation,
/// the other adequate models by their weighted mean square distance from it. Deterministic for any number of threads.
pub fn predict(
    candidates: &[Candidate],
    named: &[usize],
    test: TestedImpact,
    inputs: Inputs,
    scenarios: &[Scenario],
) -> Vec<Vec<Result<Prediction, PredictError>>> {
    let weights = weights(candidates);
    let prepared: Vec<(Directions, Result<AtTest, PredictError>)> = named
        .par_iter()
        .map(|k| {
            let directions = Directions::of(&candidates[*k]);
            let at_test = AtTest::new(&candidates[*k], &directions, test);
            (directions, at_test)
        })
        .collect();
    scenarios
        .par_iter()
        .map(|scenario| {
            let others: Vec<(Outcome, f64)> = weights
                .par_iter()
                .filter_map(|(k, weight)| {
                    let structure = candidates[*k].structure(scenario.mass_kg).ok()?;
                    Some((impact(&structure, scenario.speed_m_per_s, SAMPLING_S).ok()?.0, *weight))
                })
                .collect();
            named
                .par_iter()
                .zip(&prepared)
                .map(|(k, (directions, at_test))| {
                    let at_test = at_test.as_ref().map_err(Clone::clone)?;
                    let one = Impact { candidate: &candidates[*k], directions, at_test, scenario: *scenario, test };
                    one.prediction(inputs, &others)
                })
                .collect()
        })
        .collect()
}

impl AtTest {
    fn new(candidate: &Candidate, directions: &Directions, test: TestedImpact) -> Result<Self, PredictError> {
        let structure = candidate.structure(None)?;
        let speed = test.speed_m_per_s;
        let (outcome, wave) = impact(&structure, speed, SAMPLING_S)?;
        let own = Scenario { speed_m_per_s: speed, mass_kg: None };
        let changes = directions
            .0
            .par_iter()
            .map(|direction| if direction.limited { relative(candidate, own, direction, &outcome) } else { [0.0; 6] })
            .collect();
        Ok(Self {
            reach: Reach::new(&structure, &wave, speed),
            deceleration: at_crush(&wave, &outcome),
            outcome,
            changes,
        })
    }
}

/// Deceleration of the compartment at its dynamic crush, m/s².
fn at_crush(wave: &Wave, outcome: &Outcome) -> Option<f64> {
    let sample = (outcome.get(Quantity::TimeOfDynamicCrush)? / wave.dt_s) as usize;
    wave.compartment()?.acceleration_m_per_s2.get(sample).map(|a| -a)
}

/// Half the difference of the numbers between both ends of a direction.
fn difference(candidate: &Candidate, scenario: Scenario, direction: &Direction) -> [f64; 6] {
    let at = |factors: &BTreeMap<String, f64>| {
        let structure = candidate.changed(factors, scenario.mass_kg).ok()?;
        Some(impact(&structure, scenario.speed_m_per_s, COARSE_S).ok()?.0)
    };
    let [up, down] = &direction.ends;
    half_difference(at(up), at(down))
}

fn half_difference(up: Option<Outcome>, down: Option<Outcome>) -> [f64; 6] {
    let (up, down) = (up.unwrap_or_default(), down.unwrap_or_default());
    std::array::from_fn(|q| up.0[q].zip(down.0[q]).map_or(0.0, |(up, down)| 0.5 * (up - down)))
}

/// The same over the numbers themselves.
fn relative(candidate: &Candidate, scenario: Scenario, direction: &Direction, outcome: &Outcome) -> [f64; 6] {
    let changes = difference(candidate, scenario, direction);
    std::array::from_fn(|q| outcome.0[q].filter(|value| *value != 0.0).map_or(0.0, |value| changes[q] / value))
}

/// One candidate in one impact.
struct Impact<'a> {
    candidate: &'a Candidate,
    directions: &'a Directions,
    at_test: &'a AtTest,
    scenario: Scenario,
    test: TestedImpact,
}

impl Impact<'_> {
    fn prediction(&self, inputs: Inputs, others: &[(Outcome, f64)]) -> Result<Prediction, PredictError> {
        let structure = self.candidate.structure(self.scenario.mass_kg)?;
        let speed = self.scenario.speed_m_per_s;
        let mass_kg: f64 = structure.masses_kg().iter().sum();
        let (outcome, wave) = impact(&structure, speed, SAMPLING_S)?;
        let reach = Reach::new(&structure, &wave, speed);
        let beyond = reach.beyond(&self.at_test.reach);
        let faster = self.candidate.depends_on_rate() && reach.is_faster(&self.at_test.reach);
        let by_parameters = self.by_parameters(&outcome);
        let by_speed = self.by_step(inputs.speed_m_per_s / speed, |scenario, factor| Scenario {
            speed_m_per_s: factor * scenario.speed_m_per_s,
            ..scenario
        });
        let by_mass = self.by_step(inputs.mass_kg / mass_kg, |scenario, factor| Scenario {
            mass_kg: Some(factor * mass_kg),
            ..scenario
        });
        let by_crush = [self.by_rate_effect(beyond.is_some()), self.by_extrapolation(&wave, &outcome)];
        let intervals = Quantity::ALL.map(|quantity| {
            let value = outcome.get(quantity)?;
            let q = quantity as usize;
            let models =
                others.iter().filter_map(|(other, weight)| Some(weight * (other.get(quantity)? - value).powi(2)));
            let of_crush = by_crush.map(|share| (quantity.power_of_crush() * share * value).powi(2));
            let variances: Variances =
                [by_parameters[q], by_speed[q], by_mass[q], models.sum(), of_crush[0], of_crush[1]];
            interval(value, &variances)
        });
        let energy = energy(&structure, speed, &outcome)?;
        let (limited, models) = (self.directions.limited(), others.len());
        Ok(Prediction { mass_kg, outcome, intervals, energy, wave, beyond, faster, limited, models })
    }

    /// Variances by the parameters. What the record leaves open moves the test itself too, where the record holds it
    /// fast: of an open direction only what it changes beyond that counts.
    fn by_parameters(&self, outcome: &Outcome) -> [f64; 6] {
        let pairs: Vec<(&Direction, &[f64; 6])> = self.directions.0.iter().zip(&self.at_test.changes).collect();
        let changes: Vec<[f64; 6]> = pairs
            .into_par_iter()
            .map(|(direction, in_test)| {
                if !direction.limited {
                    return difference(self.candidate, self.scenario, direction);
                }
                let here = relative(self.candidate, self.scenario, direction, outcome);
                std::array::from_fn(|q| (here[q] - in_test[q]) * outcome.0[q].unwrap_or(0.0))
            })
            .collect();
        std::array::from_fn(|q| changes.iter().map(|change| change[q] * change[q]).sum())
    }

    /// Variances by a relative standard deviation of an input, from a difference of one percent.
    fn by_step(&self, deviation: f64, stepped: impl Fn(Scenario, f64) -> Scenario) -> [f64; 6] {
        if deviation == 0.0 {
            return [0.0; 6];
        }
        let at = |factor: f64| {
            let scenario = stepped(self.scenario, factor);
            let structure = self.candidate.structure(scenario.mass_kg).ok()?;
            Some(impact(&structure, scenario.speed_m_per_s, COARSE_S).ok()?.0)
        };
        half_difference(at(1.0 + STEP), at(1.0 - STEP)).map(|change| (change / STEP * deviation).powi(2))
    }

    fn by_rate_effect(&self, beyond: bool) -> f64 {
        if self.candidate.depends_on_rate() || self.candidate.rate_factor_is_fitted() {
            return 0.0;
        }
        let has_one = self.candidate.has_rate_factor();
        let (speed, (slowest, fastest)) = (self.scenario.speed_m_per_s, self.test.range_m_per_s);
        by_rate_effect(speed, speed.max(slowest).min(fastest), beyond, has_one)
    }

    /// By the slope of the force from the tested crush on to the one predicted.
    fn by_extrapolation(&self, wave: &Wave, outcome: &Outcome) -> f64 {
        let crush = outcome.get(Quantity::DynamicCrush).zip(self.at_test.outcome.get(Quantity::DynamicCrush));
        let Some((crush, tested)) = crush.filter(|(crush, tested)| crush > tested && *tested > 0.0) else { return 0.0 };
        let ends = at_crush(wave, outcome).zip(self.at_test.deceleration).filter(|(here, _)| *here > 0.0);
        let slope = ends.map_or(1.0, |(here, there)| (1.0 - there / here) / (1.0 - tested / crush));
        by_extrapolation(crush / tested, slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::impact::candidate::ParameterSpread;

    fn elastoplastic(difference: Option<f64>) -> Candidate {
        let names = ["loading_stiffness_n_per_m", "unloading_stiffness_n_per_m"].map(str::to_owned);
        Candidate {
            id: "elastoplastic/closed-form/1".to_owned(),
            model: "elastoplastic".to_owned(),
            parameters: [("mass_kg".to_owned(), 1000.0), (names[0].clone(), 4e5), (names[1].clone(), 1.6e7)].into(),
            spread: Some(ParameterSpread {
                standard_deviation: names.iter().cloned().zip([4e3, 1.6e6]).collect(),
                order: names.to_vec(),
                correlation: vec![vec![1.0, 0.0], vec![0.0, 1.0]],
                open: Vec::new(),
            }),
            difference,
        }
    }

    fn stiffer() -> Candidate {
        let mut other = elastoplastic(Some(0.0));
        "elastoplastic/direct-fit/1".clone_into(&mut other.id);
        other.parameters.insert("loading_stiffness_n_per_m".to_owned(), 4.4e5);
        other
    }

    const TEST: TestedImpact = TestedImpact { speed_m_per_s: 15.0, range_m_per_s: (15.0, 15.0) };

    fn at(candidates: &[Candidate], inputs: Inputs, speed: f64, mass_kg: Option<f64>) -> Prediction {
        let scenario = Scenario { speed_m_per_s: speed, mass_kg };
        predict(candidates, &[0], TEST, inputs, &[scenario])[0][0].clone().unwrap()
    }

    fn half_width(prediction: &Prediction) -> f64 {
        let interval = prediction.intervals[0].as_ref().unwrap();
        0.5 * (interval.high - interval.low) / prediction.outcome.0[0].unwrap()
    }

    #[test]
    fn a_linear_curve_scales_with_the_speed_and_the_root_of_the_mass() {
        let one = [elastoplastic(Some(0.0))];
        let crush = |speed, mass| at(&one, Inputs::default(), speed, mass).outcome.0[0].unwrap();
        let tested = crush(15.0, None);
        assert!((tested - 15.0 * f64::sqrt(1000.0 / 4e5)).abs() < 1e-9);
        assert!((crush(7.5, None) - 0.5 * tested).abs() < 1e-9);
        assert!((crush(15.0, Some(4000.0)) - 2.0 * tested).abs() < 1e-9);
    }

    #[test]
    fn the_tested_impact_extrapolates_nothing_and_a_faster_one_does() {
        let one = [elastoplastic(Some(0.0))];
        let own = at(&one, Inputs::default(), 15.0, None);
        assert_eq!((own.beyond, own.faster), (None, false));
        let faster = at(&one, Inputs::default(), 18.0, None);
        let (element, factor) = faster.beyond.unwrap();
        assert!(element == 1 && (factor - 1.2).abs() < 1e-3, "{factor}");
        assert!(at(&one, Inputs::default(), 15.0, Some(1200.0)).beyond.is_some());
        assert_eq!(at(&one, Inputs::default(), 12.0, None).beyond, None);
    }

    #[test]
    fn intervals_widen_with_extrapolation_and_with_other_models() {
        let one = [elastoplastic(Some(0.0))];
        let widths: Vec<f64> =
            [15.0, 17.0, 20.0].iter().map(|v| half_width(&at(&one, Inputs::default(), *v, None))).collect();
        // In the test: 1 % of stiffness is 0.5 % of crush, 1.645 of these.
        assert!((widths[0] - 0.00822).abs() < 1e-4, "{widths:?}");
        assert!(widths[0] < widths[1] && widths[1] < widths[2], "{widths:?}");
        let two = [elastoplastic(Some(0.0)), stiffer()];
        let spread = half_width(&at(&two, Inputs::default(), 15.0, None));
        // Half of the weight on a model whose crush is 1/sqrt(1.1) of this: 4.65 %, times sqrt(0.5).
        let expected = 1.644_853_6 * f64::hypot(0.005, (1.0 - 1.1_f64.powf(-0.5)) * 0.5_f64.sqrt());
        assert!((spread - expected).abs() < 2e-4, "{spread}, expected {expected}");
        let inputs = Inputs { speed_m_per_s: 0.15, mass_kg: 0.0 };
        // Crush goes as the speed: 1 % of it.
        let with_speed = half_width(&at(&one, inputs, 15.0, None));
        assert!((with_speed - 1.644_853_6 * f64::hypot(0.005, 0.01)).abs() < 2e-4, "{with_speed}");
    }

    #[test]
    fn an_open_parameter_that_the_test_holds_fast_is_no_doubt_of_its_crush() {
        let mut open = elastoplastic(Some(0.0));
        let spread = open.spread.as_mut().unwrap();
        spread.standard_deviation.insert("loading_stiffness_n_per_m".to_owned(), 4e6);
        let prediction = at(&[open], Inputs::default(), 12.0, None);
        assert_eq!(prediction.limited, 1);
        // A linear curve: the open stiffness moves the crush of both impacts alike, the rate effect is left.
        let left = 1.644_853_6 * by_rate_effect(12.0, 15.0, false, false);
        assert!((half_width(&prediction) - left).abs() < 1e-3, "{}", half_width(&prediction));
    }

    #[test]
    fn a_mass_below_that_in_front_of_the_compartment_is_refused() {
        let scenario = Scenario { speed_m_per_s: 15.0, mass_kg: Some(0.0) };
        let results = predict(&[elastoplastic(None)], &[0], TEST, Inputs::default(), &[scenario]);
        assert!(matches!(results[0][0], Err(PredictError::Mass { .. })));
    }
}
