//! Derivatives of a linear motion by its parameters, eight side by side.
//!
//! The exponential of a step and its derivatives come from one pass of scaling, Taylor series and squaring, each
//! operation differentiated by the product rule: no finite differences, and no step error that depends on the sampling
//! interval. The eight derivatives of an entry stand together, so that the processor's vectors are full however small
//! the matrix is; every lane does the operations of a single derivative in the same order, hence the same bits for
//! every vector width. Plain loops: closures would not be compiled for the vectors of the caller.

use pulp::{Simd, WithSimd};

use crate::exact::scaling::{INVERSE_FACTORIALS, POWERS, TERMS, squarings_of};
use crate::motion::mass_motion::Waves;
use crate::{Instants, Motion};

/// Derivatives side by side.
pub(crate) const ABREAST: usize = 8;
/// The derivatives of one number; places that nothing fills are zero.
pub(crate) type Lanes = [f64; ABREAST];

/// A linear motion and how eight parameters change it, marched over instants. Matrices are row after row, time in
/// units of `tau_s`.
pub(crate) struct DerivativesAbreast<'a> {
    pub masses: usize,
    pub tau_s: f64,
    /// The matrix, N x N.
    pub a: &'a [f64],
    /// Its derivatives.
    pub da: &'a [Lanes],
    /// The state at the start, N.
    pub start: &'a [f64],
    /// Its derivatives.
    pub start_by: &'a [Lanes],
    /// How many of the lanes are filled.
    pub filled: usize,
    pub at: &'a Instants,
    pub waves: Waves,
}

impl WithSimd for DerivativesAbreast<'_> {
    /// The motion of every mass, and how every parameter of a filled lane changes it.
    type Output = (Vec<Motion>, Vec<Vec<Motion>>);

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        // Loops of a known length are unrolled.
        match self.start.len() {
            2 => self.march::<2>(),
            3 => self.march::<3>(),
            4 => self.march::<4>(),
            6 => self.march::<6>(),
            _ => self.march::<UNKNOWN>(),
        }
    }
}

impl DerivativesAbreast<'_> {
    /// `N`: number of states, or [`UNKNOWN`]. A sensitivity goes `s(t+dt) = phi s + dphi z`. The first instant is
    /// reached by one step of its own; accelerations come from `A z` and `A s + dA z`, not from differences.
    #[inline(always)]
    fn march<const N: usize>(&self) -> <Self as WithSimd>::Output {
        let (n, masses, at, per_tau) = (known::<N>(self.start.len()), self.masses, self.at, self.tau_s.recip());
        let asked = self.waves.asked();
        let mut motions = vec![Motion::zeros(at.samples, self.waves); masses];
        let mut derivatives: Vec<[Vec<Lanes>; 3]> =
            (0..masses).map(|_| asked.map(|asked| vec![[0.0; ABREAST]; if asked { at.samples } else { 0 }])).collect();
        let (mut z, mut s) = (self.start.to_vec(), self.start_by.to_vec());
        let (mut next_z, mut next_s) = (z.clone(), s.clone());
        if at.first_s > 0.0 {
            let (phi, dphi) = self.exponential::<N>(at.first_s);
            applied::<N>(&phi, &dphi, (&z, &s), (&mut next_z, &mut next_s), 0..n);
            (z, s) = (next_z.clone(), next_s.clone());
        }
        let (phi, dphi) = self.exponential::<N>(at.dt_s);
        let (mut rate_z, mut rate_s) = (z.clone(), s.clone());
        for k in 0..at.samples {
            if asked[2] {
                applied::<N>(self.a, self.da, (&z, &s), (&mut rate_z, &mut rate_s), masses..2 * masses);
            }
            for mass in 0..masses {
                let (motion, derivative) = (&mut motions[mass], &mut derivatives[mass]);
                if asked[0] {
                    (motion.displacement_m[k], derivative[0][k]) = (z[mass], s[mass]);
                }
                if asked[1] {
                    motion.velocity_m_per_s[k] = z[masses + mass] * per_tau;
                    derivative[1][k] = scaled(&s[masses + mass], per_tau);
                }
                if asked[2] {
                    motion.acceleration_m_per_s2[k] = rate_z[masses + mass] * per_tau * per_tau;
                    derivative[2][k] = scaled(&rate_s[masses + mass], per_tau * per_tau);
                }
            }
            applied::<N>(&phi, &dphi, (&z, &s), (&mut next_z, &mut next_s), 0..n);
            std::mem::swap(&mut z, &mut next_z);
            std::mem::swap(&mut s, &mut next_s);
        }
        let of_lane = |lane: usize| {
            let wave = |wave: &Vec<Lanes>| wave.iter().map(|lanes| lanes[lane]).collect();
            let motion = |[x, v, a]: &[Vec<Lanes>; 3]| Motion {
                displacement_m: wave(x),
                velocity_m_per_s: wave(v),
                acceleration_m_per_s2: wave(a),
            };
            derivatives.iter().map(motion).collect()
        };
        (motions, (0..self.filled).map(of_lane).collect())
    }

    /// `exp(A t)` and its derivatives, `t` in s.
    #[inline(always)]
    fn exponential<const N: usize>(&self, t_s: f64) -> (Vec<f64>, Vec<Lanes>) {
        let n = known::<N>(self.start.len());
        let t = t_s / self.tau_s;
        let column = |j: usize| (0..n).map(|i| self.a[i * n + j].abs()).sum::<f64>();
        let squarings = squarings_of((0..n).map(column).fold(0.0, f64::max) * t.abs());
        let h = t * 0.5_f64.powi(squarings);
        let x: Vec<f64> = self.a.iter().map(|a| a * h).collect();
        let dx: Vec<Lanes> = self.da.iter().map(|d| scaled(d, h)).collect();
        let mut powers: [(Vec<f64>, Vec<Lanes>); POWERS] = std::array::from_fn(|_| (x.clone(), dx.clone()));
        for k in 1..POWERS {
            let (lower, power) = powers.split_at_mut(k);
            let ((a, da), (b, db)) = (&lower[k / 2], &lower[(k - 1) / 2]);
            multiplied::<N>(n, (a, da), (b, db), (&mut power[0].0, &mut power[0].1));
        }
        let (last, dlast) = &powers[POWERS - 1];
        let mut phi: Vec<f64> = last.iter().map(|x| x * INVERSE_FACTORIALS[TERMS]).collect();
        let mut dphi: Vec<Lanes> = dlast.iter().map(|d| scaled(d, INVERSE_FACTORIALS[TERMS])).collect();
        let (mut product, mut dproduct) = (x.clone(), dx.clone());
        for first in (0..TERMS).step_by(POWERS).rev() {
            if first + POWERS < TERMS {
                multiplied::<N>(n, (&phi, &dphi), (last, dlast), (&mut product, &mut dproduct));
                std::mem::swap(&mut phi, &mut product);
                std::mem::swap(&mut dphi, &mut dproduct);
            }
            for i in 0..n {
                phi[i * n + i] += INVERSE_FACTORIALS[first];
            }
            for k in 1..POWERS {
                let (factor, (power, dpower)) = (INVERSE_FACTORIALS[first + k], &powers[k - 1]);
                for i in 0..n * n {
                    phi[i] += power[i] * factor;
                    for lane in 0..ABREAST {
                        dphi[i][lane] += dpower[i][lane] * factor;
                    }
                }
            }
        }
        for _ in 0..squarings {
            multiplied::<N>(n, (&phi, &dphi), (&phi, &dphi), (&mut product, &mut dproduct));
            std::mem::swap(&mut phi, &mut product);
            std::mem::swap(&mut dphi, &mut dproduct);
        }
        (phi, dphi)
    }
}

