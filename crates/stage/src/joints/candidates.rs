//! Rows of the joints of parameter-solve and simulate: candidates and their curves.

use crumple_artifact::Artifact;
use crumple_artifact::records::{CandidateV1, EventsV1, PredictionV1, RecommendationV1, SimulationV1, TestV1};
use crumple_signal::{About, Kind, Weight};

use crate::joints::curves::value_at;
use crate::joints::{BESIDE, Finding, Invariant, RunParts, is_outside, record, records};

/// Rows of the stages.
pub(crate) static ROWS: [Invariant; 7] = [
    Invariant {
        kind: Kind {
            code: "CR501",
            weight: Weight::Decisive,
            explanation: [
                "The masses of a candidate do not add up to that of the test.",
                "mass_kg, or m1_kg, m2_kg, ... of a candidate are compared with the mass of /test; 0.5 % is left.",
                "Its stiffness is that of another vehicle: crush and forces at other speeds are wrong by the ratio.",
                "give the program of the stage parameter-solve the mass of /test, or crumple ingest the mass of the \
                 candidate",
            ],
        },
        ends_the_run: false,
        find: masses_of_another_vehicle,
    },
    Invariant {
        kind: Kind {
            code: "CR502",
            weight: Weight::Decisive,
            explanation: [
                "A parameter lies outside of its own interval.",
                BESIDE,
                "The interval or the value is that of something else.",
                "write the interval of the value that is written",
            ],
        },
        ends_the_run: true,
        find: parameter_outside,
    },
    Invariant {
        kind: Kind {
            code: "CR503",
            weight: Weight::Decisive,
            explanation: [
                "A candidate is recommended that is not there.",
                "The ids of /recommendation are looked for below /parameters/.",
                "Nobody can predict with it.",
                "recommend one of the candidates that are written",
            ],
        },
        ends_the_run: true,
        find: recommends_nobody,
    },
    Invariant {
        kind: Kind {
            code: "CR601",
            weight: Weight::Decisive,
            explanation: [
                "The dynamic crush of a simulation is not that of its curve.",
                "The curve is read at the stated time; 1 % and 1 mm are left.",
                "The figure or the curve is that of something else.",
                "read the figures off the curves that the program of the stage simulate writes",
            ],
        },
        ends_the_run: true,
        find: simulated_crush_differs,
    },
    Invariant {
        kind: Kind {
            code: "CR602",
            weight: Weight::Decisive,
            explanation: [
                "A simulation or a prediction is of a candidate that is not there.",
                "Its id is looked for below /parameters/ of 5-parameter-solve; a chain of the pipeline needs none.",
                "What it was made with cannot be told.",
                "simulate and predict with candidates of 5-parameter-solve",
            ],
        },
        ends_the_run: true,
        find: of_nobody,
    },
    Invariant {
        kind: Kind {
            code: "CR603",
            weight: Weight::Decisive,
            explanation: [
                "A candidate is recommended that does not repeat its own test.",
                "Its simulated dynamic crush is compared with that of /events, where the recommendation does not rate \
                 it; 3.5 % is left, as for every candidate (docs/methods/prediction.md).",
                "What it predicts of other speeds is wrong by at least as much.",
                "recommend no candidate that misses its test, or write its parameters in SI units",
            ],
        },
        ends_the_run: true,
        find: recommended_misses_its_test,
    },
    Invariant {
        kind: Kind {
            code: "CR604",
            weight: Weight::Decisive,
            explanation: [
                "A candidate was compared with the test with other parameters than it was simulated with.",
                "crush_error of its evaluation, else of its rating, says what crush it has at the speed of the test; \
                 its simulated crush is compared with that, and 1 % is left. Not asked where something else than the \
                 impact moves the model.",
                "Its agreement with the test, or else its curves, are those of other parameters.",
                "evaluate and simulate the parameters that are written, at the speed of the test",
            ],
        },
        ends_the_run: true,
        find: evaluated_with_others,
    },
];

/// All masses of a candidate together, kg; `None` where it states none.
pub(crate) fn total_mass(candidate: &CandidateV1) -> Option<f64> {
    let is_numbered = |name: &str| {
        let number = name.strip_prefix('m').and_then(|rest| rest.strip_suffix("_kg"));
        number.is_some_and(|number| !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit()))
    };
    let whole = candidate.parameters.get("mass_kg").copied();
    let parts: Vec<f64> = candidate.parameters.iter().filter(|(name, _)| is_numbered(name)).map(|(_, m)| *m).collect();
    whole.or_else(|| (!parts.is_empty()).then(|| parts.iter().sum()))
}

