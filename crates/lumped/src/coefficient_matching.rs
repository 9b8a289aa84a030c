//! Parameters from the coefficients of a characteristic polynomial, every solution.

use crumple_lti::{Complex, polynomial_roots};

use crate::error::{finite, positive};
use crate::{DoubleSpringMassDamper, LumpedError, Maxwell};

/// One solution: springs and dampers, complex where the polynomial and the masses admit no real ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MatchedDouble {
    /// Spring to the barrier, N/m.
    pub k1_n_per_m: Complex,
    /// Spring between the masses, N/m.
    pub k2_n_per_m: Complex,
    /// Damper to the barrier, N·s/m.
    pub c1_n_s_per_m: Complex,
    /// Damper between the masses, N·s/m.
    pub c2_n_s_per_m: Complex,
    /// The root of the cubic it belongs to, `c1·c2/(m1·m2)`, 1/s².
    pub zeta_per_s2: Complex,
}

/// Every solution of matching a two-mass model with known masses to a polynomial of degree four.
#[derive(Debug, Clone, PartialEq)]
pub struct CoefficientMatch {
    /// The real solutions: two or six (four where roots of the cubic coincide), mirror pairs side by side, those of the
    /// smallest `zeta` first and in each pair the one with the larger c1.
    pub real: Vec<DoubleSpringMassDamper>,
    /// The others.
    pub complex: Vec<MatchedDouble>,
    /// Mass ratio m2/m1 below which a solution with all parameters positive exists: `(t·u·v - v² - t²·w)/v²`. `None` for
    /// v = 0. Holds for a stable polynomial with positive coefficients.
    pub largest_mass_ratio: Option<f64>,
}

impl CoefficientMatch {
    /// Whether all four parameters of a solution are positive.
    pub fn is_physical(model: &DoubleSpringMassDamper) -> bool {
        [model.k1_n_per_m, model.k2_n_per_m, model.c1_n_s_per_m, model.c2_n_s_per_m].iter().all(|x| *x > 0.0)
    }
}

/// `r1²/t²` below which it is zero: its own rounding, some 1e-15 of each of its terms, and that of the root.
const SAME_DAMPERS: f64 = 1e-12;

