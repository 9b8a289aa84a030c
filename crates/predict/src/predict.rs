//! Predictions of several candidates for several impacts.

use rayon::prelude::*;

use crate::error::PredictError;
use crate::impact::candidate::{Candidate, ImpactSetup, Scenario, TestedImpact};
use crate::impact::outcome::Outcome;
use crate::impact::partner::PreparedSetup;
use crate::intervals::prediction::{Impact, Prediction};
use crate::intervals::sources::{Inputs, PreparedPartner, weights};
use crate::intervals::tested::{OwnTest, SAMPLING_S, Tested};

/// Lets every candidate named by its place meet every impact: for each impact, in their order, what each of the named
/// says, in theirs.
///
/// Intervals of a candidate are about its own value: parameters and inputs by differences of one standard deviation,
/// the other adequate models by their weighted mean square distance from it; of a partner that is a vehicle likewise.
/// Deterministic for any number of threads.
pub fn predict(
    candidates: &[Candidate],
    named: &[usize],
    test: &TestedImpact,
    inputs: Inputs,
    scenarios: &[Scenario],
    setup: &ImpactSetup,
) -> Vec<Vec<Result<Prediction, PredictError>>> {
    let prepared: Vec<Result<Tested<'_>, PredictError>> =
        named.par_iter().map(|k| Tested::new(&candidates[*k], test)).collect();
    let weights = weights(candidates);
    let heaviest = weights.first().map(|(k, _)| *k);
    let weighted: Vec<(&Candidate, OwnTest<'_>, f64)> = weights
        .into_par_iter()
        .filter_map(|(k, weight)| Some((&candidates[k], OwnTest::new(&candidates[k], test).ok()?.0, weight)))
        .collect();
    let partner = PreparedPartner::new(&setup.partner);
    let all_of = |scenario: &Scenario| -> Result<Vec<_>, PredictError> {
        let partner = partner.as_ref().map_err(Clone::clone)?;
        let opponent = partner.opponent(*scenario)?;
        let setting = PreparedSetup { opponent: opponent.as_ref(), occupant: setup.occupant.as_ref() };
        let others: Vec<(Outcome, &OwnTest<'_>, f64)> = weighted
            .par_iter()
            .filter_map(|(candidate, own, weight)| {
                let structure = candidate.structure(scenario.mass_kg).ok()?;
                Some((setting.impact(&structure, scenario.speed_m_per_s, SAMPLING_S).ok()?.0, own, *weight))
            })
            .collect();
        Ok(prepared
            .par_iter()
            .zip(named)
            .map(|(tested, place)| {
                let tested = tested.as_ref().map_err(Clone::clone)?;
                let occupant_ends = &setup.occupant_ends;
                Impact { tested, partner, setting, scenario: *scenario, leads: heaviest == Some(*place), occupant_ends }
                    .prediction(inputs, &others)
            })
            .collect())
    };
    scenarios
        .par_iter()
        .map(|scenario| all_of(scenario).unwrap_or_else(|error| named.iter().map(|_| Err(error.clone())).collect()))
        .collect()
}

#[cfg(test)]
mod tests {
    use crumple_lumped::{Elastoplastic, LumpedError, Model, ModelKind};
    use crumple_signal::Sampled;

    use super::*;

    use crate::impact::candidate::ParameterSpread;
    use crate::impact::candidate::Partner;
    use crate::impact::made_test::MadeTest;
    use crate::impact::outcome::Quantity;
    use crate::intervals::sources::{by_masses_in_front, by_rate_effect};

    const MODEL: Model = Model::Elastoplastic(Elastoplastic {
        mass_kg: 1000.0,
        loading_stiffness_n_per_m: 4e5,
        unloading_stiffness_n_per_m: 1.6e7,
        release: true,
    });
    const MISSING: LumpedError = LumpedError::Diverges { model: ModelKind::Elastoplastic, time_s: 0.0 };

    fn elastoplastic(weight: f64) -> Candidate {
        let names = ["loading_stiffness_n_per_m", "unloading_stiffness_n_per_m"].map(str::to_owned);
        Candidate {
            id: "elastoplastic/closed-form/1".to_owned(),
            model: Ok(MODEL),
            spread: Some(ParameterSpread {
                standard_deviation: names.iter().cloned().zip([4e3, 1.6e6]).collect(),
                order: names.to_vec(),
                correlation: vec![vec![1.0, 0.0], vec![0.0, 1.0]],
                open: Vec::new(),
            }),
            weight,
        }
    }

    fn stiffer() -> Candidate {
        let mut other = elastoplastic(1.0);
        "elastoplastic/direct-fit/1".clone_into(&mut other.id);
        other.model = MODEL.changed([("loading_stiffness_n_per_m", 4.4e5)]).ok_or(MISSING);
        other
    }

    fn test() -> TestedImpact {
        TestedImpact::new(15.0, [])
    }

    fn at(candidates: &[Candidate], inputs: Inputs, speed: f64, mass_kg: Option<f64>) -> Prediction {
        let scenario = Scenario { speed_m_per_s: speed, partner_speed_m_per_s: 0.0, mass_kg };
        predict(candidates, &[0], &test(), inputs, &[scenario], &ImpactSetup::default())[0][0].clone().unwrap()
    }

    fn half_width(prediction: &Prediction) -> f64 {
        let interval = prediction.intervals[0].as_ref().unwrap();
        0.5 * (interval.high - interval.low) / prediction.outcome.0[0].unwrap()
    }

    #[test]
    fn a_linear_curve_scales_with_the_speed_and_the_root_of_the_mass() {
        let one = [elastoplastic(1.0)];
        let crush = |speed, mass| at(&one, Inputs::default(), speed, mass).outcome.0[0].unwrap();
        let tested = crush(15.0, None);
        assert!((tested - 15.0 * f64::sqrt(1000.0 / 4e5)).abs() < 1e-9);
        assert!((crush(7.5, None) - 0.5 * tested).abs() < 1e-9);
        assert!((crush(15.0, Some(4000.0)) - 2.0 * tested).abs() < 1e-9);
    }

    #[test]
    fn the_tested_impact_extrapolates_nothing_and_a_faster_one_does() {
        let one = [elastoplastic(1.0)];
        let own = at(&one, Inputs::default(), 15.0, None);
        assert_eq!((own.support.beyond, own.support.faster), (None, false));
        let faster = at(&one, Inputs::default(), 18.0, None);
        let (element, factor) = faster.support.beyond.unwrap();
        assert!(element == 1 && (factor - 1.2).abs() < 1e-3, "{factor}");
        assert!(at(&one, Inputs::default(), 15.0, Some(1200.0)).support.beyond.is_some());
        assert_eq!(at(&one, Inputs::default(), 12.0, None).support.beyond, None);
    }

    #[test]
    fn intervals_widen_with_extrapolation_and_with_other_models() {
        let one = [elastoplastic(1.0)];
        let widths: Vec<f64> =
            [15.0, 17.0, 20.0].iter().map(|v| half_width(&at(&one, Inputs::default(), *v, None))).collect();
        // In the test: 1 % of stiffness is 0.5 % of crush, 1.645 of these.
        assert!((widths[0] - 0.00822).abs() < 1e-4, "{widths:?}");
        assert!(widths[0] < widths[1] && widths[1] < widths[2], "{widths:?}");
        let two = [elastoplastic(1.0), stiffer()];
        let both = at(&two, Inputs::default(), 15.0, None);
        // The answer is the mean of two models of one weight, of which one has 1/sqrt(1.1) of the crush of the other.
        let (other, spread) = (1.1_f64.powf(-0.5), half_width(&both));
        let mean = 0.5 * (1.0 + other);
        let own = at(&one, Inputs::default(), 15.0, None).outcome.0[0].unwrap();
        assert!((both.outcome.0[0].unwrap() / own - mean).abs() < 1e-6);
        let expected = 1.644_853_6 * f64::hypot(0.005, 0.5 * (1.0 - other)) / mean;
        assert!((spread - expected).abs() < 2e-4, "{spread}, expected {expected}");
        let inputs = Inputs { speed_m_per_s: 0.15, ..Inputs::default() };
        // Crush goes as the speed: 1 % of it.
        let with_speed = half_width(&at(&one, inputs, 15.0, None));
        assert!((with_speed - 1.644_853_6 * f64::hypot(0.005, 0.01)).abs() < 2e-4, "{with_speed}");
    }

    #[test]
    fn a_prediction_is_as_unsure_as_the_record_that_it_is_from() {
        let one = [elastoplastic(1.0)];
        let test = test().with_crush_deviation(0.01);
        let half = |inputs: Inputs, speed: f64| {
            let scenario = Scenario { speed_m_per_s: speed, partner_speed_m_per_s: 0.0, mass_kg: None };
            let predicted = predict(&one, &[0], &test, inputs, &[scenario], &ImpactSetup::default());
            half_width(predicted[0][0].as_ref().unwrap())
        };
        // 0.5 % by the stiffness and 10 mm of 0.75 m.
        let tested = half(Inputs::default(), 15.0);
        let crush = 15.0 * f64::sqrt(1000.0 / 4e5);
        assert!((tested - 1.644_853_6 * f64::hypot(0.005, 0.01 / crush)).abs() < 2e-4, "{tested}");
        // The same 10 mm of a shorter crush.
        let known = half_width(&at(&one, Inputs::default(), 10.0, None)) / 1.644_853_6;
        let slower = half(Inputs::default(), 10.0);
        assert!((slower - 1.644_853_6 * known.hypot(0.01 / crush * 1.5)).abs() < 2e-4, "{slower}");
        // An error of the speed of the test, which shifts the record by pi/2 of it, shifts what is asked by pi/2 - 1.
        let inputs = Inputs { speed_m_per_s: 0.1, ..Inputs::default() };
        let by_speed = 0.1 / 15.0;
        let record = (0.01 / crush).powi(2) - by_speed * by_speed * (std::f64::consts::PI - 1.0);
        let expected = 1.644_853_6 * (0.005_f64.powi(2) + by_speed * by_speed + record).sqrt();
        let with_speed = half(inputs, 15.0);
        assert!((with_speed - expected).abs() < 2e-4, "{with_speed}, expected {expected}");
        // Tests that were left out were missed by twice their standard deviations.
        assert!((half(Inputs { left_out: 2.0, ..Inputs::default() }, 15.0) - 2.0 * tested).abs() < 1e-12);
        assert_eq!(half(Inputs { left_out: 0.5, ..Inputs::default() }, 15.0), tested);
    }

    /// A test of another structure than the candidate, as its record shows it.
    fn recorded() -> TestedImpact {
        let truth = at(&[true_car()], Inputs::default(), 15.0, None);
        let velocity = truth.wave.compartment().unwrap().velocity_m_per_s.clone();
        let made = MadeTest {
            dynamic_crush_m: truth.outcome.get(Quantity::DynamicCrush),
            coefficient_of_restitution: truth.outcome.get(Quantity::Restitution),
            ..MadeTest::default()
        };
        test().with_measured(made.with_velocity(15.0, &Sampled::new(0.0, 1e-4, velocity).unwrap(), false))
    }

    fn true_car() -> Candidate {
        let mut car = stiffer();
        car.model = car.model.and_then(|m| m.changed([("unloading_stiffness_n_per_m", 1.2e7)]).ok_or(MISSING));
        car
    }

    #[test]
    fn the_record_answers_for_peak_and_rebound_and_what_the_model_missed_is_in_the_interval() {
        let test = recorded();
        for speed in [15.0, 10.0] {
            let scenario = Scenario { speed_m_per_s: speed, partner_speed_m_per_s: 0.0, mass_kg: None };
            let one = [elastoplastic(1.0)];
            let predicted = predict(&one, &[0], &test, Inputs::default(), &[scenario], &ImpactSetup::default());
            let predicted = predicted[0][0].as_ref().unwrap();
            let truth = at(&[true_car()], Inputs::default(), speed, None).outcome;
            let model = at(&one, Inputs::default(), speed, None).outcome;
            assert_eq!((predicted.peak_by_record, predicted.rebound_by_record), (Some(true), Some(true)));
            // Linear curves: peak in proportion to the speed, restitution the same. The deceleration of a record is the
            // slope of its velocity between samples of 0.1 ms.
            for (quantity, tolerance) in
                [(Quantity::Peak, 2e-3), (Quantity::Restitution, 1e-9), (Quantity::DeltaV, 1e-9)]
            {
                let value = |of: &Outcome| of.get(quantity).unwrap();
                let (answer, expected) = (value(&predicted.outcome), value(&truth));
                assert!((answer / expected - 1.0).abs() < tolerance, "{quantity:?}: {answer}, expected {expected}");
                let interval = predicted.intervals[quantity as usize].as_ref().unwrap();
                assert!(interval.low < value(&model) && value(&model) < interval.high, "{quantity:?}: {interval:?}");
                assert!(interval.by.contains("misfit of the test"), "{}", interval.by);
            }
            // The crush stays the model's, and is off by what it is off in the test.
            assert_eq!(predicted.outcome.0[0], model.0[0]);
            let known = half_width(&at(&one, Inputs::default(), speed, None)) / 1.644_853_6;
            let wider = half_width(predicted) / 1.644_853_6;
            assert!((wider - known.hypot(1.1_f64.sqrt() - 1.0)).abs() < 1e-3, "{wider}, {known}");
        }
    }

    #[test]
    fn beyond_the_test_the_model_answers_and_of_several_tests_no_record_does() {
        let scenario = Scenario { speed_m_per_s: 18.0, partner_speed_m_per_s: 0.0, mass_kg: None };
        let one = [elastoplastic(1.0)];
        let by = |test: &TestedImpact| {
            let predicted = predict(&one, &[0], test, Inputs::default(), &[scenario], &ImpactSetup::default());
            let predicted = predicted[0][0].clone().unwrap();
            (predicted.peak_by_record, predicted.rebound_by_record)
        };
        assert_eq!(by(&recorded()), (Some(false), Some(false)));
        assert_eq!(by(&test()), (None, None));
    }

    #[test]
    fn equals_with_one_record_meet_as_at_the_wall() {
        let test = recorded();
        let candidates = vec![elastoplastic(1.0)];
        let partner = Partner::Vehicle { candidates: candidates.clone(), place: 0, test: test.clone(), mass_kg: None };
        let at = |partner: Partner, partner_speed_m_per_s: f64| {
            let scenario = Scenario { speed_m_per_s: 12.0, partner_speed_m_per_s, mass_kg: None };
            let setup = ImpactSetup { partner, ..ImpactSetup::default() };
            predict(&candidates, &[0], &test, Inputs::default(), &[scenario], &setup)[0][0].clone().unwrap()
        };
        let (wall, both) = (at(Partner::Wall, 0.0), at(partner, 12.0));
        for (quantity, other) in [
            (Quantity::Peak, Quantity::PartnerPeak),
            (Quantity::DeltaV, Quantity::PartnerDeltaV),
            (Quantity::Restitution, Quantity::Restitution),
        ] {
            let expected = wall.outcome.get(quantity).unwrap();
            for quantity in [quantity, other] {
                let value = both.outcome.get(quantity).unwrap();
                assert!((value / expected - 1.0).abs() < 1e-8, "{quantity:?}: {value}, expected {expected}");
            }
        }
        // The velocities after it belong to the change of velocity.
        let own = both.collision.unwrap().own;
        let change = own.velocity_before_m_per_s - own.velocity_after_m_per_s.unwrap();
        assert!((change - wall.outcome.get(Quantity::DeltaV).unwrap()).abs() < 1e-7, "{change}");
    }

    #[test]
    fn an_open_parameter_that_the_test_holds_fast_is_no_doubt_of_its_crush() {
        let mut open = elastoplastic(1.0);
        let spread = open.spread.as_mut().unwrap();
        spread.standard_deviation.insert("loading_stiffness_n_per_m".to_owned(), 4e6);
        let prediction = at(&[open], Inputs::default(), 12.0, None);
        assert_eq!(prediction.support.limited, 1);
        // A linear curve: the open stiffness moves the crush of both impacts alike, the rate effect is left.
        let left = f64::hypot(by_rate_effect(12.0, 15.0, false, false, true), by_masses_in_front(0.8, 1.0));
        let left = 1.644_853_6 * left;
        assert!((half_width(&prediction) - left).abs() < 1e-3, "{}", half_width(&prediction));
    }

    #[test]
    fn a_mass_below_that_in_front_of_the_compartment_is_refused() {
        let scenario = Scenario { speed_m_per_s: 15.0, partner_speed_m_per_s: 0.0, mass_kg: Some(0.0) };
        let candidates = [elastoplastic(0.0)];
        let results = predict(&candidates, &[0], &test(), Inputs::default(), &[scenario], &ImpactSetup::default());
        assert!(matches!(results[0][0], Err(PredictError::Mass { .. })));
    }
}
