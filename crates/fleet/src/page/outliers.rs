//! Which points lie far from the line through the others.

/// Residuals beyond this many robust standard deviations are outliers.
pub(crate) const LIMIT: f64 = 4.0;
/// A median absolute deviation of normal residuals is this share of their standard deviation.
const MAD_OF_NORMAL: f64 = 0.674_489_750_196_081_7;
/// Rounds of fitting the line to the points that are not outliers.
const ROUNDS: usize = 3;
/// Fewest points of a line.
const FEWEST: usize = 8;

/// A straight line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Line {
    /// Value at the mean of x.
    pub(crate) level: f64,
    /// Mean of x.
    pub(crate) at: f64,
    /// Slope.
    pub(crate) slope: f64,
}

impl Line {
    /// Value at x.
    pub(crate) fn value(&self, x: f64) -> f64 {
        self.level + self.slope * (x - self.at)
    }
}

/// The least-squares line through the points that are not outliers, and which are: residuals above [`LIMIT`] robust
/// standard deviations. `None`: fewer than eight points.
pub(crate) fn line_and_outliers(points: &[(f64, f64)]) -> Option<(Line, Vec<bool>)> {
    if points.len() < FEWEST {
        return None;
    }
    let mut is_outlier = vec![false; points.len()];
    let mut line = fit(points, &is_outlier);
    for _ in 0..ROUNDS {
        let residuals: Vec<f64> = points.iter().map(|(x, y)| (y - line.value(*x)).abs()).collect();
        let limit = LIMIT * median(&residuals) / MAD_OF_NORMAL;
        // Points on a line have rounding alone for residuals.
        let least = 1e-9 * points.iter().fold(0.0_f64, |most, (_, y)| most.max(y.abs()));
        is_outlier = residuals.iter().map(|residual| *residual > limit.max(least)).collect();
        line = fit(points, &is_outlier);
    }
    Some((line, is_outlier))
}

fn fit(points: &[(f64, f64)], is_outlier: &[bool]) -> Line {
    let kept = || points.iter().zip(is_outlier).filter(|(_, outlier)| !**outlier).map(|(point, _)| point);
    let count = kept().count().max(1) as f64;
    let (x, y) = kept().fold((0.0, 0.0), |(sx, sy), (x, y)| (sx + x / count, sy + y / count));
    let (xx, xy) = kept().fold((0.0, 0.0), |(xx, xy), (px, py)| (xx + (px - x).powi(2), xy + (px - x) * (py - y)));
    Line { level: y, at: x, slope: if xx > 0.0 { xy / xx } else { 0.0 } }
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_point_that_was_moved_is_found_and_does_not_turn_the_line() {
        let mut points: Vec<(f64, f64)> =
            (0..40).map(|k| (f64::from(k), 2.0 * f64::from(k) + 0.1 * f64::from(k % 3))).collect();
        points[35].1 += 30.0;
        let (line, outliers) = line_and_outliers(&points).unwrap();
        assert_eq!(outliers.iter().filter(|outlier| **outlier).count(), 1);
        assert!(outliers[35] && (line.slope - 2.0).abs() < 1e-3, "{line:?}");
        assert!(line_and_outliers(&points[..7]).is_none());
        let on_a_line: Vec<(f64, f64)> = (0..9).map(|k| (f64::from(k), 0.1 * f64::from(k))).collect();
        assert!(!line_and_outliers(&on_a_line).unwrap().1.contains(&true));
    }
}
