//! Reads an artifact, whoever wrote it, and believes nothing unchecked.

use std::any::Any;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use crumple_signal::QuantityKind;
use crumple_signal::unit::signal_unit;
use mcap::McapError;
use mcap::records::{self, MessageHeader, Record as McapRecord, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::chunk::{Directory, Topic, unpack};
use crate::error::ReadError;
use crate::finite::needed;
use crate::layout::codec::{Codec, decode_wave_block};
use crate::layout::digest::ContentDigest;
use crate::layout::names::{CONTENT, WAVE_PREFIX, is_later_version};
use crate::layout::provenance::{FORMAT_VERSION, PROVENANCE, Provenance};
use crate::layout::record::Record;
use crate::layout::wave::{Wave, WaveAssembler};
use crate::read::named_pipe::refuse_named_pipe;
use crate::records::{TestV1, WaveBlockV1};

/// Records other than chunks are small; an absurd length is damage or an attack.
const MAX_RECORD_BYTES: usize = 5 << 30;

/// A small record as it stands in the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RawRecord {
    /// Its topic.
    pub topic: String,
    /// Name of its schema.
    pub schema: String,
    /// How the payload is encoded.
    pub encoding: String,
    /// MCAP log time, ns.
    pub log_time: u64,
    /// The message.
    pub payload: Vec<u8>,
}

/// Topic of the description of the test.
const TEST: &str = "/test";

/// An artifact in memory: every CRC, the content digest and every waveform have been checked.
#[derive(Debug, Clone)]
pub struct Artifact {
    path: PathBuf,
    provenance: Option<Provenance>,
    digest: String,
    records: Vec<RawRecord>,
    waves: BTreeMap<String, Wave>,
    /// What metadata state of waveforms whose quantity has no unit of its own.
    stated_units: BTreeMap<String, String>,
    /// The record of `/test`, which every stage asks for again and again.
    test: Option<Box<TestV1>>,
}

impl Artifact {
    /// Reads a file. Memory: the samples once, plus the small records.
    ///
    /// Errors: [`ReadError`], which names the file, the damaged record and one thing to do.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        Self::open_reporting(path, &mut |_| {})
    }

    /// The same, and tells `done` of the bytes of each piece that is read.
    pub fn open_reporting(path: &Path, done: &mut dyn FnMut(u64)) -> Result<Self, ReadError> {
        let io = |source| ReadError::Io { path: path.to_owned(), source };
        refuse_named_pipe(path).map_err(io)?;
        let file = File::open(path).map_err(io)?;
        let found = file.metadata().map_err(io)?;
        if found.is_dir() {
            return Err(io(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder")));
        }
        let mut scan = Scan::new(path);
        scan.length = found.is_file().then_some(found.len());
        scan.run(Reporting { file, done })?;
        scan.finish()
    }

    /// Reads from any source; `path` is what messages call it.
    pub fn read(path: &Path, source: impl Read) -> Result<Self, ReadError> {
        let mut scan = Scan::new(path);
        scan.run(source)?;
        scan.finish()
    }

    /// Where it was read from.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The stage that wrote it, if it says so.
    pub fn stage(&self) -> Option<&str> {
        self.provenance.as_ref().map(|p| p.stage.as_str()).filter(|s| !s.is_empty())
    }

    /// Who made it, from what, with which settings, if it says so.
    pub fn provenance(&self) -> Option<&Provenance> {
        self.provenance.as_ref()
    }

    /// Digest of its content, computed from the messages read.
    pub fn digest(&self) -> &str {
        &self.digest
    }

    /// The small records in file order.
    pub fn records(&self) -> &[RawRecord] {
        &self.records
    }

    /// The waveforms by channel id.
    pub fn waves(&self) -> &BTreeMap<String, Wave> {
        &self.waves
    }

    /// The unit of a waveform: SI of its quantity, of another quantity what its metadata state.
    pub fn unit_of_wave(&self, id: &str) -> Option<&str> {
        let unit = self.waves.get(id)?.quantity.si_unit();
        Some(self.stated_units.get(id).map_or(unit, String::as_str))
    }

    /// Decodes the record under `topic`; `None` if there is no such topic.
    ///
    /// Errors: the topic holds another type or a newer version; the message does not decode.
    pub fn record<R: Record>(&self, topic: &str) -> Result<Option<R>, ReadError> {
        let known =
            self.test.as_deref().filter(|_| topic == TEST).and_then(|test| (test as &dyn Any).downcast_ref::<R>());
        if let Some(known) = known {
            return Ok(Some(known.clone()));
        }
        self.records.iter().find(|r| r.topic == topic).map(|raw| self.decode(raw)).transpose()
    }

    /// Decodes one raw record, of this version of the type or the one before.
    pub fn decode<R: Record>(&self, raw: &RawRecord) -> Result<R, ReadError> {
        let decode = match raw.schema.as_str() {
            schema if schema == R::SCHEMA => R::decode,
            schema if Some(schema) == R::EARLIER => R::decode_earlier,
            _ => return Err(self.wrong_schema(raw, R::SCHEMA)),
        };
        let message = |problem| ReadError::Message { path: self.path.clone(), topic: raw.topic.clone(), problem };
        let codec = Codec::from_name(&raw.encoding).ok_or_else(|| message(unread_encoding(&raw.encoding)))?;
        let record = decode(codec, &raw.payload).map_err(message)?;
        match record.first_impossible() {
            Some((field, value)) => Err(message(format!("{field} is {value}, {}", needed(value)))),
            None => Ok(record),
        }
    }

    fn wrong_schema(&self, raw: &RawRecord, needed: &str) -> ReadError {
        if is_later_version(&raw.schema, needed) {
            return ReadError::Newer {
                path: self.path.clone(),
                what: format!("the record type of topic {}", raw.topic),
                found: raw.schema.clone(),
                known: needed.to_owned(),
            };
        }
        ReadError::WrongType {
            path: self.path.clone(),
            topic: raw.topic.clone(),
            found: raw.schema.clone(),
            needed: needed.to_owned(),
        }
    }
}

fn unread_encoding(encoding: &str) -> String {
    format!("encoding {encoding:?} is not read, json or bincode is needed")
}

/// One pass over a file.
struct Scan<'a> {
    path: &'a Path,
    directory: Directory,
    records: Vec<RawRecord>,
    /// Topics of the records.
    topics: BTreeSet<String>,
    waves: BTreeMap<String, (WaveAssembler, Topic)>,
    digest: ContentDigest,
    provenance: Option<BTreeMap<String, String>>,
    content: Option<BTreeMap<String, String>>,
    /// Length of the file, bytes, where it is known: no record is longer.
    length: Option<u64>,
    /// Bytes of complete records so far.
    offset: u64,
    /// The record before the place where reading stands.
    last: String,
    chunks: u64,
    outside: Vec<String>,
    ended: bool,
    footer: bool,
    /// The first message that makes no sense; told only once every CRC is known to be right.
    nonsense: Option<ReadError>,
}

