//! Reads the events and the displacement, solves, writes the candidates.

mod assess;
mod chains;
mod exponential_sums;
mod inputs;
mod options;
mod records;

use std::path::PathBuf;

use crumple_lumped_fit::{
    Candidate, Evidence, FitQuantity, Identified, MassSplit, Method, Place, Quartic, Sensor, all_in_words,
    curve_fit_of_the_paper, masses, match_as_the_paper_typed, match_identified, solve,
};
use crumple_signal::{Acceleration, Displacement, Force, Sampled, TestDescription, Velocity};
use crumple_stage::records::{CandidateV1, EventsV1, ExponentialSumV1, FitV1, SensorFitV1, TestV1};
use crumple_stage::{Inputs, Loaded, Outcome, Output, RefuseExt, Refused, Stage, Wave};

use crate::stage::assess::candidates::judge_all;
use crate::stage::assess::replace_by_refined::held;
use crate::stage::chains::fit_chains;
use crate::stage::exponential_sums::maxwell_candidates;
use crate::stage::inputs::identified_models::{identified_models, matching_record};
use crate::stage::options::chain_table::FittedChain;
use crate::stage::options::flags::Options;
use crate::stage::options::settings::StageSettings;
use crate::stage::records::uncertainty::{Judged, of_its_own};

/// The stage.
pub struct ParameterSolve;

impl Stage for ParameterSolve {
    const NAME: &'static str = "parameter-solve";
    const ABOUT: &'static str =
        "Finds the springs and dampers of lumped crash models from the crash events and the displacement of a test.";
    type Options = Options;
    type Settings = StageSettings;
    type Input = Inputs;

    fn resolve(mut options: Options) -> anyhow::Result<StageSettings> {
        let chains = std::mem::take(&mut options.chain);
        let mut settings: StageSettings = options.try_into()?;
        settings.chain = chains.iter().map(|(name, table)| FittedChain::read(name, table)).collect::<Result<_, _>>()?;
        Ok(settings)
    }

    fn load(paths: &[PathBuf], _: &StageSettings) -> anyhow::Result<Loaded<Inputs>> {
        crumple_stage::load_artifacts(paths)
    }

