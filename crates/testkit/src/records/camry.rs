//! The real record of the reference material with all that belongs to it.

use std::path::Path;
use std::{fs, io};

/// Writes an NHTSA record, all files beside `ev5` of its stem, with the load cells of its barrier from their archive,
/// as one folder, as it is downloaded. Errors: a file that cannot be read or written.
pub fn write_camry_with_load_cells(ev5: &Path, cells: &Path, into: &Path) -> io::Result<()> {
    fs::create_dir_all(into)?;
    for entry in fs::read_dir(ev5.parent().unwrap_or(ev5))? {
        let path = entry?.path();
        if let (true, Some(name)) = (path.file_stem() == ev5.file_stem(), path.file_name()) {
            fs::copy(&path, into.join(name))?;
        }
    }
    let mut cells = zip::ZipArchive::new(fs::File::open(cells)?)?;
    for place in 0..cells.len() {
        let mut entry = cells.by_index(place)?;
        let path = entry.enclosed_name().ok_or(io::ErrorKind::InvalidData)?;
        if let Some(name) = path.file_name() {
            io::copy(&mut entry, &mut fs::File::create(into.join(name))?)?;
        }
    }
    Ok(())
}
