//! The method `exponentials`: a record as a sum of exponentials.

use crumple_identify::{ExponentialOptions, ExponentialSumFit, Sample, Stop, exponential_sum};
use crumple_lti::{Complex, Mode};
use crumple_signal::TestDescription;
use crumple_stage::records::{ExponentialSumV1, ExponentialTermV1};
use crumple_stage::{Inputs, Outcome, Output, RefuseExt, Refused};

use crate::comparison::Comparison;
use crate::evidence::{evidence, foretold, identification, modes, notes_on_modes, percent, validate};
use crate::input_output::output;
use crate::judgement::{put_spreads, spread};
use crate::options::Settings;

/// One sum.
pub fn run(
    settings: &Settings,
    test: &TestDescription,
    inputs: &Inputs,
    comparison: &mut Comparison,
    out: &mut Output,
) -> anyhow::Result<Outcome> {
    let Some(beyond) = &settings.beyond_era else { return Ok(Outcome::Done) };
    let answer = output(settings, beyond, test, inputs)?;
    let record = answer.sampled.samples();
    let mut start = Vec::new();
    if beyond.conditions > 0 {
        start.push(record[0]);
    }
    if beyond.conditions > 1 {
        let velocity = match answer.id.strip_suffix("/displacement") {
            Some(base) => inputs.wave(&format!("{base}/velocity"))?.sampled.at(answer.sampled.t0_s()),
            None => None,
        };
        start.push(velocity.ok_or_else(|| {
            Refused::new(format!("the velocity of {} at the start of the window is not known", answer.id))
                .hint("leave \"velocity\" out of --conditions, or take a displacement as the first of --outputs")
        })?);
    }
    if beyond.conditions > 2 {
        start.push(0.0);
    }
    let options = ExponentialOptions {
        real: beyond.real,
        start,
        stop: Stop { max_iterations: beyond.most_iterations(), ..Stop::default() },
        ..ExponentialOptions::new(beyond.terms)
    };
    let fit = exponential_sum(record, answer.sampled.dt_s(), &options)
        .refuse_with_hint("widen the window (--from, --to), lower --terms, or name another of --outputs")?;
    let id = format!("exponentials-{}", beyond.terms);
    let mut notes = vec![format!("time of the exponents runs from the first sample, {} s", answer.sampled.t0_s())];
    if fit.condition > 1e8 {
        let text = format!(
            "{id}: condition number {:.1e}: the curve is known, its single terms are not; believe crush, time and energy only",
            fit.condition
        );
        out.notes().warning(text.clone());
        notes.push(format!("warning: {text}"));
    }
    let poles: Vec<Complex> = fit.terms.iter().map(|term| term.exponent).collect();
    let mut remarks = notes_on_modes(&id, &poles, &[&answer]);
    remarks.info(format!("{id}: the record is taken for a free decay from its first sample on: nothing may drive it"));
    let terms = fit
        .terms
        .iter()
        .map(|term| ExponentialTermV1 {
            re_amplitude: term.amplitude.re,
            im_amplitude: term.amplitude.im,
            re_per_s: term.exponent.re,
            im_rad_per_s: term.exponent.im,
        })
        .collect::<Vec<_>>();
    if terms.iter().any(|t| !(t.re_amplitude.is_finite() && t.im_amplitude.is_finite())) {
        return Ok(Outcome::NoAcceptableResult(format!(
            "{id}: exponents coincide exactly, so that the sum has a term t exp(st), which the record cannot hold"
        )));
    }
    out.put(&format!("/model/{id}"), &ExponentialSumV1 { terms, output: answer.describe() })?;
    out.put(&format!("/modes/{id}"), &modes(fit.terms.iter().map(|term| (Mode::continuous(term.exponent), None))))?;
    let mut support = evidence(None, &answer, &fit.simulated, fit.criteria.parameters);
    let again = ExponentialOptions { random_starts: 0, given: vec![poles.clone()], ..options.clone() };
    let found = spread(
        settings.bootstrap.as_ref(),
        (&id, &Sample { poles, ..Sample::default() }),
        (record, &fit.simulated),
        fit.criteria.parameters,
        &mut remarks,
        |y| {
            let fit = exponential_sum(y, answer.sampled.dt_s(), &again).ok()?;
            Some(Sample { poles: fit.terms.iter().map(|term| term.exponent).collect(), ..Sample::default() })
        },
    );
    if let Some(found) = &found {
        put_spreads(found, &mut support);
    }
    notes.extend(remarks.to_texts());
    out.notes().extend(remarks);
    let all = answer.sampled.len() + answer.kept.len();
    let curve: Vec<f64> = (0..all).map(|k| value_at(&fit, k as f64 * answer.sampled.dt_s())).collect();
    validate(&answer, &curve, &mut support);
    let record = identification("exponentials", beyond.terms, "free-decay", &answer, &fit.simulated, notes);
    if beyond.conditions > 0 {
        support.initial_conditions = format!("{} of the record's start held", beyond.conditions);
    }
    support.stop_reason = Some(fit.termination.name().to_owned());
    support.iterations = u32::try_from(fit.iterations).ok();
    support.evaluations = Some(fit.evaluations as u64);
    support.losses = fit.losses.clone();
    support.condition = Some(fit.condition).filter(|c| c.is_finite());
    let percent = percent(record.fit_percent);
    out.put(&format!("/identification/{id}"), &record)?;
    out.put(&format!("/evidence/{id}"), &support)?;
    comparison.enter(&id, answer.sampled.len(), std::slice::from_ref(&support));
    out.summary(format!(
        "{id}: {percent} of {} samples, {} after {} iterations{}",
        answer.sampled.len(),
        fit.termination.name(),
        fit.iterations,
        foretold(std::slice::from_ref(&support))
    ));
    Ok(Outcome::Done)
}

/// The sum at a time after the first sample.
fn value_at(fit: &ExponentialSumFit, time_s: f64) -> f64 {
    fit.terms.iter().map(|term| (term.amplitude * (term.exponent * time_s).exp()).re).sum()
}
