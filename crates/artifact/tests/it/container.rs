//! What stands in the container of an artifact, by another reader and another digest than those of this crate; and
//! containers as other programs write them.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;

use crumple_artifact::records::{NotesV1, WaveBlockV1};
use crumple_artifact::{Artifact, ArtifactBuilder, Compression, InputDigest, Provenance, ReadError, Record};
use crumple_signal::{QuantityKind, Sampled};

const START_S: f64 = -0.02;

fn provenance() -> Provenance {
    let input = InputDigest { kind: "ingest".into(), digest: "blake3:00".into() };
    Provenance::new("filter", "0.1.0", r#"{"cfc":60}"#.into(), vec![input])
}

/// An artifact of two notes and a waveform of two blocks.
fn written(provenance: &Provenance) -> Vec<u8> {
    let mut builder = ArtifactBuilder::new();
    for topic in ["/notes", "/notes/more"] {
        builder.put(topic, &NotesV1 { stage: "filter".into(), notes: vec!["zero level 0.01".into()] }).unwrap();
    }
    let samples = (0..70_000).map(|k| f64::from(k).sin()).collect();
    builder.wave("93", QuantityKind::Acceleration, Sampled::new(START_S, 1e-4, samples).unwrap()).unwrap();
    let mut file = Cursor::new(Vec::new());
    builder.write_to(&mut file, provenance, Compression::None).unwrap();
    file.into_inner()
}

fn read(bytes: &[u8]) -> Result<Artifact, ReadError> {
    Artifact::read(Path::new("x.mcap"), bytes)
}

/// The metadata record of this name.
fn metadata(bytes: &[u8], name: &str) -> BTreeMap<String, String> {
    let records = mcap::read::LinearReader::new(bytes).unwrap();
    let of_name = records.filter_map(|record| match record.unwrap() {
        mcap::records::Record::Metadata(metadata) if metadata.name == name => Some(metadata.metadata),
        _ => None,
    });
    of_name.last().unwrap_or_default()
}

/// The digest, the number of messages and the log times are those that docs/format.md states.
#[test]
fn digest_count_and_times_are_as_the_format_says() {
    let bytes = written(&provenance());
    let mut fed = Vec::new();
    let mut times = Vec::new();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let schema = message.channel.schema.as_ref().unwrap();
        for part in [&message.channel.topic, &schema.name, &message.channel.message_encoding] {
            fed.extend((part.len() as u64).to_le_bytes());
            fed.extend(part.as_bytes());
        }
        fed.extend(message.log_time.to_le_bytes());
        fed.extend((message.data.len() as u64).to_le_bytes());
        fed.extend(&*message.data);
        times.push((message.channel.topic.clone(), message.log_time));
    }
    let digest = format!("blake3:{}", blake3::hash(&fed).to_hex());
    assert_eq!(crumple_artifact::blake3_text(&fed), digest);
    assert_eq!(read(&bytes).unwrap().digest(), digest);
    let content = metadata(&bytes, "content");
    assert_eq!((content["digest"].as_str(), content["messages"].as_str()), (digest.as_str(), "4"));
    let origin: u64 = content["time.t0_offset_ns"].parse().unwrap();
    let start = origin - 20_000_000;
    let second_block = start + 65_536 * 100_000;
    let expected = [("/notes", start), ("/notes/more", start), ("/wave/93", start), ("/wave/93", second_block)];
    assert_eq!(times, expected.map(|(topic, time)| (topic.to_owned(), time)));
}

#[test]
fn who_made_it_of_which_sources_is_stated_and_read_back() {
    let plain = provenance();
    let built = provenance().with_build("blake3:aa");
    let packed = built.clone().made_by("crumple-artifact pack");
    let stated = |provenance: &Provenance| {
        let bytes = written(provenance);
        assert_eq!(read(&bytes).unwrap().provenance(), Some(provenance));
        let map = metadata(&bytes, "provenance");
        (map.get("build").cloned(), map.get("made_by").cloned())
    };
    assert_eq!(stated(&plain), (None, None));
    assert_eq!(stated(&built), (Some("blake3:aa".to_owned()), None));
    assert_eq!(stated(&packed), (None, Some("crumple-artifact pack".to_owned())));
}

