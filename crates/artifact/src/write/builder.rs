//! Collects records and waveforms and writes them as one artifact.

use std::collections::BTreeMap;
use std::io::{Cursor, Seek, Write};
use std::path::{Path, PathBuf};

use crumple_signal::{QuantityKind, Sampled};
use mcap::records::{MessageHeader, Metadata};

use super::atomic::replace_atomically;
use super::output_kind::OutputKind;
use crate::error::WriteError;
use crate::layout::codec::{Codec, encode_wave_block};
use crate::layout::digest::ContentDigest;
use crate::layout::names::{CONTENT, LIBRARY, WAVE_PREFIX};
use crate::layout::provenance::{PROVENANCE, Provenance};
use crate::layout::record::Record;
use crate::layout::time_origin::{FARTHEST_S, log_time, origin_ns, to_ns};
use crate::layout::wave::{BLOCK_SAMPLES, Wave};
use crate::records::WaveBlockV1;

/// Compression of the chunks. The content digest does not depend on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Compression {
    /// None: fastest, and filtered signals hardly compress.
    #[default]
    None,
    /// Zstandard with one thread, so that the bytes do not depend on the machine.
    Zstd,
}

struct Small {
    topic: String,
    schema: &'static str,
    schema_json: &'static [u8],
    payload: Vec<u8>,
}

/// Collects what a stage found and writes it as one file.
///
/// Small records come first in the order they were put, then the blocks of all waveforms in order of time.
#[derive(Default)]
pub struct ArtifactBuilder {
    records: Vec<Small>,
    waves: BTreeMap<String, Wave>,
}

impl ArtifactBuilder {
    /// An empty artifact.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a record under a topic.
    ///
    /// Errors: a second record under the topic; a number that is not finite or that no crash has; a record that
    /// contradicts itself.
    pub fn put<R: Record>(&mut self, topic: &str, record: &R) -> Result<(), WriteError> {
        if self.records.iter().any(|r| r.topic == topic) {
            return Err(WriteError::Duplicate(topic.to_owned()));
        }
        if let Some((field, value)) = record.first_impossible() {
            return Err(WriteError::Impossible { topic: topic.to_owned(), field, value });
        }
        let encode = |problem| WriteError::Encode { topic: topic.to_owned(), problem };
        record.check().map_err(encode)?;
        self.records.push(Small {
            topic: topic.to_owned(),
            schema: R::SCHEMA,
            schema_json: R::schema_json(),
            payload: record.to_json().map_err(encode)?,
        });
        Ok(())
    }

    /// Adds a waveform; its topic is `/wave/<id>`. Errors: a second waveform of that id; a start that nanoseconds in 64
    /// bits do not reach.
    pub fn wave(&mut self, id: &str, quantity: QuantityKind, sampled: Sampled) -> Result<(), WriteError> {
        if sampled.t0_s().abs() > FARTHEST_S {
            let problem = format!("it starts at {} s, times go from -292 to 292 years", sampled.t0_s());
            return Err(WriteError::Encode { topic: format!("{WAVE_PREFIX}{id}"), problem });
        }
        match self.waves.insert(id.to_owned(), Wave { quantity, sampled }) {
            None => Ok(()),
            Some(_) => Err(WriteError::Duplicate(format!("{WAVE_PREFIX}{id}"))),
        }
    }

    /// The records as `(topic, schema, JSON)`, in order.
    pub fn records(&self) -> impl Iterator<Item = (&str, &str, &[u8])> {
        self.records.iter().map(|r| (r.topic.as_str(), r.schema, r.payload.as_slice()))
    }

    /// Writes the artifact to `path` in one step (see [`write_atomically`](crate::write_atomically)) and returns its
    /// content digest.
    pub fn write(&self, path: &Path, provenance: &Provenance, compression: Compression) -> Result<String, WriteError> {
        self.write_replacing(path, &[], provenance, compression, &mut |_| ())
    }

    /// Samples of all waveforms together: the work of writing.
    pub fn samples(&self) -> u64 {
        self.waves.values().map(|wave| wave.sampled.len() as u64).sum()
    }

    /// [`write`](Self::write) that tells how many samples have been written since the last call, and removes
    /// `dependents`, files made from the old artifact, right before the new one appears (see [`replace_atomically`]).
    pub fn write_replacing(
        &self,
        path: &Path,
        dependents: &[PathBuf],
        provenance: &Provenance,
        compression: Compression,
        report: &mut dyn FnMut(u64),
    ) -> Result<String, WriteError> {
        enum Failure {
            Io(std::io::Error),
            Write(WriteError),
        }
        impl From<std::io::Error> for Failure {
            fn from(error: std::io::Error) -> Self {
                Self::Io(error)
            }
        }
        replace_atomically(path, OutputKind::Artifact, dependents, |file| {
            self.write_blocks(file, provenance, compression, report)
                .map_err(|source| Failure::Write(WriteError::Container { path: path.to_owned(), source }))
        })
        .map_err(|failure| match failure {
            Failure::Io(source) => WriteError::Io { path: path.to_owned(), source },
            Failure::Write(error) => error,
        })
    }

