//! Driven linear motion, and derivatives of linear motion by its coefficients.
//!
//! A linear system under a drive: exact steps, exact heat, exact work.
//!
//! A chain, a Maxwell model or any other linear system `z' = A z` gets four more states: position and velocity of the
//! barrier, the input `u` of the drive and its slope. Between samples the drive is a straight line, so `u' = slope` and
//! `slope' = 0` make the whole a free system with one matrix exponential for a step. Heat and work are integrals of
//! quadratic forms of the state and come from a block exponential of twice the size: Van Loan, "Computing integrals
//! involving the matrix exponential", IEEE Trans. Automatic Control 23(3), 1978.
//!
//! Derivatives of a linear motion by its parameters, eight or four side by side.
//!
//! The exponential of a step and its derivatives come from one pass of scaling, Taylor series and squaring, each
//! operation differentiated by the product rule: no finite differences, and no step error that depends on the sampling
//! interval. The derivatives of an entry stand together, so that the processor's vectors are full however small the
//! matrix is; every lane does the operations of a single derivative in the same order, hence the same bits for any
//! number of lanes and every vector width. Plain loops: closures would not be compiled for the vectors of the caller.

use crumple_numerics::lti::matrix_exponential;
use nalgebra::{DMatrix, DVector};
use pulp::{Simd, WithSimd};

use crate::exact::linear_motion::{INVERSE_FACTORIALS, LinearElement, LinearSystem, POWERS, TERMS, squarings_of};
use crate::motion::mass_motion::Asked;
use crate::structure::connected_masses::Form;
use crate::{Drive, Instants, LumpedError, Motion};

/// A linear structure under a drive: states of its own followed by four of the drive: position and velocity of the
/// barrier, the input and its slope.
pub(crate) struct Driven {
    /// The matrix.
    a: DMatrix<f64>,
    /// `z' Q z` is the power that turns into heat.
    heat: DMatrix<f64>,
    /// `z' Q z` is the power that comes in.
    work: DMatrix<f64>,
    masses: usize,
    states: usize,
}

/// The system at one sample.
pub(crate) struct Instant<'a> {
    /// States, those of the drive last.
    pub z: &'a [f64],
    /// Their rates.
    pub rate: &'a [f64],
    /// Heat since the start, J.
    pub dissipated_j: f64,
    /// Work of the drive since the start, J.
    pub input_j: f64,
}

impl Driven {
    /// The system with its powers: of every damper its force times the rate of its compression; force times the
    /// velocity of the mass it acts on, or the force on the barrier times its velocity.
    pub fn new(system: &LinearSystem, drive: &Drive) -> Self {
        let (masses, states) = (system.masses, system.states);
        let size = states + 4;
        let (barrier_v, input) = (states + 1, states + 2);
        let mut a = DMatrix::zeros(size, size);
        system.entries(1.0, &mut |row, column, value| a[(row, column)] += value);
        (a[(states, barrier_v)], a[(input, input + 1)]) = (1.0, 1.0);
        let row_of = |element: &LinearElement, form: &Form| {
            let mut row = DVector::<f64>::zeros(size);
            system.row(element, form, 1.0, &mut |column, value| row[column] += value);
            row
        };
        let rate = Form { w: 1.0, ..Form::ZERO };
        let [mut heat, mut work] = [0; 2].map(|_| DMatrix::zeros(size, size));
        for element in &system.elements {
            // The damper in series with a spring moves at what the spring leaves.
            let of_damper = element.inner.map_or(rate, |(inner, _)| rate.plus(-1.0, &inner));
            heat += row_of(element, &element.damping) * row_of(element, &of_damper).transpose();
        }
        if let Some((mass, _)) = drive.force() {
            a[(masses + mass, input)] = 1.0 / system.masses_kg()[mass];
            work[(masses + mass, input)] = 1.0;
        } else if drive.base().is_some() {
            a[(barrier_v, input)] = 1.0;
            for element in &system.elements {
                for (node, sign) in element.nodes.into_iter().zip([-1.0, 1.0]) {
                    if node == masses {
                        let row = row_of(element, &element.force).transpose();
                        work.row_mut(barrier_v).zip_apply(&row, |sum, term| *sum += sign * term);
                    }
                }
            }
        }
        let [heat, work] = [heat, work].map(|q: DMatrix<f64>| (&q + q.transpose()) * 0.5);
        Self { a, heat, work, masses, states }
    }

