//! The modes of a realisation, and how much the data supports each.

use crumple_lti::{Complex, Mode, StateSpace, eigenvectors};
use nalgebra::DMatrix;

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
