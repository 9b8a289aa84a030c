//! Modes of an identified model: how much the data support each, how alike their shapes are, how sure their
//! frequencies.

use std::f64::consts::PI;

use crumple_numerics::lti::{Complex, Mode, StateSpace, TransferFunction, eigenvectors};
use nalgebra::{DMatrix, DVector};

/// A pole of an identified model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IdentifiedMode {
    /// Pole in the z-plane.
    pub discrete_pole: Complex,
    /// The same in continuous time, on the principal branch; `None` for `z = 0`.
    pub mode: Option<Mode>,
    /// Modal amplitude coherence: cosine between the mode's history in the data and the pure one of its pole. 1: the
    /// data contain this mode; well below 0.9: a product of noise. `None` if the model has multiple poles.
    pub modal_amplitude_coherence: Option<f64>,
    /// Mode singular value relative to the largest: the mode's share in the response. `None` as above.
    pub mode_singular_value: Option<f64>,
}

/// Modes of a discrete model in the order of `poles`, and their shapes: what every output shows of a mode, scaled and
/// turned so that the largest entry is 1.
///
/// `controllability` is `S^1/2 V'`: the identified sequence `[B, A B, A² B, ...]` that the model's own is compared
/// with. `terms` is the number of samples the sum in the mode singular value runs over.
///
/// With `b_i`, `c_i` the modal input and output: coherence `|q* q'| / (|q| |q'|)`, `q = [b_i, z_i b_i, z_i² b_i,
/// ...]`, `q'` the same row taken from the data; mode singular value `sqrt(|c_i| (1 + |z_i| + |z_i|² + ...) |b_i|)`.
/// Juang & Pappa, J. Guidance 8(5), 1985, and 9(3), 1986.
pub(crate) fn modes(
    model: &StateSpace,
    poles: &[Complex],
    dt_s: f64,
    controllability: &DMatrix<f64>,
    terms: usize,
) -> (Vec<IdentifiedMode>, Vec<Option<Vec<Complex>>>) {
    let none = || ModalEvidence { coherence: None, strength: None, shape: None };
    let evidence =
        modal_evidence(model, poles, controllability, terms).unwrap_or_else(|| poles.iter().map(|_| none()).collect());
    let largest = evidence.iter().filter_map(|mode| mode.strength).fold(0.0, f64::max);
    let identified = poles.iter().zip(&evidence).map(|(&z, evidence)| IdentifiedMode {
        discrete_pole: z,
        mode: Mode::discrete(z, dt_s),
        modal_amplitude_coherence: evidence.coherence,
        mode_singular_value: evidence.strength.map(|s| s / largest).filter(|s| s.is_finite()),
    });
    (identified.collect(), evidence.iter().map(|mode| mode.shape.clone()).collect())
}

/// What the data say of one mode.
struct ModalEvidence {
    coherence: Option<f64>,
    /// Mode singular value, not yet relative to the largest.
    strength: Option<f64>,
    shape: Option<Vec<Complex>>,
}

/// One entry a pole; `None` if the eigenvectors do not span the state space.
fn modal_evidence(
    model: &StateSpace,
    poles: &[Complex],
    controllability: &DMatrix<f64>,
    terms: usize,
) -> Option<Vec<ModalEvidence>> {
    let complex = |m: &DMatrix<f64>| m.map(|x| Complex::new(x, 0.0));
    let vectors = eigenvectors(&model.a, poles)?;
    let inverse = vectors.clone().try_inverse()?;
    if inverse.iter().any(|x| !x.re.is_finite() || !x.im.is_finite()) {
        return None;
    }
    let b = &inverse * complex(&model.b);
    let c = complex(&model.c) * &vectors;
    let identified = &inverse * complex(controllability);
    let inputs = b.ncols();
    let evidence = poles.iter().enumerate().map(|(i, &z)| {
        let mut pure: Vec<Complex> = b.row(i).iter().copied().collect();
        let (mut inner, mut pure_square, mut data_square) = (Complex::new(0.0, 0.0), 0.0, 0.0);
        for (j, data) in identified.row(i).iter().enumerate() {
            let pure = &mut pure[j % inputs];
            inner += pure.conj() * data;
            pure_square += pure.norm_sqr();
            data_square += data.norm_sqr();
            *pure *= z;
        }
        let coherence = inner.norm() / (pure_square * data_square).sqrt();
        let modulus = z.norm();
        let sum: f64 = std::iter::successors(Some(1.0), |power| Some(power * modulus)).take(terms).sum();
        let strength = (c.column(i).norm() * sum * b.row(i).norm()).sqrt();
        ModalEvidence {
            // Rounding may carry it past 1.
            coherence: coherence.is_finite().then_some(coherence.min(1.0)),
            strength: strength.is_finite().then_some(strength),
            shape: normalized(c.column(i).iter().copied().collect()),
        }
    });
    Some(evidence.collect())
}

