//! From the files of a record to a test description, waveforms and their quality.

use clap::ValueEnum as _;
use crumple_artifact::records::{DamageV1, VehicleV1};
use crumple_metrics::{Exchange, Plausibility, plausibility};
use crumple_signal::value::Time;
use crumple_signal::{
    About, Channel, KindOfTest, Notes, SIMULATED, Source, TestDescription, TestKind, Weight, is_mass_of_a_vehicle,
    part_of, remarks,
};

use crate::checks::exchanges::Answer;
use crate::checks::{channel_quality, exchanges};
use crate::error::{Question, Refusal};
use crate::files::open;
use crate::formats::reader::{Bundle, Reader, stem};
use crate::pulse::Polarity;
use crate::recording::content::{ReadChannel, Recording, Wave};
use crate::recording::details::{self, Details, Stated};
use crate::recording::unit_system::UnitSystem;
use crate::recording::{content, settings};
use crate::{IngestError, IngestSettings, Result, contact, impact, kind, pulse, refuse, wall};

/// Result of the stage.
#[derive(Debug, Clone)]
pub struct Ingested {
    /// The test, its pulse named.
    pub test: TestDescription,
    /// Every channel with data, in the order of the source.
    pub waves: Vec<Wave>,
    /// What was measured on the vehicle afterwards, where the record says so.
    pub damage: Option<DamageV1>,
    /// The vehicles of a test with several, that of the pulse with what was stated about it.
    pub vehicles: Vec<VehicleV1>,
    /// Speed at which they approach each other, m/s.
    pub closing_speed_m_per_s: Option<f64>,
    /// Whether impact speed and pulse fit together; `None` where nothing is to be held against each other.
    pub plausibility: Option<Plausibility>,
    /// Remarks.
    pub notes: Notes,
}

impl Ingested {
    /// The waveform of the pulse.
    pub fn pulse(&self) -> Option<&Wave> {
        let id = self.test.pulse.as_deref()?;
        self.waves.iter().find(|wave| wave.id == id)
    }
}

/// Reads a record and applies what is stated about it: `flags` beat the sidecar, which beats the record.
///
/// Samples are as in the file but for the factor of their unit, and the sign if flipping is asked for. Where one
/// exchange of units, speeds, times or signs makes pulse and impact speed fit, the first note asks for it, with the
/// flag that was tried and mends it.
pub fn ingest(bundle: &Bundle, flags: &IngestSettings) -> Result<Ingested> {
    if let Some(error) = unit_asked_at_the_start(bundle, flags) {
        return Err(error);
    }
    let ingested = match read(bundle, flags) {
        Err(error) if error.refusal == Refusal::UnitOfTime => proven_unit_of_time(bundle, flags, error),
        read => read,
    };
    let mut ingested = ingested.map_err(|error| everything_asked(bundle, flags, error))?;
    let Some(plausibility) = &ingested.plausibility else { return Ok(ingested) };
    let speed = ingested.test.impact_speed_m_per_s.unwrap_or(0.0);
    let answers = match plausibility {
        Plausibility::After(exchange, _) => exchanges::answers(*exchange, flags, speed),
        _ => Vec::new(),
    };
    let mends = |answer: &Answer| match bundle.large {
        // A table that is read piece by piece is not read again for a question: of several answers none is tried.
        Some(_) => answers.len() == 1,
        None => read(bundle, &answer.settings).is_ok_and(|read| read.plausibility == Some(Plausibility::Consistent)),
    };
    let answer = answers.iter().find(|answer| mends(answer)).map(|answer| answer.flag.as_str());
    if let Some(question) = exchanges::question(plausibility, answer, speed) {
        refuse_slow_times(bundle, &ingested, answer, &question.text)?;
        ingested.notes.push_first(question);
        ingested.test.exchange_asked = true;
    }
    Ok(ingested)
}

/// A table of more bytes than this is asked for its unit at its start, so that who has to state it does not wait for
/// the rest.
const LONG: usize = 1 << 20;
/// So many of its bytes are its start: its names and some hundred rows.
const START: usize = 1 << 14;

