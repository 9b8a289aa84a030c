//! Unpacks one chunk of an MCAP file, its CRC checked before anything in it is believed.

use std::collections::BTreeMap;
use std::io::Read;

use mcap::records::{self, MessageHeader, Record as McapRecord, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::decompress::add_decompressors;

/// A chunk may unpack to this much whatever its size, so that any ordinary writer's chunks fit.
const FREE_BYTES: u64 = 64 << 20;
/// Beyond that, the largest ratio of unpacked to packed bytes: constant signals reach it, decompression bombs exceed
/// it.
const MAX_RATIO: u64 = 4096;

/// What a channel and its schema say of a topic.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Topic {
    pub(crate) name: String,
    pub(crate) schema: String,
    pub(crate) encoding: String,
    pub(crate) metadata: BTreeMap<String, String>,
}

/// Schemas and channels seen so far.
#[derive(Debug, Default)]
pub(crate) struct Directory {
    schemas: BTreeMap<u16, String>,
    channels: BTreeMap<u16, Topic>,
}

impl Directory {
    pub(crate) fn schema(&mut self, id: u16, name: String) {
        self.schemas.insert(id, name);
    }

    pub(crate) fn channel(&mut self, channel: records::Channel) {
        let schema = self.schemas.get(&channel.schema_id).cloned().unwrap_or_default();
        self.channels.insert(
            channel.id,
            Topic { name: channel.topic, schema, encoding: channel.message_encoding, metadata: channel.metadata },
        );
    }

    pub(crate) fn topic(&self, channel_id: u16) -> Result<&Topic, String> {
        self.channels.get(&channel_id).ok_or_else(|| format!("a message names channel {channel_id}, which is unknown"))
    }

    pub(crate) fn topics(&self) -> impl Iterator<Item = &Topic> {
        self.channels.values()
    }
}

/// The messages of a chunk; its schemas and channels go into `directory`.
///
/// `body` is the chunk record without opcode and length. Everything is unpacked and its CRC checked first.
pub(crate) fn unpack(body: &[u8], directory: &mut Directory) -> Result<Vec<(MessageHeader, Vec<u8>)>, String> {
    let McapRecord::Chunk { header, .. } = mcap::parse_record(op::CHUNK, body).map_err(|e| e.to_string())? else {
        return Err("not a chunk".into());
    };
    let limit = FREE_BYTES.saturating_add(header.compressed_size.saturating_mul(MAX_RATIO));
    let size = header.uncompressed_size;
    if size > limit {
        return Err(format!("it announces {size} unpacked bytes for {} packed ones", header.compressed_size));
    }
    if size > crumple_memory::left() {
        return Err(format!("it announces {size} unpacked bytes, more than is left of the budget (--memory-limit)"));
    }
    // A reader of its own, fed with this record alone: it checks the CRC before it yields anything from inside.
    let mut reader = LinearReader::new_with_options(
        LinearReaderOptions::default()
            .with_skip_start_magic(true)
            .with_skip_end_magic(true)
            .with_prevalidate_chunk_crcs(true)
            .with_record_length_limit(usize::try_from(limit.max(body.len() as u64)).unwrap_or(usize::MAX)),
    );
    add_decompressors(&mut reader, size).map_err(|e| e.to_string())?;
    let mut prefix = [0; 9];
    prefix[0] = op::CHUNK;
    prefix[1..].copy_from_slice(&(body.len() as u64).to_le_bytes());
    let mut source = prefix.chain(body);
    let mut messages = Vec::new();
    while let Some(event) = reader.next_event() {
        match event.map_err(|e| e.to_string())? {
            LinearReadEvent::ReadRequest(need) => {
                let piece = need.min(prefix.len() + body.len());
                let read = source.read(reader.insert(piece)).map_err(|e| e.to_string())?;
                reader.notify_read(read);
            }
            LinearReadEvent::Record { opcode, data } => {
                match mcap::parse_record(opcode, data).map_err(|e| e.to_string())? {
                    McapRecord::Schema { header, .. } => directory.schema(header.id, header.name),
                    McapRecord::Channel(channel) => directory.channel(channel),
                    McapRecord::Message { header, data } => messages.push((header, data.into_owned())),
                    other => return Err(format!("record {:#04x} inside the chunk", other.opcode())),
                }
            }
        }
    }
    Ok(messages)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chunk that says how much is in it and holds nothing.
    fn announcing(size: u64) -> Vec<u8> {
        let times = [0_u64.to_le_bytes(), 0_u64.to_le_bytes()].concat();
        let compression = [4_u32.to_le_bytes().as_slice(), b"zstd"].concat();
        [times, size.to_le_bytes().to_vec(), vec![0; 4], compression, 0_u64.to_le_bytes().to_vec()].concat()
    }

    #[test]
    fn a_chunk_that_announces_more_than_it_can_hold_is_refused_before_it_is_unpacked() {
        let refused = |size| unpack(&announcing(size), &mut Directory::default()).unwrap_err();
        for size in [FREE_BYTES + 1, u64::MAX] {
            assert_eq!(refused(size), format!("it announces {size} unpacked bytes for 0 packed ones"));
        }
        assert!(!refused(FREE_BYTES).starts_with("it announces"), "{}", refused(FREE_BYTES));
    }
}