    /// The content digest of the artifact as it would be written.
    pub fn digest(&self) -> Result<String, mcap::McapError> {
        let nobody = Provenance::new("", "", String::new(), Vec::new());
        self.write_to(Cursor::new(Vec::new()), &nobody, Compression::None)
    }

    /// Writes the artifact into `sink` and returns its content digest. The bytes depend on the records, the
    /// waveforms, the provenance and the compression, and on nothing else.
    pub fn write_to<W: Write + Seek>(
        &self,
        sink: W,
        provenance: &Provenance,
        compression: Compression,
    ) -> Result<String, mcap::McapError> {
        self.write_blocks(sink, provenance, compression, &mut |_| ())
    }

    fn write_blocks<W: Write + Seek>(
        &self,
        sink: W,
        provenance: &Provenance,
        compression: Compression,
        report: &mut dyn FnMut(u64),
    ) -> Result<String, mcap::McapError> {
        let earliest_ns = self.waves.values().filter(|w| !w.sampled.is_empty()).map(Wave::t0_ns).min().unwrap_or(0);
        let origin = origin_ns(earliest_ns);
        let start = log_time(origin, earliest_ns);
        let options = mcap::WriteOptions::new().compression(None).profile("").library(LIBRARY);
        #[cfg(unix)]
        let options = options.compression_threads(0);
        let options = match compression {
            Compression::None => options,
            #[cfg(unix)]
            Compression::Zstd => options.compression(Some(mcap::Compression::Zstd)),
            // What packs is written in C.
            #[cfg(not(unix))]
            Compression::Zstd => return Err(mcap::McapError::UnsupportedCompression("zstd".to_owned())),
        };
        let mut writer = options.create(sink)?;
        writer.write_metadata(&Metadata { name: PROVENANCE.to_owned(), metadata: provenance.to_metadata() })?;
        let mut digest = ContentDigest::default();

        for record in &self.records {
            let schema = writer.add_schema(record.schema, "jsonschema", record.schema_json)?;
            let channel = writer.add_channel(schema, &record.topic, Codec::Json.name(), &BTreeMap::new())?;
            let header = MessageHeader { channel_id: channel, sequence: 0, log_time: start, publish_time: start };
            writer.write_to_known_channel(&header, &record.payload)?;
            digest.update(&record.topic, record.schema, Codec::Json.name(), start, &record.payload);
        }

        // One pass over all waveforms in order of time, so that log times never fall.
        let schema_json = WaveBlockV1::schema_json();
        let mut blocks = Vec::new();
        for (id, wave) in &self.waves {
            let schema = writer.add_schema(WaveBlockV1::SCHEMA, "jsonschema", schema_json)?;
            let topic = format!("{WAVE_PREFIX}{id}");
            let channel = writer.add_channel(schema, &topic, Codec::Bincode.name(), &wave.channel_metadata())?;
            let count = wave.sampled.len().div_ceil(BLOCK_SAMPLES).max(1);
            for block in 0..count {
                let t_ns = to_ns(wave.sampled.time_s(block * BLOCK_SAMPLES));
                blocks.push((log_time(origin, t_ns).max(start), channel, block, topic.clone(), wave));
            }
        }
        blocks.sort_by_key(|(time, channel, block, ..)| (*time, *channel, *block));
        let mut payload = Vec::new();
        for (time, channel, block, topic, wave) in blocks {
            let first = block * BLOCK_SAMPLES;
            let samples = wave.sampled.samples();
            let samples = &samples[first..(first + BLOCK_SAMPLES).min(samples.len())];
            encode_wave_block(wave.t0_ns(), wave.sampled.dt_s(), first as u64, samples, &mut payload);
            let header =
                MessageHeader { channel_id: channel, sequence: block as u32, log_time: time, publish_time: time };
            writer.write_to_known_channel(&header, &payload)?;
            digest.update(&topic, WaveBlockV1::SCHEMA, Codec::Bincode.name(), time, &payload);
            report(samples.len() as u64);
        }

        let digest_text = digest.text();
        writer.write_metadata(&Metadata {
            name: CONTENT.to_owned(),
            metadata: BTreeMap::from([
                ("digest".to_owned(), digest_text.clone()),
                ("messages".to_owned(), digest.messages().to_string()),
                ("time.t0_offset_ns".to_owned(), origin.to_string()),
            ]),
        })?;
        writer.finish()?;
        Ok(digest_text)
    }
}
