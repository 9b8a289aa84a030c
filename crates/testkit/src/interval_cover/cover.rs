//! Counts of intervals that hold the truth.

use std::collections::BTreeMap;
use std::fmt::Write as _;

/// The counts of one parameter.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Counts {
    /// Closed intervals with the truth inside.
    pub held: usize,
    /// Intervals that are open on a side: the record leaves the parameter open.
    pub open: usize,
    /// Widths of the closed intervals over the truth.
    pub widths: Vec<f64>,
}

/// A closed interval without the truth.
#[derive(Debug, Clone, PartialEq)]
pub struct Miss {
    /// Number of the record.
    pub record: usize,
    /// Name of the parameter.
    pub parameter: String,
    /// Its true value.
    pub truth: f64,
    /// The interval that was stated.
    pub interval: (f64, f64),
}

/// The counts of a family by parameter, and of records without a candidate.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Cover {
    /// By parameter.
    pub parameters: BTreeMap<String, Counts>,
    /// Records that gave no candidate.
    pub without: usize,
    /// Every closed interval that misses the truth, by the number of the record.
    pub misses: Vec<Miss>,
}

impl Cover {
    /// Adds another count of the same family.
    pub(super) fn add(&mut self, other: &Self) {
        self.without += other.without;
        for (name, more) in &other.parameters {
            let counts = self.parameters.entry(name.clone()).or_default();
            counts.held += more.held;
            counts.open += more.open;
            counts.widths.extend(&more.widths);
        }
        self.misses.extend(other.misses.iter().cloned());
    }

    /// Adds the interval that this record gives of a parameter whose true value is known.
    pub(super) fn count(
        &mut self,
        record: usize,
        (parameter, truth): (&str, f64),
        (low, high): (Option<f64>, Option<f64>),
    ) {
        let counts = self.parameters.entry(parameter.to_owned()).or_default();
        let Some((low, high)) = low.zip(high) else {
            counts.open += 1;
            return;
        };
        counts.widths.push((high - low) / truth);
        if low <= truth && truth <= high {
            counts.held += 1;
        } else {
            self.misses.push(Miss { record, parameter: parameter.to_owned(), truth, interval: (low, high) });
        }
    }

    /// Rows of a Markdown table: family, parameter, closed intervals, cover in percent, median width of the closed ones
    /// in percent of the truth, open, without a candidate.
    pub fn rows(&self, family: &str) -> String {
        let mut rows = String::new();
        for (name, counts) in &self.parameters {
            let closed = counts.widths.len();
            let percent = 100.0 * counts.held as f64 / closed as f64;
            let mut widths = counts.widths.clone();
            widths.sort_by(f64::total_cmp);
            let width = widths.get(closed / 2).map_or_else(|| "-".to_owned(), |width| format!("{:.1}", 100.0 * width));
            let cover = if closed > 0 { format!("{percent:.1}") } else { "-".to_owned() };
            let _infallible = writeln!(
                rows,
                "| {family} | {name} | {closed} | {cover} | {width} | {} | {} |",
                counts.open, self.without
            );
        }
        rows
    }
}

impl std::fmt::Display for Miss {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { record, parameter, truth, interval: (low, high) } = self;
        write!(f, "record {record}: {parameter} = {truth:.6e} is not in {low:.6e} to {high:.6e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_intervals_are_counted_apart_from_open_ones() {
        let mut cover = Cover::default();
        cover.count(0, ("k", 2.0), (Some(1.0), Some(3.0)));
        cover.count(1, ("k", 4.0), (Some(1.0), Some(3.0)));
        cover.count(2, ("k", 2.0), (None, Some(3.0)));
        assert_eq!(cover.parameters["k"], Counts { held: 1, open: 1, widths: vec![1.0, 0.5] });
        assert_eq!(cover.rows("x"), "| x | k | 2 | 50.0 | 100.0 | 1 | 0 |\n");
        assert_eq!(cover.misses[0].to_string(), "record 1: k = 4.000000e0 is not in 1.000000e0 to 3.000000e0");
    }
}