fn masses_of_another_vehicle(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(artifact) = parts.of("parameter-solve") else { return Vec::new() };
    let Some(mass_kg) = record::<TestV1>(artifact, "/test").and_then(|test| test.mass_kg) else { return Vec::new() };
    let mut of_candidates = parts.candidates().iter().filter_map(|(id, candidate)| {
        let total = total_mass(candidate)?;
        ((total - mass_kg).abs() > 5e-3 * mass_kg).then(|| ((*id).to_owned(), total))
    });
    let Some((id, total)) = of_candidates.next() else { return Vec::new() };
    let others = match of_candidates.count() {
        0 => String::new(),
        more => format!("; so do those of {more} more"),
    };
    let text = format!("the masses of {id} add up to {total:.1} kg, the test has {mass_kg:.1} kg{others}");
    let values = vec![("candidate_kg", total), ("test_kg", mass_kg)];
    vec![Finding { stage: "parameter-solve", about: About::Mass, values, text }]
}

fn parameter_outside(parts: &RunParts<'_>) -> Vec<Finding> {
    for (id, candidate) in parts.candidates() {
        let Some(uncertainty) = &candidate.uncertainty else { continue };
        // A value on a bound of its search is beside the least misfit, which its interval is of.
        let bounds = candidate.fit.as_ref().map_or(&[][..], |fit| &fit.active_bounds);
        for (name, value) in candidate.parameters.iter().filter(|(name, _)| !bounds.contains(*name)) {
            let end = |ends: &std::collections::BTreeMap<String, Option<f64>>| ends.get(name).copied().flatten();
            let Some((low, high)) = end(&uncertainty.interval_low).zip(end(&uncertainty.interval_high)) else {
                continue;
            };
            if is_outside(*value, low, high) {
                let text = format!("{name} of {id} is {value:.4e}, its interval {low:.4e} to {high:.4e}");
                let values = vec![("value", *value), ("low", low), ("high", high)];
                return vec![Finding { stage: "parameter-solve", about: About::Model((*id).to_owned()), values, text }];
            }
        }
    }
    Vec::new()
}

/// Whether an artifact holds the candidate of an id.
fn has_candidate(artifact: &Artifact, id: &str) -> bool {
    artifact.records().iter().any(|raw| raw.topic.strip_prefix("/parameters/") == Some(id))
}

fn recommends_nobody(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(artifact) = parts.of("parameter-solve") else { return Vec::new() };
    let Some(choice) = record::<RecommendationV1>(artifact, "/recommendation") else { return Vec::new() };
    let named = [("recommended", &choice.recommended), ("simplest", &choice.simplest), ("closest", &choice.closest)];
    let is_there = |id: &str| has_candidate(artifact, id);
    let absent = named.into_iter().find_map(|(what, id)| Some((what, id.as_deref().filter(|id| !is_there(id))?)));
    let Some((what, id)) = absent else { return Vec::new() };
    let text = format!("{id} is named as {what}, and there is no such candidate");
    vec![Finding { stage: "parameter-solve", about: About::Model(id.to_owned()), values: Vec::new(), text }]
}

fn simulated_crush_differs(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(artifact) = parts.of("simulate") else { return Vec::new() };
    for (id, simulation) in records::<SimulationV1>(artifact, "/simulation/") {
        let stated = simulation.dynamic_crush_m.zip(simulation.time_of_dynamic_crush_s);
        let curve = artifact.waves().get(&format!("{id}/displacement"));
        let Some(((crush_m, time_s), curve)) = stated.zip(curve) else { continue };
        let Some(at_m) = value_at(&curve.sampled, time_s) else { continue };
        if (at_m - crush_m).abs() <= 0.01 * crush_m.abs().max(at_m.abs()) + 1e-3 {
            continue;
        }
        let text = format!(
            "the dynamic crush of {id} is {:.0} mm, the displacement of its curve at that time {:.0} mm",
            crush_m * 1e3,
            at_m * 1e3
        );
        let values = vec![("simulated_m", crush_m), ("curve_m", at_m)];
        return vec![Finding { stage: "simulate", about: About::Model((*id).to_owned()), values, text }];
    }
    Vec::new()
}

/// Share of the crush of the test that a recommended candidate may miss: that of the choice.
pub const ADEQUATE: f64 = 0.035;

