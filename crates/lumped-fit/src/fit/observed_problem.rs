//! A model of which some parameters are free, compared with a record through its measurement.

use std::collections::BTreeMap;

use crumple_estimation::minimise::levenberg_marquardt::Response;
use crumple_lumped::{Model, ModelKind, ParameterKind};
use nalgebra::DMatrix;

use crate::free::free_parameter::{FreeParameter, masses_of, rest_mass};
use crate::record::observation::Observation;

/// Relative residual below which the model is exact: rounding of a response of size one through filter and
/// integration.
const EXACT: f64 = 1e-10;

/// A model of which some parameters are free, compared with an observation. Residuals are `w (model - record)` in
/// units of the largest value of the first wave; the coordinates are those of [`FreeParameter`].
#[derive(Debug, Clone)]
pub(crate) struct Problem<'a> {
    /// The model with the values of everything that is not free.
    pub template: Model,
    /// What is free, in the order of the coordinates.
    pub free: Vec<FreeParameter>,
    /// The waves it is compared with.
    pub observed: &'a Observation,
    /// Metres of one unit of residual.
    pub unit_m: f64,
}

impl<'a> Problem<'a> {
    /// The problem at the values of `template`; parameters that are not in `free` stay there.
    pub fn new(template: Model, free: Vec<FreeParameter>, observed: &'a Observation) -> Self {
        Self { template, free, observed, unit_m: observed.scale_m() }
    }

    /// The model at a point; `None` where its parameters are not physical. With free masses the last mass is the rest
    /// of the total of the template.
    pub fn model(&self, theta: &[f64]) -> Option<Model> {
        let mut values = self.template.parameters();
        for (parameter, coordinate) in self.free.iter().zip(theta) {
            *values.get_mut(parameter.name)? = parameter.at(*coordinate);
        }
        if let Some((rest, _)) = rest_mass(&self.template, &self.free) {
            // The total is known.
            let masses = masses_of(&self.template);
            let total: f64 = masses.iter().map(|(_, kg)| kg).sum();
            let others: f64 = masses.iter().filter(|(name, _)| *name != rest).map(|(name, _)| values[*name]).sum();
            *values.get_mut(rest)? = total - others;
        }
        with_parameters(&self.template, &values)
    }

    /// The coordinates of the template.
    pub fn start(&self) -> Vec<f64> {
        self.free.iter().map(|p| p.coordinate(p.value)).collect()
    }
}

/// The same model with other values by name; `None` for values without meaning. Whether an elastoplastic model leaves
/// the barrier is no parameter, and kept.
pub(crate) fn with_parameters(template: &Model, values: &BTreeMap<String, f64>) -> Option<Model> {
    let kind: ModelKind = template.kind();
    let mut model = Model::from_parameters(kind, values).ok()?;
    if let (Model::Elastoplastic(new), Model::Elastoplastic(old)) = (&mut model, template) {
        new.release = old.release;
    }
    Some(model)
}

impl Response for Problem<'_> {
    /// One residual for each sample of each wave.
    fn rows(&self) -> usize {
        self.observed.rows()
    }

    /// Sum of squares of [`EXACT`] at every sample.
    fn exact(&self) -> f64 {
        EXACT * EXACT * self.rows() as f64
    }

    /// `w (model - record)/unit`, wave after wave, through the measurement of each.
    fn residuals(&self, theta: &[f64], out: &mut [f64]) -> bool {
        let Some(misfit) = self.model(theta).and_then(|model| self.observed.misfit(&model)) else { return false };
        for (out, misfit) in out.iter_mut().zip(misfit) {
            *out = misfit / self.unit_m;
        }
        true
    }

    /// Derivatives of the measured response by each coordinate, `dp/dtheta dx/dp w/unit`; a mass that is free is
    /// taken from the last one.
    fn sensitivities(&self, theta: &[f64], out: &mut DMatrix<f64>) -> Option<bool> {
        let model = self.model(theta)?;
        let names = model.kind().parameter_names();
        let place = |name: &str| names.iter().position(|other| *other == name);
        let mut places = self.free.iter().map(|p| place(p.name)).collect::<Option<Vec<usize>>>()?;
        // A mass that is free is taken from the last one.
        let rest = rest_mass(&self.template, &self.free).and_then(|(name, _)| place(name));
        places.extend(rest);
        let v0 = self.observed.impact_speed_m_per_s;
        let mut row = 0;
        for wave in &self.observed.waves {
            let what = (wave.mass, wave.quantity);
            let derivatives = wave.measurement.derivatives(&model, what, v0, wave.last(), &places).ok()?;
            for (j, (parameter, theta)) in self.free.iter().zip(theta).enumerate() {
                let scale = parameter.slope(*theta) * wave.weight / self.unit_m;
                let taken = rest.filter(|_| parameter.kind == ParameterKind::Mass).and_then(|_| derivatives.last());
                for (k, row) in (row..row + wave.samples.len()).enumerate() {
                    let at = wave.first + k * wave.stride;
                    let derivative =
                        derivatives[j].get(at)? - taken.map_or(Some(0.0), |column| column.get(at).copied())?;
                    out[(row, j)] = scale * derivative;
                }
            }
            row += wave.samples.len();
        }
        out.columns(0, self.free.len()).iter().all(|x| x.is_finite()).then_some(true)
    }
}
