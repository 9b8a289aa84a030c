//! Springs and dampers of the double model from its characteristic polynomial: every solution.
//!
//! The characteristic polynomial of the double model, `s^4 + t s^3 + u s^2 + v s + w`, has with the masses m1, m2:
//! - `t = (m1 c2 + m2 (c1 + c2))/(m1 m2)`
//! - `u = (m1 k2 + m2 (k1 + k2) + c1 c2)/(m1 m2)`
//! - `v = (c1 k2 + c2 k1)/(m1 m2)`
//! - `w = k1 k2/(m1 m2)`
//!
//! Four equations for `k1, k2, c1, c2`, with six solutions counted with multiplicity ([`CoefficientMatching::solve`]).
//! An identified model gives the polynomial through its four poles; which of the solutions is the vehicle, poles cannot
//! say.

use std::ops::{Add, Mul};

use nalgebra::Matrix4;

use crate::error::{finite, positive};
use crate::matching::cubic::{
    ComplexDoubleLength, ComplexQuad, CubicRoot, CubicUncertainty, DoubleLength, Quad, cubic_roots, decimal, real,
};
use crate::{Complex, DoubleSpringMassDamper, LumpedError};

/// By how much a coefficient or a mass given as a binary number may be off, relative: four roundings, as many as it
/// takes to compute one.
const ROUNDING: f64 = 2.0 * f64::EPSILON;
/// Smale's bound for an approximate zero, `(13 - 3 sqrt 17)/4`.
const ALPHA: f64 = 0.157_670_780_786_5;

/// How the given numbers are meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Reading {
    /// As binary numbers, each right to four roundings: solutions that are equal within those are equal.
    #[default]
    Binary,
    /// As the decimal numbers they are written as, exactly: `0.1` is one tenth. Matters next to multiple solutions
    /// only.
    Decimal,
}

impl Reading {
    fn read(self, x: f64) -> Quad {
        match self {
            Self::Binary => Quad::from(x),
            Self::Decimal => decimal(x),
        }
    }
}

/// The polynomial `s^4 + t s^3 + u s^2 + v s + w` to be met and the masses to meet it with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoefficientMatching {
    /// Relative uncertainty of the numbers.
    rounding: f64,
    polynomial: [Quad; 4],
    m1: Quad,
    m2: Quad,
}

/// All parameter sets of the double model with a given characteristic polynomial.
#[derive(Debug, Clone, PartialEq)]
pub struct CoefficientMatch {
    /// `t, u, v, w` of the polynomial.
    pub polynomial: [f64; 4],
    /// Mass of the chassis, kg.
    pub m1_kg: f64,
    /// Mass of the compartment, kg.
    pub m2_kg: f64,
    /// Upper bound of `m2/m1` for physical parameters, see [`CoefficientMatching::largest_mass_ratio`]; `None`: no
    /// masses give such parameters.
    pub largest_mass_ratio: Option<f64>,
    /// Roots `zeta = c1 c2/(m1 m2)` of the cubic, 1/s², each with its multiplicity; real ones first.
    pub roots: Vec<MatchRoot>,
    /// The solutions, real ones first, by rising `k1`; multiplicities sum to six.
    pub solutions: Vec<MatchedSolution>,
}

/// One root of the cubic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MatchRoot {
    /// `zeta = c1 c2/(m1 m2)`, 1/s².
    pub zeta: Complex,
    /// How often it counts.
    pub multiplicity: usize,
    /// Proof that a true root lies within a radius; `None` at a multiple root, where there is none.
    pub certificate: Option<Certificate>,
}

/// An approximate zero in the sense of Smale's alpha theory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Certificate {
    /// `alpha = beta gamma`, below 0.1577.
    pub alpha: f64,
    /// Distance `2 beta` within which the exact root of the polynomial as given lies, 1/s².
    pub radius: f64,
}

