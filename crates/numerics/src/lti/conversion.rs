//! Between continuous and sampled models, and between state space and transfer function.

use nalgebra::{DMatrix, DVector};

use crate::linalg::jacobi_svd;
use crate::lti::eigenvalues::check_finite;
use crate::lti::matrix_functions::one_norm;
use crate::lti::model::check_sample_time;
use crate::lti::{Complex, LtiError, StateSpace, TransferFunction, matrix_exponential, matrix_logarithm};

/// Poles nearer to zero than this are delays: there is no continuous counterpart of any order.
const DELAY: f64 = 1e-6;

/// Cosine between a left and a right eigenvector below which the pole counts as multiple: rounding parts a double pole
/// by `sqrt(f64::EPSILON)`, 1.5e-8 of its size, and leaves a cosine of that order.
const DEFECTIVE: f64 = 1e-6;

/// What an input does between its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InputHold {
    /// It keeps the value of the last sample.
    Zero,
    /// It goes straight to the next sample.
    First,
}

/// A continuous model and what had to be done to get it.
#[derive(Debug, Clone, PartialEq)]
pub struct Continuous {
    /// The model. Its state is that of the sampled one only without `conjugated` poles and for a zero-order hold.
    pub model: StateSpace,
    /// Negative real poles `z` that got a conjugate at the Nyquist frequency, one more state each.
    pub conjugated: Vec<f64>,
}

/// The continuous model of which the sampled one is the discretisation with the given hold; `|Im s| <= pi/dt`.
///
/// `A = ln(Ad)/dt`. With `phi(X) = (e^X - I)/X` a zero-order hold has `Bd = phi(A dt) B dt`, a first-order hold, in the
/// form without the next sample, `Bd = phi(A dt)^2 B dt` and `Dd = D + C (phi(A dt) - I)/(A dt) B dt`. `phi` is regular
/// for every pole that a principal logarithm can give, a rigid body (`z = 1`) among them.
///
/// A negative real pole has no real logarithm. As MATLAB's `d2c` does, it gets a conjugate, `s = ln|z|/dt +- i pi/dt`:
/// the outputs at the samples stay the same, the order grows by one, the pole is listed in `conjugated`. Such a pole is
/// an artefact of sampling or of too high an order; nothing in the continuous world is known of it.
///
/// Errors: a pole within 1e-6 of zero (a delay), a multiple negative pole.
pub fn to_continuous(model: &StateSpace, hold: InputHold) -> Result<Continuous, LtiError> {
    let dt_s = model.require_discrete()?;
    let (m, q) = (model.b.ncols(), model.c.nrows());
    let mut rest = model.clone();
    // Modes taken out: pole, row of inputs, column of outputs.
    let mut alone: Vec<(f64, DMatrix<f64>, DMatrix<f64>)> = Vec::new();
    while let Some(z) = rest.poles()?.into_iter().find(|z| z.im == 0.0 && z.re <= DELAY) {
        if z.re.abs() <= DELAY {
            return Err(LtiError::Delay { re: z.re });
        }
        let (remaining, b, c) = split_off(&rest, z.re)?;
        rest = remaining;
        alone.push((z.re, b, c));
    }
    let kept = rest.order();
    let n = kept + 2 * alone.len();
    // A dt, Bd and C with two states for every mode taken out.
    let mut generator = DMatrix::zeros(n, n);
    generator.view_mut((0, 0), (kept, kept)).copy_from(&matrix_logarithm(&rest.a)?);
    let mut b = DMatrix::zeros(n, m);
    b.rows_mut(0, kept).copy_from(&rest.b);
    let mut c = DMatrix::zeros(q, n);
    c.columns_mut(0, kept).copy_from(&rest.c);
    for (index, (z, row, column)) in alone.iter().enumerate() {
        let at = kept + 2 * index;
        let (rate, turn) = (z.abs().ln(), std::f64::consts::PI);
        generator.view_mut((at, at), (2, 2)).copy_from_slice(&[rate, -turn, turn, rate]);
        b.row_mut(at).copy_from(row);
        c.column_mut(at).copy_from(column);
    }
    let (phi, phi_next) = phi_functions(&generator)?;
    let solved = |right: &DMatrix<f64>| {
        phi.clone().lu().solve(right).ok_or(LtiError::Singular { what: "the integral of the matrix exponential" })
    };
    let (b, d) = match hold {
        InputHold::Zero => (solved(&b)?, model.d.clone()),
        InputHold::First => {
            let b = solved(&solved(&b)?)?;
            let d = &model.d - &c * (phi_next * &b);
            (b, d)
        }
    };
    let conjugated = alone.into_iter().map(|(z, ..)| z).collect();
    Ok(Continuous { model: StateSpace::new(generator / dt_s, b / dt_s, c, d, None)?, conjugated })
}

