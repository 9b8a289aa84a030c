//! The method `tfest`: continuous transfer functions from waveforms to others.

use std::f64::consts::TAU;

use crumple_numerics::lti::{Complex, StateSpace};
use crumple_signal::{Notes, QuantityKind};
use crumple_stage::records::EvidenceV1;
use crumple_stage::{Outcome, RefuseExt};
use crumple_sysid::{
    InitialConditions, IoData, PoleKind, Stop, TransferFunctionArray, TransferFunctionFit, TransferFunctionOptions,
    compare, continued, pole_kinds, response_deviations, sampled, transfer_function_array, transfer_function_fit,
};
use nalgebra::DVector;

use crate::stage::options::choices::Method;
use crate::stage::options::paper;
use crate::stage::options::settings::{InputOutputSettings, Settings};
use crate::stage::records::discrete::note_on_fit;
use crate::stage::records::evidence::{
    Poles, fit_in_words, identification, identification_with_evidence, if_determined, notes_on_poles, pole_record,
    put_search, put_transfer_functions, simulation_evidence, validate_all, validation_summary,
};
use crate::stage::records::realization::state_space;
use crate::stage::records::responses::{Band, ModelResponses, note_limits, put_spreads, spread};
use crate::stage::records::results::Results;
use crate::stage::waves::{Record, Source, WindowedWave, record};

/// One transfer function, or an array of them, for every limit of iterations.
pub fn run(source: Source<'_>, results: &mut Results<'_>) -> anyhow::Result<Outcome> {
    let settings = source.settings;
    let Some(input_output) = &settings.input_output else { return Ok(Outcome::Done) };
    let record = record(source, input_output)?;
    let options = TransferFunctionOptions {
        hold: input_output.hold.into(),
        delay: input_output.delay,
        initial: input_output.initial.into(),
        stable: input_output.stable,
        starts: input_output.start_kinds(),
        ..TransferFunctionOptions::new(input_output.poles, input_output.zeros)
    };
    for &max_iterations in &input_output.max_iterations {
        let options = TransferFunctionOptions { stop: Stop { max_iterations, ..Stop::default() }, ..options.clone() };
        let mut id = format!("tfest-{}-{}", input_output.poles, input_output.zeros);
        let mut limit = None;
        if max_iterations < input_output.most_iterations() {
            id.push_str(&format!("-after-{max_iterations}"));
            limit = Some(format!("{id}: every start is stopped after {max_iterations} iterations, converged or not"));
        }
        if settings.paper.is_some() {
            id.push_str("-paper");
        }
        let task = TransferFunctionTask { id: &id, options: &options, settings, input_output, record: &record };
        let mut notes = Notes::new();
        limit.into_iter().for_each(|text| notes.info(text));
        if let Some(paper) = settings.paper {
            paper::remarks(paper).iter().for_each(|remark| notes.info(*remark));
        }
        let hint = "widen the window (--from, --to), lower --poles, or name other waveforms";
        if record.single() {
            let fit = transfer_function_fit(&record.data, &options).refuse_with_hint(hint)?;
            notes.extend(preparation(&id, &record));
            notes.extend(remarks(&id, &fit, &record.inputs[0], &record.outputs[0]));
            put_transfer_function(&task, &fit, &mut notes, results)?;
        } else {
            let fit = transfer_function_array(&record.data, &options).refuse_with_hint(hint)?;
            put_array(&task, &fit, &mut notes, results)?;
        }
        results.out.notes().extend(notes);
    }
    Ok(Outcome::Done)
}

