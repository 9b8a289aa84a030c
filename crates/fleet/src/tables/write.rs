//! The tables of a fleet on disk.

use std::path::Path;

use anyhow::Context;
use crumple_artifact::{OutputKind, write_atomically};
use rayon::prelude::*;

use crate::tables::comma_separated::write_csv;
use crate::tables::parquet_file::write_parquet;
use crate::tables::table::Table;

/// Writes each table as Parquet and as CSV into a folder, each file in one piece.
pub(crate) fn write_tables(folder: &Path, tables: &[Table]) -> anyhow::Result<()> {
    tables.par_iter().try_for_each(|table| {
        let path = folder.join(format!("{}.parquet", table.name));
        let cannot_write = |path: &Path| format!("cannot write {}", path.display());
        write_atomically(&path, OutputKind::Table, |file| -> anyhow::Result<()> { Ok(write_parquet(table, file)?) })
            .with_context(|| cannot_write(&path))?;
        let path = folder.join(format!("{}.csv", table.name));
        write_atomically(&path, OutputKind::Table, |file| -> anyhow::Result<()> { Ok(write_csv(table, file)?) })
            .with_context(|| cannot_write(&path))
    })
}
