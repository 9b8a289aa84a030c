//! What is known of a test beside its samples: description, channels by name, parts of a dummy's body.

use crate::Spread;
use crate::iso13499::{IsoCode, wildcard};
use crate::{Channel, QuantityKind};

/// A part of the body that a criterion is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum BodyPart {
    /// Head of a dummy.
    Head,
    /// Free-motion headform, FMVSS 201.
    Headform,
    /// Chest of a dummy.
    Chest,
    /// Upper neck of a dummy.
    Neck,
}

impl BodyPart {
    /// The class of its linear acceleration, of a neck of its forces and moments: head 1000, chest 180 (SAE J211-1
    /// Table 1; FMVSS 208), neck 600 (FMVSS 208 S6.6).
    pub const fn cfc(self) -> u16 {
        match self {
            Self::Head | Self::Headform => 1000,
            Self::Chest => 180,
            Self::Neck => 600,
        }
    }
}

/// The class of a head's angular velocity (NHTSA, for BrIC).
const ROTATION_CFC: u16 = 60;

/// Words of a place near a head that is none.
const NO_HEAD: [&str; 11] =
    ["restraint", "rest", "liner", "airbag", "lamp", "light", "rail", "cylinder", "engine", "motor", "bulk"];

/// The part of the body an accelerometer sits in, by its ISO code, else by the words of its location (of its id where
/// there is no location).
pub fn part_of(channel: &Channel) -> Option<BodyPart> {
    let of_neck = |part: &BodyPart| *part == BodyPart::Neck;
    place_of(channel).filter(|part| channel.quantity == QuantityKind::Acceleration && !of_neck(part))
}

/// The part of the body of which a criterion takes the channel, and the class that it asks for: an acceleration of head
/// or chest, the head's angular velocity, force or moment of the upper neck.
pub fn criterion_of(channel: &Channel) -> Option<(BodyPart, u16)> {
    let part = place_of(channel)?;
    let class = match (channel.quantity, part) {
        (QuantityKind::Acceleration, BodyPart::Head | BodyPart::Headform | BodyPart::Chest) => part.cfc(),
        (QuantityKind::AngularVelocity, BodyPart::Head) => ROTATION_CFC,
        (QuantityKind::Force | QuantityKind::Moment, BodyPart::Neck) => part.cfc(),
        _ => return None,
    };
    Some((part, class))
}

/// The part of the body a sensor sits in, whatever it measures.
fn place_of(channel: &Channel) -> Option<BodyPart> {
    let place = if channel.location.trim().is_empty() { &channel.id } else { &channel.location };
    let place = place.to_lowercase();
    let words: Vec<&str> = place.split(|c: char| !c.is_alphanumeric()).collect();
    let has = |word: &str| words.contains(&word);
    if has("headform") || has("fmh") {
        return Some(BodyPart::Headform);
    }
    if let Some((code, _)) = channel.code.as_deref().and_then(|code| IsoCode::parse(code).ok()) {
        match code.main_location() {
            "HEAD" => return Some(BodyPart::Head),
            "CHST" => return Some(BodyPart::Chest),
            "NECK" if code.fine_locations()[0] == "UP" => return Some(BodyPart::Neck),
            _ => {}
        }
    }
    if place.starts_with("vehicle") || NO_HEAD.into_iter().any(has) {
        None
    } else if has("head") {
        Some(BodyPart::Head)
    } else if has("neck") && !has("lower") {
        Some(BodyPart::Neck)
    } else {
        (has("chest") || has("thorax")).then_some(BodyPart::Chest)
    }
}

// Selects channels by the name a person gives: an id, a code, another name, a pattern.

/// Whether a name is a pattern: it has `*` or `?` in it.
pub fn is_pattern(wanted: &str) -> bool {
    wanted.contains(['*', '?'])
}

/// The channels that a name selects, as indices: the one with this id; else those with this id or code or other name
/// in any case; else, if it is a pattern, all whose id, code or other name matches. None, one or several.
pub fn resolve_channels(channels: &[(&Channel, &[String])], wanted: &str) -> Vec<usize> {
    let wanted = wanted.trim();
    if let Some(index) = channels.iter().position(|(channel, _)| channel.id == wanted) {
        return vec![index];
    }
    let fold = wanted.to_lowercase();
    let all = |fits: &dyn Fn(&str) -> bool, by_other_names: bool| -> Vec<usize> {
        let named = |(channel, names): &(&Channel, &[String])| {
            let others = names.iter().chain(&channel.code).map(String::as_str);
            fits(&channel.id) || (by_other_names && others.into_iter().any(fits))
        };
        (0..channels.len()).filter(|k| named(&channels[*k])).collect()
    };
    let same = |name: &str| name.to_lowercase() == fold;
    for by_other_names in [false, true] {
        let matches = all(&same, by_other_names);
        if !matches.is_empty() {
            return matches;
        }
    }
    if is_pattern(wanted) { all(&|name| wildcard(wanted, name), true) } else { Vec::new() }
}

