//! Discrete models: what an estimator gives, whether it is accepted, and its records.

use crumple_numerics::lti::{Complex, InputHold, Mode, StateSpace, to_continuous, to_transfer_function};
use crumple_signal::{Note, Notes, Severity};
use crumple_stage::Output;
use crumple_stage::records::EvidenceV1;
use crumple_sysid::{
    IdentifyError, IoData, MissReason, compare, continued, fit_measures, mode_shapes, simulate_fitted, weak_fit,
};

use crate::stage::options::choices::{Hold, Method};
use crate::stage::options::settings::BootstrapSettings;
use crate::stage::records::evidence::{
    Poles, fit_in_words, identification_with_evidence, notes_on_poles, pole_record, prediction_tests,
    put_transfer_functions, validate_all, validation_summary,
};
use crate::stage::records::realization::{shapes, state_space};
use crate::stage::records::responses::{
    Band, Equation, ModelResponses, note_limits, put_spreads, spread_of_equation, spread_of_outputs, zeros_of,
};
use crate::stage::records::results::Results;
use crate::stage::waves::{Record, WindowedWave};

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
            other_models: Vec::new(),
            choices: RecordChoices::default(),
        }
    }
}

/// A fit below this (percent) gets a warning, or is refused where the model accounts for none of the variance either.
const LEAST_FIT_PERCENT: f64 = -100.0;

/// A modulus within this of 1 is on the unit circle, as far as the eigenvalues of a double pole are known: their
/// rounding is the root of that of the numbers.
const ROUNDING: f64 = 1e-8;

/// Simulates a model on the record it was identified from.
///
/// Errors: a simulation that misses the record by more than twice what its mean does (fit below -100 %) and accounts
/// for none of its variance. Where it accounts for some, the level of the record is what is missed, and a note says so;
/// another where the errors have more than half of the variance.
pub fn simulate_accepted(
    mut model: DiscreteModel,
    data: &IoData,
) -> Result<(Vec<Vec<f64>>, DiscreteModel), IdentifyError> {
    let simulated = simulate_fitted(&model.state_space, data)?.0;
    for (measured, response) in data.outputs().iter().zip(&simulated) {
        let fit = match fit_measures(measured, response) {
            Some(fit) => fit,
            None => return Err(miss(f64::NEG_INFINITY, &model)),
        };
        match fit.fit_percent.filter(|fit| *fit < LEAST_FIT_PERCENT) {
            Some(percent) if fit.vaf_percent.is_none_or(|vaf| vaf <= 0.0) => return Err(miss(percent, &model)),
            _ => {
                if let Some(text) = fit.fit_percent.and_then(fit_warning) {
                    model.notes.warning(text);
                }
            }
        }
    }
    Ok((simulated, model))
}

/// The error of a model that misses the record, with what is known of its poles.
fn miss(fit_percent: f64, model: &DiscreteModel) -> IdentifyError {
    let largest = match model.state_space.poles() {
        Ok(poles) => poles.iter().map(|z| z.norm()).fold(0.0, f64::max),
        Err(error) => return error.into(),
    };
    let why = match largest {
        factor if factor > 1.0 + ROUNDING => MissReason::Grows { factor },
        modulus if modulus >= 1.0 - ROUNDING => MissReason::Marginal,
        _ => MissReason::Stable,
    };
    IdentifyError::Misses { fit_percent, limit: LEAST_FIT_PERCENT, why }
}

/// The warning about a fit that passes: that the level of the record is missed, or most of its variance.
fn fit_warning(percent: f64) -> Option<String> {
    if percent < LEAST_FIT_PERCENT {
        return Some(format!(
            "fit {percent:.1} %: the model misses the level of the record; a linear model has no constant, see \
             --remove-mean"
        ));
    }
    weak_fit(percent)
}

/// The same warning for a model that was fitted to the simulation itself, so that it is no worse than silence.
pub fn note_on_fit(id: &str, fit_percent: Option<f64>, notes: &mut Notes) {
    if let Some(text) = fit_percent.and_then(fit_warning) {
        notes.warning(format!("{id}: {text}"));
    }
}

/// Transfer functions of more states are not written: their coefficients say nothing.
const MOST_COEFFICIENTS: usize = 10;

