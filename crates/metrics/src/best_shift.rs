//! The shift of largest correlation between two curves.
//!
//! ISO/TS 18571 and CORA shift one curve against the other and keep the shift of largest correlation. By definition
//! that is a sum of products for every shift, N² in all; a transform gives all sums at once but with rounding that may
//! exchange two near shifts. Here the transform only narrows the choice, the definition decides.

use crumple_numerics::linalg::real_transform;

/// What is maximised over the shifts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Correlation {
    /// Pearson's: the means of the overlapping parts are removed.
    Centred,
    /// `ΣXY/sqrt(ΣX²·ΣY²)` as it is.
    Raw,
}

/// The best shift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BestShift {
    /// Samples by which the comparison is late; negative: early.
    pub(crate) late: isize,
    /// Correlation there; `None` where no shift has one (a constant curve).
    pub(crate) correlation: Option<f64>,
}

/// Correlations closer than this are equal: their rounding. So a periodic curve keeps the smaller shift.
const EQUAL: f64 = 1e-12;

/// Overlap of reference and comparison at a shift.
pub(crate) fn overlap<'a>(t: &'a [f64], c: &'a [f64], late: isize) -> (&'a [f64], &'a [f64]) {
    let m = late.unsigned_abs().min(t.len());
    let n = t.len() - m;
    if late >= 0 { (&t[..n], &c[m..]) } else { (&t[m..], &c[..n]) }
}

/// The first shift of largest correlation in the order 0, +1, -1, +2, ... (+: the comparison is late).
///
/// Exact, but not by trying all: a fast Fourier transform gives every sum of products with a known error; only shifts
/// that may be the best within that error are computed by their definition. Overlaps without a correlation (constant
/// parts) are passed over. Time N·log N for curves with a clear maximum; N·shifts at worst.
pub(crate) fn best_shift(t: &[f64], c: &[f64], longest: usize, kind: Correlation) -> BestShift {
    let mut best = BestShift { late: 0, correlation: correlation(t, c, kind) };
    for late in candidates(t, c, longest.min(t.len().saturating_sub(1)), kind) {
        let (t, c) = overlap(t, c, late);
        if let Some(value) = correlation(t, c, kind)
            && best.correlation.is_none_or(|best| value > best + EQUAL)
        {
            best = BestShift { late, correlation: Some(value) };
        }
    }
    best
}

/// The correlation by its definition, two passes; `None` where a part is constant (centred) or zero (raw).
pub(crate) fn correlation(x: &[f64], y: &[f64], kind: Correlation) -> Option<f64> {
    let (mean_x, mean_y) = match kind {
        Correlation::Raw => (0.0, 0.0),
        Correlation::Centred => {
            let constant = |part: &[f64]| part.iter().all(|value| *value == part[0]);
            if x.len() < 2 || constant(x) || constant(y) {
                return None;
            }
            (mean(x), mean(y))
        }
    };
    let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
    for (x, y) in x.iter().zip(y) {
        let (x, y) = (x - mean_x, y - mean_y);
        xx += x * x;
        yy += y * y;
        xy += x * y;
    }
    let value = xy / (xx * yy).sqrt();
    value.is_finite().then_some(value)
}

/// Mean of the samples; NaN without any.
fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len() as f64
}