impl TestDescription {
    /// The channels that an id, a code or a pattern such as `1?VEHC*X?` selects, see [`resolve_channels`].
    pub fn resolve_channels(&self, wanted: &str) -> Vec<&Channel> {
        let named: Vec<(&Channel, &[String])> = self.channels.iter().map(|channel| (channel, [].as_slice())).collect();
        resolve_channels(&named, wanted).into_iter().map(|k| &self.channels[k]).collect()
    }
}

// What is known of a crash test beside its samples.

/// What stands in place of a barrier where the vehicle met another one.
pub const ANOTHER_VEHICLE: &str = "another vehicle";

/// Where a record came from.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Source {
    /// The file format as recognised, e.g. `csv`, `nhtsa-ev5`.
    pub format: String,
    /// The file's name without its folder.
    pub name: String,
    /// Digest of the content, `blake3:<hex>`.
    pub digest: String,
}

impl Source {
    /// Whether it is the result of a simulation, which has no sensor: no zero level, no trigger, no error of a gain.
    pub fn is_simulated(&self) -> bool {
        SIMULATED.contains(&self.format.as_str())
    }
}

/// Formats of the results of simulations.
pub const SIMULATED: [&str; 5] =
    ["ls-dyna-binout", "ls-dyna-text", "openradioss-t01", "openradioss-table", "simulation-curves"];

/// First contact: the origin of every time after ingest, which are seconds from it.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// What settled it, in words: `stated by flag`, `file`, `the format nhtsa-ev5`, `auto`, `threshold`, or those of
    /// another program.
    pub rule: String,
    /// Where it lies on the time axis of the source, s.
    pub source_time_s: f64,
    /// How uncertain it is, s; `None`: not known, and in no interval.
    pub uncertainty_s: Option<Spread>,
    /// How much earlier a soft front may have touched, s, beside that: the pulse was seen, not the contact.
    pub earlier_by_s: f64,
}

/// What was tested.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum TestKind {
    /// A vehicle, whose structure stops it or is hit.
    Vehicle,
    /// A sled: its brake or its drive makes the pulse.
    Sled,
    /// A sled that is pushed from rest and rolls on.
    Catapult,
    /// A part; it has a structure of its own where its mass is stated.
    Component,
}

impl TestKind {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Vehicle, Self::Sled, Self::Catapult, Self::Component];

    /// The name in options and records.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Vehicle => "vehicle",
            Self::Sled => "sled",
            Self::Catapult => "catapult",
            Self::Component => "component",
        }
    }
}

/// How a vehicle met what it hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Overlap {
    /// It was stopped by it.
    Full,
    /// It slid past it and kept a part of its speed, as in a small overlap.
    Glancing,
}

impl Overlap {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Full, Self::Glancing];

    /// The name in options and records.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Full => "full",
            Self::Glancing => "glancing",
        }
    }
}

/// What was tested, and what says so.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KindOfTest {
    /// What was tested.
    pub kind: TestKind,
    /// What settled it, in words: `stated by flag`, `the code of the pulse`, `proposed by the pulse`.
    pub rule: String,
}

/// A crash test: title, vehicle, masses and speeds where known, and its channels.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TestDescription {
    /// Title as the source gives it, else the file's stem.
    pub title: String,
    /// Vehicle, in words.
    pub vehicle: Option<String>,
    /// Test mass, kg.
    pub mass_kg: Option<f64>,
    /// Speed just before contact, m/s, positive.
    pub impact_speed_m_per_s: Option<f64>,
    /// Barrier, in words.
    pub barrier: Option<String>,
    /// Where the record came from.
    pub source: Source,
    /// Every channel the source lists.
    pub channels: Vec<Channel>,
    /// Id of the channel taken as the crash pulse.
    pub pulse: Option<String>,
    /// Remarks of the reader of the file.
    pub notes: Vec<String>,
    /// First contact, t = 0; `None`: nothing says that it is there.
    pub contact: Option<Contact>,
    /// Whether its reader asked for an exchange of unit, speed, time or sign that makes pulse and impact speed fit.
    pub exchange_asked: bool,
    /// What was tested; `None`: nothing says that it is anything but a vehicle.
    pub kind: Option<KindOfTest>,
    /// How it met what it hit; `None`: nobody states it.
    pub overlap: Option<Overlap>,
}

/// Why no channel can be taken as the pulse.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PulseError {
    /// The named channel is not in the test.
    #[error("the test names {0:?} as its pulse, but has no such channel")]
    Unknown(String),
    /// There is no acceleration.
    #[error("the test has no acceleration channel with data")]
    None,
    /// Its only one answers an input, for all that is known.
    #[error("the test names no pulse, and its acceleration stands beside quantities that are no motion")]
    Beside,
    /// There are several, and the test does not say which.
    #[error("the test has {0} acceleration channels and does not say which is the pulse")]
    Several(usize),
}

/// Masses of vehicles, kg: from a light quadricycle to a lorry with its load.
pub const VEHICLE_KG: std::ops::RangeInclusive<f64> = 200.0..=60_000.0;