/// Shape of every pole of a discrete model, scaled and turned so that the largest entry is 1: what each output shows of
/// the mode. `None` for a pole that no output shows, and for all where eigenvectors do not span the state space.
pub fn mode_shapes(model: &StateSpace, poles: &[Complex]) -> Vec<Option<Vec<Complex>>> {
    match eigenvectors(&model.a, poles) {
        Some(vectors) => {
            let seen = model.c.map(|x| Complex::new(x, 0.0)) * vectors;
            seen.column_iter().map(|column| normalized(column.iter().copied().collect())).collect()
        }
        None => vec![None; poles.len()],
    }
}

/// Divides by the entry of largest modulus (the first such entry on a tie); `None` for a mode that no output shows.
pub(crate) fn normalized(mut shape: Vec<Complex>) -> Option<Vec<Complex>> {
    let largest = shape.iter().fold(Complex::new(0.0, 0.0), |m, x| if x.norm() > m.norm() { *x } else { m });
    for entry in &mut shape {
        *entry /= largest;
    }
    shape.iter().all(|x| x.re.is_finite() && x.im.is_finite()).then_some(shape)
}

// Standard deviations of roots, modes and frequency responses from those of coefficients.
//
// First-order (delta method) propagation: with gradient `g` of a quantity by the coefficients and their covariance
// `P`, its variance is `g' P g`. Right where the coefficients' errors are small against the curvature of the
// quantity; near a multiple root it is not, and nothing is returned there.

/// Standard deviations of real and imaginary parts of the roots of a polynomial, coefficients highest power first with
/// `covariance`, at first order: `dz/dp_j = -z^(n-j)/P'(z)`. `None` at a multiple root, which moves with the root of
/// a change, and where the covariance is not finite.
pub(crate) fn root_deviations(
    polynomial: &[f64],
    covariance: &DMatrix<f64>,
    roots: &[Complex],
) -> Vec<Option<(f64, f64)>> {
    roots
        .iter()
        .map(|z| {
            let gradient = root_gradient(polynomial, *z)?;
            let deviation = |part: &dyn Fn(&Complex) -> f64| {
                let g = DVector::from_iterator(gradient.len(), gradient.iter().map(part));
                finite(g.dot(&(covariance * &g)).max(0.0).sqrt())
            };
            Some((deviation(&|g| g.re)?, deviation(&|g| g.im)?))
        })
        .collect()
}

/// `dz/dp_j = -z^(n-j)/P'(z)` for `j = 0 ..= n`, the coefficients highest power first; `None` where the derivative
/// `P'` vanishes to ten digits, at a multiple root.
pub(crate) fn root_gradient(polynomial: &[f64], z: Complex) -> Option<Vec<Complex>> {
    let n = polynomial.len().checked_sub(1)?;
    // Terms j z^(j-1) p of the derivative, and the sum of their sizes against which it may vanish.
    let mut slope = Complex::new(0.0, 0.0);
    let mut size = 0.0;
    for (index, p) in polynomial[..n].iter().enumerate() {
        let power = n - index;
        let term = z.powu(u32::try_from(power - 1).ok()?) * (power as f64 * p);
        slope += term;
        size += term.norm();
    }
    if slope.norm() <= 1e-10 * size {
        return None;
    }
    (0..=n).map(|index| Some(-z.powu(u32::try_from(n - index).ok()?) / slope)).collect()
}

