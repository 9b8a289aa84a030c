//! Numbers named in protobuf messages of MCAP files, in chunks of every packing.

use std::fs;
use std::io::Write;

use crumple_ingest::{IngestError, IngestSettings, Ingested};
use crumple_signal::{QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G};
use crumple_testkit::shared;
use mcap::Compression;
use proptest::prelude::*;
use prost_reflect::prost::Message as _;
use prost_reflect::prost_types::field_descriptor_proto::{Label, Type};
use prost_reflect::prost_types::{DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet};
use prost_reflect::{DescriptorPool, DynamicMessage, MapKey, Value};

use crate::messages::{imu, mcap_file};
use crate::{given, read_as};

fn field(name: &str, number: i32, kind: Type, of: &str) -> FieldDescriptorProto {
    FieldDescriptorProto {
        name: Some(name.to_owned()),
        number: Some(number),
        label: Some(if name == "raw" { Label::Repeated } else { Label::Optional } as i32),
        r#type: Some(kind as i32),
        type_name: (!of.is_empty()).then(|| of.to_owned()),
        ..FieldDescriptorProto::default()
    }
}

fn message(name: &str, fields: Vec<FieldDescriptorProto>) -> DescriptorProto {
    DescriptorProto { name: Some(name.to_owned()), field: fields, ..DescriptorProto::default() }
}

/// `crash.Sensor`, in the manner of Foxglove's types: a stamp, a vector, a repeated number, a float.
fn description() -> Vec<u8> {
    let file = |package: &str, types: Vec<DescriptorProto>, needs: &[&str]| FileDescriptorProto {
        name: Some(format!("{package}.proto")),
        package: Some(package.to_owned()),
        dependency: needs.iter().map(|n| format!("{n}.proto")).collect(),
        message_type: types,
        syntax: Some("proto3".to_owned()),
        ..FileDescriptorProto::default()
    };
    let stamp = message("Timestamp", vec![field("seconds", 1, Type::Int64, ""), field("nanos", 2, Type::Int32, "")]);
    let vector =
        message("Vector3", ["x", "y", "z"].iter().zip(1..).map(|(n, k)| field(n, k, Type::Double, "")).collect());
    let sensor = message(
        "Sensor",
        vec![
            field("timestamp", 1, Type::Message, ".google.protobuf.Timestamp"),
            field("linear", 3, Type::Message, ".crash.Vector3"),
            field("raw", 4, Type::Sint32, ""),
            field("force", 5, Type::Float, ""),
            field("label", 6, Type::String, ""),
        ],
    );
    let set = FileDescriptorSet {
        file: vec![
            file("google.protobuf", vec![stamp], &[]),
            file("crash", vec![vector, sensor], &["google.protobuf"]),
        ],
    };
    set.encode_to_vec()
}

/// One message: x = -k m/s^2 at 1 kHz from 100 s on. The z of the first is 0, which protobuf does not send.
fn sample(pool: &DescriptorPool, k: u64, with_stamp: bool) -> Vec<u8> {
    let of = |name: &str| DynamicMessage::new(pool.get_message_by_name(name).unwrap());
    let mut sensor = of("crash.Sensor");
    if with_stamp {
        let mut stamp = of("google.protobuf.Timestamp");
        stamp.set_field_by_name("seconds", Value::I64(100));
        stamp.set_field_by_name("nanos", Value::I32((k * 1_000_000) as i32));
        sensor.set_field_by_name("timestamp", Value::Message(stamp));
    }
    let mut linear = of("crash.Vector3");
    linear.set_field_by_name("x", Value::F64(-(k as f64)));
    linear.set_field_by_name("z", Value::F64(0.5 * k as f64));
    sensor.set_field_by_name("linear", Value::Message(linear));
    sensor.set_field_by_name("raw", Value::List(vec![Value::I32(7), Value::I32(-(k as i32))]));
    sensor.set_field_by_name("force", Value::F32(0.25 * k as f32));
    sensor.encode_to_vec()
}

const TOPIC: (&str, &str) = ("/tunnel", "protobuf");