/// `(e^X - I)/X` and `(e^X - I - X)/X²`, from one exponential; no inverse of `X`.
fn phi_functions(x: &DMatrix<f64>) -> Result<(DMatrix<f64>, DMatrix<f64>), LtiError> {
    let n = x.nrows();
    let mut big = DMatrix::zeros(3 * n, 3 * n);
    big.view_mut((0, 0), (n, n)).copy_from(x);
    big.view_mut((0, n), (n, n)).fill_with_identity();
    big.view_mut((n, 2 * n), (n, n)).fill_with_identity();
    let e = matrix_exponential(&big)?;
    Ok((e.view((0, n), (n, n)).into_owned(), e.view((0, 2 * n), (n, n)).into_owned()))
}

/// Takes the mode of a simple real pole out of a model: what is left (one state less), and the mode's input row and
/// output column. The remaining states are orthonormal coordinates of the left eigenvector's complement.
fn split_off(model: &StateSpace, z: f64) -> Result<(StateSpace, DMatrix<f64>, DMatrix<f64>), LtiError> {
    let n = model.order();
    let shifted = &model.a - DMatrix::<f64>::identity(n, n) * z;
    let svd =
        jacobi_svd(&shifted).ok_or(LtiError::NotConverged { what: "the mode of a negative pole", iterations: 60 })?;
    let right: DVector<f64> = svd.right.column(n - 1).into_owned();
    // The left vector of a zero singular value is not given; the right one of the transpose is.
    let svd = jacobi_svd(&shifted.transpose())
        .ok_or(LtiError::NotConverged { what: "the mode of a negative pole", iterations: 60 })?;
    let left: DVector<f64> = svd.right.column(n - 1).into_owned();
    let cosine = left.dot(&right);
    if cosine.abs() < DEFECTIVE {
        return Err(LtiError::NegativeRealEigenvalue { re: z });
    }
    let b = left.transpose() * &model.b;
    let c = &model.c * &right / cosine;
    // Householder reflection that takes the left vector to the first axis; the other axes span its complement.
    let mut normal = left.clone();
    normal[0] += if left[0] >= 0.0 { 1.0 } else { -1.0 };
    let normal = normal.normalize();
    let reflection = DMatrix::<f64>::identity(n, n) - &normal * normal.transpose() * 2.0;
    let basis = reflection.columns(1, n - 1).into_owned();
    let rest_b = &model.b - &right * &b / cosine;
    check_finite("a mode", &rest_b)?;
    let rest = StateSpace::new(
        basis.tr_mul(&(&model.a * &basis)),
        basis.tr_mul(&rest_b),
        &model.c * &basis,
        model.d.clone(),
        model.sample_time_s,
    )?;
    Ok((
        rest,
        DMatrix::from_row_slice(1, b.ncols(), b.as_slice()),
        DMatrix::from_column_slice(c.nrows(), 1, c.as_slice()),
    ))
}

/// A sampled model driven by this sample of the input and the next:
/// `x[k+1] = a x[k] + b_now u[k] + b_next u[k+1]`, `y[k] = c x[k] + d u[k]`.
///
/// The state is that of the continuous model at the samples, unlike in the textbook form that shifts it to get rid
/// of `u[k+1]`; so initial conditions keep their meaning.
#[derive(Debug, Clone, PartialEq)]
pub struct FirstOrderHold {
    /// State matrix.
    pub a: DMatrix<f64>,
    /// Input matrix of the sample at the start of the interval.
    pub b_now: DMatrix<f64>,
    /// Input matrix of the sample at its end.
    pub b_next: DMatrix<f64>,
    /// Output matrix.
    pub c: DMatrix<f64>,
    /// Direct term.
    pub d: DMatrix<f64>,
    /// Sampling interval, s.
    pub sample_time_s: f64,
}

