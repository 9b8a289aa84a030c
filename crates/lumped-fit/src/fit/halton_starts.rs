//! Starts that are spread evenly over a box: Halton points.

/// Start `index` of a search: a Halton point in the box `lower..upper`.
///
/// The same for every run, and evenly spread for any number of starts: the discrepancy of `n` points in `d` coordinates
/// is `O((ln n)^d/n)`. Bases are the first 24 primes, repeated beyond; points in bases above 20 or so are correlated
/// until many are drawn. Halton, "On the efficiency of certain quasi-random sequences of points", Numer. Math. 2, 1960.
pub(crate) fn start(index: usize, lower: &[f64], upper: &[f64]) -> Vec<f64> {
    const BASES: [usize; 24] =
        [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71, 73, 79, 83, 89];
    lower
        .iter()
        .zip(upper)
        .zip(BASES.into_iter().cycle())
        .map(|((low, high), base)| low + (high - low) * radical_inverse(index + 1, base))
        .collect()
}

/// The digits of `index` in `base`, mirrored at the radix point: a number in `0..1`.
fn radical_inverse(mut index: usize, base: usize) -> f64 {
    let (mut value, mut weight) = (0.0, 1.0 / base as f64);
    while index > 0 {
        value += (index % base) as f64 * weight;
        index /= base;
        weight /= base as f64;
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn starts_are_spread_over_the_box() {
        let points: Vec<_> = (0..64).map(|k| start(k, &[-1.0; 4], &[1.0; 4])).collect();
        for axis in 0..4 {
            let positive = points.iter().filter(|p| p[axis] > 0.0).count();
            assert!((28..=36).contains(&positive), "axis {axis}: {positive} of 64");
        }
        assert_eq!(points[0][0], 0.0);
    }
}