/// What a reader should know before believing the coefficients.
fn remarks(id: &str, fit: &TransferFunctionFit, drive: &WindowedWave, answer: &WindowedWave) -> Notes {
    let poles: Vec<Complex> = fit.modes.iter().map(|mode| mode.pole).collect();
    let mut notes = notes_on_poles(id, &poles, &[answer, drive]);
    let kinds = pole_kinds(&poles, pole_record(&[answer, drive]));
    let of_motion = drive.quantity == QuantityKind::Acceleration && answer.quantity == QuantityKind::Displacement;
    for (zero, deviation) in
        fit.zeros.iter().zip(&fit.zero_deviations).filter(|(zero, _)| zero.re > 0.0 && zero.im >= 0.0)
    {
        let sure = deviation.map_or("not determined".to_owned(), |(re, _)| format!("standard deviation {re:.2}"));
        let place = format!("{id}: the zero {:.4} {:+.4}i 1/s ({sure}) lies in the right half plane", zero.re, zero.im);
        if of_motion {
            notes.warning(format!(
                "{place}: a chain of springs and dampers has it at -k2/c2, on the left; with positive constants this \
                 model is impossible"
            ));
        } else {
            notes.info(place);
        }
    }
    let gain = fit.transfer_function.at(Complex::new(0.0, 0.0)).re;
    if of_motion && !kinds.contains(&PoleKind::Integrator) && poles.iter().all(|s| s.re < 0.0) {
        let exact = "the true system is 1/s^2 and has none";
        if gain < 0.0 {
            notes.warning(format!(
                "{id}: the gain at rest, {gain:.4e} s^2, is negative: a steady forward acceleration would move the \
                 body backward; {exact}"
            ));
        } else {
            notes.info(format!(
                "{id}: the gain at rest, {gain:.4e} s^2, follows from the length of the record; \
                {exact}"
            ));
        }
    }
    let numerator = fit.transfer_function.numerator();
    let shown = &fit.numerator_deviations[fit.numerator_deviations.len() - numerator.len()..];
    for (power, (b, deviation)) in numerator.iter().rev().zip(shown.iter().rev()).enumerate() {
        if 1.96 * deviation > b.abs() {
            notes.warning(format!(
                "{id}: the numerator's coefficient of s^{power}, {b:.6e} with standard deviation {deviation:.2e}, may \
                 have either sign (at 95 %)"
            ));
        }
    }
    condition_note(id, fit.search.condition, &mut notes);
    note_on_fit(id, fit.fit.and_then(|fit| fit.fit_percent), &mut notes);
    notes
}

