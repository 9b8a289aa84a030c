//! What a person may state about a record: the same names as flags, pipeline keys and sidecar keys.

use crumple_signal::iso13499::IsoCode;
use crumple_signal::value::{Frequency, Mass, Speed, Time};
use crumple_signal::{About, Channel, Notes, Overlap, TestKind, Uncertain, Weight, remarks, resolve_channels};
use serde::{Deserialize, Serialize};

use crate::recording::content::ReadChannel;
use crate::recording::scale::Scales;
use crate::recording::stated_contact::{ContactRule, TimeZero};
use crate::recording::unit_system::{DrivingAxis, UnitSystem};

pub use crumple_signal::is_pattern;

/// What to do with the polarity of acceleration channels.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Sign {
    /// As in the file.
    #[default]
    Keep,
    /// Multiplied by -1.
    Flip,
    /// Multiplied by -1 where the pulse is certain to be of the wrong sign, as in the file otherwise.
    Auto,
}

/// A kind of table with rules of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Profile {
    /// Event data recorder: columns of velocity are the change of velocity since the start of the event.
    Edr,
}

/// Where on an occupant the accelerometers sit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum BodyPlace {
    /// In the head: HIC.
    Head,
    /// In the chest.
    Chest,
}

impl BodyPlace {
    /// As a location says it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Head => "head",
            Self::Chest => "chest",
        }
    }
}

