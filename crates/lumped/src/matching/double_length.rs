//! Numbers of twice the length, an unevaluated sum of two f64, about 32 digits: what the crate `qd` leaves to say.
//!
//! The cubic of coefficient matching loses up to fifteen digits near a multiple root. In numbers of twice the length
//! that leaves some sixteen, so that its roots come out right to the last bit of an f64. Sums, products, quotients and
//! roots err by a few `1e-32` of the largest of their parts.

use nalgebra::Complex;
pub(crate) use qd::Quad;

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
