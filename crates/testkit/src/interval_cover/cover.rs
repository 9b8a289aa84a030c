//! Counts of intervals that hold the truth.

use std::collections::BTreeMap;
use std::fmt::Write as _;

/// The counts of one parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Closed intervals.
    pub closed: usize,
    /// Those of them with the truth inside.
    pub held: usize,
    /// Intervals that are open on a side: the record leaves the parameter open.
    pub open: usize,
}

/// The counts of a family by parameter, and of records without a candidate.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Cover {
    /// By parameter.
    pub parameters: BTreeMap<String, Counts>,
    /// Records that gave no candidate.
    pub without: usize,
}

impl Cover {
    /// Adds another count of the same family.
    pub(super) fn add(&mut self, other: &Self) {
        self.without += other.without;
        for (name, more) in &other.parameters {
            let counts = self.parameters.entry(name.clone()).or_default();
            counts.closed += more.closed;
            counts.held += more.held;
            counts.open += more.open;
        }
    }

    /// Adds the interval of a parameter whose true value is known.
    pub(super) fn count(&mut self, name: &str, truth: f64, (low, high): (Option<f64>, Option<f64>)) {
        let counts = self.parameters.entry(name.to_owned()).or_default();
        match low.zip(high) {
            Some((low, high)) => {
                counts.closed += 1;
                counts.held += usize::from(low <= truth && truth <= high);
            }
            None => counts.open += 1,
        }
    }

    /// Rows of a Markdown table: family, parameter, closed, cover in percent, open, without a candidate.
    pub fn rows(&self, family: &str) -> String {
        let mut rows = String::new();
        for (name, counts) in &self.parameters {
            let percent = 100.0 * counts.held as f64 / counts.closed as f64;
            let _infallible = writeln!(
                rows,
                "| {family} | {name} | {} | {} | {} | {} |",
                counts.closed,
                if counts.closed > 0 { format!("{percent:.1}") } else { "-".to_owned() },
                counts.open,
                self.without
            );
        }
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_intervals_are_counted_apart_from_open_ones() {
        let mut cover = Cover::default();
        cover.count("k", 2.0, (Some(1.0), Some(3.0)));
        cover.count("k", 4.0, (Some(1.0), Some(3.0)));
        cover.count("k", 2.0, (None, Some(3.0)));
        assert_eq!(cover.parameters["k"], Counts { closed: 2, held: 1, open: 1 });
        assert_eq!(cover.rows("x"), "| x | k | 2 | 50.0 | 1 | 0 |\n");
    }
}
