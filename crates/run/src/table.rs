//! A table of a fleet or of a run: in memory, as CSV, as Parquet.

use std::borrow::Cow;
use std::io::Write;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;

// Named columns of one kind each.

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Text.
    Text,
    /// A number.
    Number,
    /// A whole number.
    Count,
    /// Yes or no.
    Flag,
}

/// One value; every column may lack some.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Cell {
    /// Unknown.
    Empty,
    /// Text.
    Text(Arc<str>),
    /// A number.
    Number(f64),
    /// A whole number.
    Count(i64),
    /// Yes or no.
    Flag(bool),
}

/// A column: its name, with the unit of its numbers, and what it holds.
pub(crate) type Column = (String, Kind);

/// A table.
#[derive(Debug, Clone, Default)]
pub(crate) struct Table {
    /// Name of its file without ending.
    pub(crate) name: Cow<'static, str>,
    /// Columns.
    pub(crate) columns: Vec<Column>,
    /// Rows, a cell for each column.
    pub(crate) rows: Vec<Vec<Cell>>,
    /// Units of columns whose numbers are of one quantity, by their names.
    pub(crate) units: Vec<(String, &'static str)>,
}

impl Table {
    /// A table without units beside those in the names of its columns.
    pub(crate) fn new(name: impl Into<Cow<'static, str>>, columns: Vec<Column>, rows: Vec<Vec<Cell>>) -> Self {
        Self { name: name.into(), columns, rows, units: Vec::new() }
    }
}

impl From<Option<f64>> for Cell {
    fn from(value: Option<f64>) -> Self {
        value.filter(|value| value.is_finite()).map_or(Self::Empty, Self::Number)
    }
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        Some(value).into()
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        if text.is_empty() { Self::Empty } else { Self::Text(text.into()) }
    }
}

impl From<&String> for Cell {
    fn from(text: &String) -> Self {
        text.as_str().into()
    }
}

impl From<Option<&str>> for Cell {
    fn from(text: Option<&str>) -> Self {
        text.map_or(Self::Empty, Self::from)
    }
}

impl From<bool> for Cell {
    fn from(value: bool) -> Self {
        Self::Flag(value)
    }
}

/// Columns by their names and kinds.
pub(crate) fn columns(columns: &[(&str, Kind)]) -> Vec<Column> {
    columns.iter().map(|(name, kind)| ((*name).to_owned(), *kind)).collect()
}

// A table as a CSV file.

/// How a CSV file is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CsvForm {
    /// Comma and point, numbers in full.
    Plain,
    /// Comma and point, numbers as short as they read back.
    Sheet,
    /// With semicolon and decimal comma.
    Semicolon,
}

/// Writes a table: names of the columns, then the rows; what is unknown is empty. `'` stands in front of a text that a
/// spreadsheet would take for a formula.
pub(crate) fn write_csv(table: &Table, form: CsvForm, file: impl Write) -> Result<(), csv::Error> {
    let separator = if form == CsvForm::Semicolon { b';' } else { b',' };
    let mut writer = csv::WriterBuilder::new().delimiter(separator).from_writer(file);
    writer.write_record(table.columns.iter().map(|(name, _)| guarded(name).into_owned()))?;
    for row in &table.rows {
        writer.write_record(row.iter().map(|cell| text(cell, form)))?;
    }
    writer.flush()?;
    Ok(())
}

/// A text that no spreadsheet takes for a formula.
fn guarded(text: &str) -> Cow<'_, str> {
    if text.starts_with(['=', '+', '-', '@', '\t', '\r']) { format!("'{text}").into() } else { text.into() }
}

fn text(cell: &Cell, form: CsvForm) -> String {
    match cell {
        Cell::Empty => String::new(),
        Cell::Text(text) => guarded(text).into_owned(),
        Cell::Number(number) => {
            let mut plain = number.to_string();
            let short = format!("{number:e}");
            let is_shorter = form != CsvForm::Plain && short.len() < plain.len();
            // Readers that take the first rows for the type of a column see that it is no count.
            if number.fract() == 0.0 {
                plain += ".0";
            }
            let number = if is_shorter { short } else { plain };
            if form == CsvForm::Semicolon { number.replace('.', ",") } else { number }
        }
        Cell::Count(number) => number.to_string(),
        Cell::Flag(flag) => flag.to_string(),
    }
}

