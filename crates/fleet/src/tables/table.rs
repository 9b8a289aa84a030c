//! A table in memory: named columns of one kind each.

use std::sync::Arc;

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
#[derive(Debug, Clone)]
pub(crate) struct Table {
    /// Name of its file without ending.
    pub(crate) name: &'static str,
    /// Columns.
    pub(crate) columns: Vec<Column>,
    /// Rows, a cell for each column.
    pub(crate) rows: Vec<Vec<Cell>>,
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
