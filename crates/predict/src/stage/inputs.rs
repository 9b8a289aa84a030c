//! Candidates as the library takes them, and which of them are to predict.

use crumple_predict::{Candidate, HALF_WIDTH, ParameterSpread, TestedImpact};
use crumple_stage::records::{CandidateV1, EventsV1, RecommendationV1, TestsV1};
use crumple_stage::{Inputs, Usage, unknown_name};

use crate::stage::against::measured;

/// A candidate that is to predict.
#[derive(Debug, PartialEq, Eq)]
pub struct Named {
    /// Its place among the candidates.
    pub place: usize,
    /// The names it has in the choice.
    pub names: Vec<&'static str>,
}

/// The impact that the candidates are of: that of the test, or the deepest of several tests with the speeds of all.
/// `None` where nothing tells a speed. Errors: records that cannot be read.
pub fn tested(input: &Inputs) -> anyhow::Result<Option<TestedImpact>> {
    let several: Option<TestsV1> = input.record_if("/tests")?;
    let test = input.test()?;
    // Of several, what their inputs leave unsure is in what the tests that are left out are missed by.
    let events: Option<EventsV1> = if several.is_some() { None } else { Some(input.record("/events")?) };
    let speed = events.as_ref().and_then(|events| events.impact_speed_m_per_s).or(test.impact_speed_m_per_s);
    let Some(speed) = speed else { return Ok(None) };
    let made = events.as_ref().map(|events| measured(input, &test, events, speed)).transpose()?;
    let deviation = events.as_ref().and_then(crush_deviation_m);
    let speeds = several.iter().flat_map(|several| &several.tests).map(|test| test.impact_speed_m_per_s);
    let tested = TestedImpact::new(speed, speeds).with_crush_deviation(deviation.unwrap_or(0.0));
    Ok(Some(tested.with_measured(made.unwrap_or_default())))
}

/// Standard deviation of the dynamic crush by the inputs of its test, m: of a normal distribution as wide as its 5-95 %
/// interval.
fn crush_deviation_m(events: &EventsV1) -> Option<f64> {
    let interval = events.intervals.iter().find(|interval| interval.name == "dynamic_crush_m")?;
    Some((interval.high - interval.low) / (2.0 * HALF_WIDTH))
}

/// All candidates, with what the choice says of them.
pub fn candidates(records: &[(String, CandidateV1)], choice: Option<&RecommendationV1>) -> Vec<Candidate> {
    let difference = |id: &str| {
        let rated = choice?.candidates.iter().find(|rated| rated.id == id)?;
        rated.difference_with_priors.filter(|_| rated.adequate)
    };
    records
        .iter()
        .map(|(id, record)| Candidate {
            id: id.clone(),
            model: record.model.clone(),
            parameters: record.parameters.clone(),
            spread: record.uncertainty.as_ref().map(|known| ParameterSpread {
                standard_deviation: known.standard_deviation.clone(),
                order: known.order.clone(),
                correlation: known.correlation.clone(),
                open: record.undetermined().into_iter().map(str::to_owned).collect(),
            }),
            difference: difference(id),
        })
        .collect()
}

/// Whether a fitted chain has a sensor behind the mass that the pulse is of.
fn has_occupant(record: &CandidateV1) -> bool {
    let Some(fit) = &record.fit else { return false };
    let pulse = fit.sensors.iter().find(|sensor| sensor.channel == fit.channel);
    pulse.is_some_and(|pulse| fit.sensors.iter().any(|sensor| sensor.mass > pulse.mass))
}

/// Those asked for; else the recommended, the simplest and the closest. Where nobody chose, every physical candidate
/// but for duals. Errors: an id that none has, with the nearest.
pub fn named(
    candidates: &[Candidate],
    records: &[(String, CandidateV1)],
    choice: Option<&RecommendationV1>,
    asked: &[String],
) -> anyhow::Result<Vec<Named>> {
    let place = |id: &str| candidates.iter().position(|candidate| candidate.id == id);
    let chosen: Vec<(&'static str, Option<&str>)> = choice.map_or_else(Vec::new, |choice| {
        vec![
            ("recommended", choice.recommended.as_deref()),
            ("simplest", choice.simplest.as_deref()),
            ("closest", choice.closest.as_deref()),
        ]
    });
    let names = |place: usize| {
        let id = Some(candidates[place].id.as_str());
        chosen.iter().filter(|(_, other)| *other == id).map(|(name, _)| *name).collect()
    };
    let mut places = Vec::new();
    if asked.is_empty() && choice.is_some() {
        places.extend(chosen.iter().filter_map(|(_, id)| place((*id)?)));
    } else if asked.is_empty() {
        let is_dual = |k: usize| {
            let other = records[k].1.equivalent_to.as_deref();
            other.is_some_and(|other| records[..k].iter().any(|(id, _)| id == other))
        };
        let is_vehicle = |k: &usize| records[*k].1.physical && !has_occupant(&records[*k].1);
        places.extend((0..records.len()).filter(|k| is_vehicle(k) && !is_dual(*k)));
    }
    for id in asked {
        let ids: Vec<&str> = candidates.iter().map(|candidate| candidate.id.as_str()).collect();
        let unknown = || unknown_name(&format!("the artifacts hold no candidate {id:?}"), id, &ids);
        let place = place(id).ok_or_else(unknown)?;
        if has_occupant(&records[place].1) {
            let problem = format!("the last mass of {id} is an occupant: as a vehicle it predicts nothing");
            return Err(Usage::new(problem)
                .hint("name a model of the vehicle, and the restraint with --occupant")
                .into());
        }
        places.push(place);
    }
    let mut named: Vec<Named> = Vec::new();
    for place in places {
        if !named.iter().any(|other| other.place == place) {
            named.push(Named { place, names: names(place) });
        }
    }
    Ok(named)
}
