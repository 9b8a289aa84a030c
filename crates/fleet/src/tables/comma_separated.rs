//! A table as a CSV file.

use std::io::Write;

use crate::tables::table::{Cell, Table};

/// Writes a table: names of the columns, then the rows; what is unknown is empty, numbers are in full.
pub(crate) fn write_csv(table: &Table, file: impl Write) -> Result<(), csv::Error> {
    let mut writer = csv::Writer::from_writer(file);
    writer.write_record(table.columns.iter().map(|(name, _)| name))?;
    for row in &table.rows {
        writer.write_record(row.iter().map(text))?;
    }
    writer.flush()?;
    Ok(())
}

fn text(cell: &Cell) -> String {
    match cell {
        Cell::Empty => String::new(),
        Cell::Text(text) => text.to_string(),
        Cell::Number(number) => number.to_string(),
        Cell::Count(number) => number.to_string(),
        Cell::Flag(flag) => flag.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::table::{Kind, columns};

    #[test]
    fn texts_are_quoted_and_gaps_stay_empty() {
        let table = Table {
            name: "t",
            columns: columns(&[("error", Kind::Text), ("mass_kg", Kind::Number)]),
            rows: vec![vec!["a \"b\",\nc".into(), Cell::Empty], vec![Cell::Empty, 0.1.into()]],
        };
        let mut bytes = Vec::new();
        write_csv(&table, &mut bytes).unwrap();
        assert_eq!(String::from_utf8(bytes).unwrap(), "error,mass_kg\n\"a \"\"b\"\",\nc\",\n,0.1\n");
    }
}
