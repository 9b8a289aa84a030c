//! How often intervals hold the truth.

use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Counts by quantity: intervals, and those that hold the truth.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Counts(BTreeMap<(&'static str, String), (usize, usize)>);

/// Nominal level of all of them.
const LEVEL: f64 = 0.9;
/// Standard deviations of the binomial count by which it may be lower; one in a thousand counts is.
const ALLOWANCE: f64 = 3.1;

impl Counts {
    /// Counts an interval of what `kind` has of a quantity.
    pub fn add(&mut self, kind: &'static str, quantity: &str, holds: bool) {
        let (all, held) = self.0.entry((kind, quantity.to_owned())).or_default();
        *all += 1;
        *held += usize::from(holds);
    }

    /// Quantities that hold the truth less often than their level says, chance allowed for.
    pub fn too_low(&self) -> Vec<String> {
        let is_low = |all: usize, held: usize| {
            let all = all as f64;
            (held as f64) < LEVEL * all - ALLOWANCE * (all * LEVEL * (1.0 - LEVEL)).sqrt()
        };
        let low = self.0.iter().filter(|(_, (all, held))| is_low(*all, *held));
        low.map(|((kind, quantity), (all, held))| format!("{kind} {quantity}: {held} of {all} intervals hold"))
            .collect()
    }

    /// Lines of a table: of what, quantity, how many of how many.
    pub fn table(&self) -> String {
        let mut out = "\n| 90 % intervals | quantity | hold the truth |\n|---|---|---|\n".to_owned();
        for ((kind, quantity), (all, held)) in &self.0 {
            let _infallible = writeln!(out, "| {kind} | {quantity} | {held} of {all} |");
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chance_is_allowed_for() {
        let mut counts = Counts::default();
        for k in 0..40 {
            counts.add("of a test", "enough", k % 5 != 0);
            counts.add("of a test", "few", k % 3 != 0);
        }
        assert_eq!(counts.too_low(), ["of a test few: 26 of 40 intervals hold"]);
    }
}