/// Discretises for an input that is linear between samples; exact for such inputs, error O(dt²) for smooth ones.
///
/// `exp([[a, b, 0], [0, 0, I/dt], [0, 0, 0]] dt)` has `[Ad, G1, G2]` as its first block row, and
/// `b_now = G1 - G2`, `b_next = G2`. Source: Van Loan, "Computing integrals involving the matrix exponential", IEEE
/// Trans. Autom. Control 23(3), 1978.
pub fn discretize_first_order_hold(model: &StateSpace, dt_s: f64) -> Result<FirstOrderHold, LtiError> {
    model.require_continuous()?;
    check_sample_time(dt_s)?;
    let (n, m) = model.b.shape();
    let mut big = DMatrix::zeros(n + 2 * m, n + 2 * m);
    big.view_mut((0, 0), (n, n)).copy_from(&(&model.a * dt_s));
    big.view_mut((0, n), (n, m)).copy_from(&(&model.b * dt_s));
    big.view_mut((n, n + m), (m, m)).fill_with_identity();
    let e = matrix_exponential(&big)?;
    let g1 = e.view((0, n), (n, m)).into_owned();
    let g2 = e.view((0, n + m), (n, m)).into_owned();
    Ok(FirstOrderHold {
        a: e.view((0, 0), (n, n)).into_owned(),
        b_now: g1 - &g2,
        b_next: g2,
        c: model.c.clone(),
        d: model.d.clone(),
        sample_time_s: dt_s,
    })
}

impl FirstOrderHold {
    /// The textbook form without the next sample: the state is `x - b_next u`, the direct term grows by `c b_next`.
    /// Same response to every input. Errors: not finite.
    pub fn state_space(&self) -> Result<StateSpace, LtiError> {
        StateSpace::new(
            self.a.clone(),
            &self.b_now + &self.a * &self.b_next,
            self.c.clone(),
            &self.d + &self.c * &self.b_next,
            Some(self.sample_time_s),
        )
    }

    /// Response of a model with one input and one output to `input` from the state `initial`.
    /// Errors: [`LtiError::NotSingle`], [`LtiError::Shape`].
    pub fn response(&self, input: &[f64], initial: &DVector<f64>) -> Result<Vec<f64>, LtiError> {
        if self.b_now.ncols() != 1 || self.c.nrows() != 1 {
            return Err(LtiError::NotSingle { inputs: self.b_now.ncols(), outputs: self.c.nrows() });
        }
        if initial.len() != self.a.nrows() {
            return Err(LtiError::Shape {
                what: "the initial state",
                rows: initial.len(),
                columns: 1,
                expected: format!("{} x 1", self.a.nrows()),
            });
        }
        let mut x = initial.clone();
        let mut output = Vec::with_capacity(input.len());
        for (k, &u) in input.iter().enumerate() {
            output.push((&self.c * &x)[0] + self.d[(0, 0)] * u);
            if let Some(&next) = input.get(k + 1) {
                x = &self.a * x + self.b_now.column(0) * u + self.b_next.column(0) * next;
            }
        }
        Ok(output)
    }
}

/// The sampled model whose response to a zero-order hold is the continuous one's, exactly.
///
/// `exp([[a, b], [0, 0]] dt) = [[Ad, Bd], [0, I]]`; `c` and `d` stay. No inverse of `a`, so a rigid body (pole at
/// zero) is an ordinary case. Source: Van Loan, IEEE Trans. Autom. Control 23(3), 1978.
pub fn discretize_zero_order_hold(model: &StateSpace, dt_s: f64) -> Result<StateSpace, LtiError> {
    model.require_continuous()?;
    check_sample_time(dt_s)?;
    let (n, m) = model.b.shape();
    let a = &model.a * dt_s;
    let b = &model.b * dt_s;
    // The result is linear in b: scaled down to a, it costs no extra squarings.
    let scale = power_of_two_above(one_norm(&b) / one_norm(&a).max(0.1));
    let e = matrix_exponential(&augmented(&a, &(b / scale), 0.0))?;
    StateSpace::new(
        e.view((0, 0), (n, n)).into_owned(),
        e.view((0, n), (n, m)).into_owned() * scale,
        model.c.clone(),
        model.d.clone(),
        Some(dt_s),
    )
}

