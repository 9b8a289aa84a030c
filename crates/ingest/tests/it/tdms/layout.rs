//! Byte orders, segments, interleaving, damage.

use crumple_signal::{QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G};

use crate::tdms::scaling::daqmx;
use crate::tdms::writer::{
    BIG, DAQMX, INTERLEAVED, NEW_LIST, RAW, Value, Writer, accelerometer, has_note, pulse, read, samples, segment,
    simple, waveform,
};

#[test]
fn both_byte_orders_read_alike() {
    let (little, big) = (read(simple(60, false)).unwrap(), read(simple(60, true)).unwrap());
    let wave = little.channels[0].wave.as_ref().unwrap();
    assert_eq!((wave.t0_s(), wave.dt_s(), wave.samples()[59]), (-0.01, 1e-4, pulse(59) * G));
    assert_eq!(little.channels[0].wave, big.channels[0].wave);
    assert_eq!(little.details.title.unwrap().value, "a test");
    assert_eq!(little.channels[0].channel.id, "g.acc");
}

#[test]
fn segments_inherit_objects_chunks_and_properties() {
    let mut metadata = Writer::new(false);
    metadata.object("/'g'/'a'", Some((10, 2)), &accelerometer()).object("/'g'/'none'", Some((10, 0)), &[]).object(
        "/'g'/'b'",
        Some((3, 1)),
        &waveform(),
    );
    let chunk = |start: usize| {
        let mut raw = Writer::new(false);
        raw.doubles([start as f64, start as f64 + 1.0]).u32(7);
        raw.bytes
    };
    // Two chunks in one segment, one in the next, which says nothing at all; then `a` alone under a new list.
    let mut file = segment(NEW_LIST | RAW, 3, &metadata, &[chunk(0), chunk(2)].concat());
    file.extend(segment(RAW, 0, &metadata, &chunk(4)));
    let mut again = Writer::new(false);
    again.text("/'g'/'a'").u32(0).u32(0);
    let mut raw = Writer::new(false);
    raw.doubles([6.0, 7.0]);
    file.extend(segment(NEW_LIST | RAW, 1, &again, &raw.bytes));
    // An old list in which `b` has no data now, and a new property.
    let mut last = Writer::new(false);
    last.object("/'g'/'b'", None, &[("unit_string", Value::Text("V"))]);
    raw.bytes.clear();
    raw.doubles([8.0, 9.0]);
    file.extend(segment(2 | RAW, 1, &last, &raw.bytes));
    let recording = read(file).unwrap();
    let expected: Vec<f64> = (0..10).map(|k| f64::from(k) * G).collect();
    assert_eq!(samples(&recording.channels[0]), expected);
    assert_eq!(samples(&recording.channels[1]), [7.0, 7.0, 7.0]);
    assert_eq!(recording.channels[1].channel.quantity, QuantityKind::Voltage);
    has_note(&recording, "no samples in g.none");
}

#[test]
fn interleaved_samples_of_different_types() {
    for big in [false, true] {
        let mut metadata = Writer::new(big);
        metadata
            .object("/'g'/'a'", Some((10, 30)), &accelerometer())
            .object("/'g'/'b'", Some((2, 30)), &waveform())
            .object("/'g'/'c'", Some((9, 30)), &waveform());
        let mut raw = Writer::new(big);
        for k in 0..60_i16 {
            raw.doubles([f64::from(k)]).put((-k).to_le_bytes()).put((f32::from(k) * 0.5).to_le_bytes());
        }
        let toc = NEW_LIST | RAW | INTERLEAVED | if big { BIG } else { 0 };
        let recording = read(segment(toc, 3, &metadata, &raw.bytes)).unwrap();
        for (found, factor) in recording.channels.iter().zip([G, -1.0, 0.5]) {
            let expected: Vec<f64> = (0..60).map(|k| f64::from(k) * factor).collect();
            assert_eq!(samples(found), expected);
        }
    }
}

#[test]
fn an_aborted_recording_is_read_as_far_as_it_goes() {
    let whole = simple(60, false);
    for (cut, length) in [(0, u64::MAX), (20, u64::MAX), (20, 0)] {
        let mut file = whole[..whole.len() - cut].to_vec();
        if length != 0 {
            file[12..20].copy_from_slice(&length.to_le_bytes());
        }
        let recording = read(file).unwrap();
        // 20 bytes are two samples and a half.
        assert_eq!(samples(&recording.channels[0]).len(), if cut == 0 { 60 } else { 57 });
        has_note(&recording, "the recording was aborted, it is read as far as it goes");
    }
    // A second segment that was only begun.
    for rest in 1..28 {
        let recording = read([&whole[..], &whole[..rest]].concat()).unwrap();
        assert_eq!(samples(&recording.channels[0]).len(), 60);
        has_note(&recording, "no whole segment");
    }
    let mut begun = whole[..100].to_vec();
    begun[12..20].copy_from_slice(&u64::MAX.to_le_bytes());
    assert_eq!(samples(&read([whole, begun].concat()).unwrap().channels[0]).len(), 60);
}

#[test]
fn damage_is_refused_at_its_byte() {
    let whole = simple(60, false);
    let refused = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut file = whole.clone();
        change(&mut file);
        read(file).unwrap_err().to_string()
    };
    let text = refused(&|f| f.extend([b'x'; 40]));
    assert_eq!(text, format!("t.tdms: at byte {}: no segment starts here (no TDSm)", whole.len()));
    assert_eq!(refused(&|f| f[8] = 9), "t.tdms: at byte 8: version 4617 of TDMS, 4712 and 4713 are known");
    // Object count.
    assert!(refused(&|f| f[31] = 0x7F).contains("at byte"));
    assert!(refused(&|f| f.truncate(40)).contains("at byte"));
    let empty = segment(NEW_LIST, 1, Writer::new(false).object("/", None, &[]), &[]);
    assert!(read(empty).unwrap_err().to_string().contains("no channel has samples"));
}

#[test]
fn absurd_counts_cost_nothing() {
    // 2^60 samples of 8 bytes overflow; 2^40 just end with the file.
    for count in [1_u64 << 60, 1 << 62, u64::MAX, 1 << 40] {
        let mut metadata = Writer::new(false);
        metadata.object("/'g'/'a'", Some((10, count)), &accelerometer());
        let mut raw = Writer::new(false);
        raw.doubles([0.0; 60]);
        match read(segment(NEW_LIST | RAW, 1, &metadata, &raw.bytes)) {
            Ok(recording) => assert_eq!(samples(&recording.channels[0]).len(), 60),
            Err(error) => assert!(error.to_string().contains("an impossible count"), "{error}"),
        }
    }
    let mut texts = Writer::new(false);
    texts.text("/'g'/'t'").u32(28).u32(0x20).u32(1).u64(u64::MAX).u64(0).u32(0);
    assert!(read(segment(NEW_LIST | RAW, 1, &texts, b"abc")).is_err());
    // 20 000 channels that share the 2 bytes of each of 100 000 rows would be 2·10^9 samples.
    let mut shared_rows = Writer::new(false);
    for k in 0..20_000 {
        daqmx(&mut shared_rows, &format!("/'g'/'{k}'"), 100_000, 0, 2, &[]);
    }
    let error = read(segment(NEW_LIST | RAW | DAQMX, 20_000, &shared_rows, &vec![0; 200_000])).unwrap_err();
    assert!(error.to_string().contains("million samples"), "{error}");
}