/// Standard deviations of natural frequency (rad/s) and damping ratio of the continuous counterparts of the roots of
/// `z^n + a_1 z^(n-1) + ... + a_n`, with the covariance of `a`; `None` as above and for a root at zero.
pub(crate) fn discrete_mode_deviations(
    a: &[f64],
    covariance: &DMatrix<f64>,
    roots: &[Complex],
    dt_s: f64,
) -> Vec<Option<(f64, f64)>> {
    let polynomial: Vec<f64> = std::iter::once(1.0).chain(a.iter().copied()).collect();
    roots
        .iter()
        .map(|z| {
            if z.norm() == 0.0 {
                return None;
            }
            let s = z.ln() / dt_s;
            let modulus = s.norm();
            let gradient = root_gradient(&polynomial, *z)?;
            // ds = dz/(z dt); d|s| = Re(conj(s) ds)/|s|; dzeta = -(Re ds)/|s| + Re(s) d|s|/|s|².
            let change: Vec<Complex> = gradient[1..].iter().map(|dz| dz / (z * dt_s)).collect();
            let frequency: Vec<f64> = change.iter().map(|ds| (s.conj() * ds).re / modulus).collect();
            let damping: Vec<f64> = change
                .iter()
                .zip(&frequency)
                .map(|(ds, dw)| -ds.re / modulus + s.re * dw / (modulus * modulus))
                .collect();
            let deviation = |g: Vec<f64>| {
                let g = DVector::from_vec(g);
                finite(g.dot(&(covariance * &g)).max(0.0).sqrt())
            };
            Some((deviation(frequency)?, deviation(damping)?))
        })
        .collect()
}

/// Relative standard deviation of the modulus and standard deviation of the phase (rad) of a transfer function at
/// frequencies in rad/s, with the covariance of its coefficients: numerator as long as `numerator_length` says, then
/// the denominator without its 1, both highest power first. `None` where the response vanishes.
///
/// By `d ln H = dB/B - dA/A`: its real part is the relative change of the modulus, its imaginary part that of the
/// phase.
pub fn response_deviations(
    tf: &TransferFunction,
    numerator_length: usize,
    covariance: &DMatrix<f64>,
    rad_per_s: &[f64],
) -> Vec<Option<(f64, f64)>> {
    let n = tf.denominator().len() - 1;
    let value = |p: &[f64], s: Complex| p.iter().fold(Complex::new(0.0, 0.0), |sum, c| sum * s + *c);
    rad_per_s
        .iter()
        .map(|w| {
            let s = Complex::new(0.0, *w);
            let (b, a) = (value(tf.numerator(), s), value(tf.denominator(), s));
            // d ln H = db/B - da/A.
            let power = |k: usize| s.powu(u32::try_from(k).unwrap_or(u32::MAX));
            let mut gradient: Vec<Complex> = (0..numerator_length).rev().map(|k| power(k) / b).collect();
            gradient.extend((0..n).rev().map(|k| -power(k) / a));
            let deviation = |part: &dyn Fn(&Complex) -> f64| {
                let g = DVector::from_iterator(gradient.len(), gradient.iter().map(part));
                finite(g.dot(&(covariance * &g)).max(0.0).sqrt())
            };
            Some((deviation(&|g| g.re)?, deviation(&|g| g.im)?))
        })
        .collect()
}

/// `None` for what is not a finite number.
fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

// Measures of mode shapes: assurance criterion and phase collinearity.

/// Modal assurance criterion `|p* q|² / (p* p  q* q)` of two shapes: 1 for the same up to a factor, 0 for orthogonal
/// ones. `None` for shapes of different lengths, or one that is zero.
///
/// Two shapes of two sensors are easily alike: it says little with fewer than four sensors. Allemang & Brown, IMAC
/// 1982.
pub fn modal_assurance(p: &[Complex], q: &[Complex]) -> Option<f64> {
    let inner: Complex = p.iter().zip(q).map(|(p, q)| p.conj() * q).sum();
    let square = |shape: &[Complex]| shape.iter().map(Complex::norm_sqr).sum::<f64>();
    let mac = inner.norm_sqr() / (square(p) * square(q));
    // Rounding may carry it past 1.
    (p.len() == q.len() && mac.is_finite()).then_some(mac.min(1.0))
}

/// Modal phase collinearity `((Sxx - Syy)² + 4 Sxy²) / (Sxx + Syy)²` with `Sxx`, `Syy`, `Sxy` the sums of squares and
/// products of real and imaginary parts: 1 if all sensors move in phase or against it, as in a lightly damped
/// structure, 0 for phases spread all round, as noise has them. `None` for a shape of zeros.
///
/// Not centred, for a shape through rest has no mean. One sensor alone always has 1. Pappa, Elliott & Schenk, J.
/// Guidance 16(5), 1993.
pub fn phase_collinearity(shape: &[Complex]) -> Option<f64> {
    let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
    for z in shape {
        xx += z.re * z.re;
        yy += z.im * z.im;
        xy += z.re * z.im;
    }
    let mpc = ((xx - yy).powi(2) + 4.0 * xy * xy) / (xx + yy).powi(2);
    mpc.is_finite().then_some(mpc.min(1.0))
}