/// Springs and dampers of [`DoubleSpringMassDamper`] from its masses and `s⁴ + t·s³ + u·s² + v·s + w`: all six solutions.
///
/// With `κ = 1 + m2/m1`, `ζ = c1·c2/(m1·m2)` is a root of
/// `ζ³ - 2u·ζ² + (u² + t·v - 4κw)·ζ + (κv² + t²w - t·u·v)`; each root gives a mirror pair
/// `c1 = m1(t ± r1)/2`, `c2 = mr(t ∓ r1)/2`, `k1 = m1((u - ζ) ± r0)/2`, `k2 = mr((u - ζ) ∓ r0)/2` with
/// `r1 = sqrt(t² - 4κζ)`, `r0 = (t(u - ζ) - 2κv)/r1`, `mr = m1·m2/(m1 + m2)`: the polynomial is
/// `s⁴ + S·s² + q1·q2/(m1·m2)` with `q1/m1` and `q2/mr` the roots of a quadratic whose discriminant must be a square.
/// A real root with `ζ <= t²/4κ` gives two real solutions, and there always is one. Simple roots come to some 1e-14;
/// a double root (mirrors that coincide) to half the digits.
///
/// `denominator` has the highest power first and any positive leading coefficient. Errors: masses that are not
/// positive, coefficients that are not finite.
pub fn match_double(m1_kg: f64, m2_kg: f64, denominator: &[f64; 5]) -> Result<CoefficientMatch, LumpedError> {
    positive("m1_kg", m1_kg)?;
    positive("m2_kg", m2_kg)?;
    positive("the leading coefficient", denominator[0])?;
    let [t, u, v, w] = [1, 2, 3, 4].map(|k| denominator[k] / denominator[0]);
    for (name, value) in [("the coefficient of s^3", t), ("of s^2", u), ("of s", v), ("of 1", w)] {
        finite(name, value)?;
    }
    let kappa = 1.0 + m2_kg / m1_kg;
    let reduced = m1_kg * m2_kg / (m1_kg + m2_kg);
    let cubic = [1.0, -2.0 * u, u * u + t * v - 4.0 * kappa * w, kappa * v * v + t * t * w - t * u * v];
    let mut roots = polynomial_roots(&cubic)?;
    roots.sort_by(|a, b| a.re.total_cmp(&b.re));

    let (mut real, mut complex) = (Vec::new(), Vec::new());
    for zeta in roots {
        let rest = Complex::new(u, 0.0) - zeta;
        let square = Complex::new(t * t, 0.0) - zeta * (4.0 * kappa);
        // At r1 = 0 the mirror images share their dampers, and r0 comes from the other square; rounding must not make such
        // a pair complex.
        let (r1, r0) = if square.norm() > SAME_DAMPERS * t * t {
            let r1 = square.sqrt();
            (r1, (rest * t - 2.0 * kappa * v) / r1)
        } else {
            (Complex::new(0.0, 0.0), (rest * rest - 4.0 * kappa * w).sqrt())
        };
        for sign in [1.0, -1.0] {
            let c1 = (r1 * sign + t) * (m1_kg / 2.0);
            let c2 = (r1 * -sign + t) * (reduced / 2.0);
            let k1 = (rest + r0 * sign) * (m1_kg / 2.0);
            let k2 = (rest - r0 * sign) * (reduced / 2.0);
            if [c1, c2, k1, k2].iter().all(|x| x.im == 0.0) {
                real.push(DoubleSpringMassDamper {
                    m1_kg,
                    m2_kg,
                    k1_n_per_m: k1.re,
                    k2_n_per_m: k2.re,
                    c1_n_s_per_m: c1.re,
                    c2_n_s_per_m: c2.re,
                });
            } else {
                complex.push(MatchedDouble {
                    k1_n_per_m: k1,
                    k2_n_per_m: k2,
                    c1_n_s_per_m: c1,
                    c2_n_s_per_m: c2,
                    zeta_per_s2: zeta,
                });
            }
        }
    }
    let ratio = (t * u * v - v * v - t * t * w) / (v * v);
    Ok(CoefficientMatch { real, complex, largest_mass_ratio: ratio.is_finite().then_some(ratio) })
}

/// The Maxwell model whose velocity has the roots `re ± i·im`: `k = m(re² + im²)`, `c = -k/(2·re)`.
///
/// Single-mass paper, section 3.3. Errors: a real part that is not negative.
pub fn maxwell_from_complex_roots(mass_kg: f64, re_per_s: f64, im_rad_per_s: f64) -> Result<Maxwell, LumpedError> {
    let stiffness_n_per_m = mass_kg * (re_per_s * re_per_s + im_rad_per_s * im_rad_per_s);
    maxwell(mass_kg, stiffness_n_per_m, 2.0 * re_per_s)
}

/// The Maxwell model whose velocity has two real roots: `k = m·r2·r3`, `c = -k/(r2 + r3)`. Errors: a root that is not
/// negative.
pub fn maxwell_from_real_roots(mass_kg: f64, r2_per_s: f64, r3_per_s: f64) -> Result<Maxwell, LumpedError> {
    positive("-r2_per_s", -r2_per_s)?;
    positive("-r3_per_s", -r3_per_s)?;
    maxwell(mass_kg, mass_kg * r2_per_s * r3_per_s, r2_per_s + r3_per_s)
}

