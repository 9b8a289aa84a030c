//! Which channel is the crash pulse, its sign, and the impact speed that the record states.
//!
//! Whether a channel moves with the passenger compartment, as the pulse of a vehicle has to.
//!
//! An engine stops in half the time of the car, and a head moves by itself: crush, force and models of such a channel
//! are not those of the vehicle. It is taken only where a person names it or the file has nothing else, with a warning.

use crumple_metrics::{Exchange, Plausibility};
use crumple_signal::iso13499::IsoCode;
use crumple_signal::{
    Axis, Channel, ChannelStatus, Notes, QuantityKind, Sampled, SignalError, TestKind, part_of, pre_event,
};

use crate::error::Question;
use crate::recording::content::{self, Fitness, MINIMUM_SAMPLES, PulseRule, ReadChannel, Recording};
use crate::recording::details::Stated;
use crate::recording::scale::of_sensor;
use crate::recording::settings::{BodyPlace, select};
use crate::{IngestError, Result, Sign, refuse_channel};

mod remarks;

pub use remarks::REMARKS;
use remarks::{
    InputsAndOutputs, NoPulse, NoneAlongX, NotOfCompartment, PositivePulse, PulseChosen, PulseDoubted, PushedPulse,
    RedundantPulse, SignKept, SignTurned, SpeedAtContact, VelocityTaken,
};

/// Index of the pulse among the channels: the one asked for, else the fittest of those that are valid and have data.
/// What was taken, why, and what else there is goes into a note. `None` only where one may be missing; where nothing
/// speaks of a crash, that is no warning.
pub fn choose_pulse(
    file: &str,
    recording: &Recording,
    wanted: Option<&str>,
    (allow_missing, is_of_a_crash): (bool, bool),
    notes: &mut Notes,
) -> Result<Option<usize>> {
    let mut candidates: Vec<usize> =
        (0..recording.channels.len()).filter(|k| is_candidate(&recording.channels[*k])).collect();
    // Stable: equally fit channels stay in the order of the file.
    candidates.sort_by_key(|k| recording.channels[*k].fitness);
    let index = match wanted {
        Some(wanted) => requested_channel(file, recording, wanted, &candidates)?,
        None => match best_candidate(file, recording, &candidates) {
            Ok(index) if allow_missing && !is_of_a_crash && is_an_output(recording) => {
                let channel = Some(describe(&recording.channels[index].channel));
                notes.push(InputsAndOutputs { channel, reason: None });
                return Ok(None);
            }
            Ok(index) => index,
            Err(error) if allow_missing => {
                let reason = error.to_string();
                if is_of_a_crash {
                    notes.push(NoPulse { reason });
                } else {
                    notes.push(InputsAndOutputs { channel: None, reason: Some(reason) });
                }
                return Ok(None);
            }
            Err(error) => return Err(error),
        },
    };
    let pulse = &recording.channels[index];
    let samples = pulse.wave.as_ref().map_or(0, Sampled::len);
    if samples < MINIMUM_SAMPLES {
        return refuse_channel(
            file,
            format!("channel {} has {samples} samples", pulse.channel.id),
            format!("at least {MINIMUM_SAMPLES} samples"),
            "choose another channel by --channel",
        );
    }
    note_choice(recording, index, &candidates, wanted.is_some(), notes);
    Ok(Some(index))
}

/// Whether the sole acceleration of a table answers an input, instead of being an impact: it stands beside a force, a
/// torque, a voltage and the like.
fn is_an_output(recording: &Recording) -> bool {
    let with_data = recording.channels.iter().filter(|read| read.wave.is_some());
    recording.pulse_rule == PulseRule::OnlyOne
        && !with_data.map(|read| read.channel.quantity).all(QuantityKind::is_motion)
}

fn is_candidate(read: &ReadChannel) -> bool {
    read.fitness.is_some()
        && read.wave.is_some()
        && matches!(read.channel.status, ChannelStatus::Valid | ChannelStatus::Computed)
}

/// What to do with the voltage of a sensor.
fn of_voltage(id: &str) -> String {
    format!("{}, or export the acceleration in g", of_sensor(id))
}
const ANOTHER_RECORD: &str =
    "export an acceleration of the same test; inputs and outputs that are no crash need none: --allow-missing";

