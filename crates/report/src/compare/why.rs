//! The change between two runs, divided among its causes.

use serde::Serialize;

use super::quantities::{Group, Quantity};

/// The change of every number that is beyond its limit, in parts.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Divided {
    /// What differs, in the order of the chain: `record`, `ingest.mass`, `filter.cfc`, `program of filter`.
    pub causes: Vec<String>,
    /// How often the chain was run for it.
    pub runs: usize,
    /// One a number.
    pub numbers: Vec<DividedNumber>,
    /// Numbers beyond their limit that a run with some of the causes does not have: they cannot be divided.
    pub undivided: Vec<String>,
    /// Parameters beyond their limit that a run does not determine: their values are one of many, and have no causes.
    pub undetermined: Vec<String>,
}

/// The change of one number in parts.
#[derive(Debug, Clone, Serialize)]
pub struct DividedNumber {
    /// What it is of.
    pub group: Group,
    /// Its name, which stays the same from run to run.
    pub name: String,
    /// Before, SI.
    pub from: f64,
    /// After, SI.
    pub to: f64,
    /// The share of each cause, SI; they add up to the change.
    pub shares: Vec<f64>,
    /// Before, after, change, and the shares, as they are shown.
    #[serde(skip)]
    shown: Vec<String>,
}

impl DividedNumber {
    /// Of a row whose first value is before and whose last is after.
    pub fn new(row: &Quantity, [from, to]: [f64; 2], shares: Vec<f64>) -> Self {
        let ends = [row.name.clone(), row.shown(0), row.shown(row.values.len() - 1), row.difference(to - from)];
        let shown = ends.into_iter().chain(shares.iter().map(|share| row.difference(*share))).collect();
        Self { group: row.group, name: row.key.clone(), from, to, shares, shown }
    }
}

impl Divided {
    /// As lines of a terminal, at most `most` numbers: a row a number, a column a cause.
    pub fn lines(&self, most: usize) -> Vec<String> {
        if self.causes.is_empty() {
            return vec!["why: no option, record or program differs".to_owned()];
        }
        let counted = |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
        let (causes, runs) = (counted(self.causes.len(), "cause"), counted(self.runs, "more run"));
        let mut lines = vec![format!("why: {causes}, by {runs}")];
        let heads = ["", "before", "after", "change"].map(str::to_owned).into_iter();
        let heads: Vec<String> = heads.chain(self.causes.iter().cloned()).collect();
        let table: Vec<&Vec<String>> =
            std::iter::once(&heads).chain(self.numbers.iter().take(most).map(|n| &n.shown)).collect();
        let width = |k: usize| table.iter().map(|row| row[k].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..heads.len()).map(width).collect();
        if self.numbers.is_empty() {
            lines.push("no number that can be divided is beyond its limit".to_owned());
        } else {
            lines.extend(table.iter().map(|row| {
                let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}"));
                cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
            }));
        }
        let left = self.numbers.len().saturating_sub(most);
        if left > 0 {
            lines.push(format!("and {left} more: --all"));
        }
        if !self.undivided.is_empty() {
            let names = self.undivided.join(", ");
            lines.push(format!("not divided, since a run with some of the causes does not have it: {names}"));
        }
        if !self.undetermined.is_empty() {
            let (count, names) = (counted(self.undetermined.len(), "parameter"), self.undetermined.join(", "));
            lines.push(format!("not divided, since a run does not determine them: {count}, {names}"));
        }
        lines
    }
}
