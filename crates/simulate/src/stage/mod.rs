//! The program: reads candidates and the motion of the test, simulates, writes responses and comparisons.

mod band;
mod drive;
mod options;
mod records;

use std::path::PathBuf;

use crate::{
    Excitation, Measured, OtherSensor, SensorFit, SimulateError, Simulation, Window, beside, beside_mass,
    simulate_chain, simulate_driven,
};
use crumple_lumped::{LumpedError, Model, ModelKind};
use crumple_lumped_fit::{MeasuredTest, evaluate};
use crumple_signal::{About, Acceleration, Displacement, Kind, Sampled, TestDescription, Velocity, Weight, remarks};
use crumple_stage::records::{CandidateV1, EvaluationV1, EventsV1, RecommendationV1};
use crumple_stage::{
    Inputs, Loaded, Outcome, Output, RefuseExt, Refused, Stage, Usage, Wave, option, total_mass_remark,
};
use rayon::prelude::*;

use crate::stage::drive::CAUTION;
use crate::stage::options::{ChainSettings, Options, Settings};
use crate::stage::records::{
    AsMeasured, BesideTest, mass_of_occupant, mass_of_pulse, other_sensors, sensor_record, summary_line, was_fitted,
    write_simulation,
};

/// The stage.
pub struct Simulate;

