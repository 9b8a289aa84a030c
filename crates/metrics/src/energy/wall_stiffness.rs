//! KW400 and the initial stiffness: what the force of a wall over the vehicle's displacement says of its front.

/// Where KW400 begins, m: below it the front covers are crushed.
pub const KW400_FROM_M: f64 = 0.025;
/// Where KW400 ends, m.
pub const KW400_TO_M: f64 = 0.4;
/// Where the line of the initial stiffness ends, m.
pub const INITIAL_TO_M: f64 = 0.2;

/// Stiffnesses from a wall's force over the displacement of the compartment.
///
/// The text that defines KW400 was not seen: three readings of its name are given, each gives back the stiffness of a
/// linear spring or says by how much it misses it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallStiffness {
    /// Work from 25 to 400 mm, J.
    pub work_j: f64,
    /// `2 W/(0.4² - 0.025²)`, N/m: the linear spring with that work between the same ends.
    pub kw400_n_per_m: f64,
    /// The same work over the whole square, `2 W/0.4²`, N/m.
    pub kw400_full_square_n_per_m: f64,
    /// Work from 0 to 400 mm over the whole square, N/m.
    pub kw400_from_zero_n_per_m: f64,
    /// Slope of the line through the force from 25 to 200 mm with the least squares over the displacement, N/m.
    pub initial_n_per_m: f64,
    /// Slope of such a line through the origin, N/m.
    pub initial_through_origin_n_per_m: f64,
}

/// The stiffnesses of a force, N, over a displacement, m, straight between samples; of the way in alone: up to the
/// first sample at or beyond 400 mm. `None` where the displacement does not reach 400 mm or does not begin at 25 mm or
/// less, where lists differ in length or are not finite.
///
/// The work is an integral over the displacement, not over the time, so the sampling does not weigh. Both lists are to
/// be of the same filter class.
pub fn wall_stiffness(displacement_m: &[f64], force_n: &[f64]) -> Option<WallStiffness> {
    let all_finite = displacement_m.iter().chain(force_n).all(|x| x.is_finite());
    if displacement_m.len() != force_n.len() || !all_finite {
        return None;
    }
    let end = displacement_m.iter().position(|x| *x >= KW400_TO_M)?;
    let start = displacement_m[..end].iter().rposition(|x| *x <= 0.0).unwrap_or(0);
    if displacement_m[start] > KW400_FROM_M {
        return None;
    }
    let (x, force) = (&displacement_m[start..=end], &force_n[start..=end]);
    let moments = |from: f64, to: f64| moments(x, force, from, to);
    let work_j = moments(KW400_FROM_M, KW400_TO_M)[0];
    let square = |x: f64| 0.5 * x * x;
    let cube = |x: f64| x * x * x / 3.0;
    // Of the line F = a + k x: normal equations over the displacement.
    let (from, to) = (KW400_FROM_M, INITIAL_TO_M);
    let [area, moment] = moments(from, to);
    let (length, first, second) = (to - from, square(to) - square(from), cube(to) - cube(from));
    Some(WallStiffness {
        work_j,
        kw400_n_per_m: work_j / (square(KW400_TO_M) - square(KW400_FROM_M)),
        kw400_full_square_n_per_m: work_j / square(KW400_TO_M),
        kw400_from_zero_n_per_m: moments(0.0, KW400_TO_M)[0] / square(KW400_TO_M),
        initial_n_per_m: (moment - first * area / length) / (second - first * first / length),
        initial_through_origin_n_per_m: moment / second,
    })
}

/// `∫F dx` and `∫x F dx` between two displacements, of straight lines between samples; before the first sample the
/// force of the first. Pieces that go back count with their sign.
fn moments(x: &[f64], force: &[f64], from: f64, to: f64) -> [f64; 2] {
    let mut sums = [0.0; 2];
    let mut add = |(x0, f0): (f64, f64), (x1, f1): (f64, f64)| {
        let (a, b) = (x0.clamp(from, to), x1.clamp(from, to));
        if a == b {
            return;
        }
        let slope = (f1 - f0) / (x1 - x0);
        let force = |x: f64| f0 + slope * (x - x0);
        let (fa, fb) = (force(a), force(b));
        sums[0] += 0.5 * (b - a) * (fa + fb);
        sums[1] += (b - a) / 6.0 * (a * (2.0 * fa + fb) + b * (fa + 2.0 * fb));
    };
    add((from.min(x[0]), force[0]), (x[0], force[0]));
    for (x, force) in x.windows(2).zip(force.windows(2)) {
        add((x[0], force[0]), (x[1], force[1]));
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_spring_has_its_own_stiffness() {
        let x: Vec<f64> = (0..=45).map(|i| 0.01 * f64::from(i)).collect();
        let force: Vec<f64> = x.iter().map(|x| 1.1e6 * x).collect();
        let of = wall_stiffness(&x, &force).unwrap();
        for k in [of.kw400_n_per_m, of.kw400_from_zero_n_per_m, of.initial_n_per_m, of.initial_through_origin_n_per_m] {
            assert!((k / 1.1e6 - 1.0).abs() < 1e-12, "{k}");
        }
        // (0.4² - 0.025²)/0.4².
        assert!((of.kw400_full_square_n_per_m / 1.1e6 - 255.0 / 256.0).abs() < 1e-12);
    }

    #[test]
    fn a_front_that_does_not_reach_400_mm_has_none() {
        assert_eq!(wall_stiffness(&[0.0, 0.2, 0.39], &[0.0, 1e5, 2e5]), None);
        assert_eq!(wall_stiffness(&[0.1, 0.5], &[0.0, 1e5]), None);
        assert_eq!(wall_stiffness(&[0.0, 0.5], &[0.0]), None);
        assert_eq!(wall_stiffness(&[0.0, 0.5], &[0.0, f64::NAN]), None);
    }
}
