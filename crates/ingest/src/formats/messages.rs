//! Channels from stamped messages: `sensor_msgs/Imu` of ROS 1 and ROS 2, and numbers named in JSON and protobuf
//! messages.
//!
//! A logger's messages come at uneven times. The stamp in the message is taken; the time of recording where stamps are
//! missing or stand still (0, frozen, doubled). Times that do not form a uniform grid are refused, unless resampling
//! is asked for (`--resample`, linear interpolation).

use std::collections::BTreeMap;

use crumple_signal::{About, Axis, Channel, Notes, QuantityKind, Sampled, Weight, remarks};

use crate::formats::remarks::{Resampled, TimesFromFirst};
use crate::recording::content::{Fitness, PulseRule, ReadChannel, Recording, list_of};
use crate::recording::details::Details;
use crate::time::OnGrid;
use crate::{IngestError, IngestSettings, Place, Result, time};

/// What a message of one topic gives: its stamp, and the values of its components.
#[derive(Debug, Clone, PartialEq)]
pub struct StampedSample {
    pub stamp_ns: i64,
    /// When the message was recorded, ns since the epoch.
    pub recorded_ns: i64,
    /// Values of the first components of the track; the others are not measured.
    pub values: Vec<f64>,
}

/// A measured quantity of a topic: name for the id, what it is, its axis, factor to SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Component {
    /// `acceleration_x`, or the path of a JSON field.
    pub name: String,
    pub quantity: QuantityKind,
    pub axis: Option<Axis>,
    /// Factor to SI.
    pub factor: f64,
}

#[derive(Debug, Clone, Default, PartialEq)]
pub struct Track {
    pub components: Vec<Component>,
    pub samples: Vec<StampedSample>,
}

/// A topic as listed in a refusal.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Topic {
    pub kind: String,
    pub encoding: String,
    pub count: u64,
}

pub fn imu_components() -> Vec<Component> {
    let axes = [("x", Axis::X), ("y", Axis::Y), ("z", Axis::Z)];
    let components_along_axes = |what: &str, quantity| {
        axes.map(|(letter, axis)| Component {
            name: format!("{what}_{letter}"),
            quantity,
            axis: Some(axis),
            factor: 1.0,
        })
    };
    [
        components_along_axes("acceleration", QuantityKind::Acceleration),
        components_along_axes("angular_velocity", QuantityKind::AngularVelocity),
    ]
    .concat()
}

/// Whether a type name is that of an IMU message: `sensor_msgs/Imu`, `sensor_msgs/msg/Imu`,
/// `sensor_msgs::msg::dds_::Imu_`.
pub fn is_imu(kind: &str) -> bool {
    let parts: Vec<&str> = kind.split(['/', ':', '.']).filter(|p| !p.is_empty()).collect();
    parts.first() == Some(&"sensor_msgs") && matches!(parts.last(), Some(&("Imu" | "Imu_")))
}

/// Little-endian numbers of a serialized message.
struct Bytes<'a> {
    data: &'a [u8],
    at: usize,
    /// Numbers of eight bytes are aligned to eight (CDR), or packed (ROS 1).
    aligned: bool,
}

impl Bytes<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        if self.aligned {
            self.at = self.at.next_multiple_of(N);
        }
        let bytes = self.data.get(self.at..self.at.checked_add(N)?)?.try_into().ok()?;
        self.at += N;
        Some(bytes)
    }

    fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    fn text(&mut self) -> Option<()> {
        let length = self.u32()? as usize;
        self.at = self.at.checked_add(length)?;
        (self.at <= self.data.len()).then_some(())
    }

    fn numbers<const N: usize>(&mut self) -> Option<[f64; N]> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = f64::from_le_bytes(self.take()?);
        }
        Some(numbers)
    }
}

