//! ROS 1 bags with chunks of every packing.

use std::fs;
use std::io::Write;

use crumple_ingest::{Bundle, IngestError, IngestSettings, Ingested, ingest};
use crumple_testkit::shared;

fn block(bytes: &[u8]) -> Vec<u8> {
    [&(bytes.len() as u32).to_le_bytes()[..], bytes].concat()
}

fn field(name: &str, value: &[u8]) -> Vec<u8> {
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
            let mut packer = lz4::EncoderBuilder::new().build(Vec::new()).unwrap();
            packer.write_all(bytes).unwrap();
            let (packed, result) = packer.finish();
            result.unwrap();
            packed
        }
        _ => bytes.to_vec(),
    }
}

fn chunk(packing: &str, claimed: usize, packed: &[u8]) -> Vec<u8> {
    let header =
        [field("op", &[5]), field("compression", packing.as_bytes()), field("size", &(claimed as u32).to_le_bytes())];
    record(&header, packed)
}

/// `sensor_msgs/Imu` of ROS 1.
fn imu(k: u32) -> Vec<u8> {
    let mut data = [k, 100, k * 1_000_000, 4].map(u32::to_le_bytes).concat();
    data.extend(b"base");
    let numbers = [vec![0.0; 13], vec![0.5; 3], vec![0.0; 9], vec![-f64::from(k), 0.0, 9.8], vec![0.0; 9]].concat();
    data.extend(numbers.iter().flat_map(|x: &f64| x.to_le_bytes()));
    data
}

/// 200 messages at 1 kHz, a chunk for each 50, the connection in the first.
fn records() -> Vec<Vec<u8>> {
    let conn = field("conn", &0_u32.to_le_bytes());
    let about = [field("topic", b"/imu"), field("type", b"sensor_msgs/Imu")].concat();
    let connection = record(&[field("op", &[7]), conn.clone(), field("topic", b"/imu")], &about);
    (0..4)
        .map(|c| {
            let messages = (0..50).flat_map(|k| record(&[field("op", &[2]), conn.clone()], &imu(50 * c + k)));
            (if c == 0 { connection.clone() } else { Vec::new() }).into_iter().chain(messages).collect()
        })
        .collect()
}

fn bag(packing: &str) -> Vec<u8> {
    let mut bag = b"#ROSBAG V2.0\n".to_vec();
    for records in records() {
        bag.extend(chunk(packing, records.len(), &pack(packing, &records)));
    }
    bag
}

fn read(bytes: Vec<u8>) -> Result<Ingested, IngestError> {
    let settings = IngestSettings {
        allow_missing: Some(true),
        channel: Some("acceleration_x".to_owned()),
        ..IngestSettings::default()
    };
    ingest(&Bundle::from_bytes("a.bag", bytes)?, &settings)
}

#[test]
fn chunks_of_every_packing_hold_the_same_record() {
    let plain = read(bag("none")).unwrap();
    let pulse = plain.pulse().unwrap();
    assert_eq!((pulse.samples.len(), pulse.samples.dt_s(), pulse.samples.samples()[60]), (200, 1e-3, -60.0));
    for packing in ["bz2", "lz4"] {
        let bytes = bag(packing);
        assert!(bytes.len() < bag("none").len() / 4, "{packing} packs zeros");
        assert_eq!(read(bytes).unwrap().pulse().unwrap().samples, pulse.samples, "{packing}");
    }
}

#[test]
fn a_real_bag_packed_anew_reads_alike() {
    let Some(path) = shared("data/ros-imu-bag/tilt_laser.bag") else { return };
    let bytes = fs::read(path).unwrap();
    let settings = IngestSettings {
        allow_missing: Some(true),
        channel: Some("acceleration_z".to_owned()),
        resample: Some("20Hz".parse().unwrap()),
        ..IngestSettings::default()
    };
    let read = |bytes: Vec<u8>| {
        let ingested = ingest(&Bundle::from_bytes("a.bag", bytes).unwrap(), &settings).unwrap();
        ingested.pulse().unwrap().samples.clone()
    };
    let expected = read(bytes.clone());
    let magic = b"#ROSBAG V2.0\n".len();
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
        assert_eq!(read(packed), expected, "{packing}");
    }
}

#[test]
fn damaged_false_and_boastful_chunks_are_refused_at_their_byte() {
    let of = |packing: &str, claimed: usize, packed: &[u8]| {
        let bytes = [b"#ROSBAG V2.0\n".to_vec(), chunk(packing, claimed, packed)].concat();
        read(bytes).unwrap_err().to_string()
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
    let cut = [b"#ROSBAG V2.0\n".to_vec(), chunk("none", 4, b"abcd")[..20].to_vec()].concat();
    assert!(read(cut).unwrap_err().to_string().contains("a record is cut short (byte 13)"));
}
