//! Whatever the bytes, the answer is a result or a refusal.

use std::io::{Cursor, Write};

use crumple_ingest::{Bundle, IngestSettings, ingest};
use proptest::collection::vec;
use proptest::prelude::*;

const CSV: &str = "# mass: 873 kg\n# impact speed: 36 km/h\ntime_s,accel_g,force [kN]\n";
const EV5: &str = "# Source\n----- EV5 -----\n----- TEST -----\nV5|NCAP - 2018 CAR|||LAB||R|NCA|VTB|||22|||57.09|0|0\n\
    ----- VEHICLE -----\n1|16|03|2018|||||||1719|1514\n----- BARRIER -----\nR|LCB|0|0|X\n----- INSTRUMENTATION -----\n\
    1|93|AC|NA|FLLR|XG|SEC|G'S|2800|M|D|800|21|57.09|-5|64|100|AM|P|REAR SEAT X\n\
    1|96|AC|NA|ENGN|XG|SEC|G'S|2800|M|D|800|21|57.09|-5|64|100|CF|P|ENGINE X: bad\n----- END -----\n";

fn table() -> Vec<u8> {
    let rows: String =
        (0..60).map(|k| format!("{:.4},{:.3},{k}\n", f64::from(k) * 1e-4 - 0.001, -0.1 * f64::from(k))).collect();
    (CSV.to_owned() + &rows).into_bytes()
}

fn curve() -> Vec<u8> {
    (-5..65)
        .map(|k| format!("{:.6}\t{:.6}\n", f64::from(k) * 1e-4, -0.1 * f64::from(k)))
        .collect::<String>()
        .into_bytes()
}

