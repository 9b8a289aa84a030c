//! Independent directions in which the parameters of a candidate may be off, from their covariance as measured.

use std::collections::BTreeMap;
use std::f64::consts::LN_2;

use nalgebra::{DMatrix, SymmetricEigen};

use crate::impact::candidate::Candidate;

/// Largest standard deviation along a direction, of the logarithms: a factor of 2. The record says nothing along a
/// direction that is wider, the range of vehicles does.
const WIDEST: f64 = LN_2;
/// Standard deviations of the logarithms below this move nothing.
const NOTHING: f64 = 1e-9;

/// One direction: one standard deviation of it, as factors of the parameters.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Direction {
    /// One standard deviation up, and down.
    pub ends: [BTreeMap<String, f64>; 2],
    /// Whether it is as wide as it may be, and not as wide as the record says.
    pub limited: bool,
}

/// The directions of a candidate.
#[derive(Debug, Clone, PartialEq)]
pub struct Directions(pub(crate) Vec<Direction>);

impl Directions {
    /// Principal directions of the covariance of the logarithms, `s_i = sd_i/|p_i|` with the correlations as measured,
    /// and one for each open parameter that has no deviation.
    ///
    /// A parameter at zero, the limit of what is physical, stays there: the others are conditioned on it. A direction
    /// wider than a factor of 2 is limited to it.
    pub fn of(candidate: &Candidate) -> Self {
        let Some(spread) = &candidate.spread else { return Self(Vec::new()) };
        let value = |name: &str| candidate.parameters.get(name).copied().unwrap_or(0.0);
        let deviation = |name: &str| spread.standard_deviation.get(name).copied().filter(|d| d.is_finite() && *d > 0.0);
        let rows = spread.order.iter().enumerate().filter(|(_, name)| deviation(name).is_some());
        let (at_zero, free): (Vec<_>, Vec<_>) = rows.partition(|(_, name)| value(name) == 0.0);
        let correlation = |rows: &[(usize, &String)], columns: &[(usize, &String)]| {
            DMatrix::from_fn(rows.len(), columns.len(), |i, j| {
                let (row, column) = (rows[i].0, columns[j].0);
                let stated = spread.correlation.get(row).and_then(|row| row.get(column));
                stated.copied().unwrap_or(if row == column { 1.0 } else { 0.0 })
            })
        };
        let mut covariance = correlation(&free, &free);
        if let Some(inverse) = correlation(&at_zero, &at_zero).try_inverse() {
            let across = correlation(&free, &at_zero);
            covariance -= &across * inverse * across.transpose();
        }
        let scale: Vec<f64> = free.iter().map(|(_, name)| deviation(name).unwrap_or(0.0) / value(name).abs()).collect();
        for (i, j) in (0..scale.len()).flat_map(|i| (0..scale.len()).map(move |j| (i, j))) {
            covariance[(i, j)] *= scale[i] * scale[j];
        }
        let names: Vec<&String> = free.iter().map(|(_, name)| *name).collect();
        let mut directions = principal(&names, covariance);
        let others = candidate.parameters.keys().filter(|name| {
            let is_open = spread.open.contains(name);
            value(name) != 0.0 && !names.contains(name) && (is_open || deviation(name).is_some())
        });
        for name in others {
            let known = deviation(name).map(|d| d / value(name).abs()).filter(|_| !spread.open.contains(name));
            directions.push(direction(&[name], &[1.0], known.unwrap_or(f64::INFINITY)));
        }
        Self(directions)
    }

    /// How many of them are limited.
    pub fn limited(&self) -> usize {
        self.0.iter().filter(|direction| direction.limited).count()
    }
}