/// What a model is for and from.
pub struct DiscreteTask<'a> {
    /// Id of the model.
    pub id: &'a str,
    /// Name of the method.
    pub method: Method,
    /// States asked for.
    pub order: usize,
    /// The waveforms.
    pub record: &'a Record,
    /// Hold of the continuous model: `first-order` or `zero-order`.
    pub hold: Hold,
    /// The window, inputs delayed.
    pub data: &'a IoData,
    /// The same with what is kept after it.
    pub whole: &'a IoData,
    /// Bootstrap, if asked for.
    pub bootstrap: Option<&'a BootstrapSettings>,
    /// The same estimate from another record of every output.
    pub refit: &'a (dyn Fn(&[Vec<f64>]) -> Option<StateSpace> + Sync),
}

/// Writes the records of one model under its id and a summary line.
pub fn put_discrete_model(
    task: &DiscreteTask<'_>,
    model: &DiscreteModel,
    simulated: &[Vec<f64>],
    results: &mut Results<'_>,
) -> anyhow::Result<()> {
    let DiscreteTask { id, method, order, record, .. } = *task;
    let mut notes = Notes::new();
    record.remarks.iter().for_each(|remark| notes.info(remark));
    notes.extend(model.notes.clone());
    for Note { text, .. } in notes.iter().filter(|note| note.severity == Severity::Warning) {
        results.out.notes().warning(format!("{id}: {text}"));
    }
    let continuous = put_models(task, model, &mut notes, results.out)?;
    let (discrete_poles, poles) = put_modes(task, &model.state_space, results.out)?;
    let responses = responses_of(&model.state_space, continuous.as_ref(), &record.outputs[0], task.delay())?;
    let mut remarks = notes_on_poles(id, &responses.poles, &record.waves());
    let (mut whole, mut evidence) =
        identification_with_evidence(method, order, record, simulated, model.parameters, Vec::new());
    fill_evidence(task, model, &discrete_poles, &mut evidence, &mut notes);
    validate_kept(task, &model.state_space, &mut evidence, &mut remarks)?;
    put_responses(task, (model, simulated), &responses, &mut evidence, &mut remarks, results.out)?;
    notes.extend(remarks.clone());
    results.out.notes().extend(remarks);
    whole.notes = notes.to_texts();
    whole.singular_values = model.singular_values.clone();
    let rows = |block_rows: usize| u32::try_from(block_rows * record.outputs.len()).ok();
    whole.hankel_rows = model.choices.block_rows.and_then(rows);
    let samples = record.data.samples();
    results.out.summary(format!(
        "{id}: {} of {samples} samples{}",
        fit_in_words(whole.fit_percent),
        validation_summary(&evidence)
    ));
    results.out.put(&format!("/identification/{id}"), &whole)?;
    poles.keep_those_of_modes(&mut evidence);
    results.enter(id, &whole, &mut evidence)
}

impl DiscreteTask<'_> {
    /// Hold that the continuous model is made for.
    fn input_hold(&self) -> InputHold {
        match self.hold {
            Hold::ZeroOrder => InputHold::Zero,
            Hold::FirstOrder => InputHold::First,
        }
    }

    /// Samples by which the inputs act late.
    fn delay(&self) -> usize {
        self.record.delay_s.map_or(0, |delay| (delay / self.record.data.sample_time_s()).round() as usize)
    }
}

/// Writes the sampled model, the continuous one, which is returned, and those beside it.
fn put_models(
    task: &DiscreteTask<'_>,
    model: &DiscreteModel,
    notes: &mut Notes,
    out: &mut Output,
) -> anyhow::Result<Option<StateSpace>> {
    let DiscreteTask { id, record, .. } = *task;
    let (input, output) = (record.input(), record.output());
    out.put(&format!("/model/{id}/discrete"), &state_space(&model.state_space, &input, &output, record.delay_s))?;
    let continuous = put_continuous(id, &model.state_space, (record, task.input_hold()), notes, out)?;
    for (name, other) in &model.other_models {
        let inputs = format!("{input}; {output}");
        out.put(&format!("/model/{id}/{name}"), &state_space(other, &inputs, &output, record.delay_s))?;
    }
    Ok(continuous)
}