/// The shifts other than 0 that may have the largest correlation, in the order of [`best_shift`].
fn candidates(t: &[f64], c: &[f64], longest: usize, kind: Correlation) -> Vec<isize> {
    let order = || (1..=longest).filter_map(|m| isize::try_from(m).ok()).flat_map(|m| [m, -m]);
    // A common offset does not change a centred correlation, but its square would drown the sums.
    let (offset_t, offset_c) = match kind {
        Correlation::Centred => (mean(t), mean(c)),
        Correlation::Raw => (0.0, 0.0),
    };
    let largest = |x: &[f64], offset: f64| x.iter().fold(0.0_f64, |m, x| m.max((x - offset).abs()));
    let (scale_t, scale_c) = (largest(t, offset_t), largest(c, offset_c));
    if !(scale_t > 0.0 && scale_c > 0.0 && scale_t.is_finite() && scale_c.is_finite()) {
        return order().collect();
    }
    let x: Vec<f64> = t.iter().map(|t| (t - offset_t) / scale_t).collect();
    let y: Vec<f64> = c.iter().map(|c| (c - offset_c) / scale_c).collect();
    let Some(products) = cross_products(&x, &y, longest) else { return order().collect() };
    let (x_sums, y_sums) = (Sums::new(&x), Sums::new(&y));

    let (total_x, total_y) = (x_sums.squares(0, x.len()), y_sums.squares(0, y.len()));
    // Rounding of the transform grows with log2 N: below 1e-14 of the norms for 2^26 points; of running sums, below
    // 1e-12 of the total.
    let product_error = 1e-13 * (total_x * total_y).sqrt();
    let square_error = 1e-12;
    let bounds = |late: isize| {
        let m = late.unsigned_abs();
        let n = x.len() - m;
        let (from_x, from_y) = if late >= 0 { (0, m) } else { (m, 0) };
        let (mut xy, mut xx, mut yy) =
            (products(late), x_sums.squares(from_x, from_x + n), y_sums.squares(from_y, from_y + n));
        if kind == Correlation::Centred {
            let (sx, sy) = (x_sums.sum(from_x, from_x + n), y_sums.sum(from_y, from_y + n));
            xy -= sx * sy / n as f64;
            xx -= sx * sx / n as f64;
            yy -= sy * sy / n as f64;
        }
        let (ex, ey) = (square_error * total_x, square_error * total_y);
        let lowest = ((xx - ex).max(0.0) * (yy - ey).max(0.0)).sqrt();
        let highest = ((xx + ex) * (yy + ey)).sqrt();
        let bound = |product: f64, up: bool| {
            let norm = if (product > 0.0) == up { lowest } else { highest };
            if norm > 0.0 {
                product / norm
            } else if up {
                f64::INFINITY
            } else {
                f64::NEG_INFINITY
            }
        };
        let error = product_error + square_error * (total_x * total_y).sqrt();
        (bound(xy - error, false), bound(xy + error, true))
    };
    let floor = order().map(|late| bounds(late).0).fold(f64::NEG_INFINITY, f64::max);
    order().filter(|&late| bounds(late).1 >= floor).collect()
}

/// Running sums and sums of squares.
struct Sums {
    sums: Vec<f64>,
    squares: Vec<f64>,
}

impl Sums {
    fn new(x: &[f64]) -> Self {
        let running = |f: fn(f64) -> f64| {
            let mut sum = 0.0;
            std::iter::once(0.0)
                .chain(x.iter().map(|&x| {
                    sum += f(x);
                    sum
                }))
                .collect()
        };
        Self { sums: running(|x| x), squares: running(|x| x * x) }
    }

    fn sum(&self, from: usize, to: usize) -> f64 {
        self.sums[to] - self.sums[from]
    }

    fn squares(&self, from: usize, to: usize) -> f64 {
        self.squares[to] - self.squares[from]
    }
}