/// The continuous model of which the sampled one is the zero-order-hold discretisation.
///
/// `ln [[Ad, Bd], [0, I]] / dt = [[a, b], [0, 0]]`. Unlike `b = a (Ad - I)⁻¹ Bd` it survives a pole at `z = 1`.
/// Of the many continuous models that share the samples it is the one with `|Im s| < pi/dt`.
///
/// Errors: a real pole `z <= 0` has no continuous counterpart ([`LtiError::NegativeRealEigenvalue`]).
pub fn undo_zero_order_hold(model: &StateSpace) -> Result<StateSpace, LtiError> {
    let dt_s = model.require_discrete()?;
    let (n, m) = model.b.shape();
    // Linear in b again; a small block keeps the matrix as near to the identity as Ad itself.
    let scale = power_of_two_above(one_norm(&model.b) * 8.0);
    let log = matrix_logarithm(&augmented(&model.a, &(&model.b / scale), 1.0))?;
    StateSpace::new(
        log.view((0, 0), (n, n)).into_owned() / dt_s,
        log.view((0, n), (n, m)).into_owned() * (scale / dt_s),
        model.c.clone(),
        model.d.clone(),
        None,
    )
}

/// `[[a, b], [0, corner·I]]`.
fn augmented(a: &DMatrix<f64>, b: &DMatrix<f64>, corner: f64) -> DMatrix<f64> {
    let (n, m) = b.shape();
    let mut result = DMatrix::zeros(n + m, n + m);
    result.view_mut((0, 0), (n, n)).copy_from(a);
    result.view_mut((0, n), (n, m)).copy_from(b);
    result.view_mut((n, n), (m, m)).fill_with_identity();
    result.view_mut((n, n), (m, m)).scale_mut(corner);
    result
}

/// A power of two at or above `x`, so that scaling by it does not round; 1 for anything below 1.
fn power_of_two_above(x: f64) -> f64 {
    if x.is_finite() && x > 1.0 { x.log2().ceil().exp2() } else { 1.0 }
}