/// One parameter set, possibly complex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MatchedSolution {
    /// Spring between barrier and chassis, N/m.
    pub k1_n_per_m: Complex,
    /// Spring between chassis and compartment, N/m.
    pub k2_n_per_m: Complex,
    /// Damper between barrier and chassis, N·s/m.
    pub c1_n_s_per_m: Complex,
    /// Damper between chassis and compartment, N·s/m.
    pub c2_n_s_per_m: Complex,
    /// Whether all four are real.
    pub real: bool,
    /// Whether all four are real, the springs positive and the dampers not negative: a passive structure, as
    /// [`Model::is_physical`](crate::Model::is_physical) has it.
    pub physical: bool,
    /// How often it counts.
    pub multiplicity: usize,
    /// Index among the solutions of the dual one, with the same compartment motion; its own where the two coincide.
    pub dual: usize,
    /// Index of the root of the cubic it belongs to.
    pub root: usize,
    /// Largest mismatch of the four equations, each relative to the sum of its moduli.
    pub residual: f64,
}

impl CoefficientMatching {
    /// A polynomial `t, u, v, w` and two masses. Errors: masses that are not positive, coefficients that are not
    /// finite.
    pub fn new(polynomial: [f64; 4], m1_kg: f64, m2_kg: f64, reading: Reading) -> Result<Self, LumpedError> {
        for (name, x) in ["t", "u", "v", "w"].into_iter().zip(polynomial) {
            finite(name, x)?;
        }
        Self::with_masses(polynomial.map(|x| reading.read(x)), m1_kg, m2_kg, reading)
    }

    /// The polynomial with these four poles, multiplied out in double length. Errors: as [`new`](Self::new), and poles
    /// that are not real or in conjugate pairs.
    pub fn from_poles(poles: &[Complex; 4], m1_kg: f64, m2_kg: f64, reading: Reading) -> Result<Self, LumpedError> {
        let mut product = [real(Quad::ZERO); 5];
        product[0] = real(Quad::ONE);
        for (degree, pole) in poles.iter().enumerate() {
            finite("real part of a pole", pole.re)?;
            finite("imaginary part of a pole", pole.im)?;
            let root = ComplexQuad::new(reading.read(pole.re), reading.read(pole.im));
            for k in (0..=degree).rev() {
                product[k + 1] -= product[k] * root;
            }
        }
        let size = poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
        for (k, c) in product.iter().enumerate().skip(1) {
            if c.im.0.abs() > 1e-9 * size.powf(k as f64) {
                return Err(LumpedError::Value {
                    name: "imaginary part of the polynomial",
                    value: c.im.0,
                    expected: "0: poles that are real or come in conjugate pairs",
                });
            }
        }
        Self::with_masses([1, 2, 3, 4].map(|k| product[k].re), m1_kg, m2_kg, reading)
    }

    fn with_masses(polynomial: [Quad; 4], m1_kg: f64, m2_kg: f64, reading: Reading) -> Result<Self, LumpedError> {
        positive("m1_kg", m1_kg)?;
        positive("m2_kg", m2_kg)?;
        let rounding = if reading == Reading::Binary { ROUNDING } else { 0.0 };
        Ok(Self { rounding, polynomial, m1: reading.read(m1_kg), m2: reading.read(m2_kg) })
    }

    /// `t, u, v, w`.
    pub fn polynomial(&self) -> [f64; 4] {
        self.polynomial.map(DoubleLength::value)
    }

    /// The same polynomial with other masses.
    pub fn with(&self, m1_kg: f64, m2_kg: f64) -> Result<Self, LumpedError> {
        Ok(Self { rounding: self.rounding, ..Self::with_masses(self.polynomial, m1_kg, m2_kg, Reading::Binary)? })
    }

    /// The bound `rho = (t u v - v^2 - t^2 w)/v^2` of `m2/m1`: with a stable polynomial, every real solution is
    /// physical (springs positive, dampers not negative) below it and none above it; at the bound one damper is zero.
    ///
    /// Without damping, `t = v = 0`, the bound is `u^2/(4w) - 1`, where the two stiffness sets meet: `k1/m1` solves
    /// `k^2 - u k + kappa w = 0`. `None` if no masses give physical parameters: a coefficient or the Routh determinant
    /// `t u v - v^2 - t^2 w` is not positive (nor damping absent altogether), the polynomial is not that of a passive
    /// chain.
    pub fn largest_mass_ratio(&self) -> Option<f64> {
        let [t, u, v, w] = self.polynomial;
        if t == Quad::ZERO && v == Quad::ZERO {
            let spread = u * u - w.times_power_of_two(4.0);
            return (u.0 > 0.0 && w.0 > 0.0 && spread.0 > 0.0).then(|| (spread / w.times_power_of_two(4.0)).value());
        }
        let routh = t * u * v - v * v - t * t * w;
        let stable = self.polynomial.iter().all(|x| x.0 > 0.0) && routh.0 > 0.0;
        stable.then(|| (routh / (v * v)).value())
    }