fn best_candidate(file: &str, recording: &Recording, candidates: &[usize]) -> Result<usize> {
    let hint = naming_one(recording);
    match (candidates, recording.pulse_rule) {
        ([], PulseRule::OnlyOne) => {
            let with_data = || recording.channels.iter().filter(|read| read.wave.is_some()).map(|read| &read.channel);
            // The unit of another quantity can be stated; that of a voltage is known, and naming it changes nothing.
            if let Some(other) = with_data().find(|channel| channel.quantity == QuantityKind::Other) {
                return Err(which(file, "no acceleration column with data".to_owned(), &other.id, 0));
            }
            let measured: Vec<String> = with_data().map(|c| format!("{} ({})", c.id, c.quantity)).collect();
            if measured.is_empty() {
                return refuse_channel(file, "no acceleration column with data", "one", hint);
            }
            let found = format!("no acceleration column with data, but {}", content::list(&measured));
            let are_voltages = with_data().all(|channel| channel.quantity == QuantityKind::Voltage);
            match with_data().next().filter(|_| are_voltages) {
                Some(first) => {
                    let expected = "an acceleration, or volts with their sensitivity";
                    refuse_channel(file, found, expected, of_voltage(&first.id))
                }
                None => refuse_channel(file, found, "one", ANOTHER_RECORD),
            }
        }
        ([], PulseRule::Fittest) => {
            let unread: Vec<&str> = recording.channels.iter().filter_map(|read| read.unread.as_deref()).collect();
            let places = "rear-seat crossmember, rear floor, sill, B-pillar or centre of gravity";
            if let [first, more @ ..] = unread.as_slice() {
                let more =
                    if more.is_empty() { String::new() } else { format!("; and {} more cannot be read", more.len()) };
                let found = "no accelerometer along x at a usual place of the compartment can be read";
                let hint = "download the test again, or name another channel by --channel";
                return refuse_channel(
                    file,
                    format!("{found}: {first}{more}"),
                    format!("a readable file of {places}"),
                    hint,
                );
            }
            let is_other = |f: &&ReadChannel| f.wave.is_some() && f.channel.quantity == QuantityKind::Acceleration;
            let others = list(recording.channels.iter().filter(is_other));
            let others = if others.is_empty() { "none" } else { &others };
            let found = "no signal file of a valid x accelerometer in the compartment is here; accelerations here";
            refuse_channel(file, format!("{found}: {others}"), places, hint)
        }
        ([first, ..], PulseRule::Fittest) => Ok(*first),
        ([only], PulseRule::OnlyOne) => Ok(*only),
        (several, PulseRule::OnlyOne) if let Some(pulse) = vehicle_channel(recording, several) => Ok(pulse),
        (several, PulseRule::OnlyOne) => {
            let names = list(several.iter().map(|k| &recording.channels[*k]));
            let found = format!("{} acceleration columns: {names}", several.len());
            Err(which(file, found, &recording.channels[several[0]].channel.id, several.len()))
        }
    }
}

/// How to name a channel, with one of the record: an acceleration along x with samples, else what comes nearest.
fn naming_one(recording: &Recording) -> String {
    let lacks = |read: &&ReadChannel| {
        let channel = &read.channel;
        (read.wave.is_none(), channel.quantity != QuantityKind::Acceleration, channel.axis != Some(Axis::X))
    };
    recording.channels.iter().min_by_key(lacks).map_or_else(
        || "give the folder or the archive that holds the files of the channels too".to_owned(),
        |read| match &read.wave {
            Some(_) => format!("name the channel, such as --channel {}", read.channel.id),
            None => format!(
                "put the files of the channels beside it; then one can be named, such as --channel {}",
                read.channel.id
            ),
        },
    )
}

/// The question where one of `count` channels has to be named; three may be those of a head.
pub fn which(file: &str, found: String, id: &str, count: usize) -> IngestError {
    let head = if count == 3 { "; x, y and z of a head or a chest take --place head or --place chest" } else { "" };
    let hint = format!("add --channel {id}, for example{head}");
    let error = IngestError::channel(file, found, "the name of the channel with the crash pulse", hint);
    error.asking(Question::Channel(id.to_owned()))
}