/// The refusal of a long table that states no unit of acceleration. Its names say so, and no row below them another.
fn unit_asked_at_the_start(bundle: &Bundle, flags: &IngestSettings) -> Option<IngestError> {
    let bytes = bundle.main.bytes.get(..START).filter(|start| (bundle.reader.streams)(start))?;
    let is_long = bundle.large.is_some() || bundle.main.bytes.len() > LONG;
    let end = bytes.iter().rposition(|byte| *byte == b'\n').filter(|_| is_long)? + 1;
    let start = Bundle {
        name: bundle.name.clone(),
        sidecar: bundle.sidecar.clone(),
        ..Bundle::with_reader(&bundle.main.name, bytes[..end].to_vec(), bundle.reader)
    };
    let choices = flags.with_number_of_vehicle().over(&open::settings(&start).ok()?.with_number_of_vehicle());
    let error = recording_of(&start, &choices).err().filter(|error| error.question == Some(Question::Unit))?;
    Some(everything_asked(&start, flags, error))
}

/// A refusal that a flag answers, with all that would be asked after it: answers are supposed until nothing more is
/// asked. A record that is read piece by piece is not read again for it.
fn everything_asked(bundle: &Bundle, flags: &IngestSettings, error: IngestError) -> IngestError {
    let (mut supposed, mut next, mut answers) = (flags.clone(), Vec::<IngestError>::new(), Vec::new());
    let mut question = error.question.clone().filter(|_| bundle.large.is_none());
    while let Some(asked) = question.take() {
        match asked {
            Question::UnitOfTime => supposed.time_unit = Some("ms".to_owned()),
            Question::Interval => supposed.sample_time = Some(Time::from_si(1e-3)),
            Question::Unit => supposed.unit = Some("g".to_owned()),
            Question::Channel(id) => supposed.channel = Some(id),
            Question::Node(id) => supposed.node = Some(id.into()),
            Question::Units(system) => {
                supposed.units = UnitSystem::from_str(system.unwrap_or("mm-ms-kg"), false).ok();
            }
        }
        let Err(later) = read(bundle, &supposed) else { break };
        let is_new = std::iter::once(&error).chain(&next).all(|before| before.question != later.question);
        let Some(asked) = later.question.clone().filter(|_| is_new) else { break };
        answers.push(match &asked {
            Question::UnitOfTime => "--time-unit ms (or s, us)".to_owned(),
            Question::Interval => "--sample-time 100us, for example".to_owned(),
            Question::Unit => "--unit g (or m/s^2, whichever it is)".to_owned(),
            Question::Channel(id) => format!("--channel {id}, for example"),
            Question::Node(id) => format!("--node {id}, for example"),
            Question::Units(Some(system)) => format!("--units {system}"),
            Question::Units(None) => "--units of the model".to_owned(),
        });
        next.push(later);
        question = Some(asked);
    }
    if next.is_empty() { error } else { error.with_next(&next, &answers) }
}

/// The record of which nothing states the unit of time, in the unit that physics proves; else `error`.
///
/// The change of velocity is proportional to the unit of time, and the crush to its square. So of units that are 1000
/// times apart at most one gives the pulse that stops the vehicle from its impact speed, which is a change of 1 to 1.3
/// times that speed (2 at 4 km/h). Times of a crash in s have steps below 0.02, so ms and us are tried.
fn proven_unit_of_time(bundle: &Bundle, flags: &IngestSettings, error: IngestError) -> Result<Ingested> {
    for unit in ["ms", "us"] {
        let tried = IngestSettings { tried_time_unit: Some(unit), ..flags.clone() };
        let Ok(mut ingested) = read(bundle, &tried) else { continue };
        let speed = ingested.test.impact_speed_m_per_s;
        let Some(speed) = speed.filter(|_| ingested.plausibility == Some(Plausibility::Consistent)) else { continue };
        ingested.notes.push(ProvenTimeUnit { reason: error.to_string(), unit, impact_speed_m_per_s: speed });
        return Ok(ingested);
    }
    Err(error)
}

