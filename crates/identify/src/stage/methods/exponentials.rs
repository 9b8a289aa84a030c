//! The method `exponentials`: a record as a sum of exponentials.

use clap::ValueEnum;
use crumple_numerics::lti::{Complex, Mode};
use crumple_signal::{About, Notes, QuantityKind, Weight, remarks};
use crumple_stage::records::{EvidenceV1, ExponentialTermV1};
use crumple_stage::{Inputs, Outcome, RefuseExt, Refused};
use crumple_sysid::{ExponentialOptions, ExponentialSumFit, ExponentialTerm, Sample, Stop, exponential_sum};

use crate::stage::methods::tfest::NotDetermined;
use crate::stage::options::choices::{Condition, Method, Paper};
use crate::stage::options::paper;
use crate::stage::options::paper::AsPrinted;
use crate::stage::options::settings::{InputOutputSettings, Settings};
use crate::stage::records::discrete::note_on_fit;
use crate::stage::records::evidence::{NamedNumbers, Poles, notes_on_poles, of_model, pole_record};
use crate::stage::records::lines::ILL_CONDITIONED;
use crate::stage::records::model::{FittedModel, Forms, Simulated, evidence_of};
use crate::stage::records::responses::ModelResponses;
use crate::stage::records::results::Results;
use crate::stage::waves::{Source, WindowedWave, flag, output, widen_the_window};

/// What one sum is fitted with.
struct SumTask {
    id: String,
    options: ExponentialOptions,
    /// Notes that come before all others.
    remarks: Vec<&'static str>,
    paper: Option<Paper>,
}

/// One sum; of the paper's curve fit a second one beside it, as the stage goes by itself.
pub fn run(source: Source<'_>, results: &mut Results<'_>) -> anyhow::Result<Outcome> {
    let Some(input_output) = &source.settings.input_output else { return Ok(Outcome::Done) };
    let answer = output(source, input_output)?;
    answer.removed().into_iter().for_each(|note| results.out.notes().push(note));
    let id = format!("exponentials-{}", input_output.terms);
    let options = |real: bool, start: Vec<f64>| ExponentialOptions {
        real,
        start,
        stop: Stop { max_iterations: input_output.most_iterations(), ..Stop::default() },
        ..ExponentialOptions::new(input_output.terms)
    };
    let Some(paper) = source.settings.paper.filter(|paper| paper::has_curve_fit(*paper)) else {
        let start = conditions(input_output.conditions, input_output, &answer, source.inputs)?;
        let task = SumTask { id, options: options(input_output.real, start), remarks: Vec::new(), paper: None };
        return fit_sum(&task, source.settings, &answer, results);
    };
    let printed = SumTask {
        id: format!("{id}-paper"),
        options: options(true, Vec::new()),
        remarks: paper::CURVE_FIT_REMARKS.to_vec(),
        paper: Some(paper),
    };
    // Contact: the position and the velocity of the record, as far as they are known.
    let held = if velocity(input_output, &answer, source.inputs)?.is_some() { 2 } else { 1 };
    let start = conditions(held, input_output, &answer, source.inputs)?;
    let remark = paper::BESIDE_CURVE_FIT[held - 1];
    let by_stage = SumTask { id, options: options(false, start), remarks: vec![remark], paper: None };
    let outcomes = [printed, by_stage].map(|task| fit_sum(&task, source.settings, &answer, results));
    // The second stands even where the first has no terms.
    let mut all = outcomes.into_iter().collect::<anyhow::Result<Vec<Outcome>>>()?.into_iter();
    let first = all.next().unwrap_or(Outcome::Done);
    Ok(if all.any(|outcome| matches!(outcome, Outcome::Done)) { Outcome::Done } else { first })
}

/// Value and derivatives at the first sample, as many as asked for.
fn conditions(
    count: usize,
    input_output: &InputOutputSettings,
    answer: &WindowedWave,
    inputs: &Inputs,
) -> anyhow::Result<Vec<f64>> {
    let mut start = Vec::new();
    if count > 0 {
        start.push(answer.sampled.samples()[0]);
    }
    if count > 1 {
        start.push(velocity(input_output, answer, inputs)?.ok_or_else(|| {
            Refused::new(format!("the velocity of {} at the start of the window is not known", answer.id)).hint(
                format!(
                    "give {}, leave \"velocity\" out of {}, or take a displacement as the first of {}",
                    flag("start-velocity"),
                    flag("conditions"),
                    flag("outputs")
                ),
            )
        })?);
    }
    if count > 2 {
        start.push(input_output.start_acceleration_m_per_s2.unwrap_or(0.0));
    }
    let given = input_output.start_velocity_m_per_s.is_some() || input_output.start_acceleration_m_per_s2.is_some();
    if given && answer.quantity != QuantityKind::Displacement {
        return Err(Refused::new(format!(
            "the conditions at the start are those of a displacement, {} is a {}",
            answer.id,
            answer.quantity.name()
        ))
        .hint(format!(
            "take a displacement as the first of {}, or leave out {} and {}",
            flag("outputs"),
            flag("start-velocity"),
            flag("start-acceleration")
        ))
        .into());
    }
    Ok(start)
}