/// Puts the accelerations into a part of the body: of three without an axis the first is along x, then y and z.
pub fn place_on_body(channels: &mut [ReadChannel], place: BodyPlace) {
    let is_acceleration = |read: &&mut ReadChannel| read.channel.quantity == QuantityKind::Acceleration;
    let mut of_body: Vec<&mut ReadChannel> = channels.iter_mut().filter(is_acceleration).collect();
    let lack_axes = of_body.len() == 3 && of_body.iter().all(|read| read.channel.axis.is_none());
    for (read, axis) in
        of_body.iter_mut().zip([Axis::X, Axis::Y, Axis::Z].into_iter().map(Some).chain(std::iter::repeat(None)))
    {
        read.channel.location = place.word().to_owned();
        read.channel.axis = read.channel.axis.or(axis.filter(|_| lack_axes));
    }
}

/// The only accelerometer of several columns that is of no occupant's head or chest; where all are, the first of them
/// along x: criteria are made of all of them, and nothing else is here.
fn vehicle_channel(recording: &Recording, several: &[usize]) -> Option<usize> {
    let channel = |k: usize| &recording.channels[k].channel;
    let vehicle: Vec<usize> = several.iter().copied().filter(|k| part_of(channel(*k)).is_none()).collect();
    match vehicle.as_slice() {
        [only] => Some(*only),
        [] => several.iter().copied().find(|k| channel(*k).axis == Some(Axis::X)).or_else(|| several.first().copied()),
        _ => None,
    }
}

fn requested_channel(file: &str, recording: &Recording, wanted: &str, candidates: &[usize]) -> Result<usize> {
    let wanted = wanted.trim();
    let names = |indices: &[usize]| list(indices.iter().map(|k| &recording.channels[*k]));
    let index = match select(&recording.channels, wanted).as_slice() {
        [index] => *index,
        [] => {
            let expected = format!("one of its {} channels, such as {}", recording.channels.len(), names(candidates));
            let found = format!("channel {wanted} is not listed");
            return refuse_channel(file, found, expected, "--list prints the table of channels");
        }
        several => {
            let found = format!("--channel {wanted} means {} channels: {}", several.len(), names(several));
            let hint = format!("give an id, such as --channel {}", recording.channels[several[0]].channel.id);
            return refuse_channel(file, found, "one channel as the crash pulse", hint);
        }
    };
    let ReadChannel { channel, wave, unread, .. } = &recording.channels[index];
    let id = &channel.id;
    let hint = || match candidates {
        [] if channel.quantity == QuantityKind::Voltage => of_voltage(id),
        [] if wave.is_some() => ANOTHER_RECORD.to_owned(),
        [] => "choose a channel with data by --channel".to_owned(),
        _ => format!("candidates here: {}", names(candidates)),
    };
    if wave.is_none() {
        let found = match channel.status {
            ChannelStatus::NotInstalled => {
                let comment = channel.comment.as_deref().map_or_else(String::new, |c| format!(" ({c})"));
                format!("channel {id}: not installed{comment}: it has no data, and no file is missing")
            }
            _ if let Some(reason) = unread => format!("channel {id}: its file is not read: {reason}"),
            _ => match &channel.comment {
                Some(comment) if id.parse::<u32>().is_err() => format!("channel {id} has no data: {comment}"),
                _ if id.parse::<u32>().is_err() => format!("channel {id} ({}): its file is not here", channel.location),
                _ => format!(
                    "channel {id} ({}): its signal file, with the extension .{id:0>3}, is not here",
                    channel.location
                ),
            },
        };
        return refuse_channel(file, found, "a channel with data", hint());
    }
    if channel.quantity != QuantityKind::Acceleration {
        let found = format!("channel {} measures {}", describe(channel), channel.quantity);
        return refuse_channel(file, found, "an acceleration as the crash pulse", hint());
    }
    Ok(index)
}

fn describe(channel: &Channel) -> String {
    let location = channel.location.strip_prefix("vehicle, ").unwrap_or(&channel.location);
    match (location.is_empty(), channel.redundant) {
        (true, _) => channel.id.clone(),
        (false, false) => format!("{} ({location})", channel.id),
        (false, true) => format!("{} ({location}, redundant)", channel.id),
    }
}

fn list<'a>(channels: impl Iterator<Item = &'a ReadChannel>) -> String {
    content::list(&channels.map(|read| describe(&read.channel)).collect::<Vec<_>>())
}

