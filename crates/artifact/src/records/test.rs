//! Record of the test: its source, its channels, its contact.

use crumple_signal::{
    Axis, Channel, Contact, Distribution, KindOfTest, Overlap, QuantityKind, Source, Spread, TestDescription, TestKind,
};
use serde::{Deserialize, Serialize};

use crate::ConversionError;

/// The test a record belongs to. Topic `/test`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct TestV1 {
    /// Title of the test.
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
    pub source: SourceV1,
    /// Every channel the source lists.
    pub channels: Vec<ChannelV1>,
    /// Id of the channel taken as the crash pulse; `null`: the only acceleration channel.
    pub pulse: Option<String>,
    /// Remarks of the reader of the file.
    #[serde(default)]
    pub notes: Vec<String>,
    /// What says that t = 0 is first contact, in words; `null`: nothing. Of earlier versions; `contact` says more.
    #[serde(default)]
    pub time_zero: Option<String>,
    /// Whether ingest asked for an exchange of unit, speed, time or sign that makes pulse and impact speed fit.
    #[serde(default)]
    pub exchange_asked: bool,
    /// First contact, t = 0; `null`: nothing says that it is there.
    #[serde(default)]
    pub contact: Option<ContactV1>,
    /// What was tested; `null`: nothing says that it is anything but a vehicle.
    #[serde(default)]
    pub kind: Option<KindV1>,
    /// How the vehicle met what it hit: `full`, or `glancing`, where it slid past and kept a part of its speed; `null`:
    /// nobody states it.
    #[serde(default)]
    pub overlap: Option<String>,
}

/// What was tested, and what says so.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct KindV1 {
    /// `vehicle`, `sled`, `catapult` or `component`. A sled, a catapult and a component without mass have no structure:
    /// there is no model of them.
    pub name: String,
    /// What settled it, in words: `stated by flag`, `the code of the pulse`, `proposed by the pulse`.
    pub rule: String,
}

/// First contact: every time after ingest is in seconds from it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct ContactV1 {
    /// What settled it, in words: `stated by flag`, `file`, `the format nhtsa-ev5`, `auto`, `threshold`, `edr`,
    /// `contact:<channel>`, `the start of impact 2`.
    pub rule: String,
    /// Where it lies on the time axis of the source, s.
    pub source_time_s: f64,
    /// Standard deviation or half width of its error, s; `null`: not known.
    #[serde(default)]
    pub uncertainty_s: Option<f64>,
    /// `normal` or `uniform`, where there is an uncertainty.
    #[serde(default)]
    pub distribution: Option<String>,
    /// How much earlier a soft front may have touched, s, beside that: the pulse was seen, not the contact.
    #[serde(default)]
    pub earlier_by_s: f64,
}

/// Origin of a record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct SourceV1 {
    /// File format as recognised.
    pub format: String,
    /// File name without folder.
    pub name: String,
    /// `blake3:<hex>` of the content.
    pub digest: String,
}

/// One channel of a test.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct ChannelV1 {
    /// Unique name; the waveform's topic is `/wave/<id>`.
    pub id: String,
    /// Sensor location in words; empty if unknown.
    pub location: String,
    /// `x`, `y`, `z`, `resultant` or `null`.
    pub axis: Option<String>,
    /// `acceleration`, `velocity`, `velocity_change`, `displacement`, `force`, ...
    pub quantity: String,
    /// SI unit of the samples.
    pub unit: String,
    /// Channel frequency class of the samples: 60, 180, 600, 1000 or `null`.
    pub cfc: Option<u16>,
    /// `valid`, `computed`, `questionable`, `failed`, `not installed` or `absent`.
    pub status: String,
    /// Velocity along the sensor axis at time zero, m/s, signed.
    pub initial_velocity_m_per_s: Option<f64>,
    /// Whether another sensor at the same place is the primary one.
    #[serde(default)]
    pub redundant: bool,
    /// The laboratory's remark.
    pub comment: Option<String>,
    /// Channel code of ISO/TS 13499.
    #[serde(default)]
    pub code: Option<String>,
    /// Transducer: type and serial number.
    #[serde(default)]
    pub sensor: Option<String>,
    /// Filter state in words.
    #[serde(default)]
    pub filter_state: Option<String>,
    /// What the source says of the sign, where it departs from SAE J211 or leaves it open.
    #[serde(default)]
    pub polarity: Option<String>,
}

impl From<&TestDescription> for TestV1 {
    fn from(test: &TestDescription) -> Self {
        Self {
            title: test.title.clone(),
            vehicle: test.vehicle.clone(),
            mass_kg: test.mass_kg,
            impact_speed_m_per_s: test.impact_speed_m_per_s,
            barrier: test.barrier.clone(),
            source: SourceV1 {
                format: test.source.format.clone(),
                name: test.source.name.clone(),
                digest: test.source.digest.clone(),
            },
            channels: test.channels.iter().map(ChannelV1::from).collect(),
            pulse: test.pulse.clone(),
            notes: test.notes.clone(),
            time_zero: test.contact.as_ref().map(|contact| contact.rule.clone()),
            contact: test.contact.as_ref().map(ContactV1::from),
            exchange_asked: test.exchange_asked,
            kind: test.kind.as_ref().map(|of| KindV1 { name: of.kind.name().to_owned(), rule: of.rule.clone() }),
            overlap: test.overlap.map(|overlap| overlap.name().to_owned()),
        }
    }
}

