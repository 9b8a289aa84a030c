//! The choice among the candidates of a run, as a record and in words.

use crumple_lumped_fit::{Choice, ComparedCandidate, Comparison, EvaluatedCandidate, Rated, Solution, Strength};
use crumple_signal::{ANOTHER_VEHICLE, Axis, Notes};
use crumple_stage::records::{
    EventsV1, PriorTermV1, PriorV1, RatedCandidateV1, RecommendationEvidenceV1, RecommendationV1, StrengthV1,
};
use crumple_stage::{Inputs, Output};

use crate::stage::comparison::measured_test;
use crate::stage::inputs::Displaced;
use crate::stage::settings::StageSettings;

/// Chooses and writes `/recommendation`; without a comparison there is no choice, for a reason.
pub fn recommend(
    settings: &StageSettings,
    comparison: &Result<Comparison, String>,
    candidates: &[EvaluatedCandidate<'_>],
    out: &mut Output,
) -> anyhow::Result<()> {
    let record = match comparison {
        Ok(comparison) => chosen(settings, comparison, candidates, out),
        Err(because) => {
            out.summary(format!("none recommended: {because}"));
            without(because)
        }
    };
    out.put("/recommendation", &record)
}

/// The choice by this comparison, its words added to the summary.
fn chosen(
    settings: &StageSettings,
    comparison: &Comparison,
    candidates: &[EvaluatedCandidate<'_>],
    out: &mut Output,
) -> RecommendationV1 {
    let record = recommendation_record(&comparison.solution(candidates, &settings.selection), comparison);
    for (name, id, because) in [
        ("recommended", &record.recommended, &record.recommended_because),
        ("simplest", &record.simplest, &record.simplest_because),
        ("closest", &record.closest, &record.closest_because),
    ] {
        out.summary(format!("{name}: {}, {because}", id.as_deref().unwrap_or("none")));
    }
    record
}

/// What the candidates are compared with, or why they are not.
pub fn compared(
    settings: &StageSettings,
    input: &Inputs,
    record: Option<(&EventsV1, Option<&Displaced>)>,
    notes: &mut Notes,
) -> anyhow::Result<Result<Comparison, String>> {
    let Some((events, displacement)) = record else {
        return Ok(Err("without crash events there is no record to compare the candidates with".to_owned()));
    };
    let test = input.test()?;
    if let Some(axis) = test.channel(&events.channel).and_then(|channel| channel.axis).filter(|axis| *axis != Axis::X) {
        let channel = &events.channel;
        return Ok(Err(format!("channel {channel} is along {axis}, and the models are of a crush along x")));
    }
    if test.barrier.as_deref() == Some(ANOTHER_VEHICLE) {
        let reason = "two vehicles collided: the displacement over ground is not the crush of either, and the models \
                      take the other vehicle for a rigid wall";
        return Ok(Err(reason.to_owned()));
    }
    if events.time_of_dynamic_crush_s.is_none() || events.dynamic_crush_m.is_none_or(|crush| crush <= 0.0) {
        let reason = "the dynamic crush is not in the record: the velocity never reaches zero";
        return Ok(Err(reason.to_owned()));
    }
    let speed = events.impact_speed_m_per_s.or(test.impact_speed_m_per_s);
    let Some((mass_kg, speed)) = settings.mass_kg.or(test.mass_kg).zip(speed) else {
        return Ok(Err("the test has no mass or no impact speed".to_owned()));
    };
    let measured = measured_test(settings, input, (events, displacement), (mass_kg, speed), notes)?;
    let comparison = measured.and_then(Comparison::of_one);
    Ok(comparison.ok_or_else(|| "no acceleration and displacement of the pulse up to dynamic crush".to_owned()))
}

/// No choice, and why.
fn without(because: &str) -> RecommendationV1 {
    RecommendationV1 {
        recommended_because: because.to_owned(),
        simplest_because: because.to_owned(),
        closest_because: because.to_owned(),
        ..RecommendationV1::default()
    }
}

fn recommendation_record(solution: &Solution, comparison: &Comparison) -> RecommendationV1 {
    let Solution { compared: candidates, selection } = solution;
    let id = |choice: &Choice| choice.candidate.map(|k| candidates[k].id.clone());
    let (from_s, to_s) = comparison.window_s();
    let evidence = selection.terms.map(|terms| RecommendationEvidenceV1 {
        quantity: comparison.quantity(),
        as_measured: comparison.is_as_measured(),
        from_s,
        to_s,
        samples: comparison.samples() as u64,
        effective_samples: terms as f64,
    });
    let priors = selection.priors.iter().map(|prior| PriorV1 {
        name: prior.name.to_owned(),
        statement: prior.statement.clone(),
        source: prior.source.to_owned(),
    });
    let mut rated: Vec<(&ComparedCandidate, &Rated)> = candidates.iter().zip(&selection.rated).collect();
    let key = |rated: &Rated| (!rated.is_adequate(), rated.difference_with_priors.unwrap_or(f64::MAX));
    rated.sort_by(|(_, a), (_, b)| {
        let (a, b) = (key(a), key(b));
        a.0.cmp(&b.0).then_with(|| a.1.total_cmp(&b.1))
    });
    RecommendationV1 {
        recommended: id(&selection.recommended),
        recommended_because: selection.recommended.because.clone(),
        simplest: id(&selection.simplest),
        simplest_because: selection.simplest.because.clone(),
        closest: id(&selection.closest),
        closest_because: selection.closest.because.clone(),
        strength: selection.strength.map(|(strength, _)| match strength {
            Strength::Weak => StrengthV1::Weak,
            Strength::Decisive => StrengthV1::Decisive,
        }),
        beside: selection.strength.map(|(_, beside)| candidates[beside].id.clone()),
        decided_by: comparison.channels(),
        evidence,
        priors: priors.collect(),
        candidates: rated.into_iter().map(|(candidate, rated)| rated_record(candidate, rated)).collect(),
    }
}

fn rated_record(candidate: &ComparedCandidate, rated: &Rated) -> RatedCandidateV1 {
    RatedCandidateV1 {
        id: candidate.id.clone(),
        class: candidate.class.name().to_owned(),
        adequate: rated.is_adequate(),
        not_adequate_because: rated.why_inadequate(),
        missed_events: rated.missed_events(),
        crush_error: candidate.own_test.crush,
        time_error: candidate.own_test.time,
        restitution_error: candidate.own_test.restitution,
        parameters: candidate.parameters as u32,
        determined: candidate.determined() as u32,
        misfit: rated.misfit,
        fit_as_measured_percent: candidate.fit_percent,
        coefficient_of_restitution: candidate.restitution,
        force_misfit_percent: candidate.force_misfit_percent,
        aicc: rated.score,
        aicc_difference: rated.difference,
        priors: rated.terms.iter().map(|(name, term)| PriorTermV1 { name: (*name).to_owned(), term: *term }).collect(),
        difference_with_priors: rated.difference_with_priors,
        weight: Some(rated.weight),
        log_deviations: rated.deviations.iter().cloned().collect(),
    }
}
