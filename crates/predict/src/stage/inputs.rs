//! Candidates as the library takes them, which of them are to predict, and tests that were made.

use std::path::{Path, PathBuf};

use crate::{Candidate, HALF_WIDTH, MadeTest, ParameterSpread, Prediction, Quantity, TestedImpact};
use crumple_lumped::Model;
use crumple_signal::TestDescription;
use crumple_stage::records::{AgainstTestV1, CandidateV1, EventsV1, MetricsV2, RecommendationV1, TestsV2};
use crumple_stage::{InputDigest, Inputs, Refused, Usage, errors_in_words, load_artifacts, unknown_name};

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
    let several: Option<TestsV2> = input.record_if("/tests")?;
    let test = input.test()?;
    let events: Option<EventsV1> = if several.is_some() { None } else { Some(input.record("/events")?) };
    let speed = events.as_ref().and_then(|events| events.impact_speed_m_per_s).or(test.impact_speed_m_per_s);
    let Some(speed) = speed else { return Ok(None) };
    let made = events.as_ref().map(|events| measured(input, &test, events, speed)).transpose()?;
    let of_one = events.as_ref().and_then(EventsV1::crush_deviation_m);
    // Of several, in proportion to the deepest.
    let of_all = several.as_ref().and_then(|several| {
        let deepest = several.tests.iter().filter_map(|test| test.dynamic_crush_m).fold(0.0, f64::max);
        Some(several.crush_deviation? * deepest)
    });
    let deviation = of_one.or(of_all);
    let speeds = several.iter().flat_map(|several| &several.tests).map(|test| test.impact_speed_m_per_s);
    let tested = TestedImpact::new(speed, speeds).with_crush_deviation(deviation.unwrap_or(0.0));
    Ok(Some(tested.with_measured(made.unwrap_or_default())))
}

