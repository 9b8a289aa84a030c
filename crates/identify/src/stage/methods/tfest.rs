//! The method `tfest`: continuous transfer functions from waveforms to others.

use std::f64::consts::TAU;

use crumple_numerics::lti::{Complex, InputHold, TransferFunction};
use crumple_signal::{About, Notes, QuantityKind, Weight, remarks};
use crumple_stage::records::EvidenceV1;
use crumple_stage::{Outcome, RefuseExt};
use crumple_sysid::{
    Hold, InitialConditions, IoData, PoleKind, Stop, TransferFunctionFit, TransferFunctionOptions, mode_shapes,
    pole_kinds, response_deviations, sampled, transfer_function_fit,
};
use nalgebra::DVector;

use crate::stage::methods::discrete::{InputLate, StatesOfPaths};
use crate::stage::options::choices::Method;
use crate::stage::options::paper;
use crate::stage::options::paper::AsPrinted;
use crate::stage::options::settings::{InputOutputSettings, Settings};
use crate::stage::records::discrete::{note_on_fit, take_out_cancelled};
use crate::stage::records::evidence::{
    NamedNumbers, Poles, if_determined, notes_on_poles, of_model, pole_record, put_search,
};
use crate::stage::records::lines::{self, ILL_CONDITIONED, with_deviation};
use crate::stage::records::model::{FittedModel, Forms, Simulated, evidence_of, treated_as};
use crate::stage::records::realization::shapes;
use crate::stage::records::responses::{Band, ModelResponses};
use crate::stage::records::results::Results;
use crate::stage::waves::{Record, Source, WindowedWave, flag, record, widen_the_window};

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
            limit = Some(StoppedEarly { id: id.clone(), iterations: max_iterations });
        }
        if settings.paper.is_some() {
            id.push_str("-paper");
        }
        let task = TransferFunctionTask { id: &id, options: &options, settings, input_output, record: &record };
        let mut notes = Notes::new();
        limit.into_iter().for_each(|limit| notes.push(limit));
        if let Some(paper) = settings.paper {
            paper::remarks(paper).iter().for_each(|remark| notes.push(AsPrinted::new(remark)));
        }
        let hint = format!("{}, lower {}, or name other waveforms", widen_the_window(), flag("poles"));
        notes.extend(preparation(&id, &record));
        let fit = transfer_function_fit(&record.data, &options).refuse_with_hint(hint)?;
        notes.extend(remarks(&id, &fit, &record));
        put(&task, &fit, notes, results)?;
    }
    Ok(Outcome::Done)
}

/// What a reader should know before believing the coefficients.
fn remarks(id: &str, fit: &TransferFunctionFit, record: &Record) -> Notes {
    let poles: Vec<Complex> = fit.modes.iter().map(|mode| mode.pole).collect();
    let mut notes = notes_on_poles(id, &poles, &record.waves());
    let mut unknown = Vec::new();
    if record.single() {
        unknown = unknown_coefficients(fit);
        // Zeros and gain of a numerator that nobody knows are no second warning.
        let numerator_is_known = unknown.is_empty() && fit.search.condition <= ILL_CONDITIONED;
        notes_on_path(id, fit, record, numerator_is_known, &mut notes);
    } else {
        notes.push(of_model(id, StatesOfPaths { poles: None, lags: None, outputs: None, states: None }));
    }
    coefficient_note(id, fit.search.condition, unknown, &mut notes);
    for (wave, measures) in record.outputs.iter().zip(&fit.fits) {
        let name = if record.single() { id.to_owned() } else { format!("{id}, {}", wave.id) };
        note_on_fit(&name, measures.and_then(|measures| measures.fit_percent), &mut notes);
    }
    notes
}

/// Zeros in the right half plane and the gain at rest of a single path.
fn notes_on_path(id: &str, fit: &TransferFunctionFit, record: &Record, numerator_is_known: bool, notes: &mut Notes) {
    let (drive, answer) = (&record.inputs[0], &record.outputs[0]);
    let poles: Vec<Complex> = fit.modes.iter().map(|mode| mode.pole).collect();
    let kinds = pole_kinds(&poles, pole_record(&[answer, drive]));
    let of_motion = drive.quantity == QuantityKind::Acceleration && answer.quantity == QuantityKind::Displacement;
    for (zero, deviation) in fit.zeros.iter().filter(|(zero, _)| zero.re > 0.0 && zero.im >= 0.0) {
        let deviation_per_s = deviation.map(|(re, _)| re);
        let (id, re_per_s, im_rad_per_s) = (id.to_owned(), zero.re, zero.im);
        if of_motion && numerator_is_known && deviation_per_s.is_some_and(|re| zero.re > 1.96 * re) {
            notes.push(ImpossibleZero { id, re_per_s, im_rad_per_s, deviation_per_s });
        } else {
            notes.push(RightHalfPlaneZero { id, re_per_s, im_rad_per_s, deviation_per_s });
        }
    }
    let gain_s2 = fit.entries[0][0].at(Complex::new(0.0, 0.0)).re;
    if of_motion && !kinds.contains(&PoleKind::Integrator) && poles.iter().all(|s| s.re < 0.0) {
        if gain_s2 < 0.0 && numerator_is_known {
            notes.push(NegativeGain { id: id.to_owned(), gain_s2 });
        } else {
            notes.push(GainAtRest { id: id.to_owned(), gain_s2 });
        }
    }
}

