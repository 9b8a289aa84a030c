//! MATLAB files of version 5 (what `save` writes, `-v7` included): numeric vectors and matrices, and those in structs.
//!
//! An element is a type, a length and data; a variable is an element of elements. Written after "MAT-File Format" of
//! The MathWorks. Nothing is reserved by what a file states.

use std::io::Read as _;

use crumple_signal::Notes;

use crate::formats::reader::{Bundle, Reader};
use crate::formats::remarks::PartsNotRead;
use crate::formats::tdms::metadata::{Strided, Type, numbers};
use crate::formats::waveform::channel::Waveform;
use crate::formats::waveform::conversion;
use crate::recording::content::Recording;
use crate::recording::details::Details;
use crate::{IngestError, IngestSettings, Result};

/// Bytes before the first element.
const HEADER: usize = 128;
/// Most that a variable may take when unpacked, bytes.
const UNPACKED_LIMIT: u64 = 1 << 28;
const DEPTH: usize = 8;
/// More columns of a matrix than this are no channels.
const COLUMN_LIMIT: usize = 4096;

pub const MAT: Reader = Reader::of_one_file("mat", recognises, conversion::FLAGS, read);

fn recognises(head: &[u8]) -> bool {
    head.starts_with(b"MATLAB 5.0") && matches!(head.get(126..HEADER), Some(b"IM" | b"MI"))
}

fn read(bundle: &Bundle, settings: &IngestSettings) -> Result<Recording> {
    let (file, bytes) = (bundle.main.name.as_str(), bundle.main.bytes.as_slice());
    let mut found = Variables { big_endian: &bytes[126..HEADER] == b"MI", ..Variables::default() };
    let hint = "the file may be cut short: save it again, or export the variables by writetable as CSV";
    found
        .elements(&bytes[HEADER..], DEPTH)
        .map_err(|what| IngestError::content(file, what, "a whole MATLAB file of version 5", hint))?;
    let mut notes = Notes::new();
    if !found.unread.is_empty() {
        notes.push(PartsNotRead { parts: "variables", names: found.unread.join(", ") });
    }
    conversion::recording(file, found.waveforms, Details::default(), settings, notes)
}

#[derive(Default)]
struct Variables {
    big_endian: bool,
    waveforms: Vec<Waveform>,
    unread: Vec<String>,
    unpacked: u64,
}

/// What there is to say of bytes that are no element.
const CUT: &str = "an element is longer than the file";

impl Variables {
    fn u32(&self, bytes: &[u8]) -> Result<u32, String> {
        let bytes: [u8; 4] = bytes.get(..4).and_then(|b| b.try_into().ok()).ok_or(CUT)?;
        Ok(if self.big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }

    /// Type and data of the first element, and what follows it.
    fn element<'a>(&self, bytes: &'a [u8]) -> Result<(u32, &'a [u8], &'a [u8]), String> {
        let tag = self.u32(bytes)?;
        if tag >> 16 != 0 {
            // Four bytes at most stand in the tag itself.
            let data = bytes.get(4..4 + (tag >> 16) as usize).filter(|data| data.len() <= 4).ok_or(CUT)?;
            return Ok((tag & 0xFFFF, data, bytes.get(8..).unwrap_or_default()));
        }
        let length = self.u32(bytes.get(4..).ok_or(CUT)?)? as usize;
        let data = bytes.get(8..).and_then(|rest| rest.get(..length)).ok_or(CUT)?;
        // Compressed elements are not padded.
        let padded = if tag == 15 { length } else { length.next_multiple_of(8) };
        Ok((tag, data, bytes.get(8 + padded..).unwrap_or_default()))
    }

    /// The variables in a row of elements.
    fn elements(&mut self, bytes: &[u8], depth: usize) -> Result<(), String> {
        let mut rest = bytes;
        while !rest.is_empty() {
            let (kind, data, after) = self.element(rest)?;
            match kind {
                14 => self.matrix(data, "", None, depth)?,
                15 => {
                    let limit = UNPACKED_LIMIT.min(crumple_memory::left() / 2);
                    let mut unpacked = Vec::new();
                    let mut packed = flate2::read::ZlibDecoder::new(data).take(limit + 1);
                    packed
                        .read_to_end(&mut unpacked)
                        .map_err(|error| format!("a variable is not unpacked: {error}"))?;
                    self.unpacked += unpacked.len() as u64;
                    if self.unpacked > limit {
                        return Err(format!("more than {} MiB when unpacked", limit >> 20));
                    }
                    // One variable; what unpacks to further packed ones is none.
                    if let (14, data, _) = self.element(&unpacked)? {
                        self.matrix(data, "", None, depth)?;
                    }
                }
                _ => {}
            }
            rest = after;
        }
        Ok(())
    }

