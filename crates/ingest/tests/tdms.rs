//! TDMS: the real files, and files built here for what they lack.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

use crumple_ingest::{Bundle, Found, IngestError, Ingested, Recording, Settings, ingest};
use crumple_signal::{Axis, ChannelStatus, QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G};
use crumple_testkit::shared;
use proptest::prelude::*;

const NEW_LIST: u32 = 4 | 2;
const RAW: u32 = 8;
const INTERLEAVED: u32 = 0x20;
const BIG: u32 = 0x40;
const DAQMX: u32 = 0x80;

/// A property's value.
#[derive(Clone)]
enum Value {
    Text(&'static str),
    Double(f64),
    Unsigned(u32),
    Time(f64),
}

/// Bytes in one byte order.
struct Writer {
    bytes: Vec<u8>,
    big: bool,
}

impl Writer {
    fn new(big: bool) -> Self {
        Self { bytes: Vec::new(), big }
    }

    fn put<const N: usize>(&mut self, little: [u8; N]) -> &mut Self {
        let mut bytes = little;
        if self.big {
            bytes.reverse();
        }
        self.bytes.extend(bytes);
        self
    }

    fn u32(&mut self, x: u32) -> &mut Self {
        self.put(x.to_le_bytes())
    }

    fn u64(&mut self, x: u64) -> &mut Self {
        self.put(x.to_le_bytes())
    }

    fn text(&mut self, text: &str) -> &mut Self {
        self.u32(text.len() as u32);
        self.bytes.extend(text.as_bytes());
        self
    }

    /// Path and raw index; `plain` is type code and count, `None` no data.
    fn object(&mut self, path: &str, plain: Option<(u32, u64)>, properties: &[(&str, Value)]) -> &mut Self {
        self.text(path);
        match plain {
            None => self.u32(u32::MAX),
            Some((code, count)) => self.u32(20).u32(code).u32(1).u64(count),
        };
        self.properties(properties)
    }

    fn properties(&mut self, properties: &[(&str, Value)]) -> &mut Self {
        self.u32(properties.len() as u32);
        for (name, value) in properties {
            self.text(name);
            match value {
                Value::Text(text) => self.u32(0x20).text(text),
                Value::Double(x) => self.u32(0xA).put(x.to_le_bytes()),
                Value::Unsigned(x) => self.u32(7).u32(*x),
                Value::Time(seconds) => {
                    let (whole, fraction) = (seconds.floor(), seconds.fract() * 2_f64.powi(64));
                    self.u32(0x44);
                    if self.big {
                        self.put((whole as i64).to_le_bytes()).u64(fraction as u64)
                    } else {
                        self.u64(fraction as u64).put((whole as i64).to_le_bytes())
                    }
                }
            };
        }
        self
    }

