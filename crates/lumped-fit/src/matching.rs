//! The double model from the poles of an identified model: every solution, and the standard deviations of each.

use std::collections::BTreeMap;

use crumple_lumped::{
    CoefficientMatch, CoefficientMatching, Complex, DoubleSpringMassDamper, MatchedSolution, Model,
    PhysicalCoordinates, Reading, RealisedModel, matching_sensitivity,
};
use crumple_signal::{About, Note, Notes, Weight, remarks};
use nalgebra::Matrix4;

use crate::candidate::{Candidate, Method, Uncertainty};
use crate::error::SolveError;

// The double model from an identified one of fourth order: coefficient matching with every solution.
//
// The characteristic polynomial `s^4 + t s^3 + u s^2 + v s + w` of the double model has four coefficients for four
// unknowns; for given masses the equations have six complex solutions, of which the real ones with positive springs
// are physical.

/// Divisions of the total mass in a sweep, 2 % apart.
const SWEEP: usize = 49;

/// The poles of an identified model, as its polynomial or as they are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Quartic {
    /// `t, u, v, w` of its monic denominator.
    Coefficients([f64; 4]),
    /// Its four poles, 1/s.
    Poles([Complex; 4]),
}

/// An identified model with four poles and what else is known of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Identified {
    /// Its id.
    pub id: String,
    /// Its poles.
    pub quartic: Quartic,
    /// Its numerator, highest power first, where it is a transfer function.
    pub numerator: Option<Vec<f64>>,
    /// Where the poles were taken from, in words.
    pub source: &'static str,
    /// Its state space, where there is one whose output is a motion.
    pub realised: Option<RealisedModel>,
    /// How well its coefficients are known; `None` where nothing says so.
    pub spread: Option<CoefficientSpread>,
    /// Time by which its input acts late, s; 0 without a delay.
    pub delay_s: f64,
}

impl Identified {
    /// A model of which nothing but the poles is known.
    pub fn of_poles(id: String, poles: [Complex; 4], source: &'static str) -> Self {
        let quartic = Quartic::Poles(poles);
        Self { id, quartic, numerator: None, source, realised: None, spread: None, delay_s: 0.0 }
    }
}

/// All solutions of a matching, and what follows from each.
#[derive(Debug, Clone, PartialEq)]
pub struct Matched {
    /// All solutions at the given masses.
    pub coefficient_match: CoefficientMatch,
    /// All solutions at other divisions of the same total mass, with the front share.
    pub sweep: Vec<(f64, CoefficientMatch)>,
    /// The real ones as candidates, in the order of the solutions.
    pub candidates: Vec<Candidate>,
    /// What was found, in words.
    pub remarks: Vec<String>,
    /// The state space in the coordinates of each solution, by the place of its candidate.
    pub coordinates: Vec<(usize, PhysicalCoordinates)>,
    /// `c1 c2/(m1 m2)` that the start of a free motion implies, 1/s².
    pub zeta_of_the_start: Option<f64>,
}

/// Every solution with the same poles and total mass at other divisions of the mass, with the front share.
fn swept(matching: &CoefficientMatching) -> Result<Vec<(f64, CoefficientMatch)>, SolveError> {
    let fractions: Vec<f64> = (1..=SWEEP).map(|k| k as f64 / (SWEEP + 1) as f64).collect();
    Ok(fractions.iter().copied().zip(matching.mass_split_sweep(&fractions)?).collect())
}

/// All solutions with the poles of a fitted double model, over the division of its mass.
#[derive(Debug, Clone, PartialEq)]
pub struct MassDivisions {
    /// Bound of m2/m1 above which no solution is physical; `None`: no division has one.
    pub largest_mass_ratio: Option<f64>,
    /// The solutions at each division, with the front share.
    pub sweep: Vec<(f64, CoefficientMatch)>,
}

impl MassDivisions {
    /// Of a double model that was fitted. `None` of any other; where the fit stopped on a bound other than zero, whose
    /// poles are those of the bound; and of a dual, which has the poles of the candidate before it.
    pub fn of(candidate: &Candidate) -> Option<Self> {
        let Model::DoubleSpringMassDamper(model) = &candidate.model else { return None };
        let bounds = &candidate.fit.as_ref()?.active_bounds;
        let is_dual = candidate.equivalent_to.is_some_and(|other| other < candidate.index);
        if is_dual || bounds.iter().any(|name| candidate.model.value(name) != Some(0.0)) {
            return None;
        }
        let [_, t, u, v, w] = model.characteristic_polynomial();
        let matching = CoefficientMatching::new([t, u, v, w], model.m1_kg, model.m2_kg, Reading::Binary).ok()?;
        Some(Self { largest_mass_ratio: matching.largest_mass_ratio(), sweep: swept(&matching).ok()? })
    }
}