/// Facts about the record and choices of its reader. What is given here beats the sidecar file, which beats the
/// record itself.
#[derive(Debug, Clone, Default, PartialEq, clap::Args, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct IngestSettings {
    /// Test mass of the vehicle, with its unit: 873kg, 1.2t, 2000lb.
    #[arg(long, value_name = "MASS")]
    pub mass: Option<Mass>,
    /// Speed just before contact, with its unit: 35km/h, 13.4m/s, 30mph.
    #[arg(long, value_name = "SPEED")]
    pub impact_speed: Option<Speed>,
    /// What was tested: vehicle, sled, catapult (a sled that is pushed from rest and rolls on) or component. A sled, a
    /// catapult and a component without mass have no structure, so no model is made. Default: as code and pulse propose
    /// it, else vehicle.
    #[arg(long, value_enum, value_name = "KIND", hide_possible_values = true)]
    pub kind: Option<TestKind>,
    /// How the vehicle met what it hit: full, or glancing, where it slid past and kept a part of its speed, as in a
    /// small overlap. A speed that is left is then no doubt about the impact speed.
    #[arg(long, value_enum, value_name = "OVERLAP", hide_possible_values = true)]
    pub overlap: Option<Overlap>,
    /// Channel to take as the crash pulse: a column name or number of a table, a curve number of an NHTSA test, a
    /// channel code, or a pattern that means one channel: '1?VEHC*X?', 'FLLR*'. With --list: the channels to print.
    /// Default: the only acceleration column; for an NHTSA test the rear-seat crossmember or the next best place along
    /// x.
    #[arg(long, value_name = "CHANNEL")]
    pub channel: Option<String>,
    /// Unit of acceleration columns that state none: g, m/s^2, mg, kilo-g, ft/s^2, mm/s^2, mm/ms^2.
    #[arg(long, value_name = "UNIT")]
    pub unit: Option<String>,
    /// Sensitivity of channels in volts or counts: CHANNEL=50mV/g, ax=16384/g, several by commas; the reading at zero
    /// behind @: ch2=50mV/g@2.5V.
    #[arg(long, value_name = "CHANNEL=SENSITIVITY")]
    pub scale: Option<Scales>,
    /// Force of the wall (barrier): a channel, or a pattern that means its load cells. Default: forces whose names say
    /// wall, barrier or load cell.
    #[arg(long, value_name = "CHANNEL")]
    pub wall: Option<String>,
    /// Unit of the time column, or of the steps of TDMS, TDM and LVM channels: s, ms, us, ns, min, h, d. Default: from
    /// the header; else s for steps below 0.02, with a note; else the unit in which the pulse fits the impact speed.
    #[arg(long, value_name = "UNIT")]
    pub time_unit: Option<String>,
    /// First contact on the file's own time axis, with its unit: 0s, 12ms, -5ms; auto: where the pulse begins. The axis
    /// is shifted so that this is t = 0. Default: as the file or its format states it, else auto.
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub time_zero: Option<TimeZero>,
    /// How first contact is found: auto, file (t = 0 of the file), threshold (0.5 g for 3 ms), edr (49 CFR 563: 0.8
    /// km/h in 20 ms) or contact:CHANNEL, the edge of a contact switch. Default: auto.
    #[arg(long, value_name = "RULE", conflicts_with = "time_zero")]
    pub time_zero_rule: Option<ContactRule>,
    /// Uncertainty of first contact, "0.5 ms uniform" (half width) or "0.3 ms" (standard deviation); what auto and the
    /// rules leave uncertain comes to it. Default: none stated.
    #[arg(long, value_name = "TIME [normal|uniform]")]
    pub time_zero_uncertainty: Option<Uncertain<Time>>,
    /// Impact that the run is about, of a pulse with several: 1 for the first. Contact is then its start, and the
    /// impact speed what the vehicle has left there. Default: the first; where that leaves speed and a later one stops
    /// the vehicle, that one.
    #[arg(long, value_name = "NUMBER")]
    pub impact: Option<u32>,
    /// Polarity of acceleration along x: keep; flip where the file has deceleration positive; auto flips only where the
    /// pulse gains 0.6 to 1.6 times the impact speed in 150 ms, with a note. Default: keep.
    #[arg(long, value_enum, value_name = "SIGN")]
    pub sign: Option<Sign>,
    /// Sampling interval of a table without a time column, or of TDMS, TDM and LVM channels without a time, with its
    /// unit: 0.08s, 100us. The first row is at 0 s.
    #[arg(long, value_name = "TIME")]
    pub sample_time: Option<Time>,
    /// Kind of table: edr for the tables of event data recorders (CDR reports), whose velocity columns are changes of
    /// velocity.
    #[arg(long, value_enum, value_name = "PROFILE")]
    pub profile: Option<Profile>,
    /// Words of the line above the table that is meant, in a text with several: "Longitudinal Crash Pulse".
    #[arg(long, value_name = "TEXT")]
    pub skip_to: Option<String>,
    /// Sheet of a workbook (.xlsx) that holds the record. Default: the only one with rows of numbers.
    #[arg(long, value_name = "NAME")]
    pub sheet: Option<String>,
    /// Where the accelerometers sit, if they are those of an occupant and their names do not say so: head, chest. Three
    /// without an axis are x, y and z.
    #[arg(long, value_enum, value_name = "PLACE")]
    pub place: Option<BodyPlace>,
    /// Number to take from the JSON or protobuf messages of an MCAP file, by its path; several by commas; a topic and a
    /// colon may stand in front: imu.acceleration.x. Its unit is that of --unit.
    #[arg(long, value_name = "PATH")]
    pub field: Option<String>,
    /// Rate to which messages, or rows of a table with uneven times, are resampled by linear interpolation, with its
    /// unit: 10kHz. Default: uneven times are refused.
    #[arg(long, value_name = "RATE")]
    pub resample: Option<Frequency>,
    /// Node of a simulation that stands for the car, by its id or words of its title. Default: the only one.
    #[arg(long, value_name = "ID|TITLE")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub node: Option<String>,
    /// Line of driving of a simulation: x, y or z. Default: that of the largest speed at the start.
    #[arg(long, value_enum, value_name = "AXIS", hide_possible_values = true)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axis: Option<DrivingAxis>,
    /// System of units of a simulation: mm-ms-kg, mm-s-t, m-s-kg or mm-ms-g. Default: that of the file, else asked.
    #[arg(long, value_enum, value_name = "SYSTEM", hide_possible_values = true)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub units: Option<UnitSystem>,
    /// Vehicle whose structure carries the pulse in an NHTSA test with two: 1 or 2. Default: 1.
    #[arg(long, value_name = "NUMBER")]
    pub vehicle_number: Option<u32>,
    /// Vehicle, in words; 1 or 2: its number, as --vehicle-number.
    #[arg(long, value_name = "TEXT")]
    pub vehicle: Option<String>,
    /// Title of the test. Default: the file's, else the file name.
    #[arg(long, value_name = "TEXT")]
    pub title: Option<String>,
    /// Barrier, in words.
    #[arg(long, value_name = "TEXT")]
    pub barrier: Option<String>,
    /// Go on without a crash pulse: inputs and outputs of any quantity, enough to filter and to identify a linear
    /// model. Default: false.
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true", value_name = "BOOL")]
    pub allow_missing: Option<bool>,
    /// Only the table of channels is wanted: nothing is asked back. Not an option of its own.
    #[arg(skip)]
    #[serde(skip)]
    pub listing: bool,
    /// Unit of times that state none, to be tried. Not an option of its own: a unit that is stated counts.
    #[arg(skip)]
    #[serde(skip)]
    pub tried_time_unit: Option<&'static str>,
}

/// What is said of each field once: its key, and that the settings above beat those below.
macro_rules! layers {
    ($($field:ident)*) => {
        /// The names a sidecar may use.
        pub const KEYS: &[&str] = &[$(stringify!($field)),*];

        /// These settings where they say something, else those below.
        pub fn over(&self, below: &Self) -> Self {
            let (above, below) = (self.clone(), below.clone());
            let (listing, tried_time_unit) = (above.listing, above.tried_time_unit);
            Self { $($field: above.$field.or(below.$field),)* listing, tried_time_unit }
        }
    };
}

