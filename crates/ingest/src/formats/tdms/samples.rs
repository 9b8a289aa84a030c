//! Raw samples as `f64`.

use crate::formats::tdms::bytes::Cursor;
use crate::formats::tdms::metadata::{Type, time};
use crate::formats::waveform::channel::Instant;

/// `count` samples, each at the start of `stride` bytes; the last may end where `raw` ends.
#[derive(Debug, Clone, Copy)]
pub struct Strided<'a> {
    /// The bytes, from the first sample on.
    pub raw: &'a [u8],
    /// Bytes from one sample to the next.
    pub stride: usize,
    /// How many there are.
    pub count: usize,
}

impl Strided<'_> {
    fn each<const N: usize>(self, big_endian: bool, out: &mut Vec<f64>, value: impl Fn([u8; N]) -> f64) {
        // A count is never believed further than the bytes go.
        out.reserve(self.count.min(self.raw.len()));
        let decode = |sample: &[u8]| {
            let mut array = [0; N];
            array.copy_from_slice(&sample[..N]);
            if big_endian {
                array.reverse();
            }
            value(array)
        };
        if self.stride == N {
            out.extend(self.raw.chunks_exact(N).take(self.count).map(decode));
        } else {
            out.extend(self.raw.chunks(self.stride).filter(|s| s.len() >= N).take(self.count).map(decode));
        }
    }
}

/// Numbers, added to `out`. Integers beyond 2^53 are rounded.
pub fn numbers(raw: Strided, kind: Type, big_endian: bool, out: &mut Vec<f64>) {
    match kind {
        Type::Int(1) => raw.each(big_endian, out, |b| f64::from(i8::from_le_bytes(b))),
        Type::Int(2) => raw.each(big_endian, out, |b| f64::from(i16::from_le_bytes(b))),
        Type::Int(4) => raw.each(big_endian, out, |b| f64::from(i32::from_le_bytes(b))),
        Type::Int(_) => raw.each(big_endian, out, |b| i64::from_le_bytes(b) as f64),
        Type::Unsigned(1) => raw.each(big_endian, out, |b| f64::from(u8::from_le_bytes(b))),
        Type::Unsigned(2) => raw.each(big_endian, out, |b| f64::from(u16::from_le_bytes(b))),
        Type::Unsigned(4) => raw.each(big_endian, out, |b| f64::from(u32::from_le_bytes(b))),
        Type::Unsigned(_) => raw.each(big_endian, out, |b| u64::from_le_bytes(b) as f64),
        Type::Single => raw.each(big_endian, out, |b| f64::from(f32::from_le_bytes(b))),
        Type::Double => raw.each(big_endian, out, f64::from_le_bytes),
        Type::Time | Type::Text | Type::Unread(..) => {}
    }
}

/// Times in seconds since `first`, the first one of all, so that nanoseconds are kept.
pub fn times(raw: Strided, big_endian: bool, first: &mut Option<Instant>, out: &mut Vec<f64>) {
    out.reserve(raw.count.min(raw.raw.len()));
    for sample in raw.raw.chunks(raw.stride).take(raw.count) {
        let Ok((fraction_s, seconds)) = time(&mut Cursor::new(sample, 0, big_endian)) else { continue };
        let instant = Instant { seconds, fraction_s };
        out.push(instant.since(*first.get_or_insert(instant)));
    }
}