    fn doubles(&mut self, values: impl IntoIterator<Item = f64>) -> &mut Self {
        for value in values {
            self.put(value.to_le_bytes());
        }
        self
    }
}

/// A segment: table of contents, metadata (objects counted outside), raw data.
fn segment(toc: u32, objects: u32, metadata: &Writer, raw: &[u8]) -> Vec<u8> {
    let mut out = Writer::new(metadata.big);
    out.bytes.extend(b"TDSm");
    out.bytes.extend(toc.to_le_bytes());
    let has_metadata = toc & 2 != 0;
    let length = if has_metadata { metadata.bytes.len() + 4 } else { 0 };
    out.u32(4713).u64((length + raw.len()) as u64).u64(length as u64);
    if has_metadata {
        out.u32(objects);
        out.bytes.extend(&metadata.bytes);
    }
    out.bytes.extend(raw);
    out.bytes
}

fn waveform() -> Vec<(&'static str, Value)> {
    vec![
        ("wf_increment", Value::Double(1e-4)),
        ("wf_start_offset", Value::Double(-0.01)),
        ("wf_samples", Value::Unsigned(5)),
    ]
}

fn accelerometer() -> Vec<(&'static str, Value)> {
    let mut properties = waveform();
    properties.push(("unit_string", Value::Text("g")));
    properties
}

fn pulse(k: usize) -> f64 {
    -(k as f64) * 0.25
}

/// One channel of `n` samples, contiguous.
fn simple(n: usize, big: bool) -> Vec<u8> {
    let mut metadata = Writer::new(big);
    metadata.object("/", None, &[("title", Value::Text("a test"))]).object("/'g'", None, &[]).object(
        "/'g'/'acc'",
        Some((10, n as u64)),
        &accelerometer(),
    );
    let mut raw = Writer::new(big);
    raw.doubles((0..n).map(pulse));
    segment(NEW_LIST | RAW | if big { BIG } else { 0 }, 3, &metadata, &raw.bytes)
}

fn read(bytes: Vec<u8>) -> Result<Recording, IngestError> {
    read_with(bytes, &Settings::default())
}

fn read_with(bytes: Vec<u8>, settings: &Settings) -> Result<Recording, IngestError> {
    let bundle = Bundle::from_bytes("t.tdms", bytes)?;
    bundle.reader.read(&bundle, settings)
}

fn samples(found: &Found) -> &[f64] {
    found.wave.as_ref().unwrap().samples()
}

#[track_caller]
fn has_note(recording: &Recording, words: &str) {
    let notes = recording.notes.to_texts();
    assert!(notes.iter().any(|note| note.contains(words)), "{words:?} is not in {notes:#?}");
}

fn lenient() -> Settings {
    Settings { allow_missing: Some(true), ..Settings::default() }
}

fn open(path: &str, settings: &Settings) -> Option<Result<Ingested, IngestError>> {
    let path = shared(path)?;
    Some(Bundle::open(&path).and_then(|bundle| ingest(&bundle, settings)))
}

fn recording(path: &str) -> Option<Recording> {
    let bundle = Bundle::open(&shared(path)?).unwrap();
    Some(bundle.reader.read(&bundle, &Settings::default()).unwrap())
}

/// Acceptance 6: wf_* time, unit from the name, 24 trailing NaN, and the velocity channel as the oracle of integration.
#[test]
fn the_target_pulse_integrates_to_its_own_velocity_channel() {
    let Some(ingested) = open("data/iihs-diadem-tdms/Target Pulse.tdms", &lenient()) else { return };
    let ingested = ingested.unwrap();
    let pulse = ingested.pulse().unwrap();
    assert_eq!(pulse.id, "IIWPG_Target_Pulse.IIWPG_Acceleration");
    assert_eq!((pulse.samples.len(), pulse.samples.t0_s(), pulse.samples.dt_s()), (92, 0.0, 1e-3));
    assert_eq!(pulse.quantity, QuantityKind::Acceleration);
    let notes = ingested.notes.to_texts();
    assert!(notes.iter().any(|n| n.starts_with("warning: 24 missing samples (NaN)")), "{notes:#?}");
    assert_eq!(ingested.waves.len(), 3, "the time channel is no wave");

    let a = pulse.samples.samples();
    let mut v = 0.0;
    let mut velocity = vec![0.0];
    for pair in a.windows(2) {
        v += 0.5 * (pair[0] + pair[1]) * pulse.samples.dt_s();
        velocity.push(v);
    }
    // Printed with the record; 1e-12 is some thousand roundings of 4 m/s.
    assert!((velocity[91] - 4.344_990_423_424_699).abs() < 1e-12, "{}", velocity[91]);
    let delta_v = ingested.waves.iter().find(|w| w.id.ends_with(".IIWPG_DeltaV")).unwrap();
    assert_eq!((delta_v.quantity, delta_v.samples.len()), (QuantityKind::Velocity, 92));
    for (ours, theirs) in velocity.iter().zip(delta_v.samples.samples()) {
        assert!((ours - theirs).abs() < 1e-12, "{ours} {theirs}");
    }
    let in_km_per_h = ingested.waves.iter().find(|w| w.id.ends_with(".IIWPG_Delta_V")).unwrap();
    // 15.641965524328903 km/h.
    assert!((in_km_per_h.samples.samples()[91] * 3.6 - 15.641_965_524_328_903).abs() < 1e-12);
    // 10.022165 g at 27 ms, to the digits printed.
    assert!((a[27] / G - 10.022_165).abs() < 1e-6 && a.iter().all(|x| *x <= a[27]));
}

/// Acceptance 8, first half.
#[test]
fn big_endian_channels_are_as_long_as_their_data() {
    let Some(recording) = recording("data/nptdms-fixtures/big_endian.tdms") else { return };
    assert_eq!(recording.channels.len(), 2);
    for found in &recording.channels {
        let wave = found.wave.as_ref().unwrap();
        assert_eq!((wave.len(), wave.dt_s()), (3500, 1e-3));
    }
    // By an independent script: samples 0, 1, 500 (the first of the second segment) and 3499.
    for (found, expected) in recording.channels.iter().zip([
        [0.0, 0.0, 0.309_016_994_374_943_7, 5.067_986_572_324_634],
        [0.0, 0.063_417_585_781_325_2, 0.309_016_994_374_943_7, 0.844_664_428_720_772_3],
    ]) {
        assert_eq!([0, 1, 500, 3499].map(|k| samples(found)[k]), expected);
    }
    assert_eq!(recording.details.title.unwrap().value, "LabVIEW Example (time domain)");
}

/// Acceptance 8, second half.
#[test]
fn daqmx_raw_data_are_read_as_volts() {
    let Some(recording) = recording("data/nptdms-fixtures/raw1.tdms") else { return };
    assert_eq!(recording.channels.len(), 7);
    for found in &recording.channels {
        let wave = found.wave.as_ref().unwrap();
        assert_eq!((wave.len(), wave.dt_s()), (2000, 1.999_999_999_999_999_8e-5));
        assert_eq!(found.channel.quantity, QuantityKind::Voltage);
    }
    // By an independent script, from the 16-bit values, slope 0.0003051850947599719 and intercept 0: samples 0, 1, 1999.
    for (k, expected) in [
        (0, [-0.184_026_612_140_263_06, 0.148_014_770_958_586_4, 0.000_915_555_284_279_915_8]),
        (6, [5.043_183_690_908_536, 4.558_549_760_429_701, 5.074_922_940_763_573]),
    ] {
        assert_eq!([0, 1, 1999].map(|n| samples(&recording.channels[k])[n]), expected);
    }
}

#[test]
fn without_an_acceleration_the_channels_are_there_and_no_pulse_is_guessed() {
    let Some(result) = open("data/nptdms-fixtures/raw1.tdms", &Settings::default()) else { return };
    let error = result.unwrap_err();
    assert!(error.to_string().starts_with("raw1.tdms: no acceleration"), "{error}");
}

#[test]
fn the_index_file_is_refused_by_name() {
    let Some(path) = shared("data/iihs-diadem-tdms/Target Pulse.tdms_index") else { return };
    let error = Bundle::open(&path).err().unwrap();
    assert_eq!(error.to_string(), "Target Pulse.tdms_index is a TDMS index file, which is not read");
    assert_eq!(error.hint(), "the samples are in the .tdms file beside it: give that");
}

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

fn daqmx(out: &mut Writer, path: &str, rows: u64, offset: u32, width: u32, properties: &[(&str, Value)]) {
    // i16 at `offset` in the only buffer, scale id 0.
    out.text(path).u32(0x1269).u32(u32::MAX).u32(1).u64(rows);
    out.u32(1).u32(3).u32(0).u32(offset).u32(0).u32(0).u32(1).u32(width).properties(properties);
}

fn scaled(kind: &'static str) -> Vec<(&'static str, Value)> {
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
    let settings = Settings { channel: Some("b".to_owned()), ..Settings::default() };
    assert!(read_with(file, &settings).unwrap_err().to_string().contains("Thermocouple"));
}

#[test]
fn plain_data_are_scaled_only_where_they_are_unscaled() {
    for (status, factor, offset) in [("unscaled", 0.5, 3.0), ("scaled", 1.0, 0.0)] {
        let mut properties = scaled("Linear");
        properties.retain(|(name, _)| *name != "NI_Scaling_Status");
        properties.push(("NI_Scaling_Status", Value::Text(status)));
        let mut metadata = Writer::new(false);
        metadata.object("/'g'/'a'", Some((10, 60)), &properties);
        let mut raw = Writer::new(false);
        raw.doubles((0..60).map(f64::from));
        let recording = read(segment(NEW_LIST | RAW, 1, &metadata, &raw.bytes)).unwrap();
        assert_eq!(samples(&recording.channels[0])[10], 10.0 * factor + offset);
    }
}

/// A group with a channel of times of `n` samples and an accelerometer of `m` without steps of its own.
fn with_times(n: usize, m: usize, step: f64) -> Vec<u8> {
    let mut metadata = Writer::new(false);
    metadata.object("/'g'/'Time'", Some((10, n as u64)), &[]).object("/'g'/'acc (g)'", Some((10, m as u64)), &[]);
    let mut raw = Writer::new(false);
    raw.doubles((0..n).map(|k| k as f64 * step - 100.0 * step)).doubles((0..m).map(pulse));
    segment(NEW_LIST | RAW, 2, &metadata, &raw.bytes)
}

#[test]
fn a_sibling_channel_of_times_gives_the_grid() {
    for (n, m, length) in [(601, 600, 600), (600, 600, 600), (600, 601, 600)] {
        let recording = read(with_times(n, m, 1e-4)).unwrap();
        let wave = recording.channels[0].wave.as_ref().unwrap();
        assert_eq!((recording.channels.len(), wave.len(), wave.t0_s(), wave.dt_s()), (1, length, -0.01, 1e-4));
        has_note(&recording, "no unit of time is stated for Time: taken as s");
        if n != m {
            has_note(&recording, &format!("has {n} samples, g.acc {m}: the shorter counts"));
        }
    }
    let settings = Settings { time_unit: Some("ms".to_owned()), ..Settings::default() };
    let recording = read_with(with_times(600, 600, 0.1), &settings).unwrap();
    assert_eq!(recording.channels[0].wave.as_ref().unwrap().dt_s(), 1e-4);
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
        let wave = recording.channels[0].wave.as_ref().unwrap();
        assert_eq!((recording.channels.len(), wave.t0_s(), wave.dt_s()), (1, 0.0, 1e-3));
    }
}