// Which poles of an identified model are modes of the record, and which are not.

/// A pole within this of zero, times the length of the record, is an integrator: over the record a motion as slow is a
/// constant or a straight line.
const INTEGRATOR: f64 = 0.1;

/// The same of two poles or more that lead from an acceleration to a displacement, where a double integrator is true:
/// noise parts a double pole by the root of what it does to a single one.
const INTEGRATOR_OF_MOTION: f64 = 0.5;

/// What a pole of an identified model is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PoleKind {
    /// A damped oscillation.
    Mode,
    /// It decays without oscillating.
    Real,
    /// It grows.
    Growing,
    /// At or near zero: a constant or a straight line over the record, as an integrator makes.
    Integrator,
    /// As fast as the sampling or faster, a modulus of `pi/dt` or more: between two samples nobody sees it.
    BeyondNyquist,
    /// A zero cancels it: a model without it fits as well.
    Cancelled,
    /// The line of a machine that runs.
    Harmonic,
}

impl PoleKind {
    /// Whether it is a motion of the record: it stands among the modes.
    pub fn is_motion(self) -> bool {
        matches!(self, Self::Mode | Self::Real | Self::Growing)
    }
}

/// The record that a model was identified from, as far as its poles are concerned.
#[derive(Debug, Clone, Copy)]
pub struct PoleRecord {
    /// Sampling interval, s.
    pub dt_s: f64,
    /// Length, s.
    pub duration_s: f64,
    /// Whether the model leads from an acceleration to a displacement.
    pub of_motion: bool,
    /// Decay rate of the exponential window that the record was multiplied with, 1/s; 0: there was none.
    pub window_per_s: f64,
}