// A table as a Parquet file.

/// Rows of a row group: what a reader has in memory at a time.
const GROUP: usize = 50_000;

/// Writes a table, with the units of columns, each by the column's name, in the metadata of the file. The same table
/// gives the same bytes.
pub(crate) fn write_parquet(table: &Table, file: &mut (impl Write + Send)) -> Result<(), ParquetError> {
    let fields = table.columns.iter().map(field).collect::<Result<Vec<_>, _>>()?;
    let schema = Arc::new(Type::group_type_builder(&table.name).with_fields(fields).build()?);
    let units: Vec<KeyValue> =
        table.units.iter().map(|(name, unit)| KeyValue::new(name.clone(), (*unit).to_owned())).collect();
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_created_by("crumple-fleet".to_owned())
        .set_key_value_metadata(Some(units).filter(|units| !units.is_empty()))
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
    use std::fs;

    use super::Kind::{Count, Flag, Number, Text};
    use super::*;
    use parquet::file::reader::{FileReader, SerializedFileReader};

    fn written(table: &Table, form: CsvForm) -> String {
        let mut bytes = Vec::new();
        write_csv(table, form, &mut bytes).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn texts_are_quoted_and_gaps_stay_empty() {
        let rows = vec![vec!["a \"b\",\nc".into(), Cell::Empty], vec![Cell::Empty, 0.1.into()]];
        let table = Table::new("t", columns(&[("error", Text), ("mass_kg", Number)]), rows);
        assert_eq!(written(&table, CsvForm::Plain), "error,mass_kg\n\"a \"\"b\"\",\nc\",\n,0.1\n");
    }

    #[test]
    fn a_spreadsheet_sees_no_formula_and_numbers_read_back_to_the_bit() {
        let rows = [("@a", 0.1 + 0.2), ("-b", 1.5e-300), ("c", -2.0)].map(|(text, x)| vec![text.into(), x.into()]);
        let table = Table::new("t", columns(&[("=1+1", Text), ("x", Number)]), rows.into());
        assert_eq!(written(&table, CsvForm::Plain).lines().next(), Some("'=1+1,x"));
        for text in ["=1", "+1", "-1", "@a", "\t=1", "\r=1"] {
            assert_eq!(guarded(text), format!("'{text}"));
        }
        assert_eq!(written(&table, CsvForm::Sheet), "'=1+1,x\n'@a,0.30000000000000004\n'-b,1.5e-300\nc,-2.0\n");
        assert_eq!(written(&table, CsvForm::Semicolon), "'=1+1;x\n'@a;0,30000000000000004\n'-b;1,5e-300\nc;-2,0\n");
        for x in [f64::MIN_POSITIVE, f64::MAX, -0.0, 1.0 / 3.0, 5e-324, 123_456_789.123_456_79] {
            assert_eq!(text(&x.into(), CsvForm::Sheet).parse::<f64>().unwrap().to_bits(), x.to_bits());
        }
    }

    #[test]
    fn what_is_written_is_read_back_with_what_is_missing_and_the_units() {
        let units = vec![("mass_kg".to_owned(), "kg")];
        let table = Table {
            units,
            name: "t".into(),
            columns: columns(&[("record", Text), ("mass_kg", Number), ("exit_code", Count), ("physical", Flag)]),
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
        let noted = reader.metadata().file_metadata().key_value_metadata().unwrap();
        assert_eq!((noted[0].key.as_str(), noted[0].value.as_deref()), ("mass_kg", Some("kg")));
        let again = tempfile::NamedTempFile::new().unwrap();
        write_parquet(&table, &mut again.reopen().unwrap()).unwrap();
        assert_eq!(fs::read(file.path()).unwrap(), fs::read(again.path()).unwrap());
    }
}