    fn run(settings: &StageSettings, input: &Inputs, out: &mut Output) -> anyhow::Result<Outcome> {
        let events = input.record_if::<EventsV1>("/events")?;
        let windowed = events.and_then(|events| up_to_the_end_of_the_event(settings, &events, out));
        let settings = windowed.as_ref().unwrap_or(settings);
        let mut candidates = Vec::new();
        let mut judgements = Vec::new();
        let mut channel = String::new();
        let mut test = None;
        if settings.solve.needs_events() {
            let events: EventsV1 = input.record("/events")?;
            let described = input.test()?;
            if settings.mass_kg.or(described.mass_kg).is_none() && !matches!(settings.solve.split, MassSplit::Both(..))
            {
                // No fault of the artifact: ingest was told to go on without a mass, and the report shall still be made.
                out.put("/test", &TestV1::from(&described))?;
                return Ok(Outcome::NoAcceptableResult(
                    "the test has no mass, which turns frequencies into N/m: --mass 873kg here or at crumple-ingest, or \
                     '# mass: 873 kg' in the header of the record"
                        .to_owned(),
                ));
            }
            if speeds_up(input, &events)? {
                out.put("/test", &TestV1::from(&described))?;
                return Ok(Outcome::NoAcceptableResult(
                    "the vehicle goes further than its impact speed alone takes it: no spring and no damper does that; see whether the \
                     pulse has the wrong sign (crumple-ingest --sign flip) or unit"
                        .to_owned(),
                ));
            }
            candidates = from_events(settings, input, &described, &events, out)?;
            let mass_kg = settings.mass_kg.or(described.mass_kg);
            judgements = judge_all(&mut candidates, settings, input, &events, mass_kg, out)?;
            channel = events.channel;
            test = Some(described);
        } else if input.record_if::<TestV1>("/test")?.is_some() {
            test = Some(input.test()?);
        }
        if let Some(test) = &test {
            out.put("/test", &TestV1::from(test))?;
        }
        if settings.solve.uses(Method::CoefficientMatching) {
            let given = settings.mass_kg.or(test.as_ref().and_then(|test| test.mass_kg));
            candidates.extend(from_models(settings, input, given, out)?);
        }
        if settings.paper.is_some() {
            let matched = |c: &&Candidate| c.method == Method::CoefficientMatching;
            let first = candidates.iter().filter(matched).count() + 1;
            let ids = ["one-fifth-in-front", "four-fifths-in-front"];
            for (id, matched) in ids.into_iter().zip(match_as_the_paper_typed(first, out.notes())?) {
                let source = "printed denominator of the transfer-function paper";
                out.put(&format!("/matching/tfest-paper/{id}"), &matching_record(&matched, source))?;
                candidates.extend(matched.candidates);
            }
        }
        if settings.solve.uses(Method::CurveFit) {
            let given = settings.mass_kg.or(test.as_ref().and_then(|test| test.mass_kg));
            candidates.extend(from_exponentials(settings, input, given, out)?);
        }
        let given = settings.mass_kg.or(test.as_ref().and_then(|test| test.mass_kg));
        candidates.extend(maxwell_candidates(settings, input, given, out)?);
        // Those of identified models come last and have none.
        judgements.resize(candidates.len(), None);
        let flags = settings.judging.flags();
        let unjudged = candidates.iter().zip(&judgements).filter(|(_, judged)| judged.is_none());
        let unjudged: Vec<String> = unjudged.map(|(candidate, _)| candidate.id()).collect();
        if !flags.is_empty() && !unjudged.is_empty() {
            out.notes().warning(format!(
                "{} without effect on {}: judged are candidates from events and motion, over the window of the displacement of \
                 the pulse that they follow",
                flags.join(", "),
                unjudged.join(", ")
            ));
        }
        for candidate in &candidates {
            // The dual of a set stands on the same bounds.
            let dual = candidate.equivalent_to.is_some_and(|other| other < candidate.index);
            let words = all_in_words(&candidate.model, held(candidate));
            if !dual && !words.is_empty() {
                out.notes().warning(format!(
                    "{}: on a bound of the search, not determined by the record: {words}",
                    candidate.id()
                ));
            }
        }
        for (candidate, judged) in candidates.iter().zip(&judgements) {
            let record = record(candidate, judged.as_ref(), &channel);
            out.put(&format!("/parameters/{}", candidate.id()), &record)?;
            out.summary(parameters_line(&candidate.id(), &record));
            if let Some(text) = judged.as_ref().map(|judged| judged.line(candidate)).filter(|text| !text.is_empty()) {
                out.summary(text);
            }
        }
        let chains = fit_chains(settings, input, out)?;
        for (id, chain) in &chains {
            out.put(&format!("/parameters/{id}"), chain)?;
            out.summary(parameters_line(id, chain));
        }
        Ok(if candidates.is_empty() && chains.is_empty() {
            Outcome::NoAcceptableResult("no model could be solved for; the notes say why".to_owned())
        } else {
            Outcome::Done
        })
    }
}

/// More of the way at constant speed than this part, and the record shows a vehicle that speeds up; a drifting zero level of
/// 0.1 g adds 1 % of 10 m/s in 100 ms.
const SPEEDS_UP: f64 = 1.05;

/// Whether the vehicle, which never stops, is at the end of its record beyond where its impact speed alone would have taken it.
fn speeds_up(input: &Inputs, events: &EventsV1) -> anyhow::Result<bool> {
    let wave = input.wave_if(&format!("{}/displacement", events.channel));
    let Some(displacement) = wave.map(Wave::signal::<Displacement>).transpose().refuse()? else { return Ok(false) };
    let (Some(speed), Some(end_m)) = (events.impact_speed_m_per_s, displacement.samples().last()) else {
        return Ok(false);
    };
    let alone_m = speed * (displacement.end_s() - events.time_zero_s);
    Ok(events.dynamic_crush_m.is_none() && alone_m > 0.0 && *end_m > SPEEDS_UP * alone_m)
}

/// The settings with the end of the event as the end of the window, where the velocity never reaches zero and no end is stated.
fn up_to_the_end_of_the_event(settings: &StageSettings, events: &EventsV1, out: &mut Output) -> Option<StageSettings> {
    let open = settings.solve.fit_to_s.is_none() && events.time_of_dynamic_crush_s.is_none();
    let end_s = events.end_of_event_s.filter(|end_s| open && *end_s > settings.solve.fit_from_s)?;
    out.notes().info(format!(
        "the velocity never reaches zero: fitted up to the end of the event at {:.1} ms ({}); --fit-to states another",
        1e3 * end_s,
        events.end_of_event_rule.as_deref().unwrap_or("rule not stated")
    ));
    let mut settings = settings.clone();
    settings.solve.fit_to_s = Some(end_s);
    Some(settings)
}