#[test]
fn no_time_is_refused_and_so_is_another_axis() {
    let mut metadata = Writer::new(false);
    metadata.object("/'g'/'acc (g)'", Some((10, 60)), &[]);
    let mut raw = Writer::new(false);
    raw.doubles([0.0; 60]);
    let error = read(segment(NEW_LIST | RAW, 1, &metadata, &raw.bytes)).unwrap_err().to_string();
    assert!(error.contains("no time: neither a sampling interval"), "{error}");
    let mut properties = accelerometer();
    properties.push(("wf_xname", Value::Text("Tension")));
    let mut metadata = Writer::new(false);
    metadata.object("/'g'/'a'", Some((10, 60)), &properties);
    let error = read(segment(NEW_LIST | RAW, 1, &metadata, &raw.bytes)).unwrap_err().to_string();
    assert!(error.contains("its X axis is \"Tension\", not time"), "{error}");
}

#[test]
fn inner_gaps_are_refused_and_gaps_at_the_end_cut() {
    let file = |gap: std::ops::Range<usize>| {
        let mut metadata = Writer::new(false);
        metadata.object("/'g'/'a'", Some((10, 80)), &accelerometer());
        let mut raw = Writer::new(false);
        raw.doubles((0..80).map(|k| if gap.contains(&k) { f64::NAN } else { pulse(k) }));
        read(segment(NEW_LIST | RAW, 1, &metadata, &raw.bytes))
    };
    let recording = file(70..80).unwrap();
    assert_eq!(samples(&recording.channels[0]).len(), 70);
    has_note(&recording, "10 missing samples (NaN) cut off at the end of g.a");
    let error = file(40..42).unwrap_err();
    assert_eq!(error.to_string(), "t.tdms, column g.a: sample 40 of 80 is missing (NaN)");
    assert!(file(0..80).unwrap_err().to_string().contains("no channel has samples"));
}

