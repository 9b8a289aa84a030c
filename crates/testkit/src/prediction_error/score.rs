//! What was predicted for a car, beside what the car does.

use serde_json::Value;

use super::car::Truth;

/// The answers that a car is asked for: speed in km/h, factor of the mass. The kind at the pole, which is tested at 35,
/// is asked at 5/8 of these speeds.
pub(super) const ASKED: [(f64, f64); 8] =
    [(56.0, 1.0), (30.0, 1.0), (40.0, 1.0), (48.0, 1.0), (64.0, 1.0), (72.0, 1.0), (56.0, 0.8), (56.0, 1.2)];
/// Places in [`ASKED`]: the test that was made, the speed that the status of a run is asked at, and what the cover of
/// intervals is counted over.
pub(super) const OWN_TEST: usize = 0;
pub(super) const LOWER: usize = 2;
pub(super) const COUNTED: [usize; 5] = [2, 3, 4, 6, 7];

/// A number that is predicted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Dynamic crush.
    Crush,
    /// Its time.
    Time,
    /// Largest deceleration behind CFC 60.
    Peak,
    /// Change of velocity.
    DeltaV,
    /// Coefficient of restitution.
    Restitution,
}

impl Quantity {
    /// All of them, in the order of a [`Prediction`].
    pub(super) const ALL: [Self; 5] = [Self::Crush, Self::Time, Self::Peak, Self::DeltaV, Self::Restitution];

    /// Name in the tables.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Crush => "dynamic crush",
            Self::Time => "time of dynamic crush",
            Self::Peak => "peak behind CFC 60",
            Self::DeltaV => "delta-v",
            Self::Restitution => "coefficient of restitution (difference times 100)",
        }
    }

    /// Field in the record of a prediction, and name of its interval.
    fn field(self) -> &'static str {
        match self {
            Self::Crush => "dynamic_crush_m",
            Self::Time => "time_of_dynamic_crush_s",
            Self::Peak => "peak_acceleration_m_per_s2",
            Self::DeltaV => "delta_v_m_per_s",
            Self::Restitution => "coefficient_of_restitution",
        }
    }

    fn of(self, truth: &Truth) -> f64 {
        match self {
            Self::Crush => truth.crush_m,
            Self::Time => truth.time_s,
            Self::Peak => truth.peak_m_per_s2,
            Self::DeltaV => truth.delta_v_m_per_s,
            Self::Restitution => truth.restitution,
        }
    }

    /// Error of a value: over the truth, but of restitution, which is a ratio itself.
    fn error(self, value: f64, truth: f64) -> f64 {
        if self == Self::Restitution { value - truth } else { value / truth - 1.0 }
    }
}

/// A predicted number beside the truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scored {
    /// Over the truth; of restitution the difference.
    pub error: f64,
    /// The 90 % interval: whether it holds the truth, and its width over the truth.
    pub interval: Option<(bool, f64)>,
}

/// The numbers of one prediction in the order of `Quantity`; `None` where one was not predicted: a model that never
/// stops has no crush.
pub type Prediction = [Option<Scored>; 5];

/// A record `/prediction/<n>` beside the truth.
pub(super) fn scored(record: &Value, truth: &Truth) -> Prediction {
    Quantity::ALL.map(|quantity| {
        let (value, truth) = (record[quantity.field()].as_f64()?.abs(), quantity.of(truth));
        let mut intervals = record["intervals"].as_array().into_iter().flatten();
        let interval = intervals.find(|interval| interval["name"] == quantity.field()).and_then(|interval| {
            let ends = [interval["low"].as_f64()?, interval["high"].as_f64()?];
            Some((ends[0] <= truth && truth <= ends[1], (ends[1] - ends[0]) / truth))
        });
        Some(Scored { error: quantity.error(value, truth), interval })
    })
}

/// What one car would show beside what another one does.
pub(super) fn scored_truth(predicted: &Truth, truth: &Truth) -> Prediction {
    Quantity::ALL.map(|quantity| {
        Some(Scored { error: quantity.error(quantity.of(predicted), quantity.of(truth)), interval: None })
    })
}

/// Who answers.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Answer {
    /// The candidate that the programs recommend for prediction.
    Recommended,
    /// The car itself, its curves known as far as its tests crushed them: what no model of these tests can know.
    CarItself,
    /// The first candidate of this model and method.
    Candidate(String),
}

