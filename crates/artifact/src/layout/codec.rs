//! The two encodings of a message. bincode is used here and nowhere else.
//!
//! bincode 2.0.1 with `config::legacy()`: little-endian, integers of fixed width, lengths as `u64`. The layout is
//! frozen by golden-bytes tests; see `docs/adr/0002-bincode.md` for the crate's state and the way out.

use std::fmt;

use serde::{Serialize, de::DeserializeOwned};

use crate::records::WaveBlockV1;

/// Most records are shorter in bincode, bytes.
const SMALL_RECORD: usize = 1 << 16;
/// Longest record in bincode, bytes. Waveforms are not read through serde.
const LARGEST_RECORD: usize = 1 << 26;

/// How the messages of one MCAP channel are encoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Codec {
    /// UTF-8 JSON.
    Json,
    /// bincode, fixed-int little-endian.
    Bincode,
}

impl Codec {
    /// The MCAP message encoding.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Json => "json",
            Self::Bincode => "bincode",
        }
    }

    /// The codec of an MCAP message encoding.
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "json" => Some(Self::Json),
            "bincode" => Some(Self::Bincode),
            _ => None,
        }
    }

    /// Encodes a value. Errors say what in the value cannot be encoded.
    pub fn encode<T: Serialize>(self, value: &T) -> Result<Vec<u8>, String> {
        match self {
            Self::Json => serde_json::to_vec(value).map_err(|e| e.to_string()),
            Self::Bincode => bincode::serde::encode_to_vec(value, bincode::config::legacy()).map_err(|e| e.to_string()),
        }
    }

    /// Decodes a value. Trailing bytes are an error: they mean another, longer type.
    pub fn decode<T: DeserializeOwned>(self, bytes: &[u8]) -> Result<T, String> {
        match self {
            Self::Json => serde_json::from_slice(bytes).map_err(|e| format!("JSON: {e}")),
            Self::Bincode => {
                // A length in the bytes reserves at most the limit before it is found to lie. The limit is a constant
                // of the type, so there are two.
                let config = bincode::config::legacy();
                let decoded = if bytes.len() <= SMALL_RECORD {
                    bincode::serde::decode_from_slice(bytes, config.with_limit::<SMALL_RECORD>())
                } else {
                    bincode::serde::decode_from_slice(bytes, config.with_limit::<LARGEST_RECORD>())
                };
                let (value, used) = decoded.map_err(|error| match error {
                    bincode::error::DecodeError::LimitExceeded => {
                        format!("bincode: a length in the record goes beyond its {} bytes", bytes.len())
                    }
                    other => format!("bincode: {other}"),
                })?;
                if used != bytes.len() {
                    return Err(format!("bincode: {} bytes left over after the record's {used}", bytes.len() - used));
                }
                Ok(value)
            }
        }
    }
}

impl fmt::Display for Codec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The bincode layout of a [`WaveBlockV1`] in words, as it stands in the metadata of every wave channel.
pub(crate) const WAVE_LAYOUT: &str = "little-endian: i64 t0_ns, f64 dt_s, u64 first, u64 n, n * f64 samples";

const WAVE_HEADER: usize = 32;

/// Encodes a wave block in bincode at the speed of a copy; the bytes are those of [`Codec::encode`].
pub(crate) fn encode_wave_block(t0_ns: i64, dt_s: f64, first: u64, samples: &[f64], bytes: &mut Vec<u8>) {
    bytes.clear();
    bytes.reserve(WAVE_HEADER + 8 * samples.len());
    bytes.extend_from_slice(&t0_ns.to_le_bytes());
    bytes.extend_from_slice(&dt_s.to_le_bytes());
    bytes.extend_from_slice(&first.to_le_bytes());
    bytes.extend_from_slice(&(samples.len() as u64).to_le_bytes());
    bytes.extend(samples.iter().flat_map(|x| x.to_le_bytes()));
}

/// Decodes a wave block.
pub(crate) fn decode_wave_block(codec: Codec, bytes: &[u8]) -> Result<WaveBlockV1, String> {
    if codec == Codec::Json {
        return codec.decode(bytes);
    }
    let word = |k: usize| -> Result<[u8; 8], String> {
        bytes
            .get(8 * k..8 * k + 8)
            .and_then(|b| b.try_into().ok())
            .ok_or_else(|| format!("bincode: a wave block has at least {WAVE_HEADER} bytes, found {}", bytes.len()))
    };
    let n = u64::from_le_bytes(word(3)?);
    let body = &bytes[WAVE_HEADER..];
    if (body.len() / 8) as u64 != n || !body.len().is_multiple_of(8) {
        return Err(format!("bincode: the block announces {n} samples, but {} bytes follow", body.len()));
    }
    Ok(WaveBlockV1 {
        t0_ns: i64::from_le_bytes(word(0)?),
        dt_s: f64::from_le_bytes(word(1)?),
        first: u64::from_le_bytes(word(2)?),
        samples: body.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap_or_default())).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fast_path_writes_and_reads_what_serde_does() {
        let block = WaveBlockV1 { t0_ns: -20_000_000, dt_s: 1e-4, first: 65_536, samples: vec![1.5, -0.0, 1e-300] };
        let slow = Codec::Bincode.encode(&block).unwrap();
        let mut fast = vec![9];
        encode_wave_block(block.t0_ns, block.dt_s, block.first, &block.samples, &mut fast);
        assert_eq!(fast, slow);
        assert_eq!(decode_wave_block(Codec::Bincode, &slow).unwrap(), block);
        assert_eq!(Codec::Bincode.decode::<WaveBlockV1>(&fast).unwrap(), block);
    }

    #[test]
    fn lengths_that_lie_are_refused() {
        let mut bytes =
            Codec::Bincode.encode(&WaveBlockV1 { t0_ns: 0, dt_s: 1.0, first: 0, samples: vec![1.0] }).unwrap();
        bytes[24..32].copy_from_slice(&(1_u64 << 40).to_le_bytes());
        assert!(decode_wave_block(Codec::Bincode, &bytes).is_err());
        assert!(Codec::Bincode.decode::<WaveBlockV1>(&bytes).is_err());
        assert!(decode_wave_block(Codec::Bincode, &bytes[..20]).is_err());
    }

    #[test]
    fn a_text_whose_length_lies_reserves_nothing() {
        let mut bytes = Codec::Bincode.encode(&"text".to_owned()).unwrap();
        for length in [1 << 17, 1 << 40, u64::MAX / 2, u64::MAX] {
            bytes[..8].copy_from_slice(&u64::to_le_bytes(length));
            let error = Codec::Bincode.decode::<String>(&bytes).unwrap_err();
            assert_eq!(error, "bincode: a length in the record goes beyond its 12 bytes");
        }
        // just above what is there: read and found short
        bytes[..8].copy_from_slice(&5_u64.to_le_bytes());
        assert!(Codec::Bincode.decode::<String>(&bytes).is_err());
    }

    #[test]
    fn records_up_to_the_limits_are_read() {
        for length in [SMALL_RECORD - 8, SMALL_RECORD - 7, SMALL_RECORD * 3] {
            let text = "x".repeat(length);
            let bytes = Codec::Bincode.encode(&text).unwrap();
            assert_eq!(Codec::Bincode.decode::<String>(&bytes).unwrap(), text);
        }
    }

    #[test]
    fn trailing_bytes_are_refused() {
        let mut bytes = Codec::Bincode.encode(&1_u32).unwrap();
        bytes.push(0);
        assert_eq!(
            Codec::Bincode.decode::<u32>(&bytes).unwrap_err(),
            "bincode: 1 bytes left over after the record's 4"
        );
    }
}