/// Refuses times so far apart that no crash is resolved, where a flag makes a crash of them: no filter would take them.
fn refuse_slow_times(bundle: &Bundle, ingested: &Ingested, answer: Option<&str>, question: &str) -> Result<()> {
    let is_too_slow = ingested.pulse().is_some_and(channel_quality::is_too_slow);
    match (&ingested.plausibility, answer) {
        (Some(Plausibility::After(Exchange::Time(_), _)), Some(flag)) if is_too_slow => {
            refuse(&bundle.name, question, "600 samples a second at least (ten times CFC 60)", format!("add {flag}"))
        }
        _ => Ok(()),
    }
}

/// [`ingest`] without the question for an exchange.
/// Warns of flags that records of a format do not listen to.
fn warn_of_flags(choices: &IngestSettings, reader: &Reader, notes: &mut Notes) {
    let why = format!("a record of the format {} states this itself, or has no such thing", reader.format);
    settings::warn_except(choices, reader.relevant_flags, &why, notes);
}

fn read(bundle: &Bundle, flags: &IngestSettings) -> Result<Ingested> {
    let file = bundle.name.as_str();
    let stated_in_sidecar = open::settings(bundle)?.with_number_of_vehicle();
    let flags = &flags.with_number_of_vehicle();
    let choices = flags.over(&stated_in_sidecar);
    let (reader, mut recording) = (bundle.reader, recording_of(bundle, &choices)?);
    let mut notes = std::mem::take(&mut recording.notes);
    warn_of_flags(&choices, reader, &mut notes);
    let allow_missing = choices.allow_missing.unwrap_or(false) || recording.details.no_pulse;
    // A velocity is named as the pulse, and has none of the checks of an acceleration.
    let (pulse, velocity) = if recording.details.no_pulse {
        (None, pulse::choose(file, &recording, choices.channel.as_deref(), &mut notes)?)
    } else {
        let missing = (allow_missing, is_of_a_crash(&recording.details, &choices));
        (pulse::choose_pulse(file, &recording, choices.channel.as_deref(), missing, &mut notes)?, None)
    };
    if !SIMULATED.contains(&reader.format) {
        check_samples(file, &recording, pulse.or(velocity), &mut notes)?;
    }

    if let Some(pulse) = pulse {
        facts_of_its_vehicle(&mut recording, pulse, &mut notes);
        speed_of_the_pulse(&mut recording, pulse, &mut notes);
    }
    if let Some(sidecar) = &bundle.sidecar {
        details::apply(&mut recording.details, &stated_in_sidecar, &sidecar.name, &mut notes);
    }
    let of_record = recording.details.mass_kg.as_ref().map(|mass| mass.value);
    details::apply(&mut recording.details, flags, "flag", &mut notes);
    let is_of_occupant = pulse.is_some_and(|k| part_of(&recording.channels[k].channel).is_some());
    details::check(file, &recording.details)?;

    let mut contact =
        contact::settle(file, &mut recording, (pulse, is_of_occupant, reader.format), &choices, &mut notes)?;
    times_in_range(file, &recording)?;
    velocity.into_iter().for_each(|k| pulse::speed_at_contact(&mut recording, k, &mut notes));
    let is_turned = pulse::turn_sign(&mut recording, pulse, choices.sign.unwrap_or_default(), &mut notes)
        .map_err(|error| overflow(file, &error.to_string()))?;
    impact::take(file, &mut recording, pulse, choices.impact, &mut contact, &mut notes)?;
    let code = pulse.and_then(|k| recording.channels[k].channel.code.clone());
    let pulse_id = pulse.map(|k| recording.channels[k].channel.id.clone());
    let same_place: Vec<String> =
        recording.channels.iter().filter(|f| f.fitness.is_some()).map(|f| f.channel.id.clone()).collect();
    let waves = take_waves(&mut recording);
    let speed = recording.details.impact_speed_m_per_s.as_ref().map(|s| s.value);
    let wave_of_pulse = waves.iter().find(|wave| Some(&wave.id) == pulse_id.as_ref());
    let of_body = wave_of_pulse.filter(|_| !is_of_occupant);
    let kind = kind::settle(&recording.details, code.as_deref(), of_body.zip(Some(speed)), &mut notes);
    let certain = kind.as_ref().and_then(kind::Found::certain);
    let polarity = Polarity::of(is_of_occupant, is_turned, certain, code.as_deref());
    let from_rest = matches!(polarity, Polarity::AsRead | Polarity::OfSled)
        && wave_of_pulse.is_some_and(|w| pulse::pushes_forward(&w.samples, w.quality.zero_level()));
    let held = of_body.filter(|_| polarity != Polarity::OfSled && details::is_alone(&recording.details));
    let plausibility = held
        .zip(speed)
        .and_then(|(wave, speed)| plausibility(&wave.samples, wave.quality.zero_level().unwrap_or(0.0), speed));
    let polarity = polarity.unless_asked(plausibility.as_ref());
    // Of inputs and outputs nobody asks for a mass.
    if pulse.is_some() || recording.details.no_pulse || is_of_a_crash(&recording.details, &choices) {
        missing_details(&recording.details, reader.has_comments, (is_of_occupant, certain), from_rest, &mut notes);
    }
    if !SIMULATED.contains(&reader.format) {
        channel_quality::check(&waves, pulse_id.as_deref(), speed, polarity, &mut notes);
    }
    let pulse_id = pulse_id.or(velocity.map(|k| recording.channels[k].channel.id.clone()));
    if !is_of_occupant {
        let is_typed = flags.mass.is_some() && !of_record.is_some_and(is_mass_of_a_vehicle);
        details::question_mass(&recording.details, is_typed, &mut notes);
    }

    let channels: Vec<Channel> = recording.channels.into_iter().map(|read| read.channel).collect();
    channel_quality::check_redundant_sensors(&channels, &waves, &same_place, speed, &mut notes);

    let details = recording.details;
    let (damage, mut vehicles) = (details.damage, details.vehicles);
    let carries = |vehicle: &VehicleV1| pulse_id.as_ref().is_some_and(|id| vehicle.channels.contains(id));
    if let Some(own) = vehicles.iter_mut().find(|vehicle| carries(vehicle)) {
        own.mass_kg = details.mass_kg.as_ref().map(|s| s.value);
        own.impact_speed_m_per_s = speed;
        own.pulse.clone_from(&pulse_id);
    }
    let words = |stated: Option<Stated<String>>| stated.map(|s| s.value);
    let test = TestDescription {
        title: words(details.title).unwrap_or_else(|| stem(file).to_owned()),
        vehicle: words(details.vehicle),
        mass_kg: details.mass_kg.map(|s| s.value),
        impact_speed_m_per_s: speed,
        barrier: words(details.barrier),
        source: Source { format: reader.format.to_owned(), name: file.to_owned(), digest: bundle.digest() },
        channels,
        pulse: pulse_id,
        notes: details.facts,
        contact,
        exchange_asked: false,
        kind: kind.map(KindOfTest::from),
        overlap: details.overlap.map(|stated| stated.value),
    };
    let closing_speed_m_per_s = details.closing_speed_m_per_s;
    Ok(Ingested { test, waves, damage, vehicles, closing_speed_m_per_s, plausibility, notes })
}