/// Writes the modes, of several outputs their shapes too. Returns the sampled poles that have a continuous counterpart,
/// and what each is.
fn put_modes(task: &DiscreteTask<'_>, model: &StateSpace, out: &mut Output) -> anyhow::Result<(Vec<Complex>, Poles)> {
    let DiscreteTask { id, record, .. } = *task;
    let dt = record.data.sample_time_s();
    let pairs: Vec<(Complex, Mode)> =
        model.poles()?.into_iter().filter_map(|z| Some((z, Mode::discrete(z, dt)?))).collect();
    let poles = Poles::of(pairs.iter().map(|(z, mode)| (*mode, Some(*z))), pole_record(&record.waves()));
    poles.put(id, out)?;
    let discrete: Vec<Complex> = pairs.iter().map(|(z, _)| *z).collect();
    if record.outputs.len() > 1 {
        let modes = pairs.iter().zip(poles.are_modes()).map(|((z, mode), is_mode)| (*z, is_mode.then_some(*mode)));
        let modes: Vec<_> = modes.collect();
        out.put(&format!("/shapes/{id}"), &shapes(&modes, &mode_shapes(model, &discrete), &record.outputs))?;
    }
    Ok((discrete, poles))
}

/// Fills in what the method tells of its fit: one-step predictions, deviations of the `poles`, losses, or why there are
/// none.
fn fill_evidence(
    task: &DiscreteTask<'_>,
    model: &DiscreteModel,
    poles: &[Complex],
    evidence: &mut [EvidenceV1],
    notes: &mut Notes,
) {
    let DiscreteTask { method, record, hold, .. } = *task;
    let deviations = model.deviations.as_ref().map(|deviations| deviations(poles)).unwrap_or_default();
    let no_deviations = model.deviations.is_none().then(|| match method {
        Method::Arx => {
            "arx of several outputs has neither a covariance of its poles that is known nor a bootstrap".to_owned()
        }
        _ => format!("{method} has no covariance of its poles that is known; --bootstrap 200 gives their spread"),
    });
    if let Some(why) = no_deviations.iter().find(|_| task.bootstrap.is_none()) {
        notes.info(format!("no standard deviations: {why}"));
    }
    // In units of the output if there is one.
    let unit = if let [scale] = record.data.output_scales()[..] { scale * scale } else { 1.0 };
    let losses: Vec<f64> = model.losses.iter().map(|loss| loss * unit).collect();
    for (k, output_evidence) in evidence.iter_mut().enumerate() {
        output_evidence.hold = (!record.inputs.is_empty()).then(|| hold.to_string());
        if let Some(predicted) = model.predicted.get(k) {
            let measured = &record.data.outputs()[k];
            output_evidence.prediction_fit_percent = fit_measures(measured, predicted).and_then(|fit| fit.fit_percent);
            let errors: Vec<f64> = measured.iter().zip(predicted).map(|(y, yh)| y - yh).collect();
            let tests = prediction_tests(task.data.inputs(), &errors, model.predicted_from);
            output_evidence.whiteness = tests.map(|t| t.whiteness);
            output_evidence.whiteness_limit = tests.map(|t| t.whiteness_limit);
            output_evidence.input_correlation = tests.and_then(|t| t.input_correlation);
        }
        output_evidence.stop_reason = model.stop_reason.map(str::to_owned);
        output_evidence.condition = model.condition;
        output_evidence.losses = losses.clone();
        output_evidence.no_deviations = no_deviations.clone();
        output_evidence.frequency_deviations = deviations.iter().map(|d| d.map(|d| d.0)).collect();
        output_evidence.damping_deviations = deviations.iter().map(|d| d.map(|d| d.1)).collect();
    }
    if !model.predicted.is_empty() {
        notes.info(
            "whiteness and correlation with the input are those of the one-step prediction errors, all else of the \
             simulation",
        );
    }
}

/// Fits of the samples kept for validation, where there are any: simulated on from the samples identified from, and
/// with the initial state fitted to the kept ones.
fn validate_kept(
    task: &DiscreteTask<'_>,
    model: &StateSpace,
    evidence: &mut [EvidenceV1],
    remarks: &mut Notes,
) -> anyhow::Result<()> {
    let DiscreteTask { id, record, data, whole, .. } = *task;
    if record.outputs[0].kept.is_empty() {
        return Ok(());
    }
    match continued(model, data, whole, None) {
        Ok(simulated) => {
            validate_all(record, &simulated, evidence);
            // The protocol of published comparisons: the initial state is fitted to the kept samples.
            let rest = whole.slice(data.samples(), whole.samples())?;
            for (output_evidence, fit) in evidence.iter_mut().zip(compare(model, &rest)?) {
                output_evidence.validation_restarted_fit_percent = fit.and_then(|fit| fit.fit_percent);
            }
        }
        Err(error) => remarks.warning(format!("{id}: no validation: {error}")),
    }
    Ok(())
}

