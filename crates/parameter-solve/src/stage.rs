//! Reads the events and the displacement, solves, writes the candidates.

use std::collections::BTreeMap;
use std::path::PathBuf;

use crumple_parameter_solve::{Candidate, Evidence, MassSplit, solve};
use crumple_signal::Displacement;
use crumple_stage::records::{CandidateV1, EventsV1, FitV1, TestV1, UncertaintyV1};
use crumple_stage::{Inputs, Loaded, Outcome, Output, RefuseExt, Refused, Stage};

use crate::options::{Options, StageSettings};

/// The stage.
pub struct ParameterSolve;

impl Stage for ParameterSolve {
    const NAME: &'static str = "parameter-solve";
    const ABOUT: &'static str =
        "Finds the springs and dampers of lumped crash models from the crash events and the displacement of a test.";
    type Options = Options;
    type Settings = StageSettings;
    type Input = Inputs;

    fn resolve(options: Options) -> anyhow::Result<StageSettings> {
        Ok(options.try_into()?)
    }

    fn load(paths: &[PathBuf], _: &StageSettings) -> anyhow::Result<Loaded<Inputs>> {
        crumple_stage::load_artifacts(paths)
    }

    fn run(settings: &StageSettings, input: &Inputs, out: &mut Output) -> anyhow::Result<Outcome> {
        let test = input.test()?;
        let events: EventsV1 = input.record("/events")?;
        let mass_kg = match (settings.mass_kg, test.mass_kg, settings.solve.split) {
            (Some(given), Some(tested), _) => {
                out.notes().info(format!("mass {given} kg given by flag instead of the test's {tested} kg"));
                given
            }
            (Some(mass), ..) | (None, Some(mass), _) => mass,
            (None, None, MassSplit::Both(m1, m2)) => {
                out.notes().info(format!("the test has no mass; taken as m1 + m2 = {} kg", m1 + m2));
                m1 + m2
            }
            (None, None, _) => {
                return Err(Refused::new("the test has no mass")
                    .expected("the test mass, which turns frequencies into N/m")
                    .hint("--mass 873kg here or at crumple-ingest, or '# mass: 873 kg' in the header of the record")
                    .into());
            }
        };
        let impact_speed_m_per_s = events.impact_speed_m_per_s.or(test.impact_speed_m_per_s).ok_or_else(|| {
            Refused::new("neither the events nor the test have an impact speed")
                .hint("--impact-speed 35km/h at crumple-ingest")
        })?;
        let channel = &events.channel;
        let id = format!("{channel}/displacement");
        let wave = if settings.solve.fits_a_signal() { Some(input.wave(&id)?) } else { input.wave_if(&id) };
        let displacement = wave
            .map(crumple_stage::Wave::signal::<Displacement>)
            .transpose()
            .refuse_with_hint("crumple-integrate writes the displacement of the pulse")?;
        let evidence = Evidence {
            mass_kg,
            impact_speed_m_per_s,
            time_of_dynamic_crush_s: events.time_of_dynamic_crush_s,
            dynamic_crush_m: events.dynamic_crush_m,
            coefficient_of_restitution: events.coefficient_of_restitution,
            time_zero_s: events.time_zero_s,
            displacement: displacement.as_ref(),
        };
        let candidates = solve(&evidence, &settings.solve, out.notes())
            .refuse_with_hint("see --mass, --m1, --m2, --fit-from and --fit-to")?;

        out.put("/test", &TestV1::from(&test))?;
        for candidate in &candidates {
            out.put(&format!("/parameters/{}", candidate.id()), &record(candidate, channel))?;
            out.summary(line(candidate));
        }
        Ok(if candidates.is_empty() {
            Outcome::NoAcceptableResult("no model could be solved for; the notes say why".to_owned())
        } else {
            Outcome::Done
        })
    }
}

fn record(candidate: &Candidate, channel: &str) -> CandidateV1 {
    let named = |values: &BTreeMap<&'static str, f64>| values.iter().map(|(k, v)| ((*k).to_owned(), *v)).collect();
    CandidateV1 {
        model: candidate.model.kind().name().to_owned(),
        method: candidate.method.name().to_owned(),
        parameters: candidate.model.parameters(),
        physical: candidate.model.is_physical(),
        equivalent_to: candidate.equivalent_id(),
        fit: candidate.fit.as_ref().map(|fit| FitV1 {
            channel: channel.to_owned(),
            quantity: "displacement".to_owned(),
            from_s: fit.from_s,
            to_s: fit.to_s,
            samples: fit.samples as u64,
            rmse: fit.rmse_m,
            iterations: fit.iterations,
            evaluations: fit.evaluations,
            stop_reason: fit.stop_reason.name().to_owned(),
            active_bounds: fit.active_bounds.iter().map(|name| (*name).to_owned()).collect(),
        }),
        uncertainty: candidate.uncertainty.as_ref().map(|u| UncertaintyV1 {
            method: "linearised, autocorrelated residuals".to_owned(),
            standard_deviation: named(&u.standard_deviation),
            condition: Some(u.condition),
        }),
        notes: candidate.notes.clone(),
    }
}

/// `kelvin/closed-form/1: stiffness 321.9 kN/m, ...` in the units of the trade.
fn line(candidate: &Candidate) -> String {
    let parameters: Vec<String> = candidate
        .model
        .parameters()
        .iter()
        .map(|(name, value)| {
            if let Some(name) = name.strip_suffix("_n_s_per_m") {
                format!("{name} {:.3} kN s/m", value / 1e3)
            } else if let Some(name) = name.strip_suffix("_n_per_m") {
                format!("{name} {:.2} kN/m", value / 1e3)
            } else {
                format!("{} {value:.1} kg", name.trim_end_matches("_kg"))
            }
        })
        .map(|text| text.replace('_', " "))
        .collect();
    format!("{}: {}", candidate.id(), parameters.join(", "))
}
