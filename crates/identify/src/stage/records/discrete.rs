//! Discrete models: what an estimator gives, whether it is accepted, and its records.

use crumple_numerics::lti::{Complex, InputHold, LtiError, Mode, StateSpace, to_continuous, to_transfer_function};
use crumple_signal::{About, Note, Notes, Weight, remarks};
use crumple_stage::records::{EvidenceV1, ShapesV1};
use crumple_sysid::{
    Cancelled, IdentifyError, IoData, MissReason, PoleKind, cancelled_poles, fit_measures, mode_shapes,
    simulate_fitted, weak_fit,
};

use crate::stage::options::choices::{Hold, Method};
use crate::stage::options::settings::BootstrapSettings;
use crate::stage::records::evidence::{
    NamedNumbers, Poles, clear_simulation, notes_on_poles, of_model, pole_record, prediction_tests,
};
use crate::stage::records::lines;
use crate::stage::records::model::{FittedModel, Forms, Simulated, evidence_of, treated_as};
use crate::stage::records::realization::shapes;
use crate::stage::records::responses::{ModelResponses, zeros_of};
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
    /// Coefficients of every output with their covariance, where those are what the method fits.
    pub coefficients: Vec<NamedNumbers>,
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
            stop_reason: None,
            condition: None,
            losses: Vec::new(),
            deviations: None,
            notes: Notes::new(),
            other_models: Vec::new(),
            coefficients: Vec::new(),
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
/// another where the errors have more than half of the variance. With `allow_unstable` a model that misses because it
/// grows, and that predicts one step ahead, is accepted without a simulation: no outputs.
pub fn simulate_accepted(
    mut model: DiscreteModel,
    data: &IoData,
    allow_unstable: bool,
) -> Result<(Vec<Vec<f64>>, DiscreteModel), IdentifyError> {
    let refused = |percent: f64, mut model: DiscreteModel| match miss(percent, &model) {
        IdentifyError::Misses { why: MissReason::Grows { factor }, .. }
            if allow_unstable && !model.predicted.is_empty() =>
        {
            model.notes.push(NotSimulated { factor });
            Ok((Vec::new(), model))
        }
        error => Err(error),
    };
    let simulated = simulate_fitted(&model.state_space, data)?.0;
    if data.inputs().is_empty() && data.outputs().len() > 1 {
        // Of motion that nobody measured the cause of, a simulation is no verdict.
        return Ok((simulated, model));
    }
    for (measured, response) in data.outputs().iter().zip(&simulated) {
        let fit = match fit_measures(measured, response) {
            Some(fit) => fit,
            None => return refused(f64::NEG_INFINITY, model),
        };
        match fit.fit_percent.filter(|fit| *fit < LEAST_FIT_PERCENT) {
            Some(percent) if fit.vaf_percent.is_none_or(|vaf| vaf <= 0.0) => return refused(percent, model),
            _ => {
                if let Some(note) = fit.fit_percent.and_then(fit_warning) {
                    model.notes.push(note);
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
fn fit_warning(fit_percent: f64) -> Option<Note> {
    if fit_percent < LEAST_FIT_PERCENT {
        return Some(LevelMissed { fit_percent }.into());
    }
    weak_fit(fit_percent).map(Note::from)
}

/// The same warning for a model that was fitted to the simulation itself, so that it is no worse than silence.
pub fn note_on_fit(id: &str, fit_percent: Option<f64>, notes: &mut Notes) {
    if let Some(note) = fit_percent.and_then(fit_warning) {
        notes.push(of_model(id, note));
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

/// Writes one model and says it on the screen.
pub fn put_discrete_model(
    task: &DiscreteTask<'_>,
    model: DiscreteModel,
    used: Vec<Vec<f64>>,
    results: &mut Results<'_>,
) -> anyhow::Result<()> {
    let DiscreteTask { id, method, order, record, .. } = *task;
    let mut notes = Notes::new();
    record.remarks.iter().chain(model.notes.iter()).for_each(|note| notes.push(of_model(id, note.clone())));
    let (forms, continuous) = forms(task, &model, &mut notes)?;
    let (discrete_poles, mut poles, shapes) = modes(task, &model.state_space)?;
    if !used.is_empty() {
        take_out_cancelled((id, record), task.data, &discrete_poles, &mut poles, &mut notes);
    }
    let responses = responses_of(&model.state_space, continuous.as_ref(), &record.outputs[0], task.delay())?;
    notes.extend(notes_on_poles(id, &poles.of_the_system(), &record.waves()));
    let is_simulated = !used.is_empty();
    let shown = if is_simulated { &used } else { &model.predicted };
    let mut evidence = evidence_of(&record.inputs, &record.outputs, shown, model.parameters);
    if !is_simulated {
        evidence.iter_mut().for_each(clear_simulation);
    }
    fill_evidence(task, &model, &discrete_poles, &mut evidence, &mut notes);
    let whole = (task.data, task.whole);
    let simulated = match Simulated::of_state_space(&model.state_space, used.clone(), whole, None) {
        _ if !is_simulated => Simulated::all_used(used),
        Ok(simulated) => simulated,
        Err(error) => {
            notes.push(PartFailed { id: id.to_owned(), part: "validation".to_owned(), reason: error.to_string() });
            Simulated::all_used(used)
        }
    };
    let (answer, delay, hold) = (&record.outputs[0], task.delay(), task.input_hold());
    let refit = |y: &[Vec<f64>], grid: &[f64]| {
        let refitted = (task.refit)(y)?;
        let continuous = to_continuous(&refitted, hold).ok().map(|result| result.model);
        Some(responses_of(&refitted, continuous.as_ref(), answer, delay).ok()?.sample(grid))
    };
    FittedModel {
        id,
        method,
        order,
        treated_as: treated_as(record),
        input: record.input(),
        inputs: &record.inputs,
        outputs: &record.outputs,
        delay_s: record.delay_s,
        forms,
        poles,
        shapes,
        simulated,
        evidence,
        hankel: (model.choices.block_rows.map(|rows| rows * record.outputs.len()), None),
        singular_values: model.singular_values.clone(),
        responses,
        band: None,
        bootstrap: task.bootstrap.filter(|_| is_simulated),
        hold: (!record.inputs.is_empty()).then_some(hold),
        refit: Box::new(refit),
        notes,
    }
    .put(results)
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

/// The sampled model, those beside it, the continuous one by the logarithm for the hold declared, which is returned
/// apart too, and its transfer functions.
fn forms(
    task: &DiscreteTask<'_>,
    model: &DiscreteModel,
    notes: &mut Notes,
) -> anyhow::Result<(Forms, Option<StateSpace>)> {
    let DiscreteTask { id, record, .. } = *task;
    let input = record.input();
    let mut state_spaces = vec![("discrete", model.state_space.clone(), input.clone())];
    let beside = model.other_models.iter();
    state_spaces.extend(beside.map(|(name, other)| (*name, other.clone(), format!("{input}; {}", record.output()))));
    let result = match to_continuous(&model.state_space, task.input_hold()) {
        Ok(result) => result,
        Err(error) => {
            notes.push(PartLeftOut::new(id, "continuous model", &error));
            return Ok((Forms { state_spaces, ..Forms::default() }, None));
        }
    };
    result.conjugated.iter().for_each(|z| notes.push(PoleConjugated { id: id.to_owned(), z: *z }));
    let continuous = result.model;
    state_spaces.push(("continuous", continuous.clone(), input));
    let paths = match continuous.order() <= MOST_COEFFICIENTS {
        true => paths(&continuous, record.outputs.len(), record.inputs.len())?,
        false => Ok(Vec::new()),
    };
    let paths = paths.unwrap_or_else(|error| {
        notes.push(PartLeftOut::new(id, "transfer function", &error));
        Vec::new()
    });
    Ok((Forms { state_spaces, paths, ..Forms::default() }, Some(continuous)))
}

/// Numerator and denominator of a path.
type Path = (Vec<f64>, Vec<f64>);

/// Those of every path of a continuous model, by output and input. The inner error: a path has none.
fn paths(model: &StateSpace, outputs: usize, inputs: usize) -> anyhow::Result<Result<Vec<Vec<Path>>, LtiError>> {
    let mut all = Vec::with_capacity(outputs);
    for i in 0..outputs {
        let mut of_output = Vec::with_capacity(inputs);
        for j in 0..inputs {
            let path = StateSpace::new(
                model.a.clone(),
                model.b.columns(j, 1).into_owned(),
                model.c.rows(i, 1).into_owned(),
                model.d.view((i, j), (1, 1)).into_owned(),
                None,
            )?;
            match to_transfer_function(&path) {
                Ok(tf) => of_output.push((tf.numerator().to_vec(), tf.denominator().to_vec())),
                Err(error) => return Ok(Err(error)),
            }
        }
        all.push(of_output);
    }
    Ok(Ok(all))
}

/// The sampled poles that have a continuous counterpart, what each is, and of several outputs the shapes of the modes.
fn modes(task: &DiscreteTask<'_>, model: &StateSpace) -> anyhow::Result<(Vec<Complex>, Poles, Option<ShapesV1>)> {
    let DiscreteTask { record, .. } = *task;
    let dt = record.data.sample_time_s();
    let pairs: Vec<(Complex, Mode)> =
        model.poles()?.into_iter().filter_map(|z| Some((z, Mode::discrete(z, dt)?))).collect();
    let poles = Poles::of(pairs.iter().map(|(z, mode)| (*mode, Some(*z))), pole_record(&record.waves()))
        .with_harmonics(&record.harmonics_rad_per_s);
    let discrete: Vec<Complex> = pairs.iter().map(|(z, _)| *z).collect();
    let shapes = (record.outputs.len() > 1).then(|| {
        let modes = pairs.iter().zip(poles.are_modes()).map(|((z, mode), is_mode)| (*z, is_mode.then_some(*mode)));
        shapes(&modes.collect::<Vec<_>>(), &mode_shapes(model, &discrete), &record.outputs)
    });
    Ok((discrete, poles, shapes))
}

/// Takes poles that zeros cancel out of the modes of a model, and says it. From an acceleration to a displacement,
/// where a double integrator is true whatever the modes, none is looked for.
pub fn take_out_cancelled(
    (id, record): (&str, &Record),
    data: &IoData,
    sampled: &[Complex],
    poles: &mut Poles,
    notes: &mut Notes,
) {
    if pole_record(&record.waves()).of_motion {
        return;
    }
    let Some(Cancelled { poles: surplus, fit_percent, without_percent }) = cancelled_poles(data, sampled) else {
        return;
    };
    let places: Vec<usize> = (0..sampled.len()).filter(|k| surplus.contains(&sampled[*k])).collect();
    places.iter().for_each(|place| poles.take_out(*place, PoleKind::Cancelled));
    let upper = places.iter().filter(|place| sampled[**place].im >= 0.0);
    notes.push(PolesCancelled {
        id: id.to_owned(),
        frequencies: upper.map(|place| format!("{} Hz", lines::digits(poles.natural_hz(*place)))).collect(),
        rest: sampled.len() - places.len(),
        fewer: places.len(),
        fit_percent,
        without_percent,
    });
}

/// Why there are no standard deviations.
fn no_covariance(method: &str) -> String {
    format!("{method} has no covariance of its poles that is known; --bootstrap 60 gives their spread")
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
    let without = model.deviations.is_none().then(|| match method {
        Method::Arx => "arx of several outputs".to_owned(),
        _ => method.to_string(),
    });
    if let Some(method) = without.iter().find(|_| task.bootstrap.is_none()) {
        notes.push(NoDeviations { id: task.id.to_owned(), method: method.clone() });
    }
    let no_deviations = without.as_deref().map(no_covariance);
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
        if let Some(coefficients) = model.coefficients.get(k) {
            coefficients.clone().put(output_evidence);
        }
        output_evidence.stop_reason = model.stop_reason.map(str::to_owned);
        output_evidence.condition = model.condition;
        output_evidence.losses = losses.clone();
        output_evidence.no_deviations = no_deviations.clone();
        output_evidence.frequency_deviations = deviations.iter().map(|d| d.map(|d| d.0)).collect();
        output_evidence.damping_deviations = deviations.iter().map(|d| d.map(|d| d.1)).collect();
    }
    if !model.predicted.is_empty() {
        notes.push(TestsOfPrediction { id: task.id.to_owned() });
    }
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

impl PartFailed {
    /// Of the stabilisation diagram of a method.
    pub fn diagram(method: &str, reason: &impl ToString) -> Self {
        let part = "stabilisation diagram".to_owned();
        Self { id: method.to_owned(), part, reason: reason.to_string() }
    }
}

impl PartLeftOut {
    /// Of a model or a method.
    pub fn new(id: &str, part: &str, reason: &impl ToString) -> Self {
        Self { id: id.to_owned(), part: part.to_owned(), reason: reason.to_string() }
    }
}

remarks! {
    /// Remarks of sampled models, and of parts that a model lacks.
    pub REMARKS;

    /// A model grows, and is written without a simulation.
    CR459 NotSimulated { factor: f64 }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "A pole has a modulus above 1, the simulation misses the record, and --allow-unstable is given."
    means "Its poles and its one-step prediction hold, as of a plant in a loop. It has no output and no fit."
    remedy "use its poles, or leave --allow-unstable out"
    says format!(
        "the model grows by a factor {factor:.4} per sample and cannot be simulated: its poles and its one-step \
         prediction can be used, its output cannot"
    );

    /// A model misses the level of the record.
    CR460 LevelMissed { fit_percent: f64 }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "The fit of the simulation is below -100 %."
    means "The model may follow the motion about the level, but not the level: a linear model has no constant."
    remedy "add --remove-mean"
    says format!(
        "fit {fit_percent:.1} %: the model misses the level of the record; a linear model has no constant, see \
         --remove-mean"
    );

    /// A part of the result that was asked for could not be made.
    CR461 PartFailed { id: String, part: String, reason: String }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "The validation runs the model on over the samples kept by --validate-from; a stabilisation diagram needs \
             models of several orders from one factorisation. The sentence says what is in the way."
    means "The model itself is written, without this part."
    remedy "do what the sentence says, or widen the window: --from, --to"
    says format!("{id}: no {part}: {reason}");

    /// A form of a model, or the diagram of a method, does not exist.
    CR462 PartLeftOut { id: String, part: String, reason: String }
    bears on (About::IdentifiedModels, Weight::None)
    decided "A continuous model is a logarithm that a sampled one may not have. A transfer function needs coefficients \
             that can be computed. A stabilisation diagram needs orders of two and more."
    means "What is written of the model holds. This form of it is missing."
    remedy "nothing; a lower order may have it: --orders"
    says format!("{id}: no {part}: {reason}");

    /// The continuous model has one more state than the sampled one.
    CR463 PoleConjugated { id: String, z: f64 }
    bears on (About::IdentifiedModels, Weight::None)
    decided "A negative real pole of a sampled model has no real logarithm. It gets a conjugate at the Nyquist \
             frequency."
    means "Both models agree at the samples. Between them the continuous one oscillates at the Nyquist frequency."
    remedy "use the sampled model, or try another order: --orders"
    says format!(
        "{id}: the pole z = {z:.6} has no continuous counterpart: the continuous model has one more state, a conjugate \
         at the Nyquist frequency, and agrees at the samples only"
    );

    /// Zeros cancel poles of the model: the order is too high.
    CR464 PolesCancelled {
        id: String, frequencies: Vec<String>, rest: usize, fewer: usize, fit_percent: f64, without_percent: f64
    }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "Output error is fitted again without each pole or pair. BIC falls, and of one input and one output a zero \
             lies beside the pole, no further than noise brings it at 95 % (Ljung, System Identification, 1999, ch. \
             16)."
    means "These poles are products of noise. They are not among the modes and have no interval; the output holds."
    remedy "identify with fewer states: --orders, --poles"
    says format!(
        "{id}: zeros cancel the poles at {}: they are no modes. A model of {rest} poles, {fewer} fewer, is as good by \
         BIC (fit {without_percent:.2} % against {fit_percent:.2} %)",
        frequencies.join(", ")
    );

    /// The method has no standard deviations of its own.
    CR465 NoDeviations { id: String, method: String }
    bears on (About::IdentifiedModels, Weight::None)
    decided "tfest, exponentials, output-error, and arx of one output have a linearised covariance; others have none."
    means "Frequencies and damping ratios have no error beside them."
    remedy "add --bootstrap 60: standard deviations and 90 % intervals of every method"
    says format!("{id}: no standard deviations: {}", no_covariance(method));

    /// Residual tests are those of the one-step prediction.
    CR466 TestsOfPrediction { id: String }
    bears on (About::IdentifiedModels, Weight::None)
    decided "arx and okid are fitted to the one-step prediction, whose errors are white where the model is true."
    means "Whiteness and correlation say whether the prediction is complete. Fit and criteria are of the simulation."
    remedy "nothing"
    says format!(
        "{id}: whiteness and correlation with the input are those of the one-step prediction errors, all else of the \
         simulation"
    );
}
