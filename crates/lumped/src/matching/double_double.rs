//! Numbers of twice the length: an unevaluated sum of two f64, about 32 digits.
//!
//! Addition and multiplication err by at most a few `1e-32` relative (Dekker 1971; Joldes, Muller, Popescu 2017), so
//! that what cancels ten digits still has twenty. No fused multiply-add, whose software form is slow.
//!
//! The cubic of coefficient matching loses up to fifteen digits near a multiple root. In numbers of twice the length
//! that leaves some sixteen, so that its roots come out right to the last bit of an f64.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// `hi + lo`, with `|lo|` at most half a unit in the last place of `hi`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Dd {
    pub hi: f64,
    pub lo: f64,
}

/// The rounded sum and its rounding error, exactly: six additions, any order of sizes (Knuth).
fn two_sum(a: f64, b: f64) -> Dd {
    let s = a + b;
    let c = s - a;
    Dd { hi: s, lo: (a - (s - c)) + (b - c) }
}

/// The same for `|a| >= |b|`, three additions (Dekker).
fn quick_two_sum(a: f64, b: f64) -> Dd {
    let s = a + b;
    Dd { hi: s, lo: b - (s - a) }
}

/// Exact product, by Veltkamp's splitting; valid below `1e290`.
fn two_product(a: f64, b: f64) -> Dd {
    let split = |x: f64| {
        let c = 134_217_729.0 * x;
        let high = c - (c - x);
        (high, x - high)
    };
    let p = a * b;
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    Dd { hi: p, lo: ((ah * bh - p) + ah * bl + al * bh) + al * bl }
}

impl Dd {
    /// Zero.
    pub const ZERO: Self = Self { hi: 0.0, lo: 0.0 };

    /// The binary number itself.
    pub fn of(x: f64) -> Self {
        Self { hi: x, lo: 0.0 }
    }

    /// The decimal number that `x` is the shortest spelling of, e.g. one tenth for `0.1`; `x` itself where that has
    /// no finite meaning.
    pub fn of_decimal(x: f64) -> Self {
        let text = format!("{x:e}");
        let Some((mantissa, exponent)) = text.split_once('e') else { return Self::of(x) };
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let digits = format!("{whole}{fraction}");
        let places = i32::try_from(fraction.len()).unwrap_or(0);
        let (Ok(value), Ok(power)) = (digits.parse::<i64>(), exponent.parse::<i32>()) else { return Self::of(x) };
        // Up to 17 digits: the upper and the lower 32 bits are exact.
        let upper = (value >> 32) as f64 * 4_294_967_296.0;
        let lower = (value & 0xffff_ffff) as f64;
        let shift = power - places;
        let ten = (0..shift.abs().min(290)).fold(Self::of(1.0), |p, _| p * Self::of(10.0));
        let exact = two_sum(upper, lower);
        let decimal = if shift < 0 { exact / ten } else { exact * ten };
        if decimal.hi == x { decimal } else { Self::of(x) }
    }

    /// Rounded to f64.
    pub fn value(self) -> f64 {
        self.hi + self.lo
    }

    /// Modulus.
    pub fn abs(self) -> Self {
        if self.hi < 0.0 { -self } else { self }
    }

    /// Times an f64.
    pub fn scale(self, by: f64) -> Self {
        self * Self::of(by)
    }

    /// Square root of a number that is not negative: one Newton step on the f64 root.
    pub fn sqrt(self) -> Self {
        if self.hi <= 0.0 {
            return Self::ZERO;
        }
        let root = self.hi.sqrt();
        let rest = self - two_product(root, root);
        two_sum(root, rest.hi / (2.0 * root))
    }
}

/// Accurate sum: error below `3 u²`, `u = 2^-53` (Joldes, Muller, Popescu 2017, algorithm 6).
impl Add for Dd {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let s = two_sum(self.hi, other.hi);
        let t = two_sum(self.lo, other.lo);
        let v = quick_two_sum(s.hi, s.lo + t.hi);
        quick_two_sum(v.hi, t.lo + v.lo)
    }
}

impl Neg for Dd {
    type Output = Self;
    fn neg(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo }
    }
}