impl Stage for Simulate {
    const NAME: &'static str = "simulate";
    const BUILD: &'static str = env!("CRUMPLE_BUILD");
    const ABOUT: &'static str = "Simulates every candidate model and compares its motion with the test.";
    const REMARKS: &'static [&'static [&'static Kind]] = &[REMARKS];
    type Options = Options;
    type Settings = Settings;
    type Input = Inputs;

    fn resolve(options: Options) -> anyhow::Result<Settings> {
        Settings::new(options)
    }

    fn load(paths: &[PathBuf], _: &Settings) -> anyhow::Result<Loaded<Inputs>> {
        crumple_stage::load_artifacts(paths)
    }

    fn run(settings: &Settings, input: &Inputs, out: &mut Output) -> anyhow::Result<Outcome> {
        let test = input.test()?;
        let events: EventsV1 = input.record("/events")?;
        let candidates = Candidate::read(input, settings.stay_attached)?;
        if candidates.is_empty() && settings.chain.is_empty() {
            return Err(input.missing("/parameters/"));
        }
        refuse_fitted_names(&settings.chain, &candidates)?;
        let stated_speed = events.impact_speed_m_per_s.or(test.impact_speed_m_per_s);
        // What starts from rest needs none.
        let impact_speed_m_per_s = stated_speed.or(settings.all_start_from_rest().then_some(0.0)).ok_or_else(|| {
            Refused::new("neither the events nor the test have an impact speed").hint(format!(
                "{}; a sled: drive = \"base\" with drive_wave = \"half-sine 20g 90ms\" in [simulate], or the id of its \
                 acceleration",
                option("ingest", "impact-speed", "35km/h")
            ))
        })?;
        let channel = &events.channel;
        let displacement = input.wave(&format!("{channel}/displacement"))?.signal::<Displacement>().refuse()?;
        let velocity =
            input.wave_if(&format!("{channel}/velocity")).map(Wave::signal::<Velocity>).transpose().refuse()?;
        let acceleration = input.wave_if(channel).map(Wave::signal::<Acceleration>).transpose().refuse()?;
        let measured = Measured {
            impact_speed_m_per_s,
            displacement: &displacement,
            measurement: input.recording_steps(&events, channel, &displacement)?,
            velocity: velocity.as_deref(),
            acceleration: acceleration.as_deref(),
            dynamic_crush_m: events.dynamic_crush_m,
            time_of_dynamic_crush_s: events.time_of_dynamic_crush_s,
        };

        let excitation = settings.driven.excitation(input, channel)?;
        let drive = settings.driven.words();
        if let Some(drive) = drive.clone() {
            if settings.driven.starts_from_rest() {
                out.notes().push(DrivenFromRest { drive });
            } else {
                out.notes().push(DrivenByThePulse { drive });
            }
        }

        // Where the velocity never reaches zero the comparison ends with the event.
        let end_of_event_s = events.end_of_event_s.filter(|_| events.time_of_dynamic_crush_s.is_none());
        let window = Window { to_s: settings.to_s.or(end_of_event_s) };
        let results: Vec<Result<Simulation, SimulateError>> = candidates
            .par_iter()
            .map(|candidate| {
                let pulse = mass_of_pulse(&candidate.record, channel);
                simulate_candidate(candidate, pulse, &measured, window, &excitation)
            })
            .collect();
        let chains: Vec<Result<Simulation, SimulateError>> = settings
            .chain
            .iter()
            .map(|stated| {
                let excitation = stated.driven.excitation(input, channel)?;
                Ok(simulate_chain(&stated.chain()?, stated.speed_m_per_s, None, &measured, window, &excitation))
            })
            .collect::<anyhow::Result<_>>()?;

        out.put("/test", &input.test_with_samples(&test))?;
        let comparison = ComparisonWithTest {
            displacement: &displacement,
            others: other_sensors(input, &test, channel)?,
            measured: as_measured(&measured, window, input, &events)?,
            impact_speed_m_per_s,
            recommended: input.record_if::<RecommendationV1>("/recommendation")?.and_then(|choice| choice.recommended),
        };
        let mut simulated = 0;
        for (candidate, result) in candidates.iter().zip(results) {
            let record = &candidate.record;
            simulated += comparison.write(candidate, result, drive.clone(), out, |simulation, sensor, dt_s| {
                if let Some(mass) = mass_of_occupant(record, &sensor.channel, simulation.compartment + 1) {
                    return beside_mass(simulation, sensor, mass, dt_s);
                }
                let seen = was_fitted(record, &sensor.channel);
                if seen { None } else { beside(simulation, sensor, dt_s) }
            })?;
        }
        for (stated, result) in settings.chain.iter().zip(chains) {
            let candidate = write_stated(stated, &test, out)?;
            simulated += comparison.write(&candidate, result, stated.words(), out, |simulation, sensor, dt_s| {
                let mass = if sensor.on_engine { stated.engine()? } else { simulation.masses.len() };
                beside_mass(simulation, sensor, mass, dt_s)
            })?;
        }
        Ok(if simulated == 0 {
            out.no_result("no candidate could be simulated", "the notes of the run say what each candidate met")
        } else {
            Outcome::Done
        })
    }
}

/// A candidate as it was read: its record, and the model that this is.
pub struct Candidate {
    id: String,
    record: CandidateV1,
    /// An error where the record names none. The elastoplastic one is moved as asked: it leaves the barrier, or stays.
    model: Result<Model, LumpedError>,
    /// What its record says of it beside the test: of a model that stays on the barrier, nothing.
    evaluation: Option<EvaluationV1>,
}

impl Candidate {
    fn read(input: &Inputs, stay_attached: bool) -> anyhow::Result<Vec<Self>> {
        let records: Vec<(String, CandidateV1)> = input.records("/parameters/")?;
        let read = |(id, record): (String, CandidateV1)| {
            let mut model = Model::read(&record.model, record.law.as_deref(), &record.parameters);
            let mut evaluation = record.evaluation.clone();
            if let Ok(Model::Elastoplastic(elastoplastic)) = &mut model {
                elastoplastic.release = !stay_attached;
                evaluation = evaluation.filter(|_| !stay_attached);
            }
            Self { id, record, model, evaluation }
        };
        Ok(records.into_iter().map(read).collect())
    }
}

/// Refuses a stated chain that has the name of a fitted one.
fn refuse_fitted_names(chains: &[ChainSettings], candidates: &[Candidate]) -> anyhow::Result<()> {
    for stated in chains {
        let fitted = format!("{}/{}/", ModelKind::Chain, stated.name);
        if candidates.iter().any(|candidate| candidate.id.starts_with(&fitted)) {
            let problem = format!("[simulate.chain.{}]: parameter-solve has fitted a chain of that name", stated.name);
            return Err(Usage::new(problem).hint("give one of them another name").into());
        }
    }
    Ok(())
}

/// The response of a candidate; of a chain the mass of number `pulse` is compared with the test, else the last.
fn simulate_candidate(
    candidate: &Candidate,
    pulse: Option<usize>,
    measured: &Measured<'_>,
    window: Window,
    excitation: &Excitation<'_>,
) -> Result<Simulation, SimulateError> {
    let model = candidate.model.clone()?;
    if let Model::Chain(chain) = &model {
        // The number comes from a file: one that the chain does not have is none.
        let compartment = pulse.filter(|mass| (1..=chain.masses_kg().len()).contains(mass)).map(|mass| mass - 1);
        return simulate_chain(chain, None, compartment, measured, window, excitation);
    }
    simulate_driven(&model, measured, window, excitation)
}

/// Writes the record of a stated chain beside those of solved candidates.
fn write_stated(stated: &ChainSettings, test: &TestDescription, out: &mut Output) -> anyhow::Result<Candidate> {
    let (id, chain) = (stated.id(), stated.chain()?);
    let mut record = stated.candidate(&chain);
    if !record.physical {
        out.notes().push(NotPassive { id: id.clone(), chain: stated.name.clone() });
    }
    let masses_kg = chain.masses_kg();
    let differs = test.mass_kg.and_then(|test_kg| Some((test_kg, total_mass_remark(masses_kg, test_kg)?)));
    if let Some((test_kg, reason)) = differs {
        record.notes.push(reason.clone());
        let sum_kg: f64 = masses_kg.iter().sum();
        let difference_percent = 100.0 * (sum_kg / test_kg - 1.0);
        out.notes().push(OtherTotalMass { id: id.clone(), sum_kg, test_kg, difference_percent, reason });
    }
    out.put(&format!("/parameters/{id}"), &record)?;
    Ok(Candidate { id, record, model: Ok(Model::Chain(chain)), evaluation: None })
}

/// The test as candidates are evaluated by it, over the window that simulations are compared in. `None`: too few
/// samples.
fn as_measured(
    test: &Measured<'_>,
    window: Window,
    input: &Inputs,
    events: &EventsV1,
) -> anyhow::Result<Option<MeasuredTest>> {
    let recorded = |wave, measurement| crumple_lumped_fit::Measured { wave, measurement };
    let displacement = recorded(test.displacement, test.measurement);
    let window_s = (0.0, window.end_s(test));
    let measured = MeasuredTest::new(&events.channel, test.impact_speed_m_per_s, window_s, displacement);
    let force = input.wall_force()?;
    let force = force.as_ref().map(|(wave, steps)| recorded(wave, *steps));
    Ok(measured.ok().map(|measured| measured.with_wall(force, |end_s| events.end_of_contact_s(end_s))))
}

/// What every simulation of a test is compared with.
struct ComparisonWithTest<'a> {
    displacement: &'a Sampled,
    others: Vec<OtherSensor>,
    /// What candidates that carry no evaluation are evaluated by; `None`: too few samples.
    measured: Option<MeasuredTest>,
    impact_speed_m_per_s: f64,
    /// Id of the recommended candidate.
    recommended: Option<String>,
}

