//! Reads candidates and the motion of the test, simulates, writes responses and comparisons.

mod chain_table;
mod drive;
mod fitted_parameters;

use std::path::PathBuf;

use crumple_estimation::statistics::effective_samples;
use crumple_lumped::{Dynamics, Model, ModelKind, Motion, SecantChain};
use crumple_signal::value::Time;
use crumple_signal::{Acceleration, Displacement, QuantityKind, Sampled, TestDescription, Velocity};
use crumple_simulate::{
    Information, Measured, OtherSensor, Rating, SensorFit, SimulateError, Simulation, Window, beside, beside_mass,
    information, is_on_engine, simulate_chain, simulate_driven,
};
use crumple_stage::records::{CandidateV1, EnergyV1, EventsV1, OtherSensorV1, RatingV1, SimulationV1, TestV1};
use crumple_stage::{Inputs, Loaded, Outcome, Output, RefuseExt, Refused, Stage, Usage, Wave, total_mass_remark};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::stage::chain_table::ChainSettings;
use crate::stage::drive::Driven;
use crate::stage::fitted_parameters::chosen;

/// The stage.
pub struct Simulate;

/// Flags and keys; what is not given has the default named in its text.
#[derive(Debug, Default, clap::Args, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// End of the compared window after time zero [default: dynamic crush of the test, or the end of a record without one]
    #[arg(long, value_name = "TIME")]
    pub to: Option<Time>,

    /// Keep the elastoplastic model attached after rebound, so that it oscillates for ever, instead of letting it leave
    /// the barrier [default: false]
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true", value_name = "BOOL")]
    pub stay_attached: Option<bool>,

    /// What moves the models: impact (the impact speed), force (a waveform of the inputs, N, from rest), base (the
    /// barrier's acceleration, a waveform of the inputs, from rest), pulse-as-force (the impact speed, and the mass times the
    /// measured acceleration as a force on the front mass: the transfer-function paper's simulation, circular)
    /// [default: impact]
    #[arg(long, value_name = "NAME")]
    pub drive: Option<String>,

    /// Waveform for --drive force or base, by its id, e.g. barrier/force
    #[arg(long, value_name = "ID")]
    pub drive_wave: Option<String>,

    /// Mass that --drive force acts on, from 1 at the barrier [default: 1]
    #[arg(long, value_name = "NUMBER")]
    pub drive_mass: Option<usize>,

    /// Chains of masses stated in the pipeline file, `[simulate.chain.<name>]`, simulated beside the candidates.
    #[arg(skip)]
    pub chain: toml::Table,
}

/// Options with every default filled in.
#[derive(Debug, Serialize)]
pub struct Settings {
    to_s: Option<f64>,
    stay_attached: bool,
    #[serde(flatten)]
    driven: Driven,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    chain: Vec<ChainSettings>,
}

impl Stage for Simulate {
    const NAME: &'static str = "simulate";
    const ABOUT: &'static str = "Simulates every candidate model and compares its motion with the test.";
    type Options = Options;
    type Settings = Settings;
    type Input = Inputs;

    fn resolve(options: Options) -> anyhow::Result<Settings> {
        let name = options.drive.as_deref().unwrap_or("impact");
        let driven = Driven::new("", name, options.drive_wave, options.drive_mass.unwrap_or(1))?;
        let chain = options
            .chain
            .iter()
            .map(|(name, table)| ChainSettings::read(name, table, &driven))
            .collect::<anyhow::Result<_>>()?;
        Ok(Settings {
            to_s: options.to.map(Time::si),
            stay_attached: options.stay_attached.unwrap_or(false),
            driven,
            chain,
        })
    }

    fn load(paths: &[PathBuf], _: &Settings) -> anyhow::Result<Loaded<Inputs>> {
        crumple_stage::load_artifacts(paths)
    }

