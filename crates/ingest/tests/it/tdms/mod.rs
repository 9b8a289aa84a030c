//! TDMS: the real files, and files built here for what they lack.

use crumple_ingest::{Bundle, IngestError, IngestSettings, Recording};
use crumple_signal::{QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G};
use crumple_testkit::shared;

use crate::tdms::layout::{daqmx, nhtsa, scaled, with_times};
use crate::{lenient, open, samples};

mod layout;

pub const NEW_LIST: u32 = 4 | 2;
pub const RAW: u32 = 8;
pub const INTERLEAVED: u32 = 0x20;
pub const BIG: u32 = 0x40;
pub const DAQMX: u32 = 0x80;

/// A property's value.
#[derive(Clone)]
pub enum Value {
    Text(&'static str),
    Double(f64),
    Unsigned(u32),
    Time(f64),
}

/// Bytes in one byte order.
pub struct Writer {
    pub bytes: Vec<u8>,
    big: bool,
}

impl Writer {
    pub fn new(big: bool) -> Self {
        Self { bytes: Vec::new(), big }
    }

    pub fn put<const N: usize>(&mut self, little: [u8; N]) -> &mut Self {
        let mut bytes = little;
        if self.big {
            bytes.reverse();
        }
        self.bytes.extend(bytes);
        self
    }

    pub fn u32(&mut self, x: u32) -> &mut Self {
        self.put(x.to_le_bytes())
    }

    pub fn u64(&mut self, x: u64) -> &mut Self {
        self.put(x.to_le_bytes())
    }

    pub fn text(&mut self, text: &str) -> &mut Self {
        self.u32(text.len() as u32);
        self.bytes.extend(text.as_bytes());
        self
    }

    /// Path and raw index; `plain` is type code and count, `None` no data.
    pub fn object(&mut self, path: &str, plain: Option<(u32, u64)>, properties: &[(&str, Value)]) -> &mut Self {
        self.text(path);
        match plain {
            None => self.u32(u32::MAX),
            Some((code, count)) => self.u32(20).u32(code).u32(1).u64(count),
        };
        self.properties(properties)
    }

    pub fn properties(&mut self, properties: &[(&str, Value)]) -> &mut Self {
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

    pub fn doubles(&mut self, values: impl IntoIterator<Item = f64>) -> &mut Self {
        for value in values {
            self.put(value.to_le_bytes());
        }
        self
    }
}

/// A segment: table of contents, metadata (objects counted outside), raw data.
pub fn segment(toc: u32, objects: u32, metadata: &Writer, raw: &[u8]) -> Vec<u8> {
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

pub fn waveform() -> Vec<(&'static str, Value)> {
    vec![
        ("wf_increment", Value::Double(1e-4)),
        ("wf_start_offset", Value::Double(-0.01)),
        ("wf_samples", Value::Unsigned(5)),
    ]
}

pub fn accelerometer() -> Vec<(&'static str, Value)> {
    let mut properties = waveform();
    properties.push(("unit_string", Value::Text("g")));
    properties
}

pub fn pulse(k: usize) -> f64 {
    -(k as f64) * 0.25
}

/// A channel: path, how many samples, properties.
pub type Described<'a> = (&'a str, usize, &'a [(&'a str, Value)]);

/// Channels of doubles in one segment.
pub fn doubles(channels: &[Described], samples: impl IntoIterator<Item = f64>) -> Vec<u8> {
    let (mut metadata, mut raw) = (Writer::new(false), Writer::new(false));
    for (path, count, properties) in channels {
        metadata.object(path, Some((10, *count as u64)), properties);
    }
    raw.doubles(samples);
    segment(NEW_LIST | RAW, channels.len() as u32, &metadata, &raw.bytes)
}

/// One channel of `n` samples, contiguous.
pub fn simple(n: usize, big: bool) -> Vec<u8> {
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

pub fn read(bytes: Vec<u8>) -> Result<Recording, IngestError> {
    read_with(bytes, &IngestSettings::default())
}

pub fn read_with(bytes: Vec<u8>, settings: &IngestSettings) -> Result<Recording, IngestError> {
    let bundle = Bundle::from_bytes("t.tdms", bytes)?;
    bundle.read(settings)
}

pub fn recording(path: &str) -> Option<Recording> {
    let bundle = Bundle::open(&shared(path)?).unwrap();
    Some(bundle.read(&IngestSettings::default()).unwrap())
}

/// Acceptance 6: wf_* time, unit from the name, 24 trailing NaN, and the velocity channel as the oracle of integration.
#[test]
fn the_target_pulse_integrates_to_its_own_velocity_channel() {
    let Some(path) = shared("data/iihs-diadem-tdms/Target Pulse.tdms") else { return };
    let ingested = open(path, &lenient()).unwrap();
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
    // By an independent script, from the 16-bit values, slope 0.0003051850947599719 and intercept 0: samples 0, 1,
    // 1999.
    for (k, expected) in [
        (0, [-0.184_026_612_140_263_06, 0.148_014_770_958_586_4, 0.000_915_555_284_279_915_8]),
        (6, [5.043_183_690_908_536, 4.558_549_760_429_701, 5.074_922_940_763_573]),
    ] {
        assert_eq!([0, 1, 1999].map(|n| samples(&recording.channels[k])[n]), expected);
    }
}

#[test]
fn without_an_acceleration_the_channels_are_there_and_no_pulse_is_guessed() {
    let Some(path) = shared("data/nptdms-fixtures/raw1.tdms") else { return };
    let error = open(path, &IngestSettings::default()).unwrap_err();
    assert!(error.to_string().starts_with("raw1.tdms: no acceleration"), "{error}");
}

#[test]
fn the_index_file_is_refused_by_name() {
    let Some(path) = shared("data/iihs-diadem-tdms/Target Pulse.tdms_index") else { return };
    let error = Bundle::open(&path).err().unwrap();
    assert_eq!(error.to_string(), "Target Pulse.tdms_index is a TDMS index file, which is not read");
    assert_eq!(error.hint(), "the samples are in the .tdms file beside it: give that");
}

/// Files whose mutations must not panic.
pub fn examples() -> Vec<Vec<u8>> {
    let mut rows = Writer::new(false);
    daqmx(&mut rows, "/'g'/'a'", 30, 0, 6, &scaled("Linear"));
    let daqmx = segment(NEW_LIST | RAW | DAQMX, 1, &rows, &[1; 360]);
    let changed = [("wf_increment", Value::Double(1e-3)), ("unit_string", Value::Text("m/s^2"))];
    let parts = [simple(60, false), doubles(&[("/'g'/'acc'", 60, &changed)], [0.5; 60])].concat();
    vec![simple(60, false), simple(60, true), with_times(61, 60, 1e-4), nhtsa(), daqmx, parts]
}
