//! Springs and dampers from exponents and amplitudes, as the ERA paper does it: for reproduction.

/// Least squares of `y = intercept + slope x`, as `(intercept, slope)`. Sums are taken about the mean, which avoids
/// cancellation.
fn line(x: &[f64], y: impl Fn(usize) -> f64) -> (f64, f64) {
    let n = x.len() as f64;
    let mean_x = x.iter().sum::<f64>() / n;
    let mean_y = (0..x.len()).map(&y).sum::<f64>() / n;
    let power: f64 = x.iter().map(|x| (x - mean_x).powi(2)).sum();
    let product: f64 = x.iter().enumerate().map(|(k, x)| (x - mean_x) * (y(k) - mean_y)).sum();
    let slope = product / power;
    (mean_y - slope * mean_x, slope)
}

/// `(k2, c2)` with `m2 s² + c2 s + k2 = C` in the sense of least squares (ERA paper, equations 19 to 22, with the
/// transposed matrix that the print leaves out).
///
/// **Not a method to use.** An amplitude is known up to one factor for each exponent, so metres are set equal to N/m
/// here; of the result 99.97 % is `m2` times the straight line through `s²`. From the exponents alone
/// [`CoefficientMatching`](crumple_lumped::CoefficientMatching) gives every model there is.
pub fn rear_from_amplitudes(exponents_per_s: &[f64], amplitudes_m: &[f64], m2_kg: f64) -> (f64, f64) {
    line(exponents_per_s, |k| amplitudes_m[k] - m2_kg * exponents_per_s[k].powi(2))
}

/// `(k1, c1)`, N/m and N·s/m, with `m1 s² + (c1 + c2) s + k1 + k2 = (c2 s + k2)²/(m2 s² + c2 s + k2)` at every
/// exponent `s`, in the sense of least squares (ERA paper, equations 6 and 23 to 25). Exact where the exponents are
/// poles of such a model; as they are not, dampers and springs can come out negative.
pub fn front_from_amplitudes(exponents_per_s: &[f64], m1_kg: f64, m2_kg: f64, (k2, c2): (f64, f64)) -> (f64, f64) {
    line(exponents_per_s, |k| {
        let s = exponents_per_s[k];
        let coupling = c2 * s + k2;
        coupling * coupling / (m2_kg * s * s + coupling) - m1_kg * s * s - coupling
    })
}
