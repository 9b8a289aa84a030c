//! What the reader says of files that are not what they should be.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;

use crumple_artifact::records::{EventsV1, MetricV1, MetricsV1, MetricsV2, NotesV1, WaveBlockV1};
use crumple_artifact::{Artifact, ArtifactBuilder, Codec, Compression, InputDigest, Provenance, ReadError, Record};
use crumple_signal::{QuantityKind, Sampled};

fn provenance() -> Provenance {
    let input = InputDigest { kind: "ingest".into(), digest: "blake3:00".into() };
    Provenance::new("filter", "0.1.0", r#"{"cfc":60}"#.into(), vec![input])
}

fn builder() -> ArtifactBuilder {
    let mut builder = ArtifactBuilder::new();
    let metric = MetricV1 {
        name: "peak".into(),
        value: Some(12.5),
        unit: "m/s^2".into(),
        channel: "93".into(),
        definition: "max |a|".into(),
        ..MetricV1::default()
    };
    builder.put("/metrics", &MetricsV2 { metrics: vec![metric] }).unwrap();
    builder.put("/notes", &NotesV1 { stage: "filter".into(), notes: vec!["zero level 0.01".into()] }).unwrap();
    let samples = (0..40).map(|k| f64::from(k).sin()).collect();
    builder.wave("93", QuantityKind::Acceleration, Sampled::new(-0.02, 1e-4, samples).unwrap()).unwrap();
    builder
}

fn bytes(compression: Compression) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    builder().write_to(&mut file, &provenance(), compression).unwrap();
    file.into_inner()
}

fn read(bytes: &[u8]) -> Result<Artifact, ReadError> {
    Artifact::read(Path::new("x.mcap"), bytes)
}

#[test]
fn what_is_written_is_read_back() {
    for compression in [Compression::None, Compression::Zstd] {
        let artifact = read(&bytes(compression)).unwrap();
        assert_eq!(artifact.stage(), Some("filter"));
        assert_eq!(artifact.provenance(), Some(&provenance()));
        let wave = &artifact.waves()["93"];
        assert_eq!(wave.quantity, QuantityKind::Acceleration);
        assert_eq!(wave.sampled.t0_s(), -0.02);
        assert_eq!(wave.sampled.samples()[7], 7.0_f64.sin());
        let metrics: MetricsV2 = artifact.record("/metrics").unwrap().unwrap();
        assert_eq!(metrics.metrics[0].value, Some(12.5));
        assert!(artifact.record::<EventsV1>("/events").unwrap().is_none());
    }
}

#[test]
fn the_digest_does_not_see_compression_and_the_bytes_repeat() {
    let (plain, packed) = (bytes(Compression::None), bytes(Compression::Zstd));
    assert_ne!(plain, packed);
    assert_eq!(read(&plain).unwrap().digest(), read(&packed).unwrap().digest());
    assert_eq!(plain, bytes(Compression::None));
    assert_eq!(packed, bytes(Compression::Zstd));
}

/// Every single bit of the file, one at a time, with and without compression.
#[test]
fn a_flipped_bit_anywhere_is_refused_and_the_record_is_named() {
    for compression in [Compression::None, Compression::Zstd] {
        let good = bytes(compression);
        let mut accepted = Vec::new();
        for place in 0..good.len() {
            for bit in 0..8 {
                let mut bad = good.clone();
                bad[place] ^= 1 << bit;
                match read(&bad) {
                    Ok(_) => accepted.push((place, bit)),
                    Err(ReadError::Corrupt { record, problem, .. }) => {
                        assert!(!record.is_empty() && !problem.is_empty());
                    }
                    Err(ReadError::Truncated { record, .. }) => assert!(!record.is_empty()),
                    Err(ReadError::NotMcap { .. }) => assert!(place < mcap::MAGIC.len(), "byte {place}"),
                    Err(other) => panic!("byte {place} bit {bit}: {other}"),
                }
            }
        }
        assert!(accepted.is_empty(), "accepted flips at {accepted:?} of {} bytes", good.len());
    }
}

