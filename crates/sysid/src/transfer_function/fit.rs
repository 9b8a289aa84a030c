//! Continuous transfer functions from input and output records.

use crumple_estimation::minimise::separable_covariance::{propagated, unknowns_covariance};
use crumple_estimation::statistics::autoregressive_effective_samples;
use crumple_lti::{Complex, Mode, StateSpace, TransferFunction};
use nalgebra::DMatrix;

use crate::modes::mode_deviations::root_deviations;
use crate::poles::multistart::{Search, best_search};
use crate::poles::options::TransferFunctionOptions;
use crate::poles::search_outcome::SearchOutcome;
use crate::poles::time_scale::{cascade, combined, in_seconds, unscaled};
use crate::{FitMeasures, IdentifyError, InformationCriteria, IoData, fit_measures};

/// A transfer function and the evidence for it.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferFunctionFit {
    /// The transfer function, in units of the data.
    pub transfer_function: TransferFunction,
    /// The same as a cascade of sections, well conditioned where coefficients of a polynomial are not.
    pub state_space: StateSpace,
    /// Numerator of the free motion over the same denominator, highest power first: `y_free = N(s)/A(s)` of a unit
    /// impulse. Empty: from rest.
    pub initial_numerator: Vec<f64>,
    /// Poles, 1/s, with frequency and damping.
    pub modes: Vec<Mode>,
    /// Zeros, 1/s.
    pub zeros: Vec<Complex>,
    /// Standard deviations of the numerator's coefficients (as many as zeros + 1, highest power first), from the
    /// covariance of the linearised fit inflated for correlated residuals.
    pub numerator_deviations: Vec<f64>,
    /// Covariance of both: the numerator's `zeros + 1` coefficients, then the denominator's; `None` where the
    /// sensitivities do not determine it.
    pub coefficient_covariance: Option<DMatrix<f64>>,
    /// Standard deviations of the real and imaginary parts of the zeros, 1/s; `None` where not determined.
    pub zero_deviations: Vec<Option<(f64, f64)>>,
    /// Mean square of the error, square of the output's unit.
    pub loss: f64,
    /// Measures of the simulated output.
    pub fit: Option<FitMeasures>,
    /// Simulated output.
    pub simulated: Vec<f64>,
    /// Criteria with the effective number of samples.
    pub criteria: InformationCriteria,
    /// The search that found it.
    pub search: SearchOutcome,
}

impl TransferFunctionFit {
    /// Covariance of the denominator's coefficients after the leading 1, by rows; empty where it is not finite.
    pub fn denominator_covariance(&self) -> Vec<Vec<f64>> {
        let n = self.search.denominator_deviations.len();
        let Some(all) = &self.coefficient_covariance else { return Vec::new() };
        let block = all.view((all.nrows() - n, all.ncols() - n), (n, n));
        if block.iter().any(|x| !x.is_finite()) {
            return Vec::new();
        }
        block.row_iter().map(|row| row.iter().copied().collect()).collect()
    }
}

/// Finds the continuous transfer function with given numbers of poles and zeros whose simulated output is nearest to
/// the measured one.
///
/// Output error, `min |y - yh|²`, by variable projection: only the poles are iterated on, numerator and initial motion
/// are linear and solved for. The model is a cascade of second-order sections, discretised exactly for the declared
/// hold; its sensitivities are states of a larger cascade, exact too. (A filter in direct form loses the optimum at
/// high sampling rates: its coefficients differ from those of integrators by less than rounding allows.) Time is
/// scaled by the record's length and signals by their root mean square.
///
/// Without estimated initial conditions a record that starts in motion, as every crash record does, is fitted badly.
/// The optimum found is the best of several starts, not proven global. A numerator may be badly determined: look at
/// its standard deviations.
///
/// Methods of the starts: Garnier & Wang (ed.), *Identification of Continuous-time Models from Sampled Data*, 2008.
pub fn transfer_function_fit(
    data: &IoData,
    options: &TransferFunctionOptions,
) -> Result<TransferFunctionFit, IdentifyError> {
    if data.inputs().len() != 1 || data.outputs().len() != 1 {
        return Err(IdentifyError::Channels {
            method: "tfest",
            needed: "one input and one output",
            inputs: data.inputs().len(),
            outputs: data.outputs().len(),
        });
    }
    best_search(data, options)?.finish(data, options)
}