    fn run(settings: &Settings, input: &Inputs, out: &mut Output) -> anyhow::Result<Outcome> {
        let test = input.test()?;
        let events: EventsV1 = input.record("/events")?;
        let candidates: Vec<(String, CandidateV1)> = input.records("/parameters/")?;
        if candidates.is_empty() && settings.chain.is_empty() {
            return Err(input.missing("/parameters/"));
        }
        for stated in &settings.chain {
            let fitted = format!("{CHAIN}/{}/", stated.name);
            if candidates.iter().any(|(id, _)| id.starts_with(&fitted)) {
                let problem =
                    format!("[simulate.chain.{}]: parameter-solve has fitted a chain of that name", stated.name);
                return Err(Usage::new(problem).hint("give one of them another name").into());
            }
        }
        let impact_speed_m_per_s = events.impact_speed_m_per_s.or(test.impact_speed_m_per_s).ok_or_else(|| {
            Refused::new("neither the events nor the test have an impact speed")
                .hint("--impact-speed 35km/h at crumple-ingest")
        })?;
        let channel = &events.channel;
        let displacement = input.wave(&format!("{channel}/displacement"))?.signal::<Displacement>().refuse()?;
        let velocity =
            input.wave_if(&format!("{channel}/velocity")).map(Wave::signal::<Velocity>).transpose().refuse()?;
        let acceleration = input.wave_if(channel).map(Wave::signal::<Acceleration>).transpose().refuse()?;
        let measured = Measured {
            time_zero_s: events.time_zero_s,
            impact_speed_m_per_s,
            displacement: &displacement,
            velocity: velocity.as_deref(),
            acceleration: acceleration.as_deref(),
            dynamic_crush_m: events.dynamic_crush_m,
            time_of_dynamic_crush_s: events.time_of_dynamic_crush_s,
        };

        let excitation = settings.driven.excitation(input, channel)?;
        let drive = settings.driven.words();
        if let Some(drive) = &drive {
            let caution = settings.driven.caution().map_or_else(String::new, |text| format!("; {text}"));
            out.notes().warning(format!("models are moved by {drive}{caution}"));
        }

        // Where the velocity never reaches zero the comparison ends with the event.
        let end_of_event_s = events.end_of_event_s.filter(|_| events.time_of_dynamic_crush_s.is_none());
        let window = Window { to_s: settings.to_s.or(end_of_event_s) };
        let results: Vec<Result<Simulation, SimulateError>> = candidates
            .par_iter()
            .map(|(_, candidate)| {
                if candidate.model == CHAIN {
                    let chain = SecantChain::from_parameters(&candidate.parameters)?;
                    return simulate_chain(&chain, None, &measured, window, &excitation);
                }
                let kind: ModelKind = candidate.model.parse()?;
                let mut model = Model::from_parameters(kind, &candidate.parameters)?;
                if let Model::Elastoplastic(elastoplastic) = &mut model {
                    elastoplastic.release = !settings.stay_attached;
                }
                simulate_driven(&model, &measured, window, &excitation)
            })
            .collect();
        let chains: Vec<Result<Simulation, SimulateError>> = settings
            .chain
            .iter()
            .map(|stated| {
                let excitation = stated.driven.excitation(input, channel)?;
                Ok(simulate_chain(&stated.chain()?, stated.speed_m_per_s, &measured, window, &excitation))
            })
            .collect::<anyhow::Result<_>>()?;

        out.put("/test", &TestV1::from(&test))?;
        let others = other_sensors(input, &test, channel)?;
        let simulations = || results.iter().chain(&chains).flatten();
        // The most that any candidate's error is worth: a smooth error makes no candidate good.
        let worth = simulations().filter_map(|s| effective_samples(&s.error_m)).reduce(f64::max);
        let mut simulated = 0;
        for ((id, candidate), result) in candidates.iter().zip(results) {
            match result {
                Ok(simulation) => {
                    simulated += 1;
                    out.summary(line(id, &simulation));
                    let mean_square = simulation.comparison.rmse_displacement_m.map(|rmse| rmse * rmse);
                    let criterion = worth.zip(mean_square).map(|(n, v)| information(v, n, chosen(candidate)));
                    let beside: Vec<SensorFit> = others
                        .iter()
                        .filter(|sensor| !was_fitted(candidate, &sensor.channel))
                        .filter_map(|sensor| beside(&simulation, sensor, events.time_zero_s, displacement.dt_s()))
                        .collect();
                    let beside = beside.into_iter().map(sensor_record).collect();
                    let found = (criterion, beside, drive.clone());
                    write(id, candidate, simulation, found, &displacement, events.time_zero_s, out)?;
                }
                Err(error) => out.notes().warning(format!("{id}: not simulated, {error}")),
            }
        }
        for (stated, result) in settings.chain.iter().zip(chains) {
            let id = stated.id();
            let passive = stated.chain()?.is_passive();
            if !passive {
                out.notes().warning(format!(
                    "{id}: a spring or damper of [simulate.chain.{}] is negative somewhere: no passive structure",
                    stated.name
                ));
            }
            let mut candidate = stated.candidate(passive);
            let masses = stated.chain()?;
            if let Some(text) = test.mass_kg.and_then(|kg| total_mass_remark(masses.masses_kg(), kg)) {
                out.notes().warning(format!("{id}: {text}"));
                candidate.notes.push(text);
            }
            out.put(&format!("/parameters/{id}"), &candidate)?;
            match result {
                Ok(simulation) => {
                    simulated += 1;
                    out.summary(line(&id, &simulation));
                    let mean_square = simulation.comparison.rmse_displacement_m.map(|rmse| rmse * rmse);
                    let criterion = worth.zip(mean_square).map(|(n, v)| information(v, n, chosen(&candidate)));
                    let beside = others
                        .iter()
                        .filter_map(|sensor| {
                            let mass = if sensor.on_engine { stated.engine()? } else { simulation.masses.len() };
                            beside_mass(&simulation, sensor, mass, events.time_zero_s, displacement.dt_s())
                        })
                        .map(sensor_record)
                        .collect();
                    let found = (criterion, beside, stated.words());
                    write(&id, &candidate, simulation, found, &displacement, events.time_zero_s, out)?;
                }
                Err(error) => out.notes().warning(format!("{id}: not simulated, {error}")),
            }
        }
        Ok(if simulated == 0 {
            Outcome::NoAcceptableResult("no candidate could be simulated; the notes say why".to_owned())
        } else {
            Outcome::Done
        })
    }
}