/// The transfer function of a continuous model with one input and one output.
///
/// Time is scaled by the largest pole first, so that coefficients of `s^4 ... s^0` do not differ by powers of 1e3. The
/// denominator is the product over the poles; the numerator follows from the adjugate by the Faddeev-LeVerrier
/// recursion `M[k+1] = A M[k] + c[k] I`, `n[k] = C M[k] B + D c[k]`. Accurate to about 1e-10 up to ten states (checked
/// at eight); the coefficients themselves lose their meaning as the order grows, not this computation alone.
/// Nothing is cancelled: an unobservable pole stays.
///
/// Errors: discrete model, several channels, coefficients beyond the range of `f64`.
pub fn to_transfer_function(model: &StateSpace) -> Result<TransferFunction, LtiError> {
    model.require_continuous()?;
    model.require_single()?;
    let n = model.order();
    let poles = model.poles()?;
    let fastest = poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
    // A nilpotent matrix (rigid bodies only) has no fastest pole; its norm is a rate too.
    let rate = [fastest, one_norm(&model.a), 1.0].into_iter().find(|&r| r > 0.0).unwrap_or(1.0);

    let mut denominator = vec![Complex::new(1.0, 0.0)];
    for pole in poles {
        let pole = pole / rate;
        denominator.push(Complex::new(0.0, 0.0));
        for k in (1..denominator.len()).rev() {
            let previous = denominator[k - 1];
            denominator[k] -= previous * pole;
        }
    }
    // Poles come in exact conjugate pairs: what imaginary part is left is rounding.
    let denominator: Vec<f64> = denominator.iter().map(|c| c.re).collect();

    let a = &model.a / rate;
    let d = model.d[(0, 0)];
    let mut adjugate = DMatrix::<f64>::identity(n, n);
    let mut numerator = vec![d];
    for c in &denominator[1..] {
        numerator.push((&model.c * &adjugate * &model.b)[(0, 0)] / rate + d * c);
        adjugate = &a * adjugate + DMatrix::<f64>::identity(n, n) * *c;
    }
    let unscaled = |p: Vec<f64>| {
        let powers = std::iter::successors(Some(1.0), |power| Some(power * rate));
        p.iter().zip(powers).map(|(c, power)| c * power).collect::<Vec<f64>>()
    };
    TransferFunction::new(&unscaled(numerator), &unscaled(denominator))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use nalgebra::dmatrix;

    use crate::lti::{discretize_first_order_hold, discretize_zero_order_hold, impulse_response, undo_zero_order_hold};

    fn sampled(a: DMatrix<f64>) -> StateSpace {
        let n = a.nrows();
        let b = DMatrix::from_fn(n, 1, |i, _| 1.0 - 0.3 * i as f64);
        let c = DMatrix::from_fn(1, n, |_, i| 0.5 + 0.4 * i as f64);
        StateSpace::new(a, b, c, dmatrix![0.2], Some(0.01)).unwrap()
    }

    #[test]
    fn without_negative_poles_it_is_the_logarithm_of_the_whole() {
        let model = sampled(dmatrix![0.9, 0.3, 0.0; -0.3, 0.9, 0.1; 0.0, 0.0, 1.0]);
        let continuous = to_continuous(&model, InputHold::Zero).unwrap();
        let whole = undo_zero_order_hold(&model).unwrap();
        assert!(continuous.conjugated.is_empty());
        // Two ways to the same: rounding of the logarithm over dt.
        assert!((&continuous.model.a - &whole.a).norm() < 1e-12 * whole.a.norm());
        assert!((&continuous.model.b - &whole.b).norm() < 1e-12 * whole.b.norm());
    }

    #[test]
    fn negative_poles_get_a_conjugate_and_the_samples_stay() {
        let a = dmatrix![0.9, 0.3, 0.0, 0.2; -0.3, 0.9, 0.1, 0.0; 0.1, 0.0, -0.5, 0.3; 0.0, 0.0, 0.0, -0.2];
        let model = sampled(a);
        let expected = impulse_response(&model, 40).unwrap();
        let continuous = to_continuous(&model, InputHold::Zero).unwrap();
        assert_eq!((continuous.model.order(), continuous.conjugated.len()), (6, 2));
        let again = impulse_response(&discretize_zero_order_hold(&continuous.model, 0.01).unwrap(), 40).unwrap();
        for (x, y) in expected.iter().zip(&again) {
            // Rounding of a logarithm and an exponential of norm 4.
            assert!((x - y).abs() < 1e-12, "{x} {y}");
        }
        let nyquist = std::f64::consts::PI / 0.01;
        let poles = continuous.model.poles().unwrap();
        assert_eq!(poles.iter().filter(|s| (s.im.abs() - nyquist).abs() < 1e-9 * nyquist).count(), 4);
        let held = to_continuous(&model, InputHold::First).unwrap();
        let again = discretize_first_order_hold(&held.model, 0.01).unwrap().state_space().unwrap();
        for (x, y) in expected.iter().zip(&impulse_response(&again, 40).unwrap()) {
            assert!((x - y).abs() < 1e-12, "{x} {y}");
        }
    }

    #[test]
    fn a_delay_and_a_double_negative_pole_are_refused() {
        let delay = sampled(dmatrix![0.0, 1.0; 0.0, 0.0]);
        assert!(matches!(to_continuous(&delay, InputHold::Zero), Err(LtiError::Delay { .. })));
        // As a triangle, where its eigenvalues are exact, and in other coordinates, where rounding parts them.
        let double = dmatrix![-0.5, 1.0; 0.0, -0.5];
        let to = dmatrix![1.3, 0.4; -0.7, 0.9];
        let turned = &to * &double * to.clone().try_inverse().unwrap();
        for a in [double, turned] {
            let continuous = to_continuous(&sampled(a), InputHold::Zero);
            assert!(matches!(continuous, Err(LtiError::NegativeRealEigenvalue { .. })), "{continuous:?}");
        }
    }

    #[test]
    fn ramp_through_a_lag_is_exact_at_every_sample() {
        let lag = StateSpace::new(dmatrix![-5.0], dmatrix![5.0], dmatrix![1.0], dmatrix![0.0], None).unwrap();
        let dt = 0.1;
        let input: Vec<f64> = (0..30).map(|k| 2.0 + 3.0 * f64::from(k) * dt).collect();
        let output =
            discretize_first_order_hold(&lag, dt).unwrap().response(&input, &DVector::from_element(1, 1.0)).unwrap();
        for (k, y) in output.iter().enumerate() {
            let t = k as f64 * dt;
            // y' = -5 y + 5 (2 + 3 t), y(0) = 1: y = 2 + 3 t - 3/5 + (1 - 7/5) e^{-5t}
            let exact = 1.4 + 3.0 * t - 0.4 * (-5.0 * t).exp();
            // 30 steps of a contracting recursion: a few roundings.
            assert!((y - exact).abs() < 1e-14, "sample {k}: {y} against {exact}");
        }
    }

    #[test]
    fn double_integrator_of_a_ramp_is_the_cubic() {
        let mass =
            StateSpace::new(dmatrix![0.0, 1.0; 0.0, 0.0], dmatrix![0.0; 1.0], dmatrix![1.0, 0.0], dmatrix![0.0], None)
                .unwrap();
        let input: Vec<f64> = (0..11).map(f64::from).collect();
        let output = discretize_first_order_hold(&mass, 1.0).unwrap().response(&input, &DVector::zeros(2)).unwrap();
        // t^3/6 at t = 10, rounding of ten steps.
        assert!((output[10] - 1000.0 / 6.0).abs() < 1e-11);
    }

    fn mass_spring_damper(m: f64, c: f64, k: f64) -> StateSpace {
        StateSpace::new(
            dmatrix![0.0, 1.0; -k / m, -c / m],
            dmatrix![0.0; 1.0 / m],
            dmatrix![1.0, 0.0],
            dmatrix![0.0],
            None,
        )
        .unwrap()
    }

    #[test]
    fn free_mass_under_constant_force_follows_the_parabola() {
        let d = discretize_zero_order_hold(&mass_spring_damper(2.0, 0.0, 0.0), 0.5).unwrap();
        // x = F t^2 / 2m, v = F t / m: exact in f64 up to one rounding.
        assert!((&d.a - dmatrix![1.0, 0.5; 0.0, 1.0]).norm() < 1e-15);
        assert!((&d.b - dmatrix![0.0625; 0.25]).norm() < 1e-15);
    }

    #[test]
    fn rigid_body_comes_back_where_the_inverse_formula_divides_by_zero() {
        let continuous = mass_spring_damper(873.0, 0.0, 0.0);
        let back = undo_zero_order_hold(&discretize_zero_order_hold(&continuous, 1e-4).unwrap()).unwrap();
        // Rounding unit over dt: 2e-12 absolute in a, relative to its entry 1.
        assert!((&back.a - &continuous.a).norm() < 1e-11, "{}", back.a);
        assert!((&back.b - &continuous.b).norm() < 1e-11 * continuous.b.norm(), "{}", back.b);
    }

    #[test]
    fn alternating_pole_has_no_continuous_counterpart() {
        let unit = dmatrix![1.0];
        let model = StateSpace::new(dmatrix![-0.5], unit.clone(), unit.clone(), unit, Some(1e-3)).unwrap();
        assert_eq!(undo_zero_order_hold(&model), Err(LtiError::NegativeRealEigenvalue { re: -0.5 }));
    }

    proptest! {
        #[test]
        fn round_trip_is_the_identity(
            frequency in 1.0..3000.0_f64, damping in 0.0..0.99_f64, mass in 1.0..2000.0_f64, gain in 1e-6..1e6_f64,
        ) {
            let dt = 1e-4;
            let mut model = mass_spring_damper(mass, 2.0 * damping * frequency * mass, frequency * frequency * mass);
            model.b *= gain;
            let back = undo_zero_order_hold(&discretize_zero_order_hold(&model, dt).unwrap()).unwrap();
            // Scaled to its natural frequency a has entries of 1, and Ad those of exp(a w dt). The logarithm divides
            // their rounding by w dt, and once more in the entries that differ from the identity by (w dt)^2 only;
            // 1e-13 is 450 roundings: room for the squarings and roots of a 3 x 3 matrix.
            let scale = dmatrix![frequency, 1.0; frequency * frequency, frequency];
            let worst = (&back.a - &model.a).component_div(&scale).amax() / frequency;
            prop_assert!(worst < 1e-13 / (frequency * dt) / (frequency * dt).min(1.0), "{worst:e}");
            // b moves by the same (w dt)^-2 times a few roundings, 1e-4 rad at the slowest: 1e8 * 1e-15.
            prop_assert!((&back.b - &model.b).norm() <= 1e-7 * model.b.norm());
        }
    }

    #[test]
    fn kelvin_model_gives_its_textbook_coefficients() {
        let (m, c, k) = (873.0, 10_000.0, 321_535.0);
        let model = StateSpace::new(
            dmatrix![0.0, 1.0; -k / m, -c / m],
            dmatrix![0.0; 1.0 / m],
            dmatrix![1.0, 0.0],
            dmatrix![0.0],
            None,
        )
        .unwrap();
        let tf = to_transfer_function(&model).unwrap();
        // 1/(m s^2 + c s + k); the s^1 coefficient of the numerator cancels exactly.
        assert_eq!(tf.numerator().len(), 1);
        // Two poles and their product, each a few roundings of an eigenvalue of a two by two matrix: 45 are allowed.
        for (found, exact) in tf.numerator().iter().chain(tf.denominator()).zip([1.0 / m, 1.0, c / m, k / m]) {
            assert!((found / exact - 1.0).abs() < 1e-14, "{found} against {exact}");
        }
    }

    #[test]
    fn double_integrator_is_one_over_s_squared() {
        let model =
            StateSpace::new(dmatrix![0.0, 1.0; 0.0, 0.0], dmatrix![0.0; 3.0], dmatrix![1.0, 0.0], dmatrix![0.0], None)
                .unwrap();
        let tf = to_transfer_function(&model).unwrap();
        assert_eq!((tf.numerator(), tf.denominator()), (&[3.0][..], &[1.0, 0.0, 0.0][..]));
    }

    proptest! {
        #[test]
        fn answers_as_the_resolvent_does(
            entries in prop::collection::vec(-1.0..1.0_f64, 81),
            frequency in 0.1..3.0_f64,
        ) {
            let n = 8;
            let speed = 500.0;
            let a = (DMatrix::from_column_slice(n, n, &entries[..64]) - DMatrix::identity(n, n) * 3.0) * speed;
            let b = DMatrix::from_column_slice(n, 1, &entries[64..72]);
            let c = DMatrix::from_column_slice(1, n, &entries[72..80]);
            let d = dmatrix![entries[80]];
            let model = StateSpace::new(a.clone(), b.clone(), c.clone(), d.clone(), None).unwrap();
            let tf = to_transfer_function(&model).unwrap();
            let s = Complex::new(0.0, frequency * speed);
            let complex = |m: &DMatrix<f64>| m.map(|x| Complex::new(x, 0.0));
            let resolvent = (DMatrix::identity(n, n) * s - complex(&a)).lu().solve(&complex(&b)).unwrap();
            let exact = (complex(&c) * resolvent)[(0, 0)] + d[(0, 0)];
            // Eight states, coefficients up to binomials times 3^8: five digits of the sixteen may go.
            prop_assert!((tf.at(s) - exact).norm() < 1e-10 * (1.0 + exact.norm()), "{} {exact}", tf.at(s));
        }
    }
}
