//! What coefficient matching found, as the artifact gets it.

use crumple_lumped_fit::{Candidate, Matched};
use crumple_stage::records::{MatchingRootV1, MatchingSolutionV1, MatchingSweepV1, MatchingV1, PhysicalCoordinatesV1};
use nalgebra::SMatrix;

/// What goes to `/matching/<model id>`.
pub fn matching_record(matched: &Matched, source: &str) -> MatchingV1 {
    let coefficient_match = &matched.coefficient_match;
    let mut candidates = matched.candidates.iter();
    let mut polynomial = vec![1.0];
    polynomial.extend(coefficient_match.polynomial);
    MatchingV1 {
        m1_kg: coefficient_match.m1_kg,
        m2_kg: coefficient_match.m2_kg,
        polynomial,
        largest_mass_ratio: coefficient_match.largest_mass_ratio,
        roots: coefficient_match
            .roots
            .iter()
            .map(|root| MatchingRootV1 {
                re_per_s2: root.zeta.re,
                im_per_s2: root.zeta.im,
                multiplicity: root.multiplicity as u32,
                certified_radius_per_s2: root.certificate.map(|c| c.radius),
            })
            .collect(),
        solutions: coefficient_match
            .solutions
            .iter()
            .map(|s| MatchingSolutionV1 {
                k1_re_n_per_m: s.k1_n_per_m.re,
                k1_im_n_per_m: s.k1_n_per_m.im,
                k2_re_n_per_m: s.k2_n_per_m.re,
                k2_im_n_per_m: s.k2_n_per_m.im,
                c1_re_n_s_per_m: s.c1_n_s_per_m.re,
                c1_im_n_s_per_m: s.c1_n_s_per_m.im,
                c2_re_n_s_per_m: s.c2_n_s_per_m.re,
                c2_im_n_s_per_m: s.c2_n_s_per_m.im,
                real: s.real,
                physical: s.physical,
                multiplicity: s.multiplicity as u32,
                dual: s.dual as u32,
                residual: s.residual,
                // Candidates are the real solutions, in the same order.
                candidate: if s.real { candidates.next().map(Candidate::id) } else { None },
                zero_re_per_s: s.zero().map(|zero| zero.re),
                zero_im_per_s: s.zero().map(|zero| zero.im),
            })
            .collect(),
        sweep: matched
            .sweep
            .iter()
            .flat_map(|(fraction, at)| at.solutions.iter().filter(|s| s.real).map(move |s| (*fraction, s)))
            .map(|(front_mass_fraction, s)| MatchingSweepV1 {
                front_mass_fraction,
                k1_n_per_m: s.k1_n_per_m.re,
                k2_n_per_m: s.k2_n_per_m.re,
                c1_n_s_per_m: s.c1_n_s_per_m.re,
                c2_n_s_per_m: s.c2_n_s_per_m.re,
                physical: s.physical,
            })
            .collect(),
        notes: matched.remarks.clone(),
        source: Some(source.to_owned()),
        zeta_of_the_start_per_s2: matched.zeta_of_the_start,
        coordinates: matched
            .coordinates
            .iter()
            .map(|(place, physical)| PhysicalCoordinatesV1 {
                candidate: matched.candidates[*place].id(),
                mass_kg: rows(&physical.mass_kg),
                damping_n_s_per_m: rows(&physical.damping_n_s_per_m),
                stiffness_n_per_m: rows(&physical.stiffness_n_per_m),
                transformation: rows(&physical.transformation),
                condition: physical.condition,
                residual: physical.residual,
                chassis_mismatch: physical.chassis_mismatch,
                start: physical.start.map(Vec::from),
            })
            .collect(),
    }
}

/// A matrix row by row.
fn rows<const N: usize>(matrix: &SMatrix<f64, N, N>) -> Vec<Vec<f64>> {
    matrix.row_iter().map(|row| row.iter().copied().collect()).collect()
}