    /// Visits `k dt`, k = 0 .. `samples`, from contact.
    ///
    /// One matrix exponential for the step, exact for drives linear between samples; heat and work by the exact
    /// integral of the quadratic form over the step (Van Loan 1978), so the balance closes to rounding, about `1e-15`
    /// of the energy a step. Errors: a motion that leaves the range of numbers.
    pub fn walk(
        &self,
        drive: &Drive,
        dt_s: f64,
        samples: usize,
        mut visit: impl FnMut(Instant<'_>),
    ) -> Result<(), LumpedError> {
        let source = drive.source();
        let at = |k: usize| source.get(k).copied().unwrap_or(0.0);
        let states = self.states;
        // Without a drive its four states stay zero and are left out.
        let active = if source.is_empty() { states } else { states + 4 };
        let part = |m: &DMatrix<f64>| m.view((0, 0), (active, active)).into_owned();
        let a = part(&self.a);
        let phi = Rows::of_matrix(&matrix_exponential(&(&a * dt_s))?);
        let heat = Rows::of_matrix(&integrated(&a, &part(&self.heat), dt_s)?);
        let work = (!source.is_empty()).then(|| integrated(&a, &part(&self.work), dt_s)).transpose()?;
        let work = work.as_ref().map(Rows::of_matrix);
        let a = Rows::of_matrix(&a);

        let mut z = vec![0.0; states + 4];
        let start = drive.start();
        for mass in 0..self.masses {
            [z[mass], z[self.masses + mass]] = start.of_mass(mass);
        }
        let (mut rate, mut next) = (vec![0.0; states + 4], vec![0.0; active]);
        let (mut dissipated_j, mut input_j) = (0.0, 0.0);
        for k in 0..samples {
            z[states + 2] = at(k);
            z[states + 3] = (at(k + 1) - at(k)) / dt_s;
            a.times(&z, &mut rate[..active]);
            if !rate.iter().all(|x| x.is_finite()) {
                return Err(LumpedError::ChainDiverges { time_s: k as f64 * dt_s });
            }
            visit(Instant { z: &z, rate: &rate, dissipated_j, input_j });
            dissipated_j += heat.form(&z, &mut next);
            if let Some(work) = &work {
                input_j += work.form(&z, &mut next);
            }
            phi.times(&z, &mut next);
            z[..active].copy_from_slice(&next);
        }
        Ok(())
    }
}

/// A square matrix row by row.
struct Rows {
    size: usize,
    entries: Vec<f64>,
}

impl Rows {
    /// Copies the entries of a square matrix, row after row.
    fn of_matrix(m: &DMatrix<f64>) -> Self {
        Self { size: m.nrows(), entries: m.transpose().as_slice().to_vec() }
    }

    /// `out = M z`.
    fn times(&self, z: &[f64], out: &mut [f64]) {
        for (row, y) in self.entries.chunks_exact(self.size).zip(out) {
            *y = row.iter().zip(z).map(|(a, b)| a * b).sum();
        }
    }