/// Candidates from the events and the displacement.
fn from_events(
    settings: &StageSettings,
    input: &Inputs,
    test: &TestDescription,
    events: &EventsV1,
    out: &mut Output,
) -> anyhow::Result<Vec<Candidate>> {
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
        (None, None, _) => return Err(Refused::new("the test has no mass").hint("--mass 873kg").into()),
    };
    let impact_speed_m_per_s = events.impact_speed_m_per_s.or(test.impact_speed_m_per_s).ok_or_else(|| {
        Refused::new("neither the events nor the test have an impact speed")
            .hint("--impact-speed 35km/h at crumple-ingest")
    })?;
    let id = format!("{}/displacement", events.channel);
    let wave = if settings.solve.fits_a_signal() { Some(input.wave(&id)?) } else { input.wave_if(&id) };
    let displacement = wave
        .map(Wave::signal::<Displacement>)
        .transpose()
        .refuse_with_hint("crumple-integrate writes the displacement of the pulse")?;
    let waves = sensor_waves(settings, input, &events.channel, mass_kg)?;
    let sensors: Vec<Sensor<'_>> = waves
        .iter()
        .map(|(place, channel, record)| Sensor {
            channel,
            place: *place,
            quantity: settings.solve.quantity,
            record,
            noise: None,
        })
        .collect();
    let evidence = Evidence {
        mass_kg,
        impact_speed_m_per_s,
        time_of_dynamic_crush_s: events.time_of_dynamic_crush_s,
        dynamic_crush_m: events.dynamic_crush_m,
        coefficient_of_restitution: restitution(events),
        time_zero_s: events.time_zero_s,
        time_of_rebound_s: events.time_of_rebound_s,
        displacement: displacement.as_ref(),
        sensors: &sensors,
    };
    solve(&evidence, &settings.solve, out.notes()).refuse_with_hint("see --mass, --m1, --m2, --fit-from and --fit-to")
}

/// The coefficient of restitution; zero where its interval holds zero.
fn restitution(events: &EventsV1) -> Option<f64> {
    let holds_zero = events.intervals.iter().any(|i| i.name == "coefficient_of_restitution" && i.low <= 0.0);
    events.coefficient_of_restitution.map(|e| if holds_zero { 0.0 } else { e })
}

/// The motions to fit together; none where it is the displacement of the pulse alone.
fn sensor_waves(
    settings: &StageSettings,
    input: &Inputs,
    pulse: &str,
    mass_kg: f64,
) -> anyhow::Result<Vec<(Place, String, Sampled)>> {
    let quantity = settings.solve.quantity;
    let mut places = settings.places.clone();
    if places.is_empty() && quantity == FitQuantity::Displacement || !settings.solve.fits_a_signal() {
        return Ok(Vec::new());
    }
    if !places.iter().any(|(place, _)| *place == Place::Compartment) {
        places.insert(0, (Place::Compartment, pulse.to_owned()));
    }
    let one = |(place, channel): (Place, String)| -> anyhow::Result<(Place, String, Sampled)> {
        let record = motion(input, &channel, quantity, mass_kg)?;
        Ok((place, channel, record))
    };
    places.into_iter().map(one).collect()
}

/// The motion of a channel.
pub fn motion(input: &Inputs, channel: &str, quantity: FitQuantity, mass_kg: f64) -> anyhow::Result<Sampled> {
    let hint = "crumple-integrate writes the motion of the pulse and of the channels named with --channels there";
    let wave = |what: &str| {
        let id = format!("{channel}/{what}");
        input.wave_if(&id).map_or_else(|| Err(not_integrated(input, channel, what)), Ok)
    };
    Ok(match quantity {
        FitQuantity::Displacement => {
            wave("displacement")?.signal::<Displacement>().refuse_with_hint(hint)?.into_sampled()
        }
        FitQuantity::Velocity => wave("velocity")?.signal::<Velocity>().refuse_with_hint(hint)?.into_sampled(),
        FitQuantity::Acceleration => acceleration(input, channel, mass_kg)?,
    })
}