/// The velocity at the first sample: as given, else that of the record, if it is there.
fn velocity(input_output: &InputOutputSettings, answer: &WindowedWave, inputs: &Inputs) -> anyhow::Result<Option<f64>> {
    if input_output.start_velocity_m_per_s.is_some() {
        return Ok(input_output.start_velocity_m_per_s);
    }
    let Some(base) = answer.id.strip_suffix("/displacement") else { return Ok(None) };
    Ok(inputs.wave_if(&format!("{base}/velocity")).and_then(|wave| wave.sampled.at(answer.sampled.t0_s())))
}

/// Fits one sum and writes its records.
fn fit_sum(
    task: &SumTask,
    settings: &Settings,
    answer: &WindowedWave,
    results: &mut Results<'_>,
) -> anyhow::Result<Outcome> {
    let SumTask { id, options, .. } = task;
    let record = answer.sampled.samples();
    let fit = exponential_sum(record, answer.sampled.dt_s(), options).refuse_with_hint(format!(
        "{}, lower {}, or name another of {}",
        widen_the_window(),
        flag("terms"),
        flag("outputs")
    ))?;
    let mut notes = fit_notes(task, &fit, answer);
    let poles: Vec<Complex> = fit.terms.iter().map(|term| term.exponent).collect();
    notes.extend(notes_on_poles(id, &poles, &[answer]));
    notes.push(TakenAsDecay { id: id.clone() });
    note_on_fit(id, fit.fit.and_then(|fit| fit.fit_percent), &mut notes);
    let terms: Vec<ExponentialTermV1> = fit
        .terms
        .iter()
        .map(|term| ExponentialTermV1 {
            re_amplitude: term.amplitude.re,
            im_amplitude: term.amplitude.im,
            re_per_s: term.exponent.re,
            im_rad_per_s: term.exponent.im,
        })
        .collect();
    if terms.iter().any(|t| !(t.re_amplitude.is_finite() && t.im_amplitude.is_finite())) {
        return Ok(Outcome::NoAcceptableResult(format!(
            "{id}: exponents coincide exactly, so that the sum has a term t exp(st), which the record cannot hold"
        )));
    }
    let (outputs, dt_s) = (std::slice::from_ref(answer), answer.sampled.dt_s());
    let mut evidence = evidence_of(&[], outputs, std::slice::from_ref(&fit.simulated), fit.criteria.parameters);
    fill_evidence(task, &fit, &mut evidence[0]);
    let after = record.len()..record.len() + answer.kept.len();
    let run_on: Vec<f64> = after.map(|k| value_at(&fit, k as f64 * dt_s)).collect();
    let run_on = if run_on.is_empty() { Vec::new() } else { vec![run_on] };
    let again = ExponentialOptions { random_starts: 0, given: vec![poles.clone()], ..options.clone() };
    let refit = |y: &[Vec<f64>], _: &[f64]| {
        let fit = exponential_sum(y.first()?, dt_s, &again).ok()?;
        Some(Sample { poles: fit.terms.iter().map(|term| term.exponent).collect(), ..Sample::default() })
    };
    let model = FittedModel {
        id,
        method: Method::Exponentials,
        order: options.terms,
        treated_as: "free-decay",
        input: String::new(),
        inputs: &[],
        outputs,
        delay_s: None,
        forms: Forms { terms, ..Forms::default() },
        poles: Poles::of(fit.terms.iter().map(|term| (Mode::continuous(term.exponent), None)), pole_record(&[answer])),
        shapes: None,
        simulated: Simulated { run_on, ..Simulated::all_used(vec![fit.simulated.clone()]) },
        evidence,
        hankel: (None, None),
        singular_values: Vec::new(),
        responses: ModelResponses {
            continuous: None,
            discrete: None,
            poles,
            zeros: Vec::new(),
            dt_s,
            samples: record.len(),
            delay: 0,
        },
        band: None,
        bootstrap: settings.bootstrap.as_ref(),
        hold: None,
        refit: Box::new(refit),
        notes,
    };
    model.put(results)?;
    Ok(Outcome::Done)
}