/// A file that says how much of it was read.
struct Reporting<'a> {
    file: File,
    done: &'a mut dyn FnMut(u64),
}

impl Read for Reporting<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.file.read(buffer)?;
        (self.done)(read as u64);
        Ok(read)
    }
}

impl<'a> Scan<'a> {
    fn new(path: &'a Path) -> Self {
        Self {
            path,
            directory: Directory::default(),
            records: Vec::new(),
            topics: BTreeSet::new(),
            waves: BTreeMap::new(),
            digest: ContentDigest::default(),
            provenance: None,
            content: None,
            length: None,
            offset: mcap::MAGIC.len() as u64,
            last: "the magic bytes".into(),
            chunks: 0,
            outside: Vec::new(),
            ended: false,
            footer: false,
            nonsense: None,
        }
    }

    fn run(&mut self, mut source: impl Read) -> Result<(), ReadError> {
        let longest = self.length.and_then(|length| usize::try_from(length).ok()).unwrap_or(MAX_RECORD_BYTES);
        let mut reader = LinearReader::new_with_options(
            LinearReaderOptions::default()
                .with_emit_chunks(true)
                .with_validate_data_section_crc(true)
                .with_validate_summary_section_crc(true)
                .with_check_finishes_after_end_magic(true)
                .with_record_length_limit(longest),
        );
        let mut length = 0;
        while let Some(event) = reader.next_event() {
            match event {
                Ok(LinearReadEvent::ReadRequest(need)) => {
                    // In pieces, so that an absurd announced length cannot reserve memory for bytes that never come.
                    let piece = need.clamp(1 << 16, 1 << 24);
                    let read = source
                        .read(reader.insert(piece))
                        .map_err(|source| ReadError::Io { path: self.path.to_owned(), source })?;
                    length += read as u64;
                    reader.notify_read(read);
                }
                Ok(LinearReadEvent::Record { opcode, data }) => {
                    let size = 9 + data.len() as u64;
                    self.record(opcode, data)?;
                    self.offset += size;
                }
                Err(error) => return Err(self.container_error(error, length)),
            }
        }
        Ok(())
    }