/// Decodes `sensor_msgs/Imu` in CDR (`cdr`) or as ROS 1 writes it. Linear acceleration in m/s^2 with gravity, angular
/// velocity in rad/s; a field whose first covariance is -1 is absent: without acceleration there is no sample, without
/// angular velocity it has three values.
pub fn imu(data: &[u8], cdr: bool, recorded_ns: i64) -> Option<StampedSample> {
    let data = if cdr {
        // Encapsulation: 0x0001 is CDR little-endian.
        data.strip_prefix(&[0, 1]).and_then(|rest| rest.get(2..))?
    } else {
        data
    };
    let mut bytes = Bytes { data, at: 0, aligned: cdr };
    if !cdr {
        bytes.u32()?; // header.seq
    }
    let (seconds, nanoseconds) = (bytes.u32()?, bytes.u32()?);
    bytes.text()?;
    bytes.numbers::<4>()?; // orientation
    bytes.numbers::<9>()?;
    let angular = bytes.numbers::<3>()?;
    let angular_covariance = bytes.numbers::<9>()?;
    let linear = bytes.numbers::<3>()?;
    let linear_covariance = bytes.numbers::<9>()?;
    if linear_covariance[0] == -1.0 {
        return None;
    }
    let angular = if angular_covariance[0] == -1.0 { Vec::new() } else { angular.to_vec() };
    Some(StampedSample {
        stamp_ns: i64::from(seconds) * 1_000_000_000 + i64::from(nanoseconds),
        recorded_ns,
        values: [linear.to_vec(), angular].concat(),
    })
}

/// The number at a path such as `imu.acceleration.x` or `samples.0`.
pub fn json_number(message: &serde_json::Value, path: &str) -> Option<f64> {
    let mut at = message;
    for part in path.split('.') {
        at = match at {
            serde_json::Value::Array(items) => items.get(part.parse::<usize>().ok()?)?,
            other => other.get(part)?,
        };
    }
    at.as_f64()
}

/// `timestamp` (Foxglove's types), `header.stamp` or `stamp` with `sec` and `nsec` or `nanosec`, in ns.
pub fn json_stamp_ns(message: &serde_json::Value) -> Option<i64> {
    let of_header = || message.get("header").and_then(|h| h.get("stamp"));
    let stamp =
        message.get("timestamp").filter(|s| s.is_object()).or_else(of_header).or_else(|| message.get("stamp"))?;
    let part = |names: &[&str]| names.iter().find_map(|name| stamp.get(name)?.as_i64());
    part(&["sec", "secs"])?.checked_mul(1_000_000_000)?.checked_add(part(&["nsec", "nanosec", "nsecs"])?)
}

/// `no topic with acceleration`: what topics there are instead.
pub fn refuse(file: &str, topics: &BTreeMap<String, Topic>, found: &str, hint: &str) -> IngestError {
    let words = |(name, topic): (&String, &Topic)| {
        let kind = if topic.kind.is_empty() { "no type" } else { &topic.kind };
        format!("{name} ({kind}, {}, {} messages)", topic.encoding, topic.count)
    };
    let list = list_of(&topics.iter().map(words).collect::<Vec<_>>(), 30);
    let list = if list.is_empty() { "none" } else { &list };
    IngestError::content(
        file,
        format!("{found}; its topics: {list}"),
        "a topic of sensor_msgs/Imu, or a field of JSON or protobuf messages named by --field",
        hint,
    )
}

