//! What a record does not determine, as a sentence.
//!
//! The weakest direction is the unit vector in the coordinates along which the response changes least. A step of 1 %
//! of the parameter with the largest part in it is described: how far the others move with it, and the root mean
//! square change of the response.

use crumple_lumped::ParameterKind;

use crate::FitQuantity;
use crumple_numerics::estimation::statistics::Covariance;

/// Parameters whose part of the weakest direction is below this share of the largest part are not named.
const WORTH_NAMING: f64 = 0.2;
/// A combination whose relative standard deviation is above this is called not determined.
const LOOSE: f64 = 0.5;

/// A coordinate of a fit with the name of its parameter, for that sentence.
#[derive(Debug, Clone)]
pub(crate) struct NamedCoordinate {
    /// The parameter, with its unit.
    pub name: String,
    /// What it is.
    pub kind: ParameterKind,
    /// Whether the coordinate is its logarithm.
    pub logarithmic: bool,
    /// Derivative of the parameter by the coordinate.
    pub slope: f64,
}

impl NamedCoordinate {
    /// The parameter without its unit: `k1` of `k1_n_per_m`.
    fn symbol(&self) -> String {
        self.kind.symbol_of(&self.name).replace('_', " ")
    }
}

/// The weakest direction as a sentence: which parameters can move together how far, and how little the response
/// changes then.
///
/// `quantity`: that of the sensitivities; of several waves that of the first, with the others weighted. With two
/// parameters the combination that remains determined is named too: moving `k1` by `d1` and `k2` by `d2` changes
/// nothing, so only `k1 - (d1/d2) k2` is known. `None` with fewer than two parameters.
pub(crate) fn weakest_direction(
    free: &[NamedCoordinate],
    covariance: &Covariance,
    quantity: FitQuantity,
) -> Option<String> {
    let along = &covariance.weakest;
    if free.len() < 2 || along.len() != free.len() {
        return None;
    }
    let variance = (along.transpose() * &covariance.matrix * along)[(0, 0)].max(0.0);
    let deviation = if covariance.rank < free.len() { f64::INFINITY } else { variance.sqrt() };
    let largest = along.amax();
    let mut parts: Vec<usize> = (0..free.len()).filter(|&i| along[i].abs() >= WORTH_NAMING * largest).collect();
    // Largest first; of equal ones the first.
    parts.sort_by(|&a, &b| along[b].abs().total_cmp(&along[a].abs()));
    let lead = *parts.first()?;
    let sign = along[lead].signum();
    // One percent of the leading parameter (of its scale, where the value is near zero).
    let unit = 0.01 / along[lead].abs();
    let named: Vec<String> = parts
        .iter()
        .map(|&i| {
            let suffix = if free[i].logarithmic { "" } else { " of its scale" };
            format!("{} {:+.2} %{suffix}", free[i].symbol(), 100.0 * unit * sign * along[i])
        })
        .collect();
    let moved = format!(
        "{} {} the {quantity} by only {} rms",
        named.join(", "),
        if named.len() == 1 { "moves" } else { "together move" },
        size(unit * covariance.weakest_change_m, quantity)
    );
    let determined = match parts[..] {
        [_] => format!("{} is the least determined", free[lead].symbol()),
        [a, b] if deviation > LOOSE => {
            let slope = |i: usize| along[i] * free[i].slope;
            let (first, second) = if comes_before(&free[a], &free[b], a < b) { (a, b) } else { (b, a) };
            let factor = -slope(first) / slope(second);
            let sign = if factor < 0.0 { '-' } else { '+' };
            format!("only {} {sign} {:.3} {} is determined", free[first].symbol(), factor.abs(), free[second].symbol())
        }
        _ if deviation > LOOSE => {
            let names: Vec<_> = parts.iter().map(|&i| free[i].symbol()).collect();
            format!("{} are not determined one by one", names.join(", "))
        }
        _ => "the least determined combination".to_owned(),
    };
    let width = if deviation.is_finite() {
        format!("standard deviation along it {:.2} %", 100.0 * deviation)
    } else {
        "nothing bounds it".to_owned()
    };
    Some(format!("{determined}: {moved}; {width}"))
}

/// Two parameters of one kind are ordered by name, others as in the model.
fn comes_before(a: &NamedCoordinate, b: &NamedCoordinate, in_the_model: bool) -> bool {
    if a.kind == b.kind { a.name < b.name } else { in_the_model }
}

/// A change of the response in a sentence: displacements in mm, others in the SI unit.
fn size(value: f64, quantity: FitQuantity) -> String {
    if quantity != FitQuantity::Displacement {
        return format!("{value:.2e} {}", quantity.unit());
    }
    let m = value;
    if m >= 1e-4 { format!("{:.2} mm", 1e3 * m) } else { format!("{m:.2e} m") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_numerics::estimation::statistics::covariance;
    use nalgebra::DMatrix;

    fn spring(name: &str, value: f64) -> NamedCoordinate {
        let kind = ParameterKind::Stiffness;
        NamedCoordinate { name: name.to_owned(), kind, logarithmic: true, slope: value }
    }

    #[test]
    fn two_springs_of_which_only_a_sum_acts_are_named_with_their_combination() {
        // Displacement depends on k1 + 0.9 k2, and hardly on the rest; coordinates are logarithms.
        let (k1, k2) = (3e5, 6e5);
        let j = DMatrix::from_fn(100, 2, |i, k| {
            let t = i as f64 / 100.0;
            let by_value = if k == 0 { t } else { 0.9 * t + 1e-7 * (20.0 * t).sin() };
            by_value * if k == 0 { k1 } else { k2 } * 1e-6
        });
        let noise: Vec<f64> = (0..100).map(|i| 1e-3 * (f64::from(i * i)).sin()).collect();
        let estimate = covariance(&j, &noise, 0.0).unwrap();
        let text = weakest_direction(
            &[spring("k1_n_per_m", k1), spring("k2_n_per_m", k2)],
            &estimate,
            FitQuantity::Displacement,
        )
        .unwrap();
        assert!(text.starts_with("only k1 + 0.900 k2 is determined: k1 +1.00 %, k2 -0.56 %"), "{text}");
    }
}