/// Refuses or notes samples that no sensor measured, of the pulse and of all others.
fn check_samples(file: &str, recording: &Recording, pulse: Option<usize>, notes: &mut Notes) -> Result<()> {
    if let Some(k) = pulse {
        exchanges::check(file, &recording.channels[k], notes)?;
    }
    let others = recording.channels.iter().enumerate().filter(|(k, _)| Some(*k) != pulse);
    exchanges::check_others(others.map(|(_, read)| read), notes);
    Ok(())
}

/// What the reader makes of the files, the sensors where a person puts them.
fn recording_of(bundle: &Bundle, choices: &IngestSettings) -> Result<Recording> {
    let mut recording = bundle.read(choices)?;
    if let Some(scales) = &choices.scale {
        scales.apply(&bundle.name, &mut recording.channels, &mut recording.notes)?;
    }
    if let Some(place) = choices.place {
        pulse::place_on_body(&mut recording.channels, place);
    }
    wall::place(&bundle.name, &mut recording, choices.wall.as_deref())?;
    Ok(recording)
}

/// Whether a record, or who brings it, states what only a crash has.
fn is_of_a_crash(details: &Details, choices: &IngestSettings) -> bool {
    let is_chosen = choices.mass.is_some() || choices.impact_speed.is_some() || choices.barrier.is_some();
    is_chosen
        || details.mass_kg.is_some()
        || details.impact_speed_m_per_s.is_some()
        || details.vehicle.is_some()
        || details.barrier.is_some()
        || details.damage.is_some()
        || !details.vehicles.is_empty()
}