impl Identified {
    /// Matches the characteristic polynomial of the double model with that of an identified model, for masses in kg.
    ///
    /// Every real solution becomes a candidate, physical or not, numbered from `first_index`: a user needs to see that
    /// a set with a negative spring exists. Complex solutions and multiplicities are in [`Matched::coefficient_match`].
    /// Where a state space is known, its transformation to the coordinates of each solution tells by a second output
    /// row which solution is right; where its outputs are the motions of both masses, the total mass alone gives one
    /// more candidate. Standard deviations follow from those of the coefficients in first order.
    ///
    /// Solutions are certified to rounding by [`CoefficientMatching`]. Errors: masses that are not positive, complex
    /// poles without their conjugates, coefficients that are not finite.
    pub fn matched(
        &self,
        m1_kg: f64,
        m2_kg: f64,
        first_index: usize,
        notes: &mut Notes,
    ) -> Result<Matched, SolveError> {
        let matching = match self.quartic {
            Quartic::Coefficients(polynomial) => CoefficientMatching::new(polynomial, m1_kg, m2_kg, Reading::Binary)?,
            Quartic::Poles(poles) => CoefficientMatching::from_poles(&poles, m1_kg, m2_kg, Reading::Binary)?,
        };
        let coefficient_match = matching.solve();
        let sweep = swept(&matching)?;
        let counts = Counts::of(&coefficient_match);
        let solutions_in_words = counts.in_words();
        let Counts { real, physical, mass_ratio, largest_mass_ratio, real_roots } = counts;
        let id = self.id.clone();
        if physical > 0 {
            notes.push(MatchedSolutions { id, real, physical, mass_ratio, largest_mass_ratio });
        } else {
            notes.push(NoPhysicalSolution { id, real, mass_ratio, largest_mass_ratio, real_roots });
        }

        // Places of the real solutions among the candidates.
        let index = |solution: usize| first_index + solution;
        let mut candidates = Vec::new();
        let mut coordinates = Vec::new();
        let zeta_of_the_start = self.realised.as_ref().and_then(RealisedModel::zeta_of_the_start);
        for (place, solution) in coefficient_match.solutions.iter().enumerate().filter(|(_, s)| s.real) {
            let Some(model) = solution.model(m1_kg, m2_kg) else { continue };
            let mut remarks = vec![format!("from the {} {}: {solutions_in_words}", self.source, self.id)];
            remarks.push(numerator_remark(self.numerator.as_deref(), solution));
            remarks.push(match matching_sensitivity(&model) {
                Some(gain) => format!("1 % in one coefficient moves a parameter by up to {:.3} %", gain.amax()),
                None if [model.c1_n_s_per_m, model.c2_n_s_per_m].contains(&0.0) => at_the_border("damper"),
                None if [model.k1_n_per_m, model.k2_n_per_m].contains(&0.0) => at_the_border("spring"),
                None => "a multiple solution: a change of the coefficients moves it by its square root".to_owned(),
            });
            let uncertainty = self.spread.as_ref().and_then(|spread| spread.of_match(&model));
            match (&uncertainty, &self.spread) {
                (Some(deviations), _) => {
                    remarks.push(format!(
                        "standard deviations: {}; for the given masses, in first order",
                        deviations.method
                    ));
                }
                (None, Some(_)) => {
                    remarks.push("no standard deviations: to first order they are unbounded here".to_owned());
                }
                (None, None) => {}
            }
            if solution.dual == place {
                remarks.push(format!(
                    "its own dual, listed once: {} of the six solutions coincide here",
                    solution.multiplicity
                ));
            }
            match self.realised.as_ref().map(|realised| realised.coordinates(&model)) {
                Some(Ok(physical)) => {
                    remarks.push(coordinate_remark(&physical));
                    coordinates.push((candidates.len(), physical));
                }
                Some(Err(error)) => remarks.push(format!("no physical coordinates: {error}")),
                None => {}
            }
            let notes = remarks.into_iter().map(Note::info).collect();
            let (model, method) = (Model::DoubleSpringMassDamper(model), Method::CoefficientMatching);
            let equivalent_to = (solution.dual != place).then(|| index(solution.dual));
            candidates.push(Candidate {
                equivalent_to,
                uncertainty,
                ..Candidate::new(model, method, index(place), notes)
            });
        }
        let mut remarks = vec![solutions_in_words, format!("used: the {} {}", self.source, self.id)];
        if self.delay_s != 0.0 {
            notes.push(DelayedInput { id: self.id.clone(), delay_s: self.delay_s });
            remarks.push(delay_in_words(self.delay_s));
        }
        if let Some(zeta) = zeta_of_the_start {
            remarks.push(start_remark(zeta, &coefficient_match));
        }
        if let Some(realised) = self.realised.as_ref().filter(|realised| realised.chassis.is_some()) {
            let index = first_index + candidates.len();
            candidates.extend(from_both_masses(realised, m1_kg + m2_kg, index, &mut remarks));
        }
        Ok(Matched { coefficient_match, sweep, candidates, remarks, coordinates, zeta_of_the_start })
    }
}

