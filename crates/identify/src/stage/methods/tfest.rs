//! The method `tfest`: continuous transfer functions from waveforms to others.

use std::f64::consts::TAU;

use crumple_numerics::lti::Complex;
use crumple_signal::{Notes, QuantityKind};
use crumple_stage::{Outcome, RefuseExt};
use crumple_sysid::{
    Hold, InitialConditions, IoData, PoleKind, Stop, TransferFunctionFit, TransferFunctionOptions, pole_kinds,
    response_deviations, transfer_function_array, transfer_function_fit,
};

use crate::stage::options::paper;
use crate::stage::records::acceptance::note_on_fit;
use crate::stage::records::evidence::{
    fit_in_words, identification, if_determined, notes_on_poles, pole_record, put_search, put_transfer_functions,
    simulation_evidence, validation_summary,
};
use crate::stage::records::poles::Poles;
use crate::stage::records::realization::state_space;
use crate::stage::records::responses::{Band, ModelResponses, put_spreads, spread};
use crate::stage::records::results::Results;
use crate::stage::records::transfer_function_array::put_array;
use crate::stage::records::transfer_function_task::{
    TransferFunctionTask, condition_note, preparation, validate_continuous,
};
use crate::stage::waves::Source;
use crate::stage::waves::{WindowedWave, record};

/// One transfer function, or an array of them, for every limit of iterations.
pub fn run(source: Source<'_>, results: &mut Results<'_>) -> anyhow::Result<Outcome> {
    let settings = source.settings;
    let Some(input_output) = &settings.input_output else { return Ok(Outcome::Done) };
    let record = record(source, input_output)?;
    let options = TransferFunctionOptions {
        hold: if input_output.hold == "zero-order" { Hold::Zero } else { Hold::First },
        delay: input_output.delay,
        initial: match input_output.initial.as_str() {
            "zero" => InitialConditions::Zero,
            "auto" => InitialConditions::Auto,
            _ => InitialConditions::Estimate,
        },
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
        if let Some(name) = &settings.paper {
            paper::remarks(name).iter().for_each(|remark| notes.info(*remark));
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
    put_search(&fit.search, &input_output.hold, settings.paper.as_deref(), &mut evidence);
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
        identification("tfest", input_output.poles, "input-output", answer, &fit.simulated, notes.to_texts());
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
