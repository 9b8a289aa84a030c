//! The curve fit of the ERA paper as a method: for reproduction, and labelled so in every candidate.

use crumple_lumped::{DoubleSpringMassDamper, Model};
use crumple_signal::Note;

use crate::{Candidate, Method, SolveError, front_from_amplitudes, rear_from_amplitudes};

/// Springs and dampers of the double model from four real exponents and amplitudes of the displacement, by equations 17
/// to 25 of the ERA paper.
///
/// **For reproduction, not for use.** The amplitude relation `C_1k = m2 s_k² + c2 s_k + k2` holds up to one unknown
/// factor for each exponent, so metres are set equal to N/m and the equations are no consequence of the model; the
/// amplitudes are those of the compartment, used as if they were the chassis's; and the model found does not have the
/// exponents it was found from. Coefficient matching of the same four exponents finds every model that does.
///
/// Errors: masses that are not positive, exponents that coincide.
pub fn curve_fit_of_the_paper(
    id: &str,
    exponents_per_s: &[f64; 4],
    amplitudes_m: &[f64; 4],
    m1_kg: f64,
    m2_kg: f64,
    index: usize,
) -> Result<Candidate, SolveError> {
    let (k2, c2) = rear_from_amplitudes(exponents_per_s, amplitudes_m, m2_kg);
    let (k1, c1) = front_from_amplitudes(exponents_per_s, m1_kg, m2_kg, (k2, c2));
    let model =
        DoubleSpringMassDamper { m1_kg, m2_kg, k1_n_per_m: k1, k2_n_per_m: k2, c1_n_s_per_m: c1, c2_n_s_per_m: c2 };
    model.check()?;
    let [_, t, u, v, w] = model.characteristic_polynomial();
    // How far each exponent is from a root of the model it led to: p(s) over the sum of its parts.
    let miss = exponents_per_s
        .iter()
        .map(|s| {
            let terms = [s.powi(4), t * s.powi(3), u * s * s, v * s, w];
            terms.iter().sum::<f64>().abs() / terms.iter().map(|x| x.abs()).sum::<f64>()
        })
        .fold(0.0, f64::max);
    let notes = vec![
        Note::warning(format!(
            "as the ERA paper prints it (equations 17 to 25, proper least squares), from {id}; for reproduction, not \
             for use"
        )),
        Note::info(
            "equations 19 to 25 are not a consequence of the model: an amplitude is known up to one factor for each \
             exponent, so metres are set equal to N/m, and nearly all of k2 and c2 is m2 times a straight line through \
             s²",
        ),
        Note::info(format!(
            "the model does not have the exponents it was made from: its characteristic polynomial misses zero there \
             by up to {:.1} % of its parts; coefficient-matching of the same exponents finds every model that has them",
            100.0 * miss
        )),
    ];
    Ok(Candidate::new(Model::DoubleSpringMassDamper(model), Method::CurveFit, index, notes))
}

#[cfg(test)]
mod tests {
    use super::*;

    const S: [f64; 4] = [-7.754, -6.238, -9.603, -10.87];
    const C: [f64; 4] = [-253.6, 83.75, 333.0, -163.2];

    #[test]
    fn gives_the_rear_of_the_papers_first_case_and_says_what_it_is() {
        let candidate = curve_fit_of_the_paper("exponentials-4", &S, &C, 291.0, 582.0, 1).unwrap();
        let p = candidate.model.parameters();
        // Printed with 5 and 4 digits; the front, recomputed from the printed formulas, is negative.
        assert!((p["k2_n_per_m"] - 40731.0).abs() < 0.5 && (p["c2_n_s_per_m"] - 9952.0).abs() < 0.5, "{p:?}");
        assert!(p["k1_n_per_m"] < 0.0 && !candidate.model.is_physical());
        assert_eq!(candidate.id(), "double-spring-mass-damper/curve-fit/1");
        assert!(candidate.notes[0].to_string().starts_with("warning: as the ERA paper prints it"));
    }

    #[test]
    fn coinciding_exponents_are_an_error() {
        assert!(curve_fit_of_the_paper("x", &[-5.0; 4], &C, 291.0, 582.0, 1).is_err());
    }
}