/// A car and what was predicted for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Its kind.
    pub kind: &'static str,
    /// Its number within the kind.
    pub number: usize,
    /// Crush and peak at the lower speed over those of its test.
    pub lower_ratios: [f64; 2],
    /// Model and method that were recommended; `None` where none was.
    pub recommended: Option<String>,
    /// Status of the run in `summary.json`, asked at the lower speed; `None` where it says none.
    pub status: Option<String>,
    /// By answer, in the order in which they are asked; `None` where an answer is missing.
    pub predictions: Vec<(Answer, Vec<Option<Prediction>>)>,
}

impl Outcome {
    /// What was predicted at a question.
    pub(super) fn prediction(&self, who: &Answer, question: usize) -> Option<Prediction> {
        self.predictions.iter().find(|(answer, _)| answer == who)?.1[question]
    }

    /// Error of a quantity that the recommended model predicts.
    pub(super) fn error(&self, quantity: Quantity, question: usize) -> Option<f64> {
        Some(self.prediction(&Answer::Recommended, question)?[quantity as usize]?.error)
    }

    /// Whether a model that does not stay crushed is recommended.
    pub(super) fn is_damped(&self) -> bool {
        let model = self.recommended.as_deref().and_then(|id| id.split('/').next());
        model.is_some_and(|model| !["elastoplastic", "force-deflection"].contains(&model))
    }

    /// Whether the recommended model repeats the test it was fitted to: it stops, with its crush within 3.5 %, its time
    /// within 5 % and its restitution within 0.1.
    pub(super) fn repeats_own_test(&self) -> bool {
        let limits = [(Quantity::Crush, 0.035), (Quantity::Time, 0.05), (Quantity::Restitution, 0.1)];
        limits.iter().all(|(quantity, limit)| self.error(*quantity, OWN_TEST).is_some_and(|e| e.abs() <= *limit))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRUTH: Truth =
        Truth { crush_m: 0.5, time_s: 0.06, peak_m_per_s2: 300.0, delta_v_m_per_s: 17.0, restitution: 0.1 };

    #[test]
    fn numbers_of_a_record_stand_beside_the_truth() {
        let record = serde_json::json!({
            "dynamic_crush_m": 0.55, "time_of_dynamic_crush_s": 0.06, "peak_acceleration_m_per_s2": 270.0,
            "coefficient_of_restitution": 0.15,
            "intervals": [
                { "name": "dynamic_crush_m", "low": 0.51, "high": 0.59 },
                { "name": "peak_acceleration_m_per_s2", "low": 200.0, "high": 350.0 },
            ],
        });
        let prediction = scored(&record, &TRUTH);
        let near = |quantity: Quantity, error: f64, interval: Option<(bool, f64)>| {
            let scored = prediction[quantity as usize].expect("predicted");
            assert!((scored.error - error).abs() < 1e-12, "{quantity:?} {scored:?}");
            assert_eq!(scored.interval.map(|(held, _)| held), interval.map(|(held, _)| held), "{quantity:?}");
            let width = |interval: Option<(bool, f64)>| interval.map_or(0.0, |(_, width)| width);
            assert!((width(scored.interval) - width(interval)).abs() < 1e-12, "{quantity:?} {scored:?}");
        };
        near(Quantity::Crush, 0.1, Some((false, 0.16)));
        near(Quantity::Time, 0.0, None);
        near(Quantity::Peak, -0.1, Some((true, 0.5)));
        near(Quantity::Restitution, 0.05, None);
        assert_eq!(prediction[Quantity::DeltaV as usize], None);
    }

    #[test]
    fn a_damped_model_that_stops_elsewhere_or_never_does_not_repeat_its_test() {
        let outcome = |own: Option<Truth>| Outcome {
            kind: "",
            number: 0,
            lower_ratios: [1.0; 2],
            recommended: Some("maxwell/direct-fit".to_owned()),
            status: None,
            predictions: vec![(Answer::Recommended, vec![own.map(|own| scored_truth(&own, &TRUTH))])],
        };
        assert!(outcome(None).is_damped());
        assert!(outcome(Some(Truth { crush_m: 0.517, time_s: 0.058, restitution: 0.19, ..TRUTH })).repeats_own_test());
        for other in [
            Some(Truth { crush_m: 0.518, ..TRUTH }),
            Some(Truth { time_s: 0.064, ..TRUTH }),
            Some(Truth { restitution: 0.21, ..TRUTH }),
            None,
        ] {
            assert!(!outcome(other).repeats_own_test(), "{other:?}");
        }
    }
}
