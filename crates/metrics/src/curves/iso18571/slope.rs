//! Error of slope of ISO/TS 18571.

/// Width of the running mean, samples.
const WIDTH: usize = 9;

/// `Σ|C' - T'|/Σ|T'|` of the smoothed derivatives; `None` below 9 samples or where T' is zero.
///
/// Central differences (one-sided at the ends), then a centred running mean of 9 points that shrinks to 7, 5, 3, 1 at
/// the ends.
pub(super) fn error(t: &[f64], c: &[f64], dt_s: f64) -> Option<f64> {
    if t.len() < WIDTH {
        return None;
    }
    let (t, c) = (smoothed(&derivative(t, dt_s)), smoothed(&derivative(c, dt_s)));
    let (mut gap, mut size) = (0.0, 0.0);
    for (t, c) in t.iter().zip(&c) {
        gap += (c - t).abs();
        size += t.abs();
    }
    let error = gap / size;
    error.is_finite().then_some(error)
}

/// Central differences, one-sided at both ends, unit of x per s.
fn derivative(x: &[f64], dt_s: f64) -> Vec<f64> {
    let n = x.len();
    let mut out = Vec::with_capacity(n);
    out.push((x[1] - x[0]) / dt_s);
    out.extend(x.windows(3).map(|w| (w[2] - w[0]) / (2.0 * dt_s)));
    out.push((x[n - 1] - x[n - 2]) / dt_s);
    out
}

/// Centred running mean over [`WIDTH`] samples, fewer near the ends.
fn smoothed(x: &[f64]) -> Vec<f64> {
    let n = x.len();
    let mean = |k: usize| {
        let half = (WIDTH / 2).min(k).min(n - 1 - k);
        x[k - half..=k + half].iter().sum::<f64>() / (2 * half + 1) as f64
    };
    (0..n).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_keeps_its_slope_up_to_the_ends() {
        let ramp: Vec<f64> = (0..20).map(|k| f64::from(k) * 0.5).collect();
        assert!(smoothed(&derivative(&ramp, 0.25)).iter().all(|slope| *slope == 2.0));
        let steeper: Vec<f64> = ramp.iter().map(|x| 1.5 * x).collect();
        assert_eq!(error(&ramp, &steeper, 0.25), Some(0.5));
        assert_eq!(error(&[1.0; 20], &steeper, 0.25), None);
        assert_eq!(error(&ramp[..8], &steeper[..8], 0.25), None);
    }
}