/// The model that the output rows of both masses give with the total mass alone; a remark on it, or on why there is
/// none.
fn from_both_masses(
    realised: &RealisedModel,
    total_kg: f64,
    index: usize,
    remarks: &mut Vec<String>,
) -> Option<Candidate> {
    let (model, residual) = match realised.from_both_masses(total_kg) {
        Ok(model) => model?,
        Err(error) => {
            remarks.push(format!("not from the rows of both masses: {error}"));
            return None;
        }
    };
    let text = format!(
        "from the rows of both masses, with the total mass alone given: m1 = {:.2} kg, m2 = {:.2} kg; the state space \
         is a chain of two masses up to {residual:.1e}",
        model.m1_kg, model.m2_kg
    );
    remarks.push(text.clone());
    let (model, method) = (Model::DoubleSpringMassDamper(model), Method::CoefficientMatching);
    Some(Candidate::new(model, method, index, vec![Note::info(text)]))
}

/// The remark on the transformation of a state space to physical coordinates: its condition, its residual, and what
/// decides between the solutions.
fn coordinate_remark(physical: &PhysicalCoordinates) -> String {
    let decided = match physical.chassis_mismatch {
        Some(gap) => format!("the chassis sensor's row differs by {:.3} %", 100.0 * gap),
        None => {
            "every real solution has such a transformation with the same compartment output: a second sensor on the \
                 front decides"
                .to_owned()
        }
    };
    format!(
        "physical coordinates of the state space: condition {:.3e}, residual {:.1e}; {decided}",
        physical.condition, physical.residual
    )
}

/// The remark on a solution with a damper or spring of zero, which has no relative sensitivity.
fn at_the_border(what: &str) -> String {
    format!("a {what} is zero, at the border of what is physical: it has no relative sensitivity to a coefficient")
}

/// The remark on the root of the cubic that the start of a free motion implies, `c1 c2/(m1 m2)`, 1/s².
fn start_remark(zeta: f64, coefficient_match: &CoefficientMatch) -> String {
    let real = coefficient_match.roots.iter().enumerate().filter(|(_, root)| root.zeta.im == 0.0);
    let nearest = real.min_by(|(_, a), (_, b)| (a.zeta.re - zeta).abs().total_cmp(&(b.zeta.re - zeta).abs()));
    let root = nearest.map_or_else(String::new, |(place, root)| {
        format!("; the nearest real root of the cubic is {:.6} 1/s² (number {})", root.zeta.re, place + 1)
    });
    format!("the start of the motion implies c1 c2/(m1 m2) = {zeta:.6} 1/s²{root}")
}

/// The remark on a delay of the input.
fn delay_in_words(delay_s: f64) -> String {
    format!(
        "its input has a delay of {:.3} ms, which the poles do not contain: springs and dampers do not depend on it, \
         and their simulation starts at contact",
        1e3 * delay_s
    )
}

/// How many solutions are real and how many physical, and whether the mass ratio allows a physical one at all.
#[derive(Debug, Clone, Copy)]
struct Counts {
    real: usize,
    physical: usize,
    /// m2/m1.
    mass_ratio: f64,
    /// The bound of it; `None`: no masses make a solution physical.
    largest_mass_ratio: Option<f64>,
    /// Real roots of the cubic, each once.
    real_roots: usize,
}

impl Counts {
    fn of(coefficient_match: &CoefficientMatch) -> Self {
        let count = |which: &dyn Fn(&MatchedSolution) -> bool| -> usize {
            coefficient_match.solutions.iter().filter(|s| which(s)).map(|s| s.multiplicity).sum()
        };
        Self {
            real: count(&|s| s.real),
            physical: count(&|s| s.physical),
            mass_ratio: coefficient_match.m2_kg / coefficient_match.m1_kg,
            largest_mass_ratio: coefficient_match.largest_mass_ratio,
            real_roots: coefficient_match.roots.iter().filter(|root| root.zeta.im == 0.0).count(),
        }
    }