fn put_transfer_function(
    task: &TransferFunctionTask<'_>,
    fit: &TransferFunctionFit,
    notes: &mut Notes,
    results: &mut Results<'_>,
) -> anyhow::Result<()> {
    let TransferFunctionTask { id, options, settings, input_output, record } = *task;
    let (data, drive, answer) = (&record.data, &record.inputs[0], &record.outputs[0]);
    let (input, output) = (drive.describe(), answer.describe());
    let tf = &fit.transfer_function;
    put_transfer_functions(id, record, |_, _| (tf.numerator().to_vec(), tf.denominator().to_vec()), results.out)?;
    results
        .out
        .put(&format!("/model/{id}/continuous"), &state_space(&fit.state_space, &input, &output, record.delay_s))?;
    let poles_of_model = Poles::of(fit.modes.iter().map(|mode| (*mode, None)), pole_record(&record.waves()));
    poles_of_model.put(id, results.out)?;
    let mut evidence = simulation_evidence(Some(drive), answer, &fit.simulated, fit.criteria.parameters);
    put_search(&fit.search, input_output.hold, settings.paper, &mut evidence);
    evidence.numerator_deviations = if_determined(&fit.numerator_deviations);
    evidence.denominator_covariance = fit.denominator_covariance();
    evidence.zeros_re_per_s = fit.zeros.iter().map(|zero| zero.re).collect();
    evidence.zeros_im_rad_per_s = fit.zeros.iter().map(|zero| zero.im).collect();
    evidence.zero_re_deviations = fit.zero_deviations.iter().map(|d| d.map(|d| d.0)).collect();
    evidence.zero_im_deviations = fit.zero_deviations.iter().map(|d| d.map(|d| d.1)).collect();
    validate_continuous(task, &fit.state_space, fit.search.initial_estimated, std::slice::from_mut(&mut evidence))?;

    let responses = responses_of(fit, answer, options.delay);
    let grid = responses.grid_hz();
    let initial = if fit.search.initial_estimated { InitialConditions::Estimate } else { InitialConditions::Zero };
    let poles = vec![responses.poles.clone()];
    let again = TransferFunctionOptions { starts: Vec::new(), given: poles, initial, ..options.clone() };
    let bootstrap = spread(
        settings.bootstrap.as_ref(),
        (id, &responses.sample(&grid)),
        (answer.sampled.samples(), &fit.simulated),
        fit.criteria.parameters,
        notes,
        |y| {
            let data = IoData::single(data.inputs()[0].clone(), y.to_vec(), data.sample_time_s()).ok()?;
            Some(responses_of(&transfer_function_fit(&data, &again).ok()?, answer, options.delay).sample(&grid))
        },
    );
    if let Some(bootstrap) = &bootstrap {
        put_spreads(bootstrap, &mut evidence);
    }
    let band = match (&bootstrap, &fit.coefficient_covariance) {
        (Some(bootstrap), _) => Some(Band::from_bootstrap(bootstrap)),
        (None, Some(covariance)) => {
            let rad_per_s: Vec<f64> = grid.iter().map(|f| TAU * f).collect();
            let magnitude: Vec<f64> = responses.sample(&grid).response.iter().map(|h| h.norm()).collect();
            let deviations =
                response_deviations(&fit.transfer_function, input_output.zeros + 1, covariance, &rad_per_s);
            Some(Band::from_deviations(&magnitude, &deviations))
        }
        (None, None) => None,
    };
    if let Some(response) = responses.response(&input, &output, band.as_ref()) {
        results.out.put(&format!("/response/{id}"), &response)?;
    }
    let mut whole =
        identification(Method::Tfest, input_output.poles, "input-output", answer, &fit.simulated, notes.to_texts());
    whole.delay_s = record.delay_s;
    let percent = fit_in_words(whole.fit_percent);
    results.out.put(&format!("/identification/{id}"), &whole)?;
    poles_of_model.keep_those_of_modes(std::slice::from_mut(&mut evidence));
    results.enter(id, &whole, std::slice::from_mut(&mut evidence))?;
    results.out.summary(format!(
        "{id}: {percent} of {} samples, {} after {} iterations from start {}{}",
        answer.sampled.len(),
        fit.search.stop_reason.name_with_bounds(fit.search.on_bound),
        fit.search.iterations,
        fit.search.start.name(),
        validation_summary(std::slice::from_ref(&evidence))
    ));
    Ok(())
}

fn responses_of<'a>(fit: &'a TransferFunctionFit, answer: &WindowedWave, delay: usize) -> ModelResponses<'a> {
    ModelResponses {
        continuous: Some(&fit.state_space),
        discrete: None,
        poles: fit.modes.iter().map(|mode| mode.pole).collect(),
        zeros: fit.zeros.clone(),
        dt_s: answer.sampled.dt_s(),
        samples: answer.sampled.len(),
        delay,
    }
}

/// What transfer functions are for and from.
pub struct TransferFunctionTask<'a> {
    /// Id of the model.
    pub id: &'a str,
    /// How it was fitted.
    pub options: &'a TransferFunctionOptions,
    /// Settings of the stage.
    pub settings: &'a Settings,
    /// Those beside `era`.
    pub input_output: &'a InputOutputSettings,
    /// The waveforms.
    pub record: &'a Record,
}

/// What was done to the waveforms before the fit.
pub fn preparation(id: &str, record: &Record) -> Notes {
    let mut notes = Notes::new();
    record.remarks.iter().for_each(|remark| notes.info(format!("{id}: {remark}")));
    if let Some(delay_s) = record.delay_s {
        notes.info(format!(
            "{id}: the input acts {delay_s:.6} s late: the coefficients have no delay in them, delay_s and the \
             responses have"
        ));
    }
    notes
}

/// Says so where the fit determines no single coefficient.
pub fn condition_note(id: &str, condition: f64, notes: &mut Notes) {
    if condition > 1e8 {
        notes.warning(format!(
            "{id}: condition number {condition:.1e}: this record does not determine the single coefficients"
        ));
    }
}