fn mcap_of(packing: Option<Compression>, description: &[u8], with_stamp: bool) -> Vec<u8> {
    let pool = DescriptorPool::decode(self::description().as_slice()).unwrap();
    let messages = (0..200_u64).map(|k| {
        // Recorded late and, without a stamp of their own, evenly.
        let late = if with_stamp { (k * 7919) % 500_000 } else { 0 };
        (50_000_000_000 + k * 2_000_000 + late, sample(&pool, k, with_stamp))
    });
    mcap_file(("crash.Sensor", "protobuf", description), TOPIC, packing, messages)
}

fn read(bytes: Vec<u8>, field: &str, unit: Option<&str>) -> Result<Ingested, IngestError> {
    let unit = unit.map_or_else(String::new, |unit| format!("--unit {unit}"));
    read_as("a.mcap", bytes, &given(&format!("--allow-missing --field {field} {unit}")))
}

#[test]
fn named_fields_come_with_the_stamps_of_the_messages_whatever_the_packing() {
    for packing in [None, Some(Compression::Lz4), Some(Compression::Zstd)] {
        let ingested =
            read(mcap_of(packing, &description(), true), "linear.x,linear.z,raw.1,force", Some("g")).unwrap();
        let of = |id: &str| ingested.waves.iter().find(|w| w.id == id).unwrap();
        let x = of("tunnel-linear_x");
        assert_eq!((x.quantity, x.samples.t0_s(), x.samples.dt_s()), (QuantityKind::Acceleration, 0.0, 1e-3));
        assert_eq!((x.samples.len(), x.samples.samples()[17]), (200, -17.0 * G));
        // 0 is not sent and read as 0.
        assert_eq!(of("tunnel-linear_z").samples.samples()[..2], [0.0, 0.5 * G]);
        assert_eq!(of("tunnel-raw_1").samples.samples()[3], -3.0 * G);
        assert_eq!(of("tunnel-force").samples.samples()[3], 0.75 * G);
    }
}

#[test]
fn without_a_stamp_the_time_of_recording_counts_and_is_said() {
    let ingested = read(mcap_of(None, &description(), false), "linear.x", None).unwrap();
    assert_eq!((ingested.waves[0].samples.dt_s(), ingested.waves[0].quantity), (2e-3, QuantityKind::Other));
    let notes = ingested.notes.to_texts().join("\n");
    assert!(notes.contains("the time of recording is taken") && notes.contains("no unit is known"), "{notes}");
}

#[test]
fn a_wrong_path_is_answered_with_the_right_ones() {
    let error = read(mcap_of(None, &description(), true), "linear.w", Some("g")).unwrap_err();
    assert!(error.to_string().contains("no JSON or protobuf message has a number at linear.w"), "{error}");
    assert_eq!(error.hint(), "correct --field; numbers there: force, linear.x, linear.y, linear.z, raw.0");
    let error = read(mcap_of(None, &description(), true), "linear", Some("g")).unwrap_err();
    assert!(error.to_string().contains("has a number at linear"), "{error}");
    let error = read(mcap_of(None, &description(), true), "linear.x", Some("parsec")).unwrap_err();
    assert!(error.to_string().contains("\"parsec\", stated by --unit"), "{error}");
}