impl IngestSettings {
    layers! {
        mass impact_speed kind overlap channel unit scale wall time_unit
        time_zero time_zero_rule time_zero_uncertainty impact sign sample_time
        profile skip_to sheet place field resample node axis units
        vehicle_number vehicle title barrier allow_missing
    }

    /// The vehicle whose record is read: the one asked for, else that of the channel asked for, as `of_channel` finds
    /// it by its name, else 1.
    pub fn vehicle_of(&self, of_channel: impl Fn(&str) -> Option<u32>) -> u32 {
        self.vehicle_number.or_else(|| of_channel(self.channel.as_deref()?.trim())).unwrap_or(1)
    }

    /// The same where channels are named by their codes, whose first character is the test object.
    pub fn vehicle_of_code(&self) -> u32 {
        self.vehicle_of(|channel| IsoCode::parse(channel).ok()?.0.object().to_digit(10))
    }

    /// The same, a bare number in place of the vehicle's description taken for its number: `--vehicle 2`.
    #[must_use]
    pub fn with_number_of_vehicle(&self) -> Self {
        let number = self.vehicle.as_deref().and_then(|text| text.trim().parse().ok()).filter(|n| (1..=9).contains(n));
        match number {
            Some(_) => Self { vehicle: None, vehicle_number: self.vehicle_number.or(number), ..self.clone() },
            None => self.clone(),
        }
    }
}

/// Warns of every flag about the form of a file that is given and not among the `relevant` ones. `why` says what
/// settles the matter instead. Facts about the test (mass, speed, time zero ...) and the choice of the pulse count for
/// every format.
pub fn warn_except(settings: &IngestSettings, relevant: &[&str], why: &str, notes: &mut Notes) {
    let flags = [
        ("--unit", settings.unit.is_some()),
        ("--time-unit", settings.time_unit.is_some()),
        ("--sample-time", settings.sample_time.is_some()),
        ("--profile", settings.profile.is_some()),
        ("--skip-to", settings.skip_to.is_some()),
        ("--sheet", settings.sheet.is_some()),
        ("--field", settings.field.is_some()),
        ("--resample", settings.resample.is_some()),
        ("--vehicle-number", settings.vehicle_number.is_some()),
        ("--node", settings.node.is_some()),
        ("--axis", settings.axis.is_some()),
        ("--units", settings.units.is_some()),
    ];
    for (flag, _) in flags.into_iter().filter(|(flag, is_given)| *is_given && !relevant.contains(flag)) {
        warn(flag, why, notes);
    }
}

/// Warns of a flag that this record does not need.
pub fn warn(flag: &str, why: &str, notes: &mut Notes) {
    notes.push(NoEffect { flag: flag.to_owned(), reason: why.to_owned() });
}

/// The channels meant, as indices, see [`resolve_channels`].
pub fn select(channels: &[ReadChannel], wanted: &str) -> Vec<usize> {
    let named: Vec<(&Channel, &[String])> = channels.iter().map(|f| (&f.channel, f.aliases.as_slice())).collect();
    resolve_channels(&named, wanted)
}

remarks! {
    /// Remarks of flags.
    pub REMARKS;

    /// A flag is given that this record does not need.
    CR113 NoEffect { flag: String, reason: String }
    bears on (About::Record, Weight::Slight)
    decided "Each format names the flags that it uses; what settles the matter instead stands in the sentence."
    means "The result is the same without the flag. If you meant to change something, it has not changed."
    remedy "leave the flag out, or check whether the record is the one that you meant"
    says format!("{flag} has no effect: {reason}");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_signal::QuantityKind;

    fn named(id: &str, aliases: &[&str]) -> ReadChannel {
        let aliases = aliases.iter().map(|a| (*a).to_owned()).collect();
        ReadChannel { aliases, ..ReadChannel::new(Channel::new(id, QuantityKind::Acceleration)) }
    }

    #[test]
    fn an_id_beats_a_name_beats_a_pattern() {
        let channels = [named("93", &["FLLR", "FLLR XG"]), named("99", &["FLLR", "93"]), named("FLRR", &["94"])];
        assert_eq!(select(&channels, "93"), [0]);
        assert_eq!(select(&channels, "fllr"), [0, 1]);
        assert_eq!(select(&channels, "FL*"), [0, 1, 2]);
        assert_eq!(select(&channels, "*xg"), [0]);
        assert_eq!(select(&channels, "nothing"), [0_usize; 0]);
        assert_eq!(select(&channels, "9?"), [0, 1, 2]);
    }
}