/// A zero in the right half plane, and how sure it is.
fn zero_in_words(id: &str, re: f64, im: f64, deviation: Option<f64>) -> String {
    let sure = deviation.map_or("not determined".to_owned(), |re| format!("standard deviation {re:.2}"));
    format!("{id}: the zero {re:.4} {im:+.4}i 1/s ({sure}) lies in the right half plane")
}

/// Coefficients of a numerator of which each may have either sign at 95 %, in words; none where one is known.
fn unknown_coefficients(fit: &TransferFunctionFit) -> Vec<String> {
    let (numerator, deviations) = (fit.entries[0][0].numerator(), &fit.numerator_deviations[0][0]);
    let shown = &deviations[deviations.len() - numerator.len()..];
    let powers = (0..numerator.len()).rev();
    let unknown = powers.zip(numerator.iter().zip(shown)).filter(|(_, (b, deviation))| 1.96 * **deviation > b.abs());
    let unknown: Vec<String> =
        unknown.map(|(power, (b, deviation))| format!("s^{power} {}", with_deviation(*b, Some(*deviation)))).collect();
    if unknown.len() < numerator.len() { Vec::new() } else { unknown }
}

/// One warning where coefficients are not known: those of either sign, and the condition of all.
fn coefficient_note(id: &str, condition: f64, unknown: Vec<String>, notes: &mut Notes) {
    let condition = Some(condition).filter(|condition| *condition > ILL_CONDITIONED);
    if condition.is_some() || !unknown.is_empty() {
        notes.push(NotDetermined { id: id.to_owned(), numbers: "coefficients".to_owned(), condition, unknown });
    }
}

/// What is known of every output.
fn evidence(task: &TransferFunctionTask<'_>, fit: &TransferFunctionFit) -> Vec<EvidenceV1> {
    let TransferFunctionTask { settings, input_output, record, .. } = *task;
    let mut evidence = evidence_of(&record.inputs, &record.outputs, &fit.simulated, fit.parameters);
    let covariance = if record.single() { fit.denominator_covariance() } else { Vec::new() };
    for (output_evidence, deviations) in evidence.iter_mut().zip(&fit.numerator_deviations) {
        put_search(&fit.search, input_output.hold, settings.paper, output_evidence);
        output_evidence.numerator_deviations = if_determined(&deviations.concat());
        output_evidence.denominator_covariance.clone_from(&covariance);
        output_evidence.zeros_re_per_s = fit.zeros.iter().map(|(zero, _)| zero.re).collect();
        output_evidence.zeros_im_rad_per_s = fit.zeros.iter().map(|(zero, _)| zero.im).collect();
        output_evidence.zero_re_deviations = fit.zeros.iter().map(|(_, d)| d.map(|d| d.0)).collect();
        output_evidence.zero_im_deviations = fit.zeros.iter().map(|(_, d)| d.map(|d| d.1)).collect();
    }
    if let Some((values, covariance)) = derivative(record).and_then(|derivative| fit.single_mass(derivative)) {
        let names = lines::SINGLE_MASS.iter().map(|(name, ..)| (*name).to_owned()).collect();
        NamedNumbers { names, values: values.to_vec(), covariance }.put(&mut evidence[0]);
    }
    evidence
}

/// By which derivative of a displacement a record answers to a force; `None` of other quantities.
fn derivative(record: &Record) -> Option<usize> {
    let [QuantityKind::Force] = record.inputs.iter().map(|wave| wave.quantity).collect::<Vec<_>>()[..] else {
        return None;
    };
    match record.outputs.iter().map(|wave| wave.quantity).collect::<Vec<_>>()[..] {
        [QuantityKind::Displacement] => Some(0),
        [QuantityKind::Velocity] => Some(1),
        [QuantityKind::Acceleration] => Some(2),
        _ => None,
    }
}

fn polynomials(tf: &TransferFunction) -> (Vec<f64>, Vec<f64>) {
    (tf.numerator().to_vec(), tf.denominator().to_vec())
}