    /// All six solutions.
    ///
    /// With `kappa = 1 + m2/m1`, `zeta = c1 c2/(m1 m2)` solves the cubic
    /// `zeta³ - 2u zeta² + (u² + t v - 4 kappa w) zeta + (kappa v² + t² w - t u v) = 0`, and each root gives a pair of
    /// dual solutions in closed form: `c1/m1, c2/mr = (t ± r1)/2`, `k1/m1, k2/mr = (u - zeta ± r0)/2` with
    /// `mr = m1 m2/(m1 + m2)`, `r1² = t² - 4 kappa zeta`, `r0² = (u - zeta)² - 4 kappa w`, signs tied by
    /// `r1 r0 = t (u - zeta) - 2 kappa v`. So there are six with multiplicity; two, four or six of them real, never
    /// none.
    ///
    /// In double-length arithmetic throughout: rounding of the results to f64 is all that is lost, also at double
    /// roots. Real parameters are right to a few `1e-16` of the larger of each pair, `c1/m1` beside `c2/mr`, except
    /// where the given coefficients themselves leave them uncertain: see [`matching_sensitivity`]. Roots of the cubic
    /// and dual solutions that are equal within the rounding of the coefficients ([`Reading`]) are one, with its
    /// multiplicity: such a polynomial is as near to one with equal solutions as to one with none there.
    pub fn solve(&self) -> CoefficientMatch {
        let kappa = Quad::ONE + self.m2 / self.m1;
        let equations = ScaledEquations::new(self.polynomial, kappa, self.rounding);
        let unit = equations.unit;
        let zetas = equations.roots();
        let product = self.m1 * self.m2;
        let reduced = product / (self.m1 + self.m2);
        let [t, u, v, w] = self.polynomial.map(|c| -(c * product));
        let given = [self.m1, self.m2, t, u, v, w];
        let mut solutions = Vec::with_capacity(6);
        for (place, root) in zetas.iter().enumerate() {
            let (sums, r) = equations.sums_and_differences(root);
            let base = solutions.len();
            let coincide = r.iter().all(|r| r.modulus() == 0.0);
            let multiplicity = if coincide { 2 * root.multiplicity } else { root.multiplicity };
            let mut put = |r: [ComplexQuad; 2], dual: usize| {
                let solution = self.solution([sums[0], sums[1], r[0], r[1]], reduced, unit, given);
                solutions.push(MatchedSolution { dual, root: place, multiplicity, ..solution });
            };
            put(r, if coincide { base } else { base + 1 });
            if !coincide {
                put(r.map(|r| -r), base);
            }
        }
        let cubic = equations.cubic();
        let roots = zetas
            .iter()
            .map(|root| MatchRoot {
                zeta: root.value.value() * (unit * unit),
                multiplicity: root.multiplicity,
                certificate: (root.multiplicity == 1).then(|| certify(cubic, root.value, unit)).flatten(),
            })
            .collect();
        CoefficientMatch {
            polynomial: self.polynomial(),
            m1_kg: self.m1.value(),
            m2_kg: self.m2.value(),
            largest_mass_ratio: self.largest_mass_ratio(),
            roots,
            solutions: ordered(solutions),
        }
    }

