//! Choosing the order of a model from the singular values of its Hankel matrix.

/// Gaps to values below this fraction of the largest are gaps to rounding; they count as gaps to this fraction.
const ROUNDING: f64 = 1e-14;

/// An order, and what speaks for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GapOrder {
    /// Number of singular values before the largest gap.
    pub order: usize,
    /// The gap `s[order]/s[order+1]` (counted from 1).
    pub ratio: f64,
    /// Noise level: median of the singular values beyond the highest order considered; `None` if none is known.
    pub noise_level: Option<f64>,
}

/// The order before the largest ratio of neighbouring singular values, up to `max_order`.
///
/// A gap counts only when the value before it stands above the noise level. The rule is sharp for clean records, where
/// the gap is twelve decades, and for a few modes in weak noise. A crash pulse has no true order: its singular values
/// fall smoothly, the largest gap is often the first one or two, and the ratio (say below 3) tells how little it
/// means. `None` with fewer than two values.
pub(crate) fn order_by_gap(values: &[f64], max_order: usize) -> Option<GapOrder> {
    let largest = *values.first().filter(|s| **s > 0.0)?;
    let noise_level = median(values.get(max_order..).unwrap_or_default());
    let floor = ROUNDING * largest;
    let mut best: Option<GapOrder> = None;
    for order in 1..=max_order.min(values.len() - 1) {
        let (before, after) = (values[order - 1], values[order]);
        if before <= noise_level.unwrap_or(0.0).max(floor) {
            break;
        }
        let ratio = before / after.max(floor);
        if best.is_none_or(|best| ratio > best.ratio) {
            best = Some(GapOrder { order, ratio, noise_level });
        }
    }
    best
}

/// Median; the lower of the two middle values of an even number.
fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len().saturating_sub(1) / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_the_values_above_rounding_on_a_clean_record() {
        let gap = order_by_gap(&[146.6, 85.7, 62.6, 3.5, 1e-14, 0.0, 0.0], 5).unwrap();
        assert_eq!(gap.order, 4);
    }

    #[test]
    fn counts_the_values_above_the_plateau_of_noise() {
        let values = [194.3, 159.9, 142.8, 79.4, 7.01, 6.92, 6.88, 6.7, 6.6];
        let gap = order_by_gap(&values, 6).unwrap();
        assert_eq!((gap.order, gap.noise_level), (4, Some(6.7)));
        assert!((gap.ratio - 79.4 / 7.01).abs() < 1e-12);
    }

    #[test]
    fn gap_between_two_values_of_noise_does_not_count() {
        // 1e-3 to 1e-9 is the widest ratio, but both are under the level that the tail shows.
        let gap = order_by_gap(&[10.0, 5.0, 1e-3, 1e-9, 2e-3, 2e-3, 2e-3], 4).unwrap();
        assert_eq!(gap.order, 2);
    }

    #[test]
    fn nothing_to_choose_from_is_none() {
        assert_eq!(order_by_gap(&[], 4), None);
        assert_eq!(order_by_gap(&[3.0], 4), None);
        assert_eq!(order_by_gap(&[0.0, 0.0], 4), None);
    }
}