impl From<&Channel> for ChannelV1 {
    fn from(channel: &Channel) -> Self {
        Self {
            id: channel.id.clone(),
            location: channel.location.clone(),
            axis: channel.axis.map(|axis| axis.to_string()),
            quantity: channel.quantity.name().to_owned(),
            unit: channel.quantity.si_unit().to_owned(),
            cfc: channel.cfc,
            status: channel.status.name().to_owned(),
            initial_velocity_m_per_s: channel.initial_velocity_m_per_s,
            redundant: channel.redundant,
            comment: channel.comment.clone(),
            code: channel.code.clone(),
            sensor: channel.sensor.clone(),
            filter_state: channel.filter_state.clone(),
            polarity: channel.polarity.clone(),
        }
    }
}

impl TryFrom<TestV1> for TestDescription {
    type Error = ConversionError;

    fn try_from(test: TestV1) -> Result<Self, ConversionError> {
        let mut ids = std::collections::BTreeSet::new();
        if let Some(twice) = test.channels.iter().find(|channel| !ids.insert(channel.id.as_str())) {
            return Err(ConversionError(format!("channel {:?} is listed twice", twice.id)));
        }
        if let Some(pulse) = test.pulse.as_deref().filter(|pulse| !ids.contains(pulse)) {
            return Err(ConversionError(format!("the pulse is channel {pulse:?}, which is not listed")));
        }
        let of_earlier = |rule| Contact { rule, source_time_s: 0.0, uncertainty_s: None, earlier_by_s: 0.0 };
        let contact = test.contact.map(Contact::try_from).transpose()?.or_else(|| test.time_zero.map(of_earlier));
        Ok(Self {
            title: test.title,
            vehicle: test.vehicle,
            mass_kg: test.mass_kg,
            impact_speed_m_per_s: test.impact_speed_m_per_s,
            barrier: test.barrier,
            source: Source { format: test.source.format, name: test.source.name, digest: test.source.digest },
            channels: test.channels.into_iter().map(Channel::try_from).collect::<Result<_, _>>()?,
            pulse: test.pulse,
            notes: test.notes,
            contact,
            exchange_asked: test.exchange_asked,
            kind: test.kind.map(KindOfTest::try_from).transpose()?,
            overlap: test.overlap.map(overlap).transpose()?,
        })
    }
}

fn overlap(name: String) -> Result<Overlap, ConversionError> {
    let of = Overlap::ALL.into_iter().find(|of| of.name() == name);
    of.ok_or_else(|| ConversionError(format!("{name:?} is no overlap, expected full or glancing")))
}

impl TryFrom<KindV1> for KindOfTest {
    type Error = ConversionError;

    fn try_from(kind: KindV1) -> Result<Self, ConversionError> {
        let unknown = || ConversionError(format!("{:?} is no kind of test", kind.name));
        let of = TestKind::ALL.into_iter().find(|of| of.name() == kind.name).ok_or_else(unknown)?;
        Ok(Self { kind: of, rule: kind.rule })
    }
}

impl From<&Contact> for ContactV1 {
    fn from(contact: &Contact) -> Self {
        Self {
            rule: contact.rule.clone(),
            source_time_s: contact.source_time_s,
            uncertainty_s: contact.uncertainty_s.map(|spread| spread.size),
            distribution: contact.uncertainty_s.map(|spread| spread.distribution.name().to_owned()),
            earlier_by_s: contact.earlier_by_s,
        }
    }
}

impl TryFrom<ContactV1> for Contact {
    type Error = ConversionError;

    fn try_from(contact: ContactV1) -> Result<Self, ConversionError> {
        let error = |what: String| ConversionError(format!("contact: {what}"));
        let distribution = match contact.distribution.as_deref() {
            None | Some("normal") => Distribution::Normal,
            Some("uniform") => Distribution::Uniform,
            Some(other) => return Err(error(format!("distribution {other:?}, expected normal or uniform"))),
        };
        let sizes = [contact.uncertainty_s.unwrap_or(0.0), contact.earlier_by_s];
        if let Some(size) = sizes.into_iter().find(|size| *size < 0.0) {
            return Err(error(format!("an uncertainty is {size} s, expected at least 0")));
        }
        let uncertainty_s = contact.uncertainty_s.map(|size| Spread { size, distribution });
        Ok(Self {
            rule: contact.rule,
            source_time_s: contact.source_time_s,
            uncertainty_s,
            earlier_by_s: contact.earlier_by_s,
        })
    }
}

impl TryFrom<ChannelV1> for Channel {
    type Error = ConversionError;

    fn try_from(channel: ChannelV1) -> Result<Self, ConversionError> {
        let error = |what| ConversionError(format!("channel {:?}: {what}", channel.id));
        let quantity: QuantityKind = channel.quantity.parse().map_err(error)?;
        if quantity.si_unit() != channel.unit && quantity != QuantityKind::Other {
            return Err(error(format!(
                "unit is {:?}, but {quantity} is stored in {:?}",
                channel.unit,
                quantity.si_unit()
            )));
        }
        Ok(Self {
            axis: channel.axis.as_deref().map(str::parse::<Axis>).transpose().map_err(error)?,
            status: channel.status.parse().map_err(error)?,
            quantity,
            id: channel.id,
            location: channel.location,
            cfc: channel.cfc,
            redundant: channel.redundant,
            initial_velocity_m_per_s: channel.initial_velocity_m_per_s,
            comment: channel.comment,
            code: channel.code,
            sensor: channel.sensor,
            filter_state: channel.filter_state,
            polarity: channel.polarity,
        })
    }
}