#[test]
fn a_file_cut_anywhere_is_refused() {
    let good = bytes(Compression::None);
    for length in 0..good.len() {
        match read(&good[..length]) {
            Err(ReadError::Truncated { at, .. }) => assert_eq!(at, length as u64),
            Err(ReadError::NotMcap { .. }) => assert!(length < mcap::MAGIC.len()),
            Err(ReadError::Corrupt { .. }) => {}
            Err(other) => panic!("cut at {length}: {other}"),
            Ok(_) => panic!("accepted when cut at {length} of {}", good.len()),
        }
    }
    let text = read(&good[..good.len() - 100]).unwrap_err().to_string();
    assert!(text.starts_with("x.mcap: truncated: the file ends at byte "), "{text}");
}

#[test]
fn a_record_longer_than_its_file_is_said_to_be_cut() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.mcap");
    let good = bytes(Compression::None);
    // the length of the first record follows the magic bytes and one byte of what it is
    for place in [11, 12, 13, 16] {
        let mut damaged = good.clone();
        damaged[place] |= 0x40;
        std::fs::write(&path, &damaged).unwrap();
        let error = Artifact::open(&path).unwrap_err();
        assert!(matches!(error, ReadError::Truncated { at, .. } if at == good.len() as u64), "{place}: {error}");
    }
    std::fs::write(&path, &good[..good.len() - 40]).unwrap();
    assert!(Artifact::open(&path).is_err());
}

#[test]
fn trailing_bytes_and_other_files_are_refused() {
    let mut long = bytes(Compression::None);
    long.push(0);
    assert!(matches!(read(&long), Err(ReadError::Corrupt { .. })));
    assert!(matches!(read(b"%PDF-1.7 something else entirely"), Err(ReadError::NotMcap { .. })));
    assert!(matches!(read(b""), Err(ReadError::NotMcap { .. })));
}

/// A file as another program writes it: JSON messages, its own chunking, no metadata.
fn foreign(topics: &[(&str, &str, &str, &[u8])], metadata: &[(&str, BTreeMap<String, String>)]) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let mut writer = mcap::WriteOptions::new().library("elsewhere").chunk_size(Some(64)).create(&mut file).unwrap();
    for (name, map) in metadata {
        writer.write_metadata(&mcap::records::Metadata { name: (*name).into(), metadata: map.clone() }).unwrap();
    }
    for (k, (topic, schema, encoding, payload)) in topics.iter().enumerate() {
        let schema = writer.add_schema(schema, "jsonschema", b"{}").unwrap();
        let channel = writer.add_channel(schema, topic, encoding, &BTreeMap::new()).unwrap();
        let header =
            mcap::records::MessageHeader { channel_id: channel, sequence: k as u32, log_time: 0, publish_time: 0 };
        writer.write_to_known_channel(&header, payload).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    file.into_inner()
}

#[test]
fn the_version_before_of_a_record_is_read_in_both_encodings() {
    let metric = MetricV1 { name: "olc".into(), value: Some(290.0), ..MetricV1::default() };
    let earlier = MetricsV1(vec![metric.clone()]);
    for codec in [Codec::Json, Codec::Bincode] {
        let payload = codec.encode(&earlier).unwrap();
        let artifact = read(&foreign(&[("/metrics", MetricsV1::SCHEMA, codec.name(), &payload)], &[])).unwrap();
        let now: MetricsV2 = artifact.record("/metrics").unwrap().unwrap();
        assert_eq!(now, MetricsV2 { metrics: vec![metric.clone()] });
        assert_eq!(artifact.record::<MetricsV1>("/metrics").unwrap().unwrap(), earlier);
    }
    // the other way round is another program's concern: it says that it is too old
    let now = Codec::Json.encode(&MetricsV2 { metrics: vec![metric] }).unwrap();
    let artifact = read(&foreign(&[("/metrics", MetricsV2::SCHEMA, "json", &now)], &[])).unwrap();
    assert!(matches!(artifact.record::<MetricsV1>("/metrics"), Err(ReadError::Newer { .. })));
}

