//! A model of lower order by balanced truncation.

use crumple_linalg::jacobi_svd;
use crumple_lti::StateSpace;
use nalgebra::DMatrix;

/// Doublings of a Gramian's sum; 2^40 steps cover every pole inside `1 - 1e-10`.
const DOUBLINGS: usize = 40;

/// Hankel singular values below this fraction of the largest are rounding.
const RANK_TOLERANCE: f64 = 1e-13;

/// Cuts a stable sampled model to its `order` states that matter most for its response: those of the largest Hankel
/// singular values, which come with it. `None`: a pole on or outside the unit circle, or fewer states than asked for.
///
/// Square-root method: Gramians by doubling, `P = sum A^k B B' A'^k`, factored by their eigenvectors, then one singular
/// value decomposition. The error of the response is at most twice the sum of the values cut off.
///
/// Moore, IEEE Trans. Autom. Control 26(1), 1981; Laub et al., IEEE Trans. Autom. Control 32(2), 1987.
pub(crate) fn balanced_truncation(model: &StateSpace, order: usize) -> Option<(StateSpace, Vec<f64>)> {
    if order == 0 || order > model.order() {
        return None;
    }
    let reach = factor(&gramian(&model.a, &(&model.b * model.b.transpose()))?)?;
    let see = factor(&gramian(&model.a.transpose(), &(model.c.transpose() * &model.c))?)?;
    let svd = jacobi_svd(&see.tr_mul(&reach))?;
    if *svd.values.get(order - 1)? <= RANK_TOLERANCE * svd.values[0] {
        return None;
    }
    let scaled = |vectors: &DMatrix<f64>| {
        let mut kept = vectors.columns(0, order).into_owned();
        for (k, s) in svd.values[..order].iter().enumerate() {
            kept.column_mut(k).unscale_mut(s.sqrt());
        }
        kept
    };
    let right = &reach * scaled(&svd.right);
    let left = &see * scaled(&svd.left);
    let reduced = StateSpace::new(
        left.tr_mul(&(&model.a * &right)),
        left.tr_mul(&model.b),
        &model.c * &right,
        model.d.clone(),
        model.sample_time_s,
    );
    Some((reduced.ok()?, svd.values))
}

/// `sum a^k w a'^k`.
/// By doubling: with `S_j` the sum of the first `2^j` terms, `S_(j+1) = S_j + a^(2^j) S_j a'^(2^j)`. `None` where the
/// sum grows beyond bounds or does not settle within [`DOUBLINGS`].
fn gramian(a: &DMatrix<f64>, w: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let (mut sum, mut power) = (w.clone(), a.clone());
    for _ in 0..DOUBLINGS {
        let more = &power * &sum * power.transpose();
        let (size, step) = (sum.amax(), more.amax());
        if !step.is_finite() || step > 1e30 * w.amax() {
            return None;
        }
        sum += more;
        if step <= 1e-17 * size {
            return Some((&sum + sum.transpose()) * 0.5);
        }
        power = &power * &power;
    }
    None
}

/// `L` with `L L' = p`, also for a singular `p`.
fn factor(p: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let eigen = nalgebra::SymmetricEigen::try_new(p.clone(), f64::EPSILON, 60 * p.nrows())?;
    let mut vectors = eigen.eigenvectors;
    for (k, value) in eigen.eigenvalues.iter().enumerate() {
        vectors.column_mut(k).scale_mut(value.max(0.0).sqrt());
    }
    Some(vectors)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_lti::impulse_response;

    fn model(weak: f64) -> StateSpace {
        StateSpace::new(
            nalgebra::dmatrix![0.9, 0.3, 0.0; -0.3, 0.9, 0.0; 0.0, 0.0, 0.5],
            nalgebra::dmatrix![1.0; 0.5; weak],
            nalgebra::dmatrix![1.0, 0.0, 1.0],
            nalgebra::dmatrix![0.3],
            Some(1.0),
        )
        .unwrap()
    }

    #[test]
    fn a_state_that_nothing_drives_goes_and_nothing_changes() {
        let (reduced, values) = balanced_truncation(&model(0.0), 2).unwrap();
        assert!(values[2] < 1e-12 * values[0], "{values:?}");
        let (x, y) = (impulse_response(&model(0.0), 60).unwrap(), impulse_response(&reduced, 60).unwrap());
        // Rounding of Gramians.
        assert!(x.iter().zip(&y).all(|(x, y)| (x - y).abs() < 1e-12));
    }

    #[test]
    fn the_error_stays_below_twice_what_was_cut_off() {
        let full = model(0.05);
        let (reduced, values) = balanced_truncation(&full, 2).unwrap();
        let (x, y) = (impulse_response(&full, 200).unwrap(), impulse_response(&reduced, 200).unwrap());
        // The largest gain over frequencies is bounded; every sample of an impulse response by it.
        let worst = x.iter().zip(&y).fold(0.0_f64, |m, (x, y)| m.max((x - y).abs()));
        assert!(worst <= 2.0 * values[2] && worst > 0.0, "{worst} {values:?}");
    }

    #[test]
    fn a_growing_model_has_no_gramian() {
        let mut growing = model(1.0);
        growing.a[(2, 2)] = 1.5;
        assert!(balanced_truncation(&growing, 2).is_none());
    }
}