/// The model of a candidate that is a chain, stated here or fitted by parameter-solve.
const CHAIN: &str = "chain";

fn write(
    id: &str,
    candidate: &CandidateV1,
    simulation: Simulation,
    (information, other_sensors, drive): (Option<Information>, Vec<OtherSensorV1>, Option<String>),
    grid: &Sampled,
    time_zero_s: f64,
    out: &mut Output,
) -> anyhow::Result<()> {
    let Simulation { motion, mut events, comparison, dynamics, .. } = simulation;
    let mut notes = Vec::new();
    let end_s = grid.end_s() - time_zero_s;
    if let (Some(t), Some(crush)) = (events.time_of_dynamic_crush_s, events.dynamic_crush_m)
        && t > end_s + grid.dt_s()
    {
        notes.push(format!(
            "warning: the model stops only {:.0} ms after time zero with a crush of {:.0} mm; the record ends at {:.0} ms, so \
             this is no dynamic crush of the test",
            1e3 * t,
            1e3 * crush,
            1e3 * end_s
        ));
        (events.time_of_dynamic_crush_s, events.dynamic_crush_m) = (None, None);
    } else if events.dynamic_crush_m.is_none() {
        notes.push("the velocity of the model never reaches zero: it has no dynamic crush".to_owned());
    }
    if !candidate.physical {
        notes.push("warning: not a passive structure, a spring or damper is negative".to_owned());
    }
    if dynamics.as_ref().is_some_and(Dynamics::diverges) {
        notes.push("warning: diverges, the motion grows without end: a pole is unstable".to_owned());
    }
    let record = SimulationV1 {
        dynamic_crush_m: events.dynamic_crush_m,
        time_of_dynamic_crush_s: events.time_of_dynamic_crush_s,
        rmse_displacement_m: comparison.rmse_displacement_m,
        fit_percent: comparison.fit_displacement_percent,
        iso18571_score: comparison.iso18571_score,
        dynamic_crush_error_m: comparison.dynamic_crush_error_m,
        time_of_dynamic_crush_error_s: comparison.time_of_dynamic_crush_error_s,
        max_displacement_error_m: comparison.max_displacement_error_m,
        fit_velocity_percent: comparison.fit_velocity_percent,
        fit_acceleration_percent: comparison.fit_acceleration_percent,
        from_s: comparison.from_s,
        to_s: comparison.to_s,
        notes,
        aicc: information.and_then(|i| i.aicc),
        effective_samples: information.map(|i| i.effective_samples),
        fitted_parameters: information.map(|i| i.parameters),
        other_sensors,
        drive,
        energy: dynamics.as_ref().map_or_else(Vec::new, |d| energies(d, events.time_of_dynamic_crush_s)),
        energy_closure: dynamics.as_ref().and_then(Dynamics::energy_closure),
        ratings: comparison.ratings.into_iter().map(rating_record).collect(),
    };
    out.put(&format!("/simulation/{id}"), &record)?;
    let mut wave = |what: &str, quantity: QuantityKind, samples: Vec<f64>| {
        out.wave(&format!("{id}/{what}"), quantity, Sampled::new(time_zero_s, grid.dt_s(), samples)?)
    };
    let mut of_mass = |prefix: &str, motion: Motion| {
        wave(&format!("{prefix}displacement"), QuantityKind::Displacement, motion.displacement_m)?;
        wave(&format!("{prefix}velocity"), QuantityKind::Velocity, motion.velocity_m_per_s)?;
        wave(&format!("{prefix}acceleration"), QuantityKind::Acceleration, motion.acceleration_m_per_s2)
    };
    of_mass("", motion)?;
    let Some(dynamics) = dynamics else { return Ok(()) };
    // The last mass is the compartment, written above.
    let mut motions = dynamics.response.motions;
    motions.pop();
    for (k, motion) in motions.into_iter().enumerate() {
        of_mass(&format!("m{}/", k + 1), motion)?;
    }
    for element in dynamics.forces {
        wave(&format!("force/{}", element.name), QuantityKind::Force, element.force_n)?;
    }
    Ok(())
}

