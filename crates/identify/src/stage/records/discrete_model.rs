//! The model that a discrete method gives for one order, and what it knows about it.

use crumple_numerics::lti::{Complex, StateSpace};
use crumple_signal::Notes;

use crate::stage::records::responses::Equation;

/// A model of one order and what its method knows about it.
pub struct DiscreteModel {
    /// The sampled model.
    pub state_space: StateSpace,
    /// Numbers that were fitted, the initial state of the simulation among them.
    pub parameters: usize,
    /// Singular values that the order was cut from; empty: the method has none.
    pub singular_values: Vec<f64>,
    /// One-step predictions of every output; empty: none.
    pub predicted: Vec<Vec<f64>>,
    /// First sample that is predicted; those before are the measured ones.
    pub predicted_from: usize,
    /// The equation, where the model is a regression of one output.
    pub equation: Option<Equation>,
    /// Why an iterative fit stopped.
    pub stop_reason: Option<&'static str>,
    /// Condition number of the sensitivities of an iterative fit.
    pub condition: Option<f64>,
    /// Loss of every refined start of one, best first, outputs divided by their root mean squares.
    pub losses: Vec<f64>,
    /// Standard deviations of frequency and damping of discrete poles, where the method has a covariance.
    pub deviations: Option<Deviations>,
    /// What a reader should know of it.
    pub notes: Notes,
    /// Growing poles that were mirrored at the unit circle after the fit.
    pub mirrored_poles: usize,
    /// Models written beside the one that is simulated, by the last part of their topic.
    pub other_models: Vec<(&'static str, StateSpace)>,
    /// What the method chose by the record; the fits of a bootstrap keep these choices.
    pub choices: RecordChoices,
}

/// Standard deviations of frequency (rad/s) and damping ratio of discrete poles.
pub type Deviations = Box<dyn Fn(&[Complex]) -> Vec<Option<(f64, f64)>>>;

/// Choices that a method makes by the record before it fits.
#[derive(Debug, Clone, Copy, Default)]
pub struct RecordChoices {
    /// The subspace methods find poles from every n-th sample.
    pub thin: Option<usize>,
    /// Past samples that the observer sees.
    pub lags: Option<usize>,
    /// Block rows of the subspace methods.
    pub block_rows: Option<usize>,
}

impl DiscreteModel {
    /// Nothing but the model.
    pub fn new(state_space: StateSpace, parameters: usize) -> Self {
        Self {
            state_space,
            parameters,
            singular_values: Vec::new(),
            predicted: Vec::new(),
            predicted_from: 0,
            equation: None,
            stop_reason: None,
            condition: None,
            losses: Vec::new(),
            deviations: None,
            notes: Notes::new(),
            mirrored_poles: 0,
            other_models: Vec::new(),
            choices: RecordChoices::default(),
        }
    }
}
