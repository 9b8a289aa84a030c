//! TDM and TDX: the real pair, and pairs written here for what it lacks.

use std::fs;

use crumple_ingest::{Bundle, IngestError, IngestSettings, Recording};
use crumple_signal::{QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G};
use crumple_testkit::shared;

use crate::{grid, has_note, samples, write, zipped};

fn read(tdm: impl AsRef<[u8]>, tdx: &[u8]) -> Result<Recording, IngestError> {
    let mut bundle = Bundle::from_bytes("t.TDM", tdm.as_ref().to_vec())?;
    bundle.companions.insert("t.tdx".to_owned(), tdx.to_vec());
    bundle.read(&IngestSettings::default())
}

/// Acceptance 7: eight sequences of 500, one of them the times of the others.
#[test]
fn corridors_are_eight_sequences_of_500() {
    let Some(path) = shared("data/iihs-diadem-tdms/Corridors.TDM") else { return };
    let bundle = Bundle::open(&path).unwrap();
    assert_eq!(bundle.companions.keys().collect::<Vec<_>>(), ["Corridors.tdx"]);
    let recording = bundle.read(&IngestSettings::default()).unwrap();
    assert_eq!(recording.channels.len(), 7);
    for found in &recording.channels {
        let wave = found.wave.as_ref().unwrap();
        assert_eq!((wave.len(), wave.t0_s(), wave.dt_s()), (500, 0.0, 1e-4));
    }
    has_note(&recording, "Time is the time axis of the other channels");
    let femur = &recording.channels[0];
    assert_eq!((femur.channel.id.as_str(), femur.channel.quantity), ("Corridors.Femur_Good", QuantityKind::Other));
    // Extremes as the header states them.
    let extremes = samples(femur).iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
    assert_eq!(extremes, (6048.0, 7256.0));
    assert_eq!(recording.details.title.as_ref().unwrap().value, "2012 Dodge Avenger");
    assert_eq!(recording.details.vehicle.as_ref().unwrap().value, "2012 Dodge Avenger");
    assert!(recording.details.facts.contains(&"Impact_velocity: 64.3".to_owned()), "{:?}", recording.details.facts);
}

/// Acceptance 7: the binary file in any case; without it a refusal that names both.
#[test]
fn the_binary_file_is_found_in_any_case_and_missed_by_name() {
    let Some(folder) = shared("data/iihs-diadem-tdms") else { return };
    let (tdm, tdx) = (fs::read(folder.join("Corridors.TDM")).unwrap(), fs::read(folder.join("Corridors.tdx")).unwrap());
    let read = |files: &[(&str, &[u8])]| {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), files);
        Bundle::open(&folder.path().join(files[0].0))?.read(&IngestSettings::default())
    };
    for name in ["Corridors.tdx", "corridors.TDX", "CORRIDORS.Tdx"] {
        let recording = read(&[("Corridors.TDM", &tdm), (name, &tdx), ("other.tdx", b"not this")]);
        assert_eq!(recording.unwrap().channels.len(), 7, "{name}");
    }
    let error = read(&[("renamed.tdm", &tdm)]).unwrap_err();
    assert_eq!(error.to_string(), "renamed.tdm: a TDM header without its samples: Corridors.tdx is not beside it");
    assert!(error.hint().contains("copy Corridors.tdx into the same folder"), "{}", error.hint());
    let renamed = |tdx: &[u8]| read(&[("renamed.tdm", &tdm), ("renamed.tdx", tdx)]).unwrap();
    has_note(&renamed(&tdx), "names Corridors.tdx as its file of samples");
    let cut = "its block, 500 samples of 8 bytes from byte 28000 on, is not in renamed.tdx of 31999 bytes";
    has_note(&renamed(&tdx[..31_999]), cut);
}

