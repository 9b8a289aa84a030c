//! Identified models with four poles among the inputs, and the record of what matching found.

use crumple_lumped::Complex;
use crumple_parameter_solve::{Identified, Matched, Quartic};
use crumple_stage::Inputs;
use crumple_stage::records::{
    MatchingRootV1, MatchingSolutionV1, MatchingSweepV1, MatchingV1, ModesV1, TransferFunctionV1,
};

/// Transfer functions of fourth order, then modes of four poles that belong to none of them.
pub fn identified_models(input: &Inputs) -> anyhow::Result<Vec<Identified>> {
    let mut found = Vec::new();
    for (id, model) in input.records::<TransferFunctionV1>("/model/")? {
        if let [leading, t, u, v, w] = model.denominator[..]
            && leading != 0.0
        {
            let quartic = Quartic::Coefficients([t, u, v, w].map(|c| c / leading));
            found.push(Identified { id, quartic, numerator: Some(model.numerator) });
        }
    }
    for (id, modes) in input.records::<ModesV1>("/modes/")? {
        if let [a, b, c, d] = &modes.0[..]
            && !found.iter().any(|model| model.id == id || model.id.starts_with(&format!("{id}/")))
        {
            let poles = [a, b, c, d].map(|mode| Complex::new(mode.re_per_s, mode.im_rad_per_s));
            found.push(Identified { id, quartic: Quartic::Poles(poles), numerator: None });
        }
    }
    Ok(found)
}

/// What goes to `/matching/<model id>`.
pub fn matching_record(matched: &Matched) -> MatchingV1 {
    let found = &matched.found;
    let mut candidates = matched.candidates.iter();
    let mut polynomial = vec![1.0];
    polynomial.extend(found.polynomial);
    MatchingV1 {
        m1_kg: found.m1_kg,
        m2_kg: found.m2_kg,
        polynomial,
        largest_mass_ratio: found.largest_mass_ratio,
        roots: found
            .roots
            .iter()
            .map(|root| MatchingRootV1 {
                re_per_s2: root.zeta.re,
                im_per_s2: root.zeta.im,
                multiplicity: root.multiplicity as u32,
                certified_radius_per_s2: root.certificate.map(|c| c.radius),
            })
            .collect(),
        solutions: found
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
                candidate: if s.real { candidates.next().map(crumple_parameter_solve::Candidate::id) } else { None },
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
    }
}
