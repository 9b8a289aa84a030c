//! Taylor series of an expression along a motion, and of its derivatives.
//!
//! Each operation has a recurrence for its next coefficient (products are convolutions; `c = exp(a)` follows from
//! `c' = c a'`, `c = ln(a)` from `a c' = a'`, a quotient from `b c = a`). So the force of an expression is as exact as
//! one of a [`Form`](crate::structure::connected_masses::Form). Derivatives by deflection, rate and parameters
//! follow from one sweep back over the operations, with series in place of numbers.
//! Griewank and Walther, "Evaluating Derivatives", 2nd ed., SIAM 2008, chapters 3 and 13.

use crate::series::step::{ORDER, Series, product};
use crate::structure::connected_masses::{Branch, Law, Strain};
use crate::structure::expression::{Expression, Operation};
use crate::structure::own_force::OwnForce;

/// An expression with the values of its parameters on one branch, and its coefficients so far.
#[derive(Debug, Clone)]
pub(crate) struct ExpressionSeries {
    operations: Vec<Operation>,
    terms: Vec<Series>,
    /// Of the parameters.
    values: Vec<f64>,
}

/// Derivatives of an expression along a motion.
#[derive(Debug, Clone)]
pub(crate) struct Partials {
    pub by_deflection: Series,
    pub by_rate: Series,
    pub by_parameter: Vec<Series>,
}

impl ExpressionSeries {
    /// That of an element on a branch, where its force is no form.
    pub fn of_element(law: &dyn Law, branch: &Branch) -> Option<Self> {
        law.as_own()?.expression(branch).map(Self::new)
    }

    /// With these parameters, and a bit for each choice.
    fn new((expression, values, choices): (&Expression, &[f64], usize)) -> Self {
        let chosen = |operation: &Operation| match *operation {
            // The side that does not hold is never read.
            Operation::Choose { test, above, below, choice } => {
                let taken = if choices >> choice & 1 == 1 { above } else { below };
                Operation::Choose { test, above: taken, below: taken, choice }
            }
            other => other,
        };
        let operations: Vec<Operation> = expression.operations.iter().map(chosen).collect();
        let terms = vec![[0.0; ORDER + 1]; operations.len()];
        Self { operations, terms, values: values.to_vec() }
    }

    /// Coefficient `k` of the force; those before it are known, and so are the first `k` of deflection and rate.
    pub fn term(&mut self, k: usize, u: &Series, w: &Series) -> f64 {
        for place in 0..self.operations.len() {
            let (before, rest) = self.terms.split_at_mut(place);
            let own = &mut rest[0];
            let at_start = |value: f64| if k == 0 { value } else { 0.0 };
            own[k] = match self.operations[place] {
                Operation::Number(number) => at_start(number),
                Operation::Parameter(p) => at_start(self.values[p]),
                Operation::Deflection => u[k],
                Operation::Rate => w[k],
                Operation::Add(a, b) => before[a][k] + before[b][k],
                Operation::Subtract(a, b) => before[a][k] - before[b][k],
                Operation::Multiply(a, b) => product(&before[a], &before[b], k),
                Operation::Divide(a, b) => {
                    let (a, b) = (&before[a], &before[b]);
                    (a[k] - (1..=k).map(|j| b[j] * own[k - j]).sum::<f64>()) / b[0]
                }
                Operation::Exponential(a) if k == 0 => before[a][0].exp(),
                Operation::Exponential(a) => {
                    (1..=k).map(|j| j as f64 * before[a][j] * own[k - j]).sum::<f64>() / k as f64
                }
                Operation::Logarithm(a) if k == 0 => before[a][0].ln(),
                Operation::Logarithm(a) => {
                    let a = &before[a];
                    let known: f64 = (1..k).map(|j| j as f64 * own[j] * a[k - j]).sum();
                    (a[k] - known / k as f64) / a[0]
                }
                Operation::Choose { above, .. } => before[above][k],
            };
        }
        self.terms.last().map_or(0.0, |terms| terms[k])
    }

