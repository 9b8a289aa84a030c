//! Records of ingest, filter and integrate: vehicles and damage, waveforms, filters, quality, events, metrics.

use crumple_signal::HALF_OF_90_PERCENT;
use serde::{Deserialize, Serialize};

// Record: how a channel was filtered.

/// How a channel was filtered. Topic `/filter/<channel id>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct ChannelFilterV1 {
    /// Channel frequency class applied; `null`: passed through.
    pub cfc: Option<u16>,
    /// `iso6487`, `sae_reflect`, `sae_zero_state`, `butterworth-low`, `butterworth-high`, `butterworth-band`,
    /// `moving-average` or `none`.
    pub mode: String,
    /// Ratio of the design frequency to the class, e.g. 2.0775.
    pub frequency_factor: Option<f64>,
    /// Samples added at each end before filtering.
    pub samples_added: u64,
    /// Coefficients a0, a1, a2, b1, b2 of `y[i] = a0 x[i] + a1 x[i-1] + a2 x[i-2] + b1 y[i-1] + b2 y[i-2]`; five for
    /// each section of a Butterworth filter, sections in the order they are run.
    pub coefficients: Vec<f64>,
    /// Gain of both passes at the class frequency, dB.
    pub gain_at_class_db: Option<f64>,
    /// Zero level subtracted before filtering, SI unit of the channel.
    pub zero_level_removed: f64,
    /// What a reader should know.
    pub notes: Vec<String>,
    /// Response of the filter that was run beside the limits of its class; empty without a class.
    #[serde(default)]
    pub corridor: Vec<CorridorPointV1>,
    /// Whether the response keeps all limits of the class; `null` without a class.
    pub corridor_ok: Option<bool>,
    /// Cut-off frequencies of a Butterworth filter, Hz: one, or two for a band.
    #[serde(default)]
    pub cutoff_hz: Vec<f64>,
    /// `zero` (forward and backward, no phase) or `causal`; `null`: nothing was filtered.
    pub phase: Option<String>,
    /// Width of a moving average, s.
    pub width_s: Option<f64>,
    /// Sampling rate the channel was brought to after filtering, Hz; `null`: its own.
    pub resampled_to_hz: Option<f64>,
    /// Shift of the time axis that aligns the channel with another, s; negative: the channel was late.
    pub shift_s: Option<f64>,
}

/// The gain of a filter at one frequency, and what its class allows there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct CorridorPointV1 {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Gain of the filter as run, dB.
    pub gain_db: f64,
    /// Upper limit, dB.
    pub upper_db: f64,
    /// Lower limit, dB; `null`: none.
    pub lower_db: Option<f64>,
}

// Record: what was measured on the vehicle after the test.

/// Residual crush of the vehicle, as the file of the test states it. Topic `/damage`; not there where it states none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct DamageV1 {
    /// Residual crush at stations of equal spacing over the width of the damage, left to right, m; negative: the
    /// structure bulges out.
    pub residual_crush_m: Vec<f64>,
    /// Width of the damage, m; `null`: not stated.
    pub damage_width_m: Option<f64>,
    /// Width of the vehicle, m.
    pub vehicle_width_m: Option<f64>,
    /// Collision deformation classification (SAE J224), e.g. `12FDEW2`.
    pub classification: Option<String>,
    /// The fields of the file that these are from.
    pub from: String,
}

/// Place of the deformed area in a collision deformation classification (SAE J224), and its letter for the front.
const AREA: (usize, char) = (2, 'F');

impl DamageV1 {
    /// Whether its classification is of another side than the front.
    pub fn is_of_another_side(&self) -> bool {
        let area = self.classification.as_deref().and_then(|code| code.chars().nth(AREA.0));
        area.is_some_and(|area| area != AREA.1)
    }

    /// Width of the damage, m, else that of the vehicle; and which it is.
    pub fn width(&self) -> Option<(f64, &'static str)> {
        let of_damage = self.damage_width_m.map(|width| (width, "of the damage"));
        of_damage.or_else(|| self.vehicle_width_m.map(|width| (width, "of the vehicle")))
    }

    /// The crush, m; a station that bulges out has none.
    pub fn crush_m(&self) -> Vec<f64> {
        self.residual_crush_m.iter().map(|crush| crush.max(0.0)).collect()
    }
}

// Record: the events of a crash on one channel.