#[test]
fn an_archive_may_hold_a_pair_or_one_tdms_file() {
    let all = header("littleEndian", &[("a", "g", "explicit", "eFloat64Usi", 0, 60)]);
    let folder = tempfile::tempdir().unwrap();
    let zip = |files: &[(&str, &[u8])]| {
        write(folder.path(), &[("t.zip", zipped(files))]);
        Bundle::open(&folder.path().join("t.zip"))
    };
    let bundle = zip(&[("x/t.TDM", all.as_bytes()), ("x/T.TDX", &[0; 480]), ("x/readme.txt", b"words")]).unwrap();
    assert_eq!(bundle.read(&IngestSettings::default()).unwrap().channels.len(), 1);
    assert_eq!(zip(&[("x/a.tdms", b"TDSm"), ("x/a.tdms_index", b"TDSh")]).unwrap().reader.format, "tdms");
    let error = zip(&[("a.tdms", b"TDSm"), ("b.tdms", b"TDSm")]).err().unwrap();
    assert!(error.to_string().contains("2 records in one archive: a.tdms, b.tdms"), "{error}");
}

/// A header with a channel for each `(name, unit, representation, valueType, offset, length)`.
fn header(byte_order: &str, channels: &[(&str, &str, &str, &str, u64, u64)]) -> String {
    let mut blocks = String::new();
    let mut data = String::new();
    let mut ids = String::new();
    for (k, (name, unit, representation, kind, offset, length)) in channels.iter().enumerate() {
        blocks.push_str(&format!(
            "<block byteOffset=\"{offset}\" id=\"inc{k}\" length=\"{length}\" valueType=\"{kind}\"/>"
        ));
        data.push_str(&format!(
            "<double_sequence id=\"s{k}\"><values external=\"inc{k}\"/></double_sequence>\
             <tdm_channel id=\"c{k}\"><name>{name}</name><unit_string>{unit}</unit_string><instance_attributes>\
             <double_attribute name=\"wf_increment\">0.0001</double_attribute>\
             <double_attribute name=\"wf_start_offset\">-0.001</double_attribute></instance_attributes>\
             <local_columns>#xpointer(id(\"l{k}\"))</local_columns></tdm_channel>\
             <localcolumn id=\"l{k}\"><sequence_representation>{representation}</sequence_representation>\
             <values>#xpointer(id(\"s{k}\"))</values></localcolumn>"
        ));
        ids.push_str(&format!(" id(\"c{k}\")"));
    }
    format!(
        "<?xml version=\"1.0\"?>\n<usi:tdm xmlns:usi=\"http://www.ni.com/Schemas/USI/1_0\"><usi:include>\
         <file byteOrder=\"{byte_order}\" url=\"T.TDX\">{blocks}</file></usi:include><usi:data>\
         <tdm_root id=\"r\"><name>n</name></tdm_root><tdm_channelgroup id=\"g\"><name>G</name>\
         <channels>#xpointer({ids})</channels></tdm_channelgroup>{data}</usi:data></usi:tdm>"
    )
}

#[test]
fn types_and_byte_orders() {
    let all = header(
        "bigEndian",
        &[
            ("a", "g", "explicit", "eFloat64Usi", 0, 60),
            ("b", "V", "explicit", "eFloat32Usi", 480, 60),
            ("c", "N", "explicit", "eInt16Usi", 720, 60),
        ],
    );
    let mut tdx: Vec<u8> = (0..60_i16).flat_map(|k| f64::from(k).to_be_bytes()).collect();
    tdx.extend((0..60_i16).flat_map(|k| f32::from(-k).to_be_bytes()));
    tdx.extend((0..60_i16).flat_map(|k| (2 * k).to_be_bytes()));
    let recording = read(&all, &tdx).unwrap();
    for (found, factor) in recording.channels.iter().zip([G, -1.0, 2.0]) {
        assert_eq!(samples(found), (0..60).map(|k| f64::from(k) * factor).collect::<Vec<f64>>());
        assert_eq!(found.wave.as_ref().unwrap().t0_s(), -0.001);
    }
    assert_eq!(recording.channels[0].channel.id, "G.a");
}

