//! Recordings of sensors in MCAP and ROS bags, and artifacts as input.

use std::collections::BTreeMap;
use std::fs;
use std::io::Cursor;

use crumple_ingest::{IngestError, IngestSettings, Ingested};
use crumple_signal::{QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G};
use crumple_testkit::shared;
use mcap::Compression;
use mcap::records::MessageHeader;

use crate::{given, notes, open, program, read_as};

/// An MCAP file of one topic, of a schema's name, encoding and data; each message is its log time and its bytes.
pub fn mcap_file(
    schema: (&str, &str, &[u8]),
    (topic, encoding): (&str, &str),
    packing: Option<Compression>,
    messages: impl IntoIterator<Item = (u64, Vec<u8>)>,
) -> Vec<u8> {
    let mut writer = mcap::WriteOptions::new().compression(packing).create(Cursor::new(Vec::new())).unwrap();
    let schema = writer.add_schema(schema.0, schema.1, schema.2).unwrap();
    let channel_id = writer.add_channel(schema, topic, encoding, &BTreeMap::new()).unwrap();
    for (time, data) in messages {
        let header = MessageHeader { channel_id, sequence: 0, log_time: time, publish_time: time };
        writer.write_to_known_channel(&header, &data).unwrap();
    }
    writer.finish().unwrap();
    writer.into_inner().into_inner()
}

fn of_topic(kind: &str, encoding: &str, messages: &[(u64, Vec<u8>)]) -> Vec<u8> {
    mcap_file((kind, "ros2msg", b""), ("/imu", encoding), Some(Compression::Zstd), messages.iter().cloned())
}

/// `sensor_msgs/Imu` as ROS 2 (`cdr`) or ROS 1 writes it.
pub fn imu(cdr: bool, stamp_ns: u64, linear: [f64; 3]) -> Vec<u8> {
    let (seconds, rest) = ((stamp_ns / 1_000_000_000) as u32, (stamp_ns % 1_000_000_000) as u32);
    let frame = if cdr { "base\0" } else { "base" };
    let head = [7, seconds, rest, frame.len() as u32];
    let mut body = head[usize::from(cdr)..].iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    body.extend(frame.as_bytes());
    if cdr {
        body.resize(body.len().next_multiple_of(8), 0);
    }
    let numbers = [vec![0.0; 13], vec![0.5; 3], vec![0.0; 9], linear.to_vec(), vec![0.0; 9]].concat();
    body.extend(numbers.iter().flat_map(|x: &f64| x.to_le_bytes()));
    if cdr { [vec![0, 1, 0, 0], body].concat() } else { body }
}

fn read(bytes: Vec<u8>, settings: &IngestSettings) -> Result<Ingested, IngestError> {
    read_as("a.mcap", bytes, settings)
}

fn settings(flags: &str) -> IngestSettings {
    given(&format!("--allow-missing --channel {flags}"))
}

/// 200 messages at 1 kHz from 100 s on; the times of recording are late and uneven.
fn log(encode: impl Fn(u64, [f64; 3]) -> Vec<u8>) -> Vec<(u64, Vec<u8>)> {
    (0..200_u64)
        .map(|k| {
            let stamp = 100_000_000_000 + k * 1_000_000;
            (stamp + 3_000_000 + (k * 7919) % 500_000, encode(stamp, [-(k as f64), 0.25, 9.8]))
        })
        .collect()
}

#[test]
fn stamps_of_the_messages_are_the_time() {
    for (kind, encoding, cdr) in [("sensor_msgs/msg/Imu", "cdr", true), ("sensor_msgs/Imu", "ros1", false)] {
        let file = of_topic(kind, encoding, &log(|stamp, linear| imu(cdr, stamp, linear)));
        let ingested = read(file, &settings("acceleration_x")).unwrap();
        assert_eq!(ingested.waves.len(), 6);
        let pulse = ingested.pulse().unwrap();
        assert_eq!((pulse.samples.t0_s(), pulse.samples.dt_s(), pulse.samples.len()), (0.0, 1e-3, 200));
        assert_eq!(pulse.samples.samples()[17], -17.0);
        assert_eq!(pulse.id, "imu-acceleration_x");
        assert!(ingested.waves.iter().filter(|w| w.quantity == QuantityKind::AngularVelocity).count() == 3);
    }
}