fn note_choice(recording: &Recording, index: usize, candidates: &[usize], asked: bool, notes: &mut Notes) {
    let pulse = &recording.channels[index];
    let (place, why) = match (asked, pulse.fitness) {
        (true, _) => (None, "as asked for"),
        (false, Some(fitness)) if recording.pulse_rule == PulseRule::Fittest => (Some(fitness.why), ""),
        (false, fitness) => (None, fitness.map_or("", |fitness| fitness.why)),
    };
    let others: Vec<&ReadChannel> =
        candidates.iter().filter(|k| **k != index).map(|k| &recording.channels[*k]).collect();
    let others = (!others.is_empty()).then(|| list(others.iter().copied()));
    notes.push(PulseChosen { channel: describe(&pulse.channel), place, why, others });
    let id = || pulse.channel.id.clone();
    if !candidates.contains(&index) && pulse.channel.status != ChannelStatus::Valid {
        notes.push(PulseDoubted { id: id(), status: pulse.channel.status.to_string() });
    }
    if let Some(doubt) = doubt(pulse, recording.pulse_rule) {
        let taken = if asked { "taken as asked for" } else { "nothing else is here" };
        notes.push(NotOfCompartment { taken, ..doubt });
    }
    if !asked && pulse.channel.redundant {
        notes.push(RedundantPulse { id: id() });
    }
}

/// Words in an id, a location or a remark that speak of a place elsewhere.
const ELSEWHERE: &str = "barrier belt brake bumper caliper chest dummy engine femur gearbox head knee motor neck \
    occupant pelvis radiator spine steering thorax tibia transmission wheel wrist";

/// Why the channel may not stand for the compartment; `None` if nothing speaks against it.
fn doubt(read: &ReadChannel, rule: PulseRule) -> Option<NotOfCompartment> {
    let channel = &read.channel;
    let of = NotOfCompartment { channel: describe(channel), axis: None, word: None, code_says: None, taken: "" };
    if let Some(axis) = channel.axis.filter(|axis| *axis != Axis::X) {
        return Some(NotOfCompartment { axis: Some(axis.to_string()), ..of });
    }
    if let Some(word) = word_for_another_place(channel) {
        return Some(NotOfCompartment { word: Some(word), ..of });
    }
    if let Some((code, _)) = channel.code.as_deref().and_then(|code| IsoCode::parse(code).ok()) {
        let vehicle = code.object().to_digit(10).unwrap_or(1);
        if fitness(&code, vehicle).is_none() {
            return Some(NotOfCompartment { code_says: Some(code.location()), ..of });
        }
    }
    (rule == PulseRule::Fittest && read.fitness.is_none()).then_some(of)
}

fn word_for_another_place(channel: &Channel) -> Option<&'static str> {
    let text = format!("{} {}", channel.id, channel.location).to_lowercase();
    text.split(|c: char| !c.is_alphabetic()).find_map(|word| ELSEWHERE.split(' ').find(|other| *other == word))
}

/// The rank of an accelerometer along x on vehicle `vehicle` (or on the sled), at a place that moves with the passenger
/// compartment; `None` elsewhere, the engine, bumper, subframe and side members first of all. Of two channels of one
/// place the one that is less filtered ranks first.
pub fn fitness(code: &IsoCode, vehicle: u32) -> Option<Fitness> {
    let is_of_vehicle = code.object() == 'S' || code.object() == '?' || code.object().to_digit(10) == Some(vehicle);
    if !is_of_vehicle || code.dimension() != "AC" || code.axis() != Some(Axis::X) {
        return None;
    }
    let fine = code.fine_locations();
    let rear = fine.contains(&"RE");
    let (place, why) = match code.main_location() {
        "SECM" | "CRME" | "SEAT" | "FORA" => (0, "rear-seat crossmember or rear floor"),
        // NHTSA names a sill by its door.
        "SILB" | "SILL" | "DOOR" if rear => (1, "rear sill"),
        "SILB" | "SILL" => (2, "sill"),
        "BPIL" => (3, "B-pillar"),
        "VEHC" => (4, "vehicle centre of gravity"),
        "TUNN" => (5, "tunnel"),
        "SLED" => (6, "sled"),
        _ => return None,
    };
    let filtered = u8::from(code.filter_class().cfc().is_some_and(|class| class < 1000));
    Some(Fitness { redundant: code.redundant(), place: 2 * place + filtered, why })
}

/// How long after time zero the pulse is looked at, s.
const WINDOW_S: f64 = 0.150;
/// Change of velocity that counts where the impact speed is not known, m/s.
const CLEAR_CHANGE_M_PER_S: f64 = 0.25;
/// The same as a part of the impact speed.
const CLEAR_PART: f64 = 0.05;