/// Notes which of mass and impact speed is missing. The criteria of an occupant need neither, nor does a record
/// without a pulse, nor what is no vehicle and has no model of a structure.
fn missing_details(
    details: &Details,
    has_comments: bool,
    (is_of_occupant, kind): (bool, Option<TestKind>),
    from_rest: bool,
    notes: &mut Notes,
) {
    let is_missing = details.mass_kg.is_none() || details.impact_speed_m_per_s.is_none();
    if is_of_occupant {
        if is_missing {
            notes.push(NeedsNeither { kind: None });
        }
    // A component has a structure once its mass is stated.
    } else if let Some(kind) = kind.filter(|kind| matches!(kind, TestKind::Sled | TestKind::Catapult)) {
        if is_missing {
            notes.push(NeedsNeither { kind: Some(kind.name()) });
        }
    } else {
        details::note_missing(details, has_comments, from_rest, notes);
    }
}

/// The channels with data, with their quality as measured.
fn take_waves(recording: &mut Recording) -> Vec<Wave> {
    let take = |read: &mut ReadChannel| {
        let samples = read.wave.take()?;
        let quality = content::measure(&samples, read.jitter, read.channel.may_feel_gravity());
        Some(Wave { id: read.channel.id.clone(), quantity: read.channel.quantity, samples, quality })
    };
    recording.channels.iter_mut().filter_map(take).collect()
}

/// A pulse on another vehicle than the one that the record was read for has the mass and the speed of its own.
fn facts_of_its_vehicle(recording: &mut Recording, pulse: usize, notes: &mut Notes) {
    let id = &recording.channels[pulse].channel.id;
    let details = &mut recording.details;
    let Some(own) = details.vehicles.iter().find(|vehicle| vehicle.channels.contains(id)) else { return };
    let numbers: Vec<String> = details.vehicles.iter().map(|vehicle| vehicle.number.to_string()).collect();
    let others: Vec<&String> = numbers.iter().filter(|number| **number != own.number.to_string()).collect();
    let other = others.first().map_or("", |number| number.as_str());
    notes.push(VehiclesMeet { numbers: numbers.join(" and "), vehicle: own.number, other: other.to_owned() });
    let of = |value| Stated { value, from: format!("the entry of vehicle {}", own.number) };
    let words = own.description.clone();
    details.vehicle = words.map(|value| Stated { value, from: format!("the entry of vehicle {}", own.number) });
    if details.mass_kg.as_ref().map(|s| s.value) != own.mass_kg {
        // Read for another vehicle, whose damage it is, too.
        details.damage = None;
    }
    details.mass_kg = own.mass_kg.map(of);
    details.impact_speed_m_per_s = own.impact_speed_m_per_s.map(of);
}

/// The pulse's own initial velocity is the better statement of the impact speed than the vehicle's.
fn speed_of_the_pulse(recording: &mut Recording, pulse: usize, notes: &mut Notes) {
    let channel = &recording.channels[pulse].channel;
    let Some(speed) = channel.initial_velocity_m_per_s.map(f64::abs).filter(|v| *v > 0.0) else { return };
    let stated = &mut recording.details.impact_speed_m_per_s;
    if let Some(old) = stated.as_ref().filter(|old| (old.value - speed).abs() > 0.01 * speed) {
        notes.push(TwoSpeeds {
            channel: channel.id.clone(),
            speed_m_per_s: speed,
            other_from: old.from.clone(),
            other_m_per_s: old.value,
        });
    }
    *stated = Some(Stated { value: speed, from: format!("the initial velocity of channel {}", channel.id) });
}