/// The refusal of a sensor whose motion no input holds: where other channels were integrated it was not among them, else the
/// artifact is missing.
fn not_integrated(input: &Inputs, channel: &str, what: &str) -> anyhow::Error {
    let integrated: Vec<&str> = input.waves().filter_map(|(id, _)| id.strip_suffix(&format!("/{what}"))).collect();
    if integrated.is_empty() {
        return input.missing(&format!("/wave/{channel}/{what}"));
    }
    let known = input.test().is_ok_and(|test| test.channel(channel).is_some());
    let (found, hint) = if known {
        let hint = format!("add {channel:?} to channels of [integrate], or crumple-integrate --channels all,{channel}");
        (format!("channel {channel}, which sensors names, was not integrated"), hint)
    } else {
        let hint = "sensors = [\"place=channel\"] takes ids of channels; crumple-artifact show lists them".to_owned();
        (format!("the test has no channel {channel:?}, which sensors names"), hint)
    };
    Refused::new(found)
        .expected(format!("a channel whose {what} the inputs hold: {}", integrated.join(", ")))
        .hint(hint)
        .into()
}

/// The acceleration of a channel from the filter's artifact, else from the force that integrate made of it.
pub fn acceleration(input: &Inputs, channel: &str, mass_kg: f64) -> anyhow::Result<Sampled> {
    if let Some(wave) = input.wave_if(channel) {
        let hint = "name an accelerometer with --sensors";
        return Ok(wave.signal::<Acceleration>().refuse_with_hint(hint)?.into_sampled());
    }
    let tested = input.test()?.mass_kg.unwrap_or(mass_kg);
    let Some(force) = input.wave_if(&format!("{channel}/force")) else {
        return Err(Refused::new(format!("none of the inputs holds the acceleration of channel {channel}"))
            .hint("give the artifact of crumple-filter too")
            .into());
    };
    let force = force.signal::<Force>().refuse()?;
    let samples = force.samples().iter().map(|f| -f / tested).collect();
    Ok(Sampled::new(force.t0_s(), force.dt_s(), samples)?)
}

/// Masses of chassis and compartment, by the options and the test.
fn given_masses(settings: &StageSettings, mass_kg: Option<f64>, out: &mut Output) -> anyhow::Result<(f64, f64)> {
    let mass_kg = match (mass_kg, settings.solve.split) {
        (Some(mass), _) => mass,
        (None, MassSplit::Both(m1, m2)) => m1 + m2,
        (None, _) => {
            return Err(Refused::new("the test has no mass")
                .expected("the masses of chassis and compartment")
                .hint("--m1 284.4kg --m2 1137.6kg")
                .into());
        }
    };
    let (m1_kg, m2_kg, split) = masses(mass_kg, settings.solve.split).refuse_with_hint("see --m1 and --m2")?;
    out.notes().info(split);
    Ok((m1_kg, m2_kg))
}

/// Candidates of the ERA paper's curve fit from every sum of four real exponentials.
fn from_exponentials(
    settings: &StageSettings,
    input: &Inputs,
    mass_kg: Option<f64>,
    out: &mut Output,
) -> anyhow::Result<Vec<Candidate>> {
    let sums = input.records::<ExponentialSumV1>("/model/")?;
    if sums.is_empty() {
        return Err(Refused::new("none of the inputs holds a sum of exponentials")
            .expected("a sum of four real ones below /model/")
            .hint("crumple-identify --methods exponentials --terms 4 --real")
            .into());
    }
    let (m1_kg, m2_kg) = given_masses(settings, mass_kg, out)?;
    let mut candidates = Vec::new();
    for (id, sum) in sums {
        let real = sum.terms.iter().all(|term| term.im_rad_per_s == 0.0);
        let [a, b, c, d] = &sum.terms[..] else {
            out.notes().warning(format!("curve-fit: {id} has {} terms, the paper's form has four", sum.terms.len()));
            continue;
        };
        if !real {
            out.notes().warning(format!(
                "curve-fit: {id} has a damped wave, the paper's form has four real exponents (--real at crumple-identify); \
                 coefficient-matching takes any"
            ));
            continue;
        }
        let exponents = [a, b, c, d].map(|term| term.re_per_s);
        let amplitudes = [a, b, c, d].map(|term| term.re_amplitude);
        match curve_fit_of_the_paper(&id, &exponents, &amplitudes, m1_kg, m2_kg, candidates.len() + 1) {
            Ok(candidate) => {
                out.notes().warning(format!("{}: as the ERA paper prints it, for reproduction only", candidate.id()));
                candidates.push(candidate);
            }
            Err(error) => out.notes().warning(format!("curve-fit: {id}: {error}")),
        }
    }
    Ok(candidates)
}

