/// Corridor score of ISO 18571 and CORA: per sample 1 inside `inner·max|T|`, 0 outside `outer·max|T|`, between them
/// `((δo - |T - C|)/(δo - δi))^k`; their mean. The signals are neither shifted nor scaled. `t` is not all zero.
pub(crate) fn corridor_score(t: &[f64], c: &[f64], inner: f64, outer: f64, power: f64) -> f64 {
    let norm = t.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
    let (inside, outside) = (inner * norm, outer * norm);
    let score = |gap: f64| {
        if gap < inside {
            1.0
        } else if gap > outside {
            0.0
        } else if outside > inside {
            ((outside - gap) / (outside - inside)).powf(power)
        } else {
            1.0
        }
    };
    t.iter().zip(c).map(|(t, c)| score((t - c).abs())).sum::<f64>() / t.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scores_inside_between_and_outside() {
        let t = [10.0; 4];
        // Gaps 0, 2.75, 5 and 6 of corridors 0.5 and 5: 1, a quarter, 0 and 0.
        assert_eq!(corridor_score(&t, &[10.0, 12.75, 15.0, 4.0], 0.05, 0.5, 2.0), (1.0 + 0.25) / 4.0);
    }
}
