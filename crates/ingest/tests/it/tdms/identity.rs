//! What names and properties say of a channel.

use crumple_ingest::{Bundle, IngestSettings, ingest};
use crumple_signal::{Axis, ChannelStatus, QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G};

use crate::tdms::writer::{NEW_LIST, RAW, Value, Writer, accelerometer, pulse, read, samples, segment, waveform};

/// A crash test as the NHTSA database describes it: 16-character codes, EV5 fields as properties.
pub fn nhtsa() -> Vec<u8> {
    let of = |place: &'static str, comment: &'static str, status: &'static str| {
        // 30 ms before contact.
        let mut properties = vec![("wf_increment", Value::Double(1e-4)), ("wf_start_offset", Value::Double(-0.03))];
        properties.extend([
            ("INST_VEHNO", Value::Text("1")),
            ("INST_CURNO", Value::Text("93")),
            ("INST_SENTYP", Value::Text("AC")),
            ("INST_SENLOC", Value::Text("NA")),
            ("INST_SENATT", Value::Text(place)),
            ("INST_AXIS", Value::Text("XG")),
            ("INST_YUNITS", Value::Text("G'S")),
            ("INST_INIVEL", Value::Text("57.09")),
            ("INST_DASTAT", Value::Text(status)),
            ("INST_INSCOM", Value::Text(comment)),
            ("VEH_VEHTWT", Value::Text("1719")),
            ("VEH_VEHSPD", Value::Double(57.09)),
            ("TEST_TITLE", Value::Text("NCAP - 2018 TOYOTA CAMRY")),
            ("TEST_CLSSPD", Value::Double(57.09)),
            ("TEST_TSTCFN", Value::Text("VTB")),
        ]);
        properties
    };
    let mut metadata = Writer::new(false);
    metadata.object("/'d'/'10ENGN000000AC1P'", Some((10, 600)), &of("ENGN", "TOP OF ENGINE X", "CF")).object(
        "/'d'/'10FORALERE00AC1P'",
        Some((10, 600)),
        &of("FLLR", "LEFT REAR SEAT CROSSMEMBER X", "AM"),
    );
    let mut raw = Writer::new(false);
    let at = |k: usize| match k {
        0..20 => 0.0,
        20..300 => 0.1,
        _ => pulse(k),
    };
    raw.doubles([1.0; 600]).doubles((0..600).map(at));
    segment(NEW_LIST | RAW, 2, &metadata, &raw.bytes)
}

#[test]
fn nhtsa_properties_give_mass_speed_and_the_pulse() {
    let ingested = ingest(&Bundle::from_bytes("v10146.tdms", nhtsa()).unwrap(), &IngestSettings::default()).unwrap();
    let test = &ingested.test;
    assert_eq!((test.mass_kg, test.impact_speed_m_per_s), (Some(1719.0), Some(57.09 / 3.6)));
    assert_eq!(test.title, "NCAP - 2018 TOYOTA CAMRY");
    assert_eq!(test.pulse.as_deref(), Some("d.10FORALERE00AC1P"));
    let pulse = test.channel("d.10FORALERE00AC1P").unwrap();
    assert_eq!(pulse.location, "vehicle, left rear seat crossmember");
    assert_eq!((pulse.axis, pulse.quantity), (Some(Axis::X), QuantityKind::Acceleration));
    assert_eq!(pulse.initial_velocity_m_per_s, Some(57.09 / 3.6));
    assert_eq!(test.channel("d.10ENGN000000AC1P").unwrap().status, ChannelStatus::Questionable);
    let before = ingested.pulse().unwrap().quality.pre_event.unwrap();
    assert!((before.zero_level - 0.1 * G).abs() < 1e-12, "the muted start is not counted");
    let notes = ingested.notes.to_texts();
    for words in ["the first 20 samples of the pulse are exactly 0", "TOP OF ENGINE X"] {
        assert!(notes.iter().any(|n| n.contains(words)), "{words}: {notes:#?}");
    }
}

#[test]
fn a_channel_named_by_its_code_is_what_the_code_says() {
    let mut metadata = Writer::new(false);
    metadata
        .object("/'R'/'10VEHC0000__ACXD_NoName1'", Some((10, 60)), &accelerometer())
        .object("/'R'/'11HEADCG00H3ACXA (g)'", Some((10, 60)), &waveform())
        .object("/'R'/'Acc (m/(s*s))'", Some((10, 60)), &waveform());
    let mut raw = Writer::new(false);
    raw.doubles((0..180).map(f64::from));
    let recording = read(segment(NEW_LIST | RAW, 3, &metadata, &raw.bytes)).unwrap();
    let [body, head, plain] = recording.channels.as_slice() else { panic!("{:?}", recording.channels) };
    assert_eq!(body.channel.code.as_deref(), Some("10VEHC0000__ACXD"));
    assert_eq!((body.channel.axis, body.channel.cfc), (Some(Axis::X), Some(60)));
    assert_eq!(body.channel.location, "vehicle");
    assert_eq!(body.channel.filter_state.as_deref(), Some("CFC 60"));
    assert_eq!((head.channel.axis, head.channel.cfc), (Some(Axis::X), Some(1000)));
    assert!(head.channel.location.starts_with("occupant front left, head"), "{}", head.channel.location);
    assert_eq!((plain.channel.quantity, plain.channel.code.as_deref()), (QuantityKind::Acceleration, None));
    assert_eq!(samples(plain)[1], 121.0);
}