    /// Derivatives of the force; all its coefficients are known.
    pub fn partials(&self) -> Partials {
        let none = [0.0; ORDER + 1];
        let mut weights = vec![none; self.operations.len()];
        if let Some(last) = weights.last_mut() {
            last[0] = 1.0;
        }
        let mut partials = Partials { by_deflection: none, by_rate: none, by_parameter: vec![none; self.values.len()] };
        for (place, operation) in self.operations.iter().enumerate().rev() {
            let weight = weights[place];
            let own = &self.terms[place];
            match *operation {
                Operation::Number(_) => {}
                Operation::Deflection => add(&mut partials.by_deflection, 1.0, &weight),
                Operation::Rate => add(&mut partials.by_rate, 1.0, &weight),
                Operation::Parameter(p) => add(&mut partials.by_parameter[p], 1.0, &weight),
                Operation::Add(a, b) => {
                    add(&mut weights[a], 1.0, &weight);
                    add(&mut weights[b], 1.0, &weight);
                }
                Operation::Subtract(a, b) => {
                    add(&mut weights[a], 1.0, &weight);
                    add(&mut weights[b], -1.0, &weight);
                }
                Operation::Multiply(a, b) => {
                    add(&mut weights[a], 1.0, &times(&weight, &self.terms[b]));
                    add(&mut weights[b], 1.0, &times(&weight, &self.terms[a]));
                }
                Operation::Divide(a, b) => {
                    let share = over(&weight, &self.terms[b]);
                    add(&mut weights[a], 1.0, &share);
                    add(&mut weights[b], -1.0, &times(&share, own));
                }
                Operation::Exponential(a) => add(&mut weights[a], 1.0, &times(&weight, own)),
                Operation::Logarithm(a) => add(&mut weights[a], 1.0, &over(&weight, &self.terms[a])),
                Operation::Choose { above, .. } => add(&mut weights[above], 1.0, &weight),
            }
        }
        partials
    }
}

/// The power of what the rate adds to a force, W, over a step of these deflections and rates.
pub(crate) fn heat(own: &OwnForce, branch: &Branch, force: &Series, u: &Series, w: &Series) -> Option<Series> {
    let mut at_rest = ExpressionSeries::new(own.at_rest(branch, u[0], w[0])?);
    let rest = [0.0; ORDER + 1];
    let added: Series = std::array::from_fn(|k| force[k] - at_rest.term(k, u, &rest));
    Some(std::array::from_fn(|k| product(&added, w, k)))
}

/// Whether a force has a series about contact at this speed, m/s.
pub(crate) fn has_series_at(own: &OwnForce, speed_m_per_s: f64) -> bool {
    let branch = own.start(Strain { w: speed_m_per_s, ..Strain::default() });
    let Some(mut series) = ExpressionSeries::of_element(own, &branch) else { return true };
    let (mut u, mut w) = ([0.0; ORDER + 1], [0.0; ORDER + 1]);
    (u[1], w[0], w[1]) = (speed_m_per_s, speed_m_per_s, 1.0);
    (0..=ORDER).all(|k| series.term(k, &u, &w).is_finite())
}

/// `sum += factor * terms`.
fn add(sum: &mut Series, factor: f64, terms: &Series) {
    sum.iter_mut().zip(terms).for_each(|(sum, term)| *sum += factor * term);
}

/// The product of two series; nothing is done for a constant that is zero throughout.
fn times(a: &Series, b: &Series) -> Series {
    if a[1..].iter().all(|term| *term == 0.0) {
        return b.map(|b| a[0] * b);
    }
    std::array::from_fn(|k| product(a, b, k))
}

/// The quotient of two series.
fn over(a: &Series, b: &Series) -> Series {
    let mut quotient = [0.0; ORDER + 1];
    for k in 0..=ORDER {
        quotient[k] = (a[k] - (1..=k).map(|j| b[j] * quotient[k - j]).sum::<f64>()) / b[0];
    }
    quotient
}