#[test]
fn json_waves_and_bincode_records_of_other_programs_are_read() {
    let notes = NotesV1 { stage: "python".into(), notes: vec!["hello".into()] };
    let artifact = read(&foreign(
        &[
            ("/notes", NotesV1::SCHEMA, "bincode", &Codec::Bincode.encode(&notes).unwrap()),
            ("/wave/a/velocity", WaveBlockV1::SCHEMA, "json", br#"{"t0_ns":0,"dt_s":0.5,"first":0,"samples":[1,2.5]}"#),
            ("/wave/a/velocity", WaveBlockV1::SCHEMA, "json", br#"{"t0_ns":0,"dt_s":0.5,"first":2,"samples":[4]}"#),
        ],
        &[],
    ))
    .unwrap();
    assert_eq!(artifact.record::<NotesV1>("/notes").unwrap().unwrap(), notes);
    let wave = &artifact.waves()["a/velocity"];
    assert_eq!(wave.sampled.samples(), [1.0, 2.5, 4.0]);
    assert_eq!(wave.quantity, QuantityKind::Velocity, "taken from the id");
    assert_eq!(artifact.provenance(), None);
}

#[test]
fn foreign_newer_wrong_and_unreadable_content_is_told_apart() {
    let imu = foreign(&[("/imu", "sensor_msgs/Imu", "ros1", b"x")], &[]);
    insta::assert_snapshot!(read(&imu).unwrap_err(), @"x.mcap: an MCAP file, but not of this kind: none of its 1 \
        channels has a schema named crumple.*, e.g. topic /imu has \"sensor_msgs/Imu\"");

    let later = foreign(&[("/events", "crumple.Events.v2", "json", b"{}")], &[]);
    let error = read(&later).unwrap().record::<EventsV1>("/events").unwrap_err();
    insta::assert_snapshot!(error, @"x.mcap: the record type of topic /events is crumple.Events.v2, this version reads \
        up to crumple.Events.v1");

    let later = foreign(
        &[("/wave/a", "crumple.WaveBlock.v2", "json", b"{}"), ("/wave/a", "crumple.WaveBlock.v2", "json", b"{}")],
        &[],
    );
    insta::assert_snapshot!(read(&later).unwrap_err(), @"x.mcap: the record type of topic /wave/a is \
        crumple.WaveBlock.v2, this version reads up to crumple.WaveBlock.v1");

    let format = BTreeMap::from([("format".to_owned(), "2".to_owned())]);
    let future = foreign(&[("/notes", NotesV1::SCHEMA, "json", b"{}")], &[("provenance", format)]);
    insta::assert_snapshot!(read(&future).unwrap_err(), @"x.mcap: the artifact format is 2, this version reads up to \
        1");

    let wrong = foreign(&[("/events", NotesV1::SCHEMA, "json", b"{}")], &[]);
    let error = read(&wrong).unwrap().record::<EventsV1>("/events").unwrap_err();
    insta::assert_snapshot!(error, @"x.mcap: topic /events holds crumple.Notes.v1, crumple.Events.v1 is needed");

    let cbor = foreign(&[("/notes", NotesV1::SCHEMA, "cbor", b"\xa0")], &[]);
    let error = read(&cbor).unwrap().record::<NotesV1>("/notes").unwrap_err();
    insta::assert_snapshot!(error, @r#"x.mcap: topic /notes: encoding "cbor" is not read, json or bincode is needed"#);

    let short = foreign(&[("/notes", NotesV1::SCHEMA, "json", br#"{"stage":"x"}"#)], &[]);
    let error = read(&short).unwrap().record::<NotesV1>("/notes").unwrap_err();
    insta::assert_snapshot!(error, @"x.mcap: topic /notes: JSON: missing field `notes` at line 1 column 13");

    let twice = foreign(&[("/notes", NotesV1::SCHEMA, "json", b"{}"), ("/notes", NotesV1::SCHEMA, "json", b"{}")], &[]);
    insta::assert_snapshot!(read(&twice).unwrap_err(), @"x.mcap: topic /notes: two messages, a record is one message");
}

#[test]
fn a_stated_digest_that_is_not_that_of_the_messages_is_refused() {
    let notes = [("/notes", NotesV1::SCHEMA, "json", br#"{"stage":"python","notes":[]}"#.as_slice())];
    let stating = |digest: &str| {
        let content = BTreeMap::from([("digest".to_owned(), digest.to_owned())]);
        read(&foreign(&notes, &[("content", content)]))
    };
    let digest = read(&foreign(&notes, &[])).unwrap().digest().to_owned();
    assert_eq!(stating(&digest).unwrap().digest(), digest);
    let error = stating("blake3:00").unwrap_err().to_string();
    let expected =
        format!("x.mcap: corrupted: metadata record \"content\": it states blake3:00, the messages give {digest}");
    assert_eq!(error, expected);
}

#[test]
fn a_start_that_nanoseconds_do_not_reach_is_not_written() {
    let start_at = |t0_s: f64| {
        let wave = Sampled::new(t0_s, 1e-4, vec![1.0; 3]).unwrap();
        ArtifactBuilder::new().wave("93", QuantityKind::Acceleration, wave).map_err(|error| error.to_string())
    };
    assert_eq!(start_at(-9.1e9), Ok(()));
    for t0_s in [1e300, -1e10] {
        assert!(start_at(t0_s).unwrap_err().contains("times go from -292 to 292 years"));
    }
}

#[test]
fn a_nan_is_neither_written_nor_read() {
    let mut builder = ArtifactBuilder::new();
    let metric = MetricV1 {
        name: "peak".into(),
        value: Some(f64::NAN),
        unit: "1".into(),
        channel: "93".into(),
        ..MetricV1::default()
    };
    let error = builder.put("/metrics", &MetricsV2 { metrics: vec![metric.clone()] }).unwrap_err();
    insta::assert_snapshot!(error, @"record /metrics: metrics[0].value is NaN, a finite number is needed");

    let payload = Codec::Bincode.encode(&MetricsV2 { metrics: vec![metric] }).unwrap();
    let error = read(&foreign(&[("/metrics", MetricsV2::SCHEMA, "bincode", &payload)], &[]))
        .unwrap()
        .record::<MetricsV2>("/metrics")
        .unwrap_err();
    insta::assert_snapshot!(error, @"x.mcap: topic /metrics: metrics[0].value is NaN, a finite number is needed");

    let block = WaveBlockV1 { t0_ns: 0, dt_s: 1.0, first: 0, samples: vec![0.0, f64::INFINITY] };
    let payload = Codec::Bincode.encode(&block).unwrap();
    let error = read(&foreign(&[("/wave/a", WaveBlockV1::SCHEMA, "bincode", &payload)], &[])).unwrap_err();
    insta::assert_snapshot!(error, @"x.mcap: topic /wave/a: sample 1 (t = 1.000000 s) is inf, a finite number is \
        needed");
}

#[test]
fn what_is_read_is_told_to_the_byte() {
    let file = tempfile::NamedTempFile::new().unwrap();
    let bytes = bytes(Compression::None);
    std::fs::write(file.path(), &bytes).unwrap();
    let mut bytes_read = 0;
    let artifact = Artifact::open_reporting(file.path(), &mut |read| bytes_read += read).unwrap();
    assert_eq!((bytes_read, artifact.stage()), (bytes.len() as u64, Some("filter")));
    let missing = file.path().with_extension("none");
    assert!(Artifact::open_reporting(&missing, &mut |_| panic!("nothing is there")).is_err());
}