/// What an interval of an event or a metric is made from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum IntervalSourceV1 {
    /// 5 % and 95 % quantile of repetitions with perturbed inputs.
    Replicates,
    /// Lowest and highest of channels that measured the same.
    Channels,
    /// Half of the step in which a recorder keeps a value, or of its sampling interval.
    Resolution,
}

impl IntervalSourceV1 {
    /// Share of the values between the ends, percent; a range and a resolution have none.
    pub fn level_percent(self) -> Option<u8> {
        matches!(self, Self::Replicates).then_some(90)
    }

    /// Reads the words that are all that earlier records have.
    fn of_words(words: &str) -> Option<Self> {
        match words.split(' ').next()? {
            "5-95" => Some(Self::Replicates),
            "range" => Some(Self::Channels),
            "resolution" => Some(Self::Resolution),
            _ => None,
        }
    }
}

/// Interval of an event, from the stated uncertainty of the measurement.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct EventIntervalV1 {
    /// Field of [`EventsV1`] it belongs to, e.g. `dynamic_crush_m`.
    pub name: String,
    /// Lower end, unit of the field.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// How it was found, in words, e.g. `5-95 % of 400 replicates`.
    pub interval_by: String,
    /// What it is made from.
    #[serde(default)]
    pub interval_source: Option<IntervalSourceV1>,
}

impl EventIntervalV1 {
    /// What it is made from.
    pub fn source(&self) -> Option<IntervalSourceV1> {
        self.interval_source.or_else(|| IntervalSourceV1::of_words(&self.interval_by))
    }
}

/// Why an event has no interval.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct MissingIntervalV1 {
    /// Field of [`EventsV1`], e.g. `dynamic_crush_m`.
    pub name: String,
    /// The reason in words.
    pub reason: String,
}

/// The events of a crash on one channel; times count from time zero. Topic `/events`.
///
/// `null` means that the record does not show the event; a note says why.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct EventsV1 {
    /// Channel the events were read from.
    pub channel: String,
    /// 0: times are seconds from contact. Nobody reads it; artifacts of versions that moved it are refused.
    pub time_zero_s: f64,
    /// What settled contact: the rule of `/test`, `file` where that says nothing.
    pub time_zero_rule: String,
    /// Dynamic crush C: displacement at the first zero of velocity, m.
    pub dynamic_crush_m: Option<f64>,
    /// Time of dynamic crush t_m, s.
    pub time_of_dynamic_crush_s: Option<f64>,
    /// Centroid time t_c of the loading pulse, s.
    pub centroid_time_s: Option<f64>,
    /// Lowest velocity after t_m, m/s, negative when the vehicle rebounds.
    pub rebound_velocity_m_per_s: Option<f64>,
    /// Coefficient of restitution e = -rebound velocity / impact speed.
    pub coefficient_of_restitution: Option<f64>,
    /// Whether the record ends during the rebound: its lowest velocity is the last sample, so that restitution and
    /// delta-v are lower bounds.
    #[serde(default)]
    pub still_separating: bool,
    /// Change of velocity, impact speed minus rebound velocity, m/s; of a velocity that never reaches zero impact speed
    /// minus the lowest velocity up to `end_of_event_s`.
    pub delta_v_m_per_s: Option<f64>,
    /// Time of the rebound velocity, s.
    pub time_of_rebound_s: Option<f64>,
    /// Impact speed the integration started from, m/s.
    pub impact_speed_m_per_s: Option<f64>,
    /// Integration rule: `trapezoid` or `forward-euler`.
    pub rule: Option<String>,
    /// Where the integration started: `time-zero` or `record-start`.
    pub start: Option<String>,
    /// Intervals of the events, where the uncertainty of the measurement was stated.
    #[serde(default)]
    pub intervals: Vec<EventIntervalV1>,
    /// Time of the lowest velocity of an event whose velocity never reaches zero, s; elsewhere it is
    /// `time_of_rebound_s`.
    #[serde(default)]
    pub time_of_delta_v_s: Option<f64>,
    /// End of an event whose velocity never reaches zero, s; `null` where it does, or where nothing happens.
    #[serde(default)]
    pub end_of_event_s: Option<f64>,
    /// What ends it: `20 ms with no more than 0.8 km/h (49 CFR 563)` or `end of the record`.
    #[serde(default)]
    pub end_of_event_rule: Option<String>,
    /// Events that have no interval although the uncertainty of the measurement was stated, and why.
    #[serde(default)]
    pub without_interval: Vec<MissingIntervalV1>,
    /// Every impact of the pulse, in the order of time. The other fields are those of one of them, with what touched
    /// the vehicle before it.
    #[serde(default)]
    pub impacts: Vec<ImpactV1>,
}