#[test]
fn unnamed_fields_and_broken_schemas_are_refused_by_name() {
    let bytes = mcap_of(None, &description(), true);
    let error = read_as("a.mcap", bytes, &IngestSettings::default()).unwrap_err();
    assert!(error.to_string().contains("/tunnel (crash.Sensor, protobuf, 200 messages)"), "{error}");
    assert!(error.hint().contains("--field"), "{}", error.hint());
    let error = read(mcap_of(None, b"syntax = \"proto3\";", true), "linear.x", None).unwrap_err();
    assert!(error.to_string().contains("its schema is no description of protobuf types"), "{error}");
    let nothing = FileDescriptorSet::default().encode_to_vec();
    let error = read(mcap_of(None, &nothing, true), "linear.x", None).unwrap_err();
    assert!(error.to_string().contains("its schema does not describe crash.Sensor"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    /// Neither a damaged description nor damaged messages stop the program; they are written into an intact MCAP file,
    /// so that no checksum is in the way.
    #[test]
    fn damaged_descriptions_and_messages(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        which in 0..2,
    ) {
        let pool = DescriptorPool::decode(description().as_slice()).unwrap();
        let change = |mut bytes: Vec<u8>| {
            for (at, byte) in &changes {
                let at = at.index(bytes.len());
                bytes[at] = *byte;
            }
            bytes
        };
        let schema = if which == 0 { change(description()) } else { description() };
        let messages = (0..60_u64).map(|k| {
            let data = sample(&pool, k, true);
            (k, if which == 1 && k % 7 == 3 { change(data) } else { data })
        });
        let file = mcap_file(("crash.Sensor", "protobuf", &schema), TOPIC, None, messages);
        if let Ok(ingested) = read(file, "linear.x,raw.1", Some("g")) {
            prop_assert!(ingested.waves.iter().all(|w| w.samples.samples().iter().all(|x| x.is_finite())));
        }
    }
}

#[test]
fn maps_are_no_numbers() {
    // A map is a repeated message with `map_entry`; a path into it finds nothing, and it is not listed.
    let mut entry = message("OfEntry", vec![field("key", 1, Type::String, ""), field("value", 2, Type::Double, "")]);
    entry.options = Some(prost_reflect::prost_types::MessageOptions { map_entry: Some(true), ..Default::default() });
    let mut of = field("of", 1, Type::Message, ".crash.Table.OfEntry");
    of.label = Some(Label::Repeated as i32);
    let mut table = message("Table", vec![of, field("a", 2, Type::Double, "")]);
    table.nested_type = vec![entry];
    let set = FileDescriptorSet {
        file: vec![FileDescriptorProto {
            name: Some("crash.proto".to_owned()),
            package: Some("crash".to_owned()),
            message_type: vec![table],
            syntax: Some("proto3".to_owned()),
            ..FileDescriptorProto::default()
        }],
    };
    let pool = DescriptorPool::from_file_descriptor_set(set.clone()).unwrap();
    let mut row = DynamicMessage::new(pool.get_message_by_name("crash.Table").unwrap());
    row.set_field_by_name("of", Value::Map([(MapKey::String("x".to_owned()), Value::F64(1.0))].into()));
    let schema = ("crash.Table", "protobuf", &set.encode_to_vec()[..]);
    let error =
        read(mcap_file(schema, ("/t", "protobuf"), None, [(1, row.encode_to_vec())]), "of.x", None).unwrap_err();
    assert_eq!(error.hint(), "correct --field; numbers there: a");
}

fn block(bytes: &[u8]) -> Vec<u8> {
    [&(bytes.len() as u32).to_le_bytes()[..], bytes].concat()
}

fn field_of_header(name: &str, value: &[u8]) -> Vec<u8> {
    block(&[name.as_bytes(), b"=", value].concat())
}

fn record(header: &[Vec<u8>], data: &[u8]) -> Vec<u8> {
    [block(&header.concat()), block(data)].concat()
}

fn pack(packing: &str, bytes: &[u8]) -> Vec<u8> {
    match packing {
        "bz2" => {
            let mut packer = bzip2::write::BzEncoder::new(Vec::new(), bzip2::Compression::best());
            packer.write_all(bytes).unwrap();
            packer.finish().unwrap()
        }
        "lz4" => {
            let mut packer = lz4_flex::frame::FrameEncoder::new(Vec::new());
            packer.write_all(bytes).unwrap();
            packer.finish().unwrap()
        }
        _ => bytes.to_vec(),
    }
}

fn chunk(packing: &str, claimed: usize, packed: &[u8]) -> Vec<u8> {
    let header = [
        field_of_header("op", &[5]),
        field_of_header("compression", packing.as_bytes()),
        field_of_header("size", &(claimed as u32).to_le_bytes()),
    ];
    record(&header, packed)
}

/// 200 messages at 1 kHz, a chunk for each 50, the connection in the first.
pub fn records() -> Vec<Vec<u8>> {
    let conn = field_of_header("conn", &0_u32.to_le_bytes());
    let about = [field_of_header("topic", b"/imu"), field_of_header("type", b"sensor_msgs/Imu")].concat();
    let connection = record(&[field_of_header("op", &[7]), conn.clone(), field_of_header("topic", b"/imu")], &about);
    (0..4)
        .map(|c| {
            let imu = |k: u32| imu(false, 100_000_000_000 + u64::from(k) * 1_000_000, [-f64::from(k), 0.0, 9.8]);
            let messages = (0..50).flat_map(|k| record(&[field_of_header("op", &[2]), conn.clone()], &imu(50 * c + k)));
            (if c == 0 { connection.clone() } else { Vec::new() }).into_iter().chain(messages).collect()
        })
        .collect()
}

pub const MAGIC: &[u8] = b"#ROSBAG V2.0\n";

fn bag(packing: &str) -> Vec<u8> {
    let chunks = records().into_iter().flat_map(|records| chunk(packing, records.len(), &pack(packing, &records)));
    MAGIC.iter().copied().chain(chunks).collect()
}

fn read_bag(bytes: Vec<u8>) -> Result<Ingested, IngestError> {
    read_as("a.bag", bytes, &given("--allow-missing --channel acceleration_x"))
}

#[test]
fn chunks_of_every_packing_hold_the_same_record() {
    let plain = read_bag(bag("none")).unwrap();
    let pulse = plain.pulse().unwrap();
    assert_eq!((pulse.samples.len(), pulse.samples.dt_s(), pulse.samples.samples()[60]), (200, 1e-3, -60.0));
    for packing in ["bz2", "lz4"] {
        let bytes = bag(packing);
        assert!(bytes.len() < bag("none").len() / 4, "{packing} packs zeros");
        assert_eq!(read_bag(bytes).unwrap().pulse().unwrap().samples, pulse.samples, "{packing}");
    }
}

#[test]
fn a_real_bag_packed_anew_reads_alike() {
    let Some(path) = shared("data/ros-imu-bag/tilt_laser.bag") else { return };
    let bytes = fs::read(path).unwrap();
    let settings = given("--allow-missing --channel acceleration_z --resample 20Hz");
    let samples = |bytes: Vec<u8>| read_as("a.bag", bytes, &settings).unwrap().pulse().unwrap().samples.clone();
    let expected = samples(bytes.clone());
    let magic = MAGIC.len();
    for packing in ["bz2", "lz4"] {
        // Every chunk of the file anew; other records as they are.
        let (mut at, mut packed) = (magic, bytes[..magic].to_vec());
        let length = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        let mut chunks = 0;
        while at < bytes.len() {
            let data_at = at + 4 + length(at);
            let end = data_at + 4 + length(data_at);
            let is_chunk = bytes[at..data_at].windows(4).any(|w| w == b"op=\x05");
            if is_chunk {
                let data = &bytes[data_at + 4..end];
                packed.extend(chunk(packing, data.len(), &pack(packing, data)));
                chunks += 1;
            } else {
                packed.extend(&bytes[at..end]);
            }
            at = end;
        }
        assert!(chunks > 0 && packed.len() < bytes.len());
        assert_eq!(samples(packed), expected, "{packing}");
    }
}

#[test]
fn damaged_false_and_boastful_chunks_are_refused_at_their_byte() {
    let of = |packing: &str, claimed: usize, packed: &[u8]| {
        let bytes = [MAGIC.to_vec(), chunk(packing, claimed, packed)].concat();
        read_bag(bytes).unwrap_err().to_string()
    };
    let data = records().concat();
    for packing in ["bz2", "lz4"] {
        let packed = pack(packing, &data);
        let text = of(packing, data.len(), &packed[..packed.len() / 2]);
        assert!(text.contains("a chunk that") && text.ends_with("(byte 13)"), "{text}");
        let text = of(packing, data.len(), b"garbage, not packed at all");
        assert!(text.contains(&format!("{packing} cannot unpack")), "{text}");
        assert!(of(packing, 10, &packed).contains("unpacks to more than the 10 bytes it claims"));
        assert!(of(packing, data.len() + 1, &packed).contains("bytes it claims"));
        // 300 MiB claimed: refused before anything is unpacked.
        assert!(of(packing, 300 << 20, &packed).contains("a chunk that claims 300 MiB"));
        let text = of(packing, data.len() - 1, &pack(packing, &data[..data.len() - 1]));
        assert!(
            text.contains("a record is cut short (byte") && text.contains("of the unpacked chunk at byte 13)"),
            "{text}"
        );
        let nested = chunk("none", data.len(), &data);
        assert!(of(packing, nested.len(), &pack(packing, &nested)).contains("a chunk inside a chunk"));
    }
    assert!(of("zstd", 4, b"abcd").contains("a chunk compressed by \"zstd\""));
    let cut = [MAGIC.to_vec(), chunk("none", 4, b"abcd")[..20].to_vec()].concat();
    assert!(read_bag(cut).unwrap_err().to_string().contains("a record is cut short (byte 13)"));
}