/// Every other accelerometer on the vehicle that was integrated.
fn other_sensors(input: &Inputs, test: &TestDescription, pulse: &str) -> anyhow::Result<Vec<OtherSensor>> {
    let mut found = Vec::new();
    for channel in test.channels.iter().filter(|channel| channel.id != pulse) {
        if let Some(wave) = input.wave_if(&format!("{}/displacement", channel.id)) {
            found.push(OtherSensor {
                channel: channel.id.clone(),
                on_engine: is_on_engine(channel),
                displacement: wave.signal::<Displacement>().refuse()?.into_sampled(),
            });
        }
    }
    Ok(found)
}

/// Whether the candidate's own fit saw this channel: it says nothing new then.
fn was_fitted(candidate: &CandidateV1, channel: &str) -> bool {
    candidate.fit.as_ref().is_some_and(|fit| fit.sensors.iter().any(|sensor| sensor.channel == channel))
}

fn sensor_record(fit: SensorFit) -> OtherSensorV1 {
    OtherSensorV1 {
        channel: fit.channel,
        mass: fit.mass as u32,
        rmse_displacement_m: fit.rmse_m,
        fit_percent: fit.fit_percent,
    }
}

fn rating_record(rating: Rating) -> RatingV1 {
    RatingV1 {
        name: rating.metric.name.to_owned(),
        quantity: rating.quantity.to_owned(),
        value: rating.metric.value,
        definition_id: rating.metric.id.to_owned(),
        mark: rating.mark.to_owned(),
        from_s: rating.metric.window.map(|window| window.from_s),
        to_s: rating.metric.window.map(|window| window.to_s),
        note: rating.note,
    }
}

/// Energy at the start, at the sample next to dynamic crush, and at the end.
fn energies(dynamics: &Dynamics, time_of_crush_s: Option<f64>) -> Vec<EnergyV1> {
    let dt_s = dynamics.response.dt_s;
    let last = dynamics.energy.len().saturating_sub(1);
    let crush = time_of_crush_s.map(|t| (t / dt_s).round() as usize).filter(|k| *k < last);
    [("start", Some(0)), ("dynamic crush", crush), ("end", Some(last))]
        .into_iter()
        .filter_map(|(instant, k)| {
            let energy = dynamics.energy.get(k?)?;
            Some(EnergyV1 {
                instant: instant.to_owned(),
                time_s: k? as f64 * dt_s,
                kinetic_j: energy.kinetic_j,
                stored_j: energy.stored_j,
                dissipated_j: energy.dissipated_j,
                input_j: energy.input_j,
            })
        })
        .collect()
}

fn line(id: &str, simulation: &Simulation) -> String {
    let c = &simulation.comparison;
    let crush = match (simulation.events.dynamic_crush_m, simulation.events.time_of_dynamic_crush_s) {
        (Some(crush), Some(t)) => format!("crush {:.1} mm at {:.2} ms", 1e3 * crush, 1e3 * t),
        _ => "never stops".to_owned(),
    };
    let fit = c.fit_displacement_percent.map_or_else(String::new, |fit| format!(", displacement fit {fit:.2} %"));
    let error = c.rmse_displacement_m.map_or_else(String::new, |rmse| format!(", rms error {:.2} mm", 1e3 * rmse));
    format!("{id}: {crush}{fit}{error}")
}