/// One impact of a pulse; times count from time zero.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct ImpactV1 {
    /// Start of its force, s: contact for the first.
    pub start_s: f64,
    /// End of its force, s.
    pub end_s: f64,
    /// Velocity at its start, m/s; `null`: the impact speed is not known.
    pub start_velocity_m_per_s: Option<f64>,
    /// Most velocity that the vehicle loses from start to end, m/s; negative: it is pushed forward.
    pub delta_v_m_per_s: f64,
    /// Acceleration of the strongest 4.4 ms, m/s^2; negative: a deceleration. `null`: a table is too coarse.
    pub peak_acceleration_m_per_s2: Option<f64>,
    /// Time of the peak, s.
    pub time_of_peak_s: Option<f64>,
    /// The record ends before the force does: `delta_v_m_per_s` is a lower bound.
    pub is_lower_bound: bool,
}

/// The impacts of a pulse or of a recorder's table where there are no events. Topic `/impacts`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct ImpactsV1 {
    /// Channel they were read from.
    pub channel: String,
    /// In the order of time.
    pub impacts: Vec<ImpactV1>,
}

impl EventsV1 {
    /// End of the contact with the barrier, s after time zero: the lowest velocity, where the vehicle separates, else
    /// the end of a record that ends at `end_s`.
    pub fn end_of_contact_s(&self, end_s: f64) -> f64 {
        self.time_of_rebound_s.or(self.time_of_delta_v_s).map_or(end_s, |t| t.min(end_s))
    }

    /// Standard deviation of the dynamic crush by the inputs of its test, m: of a normal distribution as wide as its
    /// 5-95 % interval.
    pub fn crush_deviation_m(&self) -> Option<f64> {
        let interval = self.intervals.iter().find(|interval| interval.name == "dynamic_crush_m")?;
        Some((interval.high - interval.low) / (2.0 * HALF_OF_90_PERCENT))
    }
}

// Record: crash metrics.

/// Crash metrics. Topic `/metrics`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct MetricsV2 {
    /// The metrics, in the order of channels.
    pub metrics: Vec<MetricV1>,
}

/// Crash metrics as they were written before: a JSON array.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(transparent)]
pub struct MetricsV1(pub Vec<MetricV1>);

impl From<MetricsV1> for MetricsV2 {
    fn from(earlier: MetricsV1) -> Self {
        Self { metrics: earlier.0 }
    }
}

/// One number about a channel.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct MetricV1 {
    /// Name, e.g. `peak_acceleration`.
    pub name: String,
    /// Value; `null` where the record does not show it.
    pub value: Option<f64>,
    /// SI unit.
    pub unit: String,
    /// Channel it was computed from; of several their ids joined by `+`.
    pub channel: String,
    /// Definition, or the reason for a missing value.
    pub definition: String,
    /// Key of the definition in the catalogue of `docs/metrics.md`, e.g. `olc-tb027`.
    pub definition_id: Option<String>,
    /// Start of the part of the record the value belongs to, s from time zero; `null` where it belongs to none.
    pub from_s: Option<f64>,
    /// Its end, s from time zero; the start again for a moment.
    pub to_s: Option<f64>,
    /// Lower end of the interval of the value, from stated or measured uncertainty.
    pub low: Option<f64>,
    /// Its upper end.
    pub high: Option<f64>,
    /// How the interval was found, in words, e.g. `5-95 % of 400 replicates` or `range over 4 channels`; without one
    /// why there is none, where one was to be expected.
    pub interval_by: Option<String>,
    /// What the interval is made from.
    #[serde(default)]
    pub interval_source: Option<IntervalSourceV1>,
    /// The channels it was computed from, where they are several.
    #[serde(default)]
    pub channels: Vec<String>,
    /// Whether the value is a lower bound: the record ends too early.
    #[serde(default)]
    pub is_lower_bound: bool,
}

impl MetricV1 {
    /// What its interval is made from; `None` where it has none.
    pub fn source(&self) -> Option<IntervalSourceV1> {
        self.interval_source.or_else(|| IntervalSourceV1::of_words(self.interval_by.as_deref()?))
    }

    /// The channels it was computed from. Earlier records have their joined ids alone.
    pub fn channels(&self) -> Vec<&str> {
        match &self.channels[..] {
            [] => self.channel.split('+').collect(),
            several => several.iter().map(String::as_str).collect(),
        }
    }

