//! The error of magnitude along the warping path.

use crate::curves::iso18571::warping::Warping;

/// `Σ|C - T|/Σ|T|` along the warping path; `None` where T is zero along it.
///
/// The path: least sum of `(C_i - T_j)²` with steps (i-1, j), (i, j-1), (i-1, j-1) from both starts to both ends, in the band
/// `|i - j| <= ceil(window·n) - 1`; the way back goes to the smallest accumulated neighbour, among equals in that order.
pub(super) fn error(t: &[f64], c: &[f64], window: f64) -> Option<f64> {
    let n = t.len();
    if n == 0 {
        return None;
    }
    let band = ((window * n as f64).ceil() - 1.0).clamp(0.0, (n - 1) as f64) as usize;
    let (mut gap, mut size) = (0.0, 0.0);
    Warping::new(t, c, band).visit_path(|i, j| {
        gap += (c[i] - t[j]).abs();
        size += t[j].abs();
    });
    let error = gap / size;
    error.is_finite().then_some(error)
}
