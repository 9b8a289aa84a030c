//! Numbers and texts at a place in a file, in either byte order. Nothing is allocated from a length that the file
//! does not hold.

/// What does not fit the format, and where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Broken {
    /// Offset of the byte from which it was read.
    pub at: usize,
    /// What was found.
    pub found: String,
}

/// A reading position in bytes.
#[derive(Debug, Clone)]
pub struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    big_endian: bool,
}

impl<'a> Cursor<'a> {
    /// Starts at offset `at`, which may lie past the end.
    pub fn new(bytes: &'a [u8], at: usize, big_endian: bool) -> Self {
        Self { bytes, at, big_endian }
    }

    /// Offset of the next byte.
    pub fn at(&self) -> usize {
        self.at
    }

    /// Whether numbers are read with the high byte first.
    pub fn is_big_endian(&self) -> bool {
        self.big_endian
    }

    /// The error of something read from offset `at`.
    pub fn broken<T>(at: usize, found: impl Into<String>) -> Result<T, Broken> {
        Err(Broken { at, found: found.into() })
    }

    /// The next `length` bytes.
    pub fn take(&mut self, length: usize) -> Result<&'a [u8], Broken> {
        let end = self.at.checked_add(length).filter(|end| *end <= self.bytes.len());
        match end {
            Some(end) => {
                let taken = &self.bytes[self.at..end];
                self.at = end;
                Ok(taken)
            }
            None => Self::broken(
                self.at,
                format!("{length} bytes should follow, {} are left", self.bytes.len().saturating_sub(self.at)),
            ),
        }
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Broken> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        if self.big_endian {
            array.reverse();
        }
        Ok(array)
    }

    /// An unsigned byte.
    pub fn u8(&mut self) -> Result<u8, Broken> {
        Ok(self.array::<1>()?[0])
    }

    /// Two bytes.
    pub fn u16(&mut self) -> Result<u16, Broken> {
        Ok(u16::from_le_bytes(self.array()?))
    }

    /// Four bytes.
    pub fn u32(&mut self) -> Result<u32, Broken> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    /// Eight bytes.
    pub fn u64(&mut self) -> Result<u64, Broken> {
        Ok(u64::from_le_bytes(self.array()?))
    }

    /// A length in four bytes and as many bytes of UTF-8; what is none is replaced.
    pub fn text(&mut self) -> Result<String, Broken> {
        let length = self.u32()? as usize;
        Ok(String::from_utf8_lossy(self.take(length)?).into_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_byte_orders_and_the_end() {
        let bytes = [1, 0, 0, 0, 2, 0, 0, 0, b'a', b'b'];
        assert_eq!(Cursor::new(&bytes, 0, false).u32(), Ok(1));
        assert_eq!(Cursor::new(&bytes, 0, true).u32(), Ok(1 << 24));
        assert_eq!(Cursor::new(&bytes, 4, false).text().as_deref(), Ok("ab"));
        let error = Cursor::new(&bytes, 8, false).u32().unwrap_err();
        assert_eq!((error.at, error.found.as_str()), (8, "4 bytes should follow, 2 are left"));
        assert!(Cursor::new(&bytes, 99, false).u8().is_err());
        assert!(Cursor::new(&[255, 255, 255, 255, 0], 0, false).text().is_err());
    }
}
