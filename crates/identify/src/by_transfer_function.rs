//! The method `tfest`: a continuous transfer function from one waveform to another.

use crumple_identify::{
    Hold, InitialConditions, Stop, TransferFunctionArray, TransferFunctionFit, TransferFunctionOptions,
    transfer_function_array, transfer_function_fit,
};
use crumple_lti::Complex;
use crumple_signal::{QuantityKind, TestDescription};
use crumple_stage::records::TransferFunctionV1;
use crumple_stage::{Inputs, Outcome, Output, RefuseExt};

use crate::evidence::{
    evidence, growth_notes, identification, modes, of_record, percent, put_evidence, put_transfer_functions,
};
use crate::input_output::{Cut, Record, record};
use crate::options::Settings;
use crate::to_records::state_space;

/// Poles within this of zero, times the length of the record, are integrators.
const INTEGRATOR: f64 = 0.5;

/// One transfer function for every limit of iterations.
pub fn run(settings: &Settings, test: &TestDescription, inputs: &Inputs, out: &mut Output) -> anyhow::Result<Outcome> {
    let Some(beyond) = &settings.beyond_era else { return Ok(Outcome::Done) };
    let record = record(settings, beyond, test, inputs)?;
    let options = TransferFunctionOptions {
        hold: if beyond.hold == "zero-order" { Hold::Zero } else { Hold::First },
        delay: beyond.delay,
        initial: match beyond.initial.as_str() {
            "zero" => InitialConditions::Zero,
            "auto" => InitialConditions::Auto,
            _ => InitialConditions::Estimate,
        },
        stable: beyond.stable,
        starts: beyond.start_kinds(),
        ..TransferFunctionOptions::new(beyond.poles, beyond.zeros)
    };
    for &max_iterations in &beyond.max_iterations {
        let options = TransferFunctionOptions { stop: Stop { max_iterations, ..Stop::default() }, ..options.clone() };
        let mut id = format!("tfest-{}-{}", beyond.poles, beyond.zeros);
        let mut notes = Vec::new();
        if max_iterations < beyond.most_iterations() {
            id.push_str(&format!("-after-{max_iterations}"));
            notes.push(format!("{id}: every start is stopped after {max_iterations} iterations, converged or not"));
        }
        let hint = "widen the window (--from, --to), lower --poles, or name other waveforms";
        if record.single() {
            let fit = transfer_function_fit(&record.data, &options).refuse_with_hint(hint)?;
            remarks(&id, &fit, &record.drives[0], &record.answers[0], &mut notes);
            put(&id, &fit, (&record.drives[0], &record.answers[0]), beyond, &notes, out)?;
        } else {
            let fit = transfer_function_array(&record.data, &options).refuse_with_hint(hint)?;
            growth_notes(&id, &fit.modes.iter().map(|mode| mode.pole).collect::<Vec<_>>(), &mut notes);
            notes.push(format!("{id}: one denominator for all paths, a numerator for each"));
            condition_note(&id, fit.condition, &mut notes);
            put_array(&id, &fit, &record, beyond, &notes, out)?;
        }
        for note in notes {
            match note.strip_prefix("warning: ") {
                Some(text) => out.notes().warning(text),
                None => out.notes().info(note),
            }
        }
    }
    Ok(Outcome::Done)
}

/// What a reader should know before believing the coefficients.
fn remarks(id: &str, fit: &TransferFunctionFit, drive: &Cut, answer: &Cut, notes: &mut Vec<String>) {
    let poles: Vec<Complex> = fit.modes.iter().map(|mode| mode.pole).collect();
    growth_notes(id, &poles, notes);
    let duration = answer.sampled.len() as f64 * answer.sampled.dt_s();
    let slow = poles.iter().filter(|s| s.norm() * duration < INTEGRATOR).count();
    if drive.quantity == QuantityKind::Acceleration && answer.quantity == QuantityKind::Displacement && slow >= 2 {
        notes.push(format!(
            "warning: {id}: two poles lie at zero: the model integrates the acceleration twice, which is true of any body and says nothing about this car"
        ));
    }
    if let Some(zero) = fit.zeros.iter().find(|zero| zero.re > 0.0) {
        notes.push(format!("{id}: the zero {:.4} {:+.4}i 1/s lies in the right half plane", zero.re, zero.im));
    }
    let numerator = fit.transfer_function.numerator();
    let shown = &fit.numerator_deviations[fit.numerator_deviations.len() - numerator.len()..];
    for (power, (b, deviation)) in numerator.iter().rev().zip(shown.iter().rev()).enumerate() {
        if 1.96 * deviation > b.abs() {
            notes.push(format!(
                "warning: {id}: the numerator's coefficient of s^{power}, {b:.6e} with standard deviation {deviation:.2e}, is not known even in sign"
            ));
        }
    }
    condition_note(id, fit.condition, notes);
}

fn condition_note(id: &str, condition: f64, notes: &mut Vec<String>) {
    if condition > 1e8 {
        notes.push(format!(
            "warning: {id}: condition number {condition:.1e}: the curve is known, single coefficients are not"
        ));
    }
}