fn maxwell(mass_kg: f64, stiffness_n_per_m: f64, sum_of_roots: f64) -> Result<Maxwell, LumpedError> {
    let model = Maxwell { mass_kg, stiffness_n_per_m, damping_n_s_per_m: -stiffness_n_per_m / sum_of_roots };
    model.check()?;
    Ok(model)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_printed_model_has_two_real_solutions_and_none_is_physical() {
        let found = match_double(284.4, 1137.6, &[1.0, 35.7, 6024.0, 185_000.0, 414_600.0]).unwrap();
        assert_eq!((found.real.len(), found.complex.len()), (2, 4));
        let expected = [
            [34_434.205_385, 75_328.293_525, -19_424.900_308, 1_780_698.300_028],
            [-24_281.125_385, 2_225_872.875_035, 27_547.364_308, 60_262.634_820],
        ];
        for (model, expected) in found.real.iter().zip(expected) {
            let solution = [model.c1_n_s_per_m, model.k1_n_per_m, model.c2_n_s_per_m, model.k2_n_per_m];
            for (x, exact) in solution.iter().zip(expected) {
                // The values are given to six decimals.
                assert!((x - exact).abs() < 1e-6, "{solution:?}");
            }
            assert!(!CoefficientMatch::is_physical(model));
        }
        // The bound is known to five digits: both mass splits of the paper are above it.
        assert!((found.largest_mass_ratio.unwrap() - 0.14703).abs() < 5e-6);
        // Known to six decimals.
        let zeta = found.complex[0].zeta_per_s2;
        assert!((zeta.re - 7_057.712_322).abs() < 1e-6 && (zeta.im.abs() - 3_737.960_613).abs() < 1e-6);
    }

    #[test]
    fn a_model_that_is_its_own_dual_keeps_its_real_solutions() {
        let mu = (500.0 + 1000.0) / 1000.0;
        let model = DoubleSpringMassDamper {
            m1_kg: 500.0,
            m2_kg: 1000.0,
            k1_n_per_m: mu * 2e5,
            k2_n_per_m: 2e5,
            c1_n_s_per_m: mu * 4e3,
            c2_n_s_per_m: 4e3,
        };
        let found = match_double(500.0, 1000.0, &model.characteristic_polynomial()).unwrap();
        // A double root of the solution set: half the digits.
        assert!(found.real.iter().any(|s| (s.k1_n_per_m / 3e5 - 1.0).abs() < 1e-5), "{found:?}");
    }

    #[test]
    fn a_maxwell_model_comes_back_from_its_roots() {
        let model = maxwell_from_complex_roots(873.0, -33.42, 39.02).unwrap();
        assert!((model.stiffness_n_per_m / 2_304_245.786_4 - 1.0).abs() < 1e-10);
        let model = maxwell_from_real_roots(10.0, -2.0, -3.0).unwrap();
        assert_eq!((model.stiffness_n_per_m, model.damping_n_s_per_m), (60.0, 12.0));
        assert!(maxwell_from_complex_roots(873.0, 1.0, 2.0).is_err());
        assert!(maxwell_from_real_roots(873.0, 1.0, 2.0).is_err());
        assert!(match_double(0.0, 1.0, &[1.0; 5]).is_err() && match_double(1.0, 1.0, &[f64::NAN; 5]).is_err());
    }

    proptest! {
        #[test]
        fn a_positive_model_and_its_dual_are_among_the_solutions_and_all_solutions_match(
            m in prop::array::uniform2(100.0..2000.0_f64),
            k in prop::array::uniform2(1e4..2e6_f64),
            c in prop::array::uniform2(1e3..3e4_f64),
        ) {
            let model = DoubleSpringMassDamper {
                m1_kg: m[0], m2_kg: m[1], k1_n_per_m: k[0], k2_n_per_m: k[1], c1_n_s_per_m: c[0], c2_n_s_per_m: c[1],
            };
            let polynomial = model.characteristic_polynomial();
            let found = match_double(m[0], m[1], &polynomial).unwrap();
            prop_assert_eq!(found.real.len() + found.complex.len(), 6);
            prop_assert!(found.real.len() >= 2);
            prop_assert!(found.largest_mass_ratio.unwrap() > m[1] / m[0] * (1.0 - 1e-9));
            for solution in &found.real {
                for (x, exact) in solution.characteristic_polynomial().iter().zip(polynomial) {
                    // Rounding, enlarged near mirrors that coincide, where r1 is a small root.
                    prop_assert!((x - exact).abs() <= 1e-6 * exact, "{x} {exact}");
                }
            }
            for wanted in [model, model.dual()] {
                let distance = |s: &DoubleSpringMassDamper| {
                    (s.k1_n_per_m / wanted.k1_n_per_m - 1.0).abs() + (s.c1_n_s_per_m / wanted.c1_n_s_per_m - 1.0).abs()
                };
                // Half the digits where the model nearly is its own dual.
                prop_assert!(found.real.iter().map(distance).fold(f64::INFINITY, f64::min) < 1e-5);
            }
        }
    }
}