    fn record(&mut self, opcode: u8, body: &[u8]) -> Result<(), ReadError> {
        let name = self.name_of(opcode);
        self.last.clone_from(&name);
        if opcode == op::CHUNK {
            let messages = unpack(body, &mut self.directory).map_err(|problem| self.corrupt(name.clone(), problem))?;
            for (header, payload) in messages {
                self.message(&header, payload);
            }
            return Ok(());
        }
        let parsed = mcap::parse_record(opcode, body).map_err(|e| self.corrupt(name.clone(), e.to_string()))?;
        if !self.ended && opcode != op::MESSAGE_INDEX {
            self.outside.push(name.clone());
        }
        match parsed {
            McapRecord::Schema { header, .. } => self.directory.schema(header.id, header.name),
            McapRecord::Channel(channel) => self.directory.channel(channel),
            McapRecord::Message { header, data } => self.message(&header, data.into_owned()),
            McapRecord::Metadata(records::Metadata { name, metadata }) if name == CONTENT => {
                self.content = Some(metadata);
            }
            McapRecord::Metadata(records::Metadata { name, metadata }) if name == PROVENANCE => {
                self.provenance = Some(metadata);
            }
            McapRecord::DataEnd(_) => self.ended = true,
            McapRecord::Footer(_) => self.footer = true,
            // 0x80 and up are anybody's private records; below, the MCAP specification has none.
            McapRecord::Unknown { opcode, .. } if opcode < 0x80 => {
                return Err(self.corrupt(name, format!("{opcode:#04x} is no MCAP record")));
            }
            _ => {}
        }
        Ok(())
    }

    fn message(&mut self, header: &MessageHeader, payload: Vec<u8>) {
        if let Err(error) = self.take_message(header, payload) {
            self.nonsense.get_or_insert(error);
        }
    }

    fn take_message(&mut self, header: &MessageHeader, payload: Vec<u8>) -> Result<(), ReadError> {
        let topic = self
            .directory
            .topic(header.channel_id)
            .map_err(|problem| self.corrupt(self.last.clone(), problem))?
            .clone();
        self.digest.update(&topic.name, &topic.schema, &topic.encoding, header.log_time, &payload);
        let fail = |problem| ReadError::Message { path: self.path.to_owned(), topic: topic.name.clone(), problem };
        if let Some(id) = topic.name.strip_prefix(WAVE_PREFIX).filter(|_| topic.schema == WaveBlockV1::SCHEMA) {
            let codec = Codec::from_name(&topic.encoding).ok_or_else(|| fail(unread_encoding(&topic.encoding)))?;
            let block = decode_wave_block(codec, &payload).map_err(fail)?;
            let (assembler, _) =
                self.waves.entry(id.to_owned()).or_insert_with(|| (WaveAssembler::default(), topic.clone()));
            return assembler.push(block).map_err(fail);
        }
        if is_later_version(&topic.schema, WaveBlockV1::SCHEMA) {
            return Err(ReadError::Newer {
                path: self.path.to_owned(),
                what: format!("the record type of topic {}", topic.name),
                found: topic.schema,
                known: WaveBlockV1::SCHEMA.to_owned(),
            });
        }
        if topic.schema.starts_with("crumple.") && self.topics.contains(&topic.name) {
            return Err(fail("two messages, a record is one message".into()));
        }
        self.topics.insert(topic.name.clone());
        self.records.push(RawRecord {
            topic: topic.name,
            schema: topic.schema,
            encoding: topic.encoding,
            log_time: header.log_time,
            payload,
        });
        Ok(())
    }

    fn finish(self) -> Result<Artifact, ReadError> {
        // A record whose opcode was damaged is skipped by readers as unknown; these two must have been seen.
        if !self.ended {
            return Err(self.corrupt("DataEnd".into(), "the record is missing".into()));
        }
        if !self.footer {
            return Err(self.corrupt("Footer".into(), "the record is missing".into()));
        }
        if let Some(error) = self.nonsense {
            return Err(error);
        }
        // Only now, with every CRC checked, do the words in the file count.
        if let Some(format) = self.provenance.as_ref().and_then(|p| p.get("format"))
            && format.parse::<u32>().is_ok_and(|version| version > FORMAT_VERSION)
        {
            return Err(ReadError::Newer {
                path: self.path.to_owned(),
                what: "the artifact format".into(),
                found: format.clone(),
                known: FORMAT_VERSION.to_string(),
            });
        }
        if !self.directory.topics().any(|t| t.schema.starts_with("crumple.")) {
            let channels = self.directory.topics().count();
            let example = self
                .directory
                .topics()
                .next()
                .map_or_else(String::new, |t| format!(", e.g. topic {} has {:?}", t.name, t.schema));
            return Err(ReadError::Foreign { path: self.path.to_owned(), channels, example });
        }
        let digest = self.digest.text();
        if let Some(stated) = self.content.as_ref().and_then(|c| c.get("digest"))
            && *stated != digest
        {
            let problem = format!("it states {stated}, the messages give {digest}");
            return Err(self.corrupt("metadata record \"content\"".into(), problem));
        }
        let mut artifact = Artifact {
            path: self.path.to_owned(),
            provenance: self.provenance.as_ref().map(Provenance::from_metadata),
            digest,
            records: self.records,
            waves: BTreeMap::new(),
            stated_units: BTreeMap::new(),
            test: None,
        };
        artifact.test = artifact.record(TEST).ok().flatten().map(Box::new);
        for (id, (assembler, topic)) in self.waves {
            // The quantity of a waveform without metadata comes from the test's channel list, if it is there.
            let quantity = wave_quantity(&id, &topic.metadata, artifact.test.as_deref());
            if let Some(problem) = unit_fault(quantity, &topic.metadata) {
                return Err(ReadError::Message { path: artifact.path, topic: topic.name, problem });
            }
            let sampled = assembler.finish().map_err(|problem| ReadError::Message {
                path: artifact.path.clone(),
                topic: topic.name.clone(),
                problem,
            })?;
            if let Some(unit) = topic.metadata.get("unit")
                && quantity == QuantityKind::Other
                && !unit.is_empty()
            {
                artifact.stated_units.insert(id.clone(), unit.clone());
            }
            artifact.waves.insert(id, Wave { quantity, sampled });
        }
        Ok(artifact)
    }

