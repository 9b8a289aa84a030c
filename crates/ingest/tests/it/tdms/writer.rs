//! Files built byte by byte, and what is read from them.

use crumple_ingest::{Bundle, IngestError, IngestSettings, Ingested, ReadChannel, Recording, ingest};
use crumple_testkit::shared;

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
    bundle.reader.read(&bundle, settings)
}

pub fn samples(found: &ReadChannel) -> &[f64] {
    found.wave.as_ref().unwrap().samples()
}

#[track_caller]
pub fn has_note(recording: &Recording, words: &str) {
    let notes = recording.notes.to_texts();
    assert!(notes.iter().any(|note| note.contains(words)), "{words:?} is not in {notes:#?}");
}

pub fn lenient() -> IngestSettings {
    IngestSettings { allow_missing: Some(true), ..IngestSettings::default() }
}

pub fn open(path: &str, settings: &IngestSettings) -> Option<Result<Ingested, IngestError>> {
    let path = shared(path)?;
    Some(Bundle::open(&path).and_then(|bundle| ingest(&bundle, settings)))
}

pub fn recording(path: &str) -> Option<Recording> {
    let bundle = Bundle::open(&shared(path)?).unwrap();
    Some(bundle.reader.read(&bundle, &IngestSettings::default()).unwrap())
}