/// Runs the bootstrap, if asked for, and writes the responses of a model of one input and one output.
fn put_responses(
    task: &DiscreteTask<'_>,
    (model, simulated): (&DiscreteModel, &[Vec<f64>]),
    responses: &ModelResponses<'_>,
    evidence: &mut [EvidenceV1],
    remarks: &mut Notes,
    out: &mut Output,
) -> anyhow::Result<()> {
    let DiscreteTask { id, method, record, .. } = *task;
    // Noise added to the outputs of a regression would bias its replicates.
    let regression = method == Method::Arx && model.equation.is_none();
    let bootstrap = task.bootstrap.filter(|_| !regression);
    let without = task.bootstrap.filter(|_| regression);
    note_limits(id, (record.inputs.len(), record.outputs.len()), without, remarks);
    let grid = if record.single() { responses.grid_hz() } else { Vec::new() };
    let sample = responses.sample(&grid);
    let refit = |y: &[Vec<f64>]| {
        let refitted = (task.refit)(y)?;
        let continuous = to_continuous(&refitted, task.input_hold()).ok().map(|result| result.model);
        Some(responses_of(&refitted, continuous.as_ref(), &record.outputs[0], task.delay()).ok()?.sample(&grid))
    };
    let nominal = (id, &sample);
    let spreads = match &model.equation {
        Some(equation) => spread_of_equation(bootstrap, nominal, equation, remarks, |y| refit(&[y.to_vec()])),
        None => {
            let signals = (record.data.outputs(), simulated);
            spread_of_outputs(bootstrap, nominal, signals, model.parameters, remarks, refit)
        }
    };
    let band = spreads.as_ref().map(Band::from_bootstrap);
    if let Some(spreads) = &spreads {
        evidence.iter_mut().for_each(|output_evidence| put_spreads(spreads, output_evidence));
    }
    if let Some(response) =
        responses.response(&record.input(), &record.output(), band.as_ref()).filter(|_| record.single())
    {
        out.put(&format!("/response/{id}"), &response)?;
    }
    Ok(())
}

/// The model with all that its responses need; `answer` is the first output.
fn responses_of<'a>(
    model: &'a StateSpace,
    continuous: Option<&'a StateSpace>,
    answer: &WindowedWave,
    delay: usize,
) -> Result<ModelResponses<'a>, IdentifyError> {
    let dt_s = answer.sampled.dt_s();
    Ok(ModelResponses {
        continuous,
        discrete: Some(model),
        poles: model.poles()?.into_iter().filter_map(|z| Some(Mode::discrete(z, dt_s)?.pole)).collect(),
        zeros: continuous.map(zeros_of).unwrap_or_default(),
        dt_s,
        samples: answer.sampled.len(),
        delay,
    })
}

/// Writes the continuous model by the logarithm for the hold declared, and its transfer functions.
fn put_continuous(
    id: &str,
    model: &StateSpace,
    (record, hold): (&Record, InputHold),
    notes: &mut Notes,
    out: &mut Output,
) -> anyhow::Result<Option<StateSpace>> {
    let result = match to_continuous(model, hold) {
        Ok(result) => result,
        Err(error) => {
            notes.info(format!("no continuous model: {error}"));
            return Ok(None);
        }
    };
    for z in &result.conjugated {
        notes.info(format!(
            "the pole z = {z:.6} has no continuous counterpart: the continuous model has one more state, a conjugate \
             at the Nyquist frequency, and agrees at the samples only"
        ));
    }
    let continuous = result.model;
    out.put(
        &format!("/model/{id}/continuous"),
        &state_space(&continuous, &record.input(), &record.output(), record.delay_s),
    )?;
    if continuous.order() > MOST_COEFFICIENTS {
        return Ok(Some(continuous));
    }
    let mut entries = Vec::new();
    for i in 0..record.outputs.len() {
        for j in 0..record.inputs.len() {
            let path = StateSpace::new(
                continuous.a.clone(),
                continuous.b.columns(j, 1).into_owned(),
                continuous.c.rows(i, 1).into_owned(),
                continuous.d.view((i, j), (1, 1)).into_owned(),
                None,
            )?;
            match to_transfer_function(&path) {
                Ok(tf) => entries.push((tf.numerator().to_vec(), tf.denominator().to_vec())),
                Err(error) => {
                    notes.info(format!("no transfer function: {error}"));
                    return Ok(Some(continuous));
                }
            }
        }
    }
    let inputs = record.inputs.len();
    put_transfer_functions(id, record, |i, j| entries[i * inputs + j].clone(), out)?;
    Ok(Some(continuous))
}
