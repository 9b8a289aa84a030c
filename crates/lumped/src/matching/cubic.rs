//! Roots of cubics, in double length.
//!
//! Roots of a real cubic with their multiplicities, in double-length arithmetic.
//!
//! Cardano's formula subtracts cube roots that may be equal, and Newton's method crawls at a multiple root. Here one
//! root that is always well apart from the others is found first, by Newton's method in double length from a closed
//! form in f64; the other two follow from it and the discriminant.
//!
//! Numbers of twice the length, an unevaluated sum of two f64, about 32 digits: what the crate `qd` leaves to say.
//!
//! The cubic of coefficient matching loses up to fifteen digits near a multiple root. In numbers of twice the length
//! that leaves some sixteen, so that its roots come out right to the last bit of an f64. Sums, products, quotients and
//! roots err by a few `1e-32` of the largest of their parts.

use nalgebra::Complex;

pub(crate) use qd::Quad;

/// Relative size below which a combination of the coefficients counts as zero: some hundred roundings of double-length
/// arithmetic. Of exact coefficients two roots closer than about `1e-14` of their size are taken as one double root.
const NOISE: f64 = 1e-29;
const THIRD: Quad = Quad::ONE.const_div(Quad::from_f64(3.0));
const TWO_27TH: Quad = Quad::from_f64(2.0).const_div(Quad::from_f64(27.0));

/// One root.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CubicRoot {
    pub value: ComplexQuad,
    pub multiplicity: usize,
    /// How far from `value` the roots that are taken as one may lie; 0 for a single root.
    pub radius: f64,
}

/// How far the cubic is uncertain, because its coefficients are.
pub(crate) struct CubicUncertainty<'a> {
    /// Of its value at a point.
    pub value: &'a dyn Fn(Quad) -> f64,
    /// Of its slope.
    pub slope: f64,
}

/// The roots of `z^3 + a z^2 + b z + c`, real ones first; multiplicities sum to three.
///
/// Shifted to `y^3 + p y + q`. Where the cubic is zero within its uncertainty at a point without slope,
/// `y = ±(-p/3)^(1/2)`, that point is a double root and the third is near `-2 y`; where `p` and `q` both are, zero is a
/// triple root. A cubic that near has such roots too, so that none is lost to the complex numbers by a rounding of the
/// coefficients. Else the root of largest modulus stands alone on its side of zero, so Newton's method finds it
/// without harm however close the other two are; those follow from the discriminant
/// `D = (y1-y2)^2 (y1-y3)^2 (y2-y3)^2`, whose sign says how many roots are real.
///
/// A slope uncertain by `d` moves the value at a point without slope by `d^2/(2 |y''|)`, `y'' = 6 y`, beside what
/// `uncertainty` says of the value there.
pub(crate) fn cubic_roots([a, b, c]: [Quad; 3], uncertainty: &CubicUncertainty<'_>) -> Vec<CubicRoot> {
    let shift = -a * THIRD;
    let square = a * a;
    let p = b - square * THIRD;
    let q = c - a * b * THIRD + square * a * TWO_27TH;
    let p_noise = NOISE * (b.0.abs() + square.0);
    let q_noise = NOISE * (c.0.abs() + (a * b).0.abs() + (square * a).0.abs());
    let real = |y: Quad, multiplicity, radius| {
        let z = y + shift;
        // A root at zero is one exactly.
        let z = if z.0.abs() <= NOISE * (y.0.abs() + shift.0.abs()) { Quad::ZERO } else { z };
        CubicRoot { value: real(z), multiplicity, radius }
    };
    let slope_noise = p_noise + uncertainty.slope;
    let value_noise = q_noise + (uncertainty.value)(shift);
    if p.0.abs() <= slope_noise && q.0.abs() <= value_noise {
        return vec![real(Quad::ZERO, 3, value_noise.cbrt())];
    }
    let flat = (-p * THIRD).sqrt();
    let twice = if q.0 < 0.0 { -flat } else { flat };
    let curvature = 6.0 * flat.0;
    let value_noise = q_noise
        + flat.0 * p_noise
        + NOISE * q.0.abs()
        + (uncertainty.value)(twice + shift)
        + 0.5 * slope_noise * slope_noise / curvature;
    if p.0 < 0.0 && (q.abs() - (flat * flat * flat).times_power_of_two(2.0)).0.abs() <= value_noise {
        // A parabola of this height spreads its zeros so far; twice that, as the noise is an estimate.
        let radius = 2.0 * (2.0 * value_noise / curvature).sqrt();
        return vec![real(newton(p, q, -2.0 * twice.0), 1, 0.0), real(twice, 2, radius)];
    }
    let discriminant = -(p * p * p).times_power_of_two(4.0) - q * q * Quad::from(27.0);
    let alone = newton(p, q, start(p.0, q.0, discriminant.0));
    let slope = alone * alone * Quad::from(3.0) + p;
    let half_gap = discriminant.abs().sqrt() / slope.abs().times_power_of_two(2.0);
    let middle = alone.times_power_of_two(-0.5);
    if discriminant.0 > 0.0 {
        return vec![real(alone, 1, 0.0), real(middle - half_gap, 1, 0.0), real(middle + half_gap, 1, 0.0)];
    }
    let upper = ComplexQuad::new(middle + shift, half_gap);
    let single = |value| CubicRoot { value, multiplicity: 1, radius: 0.0 };
    vec![real(alone, 1, 0.0), single(upper), single(upper.conj())]
}