/// The cases of other people's files: a channel of times beside an increment of 1, an implicit one, raw counts.
#[test]
fn channels_of_times_are_read_in_every_representation() {
    for (file, t0_s, dt_s) in [
        ("F02-time-channel-dropped/stamps.tdm", 0.0, 2.5e-4),
        ("F02-time-channel-dropped/seconds.tdm", 0.0, 2.5e-4),
        ("N07-tdm-implicit-time/implicit.tdm", -0.05, 2e-4),
        ("N08-tdm-raw-linear/counts.tdm", -0.05, 2e-4),
    ] {
        let Some(path) = shared(&format!("reference/cases/{file}")) else { return };
        let bundle = Bundle::open(&path).unwrap();
        let recording = bundle.read(&IngestSettings::default()).unwrap();
        assert_eq!((recording.channels.len(), grid(&recording.channels[0])), (1, (t0_s, dt_s)), "{file}");
        let peak = samples(&recording.channels[0]).iter().fold(0.0_f64, |most, a| most.max(a.abs())) / G;
        // Noise of 0.05 g, and counts of 0.005 g.
        assert!((peak - 24.47).abs() < 0.5, "{file}: {peak} g");
    }
}

/// Names of attributes are compared each with each: 100,000 of one tag took 17 s.
#[test]
fn a_tag_of_countless_attributes_is_refused_at_once() {
    let attributes: String = (0..100_000).map(|k| format!(" a{k}=\"1\"")).collect();
    let start = std::time::Instant::now();
    let error = read(format!("<?xml version=\"1.0\"?><usi:tdm xmlns:usi=\"x\"{attributes}/>"), &[]).unwrap_err();
    assert!(error.to_string().contains("a tag of 1"), "{error}");
    assert!(start.elapsed().as_secs() < 5);
}

#[test]
fn what_is_not_read_is_named() {
    let tdx = vec![0; 480];
    let good = ("a", "g", "explicit", "eFloat64Usi", 0, 60);
    for (bad, words) in [
        (("b", "g", "raw_polynomial", "eInt16Usi", 0, 60), "represented as raw_polynomial, only explicit"),
        (("b", "g", "explicit", "eStringUsi", 0, 60), "of type eStringUsi, only real numbers and times are read"),
        (("b", "g", "explicit", "eFloat64Usi", 8, 60), "from byte 8 on, is not in t.tdx of 480 bytes"),
        (("b", "g", "explicit", "eFloat64Usi", u64::MAX, u64::MAX), "is not in t.tdx of 480 bytes"),
    ] {
        let recording = read(header("littleEndian", &[good, bad]), &tdx).unwrap();
        assert_eq!(recording.channels.len(), 1);
        has_note(&recording, words);
    }
    let error = |text: String| read(text, &tdx).unwrap_err().to_string();
    assert!(error(header("middleEndian", &[good])).contains("byte order \"middleEndian\""));
    assert!(error(header("littleEndian", &[])).contains("no channel has samples"));
    assert!(error(header("littleEndian", &[good]).replace("</usi:data>", "")).starts_with("t.TDM: "));
    let bomb = "<!DOCTYPE x [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;\">]><usi:tdm xmlns:usi=\"u\">&b;</usi:tdm>";
    assert!(error(bomb.to_owned()).contains("DTD"), "{}", error(bomb.to_owned()));
    // Deep nesting must not exhaust the stack.
    let deep = format!("<usi:tdm xmlns:usi=\"u\">{}", "<a>".repeat(300_000));
    assert!(read(deep, &tdx).is_err());
}

/// A pair whose mutations must not panic.
pub fn example() -> (String, Vec<u8>) {
    (header("littleEndian", &[("a", "g", "explicit", "eFloat64Usi", 0, 60)]), vec![0; 480])
}