/// Whether a vehicle may have this mass, kg: what is known of cars, such as how far they rebound, may be held against
/// it.
pub fn is_mass_of_a_vehicle(mass_kg: f64) -> bool {
    VEHICLE_KG.contains(&mass_kg)
}

impl TestDescription {
    /// What was tested, in a sentence. A component is known by what the record states or by a mass below that of any
    /// vehicle.
    pub fn noun(&self) -> &'static str {
        let is_light = self.mass_kg.is_some_and(|mass_kg| mass_kg < *VEHICLE_KG.start());
        match self.kind.as_ref().map(|kind| kind.kind) {
            Some(TestKind::Component) => "component",
            None | Some(TestKind::Vehicle) if is_light => "component",
            Some(TestKind::Sled | TestKind::Catapult) => "sled",
            None | Some(TestKind::Vehicle) => "vehicle",
        }
    }

    /// Whether a structure makes the pulse, of which there can be a model: not the brake or the drive of a sled. A
    /// component has one where its mass is known.
    pub fn has_structure(&self) -> bool {
        match self.kind.as_ref().map(|kind| kind.kind) {
            None | Some(TestKind::Vehicle) => true,
            Some(TestKind::Sled | TestKind::Catapult) => false,
            Some(TestKind::Component) => self.mass_kg.is_some(),
        }
    }

    /// The channel with this id.
    pub fn channel(&self, id: &str) -> Option<&Channel> {
        self.channels.iter().find(|c| c.id == id)
    }

    /// The channel taken as the crash pulse: the one the record names, else its only acceleration channel with data.
    pub fn pulse_channel(&self) -> Result<&Channel, PulseError> {
        if let Some(id) = &self.pulse {
            return self.channel(id).ok_or_else(|| PulseError::Unknown(id.clone()));
        }
        let mut candidates =
            self.channels.iter().filter(|c| c.quantity == QuantityKind::Acceleration && c.status.has_data());
        match (candidates.next(), candidates.count()) {
            (None, _) => Err(PulseError::None),
            // Beside a torque or a voltage an acceleration answers an input.
            (Some(_), 0) if self.channels.iter().any(|c| c.status.has_data() && !c.quantity.is_motion()) => {
                Err(PulseError::Beside)
            }
            (Some(only), 0) => Ok(only),
            (Some(_), more) => Err(PulseError::Several(more + 1)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::QuantityKind;

    fn at(location: &str, code: Option<&str>) -> Option<BodyPart> {
        let code = code.map(str::to_owned);
        let location = location.to_owned();
        part_of(&Channel { location, code, ..Channel::new("1", QuantityKind::Acceleration) })
    }

    #[test]
    fn heads_and_chests_are_known_by_code_and_by_words() {
        assert_eq!(at("somewhere", Some("11HEADCG0000ACXP")), Some(BodyPart::Head));
        assert_eq!(at("driver, head", None), Some(BodyPart::Head));
        assert_eq!(at("front passenger, chest", None), Some(BodyPart::Chest));
        assert_eq!(at("free motion headform", None), Some(BodyPart::Headform));
        assert_eq!(at("vehicle, head restraint", None), None);
        assert_eq!(at("engine, cylinder head", None), None);
        assert_eq!(at("driver, pelvis", Some("11PELV000000ACXP")), None);
        assert_eq!(part_of(&Channel::new("head_x", QuantityKind::Acceleration)), Some(BodyPart::Head));
        assert_eq!(part_of(&Channel::new("head_x", QuantityKind::AngularVelocity)), None);
        let criterion = |id: &str, quantity| criterion_of(&Channel::new(id, quantity));
        assert_eq!(criterion("head_x", QuantityKind::AngularVelocity), Some((BodyPart::Head, 60)));
        assert_eq!(criterion("neck upper Fz", QuantityKind::Force), Some((BodyPart::Neck, 600)));
        assert_eq!(criterion("lower neck Fz", QuantityKind::Force), None);
        assert_eq!(criterion("neck", QuantityKind::Acceleration), None);
    }

    #[test]
    fn an_id_beats_a_code_beats_a_pattern() {
        let channel = |id: &str, code: &str| Channel {
            code: Some(code.to_owned()),
            ..Channel::new(id, QuantityKind::Acceleration)
        };
        let channels = vec![
            channel("93", "10FORALERE00ACXP"),
            channel("94", "10FORARIRE00ACXP"),
            channel("95", "10ENGN000000ACXP"),
        ];
        let test = TestDescription { channels, ..TestDescription::default() };
        let ids = |wanted: &str| -> Vec<String> {
            test.resolve_channels(wanted).into_iter().map(|channel| channel.id.clone()).collect()
        };
        assert_eq!(ids("93"), ["93"]);
        assert_eq!(ids("10foralere00acxp"), ["93"]);
        assert_eq!(ids("1?FORA*X?"), ["93", "94"]);
        assert_eq!(ids("9?"), ["93", "94", "95"]);
        assert_eq!(ids("96"), [""; 0]);
    }
}