/// What each continuous pole (1/s, rad/s) of one model is, in their order.
pub fn pole_kinds(poles: &[Complex], record: PoleRecord) -> Vec<PoleKind> {
    let PoleRecord { dt_s, duration_s, of_motion, .. } = record;
    let within = |limit: f64| move |s: &&Complex| s.norm() * duration_s < limit;
    let is_double = of_motion && poles.iter().filter(within(INTEGRATOR_OF_MOTION)).count() > 1;
    let near_zero = within(if is_double { INTEGRATOR_OF_MOTION } else { INTEGRATOR });
    let kind = |s: &Complex| match s {
        // Rounding of pi/dt is no reason to be within the sampling.
        s if s.norm() * dt_s >= PI * (1.0 - 1e-9) => PoleKind::BeyondNyquist,
        s if near_zero(&s) => PoleKind::Integrator,
        s if s.re > 0.0 => PoleKind::Growing,
        s if s.im == 0.0 => PoleKind::Real,
        _ => PoleKind::Mode,
    };
    poles.iter().map(kind).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_numerics::lti::{Mode, polynomial_roots};

    #[test]
    fn deviations_of_roots_and_modes_are_those_of_finite_differences() {
        let a = [-1.6, 0.9, -0.1];
        let covariance = nalgebra::dmatrix![4e-6, 1e-6, 0.0; 1e-6, 9e-6, -2e-6; 0.0, -2e-6, 1e-6];
        let roots = polynomial_roots(&[1.0, a[0], a[1], a[2]]).unwrap();
        let estimated = discrete_mode_deviations(&a, &covariance, &roots, 1e-3);
        let mut full = DMatrix::zeros(4, 4);
        full.view_mut((1, 1), (3, 3)).copy_from(&covariance);
        let parts = root_deviations(&[1.0, a[0], a[1], a[2]], &full, &roots);
        for (k, z) in roots.iter().enumerate() {
            let mut gradients = DMatrix::zeros(4, 3);
            for i in 0..3 {
                let h = 1e-6;
                let at = |sign: f64| {
                    let mut p = [1.0, a[0], a[1], a[2]];
                    p[i + 1] += sign * h;
                    let roots = polynomial_roots(&p).unwrap();
                    let near = *roots.iter().min_by(|x, y| (*x - z).norm().total_cmp(&(*y - z).norm())).unwrap();
                    let mode = Mode::discrete(near, 1e-3).unwrap();
                    [near.re, near.im, mode.natural_frequency_rad_per_s, mode.damping_ratio.unwrap()]
                };
                let (up, down) = (at(1.0), at(-1.0));
                for j in 0..4 {
                    gradients[(j, i)] = (up[j] - down[j]) / (2.0 * h);
                }
            }
            let exact = &gradients * &covariance * gradients.transpose();
            let (re, im) = parts[k].unwrap();
            let (w, zeta) = estimated[k].unwrap();
            for (estimated, exact) in
                [(re, exact[(0, 0)]), (im, exact[(1, 1)]), (w, exact[(2, 2)]), (zeta, exact[(3, 3)])]
            {
                // Central differences of roots known to 1e-15 with a step of 1e-6: 1e-9, over a gradient of order one.
                let exact = exact.sqrt();
                assert!((estimated - exact).abs() < 1e-6 * exact + 1e-9, "{z}: {estimated} {exact}");
            }
        }
        // A double root has no first-order deviation.
        let double = root_deviations(&[1.0, -2.0, 1.0], &DMatrix::identity(3, 3), &[Complex::new(1.0, 0.0)]);
        assert_eq!(double, [None]);
    }

    #[test]
    fn deviation_of_a_response_by_hand() {
        // H = b/(s + a): d ln|H| = db/b - a da/(a² + w²), d arg H = w da/(a² + w²).
        let tf = TransferFunction::new(&[3.0], &[1.0, 4.0]).unwrap();
        let covariance = nalgebra::dmatrix![0.09, 0.0; 0.0, 0.25];
        let (magnitude, phase) = response_deviations(&tf, 1, &covariance, &[3.0])[0].unwrap();
        assert!((magnitude - (0.01_f64 + (4.0 * 0.5 / 25.0_f64).powi(2)).sqrt()).abs() < 1e-14, "{magnitude}");
        assert!((phase - 3.0 * 0.5 / 25.0).abs() < 1e-14, "{phase}");
    }

    const I: Complex = Complex::new(0.0, 1.0);

    #[test]
    fn a_turned_and_scaled_shape_is_the_same() {
        let p = [Complex::from(1.0), Complex::from(-0.5), Complex::from(0.25)];
        let q: Vec<Complex> = p.iter().map(|x| x * Complex::new(0.3, -2.0)).collect();
        // Rounding.
        assert!((modal_assurance(&p, &q).unwrap() - 1.0).abs() < 1e-15);
        assert!((phase_collinearity(&q).unwrap() - 1.0).abs() < 1e-15);
        assert!(modal_assurance(&p[..2], &[Complex::from(1.0), Complex::from(2.0)]).unwrap() < 1e-30);
        assert_eq!(modal_assurance(&p, &p[..2]), None);
    }

    #[test]
    fn phases_all_round_are_not_collinear() {
        assert_eq!(phase_collinearity(&[Complex::from(1.0), I, Complex::from(-1.0), -I]), Some(0.0));
        assert_eq!(phase_collinearity(&[Complex::from(0.0)]), None);
    }

    fn kinds(poles: &[(f64, f64)], of_motion: bool) -> Vec<PoleKind> {
        let poles: Vec<Complex> = poles.iter().map(|(re, im)| Complex::new(*re, *im)).collect();
        pole_kinds(&poles, PoleRecord { dt_s: 0.01, duration_s: 2.0, of_motion, window_per_s: 0.0 })
    }

    #[test]
    fn poles_near_zero_are_integrators_of_motion_further_away() {
        use PoleKind::{Growing, Integrator, Mode, Real};
        let pair = [(0.0, 0.04), (0.0, -0.04), (-1.0, 9.0), (-1.0, -9.0)];
        assert_eq!(kinds(&pair, false), [Integrator, Integrator, Mode, Mode]);
        let parted = [(0.2, 0.0), (-0.2, 0.0)];
        assert_eq!(kinds(&parted, false), [Growing, Real]);
        assert_eq!(kinds(&parted, true), [Integrator, Integrator]);
        // One alone is none.
        assert_eq!(kinds(&[(-0.2, 0.0), (-1.0, 0.0)], true), [Real, Real]);
        assert_eq!(kinds(&[(0.0, 0.0), (-1.0, 0.0)], false), [Integrator, Real]);
    }

    #[test]
    fn a_pole_at_or_beyond_the_nyquist_frequency_is_no_mode() {
        let nyquist = PI / 0.01;
        let fast = [(-1.0, nyquist), (-nyquist, 0.0), (-0.8 * nyquist, 0.8 * nyquist)];
        assert_eq!(kinds(&fast, false), [PoleKind::BeyondNyquist; 3]);
        assert_eq!(kinds(&[(-1.0, 0.99 * nyquist)], false), [PoleKind::Mode]);
    }
}