/// The root of largest modulus (three real ones) or the only real one, in f64.
///
/// Cosine form for three real roots, Cardano's with the two summands of one sign for a single one: right to some
/// `1e-15`, which Newton's method doubles and doubles again.
fn start(p: f64, q: f64, discriminant: f64) -> f64 {
    if discriminant > 0.0 {
        let radius = (-p / 3.0).sqrt();
        let cosine = (0.5 * q.abs() / radius.powi(3)).clamp(-1.0, 1.0);
        return -q.signum() * 2.0 * radius * (cosine.acos() / 3.0).cos();
    }
    let root = (0.25 * q * q + p * p * p / 27.0).max(0.0).sqrt();
    // The two summands of the same sign: no cancellation.
    let u = -(0.5 * q + q.signum() * root).cbrt();
    if u == 0.0 { 0.0 } else { u - p / (3.0 * u) }
}

/// `y³ + p y + q = 0`. Ends when a step is below `1e-30` of the root, where the slope vanishes, or after 80 steps.
fn newton(p: Quad, q: Quad, start: f64) -> Quad {
    let mut y = Quad::from(start);
    // From an f64 start two steps are enough; next to a triple root each gains one bit only.
    for _ in 0..80 {
        let square = y * y;
        let slope = square * Quad::from(3.0) + p;
        if slope.0 == 0.0 {
            break;
        }
        let step = (square * y + p * y + q) / slope;
        if !step.0.is_finite() {
            break;
        }
        y -= step;
        if step.0.abs() <= 1e-30 * y.0.abs() {
            break;
        }
    }
    y
}

/// A complex number of two of them.
pub(crate) type ComplexQuad = Complex<Quad>;

/// The decimal number that `x` is the shortest spelling of, e.g. one tenth for `0.1`; `x` itself where that has no
/// finite meaning.
pub(crate) fn decimal(x: f64) -> Quad {
    let binary = Quad::from(x);
    let text = format!("{x:e}");
    let Some((mantissa, exponent)) = text.split_once('e') else { return binary };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = format!("{whole}{fraction}");
    let places = i32::try_from(fraction.len()).unwrap_or(0);
    let (Ok(value), Ok(power)) = (digits.parse::<i64>(), exponent.parse::<i32>()) else { return binary };
    // Up to 17 digits: the upper and the lower 32 bits are exact.
    let exact = Quad::from((value >> 32) as f64 * 4_294_967_296.0) + Quad::from((value & 0xffff_ffff) as f64);
    let shift = power - places;
    let ten = (0..shift.abs().min(290)).fold(Quad::ONE, |p, _| p * Quad::from(10.0));
    let decimal = if shift < 0 { exact / ten } else { exact * ten };
    if decimal.0 == x { decimal } else { binary }
}

/// What sums, products, quotients and roots do not give.
pub(crate) trait DoubleLength: Sized {
    /// Times a power of two with either sign, exactly.
    fn times_power_of_two(self, power: f64) -> Self;
    /// Rounded to f64.
    fn value(self) -> f64;
}

impl DoubleLength for Quad {
    fn times_power_of_two(self, power: f64) -> Self {
        Self(self.0 * power, self.1 * power)
    }

    fn value(self) -> f64 {
        self.0 + self.1
    }
}

/// What products and quotients do not give.
pub(crate) trait ComplexDoubleLength: Sized {
    /// Modulus, rounded to f64.
    fn modulus(self) -> f64;
    /// The root with a real part that is not negative; exactly real or imaginary for a real number.
    fn square_root(self) -> Self;
    /// Both parts rounded to f64.
    fn value(self) -> Complex<f64>;
}

impl ComplexDoubleLength for ComplexQuad {
    fn modulus(self) -> f64 {
        if self.im.0 == 0.0 { self.re.0.abs() } else { self.re.0.hypot(self.im.0) }
    }