/// Candidates from every identified model with four poles, and the record of each matching.
fn from_models(
    settings: &StageSettings,
    input: &Inputs,
    mass_kg: Option<f64>,
    out: &mut Output,
) -> anyhow::Result<Vec<Candidate>> {
    let identified = identified_models(input)?;
    if identified.is_empty() && settings.paper.is_some() {
        return Ok(Vec::new());
    }
    let (m1_kg, m2_kg) = given_masses(settings, mass_kg, out)?;
    if identified.is_empty() {
        return Err(Refused::new("none of the inputs holds a model with four poles")
            .expected(
                "below /model/ a transfer function with a denominator of degree 4, a state space of order 4 or a sum of four \
                 exponentials, or four poles below /modes/",
            )
            .hint("give the artifact of crumple-identify with order 4, or --methods exponentials --terms 4, too")
            .into());
    }
    let mut candidates: Vec<Candidate> = Vec::new();
    for model in &identified {
        let first = candidates.len() + 1;
        let matched =
            match_identified(model, m1_kg, m2_kg, first, out.notes()).refuse_with_hint(matching_hint(model))?;
        out.put(&format!("/matching/{}", model.id), &matching_record(&matched, model.source))?;
        candidates.extend(matched.candidates);
    }
    Ok(candidates)
}

/// What to do where matching refuses an identified model. The masses have been checked: it is its poles.
fn matching_hint(model: &Identified) -> String {
    match model.quartic {
        Quartic::Coefficients(_) => format!("look at the denominator of {}: its coefficients must be finite", model.id),
        Quartic::Poles(_) => {
            format!("look at {}: its complex poles must come in conjugate pairs, each written down", model.id)
        }
    }
}

fn record(candidate: &Candidate, judged: Option<&Judged>, channel: &str) -> CandidateV1 {
    CandidateV1 {
        model: candidate.model.kind().name().to_owned(),
        method: candidate.method.name().to_owned(),
        parameters: candidate.model.parameters(),
        physical: candidate.model.is_physical(),
        equivalent_to: candidate.equivalent_id(),
        fit: candidate.fit.as_ref().map(|fit| FitV1 {
            channel: channel.to_owned(),
            quantity: fit.quantity.name().to_owned(),
            from_s: fit.from_s,
            to_s: fit.to_s,
            samples: fit.samples as u64,
            rmse: fit.rmse,
            iterations: fit.iterations,
            evaluations: fit.evaluations,
            stop_reason: fit.stop_reason.name().to_owned(),
            active_bounds: fit.active_bounds.iter().map(|name| (*name).to_owned()).collect(),
            sensors: fit
                .sensors
                .iter()
                .map(|sensor| SensorFitV1 {
                    channel: sensor.channel.clone(),
                    mass: sensor.mass as u32,
                    quantity: sensor.quantity.name().to_owned(),
                    rmse: sensor.rmse,
                    noise: sensor.noise,
                })
                .collect(),
        }),
        uncertainty: judged
            .map(Judged::record)
            .or_else(|| candidate.uncertainty.as_ref().map(|u| of_its_own(u, &candidate.model.parameters()))),
        notes: candidate.notes.clone(),
    }
}

/// `kelvin/closed-form/1: stiffness 321.9 kN/m, ...` in the units of the trade, and how many of them the record leaves open.
fn parameters_line(id: &str, candidate: &CandidateV1) -> String {
    let open = match (candidate.undetermined().len(), candidate.asked().count()) {
        (0, _) => String::new(),
        (n, of) => format!("; {n} of {of} not determined"),
    };
    let parameters: Vec<String> = candidate
        .parameters
        .iter()
        .map(|(name, value)| {
            if let Some(name) = name.strip_suffix("_n_s_per_m") {
                format!("{name} {:.3} kN s/m", value / 1e3)
            } else if let Some(name) = name.strip_suffix("_n_per_m") {
                format!("{name} {:.2} kN/m", value / 1e3)
            } else if let Some(name) = name.strip_suffix("_m_per_s") {
                format!("{name} {value:.3} m/s")
            } else if let Some(name) = name.strip_suffix("_m") {
                format!("{name} {:.1} mm", 1e3 * value)
            } else {
                format!("{} {value:.1} kg", name.trim_end_matches("_kg"))
            }
        })
        .map(|text| text.replace('_', " "))
        .collect();
    format!("{id}: {}{open}", parameters.join(", "))
}