/// All candidates, with what the choice says of them.
pub fn candidates(records: &[(String, CandidateV1)], choice: Option<&RecommendationV1>) -> Vec<Candidate> {
    let weight = |id: &str| {
        let rated = choice?.candidates.iter().find(|rated| rated.id == id)?;
        let by_difference = || Some((-0.5 * rated.difference_with_priors.filter(|_| rated.adequate)?).exp());
        rated.weight.or_else(by_difference)
    };
    records
        .iter()
        .map(|(id, record)| Candidate {
            id: id.clone(),
            model: Model::read(&record.model, record.law.as_deref(), &record.parameters),
            spread: record.uncertainty.as_ref().map(|known| ParameterSpread {
                standard_deviation: known.standard_deviation.clone(),
                order: known.order.clone(),
                correlation: known.correlation.clone(),
                open: record.undetermined().into_iter().map(str::to_owned).collect(),
            }),
            weight: weight(id).unwrap_or(0.0),
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

/// A test to compare with.
#[derive(Debug)]
pub struct OtherTest {
    title: String,
    /// Its impact speed, m/s, and its mass, kg.
    impact: (f64, Option<f64>),
    made: MadeTest,
}

/// Reads the test in a run folder. Errors: no such folder, artifacts that cannot be read, no speed.
pub fn read_other_test(folder: &Path) -> anyhow::Result<(OtherTest, Vec<InputDigest>)> {
    let present = |name: &str| Some(folder.join(name)).filter(|path| path.is_file());
    let Some(integrated) = present("3-integrate.mcap") else {
        let problem = format!("{} holds no 3-integrate.mcap", folder.display());
        return Err(Usage::new(problem).hint("--against runs/NAME-OF-RECORD/NAME-OF-PIPELINE").into());
    };
    let paths: Vec<PathBuf> = [Some(integrated), present("2-filter.mcap")].into_iter().flatten().collect();
    let loaded = load_artifacts(&paths)?;
    Ok((other_test(&loaded.input)?, loaded.digests))
}

fn other_test(input: &Inputs) -> anyhow::Result<OtherTest> {
    let test = input.test()?;
    let events: EventsV1 = input.record("/events")?;
    let speed_m_per_s = events.impact_speed_m_per_s.or(test.impact_speed_m_per_s);
    let speed_m_per_s = speed_m_per_s.ok_or_else(|| Refused::new("the other test has no impact speed"))?;
    let made = measured(input, &test, &events, speed_m_per_s)?;
    Ok(OtherTest { title: test.title, impact: (speed_m_per_s, test.mass_kg), made })
}

/// What a test measured. Errors: records that cannot be read.
pub fn measured(
    input: &Inputs,
    test: &TestDescription,
    events: &EventsV1,
    speed_m_per_s: f64,
) -> anyhow::Result<MadeTest> {
    let metrics = input.record_if::<MetricsV2>("/metrics")?.map(|record| record.metrics).unwrap_or_default();
    let peak = metrics.iter().find(|metric| metric.name == "peak_acceleration" && metric.channel == events.channel);
    let made = MadeTest {
        peak_m_per_s2: peak.and_then(|metric| metric.value).map(f64::abs),
        acceleration: input.wave_if(&events.channel).map(|wave| wave.sampled.clone()),
        ..of_events(events)
    };
    let class = test.channels.iter().find(|channel| channel.id == events.channel).and_then(|channel| channel.cfc);
    let velocity = input.wave_if(&format!("{}/velocity", events.channel)).map(|wave| wave.sampled.clone());
    Ok(match velocity {
        Some(velocity) => made.with_velocity(speed_m_per_s, &velocity, class == Some(60)),
        None => made,
    })
}

/// The events of a test; of a record that ends during the rebound, restitution and delta-v are lower bounds and none.
fn of_events(events: &EventsV1) -> MadeTest {
    let is_whole = !events.still_separating;
    let deviation = |quantity: &Quantity| {
        let interval = events.intervals.iter().find(|interval| interval.name == quantity.field())?;
        Some((*quantity, (interval.high - interval.low) / (2.0 * HALF_WIDTH)))
    };
    MadeTest {
        deviations: Quantity::ALL.iter().filter_map(deviation).collect(),
        delta_v_m_per_s: events.delta_v_m_per_s.filter(|_| is_whole),
        dynamic_crush_m: events.dynamic_crush_m,
        time_of_dynamic_crush_s: events.time_of_dynamic_crush_s,
        coefficient_of_restitution: events.coefficient_of_restitution.filter(|_| is_whole),
        ..MadeTest::default()
    }
}

impl OtherTest {
    /// The impact that it was: its speed, m/s, and its mass, kg, if it says one.
    pub fn impact(&self) -> (f64, Option<f64>) {
        self.impact
    }

    /// The prediction of it beside it.
    pub fn beside(&self, prediction: &Prediction) -> AgainstTestV1 {
        let error = |quantity: Quantity| self.made.error_percent(&prediction.outcome, quantity);
        let difference = |quantity: Quantity| Some(prediction.outcome.get(quantity)? - self.made.get(quantity)?);
        let held = Quantity::ALL.iter().zip(&prediction.intervals).filter(|(quantity, interval)| {
            let pair = interval.as_ref().zip(self.made.get(**quantity));
            pair.is_some_and(|(interval, measured)| interval.low <= measured && measured <= interval.high)
        });
        AgainstTestV1 {
            test: self.title.clone(),
            dynamic_crush_error_percent: error(Quantity::DynamicCrush),
            time_of_dynamic_crush_error_percent: error(Quantity::TimeOfDynamicCrush),
            peak_acceleration_error_percent: error(Quantity::Peak),
            coefficient_of_restitution_error: difference(Quantity::Restitution),
            iso18571_score: self.made.iso18571_score(&prediction.wave),
            held: held.map(|(quantity, _)| quantity.field().to_owned()).collect(),
        }
    }
}

/// A line for a person.
pub fn beside_in_words(against: &AgainstTestV1) -> String {
    let [crush, time, peak, restitution, score] = errors_in_words(against);
    let holds = if against.held.iter().any(|name| name == "dynamic_crush_m") { "holds" } else { "does not hold" };
    format!(
        "  against {:?}: crush {crush}, its time {time}, peak {peak}, e {restitution}, ISO/TS 18571 {score}; the \
         interval {holds} the crush",
        against.test,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lower_bound_is_no_restitution_of_a_test() {
        let (coefficient_of_restitution, delta_v_m_per_s) = (Some(0.02), Some(15.3));
        let whole = EventsV1 { coefficient_of_restitution, delta_v_m_per_s, ..EventsV1::default() };
        let made = of_events(&whole);
        assert_eq!((made.coefficient_of_restitution, made.delta_v_m_per_s), (Some(0.02), Some(15.3)));
        let cut = of_events(&EventsV1 { still_separating: true, ..whole });
        assert_eq!((cut.coefficient_of_restitution, cut.delta_v_m_per_s), (None, None));
    }
}