#[test]
fn several_axes_are_asked_about() {
    let file = of_topic("sensor_msgs/msg/Imu", "cdr", &log(|stamp, linear| imu(true, stamp, linear)));
    let stated = given("--mass 1t --impact-speed 10m/s");
    let error = read(file, &stated).unwrap_err();
    assert!(error.to_string().contains("3 acceleration columns: imu-acceleration_x"), "{error}");
}

#[test]
fn a_field_of_json_messages_is_named_with_its_unit() {
    let json = |stamp: u64, linear: [f64; 3]| {
        format!(
            "{{\"header\":{{\"stamp\":{{\"sec\":{},\"nanosec\":{}}}}},\"imu\":{{\"acceleration\":{{\"x\":{}}}}}}}",
            stamp / 1_000_000_000,
            stamp % 1_000_000_000,
            linear[0]
        )
        .into_bytes()
    };
    let file = of_topic("Something", "json", &log(json));
    let error = read(file.clone(), &IngestSettings::default()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "a.mcap: no topic with acceleration; its topics: /imu (Something, json, 200 messages)"
    );
    assert!(error.hint().contains("--field imu.acceleration.x"));
    let named = given("--allow-missing --field imu.acceleration.x --unit g");
    let ingested = read(file.clone(), &named).unwrap();
    let pulse = ingested.pulse().unwrap();
    assert_eq!((pulse.id.as_str(), pulse.samples.samples()[2]), ("imu-imu_acceleration_x", -2.0 * G));
    let wrong = given("--allow-missing --field imu.speed --unit g");
    assert!(
        read(file, &wrong).unwrap_err().to_string().contains("no JSON or protobuf message has a number at imu.speed")
    );
}

#[test]
fn other_encodings_are_refused_by_name() {
    let file = of_topic("sensor_msgs/msg/Imu", "flatbuffer", &[(1, vec![1, 2, 3])]);
    let error = read(file, &IngestSettings::default()).unwrap_err();
    assert!(error.to_string().contains("(sensor_msgs/msg/Imu, flatbuffer, 1 messages)"), "{error}");
    assert!(error.hint().contains("encoding is not read"), "{}", error.hint());
}

#[test]
fn uneven_stamps_are_refused_and_resampled_only_on_request() {
    let mut messages = log(|stamp, linear| imu(true, stamp, linear));
    messages.remove(100);
    let file = of_topic("sensor_msgs/msg/Imu", "cdr", &messages);
    let error = read(file.clone(), &settings("acceleration_x")).unwrap_err();
    assert!(error.to_string().starts_with("a.mcap, topic /imu, message 101: a step of 0.002000000 s"), "{error}");
    assert!(error.hint().contains("--resample 1000Hz"), "{}", error.hint());
    let asked = settings("acceleration_x --resample 1kHz");
    let ingested = read(file, &asked).unwrap();
    let samples = ingested.pulse().unwrap().samples.samples();
    // The record is a straight line: interpolation gives it back but for rounding of the stamps (1e-9 s of 1e3 per s).
    assert!(samples.len() == 200 && samples.iter().enumerate().all(|(k, x)| (x + k as f64).abs() < 1e-6));
    assert!(notes(&ingested).contains("199 messages are resampled to 1000 Hz"));
}

#[test]
fn stamps_out_of_order_are_refused_with_advice_that_works() {
    let good = log(|stamp, linear| imu(true, stamp, linear));
    let file = |messages: &[(u64, Vec<u8>)]| of_topic("sensor_msgs/msg/Imu", "cdr", messages);
    let (mut twice, mut exchanged) = (good.clone(), good.clone());
    twice.insert(100, good[99].clone());
    let (a, b) = (exchanged[50].1.clone(), exchanged[51].1.clone());
    (exchanged[50].1, exchanged[51].1) = (b, a);
    for (messages, found, hint) in [
        (twice, "message 101: it has the same time stamp as the message before", "remove the duplicate message"),
        (exchanged, "message 52: its stamp is earlier", "sort the messages by their stamps"),
    ] {
        let error = read(file(&messages), &settings("acceleration_x")).unwrap_err();
        assert!(error.to_string().contains(found) && error.hint().starts_with(hint), "{error} ({})", error.hint());
    }
    assert_eq!(read(file(&good), &settings("acceleration_x")).unwrap().pulse().unwrap().samples.len(), 200);
}

