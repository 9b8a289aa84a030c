//! Derivatives of a linear motion by its parameters, eight side by side.
//!
//! The exponential of a step and its derivatives come from one pass of scaling, Taylor series and squaring, each
//! operation differentiated by the product rule: no finite differences, and no step error that depends on the sampling
//! interval. The eight derivatives of an entry stand together, so that the processor's vectors are full however small
//! the matrix is; every lane does the operations of a single derivative in the same order, hence the same bits for
//! every vector width. Plain loops: closures would not be compiled for the vectors of the caller.

use pulp::{Simd, WithSimd};

use crate::exact::scaling::{TERMS, squarings_of};
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
    pub at: &'a Instants,
    pub waves: Waves,
}

impl WithSimd for DerivativesAbreast<'_> {
    /// The motion of every mass, and that of every parameter; of the first as many as there are places.
    type Output = (Vec<Motion>, [Vec<Motion>; ABREAST]);

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        self.march()
    }
}

impl DerivativesAbreast<'_> {
    /// A sensitivity goes `s(t+dt) = phi s + dphi z`. The first instant is reached by one step of its own;
    /// accelerations come from `A z` and `A s + dA z`, not from differences.
    #[inline(always)]
    fn march(&self) -> <Self as WithSimd>::Output {
        let (n, masses, at, per_tau) = (self.start.len(), self.masses, self.at, self.tau_s.recip());
        let asked = self.waves.asked();
        let mut motions = vec![Motion::zeros(at.samples, self.waves); masses];
        let mut derivatives: Vec<[Vec<Lanes>; 3]> =
            (0..masses).map(|_| asked.map(|asked| vec![[0.0; ABREAST]; if asked { at.samples } else { 0 }])).collect();
        let (mut z, mut s) = (self.start.to_vec(), self.start_by.to_vec());
        let (mut next_z, mut next_s) = (z.clone(), s.clone());
        if at.first_s > 0.0 {
            let (phi, dphi) = self.exponential(at.first_s);
            applied(&phi, &dphi, (&z, &s), (&mut next_z, &mut next_s), 0..n);
            (z, s) = (next_z.clone(), next_s.clone());
        }
        let (phi, dphi) = self.exponential(at.dt_s);
        let (mut rate_z, mut rate_s) = (z.clone(), s.clone());
        for k in 0..at.samples {
            if asked[2] {
                applied(self.a, self.da, (&z, &s), (&mut rate_z, &mut rate_s), masses..2 * masses);
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
            applied(&phi, &dphi, (&z, &s), (&mut next_z, &mut next_s), 0..n);
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
        (motions, std::array::from_fn(of_lane))
    }

    /// `exp(A t)` and its derivatives, `t` in s.
    #[inline(always)]
    fn exponential(&self, t_s: f64) -> (Vec<f64>, Vec<Lanes>) {
        let n = self.start.len();
        let t = t_s / self.tau_s;
        let column = |j: usize| (0..n).map(|i| self.a[i * n + j].abs()).sum::<f64>();
        let squarings = squarings_of((0..n).map(column).fold(0.0, f64::max) * t.abs());
        let h = t * 0.5_f64.powi(squarings);
        let x: Vec<f64> = self.a.iter().map(|a| a * h).collect();
        let dx: Vec<Lanes> = self.da.iter().map(|d| scaled(d, h)).collect();
        let (mut phi, mut dphi) = (x.clone(), dx.clone());
        (0..n).for_each(|i| phi[i * n + i] += 1.0);
        let (mut term, mut dterm) = (x.clone(), dx.clone());
        let (mut product, mut dproduct) = (x.clone(), dx.clone());
        for k in 2..=TERMS {
            multiplied(n, (&term, &dterm), (&x, &dx), (&mut product, &mut dproduct));
            let factor = 1.0 / k as f64;
            for i in 0..n * n {
                term[i] = product[i] * factor;
                phi[i] += term[i];
                for lane in 0..ABREAST {
                    dterm[i][lane] = dproduct[i][lane] * factor;
                    dphi[i][lane] += dterm[i][lane];
                }
            }
        }
        for _ in 0..squarings {
            multiplied(n, (&phi, &dphi), (&phi, &dphi), (&mut product, &mut dproduct));
            std::mem::swap(&mut phi, &mut product);
            std::mem::swap(&mut dphi, &mut dproduct);
        }
        (phi, dphi)
    }
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
fn multiplied(n: usize, a: (&[f64], &[Lanes]), b: (&[f64], &[Lanes]), product: (&mut [f64], &mut [Lanes])) {
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
fn applied(
    matrix: &[f64],
    by: &[Lanes],
    (z, s): (&[f64], &[Lanes]),
    (next_z, next_s): (&mut [f64], &mut [Lanes]),
    rows: std::ops::Range<usize>,
) {
    let n = z.len();
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