fn recommended_misses_its_test(parts: &RunParts<'_>) -> Vec<Finding> {
    let solved =
        parts.of("parameter-solve").and_then(|artifact| record::<RecommendationV1>(artifact, "/recommendation"));
    let Some(choice) = solved else { return Vec::new() };
    let is_rated = |id: &str| choice.candidates.iter().any(|rated| rated.id == id);
    let Some(id) = choice.recommended.as_deref().filter(|id| !is_rated(id)) else { return Vec::new() };
    let Some(simulated) = parts.of("simulate") else { return Vec::new() };
    let crush = record(simulated, &format!("/simulation/{id}")).and_then(|s: SimulationV1| s.dynamic_crush_m);
    let Some(tested_m) = tested_crush_m(parts) else { return Vec::new() };
    let Some(crush_m) = crush else {
        let text = format!(
            "{id} is recommended, and it does not stop at the speed of the test, where the vehicle stopped at {:.0} mm",
            tested_m * 1e3
        );
        let values = vec![("tested_m", tested_m)];
        return vec![Finding { stage: "parameter-solve", about: About::Model((*id).to_owned()), values, text }];
    };
    if (crush_m - tested_m).abs() <= ADEQUATE * tested_m.abs() {
        return Vec::new();
    }
    let text = format!(
        "{id} is recommended, and its crush at the speed of the test is {:.0} mm for {:.0} mm",
        crush_m * 1e3,
        tested_m * 1e3
    );
    let values = vec![("simulated_m", crush_m), ("tested_m", tested_m)];
    vec![Finding { stage: "parameter-solve", about: About::Model((*id).to_owned()), values, text }]
}

/// Share of a simulated crush that its evaluation may be beside it: both are of one exact motion, and other programs
/// read theirs off samples.
const EVALUATED: f64 = 0.01;

/// Dynamic crush of the test, m.
pub(crate) fn tested_crush_m(parts: &RunParts<'_>) -> Option<f64> {
    record::<EventsV1>(parts.of("integrate")?, "/events")?.dynamic_crush_m.filter(|crush_m| *crush_m > 0.0)
}

fn evaluated_with_others(parts: &RunParts<'_>) -> Vec<Finding> {
    let (Some(solved), Some(simulated)) = (parts.of("parameter-solve"), parts.of("simulate")) else {
        return Vec::new();
    };
    let Some(tested_m) = tested_crush_m(parts) else { return Vec::new() };
    let choice = record::<RecommendationV1>(solved, "/recommendation").unwrap_or_default();
    let rated = |id: &str| choice.candidates.iter().find(|rated| rated.id == id)?.crush_error;
    let candidates = parts.candidates().iter().filter_map(|(id, candidate)| {
        let evaluation = candidate.evaluation.as_ref();
        let crush_error = evaluation.and_then(|evaluation| evaluation.crush_error).or_else(|| rated(id))?;
        let evaluated_m = tested_m * (1.0 + crush_error);
        let simulation: SimulationV1 = record(simulated, &format!("/simulation/{id}"))?;
        let simulated_m = simulation.dynamic_crush_m.filter(|_| simulation.drive.is_none())?;
        ((evaluated_m - simulated_m).abs() > EVALUATED * simulated_m.abs()).then_some((id, evaluated_m, simulated_m))
    });
    let Some((id, evaluated_m, simulated_m)) = candidates.into_iter().next() else { return Vec::new() };
    let text = format!(
        "the crush of {id} in the test is {:.0} mm by parameter-solve and {:.0} mm by simulate",
        evaluated_m * 1e3,
        simulated_m * 1e3
    );
    let values = vec![("evaluated_m", evaluated_m), ("simulated_m", simulated_m)];
    vec![Finding { stage: "simulate", about: About::Model((*id).to_owned()), values, text }]
}

fn of_nobody(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(solved) = parts.of("parameter-solve") else { return Vec::new() };
    let is_there = |id: &str| has_candidate(solved, id);
    let simulated = parts.of("simulate").into_iter().flat_map(Artifact::records);
    let simulated = simulated.filter_map(|raw| Some(("simulate", raw.topic.strip_prefix("/simulation/")?.to_owned())));
    let predicted = parts.of("predict").into_iter();
    let predicted = predicted.flat_map(|artifact| records::<PredictionV1>(artifact, "/prediction/"));
    let predicted = predicted.map(|(_, prediction)| ("predict", prediction.candidate));
    // A chain that the pipeline states needs no candidate.
    let is_stated = |id: &str| id.starts_with("chain/");
    let absent = simulated.chain(predicted).find(|(_, id)| !is_there(id) && !is_stated(id));
    let Some((stage, id)) = absent else { return Vec::new() };
    let text = format!("the stage {stage} worked with {id}, and there is no such candidate");
    vec![Finding { stage, about: About::Model(id), values: Vec::new(), text }]
}