impl Sub for Dd {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

/// Error below `5 u²` relative.
impl Mul for Dd {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let p = two_product(self.hi, other.hi);
        quick_two_sum(p.hi, p.lo + (self.hi * other.lo + self.lo * other.hi))
    }
}

/// Long division with three quotients, each the f64 quotient of what is left; error of a few `u²`.
impl Div for Dd {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.hi / other.hi;
        let rest = self - other.scale(first);
        let second = rest.hi / other.hi;
        let third = (rest - other.scale(second)).hi / other.hi;
        let q = quick_two_sum(first, second);
        q + Self::of(third)
    }
}

/// A complex number of two of them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct ComplexDd {
    pub re: Dd,
    pub im: Dd,
}

impl ComplexDd {
    /// With an imaginary part of zero, exactly.
    pub fn real(re: Dd) -> Self {
        Self { re, im: Dd::ZERO }
    }

    /// Modulus, rounded to f64.
    pub fn norm(self) -> f64 {
        self.re.hi.hypot(self.im.hi)
    }

    /// Complex conjugate.
    pub fn conj(self) -> Self {
        Self { re: self.re, im: -self.im }
    }

    /// Times a real number.
    pub fn scale(self, by: Dd) -> Self {
        Self { re: self.re * by, im: self.im * by }
    }

    /// The root with a real part that is not negative; exactly real or imaginary for a real number.
    pub fn sqrt(self) -> Self {
        if self.im == Dd::ZERO {
            let root = self.re.abs().sqrt();
            return if self.re.hi < 0.0 { Self { re: Dd::ZERO, im: root } } else { Self::real(root) };
        }
        let modulus = (self.re * self.re + self.im * self.im).sqrt();
        let larger = ((modulus + self.re.abs()).scale(0.5)).sqrt();
        let smaller = self.im.abs() / larger.scale(2.0);
        let (re, im) = if self.re.hi >= 0.0 { (larger, smaller) } else { (smaller, larger) };
        Self { re, im: if self.im.hi < 0.0 { -im } else { im } }
    }

    /// Both parts rounded to f64.
    pub fn value(self) -> crate::Complex {
        crate::Complex::new(self.re.value(), self.im.value())
    }
}

impl Add for ComplexDd {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Sub for ComplexDd {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl Neg for ComplexDd {
    type Output = Self;
    fn neg(self) -> Self {
        Self { re: -self.re, im: -self.im }
    }
}

impl Mul for ComplexDd {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self { re: self.re * other.re - self.im * other.im, im: self.re * other.im + self.im * other.re }
    }
}

impl Div for ComplexDd {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        if other.im == Dd::ZERO {
            return Self { re: self.re / other.re, im: self.im / other.re };
        }
        let norm = other.re * other.re + other.im * other.im;
        let product = self * other.conj();
        Self { re: product.re / norm, im: product.im / norm }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_third_times_three_is_one_to_thirty_digits() {
        let third = Dd::of(1.0) / Dd::of(3.0);
        assert!((third.scale(3.0) - Dd::of(1.0)).hi.abs() < 1e-31);
        let root = Dd::of(2.0).sqrt();
        // The Newton step squares the error of the f64 root.
        assert!((root * root - Dd::of(2.0)).hi.abs() < 1e-30);
    }

    #[test]
    fn reads_a_decimal_as_it_is_written() {
        let tenth = Dd::of_decimal(0.1);
        assert!((tenth.scale(10.0) - Dd::of(1.0)).hi.abs() < 1e-31);
        assert!(tenth.lo != 0.0);
        assert_eq!(Dd::of_decimal(6024.0), Dd::of(6024.0));
        assert_eq!(Dd::of_decimal(-291.5), Dd::of(-291.5));
        assert!(Dd::of_decimal(f64::INFINITY).hi.is_infinite());
    }

    #[test]
    fn a_complex_root_squares_to_its_number() {
        let z = ComplexDd { re: Dd::of(-3.0), im: Dd::of(1e-9) };
        let root = z.sqrt();
        let back = root * root - z;
        assert!(back.norm() < 1e-30, "{back:?}");
    }
}
