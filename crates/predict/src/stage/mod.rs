//! The program: reads candidates and which of them are named, predicts, writes predictions and their waves.

mod inputs;
mod occupant;
mod options;
mod partner;
mod plan;
mod records;
mod table;

use std::path::PathBuf;

use crate::{Candidate, ImpactSetup, Scenario, predict};
use crumple_signal::{About, Kind, Weight, remarks};
use crumple_stage::records::{CandidateV1, RecommendationV1};
use crumple_stage::{InputDigest, Inputs, Loaded, Outcome, Output, Refused, Stage, option};

use crate::stage::inputs::{OtherTest, beside_in_words, candidates, named, read_other_test, tested};
use crate::stage::occupant::rider;
use crate::stage::options::{Options, Settings};
use crate::stage::partner::ReadPartner;
pub use crate::stage::plan::{PlanOptions, plan};
use crate::stage::records::{record, write_waves};
use crate::stage::table::{Row, header, line, partner_and_occupant, what_if};

/// The stage.
pub struct Predict;

/// Inputs of another run are told from those of this one: `against:integrate`.
fn of_another_run(role: &str, digests: Vec<InputDigest>) -> impl Iterator<Item = InputDigest> {
    digests.into_iter().map(move |input| InputDigest { kind: format!("{role}:{}", input.kind), ..input })
}