/// Records of several inputs or outputs.
fn put_array(
    id: &str,
    fit: &TransferFunctionArray,
    record: &Record,
    beyond: &crate::options::BeyondEra,
    notes: &[String],
    out: &mut Output,
) -> anyhow::Result<()> {
    let entry = |i: usize, j: usize| {
        let tf = &fit.entries[i][j];
        (tf.numerator().to_vec(), tf.denominator().to_vec())
    };
    put_transfer_functions(id, record, entry, out)?;
    out.put(&format!("/model/{id}/continuous"), &state_space(&fit.state_space, &record.input(), &record.output()))?;
    out.put(&format!("/modes/{id}"), &modes(fit.modes.iter().map(|mode| (*mode, None))))?;
    let (whole, mut supports) =
        of_record("tfest", beyond.poles, record, &fit.simulated, fit.parameters, notes.to_vec());
    let finite = |values: &[f64]| if values.iter().all(|x| x.is_finite()) { values.to_vec() } else { Vec::new() };
    for (i, support) in supports.iter_mut().enumerate() {
        support.hold = Some(beyond.hold.clone());
        support.initial_conditions = if fit.initial_estimated { "estimated" } else { "zero" }.to_owned();
        support.start = Some(fit.start.name().to_owned());
        support.stop_reason = Some(fit.termination.name().to_owned());
        support.iterations = u32::try_from(fit.iterations).ok();
        support.evaluations = Some(fit.evaluations as u64);
        support.losses = fit.losses.clone();
        support.condition = Some(fit.condition).filter(|c| c.is_finite());
        // Of every input, one after the other.
        support.numerator_deviations = finite(&fit.numerator_deviations[i].concat());
        support.denominator_deviations = finite(&fit.denominator_deviations);
        support.frequency_deviations = fit.mode_deviations.iter().map(|d| d.map(|d| d.0)).collect();
        support.damping_deviations = fit.mode_deviations.iter().map(|d| d.map(|d| d.1)).collect();
    }
    let percent = percent(whole.fit_percent);
    out.put(&format!("/identification/{id}"), &whole)?;
    put_evidence(id, &supports, out)?;
    out.summary(format!(
        "{id}: {percent} of {} samples, {} after {} iterations from start {}",
        record.data.samples(),
        fit.termination.name(),
        fit.iterations,
        fit.start.name()
    ));
    Ok(())
}

fn put(
    id: &str,
    fit: &TransferFunctionFit,
    (drive, answer): (&Cut, &Cut),
    beyond: &crate::options::BeyondEra,
    notes: &[String],
    out: &mut Output,
) -> anyhow::Result<()> {
    let (input, output) = (drive.describe(), answer.describe());
    out.put(
        &format!("/model/{id}/transfer-function"),
        &TransferFunctionV1 {
            numerator: fit.transfer_function.numerator().to_vec(),
            denominator: fit.transfer_function.denominator().to_vec(),
            input: input.clone(),
            output: output.clone(),
        },
    )?;
    out.put(&format!("/model/{id}/continuous"), &state_space(&fit.state_space, &input, &output))?;
    out.put(&format!("/modes/{id}"), &modes(fit.modes.iter().map(|mode| (*mode, None))))?;
    let record = identification("tfest", beyond.poles, "input-output", answer, &fit.simulated, notes.to_vec());
    let finite = |values: &[f64]| if values.iter().all(|x| x.is_finite()) { values.to_vec() } else { Vec::new() };
    let mut support = evidence(Some(drive), answer, &fit.simulated, fit.criteria.parameters);
    support.hold = Some(beyond.hold.clone());
    support.initial_conditions = if fit.initial_estimated { "estimated" } else { "zero" }.to_owned();
    support.start = Some(fit.start.name().to_owned());
    support.stop_reason = Some(fit.termination.name().to_owned());
    support.iterations = u32::try_from(fit.iterations).ok();
    support.evaluations = Some(fit.evaluations as u64);
    support.losses = fit.losses.clone();
    support.condition = Some(fit.condition).filter(|c| c.is_finite());
    support.numerator_deviations = finite(&fit.numerator_deviations);
    support.denominator_deviations = finite(&fit.denominator_deviations);
    support.frequency_deviations = fit.mode_deviations.iter().map(|d| d.map(|d| d.0)).collect();
    support.damping_deviations = fit.mode_deviations.iter().map(|d| d.map(|d| d.1)).collect();
    support.zeros_re_per_s = fit.zeros.iter().map(|zero| zero.re).collect();
    support.zeros_im_rad_per_s = fit.zeros.iter().map(|zero| zero.im).collect();
    let percent = percent(record.fit_percent);
    out.put(&format!("/identification/{id}"), &record)?;
    out.put(&format!("/evidence/{id}"), &support)?;
    out.summary(format!(
        "{id}: {percent} of {} samples, {} after {} iterations from start {}",
        answer.sampled.len(),
        fit.termination.name(),
        fit.iterations,
        fit.start.name()
    ));
    Ok(())
}