    /// `z' M z`; `scratch` has room for `M z`.
    fn form(&self, z: &[f64], scratch: &mut [f64]) -> f64 {
        self.times(z, scratch);
        scratch.iter().zip(z).map(|(a, b)| a * b).sum()
    }
}

/// `W` with `integral over a step of z' Q z = z0' W z0`.
///
/// By the block exponential over so short a part of the step that its growing half stays small, then by doubling,
/// `W(2h) = W(h) + phi' W phi`: a stiff damper, whose mirror image in the block grows beyond all numbers, costs no
/// digits.
fn integrated(a: &DMatrix<f64>, q: &DMatrix<f64>, dt_s: f64) -> Result<DMatrix<f64>, LumpedError> {
    let n = a.nrows();
    let norm = dt_s * a.column_iter().map(|c| c.lp_norm(1)).fold(0.0, f64::max);
    let doublings = if norm > 1.0 { (norm.log2().ceil() as i32).clamp(0, 60) } else { 0 };
    let h = dt_s * 0.5_f64.powi(doublings);
    let mut block = DMatrix::zeros(2 * n, 2 * n);
    block.view_mut((0, 0), (n, n)).copy_from(&(-a.transpose() * h));
    // The result is linear in the form: at the size of the rest it costs the exponential no scaling.
    let size = if q.amax() > 0.0 { q.amax() * h } else { 1.0 };
    block.view_mut((0, n), (n, n)).copy_from(&(q * (h / size)));
    block.view_mut((n, n), (n, n)).copy_from(&(a * h));
    let e = matrix_exponential(&block)?;
    let mut phi = e.view((n, n), (n, n)).into_owned();
    let mut w = phi.transpose() * e.view((0, n), (n, n)) * size;
    for _ in 0..doublings {
        w += phi.transpose() * &w * &phi;
        phi = &phi * &phi;
    }
    Ok(w)
}

/// Derivatives side by side.
pub(crate) const ABREAST: usize = 8;
/// The same where no more are left: half as much to compute.
pub(crate) const FEW: usize = 4;
/// The derivatives of one number; places that nothing fills are zero.
pub(crate) type Lanes<const L: usize> = [f64; L];

/// A linear motion and how `L` parameters change it, marched over instants. Matrices are row after row, time in units
/// of `tau_s`.
pub(crate) struct DerivativesAbreast<'a, const L: usize> {
    pub masses: usize,
    pub tau_s: f64,
    /// The matrix, N x N.
    pub a: &'a [f64],
    /// Its derivatives.
    pub da: &'a [Lanes<L>],
    /// The state at the start, N.
    pub start: &'a [f64],
    /// Its derivatives.
    pub start_by: &'a [Lanes<L>],
    /// How many of the lanes are filled.
    pub filled: usize,
    pub at: &'a Instants,
    pub asked: Asked,
}

impl<const L: usize> WithSimd for DerivativesAbreast<'_, L> {
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