/// Writes the model and says it on the screen.
fn put(
    task: &TransferFunctionTask<'_>,
    fitted: &TransferFunctionFit,
    mut notes: Notes,
    results: &mut Results<'_>,
) -> anyhow::Result<()> {
    let TransferFunctionTask { id, options, settings, input_output, record } = *task;
    let evidence = evidence(task, fitted);
    let simulated = simulated(task, fitted)?;
    let responses = responses_of(fitted, &record.outputs[0], options.delay);
    let band = fitted.coefficient_covariance.as_ref().filter(|_| record.single()).map(|covariance| {
        let grid = responses.grid_hz();
        let rad_per_s: Vec<f64> = grid.iter().map(|f| TAU * f).collect();
        let magnitude: Vec<f64> = responses.sample(&grid).response.iter().map(|h| h.norm()).collect();
        let deviations = response_deviations(&fitted.entries[0][0], options.zeros + 1, covariance, &rad_per_s);
        Band::from_deviations(&magnitude, &deviations)
    });
    let initial = if fitted.search.initial_estimated { InitialConditions::Estimate } else { InitialConditions::Zero };
    let poles = vec![responses.poles.clone()];
    let again = TransferFunctionOptions { starts: Vec::new(), given: poles, initial, ..options.clone() };
    let refit = |y: &[Vec<f64>], grid: &[f64]| {
        let data = IoData::new(record.data.inputs().to_vec(), y.to_vec(), record.data.sample_time_s()).ok()?;
        let refitted = transfer_function_fit(&data, &again).ok()?;
        Some(responses_of(&refitted, &record.outputs[0], options.delay).sample(grid))
    };
    let mut poles = Poles::of(fitted.modes.iter().map(|mode| (*mode, None)), pole_record(&record.waves()));
    let sampled: Vec<Complex> =
        fitted.modes.iter().map(|mode| (mode.pole * record.data.sample_time_s()).exp()).collect();
    let delayed = record.data.delayed(options.delay);
    take_out_cancelled((id, record), &delayed, &sampled, &mut poles, &mut notes);
    // Several inputs and outputs have each pole several times: a mode has no one shape then.
    let has_shapes = record.outputs.len() > 1 && fitted.state_space.order() == fitted.modes.len();
    let shapes = has_shapes.then(|| {
        let of_modes = mode_shapes(&fitted.state_space, &responses.poles);
        let modes = fitted.modes.iter().zip(poles.are_modes()).map(|(mode, is)| (mode.pole, is.then_some(*mode)));
        shapes(&modes.collect::<Vec<_>>(), &of_modes, &record.outputs)
    });
    FittedModel {
        id,
        method: Method::Tfest,
        order: input_output.poles,
        treated_as: treated_as(record),
        input: record.input(),
        inputs: &record.inputs,
        outputs: &record.outputs,
        delay_s: record.delay_s,
        forms: Forms {
            state_spaces: vec![("continuous", fitted.state_space.clone(), record.input())],
            paths: fitted.entries.iter().map(|of_inputs| of_inputs.iter().map(polynomials).collect()).collect(),
            is_transfer_function: true,
            ..Forms::default()
        },
        poles,
        shapes,
        simulated,
        evidence,
        hankel: (None, None),
        singular_values: Vec::new(),
        responses,
        band,
        bootstrap: settings.bootstrap.as_ref(),
        hold: (!record.inputs.is_empty()).then_some(match options.hold {
            Hold::Zero => InputHold::Zero,
            Hold::First => InputHold::First,
        }),
        refit: Box::new(refit),
        notes,
    }
    .put(results)
}

fn responses_of<'a>(fitted: &'a TransferFunctionFit, answer: &WindowedWave, delay: usize) -> ModelResponses<'a> {
    ModelResponses {
        continuous: Some(&fitted.state_space),
        discrete: None,
        poles: fitted.modes.iter().map(|mode| mode.pole).collect(),
        zeros: fitted.zeros.iter().map(|(zero, _)| *zero).collect(),
        dt_s: answer.sampled.dt_s(),
        samples: answer.sampled.len(),
        delay,
    }
}

/// The outputs on the record and on the samples kept after it.
fn simulated(task: &TransferFunctionTask<'_>, fitted: &TransferFunctionFit) -> anyhow::Result<Simulated> {
    let TransferFunctionTask { options, record, .. } = *task;
    let used = fitted.simulated.clone();
    if record.outputs[0].kept.is_empty() {
        return Ok(Simulated::all_used(used));
    }
    let (model, rest) = sampled(&fitted.state_space, options.hold, record.data.sample_time_s())?;
    let (first, whole) = (record.data.delayed(options.delay), record.whole.delayed(options.delay));
    let start = rest * DVector::from_iterator(first.inputs().len(), first.inputs().iter().map(|u| u[0]));
    let from_rest = (!fitted.search.initial_estimated).then_some(start.as_slice());
    Ok(Simulated::of_state_space(&model, used, (&first, &whole), from_rest)?)
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
    record.remarks.iter().for_each(|remark| notes.push(of_model(id, remark.clone())));
    if record.delay_s.is_some() {
        notes.push(of_model(id, InputLate { samples: None, delay_s: record.delay_s }));
    }
    notes
}

