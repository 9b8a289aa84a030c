//! How a quantity is distributed over the runs.

use std::fmt::Write as _;

use crate::page::quantities::Quantity;
use crate::page::scatter::{BOTTOM, HEIGHT, Range, frame, x_of, y_of};
use crate::tables::rows::Row;

/// Bars of a figure.
const BARS: usize = 24;

/// Numbers of runs by value; empty where fewer than two have one.
pub(crate) fn histogram(rows: &[Row], quantity: Quantity) -> String {
    let values: Vec<f64> = rows.iter().filter_map(quantity.of).collect();
    if values.len() < 2 {
        return String::new();
    }
    let range = Range::of(values.iter().copied());
    let mut counts = [0_u32; BARS];
    for value in &values {
        counts[((range.place(*value) * BARS as f64) as usize).min(BARS - 1)] += 1;
    }
    let most = counts.iter().copied().max().unwrap_or(1);
    let heights = Range::of_counts(f64::from(most));
    let mut svg = frame(range, heights, &quantity.label(), "runs");
    let mut bars = String::new();
    for (number, count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        let [from, to] = [number, number + 1].map(|edge| x_of(edge as f64 / BARS as f64));
        let top = y_of(heights.place(f64::from(*count)));
        // Writing to a string does not fail.
        let _ = write!(bars, "M{from:.1} {:.0}V{top:.1}H{:.1}V{:.0}Z", HEIGHT - BOTTOM, to - 1.0, HEIGHT - BOTTOM);
    }
    let _ = write!(svg, "<path class=b d=\"{bars}\"/>");
    format!("<figure><figcaption>{}</figcaption>{svg}</svg></figure>", quantity.label())
}