impl ComparisonWithTest<'_> {
    /// Writes a simulation with its line of the summary, or notes why there is none; returns how many were written.
    ///
    /// `beside` compares with another sensor, at the sampling interval given last.
    fn write(
        &self,
        candidate: &Candidate,
        result: Result<Simulation, SimulateError>,
        drive: Option<String>,
        out: &mut Output,
        beside: impl Fn(&Simulation, &OtherSensor, f64) -> Option<SensorFit>,
    ) -> anyhow::Result<usize> {
        let Candidate { id, record, .. } = candidate;
        let simulation = match result {
            Ok(simulation) => simulation,
            Err(error) => {
                out.notes().push(NotSimulated { id: id.clone(), reason: error.to_string() });
                return Ok(0);
            }
        };
        out.summary(summary_line(id, &simulation));
        let dt_s = self.displacement.dt_s();
        let sensors =
            self.others.iter().filter_map(|sensor| beside(&simulation, sensor, dt_s)).map(sensor_record).collect();
        let as_measured =
            if drive.is_none() { self.as_measured(candidate, &simulation) } else { AsMeasured::default() };
        let beside_test = BesideTest {
            other_sensors: sensors,
            as_measured,
            impact_speed_m_per_s: self.impact_speed_m_per_s,
            drive,
            recommended: self.recommended.as_ref() == Some(id),
        };
        write_simulation(id, record, simulation, beside_test, self.displacement, out)?;
        Ok(1)
    }

    /// What a candidate carries of this window; one that was stated, or that another program wrote, is evaluated here.
    fn as_measured(&self, candidate: &Candidate, simulation: &Simulation) -> AsMeasured {
        let Some(test) = &self.measured else { return AsMeasured::default() };
        let (from_s, to_s) = test.window_s();
        // Ends between two samples may fall on either.
        let near = |a: f64, b: f64| (a - b).abs() < 1.5 * self.displacement.dt_s();
        let is_of_window = |known: &&EvaluationV1| near(known.from_s, from_s) && near(known.to_s, to_s);
        if let Some(known) = candidate.evaluation.as_ref().filter(is_of_window) {
            return AsMeasured {
                fit_percent: known.fit_as_measured_percent,
                force_misfit_percent: known.force_misfit_percent,
            };
        }
        let Ok(model) = &candidate.model else { return AsMeasured::default() };
        let is_behind = simulation.masses.len() > simulation.compartment + 1;
        let evaluation = evaluate(model, is_behind.then_some(simulation.compartment), test);
        AsMeasured {
            fit_percent: evaluation.fit_as_measured_percent,
            force_misfit_percent: evaluation.force_misfit_percent,
        }
    }
}

