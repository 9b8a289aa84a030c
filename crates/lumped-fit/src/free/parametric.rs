//! What a fit needs to know of a model: its numbers, where they stand in its structure, and the model with others.

use crumple_lumped::{Chain, Model, Place, Structure};

/// A model with numbers, those of a family or of a stated chain. Masses come first.
pub(crate) trait Parametric: Clone + Send + Sync {
    /// Its numbers, SI, in the order of [`places`](Self::places).
    fn values(&self) -> Vec<f64>;

    /// The same model with other numbers; `None` where they are not physical.
    fn with_values(&self, values: &[f64]) -> Option<Self>;

    /// The structure it is; `None` where its numbers are not physical.
    fn structure(&self) -> Option<Structure>;

    /// Where the numbers stand in the structure.
    fn places(&self) -> Vec<Place>;

    /// Numbers of size one that all models of one motion share, for a model that is not the only one with its motion.
    fn shared_by_duals(&self) -> Option<Vec<f64>> {
        None
    }
}

impl Parametric for Model {
    fn values(&self) -> Vec<f64> {
        self.values()
    }

    fn with_values(&self, values: &[f64]) -> Option<Self> {
        self.with_values(values).ok()
    }

    fn structure(&self) -> Option<Structure> {
        self.structure().ok()
    }

    fn places(&self) -> Vec<Place> {
        self.places()
    }

    /// Of a double model the four coefficients of the characteristic polynomial, the product of the dampers, a mass.
    fn shared_by_duals(&self) -> Option<Vec<f64>> {
        let Self::DoubleSpringMassDamper(model) = self else { return None };
        let [_, t, u, v, w] = model.characteristic_polynomial();
        let shared = [t, u, v, w, model.c1_n_s_per_m * model.c2_n_s_per_m, model.m1_kg];
        Some(shared.map(f64::ln).to_vec())
    }
}

impl Parametric for Chain {
    fn values(&self) -> Vec<f64> {
        self.values()
    }

    fn with_values(&self, values: &[f64]) -> Option<Self> {
        self.with_values(values).ok()
    }

    fn structure(&self) -> Option<Structure> {
        self.structure().ok()
    }

    fn places(&self) -> Vec<Place> {
        self.places()
    }
}
