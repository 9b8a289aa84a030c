//! A linear system under a drive: exact steps, exact heat, exact work.
//!
//! A chain, a Maxwell model or any other linear system `z' = A z` gets four more states: position and velocity of the
//! barrier, the input `u` of the drive and its slope. Between samples the drive is a straight line, so `u' = slope` and
//! `slope' = 0` make the whole a free system with one matrix exponential for a step. Heat and work are integrals of
//! quadratic forms of the state and come from a block exponential of twice the size: Van Loan, "Computing integrals
//! involving the matrix exponential", IEEE Trans. Automatic Control 23(3), 1978.

use crumple_numerics::lti::matrix_exponential;
use nalgebra::{DMatrix, DVector};

use crate::exact::linear_system::{LinearElement, LinearSystem};
use crate::structure::form::Form;
use crate::{Drive, LumpedError};

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
