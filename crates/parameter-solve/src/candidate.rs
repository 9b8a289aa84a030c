use std::collections::BTreeMap;

use crumple_lumped::Model;

use crate::{FitQuantity, Method, SensorFit, StopReason};

/// One set of parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// The model with its parameters.
    pub model: Model,
    /// How they were found.
    pub method: Method,
    /// Place among the solutions of this model and method, from 1.
    pub index: usize,
    /// Index of another solution of the same model and method that gives exactly the same record.
    pub equivalent_to: Option<usize>,
    /// How it was fitted; `None` for a closed form.
    pub fit: Option<Fit>,
    /// How well the parameters are determined; `None` where nothing is left over to judge by.
    pub uncertainty: Option<Uncertainty>,
    /// Reductions and assumptions, in words.
    pub notes: Vec<String>,
}

impl Candidate {
    /// `<model>/<method>/<index>`.
    pub fn id(&self) -> String {
        self.id_of(self.index)
    }

    /// Id of the candidate it is equivalent to.
    pub fn equivalent_id(&self) -> Option<String> {
        self.equivalent_to.map(|index| self.id_of(index))
    }

    fn id_of(&self, index: usize) -> String {
        format!("{}/{}/{index}", self.model.kind(), self.method)
    }
}

/// Record of a fit by iteration.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Window, s after time zero.
    pub from_s: f64,
    /// End of the window: time of the last sample used.
    pub to_s: f64,
    /// Samples used.
    pub samples: usize,
    /// What was fitted.
    pub quantity: FitQuantity,
    /// Root mean square error over them, unit of the quantity; of several sensors that of the first.
    pub rmse: f64,
    /// Iterations of the descent that ended here, on the thinned and on the whole window.
    pub iterations: u32,
    /// Model evaluations of all starts.
    pub evaluations: u64,
    /// Why the best start stopped.
    pub stop_reason: StopReason,
    /// Names of the parameters that stopped on a bound.
    pub active_bounds: Vec<&'static str>,
    /// How well each sensor was met; none where the compartment's displacement alone was fitted.
    pub sensors: Vec<SensorFit>,
}

/// Linearised uncertainty.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    /// Standard deviation by parameter, in its unit; a parameter on a bound has none.
    pub standard_deviation: BTreeMap<&'static str, f64>,
    /// Condition number of the sensitivity matrix, columns scaled to one length.
    pub condition: f64,
    /// Lag-1 autocorrelation of the residuals that entered.
    pub residual_autocorrelation: f64,
}