    fn square_root(self) -> Self {
        if self.im == Quad::ZERO {
            let root = self.re.abs().sqrt();
            return if self.re.0 < 0.0 { Self::new(Quad::ZERO, root) } else { real(root) };
        }
        let larger = ((self.re * self.re + self.im * self.im).sqrt() + self.re.abs()).times_power_of_two(0.5).sqrt();
        let smaller = self.im.abs().times_power_of_two(0.5) / larger;
        let (re, im) = if self.re.0 >= 0.0 { (larger, smaller) } else { (smaller, larger) };
        Self::new(re, if self.im.0 < 0.0 { -im } else { im })
    }

    fn value(self) -> Complex<f64> {
        Complex::new(self.re.value(), self.im.value())
    }
}

/// With an imaginary part of zero, exactly.
pub(crate) fn real(re: Quad) -> ComplexQuad {
    ComplexQuad::new(re, Quad::ZERO)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exact(coefficients: [Quad; 3]) -> Vec<CubicRoot> {
        cubic_roots(coefficients, &CubicUncertainty { value: &|_| 0.0, slope: 0.0 })
    }

    fn roots_of(r: [f64; 3]) -> Vec<CubicRoot> {
        let [x, y, z] = r.map(Quad::from);
        exact([-(x + y + z), x * y + y * z + z * x, -(x * y * z)])
    }

    #[test]
    fn finds_three_real_roots_to_thirty_digits() {
        let mut roots: Vec<f64> = roots_of([1e-6, 3.0, -2e5]).iter().map(|r| r.value.re.value()).collect();
        roots.sort_by(f64::total_cmp);
        for (x, y) in roots.iter().zip([-2e5, 1e-6, 3.0]) {
            // 1e-31 of the largest root is left: 1e-26, a hundred thousand millionth of the smallest.
            assert!((x - y).abs() <= 1e-15 * y.abs(), "{x} {y}");
        }
    }

    #[test]
    fn double_and_triple_roots_keep_every_digit_and_their_multiplicity() {
        let roots = roots_of([0.1, 0.1, 7.0]);
        assert_eq!(roots.iter().map(|r| r.multiplicity).collect::<Vec<_>>(), [1, 2]);
        assert_eq!((roots[0].value.re.value(), roots[1].value.re.value()), (7.0, 0.1));
        let roots = roots_of([0.3; 3]);
        assert_eq!((roots.len(), roots[0].multiplicity, roots[0].value.re.value()), (1, 3, 0.3));
        // Two units in the last place apart are two roots.
        let near = roots_of([1.0, 1.0 + 1e-12, -4.0]);
        assert_eq!(near.len(), 3);
    }

    #[test]
    fn one_real_root_leaves_a_conjugate_pair() {
        // (z - 2)(z^2 + 2 z + 5)
        let roots = exact([Quad::from(0.0), Quad::ONE, Quad::from(-10.0)]);
        assert_eq!(roots[0].value.value(), crate::Complex::new(2.0, 0.0));
        assert_eq!(roots[1].value.value(), crate::Complex::new(-1.0, 2.0));
        assert_eq!(roots[2].value.value(), crate::Complex::new(-1.0, -2.0));
        // z^3 - 8: the shifted cubic has p = 0.
        let roots = exact([Quad::ZERO, Quad::ZERO, Quad::from(-8.0)]);
        assert_eq!(roots[0].value.value(), crate::Complex::new(2.0, 0.0));
        // z^3 + 8 z: q = 0.
        let roots = exact([Quad::ZERO, Quad::from(4.0), Quad::ZERO]);
        assert_eq!(roots[0].value.value(), crate::Complex::new(0.0, 0.0));
        assert_eq!(roots[1].value.value(), crate::Complex::new(0.0, 2.0));
    }

    #[test]
    fn one_third_times_three_is_one_to_thirty_digits() {
        let third = Quad::ONE / Quad::from(3.0);
        assert!((third * Quad::from(3.0) - Quad::ONE).0.abs() < 1e-31);
        let root = Quad::from(2.0).sqrt();
        // The Newton step squares the error of the f64 root.
        assert!((root * root - Quad::from(2.0)).0.abs() < 1e-30);
    }

    #[test]
    fn reads_a_decimal_as_it_is_written() {
        let tenth = decimal(0.1);
        assert!((tenth * Quad::from(10.0) - Quad::ONE).0.abs() < 1e-31);
        assert!(tenth.1 != 0.0);
        assert_eq!(decimal(6024.0), Quad::from(6024.0));
        assert_eq!(decimal(-291.5), Quad::from(-291.5));
        assert!(decimal(f64::INFINITY).0.is_infinite());
    }

    #[test]
    fn a_complex_root_squares_to_its_number() {
        let z = ComplexQuad::new(Quad::from(-3.0), Quad::from(1e-9));
        let root = z.square_root();
        assert!((root * root - z).modulus() < 1e-30, "{root:?}");
    }
}