remarks! {
    /// Remarks of transfer functions.
    pub REMARKS;

    /// The fit was stopped after a few iterations.
    CR452 StoppedEarly { id: String, iterations: u32 }
    bears on (About::IdentifiedModels, Weight::None)
    decided "--max-iterations has several numbers: the largest gives the model to use, each smaller one a model of its \
             own."
    means "The model shows how far a fit of so many iterations is from the converged one. It is not the one to use."
    remedy "nothing; use the model without \"after\" in its name"
    says format!("{id}: every start is stopped after {iterations} iterations, converged or not");

    /// A transfer function has a zero in the right half plane.
    CR453 RightHalfPlaneZero { id: String, re_per_s: f64, im_rad_per_s: f64, deviation_per_s: Option<f64> }
    bears on (About::IdentifiedModels, Weight::None)
    decided "The real part of the zero is above 0."
    means "The response starts against its final direction. A delay looks like this, and so does a zero that is not \
           known."
    remedy "nothing, unless a delay is likely: --delay auto"
    says zero_in_words(id, *re_per_s, *im_rad_per_s, *deviation_per_s);

    /// A zero from acceleration to displacement lies where springs and dampers have none.
    CR454 ImpossibleZero { id: String, re_per_s: f64, im_rad_per_s: f64, deviation_per_s: Option<f64> }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "The real part of the zero is above 0 by more than 1.96 standard deviations, which is 95 %, and the \
             numerator is known."
    means "No positive springs and dampers give this model. Use its curve, and read no constants from it."
    remedy "do not solve for springs and dampers; try other numbers of poles and zeros: --poles, --zeros"
    says format!(
        "{}: a chain of springs and dampers has it at -k2/c2, on the left; with positive constants this model is \
         impossible",
        zero_in_words(id, *re_per_s, *im_rad_per_s, *deviation_per_s)
    );

    /// A transfer function from acceleration to displacement has a gain at rest, and the true one has none.
    CR455 GainAtRest { id: String, gain_s2: f64 }
    bears on (About::IdentifiedModels, Weight::None)
    decided "All poles decay, and none is an integrator. From an acceleration to its own displacement the truth is \
             1/s^2 (docs/methods/identification.md)."
    means "The gain follows from the length of the record. It says nothing of a stiffness."
    remedy "nothing; stiffness and damping need an input and an output at two places: --inputs, --outputs"
    says format!("{id}: the gain at rest is {gain_s2:.4e} s^2; the true system is 1/s^2 and has none");

    /// The gain at rest from acceleration to displacement is negative.
    CR456 NegativeGain { id: String, gain_s2: f64 }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "All poles decay, none is an integrator, the numerator is known, and the gain at rest is below 0."
    means "A steady forward acceleration would move the body backward. Use the curve within the window only."
    remedy "do not solve for springs and dampers; take an input and an output at two places: --inputs, --outputs"
    says format!(
        "{id}: the gain at rest, {gain_s2:.4e} s^2, is negative: a steady forward acceleration would move the body \
         backward; the true system is 1/s^2 and has none"
    );

    /// The record does not determine the single numbers of the model.
    CR457 NotDetermined { id: String, numbers: String, condition: Option<f64>, unknown: Vec<String> }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "The condition number of the sensitivities is above 1e8, or each coefficient of the numerator may have \
             either sign at 95 %."
    means "Other numbers follow the record as well. The curve of the model holds, its single numbers do not."
    remedy "use the curve only, or fewer poles, zeros or terms: --poles, --zeros, --terms"
    says match (&numbers[..], condition, &unknown[..]) {
        ("terms", condition, _) => format!(
            "{id}: condition number {:.1e}: this record does not determine the single terms; use their sum only",
            condition.unwrap_or(f64::INFINITY)
        ),
        (_, condition, []) => format!(
            "{id}: this record does not determine the single {numbers}: condition number {:.1e}",
            condition.unwrap_or(f64::INFINITY)
        ),
        (_, condition, several) => {
            let also = condition.map_or_else(String::new, |condition| format!("; condition number {condition:.1e}"));
            format!(
                "{id}: this record does not determine the single {numbers}: of the numerator {} may have either sign \
                 (at 95 %){also}",
                several.join(", ")
            )
        }
    };
}
