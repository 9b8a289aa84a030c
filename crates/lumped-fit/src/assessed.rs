//! What is known of the parameters of a candidate: covariance, intervals, profiles, replicates and propagated inputs.

use std::collections::BTreeMap;

/// A 95 % interval by parameter, in its unit; `None`: open on that side, the record does not bound it.
pub type Intervals = BTreeMap<String, (Option<f64>, Option<f64>)>;

/// How well the free numbers of a candidate are determined.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Assessment {
    /// The parameters assessed, in the order of the matrices.
    pub parameters: Vec<String>,
    /// Standard deviations, in the unit of each; those on a bound of the search have none.
    pub standard_deviation: BTreeMap<String, f64>,
    /// 95 % intervals of the linearisation: log-normal, or normal and cut at zero for a value near zero.
    pub interval: Intervals,
    /// Correlation of the estimates (of their logarithms), rows as `parameters`; those on a bound are left out.
    pub correlation: Vec<Vec<f64>>,
    /// Condition number of the sensitivities with columns of one length; `None` without full rank.
    pub condition: Option<f64>,
    /// Directions that the record determines.
    pub rank: usize,
    /// The direction determined least, in words.
    pub weakest_direction: Option<String>,
    /// Lag-1 autocorrelation of the misfit.
    pub residual_autocorrelation: f64,
    /// Independent samples that the misfit is worth.
    pub effective_samples: f64,
    /// Profile likelihood intervals, where asked for.
    pub profile: Vec<Profile>,
    /// Bootstrap, where asked for.
    pub bootstrap: Option<BlockBootstrap>,
    /// Where the accelerations are met best, near the minimum; `None` for a model with knots, and where the noise of a
    /// sensor is not known.
    pub least_misfit: Option<LeastMisfit>,
}

/// Where a model meets the accelerations best: a fit to the displacement, which sums their errors twice, is elsewhere.
#[derive(Debug, Clone, PartialEq)]
pub struct LeastMisfit {
    /// The free numbers there, by name, in the unit of each.
    pub parameters: BTreeMap<String, f64>,
    /// Those of them that stand on no bound.
    pub inside: Vec<String>,
}

/// The profile of one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Name with unit.
    pub parameter: String,
    /// Lower end of the 95 % interval; `None`: open, the record does not bound it from below.
    pub low: Option<f64>,
    /// Upper end; `None`: open.
    pub high: Option<f64>,
    /// Value and rise of `2 ln L` at every grid point, by rising value.
    pub points: Vec<(f64, f64)>,
}

impl Profile {
    /// Whether the record bounds the parameter on both sides.
    pub fn identifiable(&self) -> bool {
        self.low.is_some() && self.high.is_some()
    }
}

/// Percentiles of the parameters over the replicates.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockBootstrap {
    /// Replicates that led to a fit.
    pub replicates: usize,
    /// Samples in a block.
    pub block: usize,
    /// From the 2.5th to the 97.5th percentile.
    pub interval: BTreeMap<String, (Option<f64>, Option<f64>)>,
}

/// Percentiles over the repetitions.
#[derive(Debug, Clone, PartialEq)]
pub struct Propagation {
    /// Repetitions that led to a result.
    pub repetitions: usize,
    /// 5th and 95th percentile by name: the parameters, and `dynamic_crush_m` of the model.
    pub interval_90: BTreeMap<String, (f64, f64)>,
    /// Standard deviation by name.
    pub standard_deviation: BTreeMap<String, f64>,
}

/// How well the parameters of a candidate are determined, and how that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Assessed {
    /// Covariance, intervals, profiles and bootstrap.
    pub assessment: Assessment,
    /// The estimator repeated with uncertain inputs, where asked for.
    pub propagation: Option<Propagation>,
    /// What the propagation repeated, in words: a fit or a closed form.
    pub repeated: &'static str,
    /// Half width of the share of the mass in front that is in the intervals; 0: none.
    pub front_mass_uncertainty: f64,
}