/// Puts the fit of the kept samples into the evidence, if there are any.
pub fn validate_continuous(
    task: &TransferFunctionTask<'_>,
    model: &StateSpace,
    initial_estimated: bool,
    evidence: &mut [EvidenceV1],
) -> anyhow::Result<()> {
    let TransferFunctionTask { options, record, .. } = *task;
    if record.outputs[0].kept.is_empty() {
        return Ok(());
    }
    let (model, rest) = sampled(model, options.hold, record.data.sample_time_s())?;
    let (first, whole) = (record.data.delayed(options.delay), record.whole.delayed(options.delay));
    let start = rest * DVector::from_iterator(first.inputs().len(), first.inputs().iter().map(|u| u[0]));
    let simulated = continued(&model, &first, &whole, (!initial_estimated).then_some(start.as_slice()))?;
    validate_all(record, &simulated, evidence);
    // The protocol of published comparisons: the initial state is fitted to the kept samples.
    let restarted = compare(&model, &whole.slice(first.samples(), whole.samples())?)?;
    for (output_evidence, fit) in evidence.iter_mut().zip(restarted) {
        output_evidence.validation_restarted_fit_percent = fit.and_then(|fit| fit.fit_percent);
    }
    Ok(())
}

/// Writes the records of one array and a summary line.
pub fn put_array(
    task: &TransferFunctionTask<'_>,
    fit: &TransferFunctionArray,
    notes: &mut Notes,
    results: &mut Results<'_>,
) -> anyhow::Result<()> {
    let TransferFunctionTask { id, settings, input_output, record, .. } = *task;
    notes.extend(preparation(id, record));
    let poles: Vec<Complex> = fit.modes.iter().map(|mode| mode.pole).collect();
    notes.extend(notes_on_poles(id, &poles, &record.waves()));
    notes.info(format!("{id}: one denominator for all paths, a numerator for each"));
    condition_note(id, fit.search.condition, notes);
    for measures in fit.fits.iter().flatten() {
        note_on_fit(id, measures.fit_percent, notes);
    }
    note_limits(id, (record.inputs.len(), record.outputs.len()), settings.bootstrap.as_ref(), notes);
    if settings.bootstrap.is_some() && record.outputs.len() == 1 {
        notes.warning(format!("{id}: no bootstrap: of transfer functions it is made for one input and one output"));
    }
    let entry = |i: usize, j: usize| {
        let tf = &fit.entries[i][j];
        (tf.numerator().to_vec(), tf.denominator().to_vec())
    };
    put_transfer_functions(id, record, entry, results.out)?;
    results.out.put(
        &format!("/model/{id}/continuous"),
        &state_space(&fit.state_space, &record.input(), &record.output(), record.delay_s),
    )?;
    let poles = Poles::of(fit.modes.iter().map(|mode| (*mode, None)), pole_record(&record.waves()));
    poles.put(id, results.out)?;
    let (whole, mut evidence) = identification_with_evidence(
        Method::Tfest,
        input_output.poles,
        record,
        &fit.simulated,
        fit.parameters,
        notes.to_texts(),
    );
    for (output_evidence, deviations) in evidence.iter_mut().zip(&fit.numerator_deviations) {
        put_search(&fit.search, input_output.hold, settings.paper, output_evidence);
        // Of every input, one after the other.
        output_evidence.numerator_deviations = if_determined(&deviations.concat());
    }
    validate_continuous(task, &fit.state_space, fit.search.initial_estimated, &mut evidence)?;
    let percent = fit_in_words(whole.fit_percent);
    results.out.put(&format!("/identification/{id}"), &whole)?;
    poles.keep_those_of_modes(&mut evidence);
    results.enter(id, &whole, &mut evidence)?;
    results.out.summary(format!(
        "{id}: {percent} of {} samples, {} after {} iterations from start {}{}",
        record.data.samples(),
        fit.search.stop_reason.name_with_bounds(fit.search.on_bound),
        fit.search.iterations,
        fit.search.start.name(),
        validation_summary(&evidence)
    ));
    Ok(())
}