#[test]
fn different_start_times_are_told_and_not_aligned() {
    let mut metadata = Writer::new(false);
    for (path, start) in [("/'g'/'a'", 3.6e9), ("/'g'/'b'", 3.6e9 + 0.25)] {
        let mut properties = accelerometer();
        properties.push(("wf_start_time", Value::Time(start)));
        metadata.object(path, Some((10, 60)), &properties);
    }
    let mut raw = Writer::new(false);
    raw.doubles([0.5; 120]);
    let recording = read(segment(NEW_LIST | RAW, 2, &metadata, &raw.bytes)).unwrap();
    has_note(&recording, "channels start at times of the day up to 0.250000 s apart");
}

/// A crash test as the NHTSA database describes it: 16-character codes, EV5 fields as properties.
fn nhtsa() -> Vec<u8> {
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
    let ingested = ingest(&Bundle::from_bytes("v10146.tdms", nhtsa()).unwrap(), &Settings::default()).unwrap();
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

/// Files whose mutations must not panic.
fn examples() -> Vec<Vec<u8>> {
    let mut examples = vec![simple(60, false), simple(60, true), with_times(61, 60, 1e-4), nhtsa()];
    let mut rows = Writer::new(false);
    daqmx(&mut rows, "/'g'/'a'", 30, 0, 6, &scaled("Linear"));
    examples.push(segment(NEW_LIST | RAW | DAQMX, 1, &rows, &[1; 360]));
    for path in ["iihs-diadem-tdms/Target Pulse.tdms", "nptdms-fixtures/raw1.tdms", "nptdms-fixtures/big_endian.tdms"] {
        if let Some(path) = shared(&format!("data/{path}")) {
            examples.push(std::fs::read(path).unwrap());
        }
    }
    examples
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutated_files_never_panic(
        which in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), 0_u8..5, any::<u32>()), 0..5),
        cut in prop::option::of(any::<prop::sample::Index>()),
        early in any::<bool>(),
    ) {
        thread_local! {
            static EXAMPLES: Vec<Vec<u8>> = examples();
        }
        let mut bytes = EXAMPLES.with(|all| which.get(all).clone());
        for (at, kind, value) in changes {
            // Metadata stand at the start: half of the runs change those only.
            let range = if early { bytes.len().min(3000) } else { bytes.len() };
            if range < 4 {
                break;
            }
            let at = at.index(range - 3);
            match kind {
                0 => bytes[at] = value as u8,
                1 => bytes[at..at + 4].copy_from_slice(&value.to_le_bytes()),
                2 => bytes[at..at + 4].copy_from_slice(&[0xFF; 4]),
                3 => bytes[at..at + 4].copy_from_slice(&(value % 40).to_le_bytes()),
                _ => drop(bytes.drain(at..at + 3)),
            }
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len() + 1));
        }
        match Bundle::from_bytes("t.tdms", bytes).and_then(|bundle| ingest(&bundle, &lenient())) {
            Ok(ingested) => {
                prop_assert!(ingested.waves.iter().all(|w| w.samples.samples().iter().all(|x| x.is_finite())));
            }
            Err(error) => prop_assert!(!error.to_string().is_empty() && !error.hint().is_empty()),
        }
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