fn principal(names: &[&String], covariance: DMatrix<f64>) -> Vec<Direction> {
    if names.is_empty() || covariance.iter().any(|c| !c.is_finite()) {
        return Vec::new();
    }
    let eigen = SymmetricEigen::new(covariance);
    (0..names.len())
        .map(|i| (eigen.eigenvalues[i].max(0.0).sqrt(), eigen.eigenvectors.column(i)))
        .filter(|(deviation, _)| *deviation > NOTHING)
        .map(|(deviation, along)| direction(names, along.as_slice(), deviation))
        .collect()
}

/// One standard deviation along a vector of unit length, limited.
fn direction(names: &[&String], along: &[f64], deviation: f64) -> Direction {
    let limited = deviation > WIDEST;
    let step = deviation.min(WIDEST);
    let end =
        |sign: f64| names.iter().zip(along).map(|(name, part)| ((*name).clone(), (sign * step * part).exp())).collect();
    Direction { ends: [end(1.0), end(-1.0)], limited }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::impact::candidate::ParameterSpread;

    fn kelvin(damping: f64, deviations: [f64; 2], correlation: f64) -> Candidate {
        let names = ["stiffness_n_per_m", "damping_n_s_per_m"].map(str::to_owned);
        Candidate {
            id: "kelvin/direct-fit/1".to_owned(),
            model: "kelvin".to_owned(),
            parameters: [("mass_kg", 1000.0), ("stiffness_n_per_m", 4e5), ("damping_n_s_per_m", damping)]
                .map(|(name, value)| (name.to_owned(), value))
                .into(),
            spread: Some(ParameterSpread {
                standard_deviation: names.iter().cloned().zip(deviations).collect(),
                order: names.to_vec(),
                correlation: vec![vec![1.0, correlation], vec![correlation, 1.0]],
                open: Vec::new(),
            }),
            difference: None,
        }
    }

    #[test]
    fn directions_give_the_covariance_back() {
        let directions = Directions::of(&kelvin(1e4, [2e4, 1e3], -0.8));
        assert_eq!((directions.0.len(), directions.limited()), (2, 0));
        let log = |d: &Direction, name: &str| d.ends[0][name].ln();
        let sum = |a: &str, b: &str| directions.0.iter().map(|d| log(d, a) * log(d, b)).sum::<f64>();
        let [k, c] = ["stiffness_n_per_m", "damping_n_s_per_m"];
        // (2e4/4e5)^2, (1e3/1e4)^2, -0.8 of the product of the roots.
        assert!((sum(k, k) - 2.5e-3).abs() < 1e-12 && (sum(c, c) - 1e-2).abs() < 1e-12);
        assert!((sum(k, c) + 0.8 * 5e-3).abs() < 1e-12);
        let up_and_down = &directions.0[0].ends;
        assert!((up_and_down[0][k] * up_and_down[1][k] - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_damper_at_zero_stays_and_the_spring_is_conditioned_on_it() {
        let directions = Directions::of(&kelvin(0.0, [2e4, 1e3], -0.8));
        assert_eq!(directions.0.len(), 1);
        // 0.05 sqrt(1 - 0.8^2) = 0.03.
        assert!((directions.0[0].ends[0]["stiffness_n_per_m"].ln().abs() - 0.03).abs() < 1e-12);
    }

    #[test]
    fn what_the_record_leaves_open_is_known_to_a_factor_of_2() {
        let mut open = kelvin(1e4, [2e4, 9e4], 0.0);
        let directions = Directions::of(&open);
        assert_eq!(directions.limited(), 1);
        let widest = directions.0.iter().find(|d| d.limited).unwrap();
        assert!((widest.ends[0]["damping_n_s_per_m"].ln().abs() - LN_2).abs() < 1e-9);
        let spread = open.spread.as_mut().unwrap();
        (spread.order, spread.correlation) = (Vec::new(), Vec::new());
        spread.standard_deviation.clear();
        spread.open = vec!["damping_n_s_per_m".to_owned()];
        assert_eq!(Directions::of(&open).limited(), 1);
        open.spread = None;
        assert_eq!(Directions::of(&open).0.len(), 0);
    }
}
