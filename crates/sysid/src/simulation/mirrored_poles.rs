//! Sampled models whose growing poles are mirrored at the unit circle.

use crumple_numerics::lti::{Complex, eigenvalues, eigenvectors};
use nalgebra::DMatrix;

use crate::IdentifyError;
use crate::simulation::input_matrices::grows;

/// Mirrors poles outside the unit circle (`z -> 1/conj z`) when the model [`grows`] over `samples`, in modal
/// coordinates. Errors: an eigenvector basis that does not span the space.
///
/// The result is `A` and `C` in real modal coordinates and the number of poles that were mirrored; both as given, and
/// 0, where the model does not grow. Mirroring keeps the modulus of the pole's frequency response on the unit circle
/// up to a factor.
pub(crate) fn stabilized(
    a: DMatrix<f64>,
    c: DMatrix<f64>,
    samples: usize,
) -> Result<(DMatrix<f64>, DMatrix<f64>, usize), IdentifyError> {
    if !grows(&a, samples) {
        return Ok((a, c, 0));
    }
    let poles = eigenvalues(&a)?;
    let outside = poles.iter().filter(|z| z.norm() > 1.0).count();
    let failed = || IdentifyError::NotConverged("the modal form of an unstable subspace model");
    let vectors = eigenvectors(&a, &poles).ok_or_else(failed)?;
    let c_modal = c.map(|x| Complex::new(x, 0.0)) * &vectors;
    if c_modal.iter().any(|x| !(x.re.is_finite() && x.im.is_finite())) {
        return Err(failed());
    }
    let n = a.nrows();
    let (mut a_real, mut c_real) = (DMatrix::zeros(n, n), DMatrix::zeros(c.nrows(), n));
    let mut k = 0;
    while k < n {
        let z = if poles[k].norm() > 1.0 { poles[k] / poles[k].norm_sqr() } else { poles[k] };
        // Coordinates Re and Im of the modal state: x = 2 (Re v, -Im v).
        for i in 0..c.nrows() {
            c_real[(i, k)] = c_modal[(i, k)].re;
            if z.im != 0.0 && k + 1 < n {
                c_real[(i, k + 1)] = -c_modal[(i, k)].im;
            }
        }
        a_real[(k, k)] = z.re;
        if z.im != 0.0 && k + 1 < n {
            a_real[(k, k + 1)] = -z.im;
            a_real[(k + 1, k)] = z.im;
            a_real[(k + 1, k + 1)] = z.re;
            k += 1;
        }
        k += 1;
    }
    Ok((a_real, c_real, outside))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crate::IoData;
    use crate::simulation::input_matrices::input_matrices;
    use crumple_numerics::estimation::random::uniform_at;
    use crumple_numerics::lti::{StateSpace, simulate};

    #[test]
    fn a_growing_pole_is_mirrored_and_the_rest_fitted_again() {
        let truth = |slow: f64| {
            let a = nalgebra::dmatrix![0.9, 0.3, 0.0; -0.3, 0.9, 0.0; 0.0, 0.0, slow];
            let b = nalgebra::dmatrix![1.0; 0.5; 0.2];
            StateSpace::new(a, b, nalgebra::dmatrix![1.0, 0.0, 0.3], nalgebra::dmatrix![0.1], Some(0.01)).unwrap()
        };
        let u: Vec<f64> = (0..400).map(|k| uniform_at(3, k) - 0.5).collect();
        let y = simulate(&truth(0.8), std::slice::from_ref(&u), &[0.0; 3]).unwrap().swap_remove(0);
        let data = IoData::single(u, y, 0.01).unwrap();
        let mirrored = |model: StateSpace| stabilized(model.a, model.c, 400).unwrap();
        assert_eq!(mirrored(truth(0.8)).2, 0);
        // 1.25 and 0.8 are each other's mirror image: the model comes back.
        let (a, c, count) = mirrored(truth(1.25));
        assert_eq!(count, 1);
        let (model, _) = input_matrices(&a, &c, &data, true).unwrap();
        let fit = crate::compare(&model, &data).unwrap()[0].unwrap();
        // Rounding of a well-conditioned fit.
        assert!(fit.fit_percent.unwrap() > 100.0 - 1e-8, "{fit:?}");
    }
}
