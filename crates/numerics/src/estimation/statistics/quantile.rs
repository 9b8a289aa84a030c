//! Order statistics of small samples.
//!
//! Intervals of a bootstrap or a propagation are quantiles of its repetitions: with `n` of them a share `p` is
//! uncertain by about `sqrt(p (1 - p)/n)`.

/// The value below which a share of the sorted values lies, linear between order statistics (type 7 of Hyndman & Fan,
/// 1996); `None` without values. A share beyond 0 and 1 is taken for these.
pub fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    let at = share.clamp(0.0, 1.0) * last as f64;
    let below = (at.floor() as usize).min(last);
    let above = (below + 1).min(last);
    Some(sorted[below] + (at - below as f64) * (sorted[above] - sorted[below]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_by_hand() {
        assert_eq!(quantile(&[1.0, 2.0, 4.0], 0.5), Some(2.0));
        assert_eq!(quantile(&[1.0, 2.0, 4.0], 0.75), Some(3.0));
        assert_eq!(quantile(&[1.0, 2.0, 4.0], 7.0), Some(4.0));
        assert_eq!((quantile(&[], 0.5), quantile(&[3.0], 0.05)), (None, Some(3.0)));
    }
}
