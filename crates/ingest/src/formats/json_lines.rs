//! JSON lines: an object of numbers a line, such as loggers and web services write. A table whose columns are the paths
//! of the numbers, `acc.x`.

use std::collections::{BTreeMap, BTreeSet};

use crumple_signal::Notes;
use serde_json::Value;

use crate::formats::reader::{Bundle, Reader};
use crate::formats::remarks::{LateColumns, LinesNotUsed};
use crate::formats::table::layout::{COLUMN_LIMIT, Cells};
use crate::formats::table::numbers::Rows;
use crate::formats::table::{FLAGS_OF_ROWS, channels_of, header, recording};
use crate::recording::content::{LineNumbers, Recording, list};
use crate::recording::details::Details;
use crate::time::stamp;
use crate::{IngestSettings, Place, Result, refuse};

pub const JSON_LINES: Reader = Reader::of_one_file("json-lines", recognises, FLAGS_OF_ROWS, read);

/// Objects within objects.
const DEPTH: usize = 8;
/// Longest path that is a name, bytes.
const LONGEST_PATH: usize = 256;
/// An array of more numbers than this is no vector of a sample.
const LONGEST_ARRAY: usize = 16;
/// Most cells, as of a table in memory: a row of few numbers takes a cell of each column.
const CELL_LIMIT: usize = 1 << 24;
/// Names in a note.
const NAMED: usize = 12;

/// Whether the first two lines are an object of numbers each.
pub fn recognises(head: &[u8]) -> bool {
    let mut lines = head.split(|b| *b == b'\n').map(<[u8]>::trim_ascii).filter(|line| !line.is_empty());
    let is_row = |line: Option<&[u8]>| {
        line.filter(|line| line.starts_with(b"{"))
            .and_then(|line| serde_json::from_slice::<Value>(line).ok())
            .is_some_and(|value| cells(&value).len() > 1)
    };
    is_row(lines.next()) && is_row(lines.next())
}

/// The numbers and times of an object by their paths.
fn cells(value: &Value) -> BTreeMap<String, Value> {
    let mut cells = BTreeMap::new();
    collect(value, "", DEPTH, &mut cells);
    cells
}

fn collect(value: &Value, path: &str, depth: usize, into: &mut BTreeMap<String, Value>) {
    let below = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    if path.len() > LONGEST_PATH {
        return;
    }
    match value {
        Value::Number(_) => {
            into.insert(path.to_owned(), value.clone());
        }
        Value::String(text) if stamp(text).is_some() => {
            into.insert(path.to_owned(), value.clone());
        }
        Value::Object(fields) if depth > 0 => {
            fields.iter().for_each(|(key, inner)| collect(inner, &below(key), depth - 1, into));
        }
        Value::Array(items) if depth > 0 && items.len() <= LONGEST_ARRAY => {
            items.iter().enumerate().for_each(|(k, inner)| collect(inner, &below(&k.to_string()), depth - 1, into));
        }
        _ => {}
    }
}

fn read(bundle: &Bundle, settings: &IngestSettings) -> Result<Recording> {
    let (file, bytes) = (bundle.main.name.as_str(), bundle.main.bytes.as_slice());
    let mut names: Vec<String> = Vec::new();
    let mut rows = Rows {
        columns: Vec::new(),
        cells: Vec::new(),
        digits: Vec::new(),
        lines: LineNumbers::default(),
        left_out: Vec::new(),
        begins_late: false,
    };
    let mut notes = Notes::new();
    let (mut others, mut late) = (0_usize, BTreeSet::new());
    for (number, line) in (1..).zip(bytes.split(|b| *b == b'\n')) {
        let line = line.trim_ascii();
        if line.is_empty() {
            continue;
        }
        let value: Value = serde_json::from_slice(line).or_else(|error| {
            let hint = "correct or remove the line; a file that is cut short ends within one";
            refuse(Place::line(file, number), format!("no JSON: {error}"), "an object a line", hint)
        })?;
        let found = cells(&value);
        if names.is_empty() {
            names = found.keys().cloned().collect();
            if names.len() > COLUMN_LIMIT {
                let place = Place::line(file, number);
                let most = format!("at most {COLUMN_LIMIT}");
                return refuse(place, format!("{} numbers", names.len()), most, "keep the channels needed");
            }
            rows.columns = vec![Vec::new(); names.len()];
            rows.digits = vec![17; names.len()];
            let kind = |value: &Value| value.as_str().and_then(stamp).map_or(Cells::Numbers, Cells::Stamps);
            rows.cells = found.values().map(kind).collect();
        }
        // An event between the samples has a time, and none of their numbers.
        if names.iter().filter(|name| found.contains_key(*name)).count() < 2 {
            others += 1;
            continue;
        }
        if rows.lines.len() * names.len() >= CELL_LIMIT {
            let (place, most) = (Place::line(file, number), format!("at most {CELL_LIMIT} numbers"));
            let hint = "keep the channels needed, or convert the record to CSV, which is read in pieces";
            return refuse(place, format!("more than {CELL_LIMIT} numbers in {} columns", names.len()), most, hint);
        }
        if late.len() < NAMED {
            late.extend(found.keys().filter(|name| !names.contains(name)).cloned());
        }
        for ((name, column), cell) in names.iter().zip(&mut rows.columns).zip(&rows.cells) {
            column.push(match (found.get(name), cell) {
                (Some(Value::String(text)), Cells::Stamps(first)) => stamp(text).map_or(f64::NAN, |t| t.since(*first)),
                (Some(Value::Number(x)), Cells::Numbers) => x.as_f64().unwrap_or(f64::NAN),
                _ => f64::NAN,
            });
        }
        rows.lines.push(number);
    }
    if others > 0 {
        notes.push(LinesNotUsed { count: others, file: None, line: None });
    }
    if !late.is_empty() {
        let late: Vec<String> = late.into_iter().collect();
        notes.push(LateColumns { names: Some(list(&late)) });
    }
    let header = header::of_lines(vec![(1, names.clone())], names.len());
    let channels = channels_of(file, &header, rows, settings, (None, None), &mut notes)?;
    Ok(recording(channels, Details::default(), settings, notes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_of_numbers_are_rows() {
        assert!(recognises(b"{\"t\":0,\"a\":{\"x\":1}}\n{\"t\":1,\"a\":{\"x\":2}}\n"));
        assert!(!recognises(b"{\n\"General Test Info\": 1}\n"));
        assert!(!recognises(b"{\"t\":0}\n{\"t\":1}\n"));
        let found =
            cells(&serde_json::json!({"t": 0.5, "acc": {"x": 1, "y": [2, 3]}, "name": "x", "at": "10:00:01.5"}));
        assert_eq!(found.keys().collect::<Vec<_>>(), ["acc.x", "acc.y.0", "acc.y.1", "at", "t"]);
    }
}