const NOTES: &[u8] = br#"{"stage":"python","notes":["a"]}"#;
const BLOCK: &[u8] = br#"{"t0_ns":0,"dt_s":0.5,"first":0,"samples":[1,2.5]}"#;

/// A file of another writer: notes and a wave, in chunks or without, and what `more` adds.
fn by_another_writer(chunks: bool, more: impl FnOnce(&mut mcap::Writer<&mut Cursor<Vec<u8>>>)) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let mut writer = mcap::WriteOptions::new().use_chunks(chunks).create(&mut file).unwrap();
    for (topic, schema, payload) in
        [("/notes", NotesV1::SCHEMA, NOTES), ("/wave/a/velocity", WaveBlockV1::SCHEMA, BLOCK)]
    {
        let schema = writer.add_schema(schema, "jsonschema", b"{}").unwrap();
        let channel = writer.add_channel(schema, topic, "json", &BTreeMap::new()).unwrap();
        let header = mcap::records::MessageHeader { channel_id: channel, sequence: 0, log_time: 7, publish_time: 7 };
        writer.write_to_known_channel(&header, payload).unwrap();
    }
    more(&mut writer);
    writer.finish().unwrap();
    drop(writer);
    file.into_inner()
}

#[test]
fn a_file_without_chunks_is_read_like_one_with() {
    let read = [true, false].map(|chunks| {
        let artifact = read(&by_another_writer(chunks, |_| ())).unwrap();
        let notes: NotesV1 = artifact.record("/notes").unwrap().unwrap();
        assert_eq!(notes.notes, ["a"]);
        assert_eq!(artifact.waves()["a/velocity"].sampled.samples(), [1.0, 2.5]);
        artifact
    });
    assert_eq!(read[0].digest(), read[1].digest());
}

#[test]
fn private_records_of_other_programs_are_passed_over_and_codes_of_no_record_are_damage() {
    let with = |code: u8| {
        let record = move |writer: &mut mcap::Writer<&mut Cursor<Vec<u8>>>| {
            writer.write_private_record(code, b"mine", Default::default()).unwrap();
        };
        by_another_writer(false, record)
    };
    let private = with(0x80);
    assert_eq!(read(&private).unwrap().records().len(), 1);
    // The same record with a code that the container's specification has not given away.
    let at = private.windows(4).position(|bytes| bytes == b"mine").unwrap() - 9;
    assert_eq!(private[at], 0x80);
    for code in [0x10, 0x7f] {
        let mut damaged = private.clone();
        damaged[at] = code;
        // without the checksum of the data section, 0: not stated
        let end = damaged.windows(9).position(|bytes| bytes == [0x0f, 4, 0, 0, 0, 0, 0, 0, 0]).unwrap();
        damaged[end + 9..end + 13].fill(0);
        let error = read(&damaged).unwrap_err().to_string();
        assert!(error.ends_with(&format!("{code:#04x} is no MCAP record")), "{error}");
        assert!(error.contains(&format!("unknown record at byte {at}")), "{error}");
    }
}

#[test]
fn other_metadata_is_neither_provenance_nor_content() {
    let stating = |name: &str| {
        let map = BTreeMap::from([("stage".to_owned(), "python".to_owned()), ("digest".to_owned(), "x".to_owned())]);
        let metadata = mcap::records::Metadata { name: name.to_owned(), metadata: map };
        read(&by_another_writer(true, |writer| writer.write_metadata(&metadata).unwrap()))
    };
    assert_eq!(stating("calibration").unwrap().provenance(), None);
    assert_eq!(stating("provenance").unwrap().stage(), Some("python"));
    assert!(matches!(stating("content"), Err(ReadError::Corrupt { .. })));
}
