//! Packed chunks where the libraries in C are absent: on Windows and in a browser.

use mcap::McapResult;
use mcap::sans_io::linear_reader::LinearReader;

/// Lets a reader unpack zstd and lz4 in every build. A chunk that unpacks to more than `limit` bytes is refused.
#[cfg(unix)]
pub fn add_decompressors(_: &mut LinearReader, _limit: u64) -> McapResult<()> {
    // The reader has them as features of its crate.
    Ok(())
}

/// Lets a reader unpack zstd and lz4 in every build. A chunk that unpacks to more than `limit` bytes is refused.
#[cfg(not(unix))]
pub fn add_decompressors(reader: &mut LinearReader, limit: u64) -> McapResult<()> {
    reader.add_decompressor(in_rust::Frames::zstd(limit))?;
    reader.add_decompressor(in_rust::Frames::lz4(limit))
}

#[cfg(any(not(unix), test))]
mod in_rust {
    use std::io::{self, Read};

    use mcap::sans_io::decompressor::{DecompressResult, Decompressor};
    use mcap::{McapError, McapResult};

    /// Unpacks one frame from the start of `packed`, which it moves behind it.
    type Unpack = fn(packed: &mut &[u8], limit: u64) -> io::Result<Vec<u8>>;

    /// A decompressor that waits until a frame is whole and unpacks it at once.
    pub struct Frames {
        name: &'static str,
        unpack: Unpack,
        limit: u64,
        unpacked: Vec<u8>,
        given: usize,
    }

    impl Frames {
        pub fn zstd(limit: u64) -> Self {
            Self { name: "zstd", unpack: zstd, limit, unpacked: Vec::new(), given: 0 }
        }

        pub fn lz4(limit: u64) -> Self {
            Self { name: "lz4", unpack: lz4, limit, unpacked: Vec::new(), given: 0 }
        }
    }

    impl Decompressor for Frames {
        fn next_read_size(&self) -> usize {
            0
        }

        fn decompress(&mut self, src: &[u8], dst: &mut [u8]) -> McapResult<DecompressResult> {
            let mut rest = src;
            if self.given == self.unpacked.len() {
                // A frame that is cut short: the reader comes again with more of it, or refuses the chunk at its end.
                let Ok(frame) = (self.unpack)(&mut rest, self.limit) else {
                    return Ok(DecompressResult { consumed: 0, wrote: 0 });
                };
                if frame.len() as u64 > self.limit {
                    let problem = format!("it unpacks to more than {} bytes", self.limit);
                    return Err(McapError::DecompressionError(problem));
                }
                (self.unpacked, self.given) = (frame, 0);
            }
            let wrote = dst.len().min(self.unpacked.len() - self.given);
            dst[..wrote].copy_from_slice(&self.unpacked[self.given..self.given + wrote]);
            self.given += wrote;
            Ok(DecompressResult { consumed: src.len() - rest.len(), wrote })
        }

        fn reset(&mut self) -> McapResult<()> {
            (self.unpacked, self.given) = (Vec::new(), 0);
            Ok(())
        }

        fn name(&self) -> &'static str {
            self.name
        }
    }

    fn zstd(packed: &mut &[u8], limit: u64) -> io::Result<Vec<u8>> {
        let decoder = ruzstd::decoding::StreamingDecoder::new(packed).map_err(io::Error::other)?;
        at_most(decoder, limit)
    }

    fn lz4(packed: &mut &[u8], limit: u64) -> io::Result<Vec<u8>> {
        at_most(lz4_flex::frame::FrameDecoder::new(packed), limit)
    }

    /// One byte more than the limit is enough to see that it is exceeded.
    fn at_most(source: impl Read, limit: u64) -> io::Result<Vec<u8>> {
        let mut unpacked = Vec::new();
        source.take(limit.saturating_add(1)).read_to_end(&mut unpacked)?;
        Ok(unpacked)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::io::{Cursor, Read};

    use mcap::records::MessageHeader;
    use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReaderOptions};
    use mcap::{Compression, McapResult};

    use super::*;

    /// A file of one packed chunk with 40 messages of 10 kB.
    fn packed(compression: Compression) -> Vec<u8> {
        let mut writer =
            mcap::WriteOptions::new().compression(Some(compression)).create(Cursor::new(Vec::new())).unwrap();
        let channel = writer.add_channel(0, "/x", "json", &BTreeMap::new()).unwrap();
        for k in 0..40_u32 {
            let header = MessageHeader { channel_id: channel, sequence: k, log_time: 0, publish_time: 0 };
            let bytes: Vec<u8> = (0..10_000_u32).map(|i| (i * (k + 1) / 7) as u8).collect();
            writer.write_to_known_channel(&header, &bytes).unwrap();
        }
        writer.finish().unwrap();
        writer.into_inner().into_inner()
    }

    /// All records of a file, with the decompressors of C or those in Rust.
    fn records(mut bytes: &[u8], in_rust_with_limit: Option<u64>) -> McapResult<Vec<Vec<u8>>> {
        let mut reader = LinearReader::new_with_options(LinearReaderOptions::default().with_validate_chunk_crcs(true));
        if let Some(limit) = in_rust_with_limit {
            reader.add_decompressor(in_rust::Frames::zstd(limit))?;
            reader.add_decompressor(in_rust::Frames::lz4(limit))?;
        }
        let mut records = Vec::new();
        while let Some(event) = reader.next_event() {
            match event? {
                LinearReadEvent::ReadRequest(need) => {
                    let read = bytes.read(reader.insert(need.min(1000))).unwrap();
                    reader.notify_read(read);
                }
                LinearReadEvent::Record { data, .. } => records.push(data.to_vec()),
            }
        }
        Ok(records)
    }

    #[test]
    fn chunks_unpack_without_c_to_the_same_records() {
        for compression in [Compression::Zstd, Compression::Lz4] {
            let file = packed(compression);
            let expected = records(&file, None).unwrap();
            assert!(expected.len() > 40);
            assert_eq!(records(&file, Some(1 << 20)).unwrap(), expected);
            let error = records(&file, Some(1000)).unwrap_err().to_string();
            assert!(error.contains("it unpacks to more than 1000 bytes"), "{error}");
            let mut damaged = file.clone();
            damaged[file.len() / 2] ^= 0xff;
            assert!(records(&damaged, Some(1 << 20)).is_err());
        }
    }
}