impl Stage for Predict {
    const NAME: &'static str = "predict";
    const BUILD: &'static str = env!("CRUMPLE_BUILD");
    const ABOUT: &'static str = "Predicts impacts at other speeds and masses with the candidates of a test. \
                                 Of a whole run: `crumple predict RUN --speed 40km/h`.";
    const REMARKS: &'static [&'static [&'static Kind]] = &[occupant::REMARKS, REMARKS];
    type Options = Options;
    type Settings = Settings;
    type Input = Read;

    fn resolve(options: Options) -> anyhow::Result<Settings> {
        Settings::new(options)
    }

    fn load(paths: &[PathBuf], settings: &Settings) -> anyhow::Result<Loaded<Read>> {
        let mut loaded = crumple_stage::load_artifacts(paths)?;
        let mut other = None;
        if let Some(folder) = &settings.against {
            let (test, digests) = read_other_test(folder)?;
            loaded.digests.extend(of_another_run("against", digests));
            other = Some(test);
        }
        let (partner, digests) = settings.partner.read()?;
        loaded.digests.extend(of_another_run("partner", digests));
        Ok(loaded.map(|inputs| Read { inputs, other, partner }))
    }

    fn run(settings: &Settings, read: &Read, out: &mut Output) -> anyhow::Result<Outcome> {
        let Read { inputs: input, other, partner } = read;
        let test = input.test()?;
        let records: Vec<(String, CandidateV1)> = input.records("/parameters/")?;
        if records.is_empty() {
            return Err(input.missing("/parameters/"));
        }
        let choice: Option<RecommendationV1> = input.record_if("/recommendation")?;
        let tested = tested(input)?.ok_or_else(|| {
            Refused::new("neither the events nor the test have an impact speed").hint(option(
                "ingest",
                "impact-speed",
                "35km/h",
            ))
        })?;
        let candidates: Vec<Candidate> = candidates(&records, choice.as_ref());
        let named = named(&candidates, &records, choice.as_ref(), &settings.candidates)?;
        out.put("/test", &input.test_with_samples(&test))?;
        if settings.taken_as_km_per_h {
            out.notes().push(RangeInKmPerH {});
        }
        if named.is_empty() {
            let because = choice.map_or_else(String::new, |choice| format!(": {}", choice.recommended_because));
            let reason = format!(
                "no candidate is recommended for predictions{because}. --candidate ID predicts with one of \
                them"
            );
            return Ok(Outcome::NoAcceptableResult(reason));
        }
        let scenarios = scenarios(settings, tested.speed_m_per_s, other.as_ref())?;
        let rider = rider(settings.occupant.as_ref().map(|settings| &settings.restraint), input)?;
        rider.remark.into_iter().for_each(|remark| out.notes().push(remark));
        let setup =
            ImpactSetup { partner: partner.partner.clone(), occupant: rider.occupant, occupant_ends: rider.ends };
        for (what, words) in [("partner", partner.words.as_ref()), ("occupant", rider.words.as_ref())] {
            words.into_iter().for_each(|words| out.summary(format!("{what}: {words}")));
        }
        let places: Vec<usize> = named.iter().map(|named| named.place).collect();
        let predictions = predict(&candidates, &places, &tested, settings.inputs(), &scenarios, &setup);
        let marks = !settings.asked_speeds_m_per_s.is_empty();
        let is_chosen = settings.candidates.is_empty() && choice.is_some();
        let first = named.first().map(|named| named.place).filter(|_| is_chosen);
        settings.display.during(|| out.summary(header(marks)));
        let mut rows = Vec::new();
        for (place, (scenario, of_named)) in scenarios.iter().zip(predictions).enumerate() {
            // The impact of the other test comes last.
            let other = other.as_ref().filter(|_| place + 1 == scenarios.len());
            for (name, result) in named.iter().zip(of_named) {
                let candidate = &candidates[name.place];
                let prediction = match result {
                    Ok(prediction) => prediction,
                    Err(error) => {
                        let (id, reason) = (candidate.id.clone(), error.to_string());
                        out.notes().push(NotPredicted { id, speed_m_per_s: scenario.speed_m_per_s, reason });
                        continue;
                    }
                };
                let mut record = record(candidate, &name.names, *scenario, &prediction, partner);
                record.asked = settings.is_asked(scenario.speed_m_per_s);
                record.against = other.map(|other| other.beside(&prediction));
                let n = rows.len() + 1;
                out.put(&format!("/prediction/{n}"), &record)?;
                // Who named no candidate reads the one that is meant for it; all are in the artifact.
                if first.is_none_or(|first| first == name.place) {
                    let asked = marks.then(|| settings.asks_for(scenario.speed_m_per_s));
                    settings.display.during(|| {
                        out.summary(line(&record, asked));
                        partner_and_occupant(&record).into_iter().for_each(|line| out.summary(line));
                    });
                }
                record.against.iter().for_each(|against| out.summary(beside_in_words(against)));
                write_waves(n, prediction.wave, out)?;
                rows.push(Row { speed_m_per_s: scenario.speed_m_per_s, record });
            }
        }
        settings.display.during(|| what_if(&rows).into_iter().for_each(|line| out.summary(line)));
        Ok(if rows.is_empty() {
            out.no_result("no impact could be predicted", "the notes of the run say what each impact met")
        } else {
            Outcome::Done
        })
    }
}

/// What the stage works on.
pub struct Read {
    inputs: Inputs,
    /// The test that predictions are compared with.
    other: Option<OtherTest>,
    partner: ReadPartner,
}

/// Every mass with every speed and closing speed, and last the impact of another test, which met the partner that is
/// asked for. Errors: a partner that runs away.
fn scenarios(
    settings: &Settings,
    tested_m_per_s: f64,
    other: Option<&OtherTest>,
) -> Result<Vec<Scenario>, crumple_stage::Usage> {
    let masses: Vec<Option<f64>> = match settings.masses_kg[..] {
        [] => vec![None],
        _ => settings.masses_kg.iter().copied().map(Some).collect(),
    };
    let own = [tested_m_per_s];
    let (speeds, closing) = (&settings.speeds_m_per_s, &settings.closing_speeds_m_per_s);
    let none_asked = speeds.is_empty() && closing.is_empty() && other.is_none();
    let speeds = if none_asked { &own[..] } else { speeds };
    let partner = &settings.partner;
    let mut scenarios = Vec::new();
    for mass_kg in masses {
        for speed in speeds {
            scenarios.push(partner.at_speed(*speed, mass_kg)?);
        }
        for closing in closing {
            scenarios.push(partner.at_closing_speed(*closing, mass_kg)?);
        }
    }
    if let Some((speed, mass_kg)) = other.map(OtherTest::impact) {
        scenarios.push(partner.at_speed(speed, mass_kg)?);
    }
    Ok(scenarios)
}

remarks! {
    /// Remarks of the stage.
    REMARKS;

    /// A range of speeds has no unit.
    CR708 RangeInKmPerH {}
    bears on (About::Predictions, Weight::None)
    decided "A range such as 20..80/5 stands without a unit; a single speed needs one."
    means "Both ends and the step of the range are in km/h."
    remedy "nothing; write the unit behind the range for mph or m/s"
    says "a range of speeds without a unit is taken as km/h";

    /// A candidate has no response to an impact that was asked for.
    CR709 NotPredicted { id: String, speed_m_per_s: f64, reason: String }
    bears on (About::Predictions, Weight::Slight)
    decided "The model gives no motion at this speed and mass, or the mass asked for is less than what the model has \
             in front of its compartment: the sentence says which."
    means "There is no prediction of this impact by this candidate. Others are not touched."
    remedy "ask for another speed or mass, or predict with another candidate: --candidate ID"
    says format!("{id} at {:.1} km/h: not predicted, {reason}", 3.6 * speed_m_per_s);
}
