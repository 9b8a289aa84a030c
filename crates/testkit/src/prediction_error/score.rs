//! What was predicted for a car, beside what the car does.

/// The answers that a car is asked for: speed in km/h, factor of the mass.
pub(super) const ASKED: [(f64, f64); 8] =
    [(56.0, 1.0), (30.0, 1.0), (40.0, 1.0), (48.0, 1.0), (64.0, 1.0), (72.0, 1.0), (56.0, 0.8), (56.0, 1.25)];

/// One prediction, relative to the truth where it is a ratio.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    /// Error of dynamic crush over the crush.
    pub crush: f64,
    /// Error of its time over the time.
    pub time: f64,
    /// Error of the largest deceleration behind CFC 60 over that deceleration; `None` where none was predicted.
    pub peak: Option<f64>,
    /// Error of the coefficient of restitution; `None` where none was predicted.
    pub restitution: Option<f64>,
    /// The 90 % interval of dynamic crush: whether it holds the truth, and its width over the crush.
    pub interval: Option<(bool, f64)>,
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
    /// Model and method that were recommended; `None` where none was.
    pub recommended: Option<String>,
    /// By answer, in the order in which they are asked; `None` where an answer is missing.
    pub predictions: Vec<(Answer, Vec<Option<Prediction>>)>,
}