impl<const L: usize> DerivativesAbreast<'_, L> {
    /// `N`: number of states, or [`UNKNOWN`]. A sensitivity goes `s(t+dt) = phi s + dphi z`. The first instant is
    /// reached by one step of its own; accelerations come from `A z` and `A s + dA z`, not from differences.
    #[inline(always)]
    fn march<const N: usize>(&self) -> <Self as WithSimd>::Output {
        let (n, masses, at, per_tau) = (known::<N>(self.start.len()), self.masses, self.at, self.tau_s.recip());
        let (asked, of_masses) = (self.asked.waves.asked(), self.asked.masses(masses));
        let mut motions = self.asked.zeros(at.samples, masses);
        let zeros = |motion: &Motion| {
            let waves = [&motion.displacement_m, &motion.velocity_m_per_s, &motion.acceleration_m_per_s2];
            waves.map(|wave| vec![[0.0; L]; wave.len()])
        };
        let mut derivatives: Vec<[Vec<Lanes<L>>; 3]> = motions.iter().map(zeros).collect();
        let (mut z, mut s) = (self.start.to_vec(), self.start_by.to_vec());
        let (mut next_z, mut next_s) = (z.clone(), s.clone());
        if at.first_s > 0.0 {
            let (phi, dphi) = self.exponential::<N>(at.first_s);
            applied::<N, L>(&phi, &dphi, (&z, &s), (&mut next_z, &mut next_s), 0..n);
            (z, s) = (next_z.clone(), next_s.clone());
        }
        let (phi, dphi) = self.exponential::<N>(at.dt_s);
        let (mut rate_z, mut rate_s) = (z.clone(), s.clone());
        let of_rates = masses + of_masses.start..masses + of_masses.end;
        for k in 0..at.samples {
            if asked[2] {
                applied::<N, L>(self.a, self.da, (&z, &s), (&mut rate_z, &mut rate_s), of_rates.clone());
            }
            for mass in of_masses.clone() {
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
            applied::<N, L>(&phi, &dphi, (&z, &s), (&mut next_z, &mut next_s), 0..n);
            std::mem::swap(&mut z, &mut next_z);
            std::mem::swap(&mut s, &mut next_s);
        }
        let of_lane = |lane: usize| {
            let wave = |wave: &Vec<Lanes<L>>| wave.iter().map(|lanes| lanes[lane]).collect();
            let motion = |[x, v, a]: &[Vec<Lanes<L>>; 3]| Motion {
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
    fn exponential<const N: usize>(&self, t_s: f64) -> (Vec<f64>, Vec<Lanes<L>>) {
        let n = known::<N>(self.start.len());
        let t = t_s / self.tau_s;
        let column = |j: usize| (0..n).map(|i| self.a[i * n + j].abs()).sum::<f64>();
        let squarings = squarings_of((0..n).map(column).fold(0.0, f64::max) * t.abs());
        let h = t * 0.5_f64.powi(squarings);
        let x: Vec<f64> = self.a.iter().map(|a| a * h).collect();
        let dx: Vec<Lanes<L>> = self.da.iter().map(|d| scaled(d, h)).collect();
        let mut powers: [(Vec<f64>, Vec<Lanes<L>>); POWERS] = std::array::from_fn(|_| (x.clone(), dx.clone()));
        for k in 1..POWERS {
            let (lower, power) = powers.split_at_mut(k);
            let ((a, da), (b, db)) = (&lower[k / 2], &lower[(k - 1) / 2]);
            multiplied::<N, L>(n, (a, da), (b, db), (&mut power[0].0, &mut power[0].1));
        }
        let (last, dlast) = &powers[POWERS - 1];
        let mut phi: Vec<f64> = last.iter().map(|x| x * INVERSE_FACTORIALS[TERMS]).collect();
        let mut dphi: Vec<Lanes<L>> = dlast.iter().map(|d| scaled(d, INVERSE_FACTORIALS[TERMS])).collect();
        let (mut product, mut dproduct) = (x.clone(), dx.clone());
        for first in (0..TERMS).step_by(POWERS).rev() {
            if first + POWERS < TERMS {
                multiplied::<N, L>(n, (&phi, &dphi), (last, dlast), (&mut product, &mut dproduct));
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
                    for lane in 0..L {
                        dphi[i][lane] += dpower[i][lane] * factor;
                    }
                }
            }
        }
        for _ in 0..squarings {
            multiplied::<N, L>(n, (&phi, &dphi), (&phi, &dphi), (&mut product, &mut dproduct));
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
fn scaled<const L: usize>(lanes: &Lanes<L>, factor: f64) -> Lanes<L> {
    let mut result = *lanes;
    for value in &mut result {
        *value *= factor;
    }
    result
}

/// The product of two square matrices of `n` rows and its derivatives, `d(a b) = da b + a db`.
#[inline(always)]
fn multiplied<const N: usize, const L: usize>(
    n: usize,
    a: (&[f64], &[Lanes<L>]),
    b: (&[f64], &[Lanes<L>]),
    product: (&mut [f64], &mut [Lanes<L>]),
) {
    let n = known::<N>(n);
    let (a, b) = ((&a.0[..n * n], &a.1[..n * n]), (&b.0[..n * n], &b.1[..n * n]));
    let product = (&mut product.0[..n * n], &mut product.1[..n * n]);
    for i in 0..n {
        for j in 0..n {
            let (mut sum, mut by_left, mut by_right) = (0.0, [0.0; L], [0.0; L]);
            for k in 0..n {
                let (left, right) = (a.0[i * n + k], b.0[k * n + j]);
                let (dleft, dright) = (&a.1[i * n + k], &b.1[k * n + j]);
                sum += left * right;
                for lane in 0..L {
                    by_left[lane] += dleft[lane] * right;
                    by_right[lane] += left * dright[lane];
                }
            }
            for lane in 0..L {
                by_left[lane] += by_right[lane];
            }
            product.0[i * n + j] = sum;
            product.1[i * n + j] = by_left;
        }
    }
}

/// Some rows of the product of a matrix with a state, and its derivatives.
#[inline(always)]
fn applied<const N: usize, const L: usize>(
    matrix: &[f64],
    by: &[Lanes<L>],
    (z, s): (&[f64], &[Lanes<L>]),
    (next_z, next_s): (&mut [f64], &mut [Lanes<L>]),
    rows: std::ops::Range<usize>,
) {
    let n = known::<N>(z.len());
    let (matrix, by, z, s) = (&matrix[..n * n], &by[..n * n], &z[..n], &s[..n]);
    for i in rows {
        let (mut sum, mut dsum) = (0.0, [0.0; L]);
        for j in 0..n {
            sum += matrix[i * n + j] * z[j];
            for lane in 0..L {
                dsum[lane] += matrix[i * n + j] * s[j][lane];
            }
        }
        for j in 0..n {
            for lane in 0..L {
                dsum[lane] += by[i * n + j][lane] * z[j];
            }
        }
        (next_z[i], next_s[i]) = (sum, dsum);
    }
}