remarks! {
    /// Remarks of the stage.
    REMARKS;

    /// Models start from rest and are moved by a waveform, not by the impact of the test.
    CR605 DrivenFromRest { drive: String }
    bears on (About::Model(String::new()), Weight::Slight)
    decided "simulate.drive is force or base. Under a displacement fit of 50 % no model is called the best."
    means "Fits and errors compare with the test as recorded. They say nothing of a model, unless the test was driven \
           in the same way."
    remedy "leave simulate.drive out to compare with a crash test"
    says format!("models are moved by {drive}; {CAUTION}");

    /// Models are moved by the acceleration that they are compared with.
    CR606 DrivenByThePulse { drive: String }
    bears on (About::Model(String::new()), Weight::Slight)
    decided "simulate.drive is pulse-as-force: mass times measured acceleration acts on the front mass."
    means "The measured motion goes in. A model that is nearly one rigid mass gives it back: agreement is no evidence."
    remedy "leave simulate.drive out, so that models meet the barrier"
    says format!("models are moved by {drive}");

    /// A chain of masses that the pipeline states has a negative spring or damper.
    CR607 NotPassive { id: String, chain: String }
    bears on (About::Model(id.clone()), Weight::Marked)
    decided "Every spring and damper is looked at over its whole range; a passive structure has none below zero."
    means "The model gives energy to the vehicle: its motion may fit and is none of a structure."
    remedy "correct stiffness and damping of the chain in the pipeline"
    says format!("{id}: a spring or damper of [simulate.chain.{chain}] is negative somewhere: no passive structure");

    /// The masses of a stated chain do not add up to the mass of the test.
    CR608 OtherTotalMass { id: String, sum_kg: f64, test_kg: f64, difference_percent: f64, reason: String }
    bears on (About::Model(id.clone()), Weight::Marked)
    decided "The sum is compared with the mass of the test; more than 1 % is noted. Scales and rounded masses stay \
             below."
    means "Forces and energies belong to the masses of the chain, not to the vehicle that was tested."
    remedy "let the masses of the chain add up to the mass of the test"
    says format!("{id}: {reason}");

    /// A candidate was not simulated.
    CR609 NotSimulated { id: String, reason: String }
    bears on (About::Model(id.clone()), Weight::Marked)
    decided "Its parameters make no model, its response leaves the range of numbers, or the record has no part to \
             compare it with: the sentence says which."
    means "It has no motion, no fit and no rank. Other candidates are not touched."
    remedy "nothing, unless it is the one that is needed: then check its parameters, or fit it again"
    says format!("{id}: not simulated, {reason}");
}
