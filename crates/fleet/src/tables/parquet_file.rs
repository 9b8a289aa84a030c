//! A table as a Parquet file.

use std::io::Write;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;

use crate::tables::table::{Cell, Column, Kind, Table};

/// Rows of a row group: what a reader has in memory at a time.
const GROUP: usize = 50_000;

/// Writes a table. The same table gives the same bytes.
pub(crate) fn write_parquet(table: &Table, file: &mut (impl Write + Send)) -> Result<(), ParquetError> {
    let fields = table.columns.iter().map(field).collect::<Result<Vec<_>, _>>()?;
    let schema = Arc::new(Type::group_type_builder(table.name).with_fields(fields).build()?);
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_created_by("crumple-fleet".to_owned())
        .build();
    let mut writer = SerializedFileWriter::new(file, schema, Arc::new(properties))?;
    for rows in table.rows.chunks(GROUP) {
        let mut group = writer.next_row_group()?;
        for (number, (_, kind)) in table.columns.iter().enumerate() {
            let cells = rows.iter().map(|row| row.get(number).unwrap_or(&Cell::Empty));
            let Some(mut column) = group.next_column()? else { break };
            write_column(&mut column, *kind, cells)?;
            column.close()?;
        }
        group.close()?;
    }
    writer.close()?;
    Ok(())
}

fn field((name, kind): &Column) -> Result<Arc<Type>, ParquetError> {
    let (physical, logical) = match kind {
        Kind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        Kind::Number => (Physical::DOUBLE, None),
        Kind::Count => (Physical::INT64, None),
        Kind::Flag => (Physical::BOOLEAN, None),
    };
    let field = Type::primitive_type_builder(name, physical).with_logical_type(logical);
    Ok(Arc::new(field.with_repetition(Repetition::OPTIONAL).build()?))
}

fn write_column<'a>(
    column: &mut SerializedColumnWriter<'_>,
    kind: Kind,
    cells: impl Iterator<Item = &'a Cell> + Clone,
) -> Result<(), ParquetError> {
    let is_there: Vec<i16> = cells.clone().map(|cell| i16::from(*cell != Cell::Empty)).collect();
    macro_rules! write {
        ($type:ty, $pattern:pat => $value:expr) => {{
            let values: Vec<_> =
                cells.filter_map(|cell| if let $pattern = cell { Some($value) } else { None }).collect();
            column.typed::<$type>().write_batch(&values, Some(&is_there), None)?;
        }};
    }
    match kind {
        Kind::Text => write!(ByteArrayType, Cell::Text(text) => ByteArray::from(&**text)),
        Kind::Number => write!(DoubleType, Cell::Number(number) => *number),
        Kind::Count => write!(Int64Type, Cell::Count(number) => *number),
        Kind::Flag => write!(BoolType, Cell::Flag(flag) => *flag),
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use parquet::file::reader::{FileReader, SerializedFileReader};

    use super::*;
    use crate::tables::table::columns;

    #[test]
    fn what_is_written_is_read_back_with_what_is_missing() {
        let table = Table {
            name: "t",
            columns: columns(&[
                ("record", Kind::Text),
                ("mass_kg", Kind::Number),
                ("exit_code", Kind::Count),
                ("physical", Kind::Flag),
            ]),
            rows: vec![
                vec!["a".into(), 873.25.into(), Cell::Count(4), true.into()],
                vec!["b".into(), Cell::Empty, Cell::Count(0), Cell::Empty],
            ],
        };
        let file = tempfile::NamedTempFile::new().unwrap();
        write_parquet(&table, &mut file.reopen().unwrap()).unwrap();
        let reader = SerializedFileReader::new(file.reopen().unwrap()).unwrap();
        let rows: Vec<String> = reader.get_row_iter(None).unwrap().map(|row| row.unwrap().to_string()).collect();
        assert_eq!(
            rows,
            [
                "{record: \"a\", mass_kg: 873.25, exit_code: 4, physical: true}",
                "{record: \"b\", mass_kg: null, exit_code: 0, physical: null}",
            ]
        );
        let again = tempfile::NamedTempFile::new().unwrap();
        write_parquet(&table, &mut again.reopen().unwrap()).unwrap();
        assert_eq!(std::fs::read(file.path()).unwrap(), std::fs::read(again.path()).unwrap());
    }
}
