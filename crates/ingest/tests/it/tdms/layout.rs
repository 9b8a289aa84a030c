//! Byte orders, segments, interleaving, damage.

use crumple_ingest::{IngestError, IngestSettings, Recording};
use crumple_signal::{Axis, ChannelStatus, QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G};

use crate::tdms::{
    BIG, DAQMX, Described, INTERLEAVED, NEW_LIST, RAW, Value, Writer, accelerometer, doubles, pulse, read, read_with,
    segment, simple, waveform,
};
use crate::{given, grid, has_note, lenient, notes, read_as, samples};

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
        match read(segment(NEW_LIST | RAW, 1, &metadata, &[0; 480])) {
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
    let ingested = read_as("v10146.tdms", nhtsa(), &IngestSettings::default()).unwrap();
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
    for words in ["the first 20 samples of the pulse are exactly 0", "TOP OF ENGINE X"] {
        assert!(notes(&ingested).contains(words), "{words}: {}", notes(&ingested));
    }
}

#[test]
fn a_channel_named_by_its_code_is_what_the_code_says() {
    let channels: &[Described] = &[
        ("/'R'/'10VEHC0000__ACXD_NoName1'", 60, &accelerometer()),
        ("/'R'/'11HEADCG00H3ACXA (g)'", 60, &waveform()),
        ("/'R'/'Acc (m/(s*s))'", 60, &waveform()),
    ];
    let recording = read(doubles(channels, (0..180).map(f64::from))).unwrap();
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

pub fn daqmx(out: &mut Writer, path: &str, rows: u64, offset: u32, width: u32, properties: &[(&str, Value)]) {
    // i16 at `offset` in the only buffer, scale id 0.
    out.text(path).u32(0x1269).u32(u32::MAX).u32(1).u64(rows);
    out.u32(1).u32(3).u32(0).u32(offset).u32(0).u32(0).u32(1).u32(width).properties(properties);
}

pub fn scaled(kind: &'static str) -> Vec<(&'static str, Value)> {
    let mut properties = waveform();
    properties.extend([
        ("unit_string", Value::Text("m/s^2")),
        ("NI_Scaling_Status", Value::Text("unscaled")),
        ("NI_Number_Of_Scales", Value::Unsigned(2)),
        ("NI_Scale[1]_Scale_Type", Value::Text(kind)),
        ("NI_Scale[1]_Linear_Slope", Value::Double(0.5)),
        ("NI_Scale[1]_Linear_Y_Intercept", Value::Double(3.0)),
        ("NI_Scale[1]_Linear_Input_Source", Value::Unsigned(0)),
    ]);
    properties
}

#[test]
fn daqmx_rows_are_scaled_and_other_scales_named() {
    let mut metadata = Writer::new(false);
    daqmx(&mut metadata, "/'g'/'a'", 30, 0, 6, &scaled("Linear"));
    daqmx(&mut metadata, "/'g'/'b'", 30, 4, 6, &scaled("Thermocouple"));
    let raw: Vec<u8> = (0..60_i16).flat_map(|k| [k, 999, -k]).flat_map(i16::to_le_bytes).collect();
    // Without the bit for DAQmx: it is missing in some files.
    let file = segment(NEW_LIST | RAW | INTERLEAVED, 2, &metadata, &raw);
    let recording = read(file.clone()).unwrap();
    assert_eq!(recording.channels.len(), 1);
    let expected: Vec<f64> = (0..60).map(|k| 0.5 * f64::from(k) + 3.0).collect();
    assert_eq!(samples(&recording.channels[0]), expected);
    has_note(&recording, "left out: t.tdms, column g.b: its scale 1 is of kind Thermocouple, only Linear is applied");
    assert!(read_with(file, &given("--channel b")).unwrap_err().to_string().contains("Thermocouple"));
}

#[test]
fn plain_data_are_scaled_only_where_they_are_unscaled() {
    for (status, factor, offset) in [("unscaled", 0.5, 3.0), ("scaled", 1.0, 0.0)] {
        let mut properties = scaled("Linear");
        properties.retain(|(name, _)| *name != "NI_Scaling_Status");
        properties.push(("NI_Scaling_Status", Value::Text(status)));
        let recording = read(doubles(&[("/'g'/'a'", 60, &properties)], (0..60).map(f64::from))).unwrap();
        assert_eq!(samples(&recording.channels[0])[10], 10.0 * factor + offset);
    }
}

/// A channel of numbers 0, 1, ... with these properties beside those of its waveform.
fn with_scales(properties: &[(&'static str, Value)]) -> Result<Recording, IngestError> {
    let all = [&waveform()[..], &[("unit_string", Value::Text("m/s^2"))], properties].concat();
    read(doubles(&[("/'g'/'a'", 60, &all)], (0..60).map(f64::from)))
}

/// Type, slope, intercept and input of a scale.
macro_rules! scale {
    ($n:literal, $kind:literal, $slope:literal, $intercept:literal, $input:expr) => {
        [
            (concat!("NI_Scale[", $n, "]_Scale_Type"), Value::Text($kind)),
            (concat!("NI_Scale[", $n, "]_", $kind, "_Slope"), Value::Double($slope)),
            (concat!("NI_Scale[", $n, "]_", $kind, "_Y_Intercept"), Value::Double($intercept)),
            (concat!("NI_Scale[", $n, "]_", $kind, "_Input_Source"), Value::Unsigned($input)),
        ]
    };
}

/// The numbers are those of npTDMS 1.13.
#[test]
fn scales_without_their_number_are_counted() {
    let first = scale!(0, "Linear", 2.0, 1.0, u32::MAX);
    assert_eq!(samples(&with_scales(&first).unwrap().channels[0])[10], 21.0);
    let second = [&first[..], &scale!(1, "Linear", 0.5, -4.0, 0)].concat();
    assert_eq!(samples(&with_scales(&second).unwrap().channels[0])[10], 6.5);
    let passes = [&first[..], &scale!(1, "AdvancedAPI", 0.5, -4.0, 0)].concat();
    assert_eq!(samples(&with_scales(&passes).unwrap().channels[0])[10], 21.0);
    let scaled = [&second[..], &[("NI_Scaling_Status", Value::Text("scaled"))]].concat();
    assert_eq!(samples(&with_scales(&scaled).unwrap().channels[0])[10], 10.0);
    let other = [&first[..], &scale!(1, "Polynomial", 0.5, -4.0, 0)].concat();
    let error = with_scales(&other).unwrap_err().to_string();
    assert!(error.ends_with("its scale 1 is of kind Polynomial, only Linear is applied"), "{error}");
    for lost in [("NI_Scaling_Status", Value::Text("unscaled")), ("NI_Number_Of_Scales", Value::Unsigned(1))] {
        let error = with_scales(&[lost]).unwrap_err().to_string();
        assert!(error.contains("its values are raw (unscaled)"), "{error}");
    }
}

/// Two segments of 60 samples of one channel, each with properties of its own.
fn two_segments(first: &[(&str, Value)], second: &[(&str, Value)]) -> Result<Recording, IngestError> {
    let part = |properties: &[(&str, Value)], from: usize| {
        let all: Vec<(&str, Value)> = [&[("unit_string", Value::Text("m/s^2"))], properties].concat();
        doubles(&[("/'g'/'a'", 60, &all)], (from..from + 60).map(|k| k as f64))
    };
    read([part(first, 0), part(second, 60)].concat())
}

#[test]
fn segments_of_one_record_are_joined() {
    let dt = || ("wf_increment", Value::Double(1e-3));
    let offset = |t: f64| ("wf_start_offset", Value::Double(t));
    let start = |t: f64| ("wf_start_time", Value::Time(3.6e9 + t));
    for (first, second) in [
        (vec![dt(), offset(-0.05)], vec![dt(), offset(-0.05)]),
        (vec![dt(), offset(-0.05)], vec![dt(), offset(0.01)]),
        (vec![dt(), offset(-0.05), start(0.0)], vec![dt(), offset(-0.05), start(0.0601)]),
        // No date, no step and no unit say nothing.
        (vec![dt(), offset(-0.05)], vec![("wf_increment", Value::Double(0.0)), ("unit_string", Value::Text(""))]),
        (vec![dt(), offset(-0.05), ("wf_start_time", Value::Time(0.0))], vec![start(0.0)]),
    ] {
        let recording = two_segments(&first, &second).unwrap();
        assert_eq!((grid(&recording.channels[0]), samples(&recording.channels[0]).len()), ((-0.05, 1e-3), 120));
    }
    // What is stated behind the samples is about all of them.
    let mut last = Writer::new(false);
    last.object("/'g'/'acc'", None, &[("unit_string", Value::Text("m/s^2"))]);
    let recording = read([simple(60, false), segment(NEW_LIST, 1, &last, &[])].concat()).unwrap();
    assert_eq!(samples(&recording.channels[0])[59], pulse(59));
}

#[test]
fn segments_of_several_records_are_refused_with_what_differs() {
    let dt = |dt: f64| ("wf_increment", Value::Double(dt));
    let offset = |t: f64| ("wf_start_offset", Value::Double(t));
    let start = |t: f64| ("wf_start_time", Value::Time(86_400.0 * 44_000.0 + t));
    for (first, second, words) in [
        (vec![dt(1e-4)], vec![dt(1e-3)], "at sample 60 wf_increment is 0.0001, then 0.001"),
        (vec![dt(1e-4), offset(-0.05)], vec![dt(1e-4), offset(0.5)], "wf_start_offset is -0.05, then 0.5"),
        (
            vec![dt(1e-4), start(43_200.0)],
            vec![dt(1e-4), start(43_500.25)],
            "wf_start_time is 12:00:00.000 UTC, then 12:05:00.250 UTC (300.25 s later)",
        ),
        (vec![dt(1e-4)], vec![("unit_string", Value::Text("g"))], "unit_string is m/s^2, then g"),
        (
            [&[dt(1e-4)], &scale!(0, "Linear", 2.0, 1.0, u32::MAX)[..]].concat(),
            scale!(0, "Linear", 3.0, 1.0, u32::MAX).into(),
            "NI_Scale[0]_Linear_Slope is 2, then 3",
        ),
    ] {
        let error = two_segments(&first, &second).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
        assert!(error.hint().contains("each record into a channel of its own"), "{}", error.hint());
    }
}

/// A group with a channel of times of `n` samples and an accelerometer of `m` without steps of its own.
pub fn with_times(n: usize, m: usize, step: f64) -> Vec<u8> {
    let times = (0..n).map(|k| k as f64 * step - 100.0 * step);
    doubles(&[("/'g'/'Time'", n, &[]), ("/'g'/'acc (g)'", m, &[])], times.chain((0..m).map(pulse)))
}

#[test]
fn a_sibling_channel_of_times_gives_the_grid() {
    for (n, m, length) in [(601, 600, 600), (600, 600, 600), (600, 601, 600)] {
        let recording = read(with_times(n, m, 1e-4)).unwrap();
        assert_eq!((recording.channels.len(), samples(&recording.channels[0]).len()), (1, length));
        assert_eq!(grid(&recording.channels[0]), (-0.01, 1e-4));
        has_note(&recording, "no unit of time is stated for Time: s is assumed");
        if n != m {
            has_note(&recording, &format!("has {n} samples, g.acc {m}: the shorter length is used"));
        }
    }
    let recording = read_with(with_times(600, 600, 0.1), &given("--time-unit ms")).unwrap();
    assert_eq!(grid(&recording.channels[0]).1, 1e-4);
}

#[test]
fn times_of_the_day_count_from_the_first() {
    for big in [false, true] {
        let mut metadata = Writer::new(big);
        metadata.object("/'g'/'stamp'", Some((0x44, 60)), &[]).object("/'g'/'acc (g)'", Some((10, 60)), &[]);
        let mut raw = Writer::new(big);
        for k in 0..60_u64 {
            // From 3.6e9 s + 0.97 s in steps of 1 ms, across a whole second.
            let (ms, seconds) = ((970 + k) % 1000, 3_600_000_000 + (970 + k) / 1000);
            let fraction = (ms as f64 * 1e-3 * 2_f64.powi(64)) as u64;
            if big {
                raw.u64(seconds).u64(fraction);
            } else {
                raw.u64(fraction).u64(seconds);
            }
        }
        raw.doubles((0..60).map(pulse));
        let toc = NEW_LIST | RAW | if big { BIG } else { 0 };
        let recording = read(segment(toc, 2, &metadata, &raw.bytes)).unwrap();
        assert_eq!((recording.channels.len(), grid(&recording.channels[0])), (1, (0.0, 1e-3)));
    }
}

#[test]
fn no_time_is_refused_and_so_is_another_axis() {
    let error = read(doubles(&[("/'g'/'acc (g)'", 60, &[])], [0.0; 60])).unwrap_err().to_string();
    assert!(error.contains("no time: neither a sampling interval"), "{error}");
    let mut properties = accelerometer();
    properties.push(("wf_xname", Value::Text("Tension")));
    let error = read(doubles(&[("/'g'/'a'", 60, &properties)], [0.0; 60])).unwrap_err().to_string();
    assert!(error.contains("its X axis is \"Tension\", not time"), "{error}");
}

#[test]
fn inner_gaps_are_refused_and_gaps_at_the_end_cut() {
    let file = |gap: std::ops::Range<usize>| {
        let samples = (0..80).map(|k| if gap.contains(&k) { f64::NAN } else { pulse(k) });
        read(doubles(&[("/'g'/'a'", 80, &accelerometer())], samples))
    };
    let recording = file(70..80).unwrap();
    assert_eq!(samples(&recording.channels[0]).len(), 70);
    has_note(&recording, "10 missing samples (NaN) were cut off at the end of g.a");
    let error = file(40..42).unwrap_err();
    assert_eq!(error.to_string(), "t.tdms, column g.a: sample 40 of 80 is missing (NaN)");
    assert!(file(0..80).unwrap_err().to_string().contains("no channel has samples"));
}

/// Two channels of 60 samples at 1e-4 s from -0.01 s of their own axes, the second `later` seconds after the first.
fn apart(later: f64, second_offset: f64) -> Recording {
    let properties = |start: f64, offset: f64| {
        [
            ("wf_increment", Value::Double(1e-4)),
            ("wf_start_offset", Value::Double(offset)),
            ("unit_string", Value::Text("g")),
            ("wf_start_time", Value::Time(start)),
        ]
    };
    let (first, second) = (properties(3.6e9, -0.01), properties(3.6e9 + later, second_offset));
    read(doubles(&[("/'g'/'a'", 60, &first), ("/'g'/'b'", 60, &second)], [0.5; 120])).unwrap()
}

fn starts(recording: &Recording) -> Vec<f64> {
    recording.channels.iter().map(|read| grid(read).0).collect()
}

#[test]
fn channels_that_start_later_stand_later_on_the_axis_of_the_first() {
    let recording = apart(0.25, -0.01);
    assert_eq!(starts(&recording), [-0.01, 0.24]);
    has_note(&recording, "all use the axis of g.a, which starts first (g.b +250.000 ms)");
    // The second starts first: its axis counts, whatever the offset of the other.
    assert_eq!(starts(&apart(-0.125, 0.0)), [0.115, 0.0]);
    // Start time and offset together are the start.
    assert_eq!(starts(&apart(0.25, -0.5)), [-0.26, -0.5]);
    // One instant: the offsets are those of one trigger.
    assert_eq!(starts(&apart(0.0, 0.02)), [-0.01, 0.02]);
}

#[test]
fn channels_of_different_events_keep_their_axes() {
    let recording = apart(3600.0, -0.01);
    assert_eq!(starts(&recording), [-0.01, -0.01]);
    has_note(&recording, "up to 3600.000 s apart: they are not of one event");
}

#[test]
fn groups_with_stamps_of_their_own_have_one_axis() {
    let mut metadata = Writer::new(false);
    for group in ["a", "b"] {
        metadata.object(&format!("/'{group}'/'stamp'"), Some((0x44, 60)), &[]);
        metadata.object(&format!("/'{group}'/'acc (g)'"), Some((10, 60)), &[]);
    }
    let mut raw = Writer::new(false);
    for first_ms in [970, 1020] {
        for k in 0..60_u64 {
            let (ms, seconds) = ((first_ms + k) % 1000, 3_600_000_000 + (first_ms + k) / 1000);
            raw.u64((ms as f64 * 1e-3 * 2_f64.powi(64)) as u64).u64(seconds);
        }
        raw.doubles((0..60).map(pulse));
    }
    let recording = read_with(segment(NEW_LIST | RAW, 4, &metadata, &raw.bytes), &given("--time-unit ms")).unwrap();
    assert_eq!(starts(&recording), [0.0, 0.05]);
    has_note(&recording, "--time-unit has no effect: the times of stamp are those of a clock");
}

/// An accelerometer with a sampling interval of `increment`, and a channel of times where it has a name.
fn with_increment(increment: f64, times: &str, settings: &IngestSettings) -> Result<Recording, IngestError> {
    let properties = [("wf_increment", Value::Double(increment)), ("unit_string", Value::Text("g"))];
    let samples = (0..60).map(|k| f64::from(k) * 2.5e-4).chain((0..60).map(pulse));
    read_with(doubles(&[(&format!("/'g'/'{times}'"), 60, &[]), ("/'g'/'acc'", 60, &properties)], samples), settings)
}

fn grid_of(recording: &Recording, id: &str) -> (f64, f64) {
    grid(recording.channels.iter().find(|read| read.channel.id == id).unwrap())
}

#[test]
fn a_channel_of_times_beats_an_increment() {
    let default = IngestSettings::default();
    for (increment, words) in
        [(1.0, "an interval that no crash is recorded at"), (1e-3, "the channel of times is used")]
    {
        let recording = with_increment(increment, "Time (s)", &default).unwrap();
        assert_eq!(grid_of(&recording, "g.acc"), (0.0, 2.5e-4), "{increment}");
        has_note(&recording, words);
    }
}

#[test]
fn an_interval_of_a_second_is_asked_about() {
    let increment = |flags: &str| with_increment(1.0, "other (V)", &given(&format!("--channel g.acc {flags}")));
    let error = increment("").unwrap_err();
    assert!(error.to_string().contains("a sampling interval of 1 s and no channel of times"), "{error}");
    assert_eq!(error.hint(), "state the sampling interval, such as --sample-time 100us");
    assert_eq!(grid_of(&increment("--sample-time 250us").unwrap(), "g.acc"), (0.0, 2.5e-4));
    // The unit of the increment may be another one.
    assert_eq!(grid_of(&increment("--time-unit ms").unwrap(), "g.acc"), (0.0, 1e-3));
    // What is no crash may be that slow.
    assert_eq!(grid_of(&with_increment(1.0, "other (V)", &lenient()).unwrap(), "g.acc"), (0.0, 1.0));
}

#[test]
fn a_voltage_is_no_acceleration_and_naming_it_is_no_help() {
    let properties = [&waveform()[..], &[("unit_string", Value::Text("Volts"))]].concat();
    let file = doubles(&[("/'g'/'a'", 60, &properties)], (0..60).map(f64::from));
    for (flags, words) in
        [("", "no acceleration column with data, but g.a (voltage)"), ("--channel g.a", "measures voltage")]
    {
        let error = read_as("t.tdms", file.clone(), &given(flags)).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
        assert!(error.hint().starts_with("add --scale \"g.a=50mV/g\""), "{}", error.hint());
    }
}