    /// A variable, or the field `name` of the struct `group`.
    fn matrix(&mut self, data: &[u8], group: &str, name: Option<&str>, depth: usize) -> Result<(), String> {
        if data.is_empty() {
            return Ok(());
        }
        let (_, flags, rest) = self.element(data)?;
        let flags = self.u32(flags)?;
        let (_, dimensions, rest) = self.element(rest)?;
        let sizes =
            dimensions.chunks_exact(4).map(|size| Ok(self.u32(size)? as usize)).collect::<Result<Vec<_>, String>>()?;
        let (_, own_name, rest) = self.element(rest)?;
        let name = name.map_or_else(|| String::from_utf8_lossy(own_name).into_owned(), str::to_owned);
        match flags & 0xFF {
            2 if depth > 0 && sizes.iter().all(|size| *size == 1) => {
                let group = if group.is_empty() { name } else { format!("{group}.{name}") };
                let (_, length, rest) = self.element(rest)?;
                let length = (self.u32(length)? as usize).max(1);
                let (_, names, mut rest) = self.element(rest)?;
                for field in names.chunks(length) {
                    let (_, data, after) = self.element(rest)?;
                    let end = field.iter().position(|b| *b == 0).unwrap_or(field.len());
                    self.matrix(data, &group, Some(&String::from_utf8_lossy(&field[..end])), depth - 1)?;
                    rest = after;
                }
            }
            // Complex numbers are none of a channel.
            6..=15 if flags & 0x800 == 0 && sizes.len() == 2 => {
                let (kind, data, _) = self.element(rest)?;
                let kind = match kind {
                    1 => Type::Int(1),
                    2 => Type::Unsigned(1),
                    3 => Type::Int(2),
                    4 => Type::Unsigned(2),
                    5 => Type::Int(4),
                    6 => Type::Unsigned(4),
                    7 => Type::Single,
                    9 => Type::Double,
                    12 => Type::Int(8),
                    13 => Type::Unsigned(8),
                    other => return Err(format!("{name} has numbers of an unknown type {other}")),
                };
                let mut values = Vec::new();
                let raw = Strided { raw: data, stride: kind.size(), count: data.len() / kind.size() };
                numbers(raw, kind, self.big_endian, &mut values);
                columns(group, &name, (sizes[0], sizes[1]), values, &mut self.waveforms);
            }
            _ => self.unread.push(name),
        }
        Ok(())
    }
}

/// The channels of a matrix: the shorter side counts them. Of several the first is the time if it increases.
pub fn columns(group: &str, name: &str, (rows, columns): (usize, usize), values: Vec<f64>, into: &mut Vec<Waveform>) {
    let count = rows.min(columns);
    if values.len() < 2 || count > COLUMN_LIMIT || rows.checked_mul(columns) != Some(values.len()) {
        return;
    }
    for k in 0..count {
        let channel: Vec<f64> = if columns <= rows {
            values[k * rows..(k + 1) * rows].to_vec()
        } else {
            values.iter().skip(k).step_by(rows).copied().collect()
        };
        let is_time = count > 1 && k == 0 && channel.windows(2).all(|pair| pair[1] > pair[0]);
        let title = match (count, is_time) {
            (1, _) => name.to_owned(),
            (_, true) => format!("{name}_time"),
            _ => format!("{name}_{}", k + 1),
        };
        into.push(Waveform { values: Ok(channel), ..Waveform::new(group, title) });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    proptest::proptest! {
        #[test]
        fn any_bytes_give_an_answer(
            bytes in proptest::collection::vec(proptest::num::u8::ANY, 0..200),
            big_endian: bool,
        ) {
            let _ = Variables { big_endian, ..Variables::default() }.elements(&bytes, DEPTH);
        }
    }
}