/// Refuses channels whose times no artifact can hold.
fn times_in_range(file: &str, recording: &Recording) -> Result<()> {
    // Nanoseconds in 64 bits: 292 years.
    const LONGEST_S: f64 = 9e9;
    for read in &recording.channels {
        let Some(wave) = &read.wave else { continue };
        let (t0_s, end_s, dt_s) = (wave.t0_s(), wave.end_s(), wave.dt_s());
        if !(t0_s.abs() < LONGEST_S && end_s.abs() < LONGEST_S && (1.0 / dt_s).is_finite()) {
            return refuse(
                file,
                format!("channel {} runs from {t0_s:e} s to {end_s:e} s in steps of {dt_s:e} s", read.channel.id),
                "times within 285 years",
                "correct the times, or the unit that is stated for them",
            );
        }
    }
    Ok(())
}

fn overflow(file: &str, found: &str) -> IngestError {
    IngestError::content(file, found, "finite numbers", "correct the record, or --time-zero")
}

remarks! {
    /// Remarks of the whole record.
    pub REMARKS;

    /// No unit of time is stated, and the impact speed proves it.
    CR141 ProvenTimeUnit { reason: String, unit: &'static str, impact_speed_m_per_s: f64 }
    bears on (About::Time, Weight::None)
    decided "ms and us are tried. One of them gives a pulse that stops the vehicle from its impact speed: the change \
             of velocity is 1 to 1.3 times that speed, more below 50 km/h."
    means "Times are in this unit. The other one would change the velocity 1000 times more or less."
    remedy "nothing; --time-unit overrides"
    says format!(
        "{reason}. It is {unit}: with it the pulse stops the vehicle from {:.1} km/h. A unit 1000 times longer or \
         shorter would change the velocity 1000 times more or less. --time-unit overrides",
        3.6 * impact_speed_m_per_s
    );

    /// Mass or impact speed is missing, and nothing needs it.
    CR142 NeedsNeither { kind: Option<&'static str> }
    bears on (About::Record, Weight::None)
    decided "The pulse is an accelerometer in an occupant, or the test is one of a sled or a catapult."
    means "Criteria of occupants and the pulse are made. There is no model of a structure."
    remedy "nothing; state --mass and --impact-speed if this is a vehicle"
    says {
        let what = kind.map_or_else(|| "the criteria of an occupant need".to_owned(), |kind| format!("a {kind} needs"));
        format!("mass and impact speed are not both stated: {what} neither")
    };

    /// Two vehicles meet, and the pulse is on one of them.
    CR143 VehiclesMeet { numbers: String, vehicle: u32, other: String }
    bears on (About::Record, Weight::None)
    decided "The file lists several vehicles and the channels of each."
    means "Mass, speed and description are those of the vehicle that carries the pulse."
    remedy "nothing; --vehicle and its number take the other vehicle"
    says format!(
        "vehicles {numbers} meet: mass, speed and description are those of vehicle {vehicle}, which carries the pulse; \
         --vehicle {other} takes the other"
    );

    /// The initial velocity of the pulse is not the impact speed that the record states.
    CR144 TwoSpeeds { channel: String, speed_m_per_s: f64, other_from: String, other_m_per_s: f64 }
    bears on (About::ImpactSpeed, Weight::Marked)
    decided "Both stand in the record and differ by more than 1 %. The initial velocity of the channel is used: it \
             belongs to the pulse."
    means "Crush grows with the impact speed, energy with its square. One of both speeds is wrong."
    remedy "state the right one: --impact-speed"
    says format!(
        "initial velocity of channel {channel} is {speed_m_per_s:.4} m/s, {other_from} is {other_m_per_s:.4} m/s: the \
         first is used"
    );
}