/// Channels of all tracks, t = 0 at the earliest stamp.
pub fn recording(
    file: &str,
    tracks: &mut BTreeMap<String, Track>,
    settings: &IngestSettings,
    mut notes: Notes,
) -> Result<Recording> {
    let stands_still = |track: &Track| {
        let repeats = track.samples.windows(2).any(|pair| pair[1].stamp_ns == pair[0].stamp_ns);
        repeats && track.samples.windows(2).all(|pair| pair[1].recorded_ns > pair[0].recorded_ns)
    };
    let topics: Vec<String> =
        tracks.iter().filter(|(_, track)| stands_still(track)).map(|(name, _)| name.clone()).collect();
    if !topics.is_empty() {
        notes.push(StampsStandStill { topics });
        // All topics by one clock.
        let samples = tracks.values_mut().flat_map(|track| &mut track.samples);
        samples.for_each(|sample| sample.stamp_ns = sample.recorded_ns);
    }
    let tracks = &*tracks;
    let start_ns = tracks.values().filter_map(|t| t.samples.first()).map(|s| s.stamp_ns).min().unwrap_or(0);
    let (s, ns) = (start_ns.div_euclid(1_000_000_000), start_ns.rem_euclid(1_000_000_000));
    // More digits than a number holds.
    let first_s = Some(format!("{s}.{ns:09}"));
    notes.push(TimesFromFirst { column: None, since_start_s: None, first_s });
    let mut channels = Vec::new();
    for (topic, track) in tracks {
        channels.extend(track_channels(file, topic, track, start_ns, settings, &mut notes)?);
    }
    if channels.iter().any(|f| f.channel.quantity == QuantityKind::Acceleration) {
        notes.push(AxesOfSensor {});
    }
    Ok(Recording {
        details: Details::default(),
        channels,
        pulse_rule: PulseRule::OnlyOne,
        contact_at_zero: false,
        notes,
    })
}

