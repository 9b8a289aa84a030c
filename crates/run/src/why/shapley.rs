//! Shares of a change.

/// The Shapley values of `n` causes from what a number is with every set of them, `2^n` values: bit `k` of the index
/// says whether the cause `k` is in the set. They add up to the last value less the first.
///
/// Source: L. S. Shapley, A value for n-person games, 1953: `phi_k` is the sum over sets `S` without `k` of
/// `|S|! (n - |S| - 1)! / n!` times `v(S + k) - v(S)`.
pub(super) fn shares(values: &[f64]) -> Vec<f64> {
    let causes = values.len().trailing_zeros() as usize;
    let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
    let weight = |size: usize| factorial(size) * factorial(causes - size - 1) / factorial(causes);
    let share = |cause: usize| {
        let without = (0..values.len()).filter(|set| set & (1 << cause) == 0);
        without.map(|set| weight(set.count_ones() as usize) * (values[set | (1 << cause)] - values[set])).sum()
    };
    (0..causes).map(share).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_adds_up_is_divided_as_it_came_and_an_interaction_in_equal_parts() {
        assert_eq!(shares(&[1.0, 4.0]), [3.0]);
        // 10, and 3 by one, and -2 by the other.
        assert_eq!(shares(&[10.0, 13.0, 8.0, 11.0]), [3.0, -2.0]);
        // A product of both: 2 by 3 to 4 by 6.
        assert_eq!(shares(&[6.0, 12.0, 12.0, 24.0]), [9.0, 9.0]);
    }

    #[test]
    fn shares_of_the_glove_game_are_known() {
        // Two left gloves, one right: 1/6, 1/6, 2/3 (a textbook case of the value).
        let values = [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        let found = shares(&values);
        for (found, known) in found.iter().zip([1.0 / 6.0, 1.0 / 6.0, 2.0 / 3.0]) {
            assert!((found - known).abs() < 1e-15, "{found} {known}");
        }
    }

    #[test]
    fn shares_add_up_to_the_change() {
        let values: Vec<f64> = (0..16).map(|k| f64::from(k * k * 7 % 11) + 0.1).collect();
        let sum: f64 = shares(&values).iter().sum();
        assert!((sum - (values[15] - values[0])).abs() < 1e-12, "{sum}");
    }
}
