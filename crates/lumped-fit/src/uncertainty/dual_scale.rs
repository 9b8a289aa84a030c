//! Uncertainties of a double model carried over to its dual.

use std::collections::BTreeMap;

use crumple_lumped::DoubleSpringMassDamper;

use crate::Propagation;

/// Names and factors that lead to the dual, which exchanges front and rear: `k1' = mu k2`, `k2' = k1/mu`, dampers
/// alike, with `mu = (m1 + m2)/m2`.
///
/// The factors depend on the masses alone. Relative deviations and intervals keep their size, and so do the results
/// of repetitions with another mass, as long as its division stays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DualScale {
    /// `(m1 + m2)/m2`.
    mu: f64,
}

impl DualScale {
    /// For a model or, with the same result, its dual.
    pub fn new(model: &DoubleSpringMassDamper) -> Self {
        Self { mu: (model.m1_kg + model.m2_kg) / model.m2_kg }
    }

    /// The parameter of the dual that follows from the one of this name, and the factor between their values.
    pub fn of(&self, name: &'static str) -> (&'static str, f64) {
        match name {
            "k1_n_per_m" => ("k2_n_per_m", 1.0 / self.mu),
            "k2_n_per_m" => ("k1_n_per_m", self.mu),
            "c1_n_s_per_m" => ("c2_n_s_per_m", 1.0 / self.mu),
            "c2_n_s_per_m" => ("c1_n_s_per_m", self.mu),
            name => (name, 1.0),
        }
    }

    /// Values by parameter, for the dual.
    pub fn values(&self, values: &BTreeMap<&'static str, f64>) -> BTreeMap<&'static str, f64> {
        let exchanged = |(name, value): (&&'static str, &f64)| {
            let (name, by) = self.of(name);
            (name, value * by)
        };
        values.iter().map(exchanged).collect()
    }

    /// The results of repetitions with uncertain inputs, for the dual.
    pub fn propagation(&self, original: &Propagation) -> Propagation {
        let exchanged = |(name, (low, high)): (&&'static str, &(f64, f64))| {
            let (name, by) = self.of(name);
            (name, (low * by, high * by))
        };
        Propagation {
            repetitions: original.repetitions,
            interval_90: original.interval_90.iter().map(exchanged).collect(),
            standard_deviation: self.values(&original.standard_deviation),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_those_of_the_dual_itself() {
        let model = DoubleSpringMassDamper {
            m1_kg: 291.0,
            m2_kg: 582.0,
            k1_n_per_m: 3e5,
            k2_n_per_m: 4e5,
            c1_n_s_per_m: 0.0,
            c2_n_s_per_m: 1500.0,
        };
        let (dual, scale) = (model.dual(), DualScale::new(&model));
        let values = [
            ("k1_n_per_m", model.k1_n_per_m),
            ("k2_n_per_m", model.k2_n_per_m),
            ("c1_n_s_per_m", model.c1_n_s_per_m),
            ("c2_n_s_per_m", model.c2_n_s_per_m),
        ];
        let dual_values = scale.values(&BTreeMap::from(values));
        let wanted = [
            ("k1_n_per_m", dual.k1_n_per_m),
            ("k2_n_per_m", dual.k2_n_per_m),
            ("c1_n_s_per_m", dual.c1_n_s_per_m),
            ("c2_n_s_per_m", dual.c2_n_s_per_m),
        ];
        for (name, value) in wanted {
            // Rounding; a damper of zero stays one.
            assert!((dual_values[name] - value).abs() <= 1e-12 * value.abs(), "{name}: {} {value}", dual_values[name]);
        }
        assert_eq!(scale, DualScale::new(&dual));
    }
}