/// Number of states that is not known to the compiler.
const UNKNOWN: usize = 0;

/// `N`, or where it is [`UNKNOWN`] the number found.
#[inline(always)]
const fn known<const N: usize>(found: usize) -> usize {
    if N == UNKNOWN { found } else { N }
}

#[inline(always)]
fn scaled(lanes: &Lanes, factor: f64) -> Lanes {
    let mut result = *lanes;
    for value in &mut result {
        *value *= factor;
    }
    result
}

/// The product of two square matrices of `n` rows and its derivatives, `d(a b) = da b + a db`.
#[inline(always)]
fn multiplied<const N: usize>(
    n: usize,
    a: (&[f64], &[Lanes]),
    b: (&[f64], &[Lanes]),
    product: (&mut [f64], &mut [Lanes]),
) {
    let n = known::<N>(n);
    let (a, b) = ((&a.0[..n * n], &a.1[..n * n]), (&b.0[..n * n], &b.1[..n * n]));
    let product = (&mut product.0[..n * n], &mut product.1[..n * n]);
    for i in 0..n {
        for j in 0..n {
            let (mut sum, mut by_left, mut by_right) = (0.0, [0.0; ABREAST], [0.0; ABREAST]);
            for k in 0..n {
                let (left, right) = (a.0[i * n + k], b.0[k * n + j]);
                let (dleft, dright) = (&a.1[i * n + k], &b.1[k * n + j]);
                sum += left * right;
                for lane in 0..ABREAST {
                    by_left[lane] += dleft[lane] * right;
                    by_right[lane] += left * dright[lane];
                }
            }
            for lane in 0..ABREAST {
                by_left[lane] += by_right[lane];
            }
            product.0[i * n + j] = sum;
            product.1[i * n + j] = by_left;
        }
    }
}

/// Some rows of the product of a matrix with a state, and its derivatives.
#[inline(always)]
fn applied<const N: usize>(
    matrix: &[f64],
    by: &[Lanes],
    (z, s): (&[f64], &[Lanes]),
    (next_z, next_s): (&mut [f64], &mut [Lanes]),
    rows: std::ops::Range<usize>,
) {
    let n = known::<N>(z.len());
    let (matrix, by, z, s) = (&matrix[..n * n], &by[..n * n], &z[..n], &s[..n]);
    for i in rows {
        let (mut sum, mut dsum) = (0.0, [0.0; ABREAST]);
        for j in 0..n {
            sum += matrix[i * n + j] * z[j];
            for lane in 0..ABREAST {
                dsum[lane] += matrix[i * n + j] * s[j][lane];
            }
        }
        for j in 0..n {
            for lane in 0..ABREAST {
                dsum[lane] += by[i * n + j][lane] * z[j];
            }
        }
        (next_z[i], next_s[i]) = (sum, dsum);
    }
}