impl Search {
    /// From scaled unknowns to a transfer function in units of the data, with its covariance.
    fn finish(self, data: &IoData, options: &TransferFunctionOptions) -> Result<TransferFunctionFit, IdentifyError> {
        let Self { problem, best, .. } = &self;
        let samples = data.samples();
        let duration = samples as f64 * data.sample_time_s();
        let k = best.theta.len();
        let c: Vec<f64> = best.coefficients.column(0).iter().copied().collect();
        let unknowns: Vec<f64> = best.theta.iter().chain(&c).copied().collect();
        let (input_scale, output_scale) = (self.input_scales[0], self.output_scales[0]);
        let gain = output_scale / input_scale;
        // Numerator, denominator without its 1, frequency and damping of every section.
        let describe = |unknowns: &[f64]| -> Vec<f64> {
            let (theta, c) = unknowns.split_at(k);
            let chain = unscaled(&problem.chain(theta), duration);
            let mut all: Vec<f64> =
                self.numerator(theta, c, 0, options.zeros, duration).into_iter().map(|b| b * gain).collect();
            all.extend(&chain.denominator()[1..]);
            all.extend(chain.poles().iter().map(|s| s.norm()));
            all.extend(chain.poles().iter().map(|s| -s.re / s.norm()));
            all
        };
        let values = describe(&unknowns);
        let effective = autoregressive_effective_samples(&best.residual);
        let (covariance, condition) = unknowns_covariance(problem, best, effective);
        let n = options.poles;
        let b_count = options.zeros + 1;
        let described = covariance.map(|covariance| propagated(&describe, &unknowns, &covariance));
        let deviations: Vec<f64> = match &described {
            Some(described) => described.diagonal().iter().map(|x| x.max(0.0).sqrt()).collect(),
            None => vec![f64::INFINITY; values.len()],
        };
        let chain = unscaled(&problem.chain(&best.theta), duration);
        let mut denominator = vec![1.0];
        denominator.extend(&values[b_count..b_count + n]);
        let transfer_function = TransferFunction::new(&values[..b_count], &denominator)?;
        let simulated: Vec<f64> =
            data.outputs()[0].iter().zip(&best.residual).map(|(y, e)| y - e * output_scale).collect();
        let loss = best.cost * output_scale * output_scale / samples as f64;
        let (forced, free) = problem.state_coefficients(&best.theta, &c);
        let forced = &forced[0];
        let initial_numerator = if problem.free {
            let numerators = problem.chain(&best.theta).state_numerators();
            let sum = combined(&numerators, &free);
            // A unit impulse in scaled time has the area of the duration.
            in_seconds(&sum, n, duration).into_iter().map(|x| x * output_scale).collect()
        } else {
            Vec::new()
        };
        let direct = if problem.direct { c[problem.numerator] * gain } else { 0.0 };
        let zeros = transfer_function.zeros()?;
        // Coefficients that vanish exactly are not part of the polynomial.
        let shown = transfer_function.numerator();
        let dropped = b_count - shown.len();
        let zero_deviations = match &described {
            Some(covariance) => {
                let of_numerator = covariance.view((dropped, dropped), (shown.len(), shown.len())).into_owned();
                root_deviations(shown, &of_numerator, &zeros)
            }
            None => vec![None; zeros.len()],
        };
        Ok(TransferFunctionFit {
            coefficient_covariance: described.map(|c| c.view((0, 0), (b_count + n, b_count + n)).into_owned()),
            zero_deviations,
            zeros,
            transfer_function,
            state_space: cascade(&chain, forced, duration, gain, direct)?,
            initial_numerator,
            modes: chain.poles().into_iter().map(Mode::continuous).collect(),
            numerator_deviations: deviations[..b_count].to_vec(),
            loss,
            fit: fit_measures(&data.outputs()[0], &simulated),
            simulated,
            criteria: InformationCriteria::new(loss, effective, unknowns.len()),
            search: SearchOutcome::new(&self, condition, n, &deviations[b_count..]),
        })
    }
}
