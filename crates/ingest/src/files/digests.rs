//! Digests of a record on the disk: by them a run knows whether it has read the record before.

use std::io::{self, Read};
use std::path::Path;

use crate::files::open::{Unchanging, companions_of, file_name, head, name_and_main_file, sidecar_of};
use crate::files::zip;
use crate::formats::reader::{Bundle, framed};
use crate::formats::registry::recognise;

/// Bytes read at once, into the same memory again and again.
const PIECE: usize = 1 << 18;
/// Start of a file by which its format is known, bytes.
const HEAD: u64 = 8192;

/// What a record is made of.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordDigests {
    /// The format.
    pub format: &'static str,
    /// Name of the file or folder that the user gave. It goes into the test description, so that a renamed copy is
    /// another input.
    pub name: String,
    /// [`Bundle::digest`].
    pub record: String,
    /// Of the sidecar, `blake3:<hex>`, where there is one.
    pub sidecar: Option<String>,
}

impl Bundle {
    /// Digests of what was read.
    pub fn digests(&self) -> RecordDigests {
        RecordDigests {
            format: self.reader.format,
            name: self.name.clone(),
            record: self.digest(),
            sidecar: self.sidecar.as_ref().map(|sidecar| text(blake3::hash(&sidecar.bytes))),
        }
    }

    /// [`Bundle::digests`] of the record at `path`, read piece by piece into the same memory. `None` of an archive,
    /// whose files must be unpacked, and of what cannot be read: [`Bundle::open`] says why.
    pub fn digests_at(path: &Path) -> Option<RecordDigests> {
        let (name, main_path) = name_and_main_file(path).ok()?;
        if !main_path.is_file() {
            return None;
        }
        let start = head(&main_path, HEAD).ok()?;
        let main_name = file_name(&main_path);
        if zip::is_zip(&start) {
            return None;
        }
        let reader = recognise(&main_name, &start).ok()?;
        let (companions, _) = companions_of(reader, &main_name, &main_path).ok()?;
        // They may lie in an archive.
        if reader.spans_folders && companions.is_empty() {
            return None;
        }
        let mut hasher = blake3::Hasher::new();
        let mut piece = vec![0; PIECE];
        if companions.is_empty() {
            add(&mut hasher, Unchanging::open(&main_path).ok()?, &mut piece).ok()?;
        } else {
            for (name, path) in std::iter::once((main_name, main_path.clone())).chain(companions) {
                let file = Unchanging::open(&path).ok()?;
                let length = file.stamp.length;
                hasher.update(&framed(&name, length));
                if add(&mut hasher, file, &mut piece).ok()? != length {
                    return None;
                }
            }
        }
        let sidecar = sidecar_of(&main_path, |_, _| Box::new(|_| ())).ok()?;
        Some(RecordDigests {
            format: reader.format,
            name,
            record: text(hasher.finalize()),
            sidecar: sidecar.map(|sidecar| text(blake3::hash(&sidecar.bytes))),
        })
    }
}

fn text(digest: blake3::Hash) -> String {
    format!("blake3:{}", digest.to_hex())
}

/// Takes all bytes of a file; their number.
fn add(hasher: &mut blake3::Hasher, mut file: Unchanging, piece: &mut [u8]) -> io::Result<u64> {
    let mut length = 0;
    loop {
        let count = file.read(piece)?;
        if count == 0 {
            return Ok(length);
        }
        hasher.update(&piece[..count]);
        length += count as u64;
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn the_digests_of_a_record_on_the_disk_are_those_of_what_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(&path, text).unwrap();
            path
        };
        let both = |path: &Path| {
            let read = Bundle::open(path).unwrap().digests();
            assert_eq!(Bundle::digests_at(path), Some(read.clone()), "{}", path.display());
            read
        };
        let long = "0.0001,-1.5\n".repeat(2 * PIECE / 12);
        let table = write("crash.csv", &format!("t [s],a [g]\n{long}"));
        let alone = both(&table);
        write("crash.csv.toml", "mass = \"873 kg\"\n");
        let with_sidecar = both(&table);
        assert_ne!(with_sidecar.sidecar, alone.sidecar);
        assert_eq!(with_sidecar.record, alone.record);

        let header = "Name of the channel :Test\nNumber of samples :1\n0\n";
        let first = write("test/Channel/98_7707.001", header);
        let description = write("test/98_7707.mme", "Data format edition number :1.3\nTest object 1 :Car\n");
        let one = both(&description);
        write("test/Channel/98_7707.002", header);
        let two = both(&description);
        assert_ne!(one.record, two.record);
        assert_eq!(both(&folder.path().join("test")).record, two.record);
        fs::write(&first, header.replace("\n0", "\n1")).unwrap();
        assert_ne!(both(&description).record, two.record);
    }

    #[test]
    fn an_archive_and_what_cannot_be_read_are_left_to_the_reading() {
        let folder = tempfile::tempdir().unwrap();
        let archive = folder.path().join("test.zip");
        fs::write(&archive, b"PK\x03\x04 and so on").unwrap();
        let empty = folder.path().join("empty.csv");
        fs::write(&empty, b"").unwrap();
        for path in [&archive, &empty, &folder.path().join("missing.csv"), Path::new("/dev/zero")] {
            assert_eq!(Bundle::digests_at(path), None, "{}", path.display());
        }
    }
}