/// Gain of speed over impact speed that only a pulse of the wrong sign shows: a frontal impact loses 1.0 to 1.35 times
/// the impact speed, and a record may end early.
const CERTAIN: std::ops::RangeInclusive<f64> = 0.6..=1.6;

/// Gain of speed over impact speed above which no sign makes an impact of it: a perfect rebound loses twice the impact
/// speed, and a tenth is left to gain and impact speed. A larger gain suggests a wrong unit.
const IMPOSSIBLE: f64 = 2.2;

/// Turns the accelerations along x where that is asked for, or certainly wrong, and says so; whether it did.
pub fn turn_sign(
    recording: &mut Recording,
    pulse: Option<usize>,
    sign: Sign,
    notes: &mut Notes,
) -> Result<bool, SignalError> {
    let gain = match sign {
        Sign::Keep => return Ok(false),
        Sign::Flip => None,
        Sign::Auto => {
            let speed = recording.details.impact_speed_m_per_s.as_ref().map(|stated| stated.value);
            let gain = gain(pulse.and_then(|k| recording.channels[k].wave.as_ref()), speed);
            if !gain.is_some_and(|(_, ratio)| CERTAIN.contains(&ratio)) {
                let (over_s, ratio) = gain.unzip();
                notes.push(SignKept { over_s, ratio });
                return Ok(false);
            }
            gain
        }
    };
    let ((over_s, ratio), channels) = (gain.unzip(), flip(&mut recording.channels)?);
    notes.push(SignTurned { over_s, ratio, channels });
    Ok(true)
}

/// How long the pulse is looked at, s, and the change of the speed in it over the impact speed; `None` where one of
/// both is not known.
fn gain(pulse: Option<&Sampled>, impact_speed_m_per_s: Option<f64>) -> Option<(f64, f64)> {
    let (pulse, speed) = pulse.zip(impact_speed_m_per_s.filter(|speed| *speed > 0.0))?;
    let zero = pre_event(pulse).map_or(0.0, |before| before.zero_level);
    Some((pulse.end_s().min(WINDOW_S), change(pulse, zero) / speed))
}

/// Change of velocity over the first 150 ms, m/s.
fn change(pulse: &Sampled, zero: f64) -> f64 {
    let (from, to) = (pulse.index_at_or_after(0.0), pulse.index_at_or_after(WINDOW_S));
    pulse.samples()[from..to.max(from)].iter().map(|a| (a - zero) * pulse.dt_s()).sum()
}

/// Whether the pulse pushes the vehicle forward over the first 150 ms, as a sled does or a hit from behind.
pub fn pushes_forward(pulse: &Sampled, zero_level: Option<f64>) -> bool {
    change(pulse, zero_level.unwrap_or(0.0)) > CLEAR_CHANGE_M_PER_S
}

/// What was done about the sign of the pulse before it is checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Polarity {
    /// It is as in the file.
    AsRead,
    /// It is as in the file, of a sled: it is pushed by right.
    OfSled,
    /// It is as in the file, of the structure of a vehicle by its code: a frontal test, unless its speed is 0.
    OfVehicle,
    /// It was turned.
    Turned,
    /// It is as in the file, and asked about: it fits the impact speed with the other sign.
    Questioned,
    /// The pulse is that of an occupant; its criteria are of magnitudes, so that the sign does not matter.
    OfOccupant,
}

impl Polarity {
    /// That of a pulse that was turned or not, of an occupant or not, of this kind of test; of its ISO 13499 code the
    /// test object, 1 to 9 for a vehicle.
    pub fn of(is_of_occupant: bool, is_turned: bool, kind: Option<TestKind>, code: Option<&str>) -> Self {
        match (is_of_occupant, is_turned, kind, code.and_then(|code| code.chars().next())) {
            (true, ..) => Self::OfOccupant,
            (false, true, ..) => Self::Turned,
            (false, false, Some(TestKind::Sled | TestKind::Catapult), _) => Self::OfSled,
            (false, false, _, Some('1'..='9')) => Self::OfVehicle,
            (false, false, ..) => Self::AsRead,
        }
    }