/// The channels of one topic: one for each component that every message has.
fn track_channels(
    file: &str,
    topic: &str,
    track: &Track,
    start_ns: i64,
    settings: &IngestSettings,
    notes: &mut Notes,
) -> Result<Vec<ReadChannel>> {
    let place = |index: usize| Place::file(&format!("{file}, topic {topic}, message {}", index + 1));
    let message_error = |index: usize, found: &str, hint: &str| {
        IngestError::content(place(index), found, "stamps at equal steps", hint)
    };
    let times: Vec<f64> = track.samples.iter().map(|s| s.stamp_ns.wrapping_sub(start_ns) as f64 / 1e9).collect();
    if times.len() < 2 {
        let found = format!("{} messages with data", times.len());
        return Err(message_error(0, &found, "give a longer recording"));
    }
    if let Some(k) = times.windows(2).position(|pair| pair[1] <= pair[0]) {
        let (found, hint) = if times[k + 1] == times[k] {
            ("it has the same time stamp as the message before", "remove the duplicate message")
        } else {
            let hint = "sort the messages by their stamps, or split the recording there if another one begins";
            ("its stamp is earlier than the one before", hint)
        };
        return Err(message_error(k + 1, found, hint));
    }
    let OnGrid { grid, interpolation, words, lacks_a_rate } = time::on_grid(&times, 1e-9, settings, place)?;
    let jitter = grid.jitter;
    let comment =
        lacks_a_rate.then(|| format!("uneven stamps, up to {jitter:.2} steps off a uniform grid: needs --resample"));
    if interpolation.is_some() && !lacks_a_rate {
        notes.push(Resampled { topic: Some(topic.to_owned()), times: None, count: Some(times.len()), words });
    }
    let stem: String = topic.trim_matches('/').chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect();
    // What one message lacks is no channel.
    let measured = track.samples.iter().map(|s| s.values.len()).min().unwrap_or(0);
    track
        .components
        .iter()
        .take(measured)
        .enumerate()
        .map(|(c, component)| {
            let read = |k: usize| track.samples[k].values[c] * component.factor;
            let samples: Vec<f64> = match &interpolation {
                None => (0..track.samples.len()).map(read).collect(),
                Some(interpolation) => interpolation.apply(track.samples.len(), read),
            };
            let wave = Sampled::new(grid.t0_s, grid.dt_s, samples).map_err(|error| {
                message_error(0, &format!("{}: {error}", component.name), "cut the recording before it")
            })?;
            let name: String =
                component.name.chars().map(|c| if c.is_alphanumeric() || c == '_' { c } else { '_' }).collect();
            let mut channel = Channel::new(format!("{stem}-{name}"), component.quantity);
            channel.location = format!("sensor of topic {topic}");
            channel.axis = component.axis;
            channel.comment = comment.clone();
            let fitness = Fitness::of_only(component.quantity, "the only acceleration");
            let aliases = vec![component.name.clone(), format!("{topic}:{}", component.name)];
            Ok(ReadChannel { wave: Some(wave), jitter: grid.jitter, fitness, aliases, ..ReadChannel::new(channel) })
        })
        .collect()
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// An IMU message as ROS 2 writes it.
    pub fn cdr_imu(stamp_ns: i64, frame: &str, linear: [f64; 3]) -> Vec<u8> {
        let head = [stamp_ns / 1_000_000_000, stamp_ns % 1_000_000_000, 1 + i64::try_from(frame.len()).unwrap()];
        let mut body: Vec<u8> = head.iter().flat_map(|x| (*x as u32).to_le_bytes()).collect();
        body.extend(format!("{frame}\0").as_bytes());
        body.resize(body.len().next_multiple_of(8), 0);
        let numbers = [vec![0.0; 13], vec![0.1, 0.2, 0.3], vec![0.0; 9], linear.to_vec(), vec![0.0; 9]].concat();
        body.extend(numbers.iter().flat_map(|x: &f64| x.to_le_bytes()));
        [vec![0, 1, 0, 0], body].concat()
    }

    #[test]
    fn imu_messages_are_decoded_whatever_the_length_of_the_frame() {
        for frame in ["", "imu", "imu_link", "a_long_frame_name"] {
            let sample = imu(&cdr_imu(12_345_678_901, frame, [1.0, -2.0, 9.8]), true, 0).unwrap();
            assert_eq!(sample.stamp_ns, 12_345_678_901);
            assert_eq!(sample.values, [1.0, -2.0, 9.8, 0.1, 0.2, 0.3]);
        }
        assert_eq!(imu(&cdr_imu(0, "imu", [0.0; 3])[..200], true, 0), None);
        assert_eq!(imu(&[], true, 0), None);
        assert_eq!(imu(&[0xFF; 400], false, 0), None);
    }

    #[test]
    fn type_names_of_both_generations() {
        for kind in ["sensor_msgs/Imu", "sensor_msgs/msg/Imu", "sensor_msgs::msg::dds_::Imu_"] {
            assert!(is_imu(kind), "{kind}");
        }
        assert!(!is_imu("sensor_msgs/LaserScan") && !is_imu("Imu") && !is_imu(""));
    }

    #[test]
    fn paths_and_stamps_of_json() {
        let message: serde_json::Value = serde_json::from_str(
            r#"{"header":{"stamp":{"sec":3,"nanosec":5}},"imu":{"acceleration":{"x":-1.5},"all":[1,2]},"t":"x"}"#,
        )
        .unwrap();
        assert_eq!(json_number(&message, "imu.acceleration.x"), Some(-1.5));
        assert_eq!(json_number(&message, "imu.all.1"), Some(2.0));
        assert_eq!((json_number(&message, "imu.none"), json_number(&message, "t")), (None, None));
        assert_eq!(json_stamp_ns(&message), Some(3_000_000_005));
    }
}

remarks! {
    /// Remarks of recordings of messages.
    pub REMARKS;

    /// The stamps of messages stand still, so that the time of recording is taken.
    CR041 StampsStandStill { topics: Vec<String> }
    bears on (About::Time, Weight::Marked)
    decided "A stamp repeats that of the message before, while the times of recording increase throughout."
    means "Messages are recorded later than they are measured, and by delays that vary: times, and with them velocity \
           and crush, are less certain. All topics are read by the time of recording."
    remedy "record with stamps of the sensor"
    says {
        let topics = topics.join(", ");
        format!("stamps of topic {topics} stand still: the time of recording is taken for the time of measurement")
    };

    /// Accelerations come from an inertial sensor.
    CR042 AxesOfSensor {}
    bears on (About::Record, Weight::None)
    decided "The record holds messages (ROS, MCAP) with accelerations."
    means "At rest the sensor measures 1 g upwards. Its x is that of the vehicle only if it is mounted so."
    remedy "choose the channel along the vehicle by --channel, and check its sign"
    says "accelerations of an IMU hold gravity, and are along the axes of the sensor, not of the vehicle";
}