    fn in_words(self) -> String {
        let Self { real, physical, mass_ratio: ratio, .. } = self;
        let bound = match self.largest_mass_ratio {
            // Counted, not compared: at the bound itself one damper is zero and the set is still physical.
            Some(bound) if physical > 0 => format!("m2/m1 = {ratio:.4} is not above its bound {bound:.5}"),
            Some(bound) if real == 0 => {
                format!(
                    "m2/m1 = {ratio:.4} is above its bound {bound:.5}, so no parameter set with these masses is \
                     physical"
                )
            }
            Some(bound) => format!(
                "m2/m1 = {ratio:.4} is above its bound {bound:.5}, so no parameter set with these masses is physical: \
                 {}",
                match self.real_roots {
                    0 | 1 => "at the only real root of the cubic c1 c2 < 0",
                    _ if real > 2 => "at the real roots of the cubic c1 c2 < 0",
                    _ => "at the only root of the cubic with real springs and dampers c1 c2 < 0",
                }
            ),
            None => "the polynomial is not that of a passive chain of two masses, whatever the masses".to_owned(),
        };
        format!("6 solutions, {real} real, {physical} physical (springs positive, dampers not negative); {bound}")
    }
}

/// The remark on whether the zero of the identified numerator is that of `c2 s + k2`, within 5 %.
fn numerator_remark(numerator: Option<&[f64]>, solution: &MatchedSolution) -> String {
    let leading = numerator.map(|n| n.iter().skip_while(|x| **x == 0.0).copied().collect::<Vec<_>>());
    match (leading.as_deref(), solution.zero()) {
        (Some(&[slope, constant]), Some(zero)) => {
            let identified = -constant / slope;
            let agrees = (identified - zero.re).abs() <= 0.05 * zero.re.abs();
            format!(
                "zero of the identified numerator {identified:.4} 1/s, of c2 s + k2 {:.4} 1/s: {}",
                zero.re,
                if agrees {
                    "consistent"
                } else {
                    "not consistent, the force on the chassis is not the input it was made for"
                }
            )
        }
        (Some(other), _) => format!(
            "the identified numerator has degree {}, that of a force on the chassis 1: not comparable",
            other.len().saturating_sub(1)
        ),
        (None, _) => "no numerator to compare with: the poles alone do not tell the solutions apart".to_owned(),
    }
}

// Standard deviations of matched springs and dampers from those of the identified coefficients.
//
// `C_p = J C J'` with `J = dp/d(t, u, v, w)` by implicit differentiation of the four matching equations.

/// Covariance of the coefficients `t, u, v, w` of an identified denominator, in their units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoefficientSpread {
    /// Rows and columns `t, u, v, w`.
    covariance: Matrix4<f64>,
    /// Whether correlations were unknown and taken as zero.
    independent: bool,
}

impl CoefficientSpread {
    /// From their covariance, rows and columns from `t` to `w`. `None` for another shape, numbers that are not
    /// finite, or variances that are not positive.
    pub fn of_covariance(rows: &[Vec<f64>]) -> Option<Self> {
        if rows.len() != 4 || rows.iter().any(|row| row.len() != 4) {
            return None;
        }
        let covariance = Matrix4::from_fn(|i, j| rows[i][j]);
        let sound = covariance.iter().all(|x| x.is_finite()) && covariance.diagonal().iter().all(|x| *x > 0.0);
        sound.then_some(Self { covariance, independent: false })
    }

    /// From their standard deviations alone, as if independent. Coefficients of one fit are correlated, so the result
    /// can be wrong by a factor of a few either way.
    pub fn of_deviations(deviations: &[f64]) -> Option<Self> {
        let deviations = <[f64; 4]>::try_from(deviations).ok()?;
        let sound = deviations.iter().all(|d| d.is_finite() && *d > 0.0);
        let covariance = Matrix4::from_diagonal(&deviations.map(|d| d * d).into());
        sound.then_some(Self { covariance, independent: true })
    }