    /// The same, or [`Questioned`](Self::Questioned) where the other sign is asked about.
    pub fn unless_asked(self, plausibility: Option<&Plausibility>) -> Self {
        match plausibility {
            Some(Plausibility::After(Exchange::Polarity, _)) => Self::Questioned,
            _ => self,
        }
    }
}

/// Warns if the pulse, zero level removed, gains speed over the first 150 ms, with what helps: turning it only where it
/// was not turned and where what it then loses is that of an impact.
pub fn check(
    pulse: &Sampled,
    zero_level: Option<f64>,
    impact_speed_m_per_s: Option<f64>,
    polarity: Polarity,
    notes: &mut Notes,
) {
    let change = change(pulse, zero_level.unwrap_or(0.0));
    let clear = impact_speed_m_per_s.map_or(CLEAR_CHANGE_M_PER_S, |v| CLEAR_PART * v);
    // A vehicle that stands is pushed either way.
    let is_silent = matches!(polarity, Polarity::OfOccupant | Polarity::Questioned | Polarity::OfSled);
    if change <= clear || is_silent || impact_speed_m_per_s == Some(0.0) {
        return;
    }
    let ratio = impact_speed_m_per_s.filter(|v| *v > 0.0).map(|v| change / v);
    let (change_m_per_s, over_s) = (change, pulse.end_s().min(WINDOW_S));
    let sign = (polarity == Polarity::Turned).then_some("turned");
    // What is pushed from rest, or from behind by less than a sign turned would gain, is a motion like any other.
    let is_pushed = match ratio {
        None => polarity == Polarity::AsRead,
        Some(ratio) => ratio < *CERTAIN.start(),
    };
    if is_pushed {
        notes.push(PushedPulse { change_m_per_s, over_s, ratio, sign });
    } else {
        notes.push(PositivePulse { change_m_per_s, over_s, ratio, sign });
    }
}

/// Turns the sign of every acceleration along x, or along an axis that is not stated, and of its initial velocity.
/// Returns how many channels that are.
fn flip(channels: &mut [ReadChannel]) -> Result<usize, SignalError> {
    let mut flipped = 0;
    for ReadChannel { channel, wave, .. } in channels {
        if channel.quantity != QuantityKind::Acceleration || !matches!(channel.axis, None | Some(Axis::X)) {
            continue;
        }
        if let Some(sampled) = wave.take() {
            let (t0_s, dt_s) = (sampled.t0_s(), sampled.dt_s());
            let samples = sampled.into_samples().into_iter().map(|a| -a).collect();
            *wave = Some(Sampled::new(t0_s, dt_s, samples)?);
            channel.initial_velocity_m_per_s = channel.initial_velocity_m_per_s.map(|v| -v);
            flipped += 1;
        }
    }
    Ok(flipped)
}

/// A velocity at contact of at least this part of the largest one is the impact speed; a smaller one is that of a
/// record of changes of velocity, or of a motion from rest.
const IMPACT_PART: f64 = 0.5;

/// Index of the velocity, or change of it, that stands for the pulse of a record without an acceleration: the one asked
/// for, else the first along x, else the first whose axis is not stated, else none. A note names the others.
pub fn choose(file: &str, recording: &Recording, wanted: Option<&str>, notes: &mut Notes) -> Result<Option<usize>> {
    let has = |quantity| recording.channels.iter().any(|read| read.channel.quantity == quantity && read.wave.is_some());
    // Speeds before the crash stand beside the changes of velocity of a recorder.
    let (quantity, what) = if has(QuantityKind::VelocityChange) {
        (QuantityKind::VelocityChange, "change of velocity")
    } else {
        (QuantityKind::Velocity, "velocity")
    };
    let is_change = |k: &usize| {
        let ReadChannel { channel, wave, .. } = &recording.channels[*k];
        channel.quantity == quantity && wave.is_some()
    };
    let changes: Vec<usize> = (0..recording.channels.len()).filter(is_change).collect();
    let name = |k: usize| {
        let channel = &recording.channels[k].channel;
        channel.comment.as_ref().map_or_else(|| channel.id.clone(), |title| format!("{} ({title})", channel.id))
    };
    let names = |indices: &[usize]| indices.iter().map(|k| name(*k)).collect::<Vec<_>>().join(", ");
    let taken = match wanted {
        Some(wanted) => match select(&recording.channels, wanted).as_slice() {
            [k] if is_change(k) => *k,
            selected => {
                let found = match selected {
                    [] => format!("channel {wanted} is not listed"),
                    [k] => format!("channel {} is no {what}", name(*k)),
                    several => format!("--channel {wanted} means {} channels: {}", several.len(), names(several)),
                };
                let hint = "--list shows the channels of all tables";
                return refuse_channel(file, found, format!("one of {}", names(&changes)), hint);
            }
        },
        None => {
            let along = |axis| changes.iter().find(|k| recording.channels[**k].channel.axis == axis).copied();
            let is_only = changes.len() == 1 && quantity == QuantityKind::VelocityChange;
            let only = || changes.first().copied().filter(|_| is_only);
            let Some(taken) = along(Some(Axis::X)).or_else(|| along(None)).or_else(only) else {
                notes.push(NoneAlongX { what, channels: names(&changes) });
                return Ok(None);
            };
            taken
        }
    };
    let others: Vec<usize> = changes.into_iter().filter(|k| *k != taken).collect();
    let others = (!others.is_empty()).then(|| names(&others));
    notes.push(VelocityTaken { what, channel: name(taken), others });
    Ok(Some(taken))
}