    /// Whether it was computed from several channels.
    pub fn is_of_several(&self) -> bool {
        self.channels().len() > 1
    }
}

// Record: what ingest measured on a channel.

/// What ingest measured on a channel before any processing. Topic `/quality/<channel id>`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct QualityV1 {
    /// Mean before the event, SI unit of the channel; `null` without enough pre-event data.
    pub zero_level: Option<f64>,
    /// Standard deviation before the event.
    pub noise_floor: Option<f64>,
    /// Pre-event window: start, s.
    pub pre_event_from_s: Option<f64>,
    /// Pre-event window: end, s.
    pub pre_event_to_s: Option<f64>,
    /// Sampling rate, Hz.
    pub sample_rate_hz: f64,
    /// Largest deviation of a time stamp from the uniform grid, in sampling intervals.
    pub time_jitter: f64,
    /// Smallest sample.
    pub minimum: f64,
    /// Largest sample.
    pub maximum: f64,
    /// Longest run of equal samples at an extreme that a jump leaves (3 or more: clipped).
    pub clipped_run: u64,
    /// Longest run of equal samples that a jump leaves, while the signal is active after contact (5 or more over
    /// 0.5 ms: a dropout, perhaps).
    #[serde(default)]
    pub constant_run: Option<u64>,
    /// Start of that run, s.
    #[serde(default)]
    pub constant_run_from_s: Option<f64>,
    /// Mean over the last 20 ms, zero level removed, SI unit of the channel.
    #[serde(default)]
    pub end_level: Option<f64>,
    /// Level at rest of an acceleration in free fall before the event, 1 g off `zero_level`, m/s²; `null`: no free fall
    /// shows.
    #[serde(default)]
    pub rest_level: Option<f64>,
}

impl QualityV1 {
    /// Equal samples in a row at an extreme from which on a channel may be clipped.
    pub const CLIPPED_RUN: u64 = 3;

    /// Shortest run of equal samples that may be a dropout, and its duration, s.
    const DROPOUT: (u64, f64) = (5, 0.000_5);

    /// First and last instant of samples that may be lost, s: a run of 5 equal ones or more, over 0.5 ms.
    pub fn lost_s(&self) -> Option<[f64; 2]> {
        let (run, from_s) = self.constant_run.zip(self.constant_run_from_s)?;
        let lasts_s = run.saturating_sub(1) as f64 / self.sample_rate_hz;
        (run >= Self::DROPOUT.0 && lasts_s >= Self::DROPOUT.1).then_some([from_s, from_s + lasts_s])
    }

    /// Whether the channel may be clipped.
    pub fn may_be_clipped(&self) -> bool {
        self.clipped_run >= Self::CLIPPED_RUN
    }
}

// Record: the vehicles of a test with several.

/// The vehicles of a test in which two meet. Topic `/vehicles`; not there where the file states one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct VehiclesV1 {
    /// In the order of the file. The one with the pulse of `/test` has the mass and the speed stated there.
    pub vehicles: Vec<VehicleV1>,
    /// Speed at which they approach each other, m/s, as the file states it.
    pub closing_speed_m_per_s: Option<f64>,
}

/// One vehicle of several.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct VehicleV1 {
    /// Number by which the file names it.
    pub number: u32,
    /// In words.
    pub description: Option<String>,
    /// Test mass, kg.
    pub mass_kg: Option<f64>,
    /// Speed just before contact, m/s; 0: it stands.
    pub impact_speed_m_per_s: Option<f64>,
    /// The channel that serves best as its pulse, where one does.
    pub pulse: Option<String>,
    /// Ids of all channels on it and in it.
    pub channels: Vec<String>,
}

// Record: a block of a waveform.

/// A block of samples of one waveform. Topic `/wave/<channel id>`.
///
/// Sample i of the block is sample `first + i` of the waveform and was taken at
/// `t0_ns / 1e9 + (first + i) * dt_s` seconds; `t0_ns` and `dt_s` are equal in all blocks of a waveform.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct WaveBlockV1 {
    /// Time of sample 0 of the waveform, ns from the record's time origin.
    pub t0_ns: i64,
    /// Sampling interval, s.
    pub dt_s: f64,
    /// Index of the block's first sample.
    pub first: u64,
    /// Samples in the SI unit of the channel.
    pub samples: Vec<f64>,
}
