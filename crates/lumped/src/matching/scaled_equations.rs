//! The equations of coefficient matching scaled to size one, their cubic and what each of its roots gives.

use crate::matching::cubic::{CubicRoot, CubicUncertainty, cubic_roots};
use crate::matching::double_length::{ComplexDoubleLength, ComplexQuad, DoubleLength, Quad, real};

/// Relative size below which a discriminant counts as zero: two mirror solutions coincide, or a root lies on the
/// border between real and complex ones.
const NOISE: f64 = 1e-26;
/// The equations in a unit of time that makes them of size one, with `kappa = 1 + m2/m1`.
pub(crate) struct ScaledEquations {
    /// The unit of time, 1/s.
    pub unit: f64,
    t: Quad,
    u: Quad,
    v: Quad,
    w: Quad,
    kappa: Quad,
    rounding: f64,
}

impl ScaledEquations {
    /// Of `t, u, v, w` and `kappa`, each uncertain by a relative rounding.
    pub fn new(polynomial: [Quad; 4], kappa: Quad, rounding: f64) -> Self {
        // A power of two loses nothing.
        let [t, u, v, w] = polynomial.map(|c| c.0.abs());
        let size = [t, u.sqrt(), v.cbrt(), w.sqrt().sqrt()].into_iter().fold(0.0, f64::max);
        let unit = if size > 0.0 { size.log2().round().exp2() } else { 1.0 };
        let mut power = 1.0;
        let [t, u, v, w] = polynomial.map(|c| {
            power *= unit;
            c.times_power_of_two(1.0 / power)
        });
        Self { unit, t, u, v, w, kappa, rounding }
    }

    /// Coefficients of the cubic in `zeta`, without the leading 1: `r1² r0² - (r1 r0)²` over `-4 kappa`.
    pub fn cubic(&self) -> [Quad; 3] {
        let Self { t, u, v, w, kappa, .. } = *self;
        let kw = (kappa * w).times_power_of_two(4.0);
        [u.times_power_of_two(-2.0), u * u + t * v - kw, kappa * (v * v) + t * t * w - t * u * v]
    }

    /// `r1²`, `r0²` and `r1 r0` at a `zeta`, each with the sum of the moduli of its parts.
    fn squares_and_product(&self, zeta: ComplexQuad) -> [(ComplexQuad, f64); 3] {
        let Self { t, u, v, w, kappa, .. } = *self;
        let rest = real(u) - zeta;
        let (kz, kw, kv) = (
            zeta.scale(kappa.times_power_of_two(4.0)),
            (kappa * w).times_power_of_two(4.0),
            (kappa * v).times_power_of_two(2.0),
        );
        let of_rest = u.0.abs() + zeta.modulus();
        [
            (real(t * t) - kz, t.0 * t.0 + kz.modulus()),
            (rest * rest - real(kw), rest.modulus() * of_rest + kw.0.abs()),
            (rest.scale(t) - real(kv), t.0.abs() * of_rest + kv.0.abs()),
        ]
    }

    /// The roots of the cubic, those that are equal within the rounding of the coefficients as one.
    ///
    /// With each of the parts of `r1²`, `r0²` and `r1 r0` right to two roundings, as products are, the cubic is
    /// uncertain by what `(r1² ± a)(r0² ± b) - (r1 r0 ± c)²` is over `4 kappa`. That is least where a solution is
    /// its own dual and all three are zero.
    pub fn roots(&self) -> Vec<CubicRoot> {
        let Self { t, u, v, w, kappa, rounding, .. } = *self;
        let value = |zeta: Quad| {
            let [(square_1, a), (square_0, b), (product, c)] = self.squares_and_product(real(zeta));
            let [a, b, c] = [a, b, c].map(|size| 2.0 * rounding * size);
            let first = square_1.modulus() * b + square_0.modulus() * a + 2.0 * product.modulus() * c;
            (first + a * b + c * c) / (4.0 * kappa.0)
        };
        let parts = 2.0 / 3.0 * u.0 * u.0 + (t * v).0.abs() + 4.0 * (kappa * w).0.abs();
        cubic_roots(self.cubic(), &CubicUncertainty { value: &value, slope: 2.0 * rounding * parts })
    }

    /// `t` and `u - zeta`, `r1` and `r0` of one of the two dual solutions at a root; `r1 = r0 = 0` where they are one.
    pub fn sums_and_differences(&self, root: &CubicRoot) -> ([ComplexQuad; 2], [ComplexQuad; 2]) {
        let [t, u] = [self.t, self.u].map(real);
        // A solution is its own dual where `r1` is zero at a multiple root: `r0` is zero there too.
        let own_dual = real(self.t * self.t / self.kappa.times_power_of_two(4.0));
        let beyond = root.value - own_dual;
        let [_, (square_0, size_0), (product, size)] = self.squares_and_product(own_dual);
        let noise = 2.0 * self.rounding;
        let meets_all = square_0.modulus() <= noise * size_0 && product.modulus() <= noise * size;
        if root.multiplicity > 1 && beyond.modulus() <= root.radius && (meets_all || beyond.re.0 >= 0.0) {
            return ([t, u - own_dual], [real(Quad::ZERO); 2]);
        }
        let rest = u - root.value;
        let [(square_1, size_1), (square_0, size_0), (product, _)] = self.squares_and_product(root.value);
        let (square_1, square_0) = (denoise(square_1, size_1), denoise(square_0, size_0));
        // The larger by its root, the other by division: no sign to guess and nothing lost in the smaller.
        let larger =
            square_1.modulus() * (1.0 + rest.modulus().powi(2)) >= square_0.modulus() * (1.0 + t.modulus().powi(2));
        let differences = if square_1.modulus() == 0.0 && square_0.modulus() == 0.0 {
            [real(Quad::ZERO); 2]
        } else if larger {
            let (r1, inverse) = root_and_inverse(square_1);
            [r1, product * inverse]
        } else {
            let (r0, inverse) = root_and_inverse(square_0);
            [product * inverse, r0]
        };
        ([t, rest], differences)
    }
}

/// `r` and `1/r` of `r²`, which is mostly real: then its root needs one division for both of its parts.
fn root_and_inverse(square: ComplexQuad) -> (ComplexQuad, ComplexQuad) {
    let root = square.square_root();
    let is_real = square.im == Quad::ZERO;
    (root, if is_real { root.scale(Quad::ONE / square.re) } else { real(Quad::ONE) / root })
}

/// Sets to zero the real or imaginary part that is rounding of numbers of this size, so that a real solution is real.
pub(crate) fn denoise(x: ComplexQuad, size: f64) -> ComplexQuad {
    let clean = |part: Quad| if part.0.abs() <= NOISE * size { Quad::ZERO } else { part };
    ComplexQuad::new(clean(x.re), clean(x.im))
}