fn zipped() -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in [("t/v1.EV5", EV5.as_bytes().to_vec()), ("t/v1.093", curve()), ("t/v1.096", curve())] {
        zip.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        zip.write_all(&bytes).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

/// Replaces, inserts, removes and cuts bytes; the pieces are those that matter to a reader.
fn mutate(mut bytes: Vec<u8>, changes: &[(u8, prop::sample::Index, usize)]) -> Vec<u8> {
    const PIECES: [&[u8]; 22] = [
        b"NaN",
        b",",
        b";",
        b"\t",
        b"\n",
        b"\r\n",
        b"\"",
        b"#",
        b"-",
        b"1e999",
        b"|",
        b"\0",
        b"\xFF\xFE",
        b" ",
        b":",
        b"-----",
        b"99999999999999999999",
        b"\n\n",
        b"e",
        b".",
        b"0",
        b"kg",
    ];
    for (kind, at, piece) in changes {
        let at = at.index(bytes.len() + 1);
        let piece = PIECES[piece % PIECES.len()];
        match kind % 4 {
            0 => drop(bytes.splice(at..at, piece.iter().copied())),
            1 => {
                let end = (at + piece.len()).min(bytes.len());
                bytes.splice(at..end, piece.iter().copied());
            }
            2 => drop(bytes.drain(at..(at + piece.len()).min(bytes.len()))),
            _ => bytes.truncate(bytes.len().max(1) - (bytes.len().max(1) - at.min(bytes.len().max(1))) / 8),
        }
    }
    bytes
}

/// A result has finite samples and a pulse; a refusal has words. Reaching the end is the point.
fn check(bundle: Result<Bundle, crumple_ingest::IngestError>, settings: &IngestSettings) {
    match bundle.and_then(|bundle| ingest(&bundle, settings)) {
        Ok(ingested) => {
            assert!(ingested.pulse().is_none_or(|w| w.samples.len() >= 50));
            assert!(ingested.waves.iter().all(|w| w.samples.samples().iter().all(|x| x.is_finite())));
        }
        Err(error) => assert!(!error.to_string().is_empty() && !error.hint().is_empty()),
    }
}

fn settings() -> impl Strategy<Value = IngestSettings> {
    (prop::option::of(prop::sample::select(vec!["accel_g", "93", "2", "96", "x"])), any::<bool>()).prop_map(
        |(channel, allow)| IngestSettings {
            channel: channel.map(str::to_owned),
            allow_missing: Some(allow),
            ..IngestSettings::default()
        },
    )
}

fn changes() -> impl Strategy<Value = Vec<(u8, prop::sample::Index, usize)>> {
    vec((any::<u8>(), any::<prop::sample::Index>(), 0_usize..64), 0..6)
}

#[test]
fn the_unchanged_examples_are_read() {
    let all = IngestSettings::default();
    assert!(ingest(&Bundle::from_bytes("a.csv", table()).unwrap(), &all).is_ok());
    let mut bundle = Bundle::from_bytes("v1.EV5", EV5.as_bytes().to_vec()).unwrap();
    bundle.companions.insert("v1.093".to_owned(), curve());
    assert_eq!(ingest(&bundle, &all).unwrap().test.pulse.as_deref(), Some("93"));
    let path = tempfile::tempdir().unwrap();
    let file = path.path().join("v1.zip");
    std::fs::write(&file, zipped()).unwrap();
    assert_eq!(ingest(&Bundle::open(&file).unwrap(), &all).unwrap().waves.len(), 2);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutated_tables(changes in changes(), settings in settings()) {
        check(Bundle::from_bytes("a.csv", mutate(table(), &changes)), &settings);
    }

    #[test]
    fn mutated_tests(spec in changes(), samples in changes(), settings in settings()) {
        let bundle = Bundle::from_bytes("v1.EV5", mutate(EV5.as_bytes().to_vec(), &spec)).map(|mut bundle| {
            bundle.companions.insert("v1.093".to_owned(), mutate(curve(), &samples));
            bundle.companions.insert("v1.096".to_owned(), curve());
            bundle
        });
        check(bundle, &settings);
    }

    #[test]
    fn any_bytes(bytes in vec(any::<u8>(), 0..400), settings in settings()) {
        check(Bundle::from_bytes("a.bin", bytes), &settings);
    }

    #[test]
    fn any_printed_text(text in "[-0-9.,;eE\t \n#a-z\"()]{0,400}", settings in settings()) {
        check(Bundle::from_bytes("a.txt", text.into_bytes()), &settings);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutated_archives(changes in changes(), settings in settings()) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("v1.zip");
        std::fs::write(&path, mutate(zipped(), &changes)).unwrap();
        check(Bundle::open(&path), &settings);
    }
}

/// An ISO-MME channel file.
fn channel_file() -> Vec<u8> {
    let samples: String = (0..80).map(|k| format!("{:.4e}\n", -0.1 * f64::from(k))).collect();
    format!(
        "Test object number          :1\nChannel code                :10SECMLERE00ACXP\n\
         Unit                        :g\n\
         Reference channel           :implicit\nSampling interval           :0.0001\n\
         Time of first sample        :-0.002\nNumber of samples           :80\n{samples}NOVALUE\n"
    )
    .into_bytes()
}

/// An MCAP file of JSON messages.
fn mcap_file() -> Vec<u8> {
    let mut writer = mcap::WriteOptions::new().create(Cursor::new(Vec::new())).unwrap();
    let channel = writer.add_channel(0, "/a", "json", &std::collections::BTreeMap::new()).unwrap();
    for k in 0..60_u64 {
        let time = 1_000_000 * k;
        let header =
            mcap::records::MessageHeader { channel_id: channel, sequence: 0, log_time: time, publish_time: time };
        writer.write_to_known_channel(&header, format!("{{\"x\":{k}}}").as_bytes()).unwrap();
    }
    writer.finish().unwrap();
    writer.into_inner().into_inner()
}

/// A ROS bag with one connection and some messages that are too short for what they claim to be.
fn bag() -> Vec<u8> {
    let block = |bytes: &[u8]| [&(bytes.len() as u32).to_le_bytes()[..], bytes].concat();
    let field = |name: &str, value: &[u8]| block(&[name.as_bytes(), b"=", value].concat());
    let conn = field("conn", &0_u32.to_le_bytes());
    let about = [field("topic", b"/imu"), field("type", b"sensor_msgs/Imu")].concat();
    let mut bag = b"#ROSBAG V2.0\n".to_vec();
    bag.extend(block(&[field("op", &[7]), conn.clone(), field("topic", b"/imu")].concat()));
    bag.extend(block(&about));
    for k in 0..60_u32 {
        bag.extend(block(&[field("op", &[2]), conn.clone()].concat()));
        let mut message =
            [1_u32.to_le_bytes(), 5_u32.to_le_bytes(), (k * 1_000_000).to_le_bytes(), 0_u32.to_le_bytes()].concat();
        message.resize(16 + 37 * 8, 0);
        bag.extend(block(&message));
    }
    bag
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutated_channel_files(changes in changes(), settings in settings()) {
        check(Bundle::from_bytes("a.001", mutate(channel_file(), &changes)), &settings);
    }

    #[test]
    fn mutated_bags(changes in changes(), settings in settings()) {
        check(Bundle::from_bytes("a.bag", mutate(bag(), &changes)), &settings);
    }

    #[test]
    fn mutated_recordings(changes in changes(), settings in settings()) {
        let settings = IngestSettings { field: Some("x".to_owned()), unit: Some("g".to_owned()), ..settings };
        check(Bundle::from_bytes("a.mcap", mutate(mcap_file(), &changes)), &settings);
    }
}

#[test]
fn the_unchanged_recordings_are_read() {
    let settings =
        IngestSettings { field: Some("x".to_owned()), allow_missing: Some(true), ..IngestSettings::default() };
    for (name, bytes, waves) in [("a.001", channel_file(), 1), ("a.bag", bag(), 6), ("a.mcap", mcap_file(), 1)] {
        assert_eq!(ingest(&Bundle::from_bytes(name, bytes).unwrap(), &settings).unwrap().waves.len(), waves, "{name}");
    }
}