    fn name_of(&mut self, opcode: u8) -> String {
        let kind = match opcode {
            op::HEADER => "Header",
            op::FOOTER => "Footer",
            op::SCHEMA => "Schema",
            op::CHANNEL => "Channel",
            op::MESSAGE => "Message",
            op::CHUNK => {
                self.chunks += 1;
                return format!("chunk {} at byte {}", self.chunks, self.offset);
            }
            op::MESSAGE_INDEX => "MessageIndex",
            op::CHUNK_INDEX => "ChunkIndex",
            op::ATTACHMENT => "Attachment",
            op::ATTACHMENT_INDEX => "AttachmentIndex",
            op::STATISTICS => "Statistics",
            op::METADATA => "Metadata",
            op::METADATA_INDEX => "MetadataIndex",
            op::SUMMARY_OFFSET => "SummaryOffset",
            op::DATA_END => "DataEnd",
            _ => "unknown record",
        };
        format!("{kind} at byte {}", self.offset)
    }

    fn corrupt(&self, record: String, problem: String) -> ReadError {
        ReadError::Corrupt { path: self.path.to_owned(), record, problem }
    }

    fn container_error(&self, error: McapError, length: u64) -> ReadError {
        match error {
            McapError::BadMagic if self.offset <= mcap::MAGIC.len() as u64 => {
                ReadError::NotMcap { path: self.path.to_owned() }
            }
            McapError::UnexpectedEof if length < mcap::MAGIC.len() as u64 => {
                ReadError::NotMcap { path: self.path.to_owned() }
            }
            McapError::UnexpectedEof | McapError::RecordTooLarge { .. } => ReadError::Truncated {
                path: self.path.to_owned(),
                at: self.length.unwrap_or(length),
                record: format!("the record after {}", self.last),
            },
            // Chunks have their own CRC and passed it, so the damage is in one of the others.
            McapError::BadDataCrc { .. } => self.corrupt(
                format!(
                    "data section, outside the contents of its chunks ({}, a MessageIndex or the header of a chunk)",
                    self.outside.join(", ")
                ),
                error.to_string(),
            ),
            McapError::BadSummaryCrc { .. } => self.corrupt("summary section".into(), error.to_string()),
            McapError::BadMagic => self.corrupt("magic bytes at the end of the file".into(), error.to_string()),
            other => self.corrupt(format!("the record after {}", self.last), other.to_string()),
        }
    }
}

/// What is wrong with the unit that the metadata of a waveform state: samples are SI.
fn unit_fault(quantity: QuantityKind, metadata: &BTreeMap<String, String>) -> Option<String> {
    let unit = metadata.get("unit").filter(|_| quantity != QuantityKind::Other)?;
    // As it is written by our programs first: the table of all spellings is long.
    let is_si = unit.is_empty() || unit == quantity.si_unit() || signal_unit(unit) == Some((quantity, 1.0));
    (!is_si).then(|| format!("the unit of the samples is {unit:?}, {quantity} is stored in {:?}", quantity.si_unit()))
}

fn wave_quantity(id: &str, metadata: &BTreeMap<String, String>, test: Option<&TestV1>) -> QuantityKind {
    let stated = metadata.get("quantity").and_then(|name| name.parse().ok());
    let suffix = || id.rsplit_once('/').and_then(|(_, last)| last.parse().ok());
    let listed = || test?.channels.iter().find(|c| c.id == id)?.quantity.parse().ok();
    stated.or_else(suffix).or_else(listed).unwrap_or(QuantityKind::Other)
}