/// The velocity at time zero as the impact speed, where nothing else states one.
pub fn speed_at_contact(recording: &mut Recording, index: usize, notes: &mut Notes) {
    let ReadChannel { channel, wave: Some(wave), .. } = &recording.channels[index] else { return };
    if channel.quantity != QuantityKind::Velocity || recording.details.impact_speed_m_per_s.is_some() {
        return;
    }
    let samples = wave.samples();
    let largest = samples.iter().fold(0.0_f64, |largest, v| largest.max(v.abs()));
    let Some(at_contact) = samples.get(wave.index_at_or_after(0.0)).map(|v| v.abs()) else { return };
    if at_contact >= IMPACT_PART * largest && at_contact > 0.0 {
        notes.push(SpeedAtContact { speed_m_per_s: at_contact, channel: channel.id.clone() });
        let from = format!("the velocity {} at time zero", channel.id);
        recording.details.impact_speed_m_per_s = Some(Stated { value: at_contact, from });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_signal::{Note, QuantityKind};

    fn channel(id: &str, code: Option<&str>, axis: Option<Axis>) -> ReadChannel {
        let mut channel = Channel::new(id, QuantityKind::Acceleration);
        channel.code = code.map(str::to_owned);
        channel.axis = axis;
        ReadChannel::new(channel)
    }

    #[test]
    fn what_speaks_against_a_channel_is_said() {
        let text = |doubt: Option<NotOfCompartment>| doubt.map(|doubt| Note::from(doubt).text);
        let doubt_of = |id, code, axis| text(doubt(&channel(id, code, axis), PulseRule::OnlyOne));
        assert_eq!(doubt_of("accel_g", None, None), None);
        assert_eq!(doubt_of("Header_g", None, Some(Axis::X)), None);
        assert_eq!(doubt_of("a", Some("10FORALERE00ACXP"), Some(Axis::X)), None);
        assert_eq!(doubt_of("a", Some("20VEHCCG0000ACXP"), Some(Axis::X)), None);
        assert!(doubt_of("accel_z", None, Some(Axis::Z)).unwrap().contains(": it measures along z, not along x; "));
        assert!(doubt_of("Head_x_g", None, Some(Axis::X)).unwrap().contains(": it sits elsewhere (head); "));
        assert!(doubt_of("a", Some("10ENGN000000ACXP"), Some(Axis::X)).unwrap().contains("engine"));
        assert!(text(doubt(&channel("a", None, None), PulseRule::Fittest)).unwrap().contains("rear floor"));
    }

    #[test]
    fn the_compartment_ranks_and_the_engine_does_not() {
        let places = |codes: &str| -> Vec<Option<u8>> {
            codes.split(' ').map(|code| fitness(&IsoCode::parse(code).unwrap().0, 1).map(|f| f.place)).collect()
        };
        let ranked = "10FORALERE00AC1P 10SEATLERE00ACXD 10DOORLERE00AC1P 10VEHCCG0000AC1P 10VEHC0000__ACXD";
        assert_eq!(places(ranked), [Some(0), Some(1), Some(2), Some(8), Some(9)]);
        let other = "10DOORLEFR00AC1P 10ENGN000000AC1P 20FORALERE00AC1P 10FORALERE00ACYP 11HEADCG00H3ACXA";
        assert_eq!(places(other), [None; 5]);
    }
}
