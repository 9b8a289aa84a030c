//! The Maxwell model from an identified sum of exponentials, as the single-mass paper does it.

use crumple_lumped::{Complex, Model};
use crumple_signal::Note;

use crate::{Candidate, MaxwellExponents, Method, SolveError, maxwell_from_exponents};

/// Exponent of the constant over the slowest of the others: above this a decaying one is remarked and a growing one
/// refused.
const CONSTANT: f64 = 0.01;

/// The Maxwell model whose displacement `x = C1 + e^(a t) (...)` has these exponents, 1/s: a real one for the constant
/// and a conjugate pair, or three real ones (single-mass paper, equations 18 to 25).
///
/// The real exponent nearest zero is that of the constant, which the model has at exactly zero; how far it is from
/// there is remarked, and the other two give spring and damper in closed form. Amplitudes play no part: impact speed
/// and start of the record are not used, so a model of the right exponents may still miss the motion. The relative
/// error of `k` is the sum of those of both exponents.
///
/// Errors: another number of exponents, none of them real, a mass that is not positive, an exponent that does not decay
/// (its spring or damper would be negative).
pub fn maxwell_from_sum(id: &str, exponents: &[Complex], mass_kg: f64, index: usize) -> Result<Candidate, SolveError> {
    let count = exponents.len();
    if count != 3 {
        return Err(SolveError::Value {
            name: "number of exponents of the sum",
            value: count as f64,
            expected: "3: one real and a conjugate pair, or three real ones",
        });
    }
    let real = |k: &usize| exponents[*k].im == 0.0;
    let Some(constant) =
        (0..count).filter(real).min_by(|i, j| exponents[*i].re.abs().total_cmp(&exponents[*j].re.abs()))
    else {
        return Err(SolveError::Value {
            name: "number of real exponents of the sum",
            value: 0.0,
            expected: "1 or 3: the model has a constant",
        });
    };
    let rest: Vec<Complex> = (0..count).filter(|k| *k != constant).map(|k| exponents[k]).collect();
    let (a, b) = (rest[0], rest[1]);
    let exponents_of_the_motion = if a.im == 0.0 && b.im == 0.0 {
        MaxwellExponents::Real { a_per_s: 0.5 * (a.re + b.re), b_per_s: 0.5 * (a.re - b.re) }
    } else {
        MaxwellExponents::Complex { a_per_s: 0.5 * (a.re + b.re), b_rad_per_s: a.im }
    };
    let slowest = a.re.abs().min(b.re.abs());
    let near_zero = exponents[constant].re;
    if !near_zero.is_finite() || near_zero > CONSTANT * slowest {
        return Err(SolveError::Value {
            name: "real exponent nearest zero",
            value: near_zero,
            expected: "0, that of the constant, or at most a hundredth of the slowest other: the motion grows without \
                end",
        });
    }
    let model = maxwell_from_exponents(mass_kg, exponents_of_the_motion)?;
    let kind = match exponents_of_the_motion {
        MaxwellExponents::Complex { a_per_s, b_rad_per_s } => {
            format!("{a_per_s:.4} ± {:.4} i 1/s, complex: the mass swings", b_rad_per_s.abs())
        }
        MaxwellExponents::Real { .. } => format!("{:.4} and {:.4} 1/s, real: the mass creeps", a.re, b.re),
    };
    let mut notes = vec![Note::info(format!("from the exponents of {id}: {kind}; amplitudes are not used"))];
    notes.push(if near_zero.abs() > CONSTANT * slowest {
        Note::warning(format!(
            "the exponent taken for the constant is {near_zero:.4} 1/s, 0 in the model, and not small beside \
             {slowest:.4} 1/s: this is hardly the motion of a Maxwell model"
        ))
    } else {
        Note::info(format!("the exponent taken for the constant is {near_zero:.3e} 1/s, 0 in the model"))
    });
    Ok(Candidate::new(Model::Maxwell(model), Method::ClosedForm, index, notes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_lumped::Maxwell;

    fn exponents(model: &Maxwell) -> [Complex; 3] {
        // r² + (k/c) r + k/m = 0.
        let a = -0.5 * model.stiffness_n_per_m / model.damping_n_s_per_m;
        let square = Complex::new(a * a - model.stiffness_n_per_m / model.mass_kg, 0.0);
        let root = square.sqrt();
        [a + root, Complex::new(0.0, 0.0), a - root]
    }

    #[test]
    fn spring_and_damper_come_back_from_complex_and_from_real_exponents() {
        // Critical at sqrt(k m)/2 = 31,225 N·s/m.
        for damping_n_s_per_m in [60_000.0, 25_000.0] {
            let model = Maxwell { mass_kg: 1300.0, stiffness_n_per_m: 3e6, damping_n_s_per_m };
            let candidate = maxwell_from_sum("exponentials-3", &exponents(&model), 1300.0, 1).unwrap();
            let p = candidate.model.parameters();
            // Ten roundings.
            assert!((p["stiffness_n_per_m"] / 3e6 - 1.0).abs() < 1e-13, "{p:?}");
            assert!((p["damping_n_s_per_m"] / damping_n_s_per_m - 1.0).abs() < 1e-13, "{p:?}");
            assert_eq!(candidate.id(), "maxwell/closed-form/1");
        }
    }

    #[test]
    fn growing_exponents_and_other_forms_are_refused_with_the_reason() {
        let refused = |list: &[(f64, f64)]| {
            let list: Vec<Complex> = list.iter().map(|(re, im)| Complex::new(*re, *im)).collect();
            maxwell_from_sum("x", &list, 900.0, 1).unwrap_err().to_string()
        };
        let growing = refused(&[(0.0, 0.0), (2.0, 30.0), (2.0, -30.0)]);
        assert!(growing.contains("slowest exponent of the fit is 2"), "{growing}");
        let real = refused(&[(-1e-3, 0.0), (0.5, 0.0), (-30.0, 0.0)]);
        assert!(real.contains("slowest exponent of the fit is 0.5"), "{real}");
        let constant = refused(&[(5.0, 0.0), (-20.0, 30.0), (-20.0, -30.0)]);
        assert!(constant.contains("grows without end"), "{constant}");
        assert!(refused(&[(-20.0, 30.0), (-20.0, -30.0)]).contains("expected 3"));
    }

    #[test]
    fn a_constant_that_decays_is_remarked() {
        let list = [(-5.0, 0.0), (-20.0, 30.0), (-20.0, -30.0)].map(|(re, im)| Complex::new(re, im));
        let candidate = maxwell_from_sum("x", &list, 900.0, 1).unwrap();
        assert!(
            candidate.notes[1].to_string().starts_with("warning: the exponent taken for the constant is -5"),
            "{:?}",
            candidate.notes
        );
    }
}
