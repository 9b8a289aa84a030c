//! The fields of a protobuf message as they stand in its bytes.

/// A field: its number in the type, and its value.
pub type WireField<'a> = (u32, WireValue<'a>);

/// A value by its wire type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WireValue<'a> {
    /// Type 0.
    Varint(u64),
    /// Type 1.
    Eight([u8; 8]),
    /// Type 2: texts, messages, packed numbers.
    Bytes(&'a [u8]),
    /// Type 5.
    Four([u8; 4]),
}

impl<'a> WireValue<'a> {
    /// The bytes of a text or a message.
    pub fn bytes(self) -> Option<&'a [u8]> {
        if let Self::Bytes(bytes) = self { Some(bytes) } else { None }
    }

    /// The bits of a varint.
    pub fn varint(self) -> Option<u64> {
        if let Self::Varint(bits) = self { Some(bits) } else { None }
    }
}

/// What is left of a message.
#[derive(Debug, Clone, Copy)]
pub struct WireReader<'a>(pub &'a [u8]);

impl<'a> WireReader<'a> {
    /// A number of up to 64 bits, seven to a byte, the lowest first.
    pub fn varint(&mut self) -> Option<u64> {
        let mut bits = 0;
        for k in 0..10 {
            let (byte, rest) = self.0.split_first()?;
            self.0 = rest;
            bits |= u64::from(byte & 0x7F) << (7 * k);
            if byte & 0x80 == 0 {
                return Some(bits);
            }
        }
        None
    }

    /// The next `N` bytes.
    pub fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (bytes, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*bytes)
    }

    /// The next field; `Some(None)` at the end, `None` where the bytes are no field. Groups, long out of use, are none.
    fn field(&mut self) -> Option<Option<WireField<'a>>> {
        if self.0.is_empty() {
            return Some(None);
        }
        let tag = self.varint()?;
        let number = u32::try_from(tag >> 3).ok().filter(|n| *n > 0)?;
        let raw = match tag & 7 {
            0 => WireValue::Varint(self.varint()?),
            1 => WireValue::Eight(self.take()?),
            2 => {
                let length = usize::try_from(self.varint()?).ok()?;
                let (bytes, rest) = self.0.split_at_checked(length)?;
                self.0 = rest;
                WireValue::Bytes(bytes)
            }
            5 => WireValue::Four(self.take()?),
            _ => return None,
        };
        Some(Some((number, raw)))
    }
}

/// Tells `each` field of a message in the order of its bytes. `None` if they are no message, or `each` says so.
pub fn for_each_field<'a>(message: &'a [u8], mut each: impl FnMut(u32, WireValue<'a>) -> Option<()>) -> Option<()> {
    let mut reader = WireReader(message);
    while let Some((number, raw)) = reader.field()? {
        each(number, raw)?;
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_come_as_the_encoding_guide_has_them() {
        // Field 1 = 150, field 2 = "testing": the two examples of the protobuf encoding guide.
        let bytes = [&[0x08, 0x96, 0x01, 0x12, 0x07][..], b"testing"].concat();
        let mut fields = Vec::new();
        for_each_field(&bytes, |number, raw| {
            fields.push((number, raw));
            Some(())
        })
        .unwrap();
        assert_eq!(fields, [(1, WireValue::Varint(150)), (2, WireValue::Bytes(b"testing"))]);
    }

    #[test]
    fn what_is_cut_short_or_too_long_is_no_message() {
        for bytes in [&[0x08][..], &[0x12, 0x07, b't'], &[0xFF; 11], &[0x00, 0x00], &[0x0B, 0x0C], &[0x09, 1, 2]] {
            assert_eq!(for_each_field(bytes, |_, _| Some(())), None, "{bytes:?}");
        }
    }
}