    /// Half sums and differences: `c1/m1 = (t + r1)/2`, `c2/mr = (t - r1)/2`, the same of the springs with `u - zeta`
    /// and `r0`. `unit` is the unit of time, 1/s, that `t, rest, r1, r0` are in; `given`: see
    /// [`residual`].
    fn solution(
        &self,
        [t, rest, r1, r0]: [ComplexQuad; 4],
        reduced: Quad,
        unit: f64,
        given: [Quad; 6],
    ) -> MatchedSolution {
        let half = |sum: ComplexQuad, a: ComplexQuad, b: ComplexQuad, scale: Quad| {
            let sum = denoise(sum, a.modulus() + b.modulus());
            if sum.im == Quad::ZERO { real(sum.re * scale) } else { sum.scale(scale) }
        };
        let [rate, square] = [0.5 * unit, 0.5 * unit * unit];
        let c1 = half(t + r1, t, r1, self.m1.times_power_of_two(rate));
        let c2 = half(t - r1, t, r1, reduced.times_power_of_two(rate));
        let k1 = half(rest + r0, rest, r0, self.m1.times_power_of_two(square));
        let k2 = half(rest - r0, rest, r0, reduced.times_power_of_two(square));
        let values = [k1, k2, c1, c2];
        let is_real = values.iter().all(|z| z.im == Quad::ZERO);
        let [k1_n_per_m, k2_n_per_m, c1_n_s_per_m, c2_n_s_per_m] = values.map(ComplexDoubleLength::value);
        MatchedSolution {
            k1_n_per_m,
            k2_n_per_m,
            c1_n_s_per_m,
            c2_n_s_per_m,
            real: is_real,
            physical: is_real && [k1, k2].iter().all(|z| z.re.0 > 0.0) && [c1, c2].iter().all(|z| z.re.0 >= 0.0),
            multiplicity: 1,
            dual: 0,
            root: 0,
            residual: residual([k1_n_per_m, k2_n_per_m, c1_n_s_per_m, c2_n_s_per_m], given),
        }
    }

    /// The solutions for many divisions of one total mass, `m1/(m1 + m2)` from the list.
    ///
    /// Real solutions move continuously with the division, except where two meet and turn complex.
    pub fn mass_split_sweep(&self, front_fractions: &[f64]) -> Result<Vec<CoefficientMatch>, LumpedError> {
        let total = (self.m1 + self.m2).value();
        front_fractions.iter().map(|f| Ok(self.with(f * total, (1.0 - f) * total)?.solve())).collect()
    }
}

/// Mismatch of the four equations for rounded `k1, k2, c1, c2`, in double length. `given`: `m1, m2`, then `t, u, v, w`
/// times `-m1 m2`, the same for all solutions.
///
/// `max |sum of the terms|/(sum of their moduli)` over the four equations: some `1e-16` for parameters rounded to
/// f64.
fn residual(parameters: [Complex; 4], given: [Quad; 6]) -> f64 {
    if parameters.iter().all(|z| z.im == 0.0) {
        largest_mismatch(parameters.map(|z| Quad::from(z.re)), given, |x| x.0.abs())
    } else {
        let parameters = parameters.map(|z| ComplexQuad::new(Quad::from(z.re), Quad::from(z.im)));
        largest_mismatch(parameters, given.map(real), ComplexDoubleLength::modulus)
    }
}

/// See [`residual`]: in real or in complex numbers.
fn largest_mismatch<T>([k1, k2, c1, c2]: [T; 4], [m1, m2, t, u, v, w]: [T; 6], size: impl Fn(T) -> f64) -> f64
where
    T: Copy + Add<Output = T> + Mul<Output = T>,
{
    let mismatch = |first: T, others: &[T]| {
        let sum = others.iter().fold(first, |sum, &x| sum + x);
        let sizes: f64 = size(first) + others.iter().map(|&x| size(x)).sum::<f64>();
        if sizes > 0.0 { size(sum) / sizes } else { 0.0 }
    };
    [
        mismatch(t, &[m1 * c2, m2 * c1, m2 * c2]),
        mismatch(u, &[m1 * k2, m2 * k1, m2 * k2, c1 * c2]),
        mismatch(v, &[c1 * k2, c2 * k1]),
        mismatch(w, &[k1 * k2]),
    ]
    .into_iter()
    .fold(0.0, f64::max)
}

