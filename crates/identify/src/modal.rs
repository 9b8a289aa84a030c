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

/// Modes of a discrete model in the order of `poles`.
///
/// `controllability` is `S^1/2 V'`: the identified sequence `[B, A B, A² B, ...]` by which the model's own is judged.
/// `terms` is the number of samples the sum in the mode singular value runs over.
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
) -> Vec<IdentifiedMode> {
    let evidence = modal_evidence(model, poles, controllability, terms);
    let (coherence, mut strength) = evidence.unwrap_or_else(|| (vec![None; poles.len()], vec![None; poles.len()]));
    let largest = strength.iter().flatten().copied().fold(0.0, f64::max);
    for value in &mut strength {
        *value = value.map(|s| s / largest).filter(|s| s.is_finite());
    }
    poles
        .iter()
        .zip(coherence.into_iter().zip(strength))
        .map(|(&z, (coherence, strength))| IdentifiedMode {
            discrete_pole: z,
            mode: Mode::discrete(z, dt_s),
            modal_amplitude_coherence: coherence,
            mode_singular_value: strength,
        })
        .collect()
}

type Evidence = (Vec<Option<f64>>, Vec<Option<f64>>);

/// Coherences and unscaled mode singular values; `None` if the eigenvectors do not span the state space.
fn modal_evidence(
    model: &StateSpace,
    poles: &[Complex],
    controllability: &DMatrix<f64>,
    terms: usize,
) -> Option<Evidence> {
    let complex = |m: &DMatrix<f64>| m.map(|x| Complex::new(x, 0.0));
    let vectors = eigenvectors(&model.a, poles)?;
    let inverse = vectors.clone().try_inverse()?;
    if inverse.iter().any(|x| !x.re.is_finite() || !x.im.is_finite()) {
        return None;
    }
    let b = &inverse * complex(&model.b);
    let c = complex(&model.c) * &vectors;
    let identified = &inverse * complex(controllability);
    let mut coherences = Vec::with_capacity(poles.len());
    let mut strengths = Vec::with_capacity(poles.len());
    for (i, &z) in poles.iter().enumerate() {
        let mut pure = b[i];
        let (mut inner, mut pure_square, mut data_square) = (Complex::new(0.0, 0.0), 0.0, 0.0);
        for data in identified.row(i).iter() {
            inner += pure.conj() * data;
            pure_square += pure.norm_sqr();
            data_square += data.norm_sqr();
            pure *= z;
        }
        let coherence = inner.norm() / (pure_square * data_square).sqrt();
        // Rounding may carry it past 1.
        coherences.push(coherence.is_finite().then_some(coherence.min(1.0)));

        let modulus = z.norm();
        let sum: f64 = std::iter::successors(Some(1.0), |power| Some(power * modulus)).take(terms).sum();
        let strength = (c[i].norm() * sum * b[i].norm()).sqrt();
        strengths.push(strength.is_finite().then_some(strength));
    }
    Some((coherences, strengths))
}