#[test]
fn damaged_and_boastful_files_are_refused() {
    let file = of_topic("sensor_msgs/msg/Imu", "cdr", &log(|stamp, linear| imu(true, stamp, linear)));
    for length in [9, 100, file.len() / 2, file.len() - 1] {
        let error = read(file[..length].to_vec(), &IngestSettings::default()).unwrap_err();
        assert!(error.to_string().contains("the MCAP file cannot be read"), "{error}");
    }
    // A chunk record (opcode 6): times, then the size it claims.
    let mut huge = b"\x89MCAP0\r\n".to_vec();
    let mut chunk = vec![0; 16];
    chunk.extend((1_u64 << 40).to_le_bytes());
    chunk.extend([0; 4]);
    chunk.extend(3_u32.to_le_bytes());
    chunk.extend(b"lz4");
    chunk.extend(0_u64.to_le_bytes());
    huge.push(6);
    huge.extend((chunk.len() as u64).to_le_bytes());
    huge.extend(&chunk);
    huge.extend(b"\x89MCAP0\r\n");
    let error = read(huge, &IngestSettings::default()).unwrap_err();
    assert!(error.to_string().contains("a chunk that claims 1048576 MiB"), "{error}");
}

#[test]
fn an_artifact_of_a_stage_passes_through() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let rows: String =
        (0..400).map(|k| format!("{:.4},{:.3},{k}\n", f64::from(k - 100) * 1e-4, -0.1 * f64::from(k))).collect();
    let head = "# mass: 873 kg\n# impact speed: 36 km/h\ntime_s,accel_g,force [kN]\n";
    fs::write(path("a.csv"), format!("{head}{rows}")).unwrap();
    for (input, output) in [("a.csv", "1.mcap"), ("1.mcap", "2.mcap")] {
        assert_eq!(program(&path(input), &["-o", path(output).to_str().unwrap()]).0, 0);
    }
    let read = |name: &str| open(path(name), &IngestSettings::default()).unwrap();
    let (first, again) = (read("a.csv"), read("2.mcap"));
    assert_eq!((again.test.pulse.as_deref(), again.test.mass_kg), (Some("accel_g"), Some(873.0)));
    assert_eq!(first.test.channels, again.test.channels);
    for wave in &first.waves {
        assert_eq!(again.waves.iter().find(|w| w.id == wave.id).unwrap().samples, wave.samples);
    }
}

#[test]
fn the_logged_bag_gives_gravity() {
    let Some(path) = shared("data/ros-imu-bag/tilt_laser.bag") else { return };
    let error = open(&path, &settings("acceleration_z")).unwrap_err();
    assert!(error.to_string().contains("a step of 0.039775"), "{error}");
    let ingested = open(&path, &settings("acceleration_z --resample 20Hz")).unwrap();
    let samples = ingested.pulse().unwrap().samples.samples();
    let mean = samples.iter().sum::<f64>() / samples.len() as f64;
    // The mean of the raw messages is stated as 9.796; interpolation on as many instants moves it by far less than
    // 0.01.
    assert!((mean - 9.796).abs() < 0.01, "{mean}");
}

#[test]
fn topics_of_a_bag_and_of_an_mcap_file_are_listed() {
    let Some(bag) = shared("data/ros-imu-bag/tilt_laser.bag") else { return };
    let (code, table, _) = program(&bag, &["--list"]);
    assert_eq!(code, 0);
    assert!(table.contains("imu_data-acceleration_x") && table.contains("needs --resample"), "{table}");
    let Some(mcap) = shared("data/mcap-json/example.mcap") else { return };
    let (code, _, text) = program(&mcap, &["--list"]);
    assert_eq!(code, 3);
    assert!(text.contains("no topic with acceleration; its topics: mouse (MouseEvent, json, 111 messages)"), "{text}");
}