    /// Standard deviations of `k1, k2, c1, c2` of one solution: `J cov J'` with `J` by implicit differentiation of the
    /// four equations, for known masses.
    ///
    /// First order: good while the deviations are small beside the distance to the next solution, without bound towards
    /// a multiple one. `None` there, and where a coefficient or a damper is zero.
    pub fn of_match(&self, model: &DoubleSpringMassDamper) -> Option<Uncertainty> {
        let relative = matching_sensitivity(model)?;
        let p = [model.k1_n_per_m, model.k2_n_per_m, model.c1_n_s_per_m, model.c2_n_s_per_m];
        let coefficients = model.characteristic_polynomial();
        let jacobian = Matrix4::from_fn(|i, j| relative[(i, j)] * p[i] / coefficients[j + 1]);
        let covariance = jacobian * self.covariance * jacobian.transpose();
        let names = ["k1_n_per_m", "k2_n_per_m", "c1_n_s_per_m", "c2_n_s_per_m"];
        let standard_deviation: BTreeMap<&'static str, f64> =
            names.into_iter().zip(covariance.diagonal().iter().map(|x| x.max(0.0).sqrt())).collect();
        // With columns of one length.
        let mut scaled = relative;
        for mut column in scaled.column_iter_mut() {
            let length = column.norm();
            column.unscale_mut(length);
        }
        let values = scaled.singular_values();
        let condition = values.max() / values.min();
        let finite = condition.is_finite() && standard_deviation.values().all(|d| d.is_finite());
        finite.then_some(Uncertainty {
            method: if self.independent {
                "J cov J' from the deviations of the identified coefficients, taken as independent"
            } else {
                "J cov J' from the covariance of the identified coefficients"
            },
            standard_deviation,
            condition,
            residual_autocorrelation: None,
        })
    }
}

remarks! {
    /// Remarks of coefficient matching.
    pub REMARKS;

    /// Coefficient matching of an identified model gave physical sets of parameters.
    CR507 MatchedSolutions {
        id: String, real: usize, physical: usize, mass_ratio: f64, largest_mass_ratio: Option<f64>
    }
    bears on (About::Model(String::new()), Weight::None)
    decided "For given masses the characteristic polynomial of the double model has 6 solutions. Physical are those \
             whose springs are positive and whose dampers are not negative (docs/methods/parameter-solve.md)."
    means "Each real solution is a candidate. All of them have the poles of the identified model: the poles do not \
           tell which one is the vehicle."
    remedy "nothing; an identified model with an output of the chassis tells the solutions apart"
    says {
        let (mass_ratio, largest_mass_ratio) = (*mass_ratio, *largest_mass_ratio);
        let counts = Counts { real: *real, physical: *physical, mass_ratio, largest_mass_ratio, real_roots: 0 };
        format!("{id}: {}", counts.in_words())
    };

    /// With these masses no set of parameters has the poles of the identified model and is physical.
    CR508 NoPhysicalSolution {
        id: String, real: usize, mass_ratio: f64, largest_mass_ratio: Option<f64>, real_roots: usize
    }
    bears on (About::Model(String::new()), Weight::Slight)
    decided "Of 6 solutions those are physical whose springs are positive and whose dampers are not negative. With the \
             polynomial s^4 + t s^3 + u s^2 + v s + w every real solution is physical up to m2/m1 = \
             (t u v - v^2 - t^2 w)/v^2, and none above it (docs/methods/parameter-solve.md)."
    means "No vehicle with these masses has these poles. Real solutions, where there are any, have a negative spring \
           or damper."
    remedy "put more mass in front (front_mass_fraction) until m2/m1 is below the bound; without a bound identify \
            another model"
    says {
        let (mass_ratio, largest_mass_ratio) = (*mass_ratio, *largest_mass_ratio);
        let counts = Counts { real: *real, physical: 0, mass_ratio, largest_mass_ratio, real_roots: *real_roots };
        format!("{id}: {}", counts.in_words())
    };

    /// The input of the identified model has a delay.
    CR509 DelayedInput { id: String, delay_s: f64 }
    bears on (About::Model(String::new()), Weight::None)
    decided "The identified model states the delay of its input."
    means "Springs and dampers follow from the poles and do not depend on the delay. The simulated motion starts at \
           contact; the identified model starts later by the delay."
    remedy "nothing"
    says format!("{id}: {}", delay_in_words(*delay_s));

    /// Candidates of a paper's printed polynomial stand beside the candidates of the test.
    CR510 PrintedPolynomial {}
    bears on (About::Model(String::new()), Weight::Slight)
    decided "The run asks for them: --paper tfest."
    means "They reproduce the transfer-function paper. They say nothing about this vehicle."
    remedy "leave paper out, unless the paper is to be reproduced"
    says "the candidates of --paper tfest are those of the paper's printed polynomial, not of this test";
}
