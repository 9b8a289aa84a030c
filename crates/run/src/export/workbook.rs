//! Tables as a workbook: a sheet a table.

use crumple_stage::Refused;
use rust_xlsxwriter::{DocProperties, ExcelDateTime, Format, Workbook, XlsxError};

use crate::table::{Cell, Table};

/// Rows and columns that a sheet holds.
const ROWS: usize = 1_048_576;
const COLUMNS: usize = 16_384;
/// Characters that a cell holds.
const CHARACTERS: usize = 32_767;
/// Widest column, characters.
const WIDEST: usize = 60;
/// Rows that the width of a column is taken from.
const LOOKED_AT: usize = 200;

/// The bytes of the workbook. The same tables give the same bytes.
pub(crate) fn workbook(tables: &[Table]) -> anyhow::Result<Vec<u8>> {
    for table in tables {
        let (rows, columns) = (table.rows.len() + 1, table.columns.len());
        if rows > ROWS || columns > COLUMNS {
            let problem = format!("{} has {rows} rows and {columns} columns", table.name);
            return Err(Refused::new(problem)
                .expected(format!("at most {ROWS} rows and {COLUMNS} columns, which a sheet holds"))
                .hint("--what leaves tables out, --decimate 100 leaves rows of waves out and keeps their peaks")
                .into());
        }
    }
    Ok(written(tables)?)
}

fn written(tables: &[Table]) -> Result<Vec<u8>, XlsxError> {
    let mut workbook = Workbook::new();
    // Without a date the time of writing would stand in the file.
    let never = ExcelDateTime::from_ymd(2000, 1, 1)?;
    workbook.set_properties(&DocProperties::new().set_creation_datetime(&never));
    let bold = Format::new().set_bold();
    for table in tables {
        let sheet = workbook.add_worksheet();
        sheet.set_name(&*table.name)?;
        sheet.set_freeze_panes(1, 0)?;
        for (column, (name, _)) in (0_u16..).zip(&table.columns) {
            let cells = table.rows.iter().take(LOOKED_AT).filter_map(|row| row.get(usize::from(column)));
            let widest = cells.map(width).chain([name.chars().count()]).max().unwrap_or(0);
            sheet.set_column_width(column, widest.min(WIDEST) as f64 + 2.0)?;
            sheet.write_string_with_format(0, column, name, &bold)?;
        }
        for (number, row) in (1_u32..).zip(&table.rows) {
            for (column, cell) in (0_u16..).zip(row) {
                match cell {
                    Cell::Empty => continue,
                    Cell::Text(text) => {
                        sheet.write_string(number, column, text.chars().take(CHARACTERS).collect::<String>())?
                    }
                    Cell::Number(value) => sheet.write_number(number, column, *value)?,
                    Cell::Count(value) => sheet.write_number(number, column, *value as f64)?,
                    Cell::Flag(value) => sheet.write_boolean(number, column, *value)?,
                };
            }
        }
    }
    workbook.save_to_buffer()
}

fn width(cell: &Cell) -> usize {
    match cell {
        Cell::Empty => 0,
        Cell::Text(text) => text.chars().count(),
        Cell::Number(_) => 12,
        Cell::Count(value) => value.to_string().len(),
        Cell::Flag(_) => 5,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::{Kind, columns};

    #[test]
    fn the_same_tables_are_the_same_bytes_and_what_no_sheet_holds_is_refused() {
        let table = Table::new("t", columns(&[("x", Kind::Number)]), vec![vec![0.1.into()], vec!["=1+1".into()]]);
        let bytes = workbook(std::slice::from_ref(&table)).unwrap();
        std::thread::sleep(std::time::Duration::from_millis(1100));
        assert!(bytes == workbook(std::slice::from_ref(&table)).unwrap());
        let long = Table { rows: vec![Vec::new(); ROWS], ..table };
        let error = workbook(&[long]).unwrap_err().to_string();
        assert!(error.starts_with("t has 1048577 rows"), "{error}");
    }
}
