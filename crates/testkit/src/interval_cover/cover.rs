//! Counts of intervals that hold the truth.

use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Closed intervals of one kind.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Closed {
    /// Those with the truth inside.
    pub held: usize,
    /// Their widths over the truth.
    pub widths: Vec<f64>,
}

/// The counts of one parameter.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Counts {
    /// Closed intervals of records that determine the parameter, as the report says it.
    pub determined: Closed,
    /// Other closed intervals: the parameter is open, or known to an order of magnitude only.
    pub not_determined: Closed,
    /// Intervals that are open on a side.
    pub open: usize,
}

impl Closed {
    fn add(&mut self, other: &Self) {
        self.held += other.held;
        self.widths.extend(&other.widths);
    }

    /// How many, and how many in a hundred hold the truth.
    fn cells(&self) -> String {
        let count = self.widths.len();
        match count {
            0 => "0 | -".to_owned(),
            _ => format!("{count} | {:.1}", 100.0 * self.held as f64 / count as f64),
        }
    }

    /// Median width in percent of the truth.
    fn width(&self) -> String {
        let mut widths = self.widths.clone();
        widths.sort_by(f64::total_cmp);
        widths.get(widths.len() / 2).map_or_else(|| "-".to_owned(), |width| format!("{:.1}", 100.0 * width))
    }
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
            counts.determined.add(&more.determined);
            counts.not_determined.add(&more.not_determined);
            counts.open += more.open;
        }
        self.misses.extend(other.misses.iter().cloned());
    }

    /// Adds the interval that this record gives of a parameter whose true value is known.
    pub(super) fn count(
        &mut self,
        record: usize,
        (parameter, truth, is_determined): (&str, f64, bool),
        (low, high): (Option<f64>, Option<f64>),
    ) {
        let counts = self.parameters.entry(parameter.to_owned()).or_default();
        let Some((low, high)) = low.zip(high) else {
            counts.open += 1;
            return;
        };
        let closed = if is_determined { &mut counts.determined } else { &mut counts.not_determined };
        closed.widths.push((high - low) / truth);
        if low <= truth && truth <= high {
            closed.held += 1;
        } else {
            self.misses.push(Miss { record, parameter: parameter.to_owned(), truth, interval: (low, high) });
        }
    }

    /// All closed intervals: how many hold the truth, of how many, and the median width in percent of the truth of
    /// those of parameters whose name ends so.
    pub(super) fn held(&self, unit: &str) -> (usize, usize, String) {
        let mut all = Closed::default();
        let mut of_unit = Closed::default();
        for (name, counts) in &self.parameters {
            for closed in [&counts.determined, &counts.not_determined] {
                all.add(closed);
                if name.ends_with(unit) {
                    of_unit.add(closed);
                }
            }
        }
        (all.held, all.widths.len(), of_unit.width())
    }

    /// What stands over the [`rows`](Self::rows).
    pub const HEAD: &str = "| family | parameter | determined | cover, % | median width, % | closed, not determined | \
                            cover, % | open | records without a candidate |\n|---|---|---|---|---|---|---|---|---|";

    /// Rows of a Markdown table: family, parameter; of records that determine it how many, cover and median width in
    /// percent of the truth; other closed intervals and their cover; open, without a candidate.
    pub fn rows(&self, family: &str) -> String {
        let mut rows = String::new();
        for (name, counts) in &self.parameters {
            let (determined, others) = (&counts.determined, &counts.not_determined);
            let _infallible = writeln!(
                rows,
                "| {family} | {name} | {} | {} | {} | {} | {} |",
                determined.cells(),
                determined.width(),
                others.cells(),
                counts.open,
                self.without
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
        cover.count(0, ("k", 2.0, true), (Some(1.0), Some(3.0)));
        cover.count(1, ("k", 4.0, true), (Some(1.0), Some(3.0)));
        cover.count(2, ("k", 2.0, false), (None, Some(3.0)));
        cover.count(3, ("k", 2.0, false), (Some(1e-4), Some(3.0)));
        let mut both = cover.clone();
        both.add(&cover);
        let counts = &cover.parameters["k"];
        assert_eq!(counts.determined, Closed { held: 1, widths: vec![1.0, 0.5] });
        assert_eq!((counts.not_determined.held, counts.open), (1, 1));
        assert_eq!(cover.held("k"), (2, 3, "100.0".to_owned()));
        assert_eq!(cover.held("c"), (2, 3, "-".to_owned()));
        assert_eq!(cover.rows("x"), "| x | k | 2 | 50.0 | 100.0 | 1 | 100.0 | 1 | 0 |\n");
        assert_eq!(both.rows("x"), "| x | k | 4 | 50.0 | 100.0 | 2 | 100.0 | 2 | 0 |\n");
        assert_eq!(cover.misses[0].to_string(), "record 1: k = 4.000000e0 is not in 1.000000e0 to 3.000000e0");
    }
}