/// `Σ x[i]·y[i + late]` for every shift up to `longest`, by the transform. `None` if the transform refuses.
fn cross_products(x: &[f64], y: &[f64], longest: usize) -> Option<impl Fn(isize) -> f64 + use<>> {
    let length = (x.len() + longest).next_power_of_two().max(2);
    let plan = real_transform(length);
    let (forward, backward) = (plan.forward, plan.inverse);
    let transform = |x: &[f64]| {
        let (mut time, mut frequency) = (vec![0.0; length], forward.make_output_vec());
        time[..x.len()].copy_from_slice(x);
        forward.process(&mut time, &mut frequency).ok()?;
        Some(frequency)
    };
    let (fx, mut fy) = (transform(x)?, transform(y)?);
    for (y, x) in fy.iter_mut().zip(&fx) {
        *y *= x.conj() / length as f64;
    }
    let mut products = vec![0.0; length];
    backward.process(&mut fy, &mut products).ok()?;
    Some(move |late: isize| products[if late >= 0 { late as usize } else { length - late.unsigned_abs() }])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn by_trying_all(t: &[f64], c: &[f64], longest: usize, kind: Correlation) -> BestShift {
        let mut best = BestShift { late: 0, correlation: correlation(t, c, kind) };
        for late in (1..=isize::try_from(longest).unwrap()).flat_map(|m| [m, -m]) {
            let (t, c) = overlap(t, c, late);
            if let Some(value) = correlation(t, c, kind)
                && best.correlation.is_none_or(|best| value > best + EQUAL)
            {
                best = BestShift { late, correlation: Some(value) };
            }
        }
        best
    }

    #[test]
    fn finds_what_trying_all_shifts_finds() {
        let n = 331;
        let pulse = |k: usize, at: f64| (-((k as f64 - at) / 25.0).powi(2)).exp();
        let curve = |f: &dyn Fn(usize) -> f64| (0..n).map(f).collect::<Vec<f64>>();
        let reference = curve(&|k| pulse(k, 120.0));
        for other in [
            curve(&|k| 3.0 * pulse(k, 141.0) + 1e6),
            curve(&|k| pulse(k, 100.0) + 0.3 * (k as f64 * 1.7).sin()),
            curve(&|k| -pulse(k, 120.0)),
            curve(&|k| if k > 300 { 1.0 } else { 0.0 }),
            curve(&|k| if k == 5 { 1.0 } else { 2.0 }),
            curve(&|k| (k as f64 * 0.2).sin()),
            vec![2.0; n],
        ] {
            for kind in [Correlation::Centred, Correlation::Raw] {
                for (t, c) in [(&reference, &other), (&other, &reference), (&other, &other)] {
                    assert_eq!(best_shift(t, c, 66, kind), by_trying_all(t, c, 66, kind), "{kind:?}");
                }
            }
        }
    }

    #[test]
    fn finds_what_trying_all_shifts_finds_in_curves_of_every_size_and_offset() {
        let share = |k: usize, stream: f64| (k as f64 * stream).fract() - 0.5;
        for number in 1..400_usize {
            let n = 3 + number % 57;
            let (noise, offset) = ([0.0, 0.02, 1.0][number % 3], [0.0, 3.0, -1e7][number / 3 % 3]);
            let flat = if number % 4 == 0 { n / 2 } else { 0 };
            let curve = |place: usize, scale: f64, stream: f64| -> Vec<f64> {
                let at = |k: usize| {
                    let u = (k as f64 - place as f64) / (1.0 + n as f64 / 7.0);
                    let pulse =
                        if k < flat { 0.0 } else { (-u * u).exp() + noise * share(k * (1 + number % 5), stream) };
                    scale * pulse + if number % 2 == 0 { offset } else { 0.0 }
                };
                (0..n).map(at).collect()
            };
            let t = curve(n / 2, 1.0, 0.618_034);
            let c = curve((n / 2 + number % 11).saturating_sub(5), [1.0, -2.0, 1e-3, 1e9][number % 4], 0.754_878);
            for (kind, longest) in [Correlation::Centred, Correlation::Raw]
                .map(|kind| (kind, n / 3))
                .into_iter()
                .chain([(Correlation::Centred, n), (Correlation::Raw, n + 5)])
            {
                let tried = by_trying_all(&t, &c, longest.min(n - 1), kind);
                assert_eq!(best_shift(&t, &c, longest, kind), tried, "{number}: {n} samples, {kind:?}");
            }
        }
    }

    #[test]
    fn samples_beyond_the_transform_are_compared_by_the_definition_alone() {
        // Zeros and infinities have no scale; a part of one sample or of equal ones has no correlation.
        let (pulse, zeros) = ([0.0, 1.0, 0.0, 0.0], [0.0; 4]);
        for kind in [Correlation::Centred, Correlation::Raw] {
            assert_eq!(best_shift(&pulse, &zeros, 2, kind), by_trying_all(&pulse, &zeros, 2, kind));
            assert_eq!(best_shift(&zeros, &pulse, 2, kind), by_trying_all(&zeros, &pulse, 2, kind));
            let endless = [0.0, f64::INFINITY, 1.0, 0.0];
            assert_eq!(best_shift(&pulse, &endless, 3, kind), by_trying_all(&pulse, &endless, 3, kind));
            assert_eq!(best_shift(&endless, &pulse, 3, kind), by_trying_all(&endless, &pulse, 3, kind));
        }
        assert_eq!(correlation(&[1.0], &[2.0], Correlation::Centred), None);
        assert_eq!(correlation(&[1.0], &[2.0], Correlation::Raw), Some(1.0));
        assert_eq!(correlation(&[0.1; 3], &[1.0, 2.0, 4.0], Correlation::Centred), None);
        assert_eq!(correlation(&[1.0, 2.0, 4.0], &[0.1; 3], Correlation::Centred), None);
        assert_eq!(correlation(&[1.0, 2.0], &[3.0, 5.0], Correlation::Centred), Some(1.0));
    }

    #[test]
    fn a_constant_curve_has_no_correlation() {
        assert_eq!(best_shift(&[1.0; 9], &[1.0; 9], 3, Correlation::Centred), BestShift { late: 0, correlation: None });
    }
}