/// Notes on a fitted sum: those of its task, where time counts from, and how well its terms are determined.
fn fit_notes(task: &SumTask, fit: &ExponentialSumFit, answer: &WindowedWave) -> Notes {
    let mut notes = Notes::new();
    let id = &task.id;
    task.remarks.iter().for_each(|remark| notes.push(of_model(id, AsPrinted::new(remark))));
    let start = |t0_s, value, slope_per_s| StartOfSum { id: id.clone(), t0_s, value, slope_per_s };
    notes.push(start(Some(answer.sampled.t0_s()), None, None));
    if task.paper.is_some() {
        let sum = |part: fn(&ExponentialTerm) -> Complex| fit.terms.iter().map(part).sum::<Complex>().re;
        let (value, slope) = (sum(|term| term.amplitude), sum(|term| term.amplitude * term.exponent));
        notes.push(start(None, Some(value), Some(slope)));
    }
    if fit.condition > ILL_CONDITIONED {
        let (id, numbers) = (id.clone(), "terms".to_owned());
        notes.push(NotDetermined { id, numbers, condition: Some(fit.condition), unknown: Vec::new() });
    }
    notes
}

/// Fills in what the fit tells of itself: conditions at the start, deviations, how the search ended.
fn fill_evidence(task: &SumTask, fit: &ExponentialSumFit, evidence: &mut EvidenceV1) {
    let SumTask { options, paper, .. } = task;
    if !options.start.is_empty() {
        let values: Vec<String> =
            Condition::value_variants().iter().zip(&options.start).map(|(name, x)| format!("{name} {x:.6e}")).collect();
        evidence.initial_conditions = format!("held: {}", values.join(", "));
    }
    evidence.paper = paper.map(|paper| paper.to_string());
    evidence.frequency_deviations = fit.mode_deviations.iter().map(|d| d.map(|d| d.0)).collect();
    evidence.damping_deviations = fit.mode_deviations.iter().map(|d| d.map(|d| d.1)).collect();
    put_correlations(fit, evidence);
    evidence.stop_reason = Some(fit.stop_reason.name_with_bounds(fit.on_bound).to_owned());
    evidence.iterations = Some(fit.iterations);
    evidence.evaluations = Some(fit.evaluations);
    evidence.losses = fit.losses.clone();
    evidence.condition = Some(fit.condition).filter(|c| c.is_finite());
}

/// Names, values, standard deviations and correlations of amplitudes and exponents; without a covariance the reason
/// why.
fn put_correlations(fit: &ExponentialSumFit, evidence: &mut EvidenceV1) {
    let Some(covariance) = &fit.covariance else {
        evidence.no_deviations = Some("the sensitivities of the record do not determine the terms".to_owned());
        return;
    };
    let (names, values) = fit.numbers().into_iter().unzip();
    NamedNumbers { names, values, covariance: covariance.clone() }.put(evidence);
}

/// The sum at a time after the first sample.
fn value_at(fit: &ExponentialSumFit, time_s: f64) -> f64 {
    fit.terms.iter().map(|term| (term.amplitude * (term.exponent * time_s).exp()).re).sum()
}

remarks! {
    /// Remarks of sums of exponentials.
    pub REMARKS;

    /// Where the time of a sum of exponentials begins, and what the sum is there.
    CR441 StartOfSum { id: String, t0_s: Option<f64>, value: Option<f64>, slope_per_s: Option<f64> }
    bears on (About::IdentifiedModels, Weight::None)
    decided "Amplitudes and exponents are fitted to the samples of the window, and count from its first one."
    means "To compare amplitudes with others, move both to one time. Exponents do not depend on it."
    remedy "nothing; --conditions holds value and slope of the record at the start"
    says match t0_s {
        Some(t0_s) => format!("{id}: time of the exponents runs from the first sample, {t0_s} s"),
        None => format!(
            "{id}: at its start the sum is {:.6e}, its slope {:.6e}",
            value.unwrap_or_default(),
            slope_per_s.unwrap_or_default()
        ),
    };

    /// A record is taken for a free decay.
    CR442 TakenAsDecay { id: String }
    bears on (About::IdentifiedModels, Weight::None)
    decided "The method exponentials fits the samples without an input."
    means "Exponents are poles of the system only where nothing drives it from the first sample on."
    remedy "start the window where the free motion begins: --from, or take a method with an input, as tfest"
    says format!("{id}: the record is taken for a free decay from its first sample on: nothing may drive it");
}