/// Real solutions first, by `k1`; then complex ones by the real and imaginary part of `k1`.
fn ordered(solutions: Vec<MatchedSolution>) -> Vec<MatchedSolution> {
    let mut order: Vec<usize> = (0..solutions.len()).collect();
    order.sort_by(|&i, &j| {
        let key = |s: &MatchedSolution| (s.k1_n_per_m.re, s.k1_n_per_m.im);
        let (a, b) = (&solutions[i], &solutions[j]);
        b.real.cmp(&a.real).then(key(a).0.total_cmp(&key(b).0)).then(key(a).1.total_cmp(&key(b).1))
    });
    let mut place = vec![0; order.len()];
    for (new, &old) in order.iter().enumerate() {
        place[old] = new;
    }
    order.iter().map(|&old| MatchedSolution { dual: place[solutions[old].dual], ..solutions[old] }).collect()
}

/// Alpha theory at `z`: `beta = |f/f'|`, `gamma = max |f^(k)/(k! f')|^(1/(k-1))`.
fn certify([a, b, c]: [Quad; 3], z: ComplexQuad, unit: f64) -> Option<Certificate> {
    let [ca, cb, cc, twice_a] = [a, b, c, a.times_power_of_two(2.0)].map(real);
    let (f, three_z) = (((z + ca) * z + cb) * z + cc, z.scale(Quad::from(3.0)));
    // Rounding of the evaluation itself bounds what can be proved.
    let size = z.modulus();
    let noise = 1e-31 * (size.powi(3) + a.0.abs() * size * size + b.0.abs() * size + c.0.abs());
    let slope = ((three_z + twice_a) * z + cb).modulus();
    let curvature = (three_z + ca).modulus();
    if slope == 0.0 {
        return None;
    }
    let beta = (f.modulus() + noise) / slope;
    let gamma = (curvature / slope).max((1.0 / slope).sqrt());
    let alpha = beta * gamma;
    (alpha < ALPHA).then_some(Certificate { alpha, radius: 2.0 * beta * unit * unit })
}

impl MatchedSolution {
    /// The model, for a real solution.
    pub fn model(&self, m1_kg: f64, m2_kg: f64) -> Option<DoubleSpringMassDamper> {
        self.real.then_some(DoubleSpringMassDamper {
            m1_kg,
            m2_kg,
            k1_n_per_m: self.k1_n_per_m.re,
            k2_n_per_m: self.k2_n_per_m.re,
            c1_n_s_per_m: self.c1_n_s_per_m.re,
            c2_n_s_per_m: self.c2_n_s_per_m.re,
        })
    }

    /// Zero `-k2/c2` of the transfer function from a force on the chassis to the compartment, 1/s; `None` without `c2`.
    pub fn zero(&self) -> Option<Complex> {
        (self.c2_n_s_per_m.norm() > 0.0).then(|| -self.k2_n_per_m / self.c2_n_s_per_m)
    }
}

/// Relative change of `k1, k2, c1, c2` (rows) for a relative change of `t, u, v, w` (columns), by implicit
/// differentiation of the four equations. Grows without bound towards a multiple solution: `None` there, and where
/// a coefficient or parameter is zero.
pub fn matching_sensitivity(model: &DoubleSpringMassDamper) -> Option<Matrix4<f64>> {
    let (m1, m2) = (model.m1_kg, model.m2_kg);
    let p = [model.k1_n_per_m, model.k2_n_per_m, model.c1_n_s_per_m, model.c2_n_s_per_m];
    let [k1, k2, c1, c2] = p;
    #[rustfmt::skip]
    let forward = Matrix4::new(
        0.0,             0.0,             1.0 / m1,        (m1 + m2) / (m1 * m2),
        1.0 / m1,        (m1 + m2) / (m1 * m2), c2 / (m1 * m2), c1 / (m1 * m2),
        c2 / (m1 * m2),  c1 / (m1 * m2),  k2 / (m1 * m2),  k1 / (m1 * m2),
        k2 / (m1 * m2),  k1 / (m1 * m2),  0.0,             0.0,
    );
    let coefficients = model.characteristic_polynomial();
    let relative = Matrix4::from_fn(|i, j| forward[(i, j)] * p[j] / coefficients[i + 1]);
    let inverse = relative.try_inverse()?;
    inverse.iter().all(|x| x.is_finite()).then_some(inverse)
}

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
fn denoise(x: ComplexQuad, size: f64) -> ComplexQuad {
    let clean = |part: Quad| if part.0.abs() <= NOISE * size { Quad::ZERO } else { part };
    ComplexQuad::new(clean(x.re), clean(x.im))
}
