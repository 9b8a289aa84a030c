//! A model seen through a measurement, beside the record: the common description of every fit that is judged.

use crumple_lumped::{Model, ModelKind};
use crumple_signal::{Displacement, Signal};

use crate::least_squares::Response;
use crate::{Measurement, SolveError};

/// A record and where it is compared.
#[derive(Debug, Clone)]
pub struct Observed {
    /// How the displacement was measured.
    pub measurement: Measurement,
    /// Speed at contact, m/s.
    pub impact_speed_m_per_s: f64,
    /// First index of the window, on the grid of the measurement.
    pub first: usize,
    /// Distance of the samples compared.
    pub stride: usize,
    /// The displacement at `first`, `first + stride`, ..., m.
    pub displacement_m: Vec<f64>,
    /// What the displacement is known to at best, m, see [`RESOLUTION_M`].
    pub resolution_m: f64,
}

/// Root mean square error that no displacement is believed to be free of, m.
///
/// A measurement that is repeated on the model has no error of its own; what remains is digits and what no filter
/// record tells (anti-aliasing, phase of the sampling). A tenth of a micrometre: at contact speed the distance of
/// 1e-8 s. It stands in for no error of the sensor: those are propagated.
pub const RESOLUTION_M: f64 = 1e-7;

/// A misfit below this share of the largest displacement is the exact model.
const EXACT: f64 = 1e-10;

/// Fewest samples judged.
const FEWEST: usize = 12;

impl Observed {
    /// At most `limit` samples from `from_s` to `to_s` after contact. `displacement` is on the grid of the measurement, as
    /// far as it goes. Errors: a window that leaves the record, or fewer than 12 samples.
    pub fn new(
        displacement: &Signal<Displacement>,
        time_zero_s: f64,
        measurement: Measurement,
        impact_speed_m_per_s: f64,
        (from_s, to_s): (f64, f64),
        limit: usize,
    ) -> Result<Self, SolveError> {
        let dt = measurement.dt_s;
        let index = |t: f64| (t - measurement.first_s) / dt;
        // The record may start later than the acceleration: integrated from contact.
        let offset = index(displacement.t0_s() - time_zero_s).round().max(0.0) as usize;
        let first = (index(from_s) - 1e-6).ceil().max(0.0) as usize;
        let last_s = displacement.end_s() - time_zero_s;
        let error = SolveError::Window { from_s, to_s, first_s: displacement.t0_s() - time_zero_s, last_s };
        if !(from_s.is_finite() && to_s.is_finite() && from_s < to_s && to_s <= last_s + 1e-6 * dt) {
            return Err(error);
        }
        let last = (index(to_s) + 1e-6).floor().max(0.0) as usize;
        let first = first.max(offset);
        if last < first {
            return Err(error);
        }
        let count = last - first + 1;
        if count < FEWEST {
            return Err(SolveError::TooFewSamples { samples: count, from_s, to_s, needed: FEWEST });
        }
        let stride = count.div_ceil(limit.max(FEWEST));
        let samples = displacement.samples();
        let end = (last + 1 - offset).min(samples.len());
        let displacement_m = samples[(first - offset).min(end)..end].iter().copied().step_by(stride).collect();
        Ok(Self { measurement, impact_speed_m_per_s, first, stride, displacement_m, resolution_m: RESOLUTION_M })
    }

    /// Index of the last sample on the grid of the measurement.
    pub fn last(&self) -> usize {
        self.first + self.stride * (self.displacement_m.len() - 1)
    }

    /// Model minus record at every sample of the window, m; `None` without a finite response.
    pub fn misfit(&self, model: &Model) -> Option<Vec<f64>> {
        let x = self.measurement.displacement(model, self.impact_speed_m_per_s, self.last()).ok()?;
        let picked = x.get(self.first..)?.iter().step_by(self.stride);
        let misfit: Vec<f64> = picked.zip(&self.displacement_m).map(|(model, record)| model - record).collect();
        (misfit.len() == self.displacement_m.len() && misfit.iter().all(|r| r.is_finite())).then_some(misfit)
    }

    /// Largest displacement of the window, m.
    pub fn scale_m(&self) -> f64 {
        self.displacement_m.iter().fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()))
    }
}

/// One parameter that is judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeParameter {
    /// Name with unit.
    pub name: &'static str,
    /// Value where the description was made.
    pub value: f64,
    /// Unit of its coordinate: the value itself for a logarithm, the scale of its kind otherwise.
    pub unit: f64,
    /// Scale of its kind, `m (v0/C)²` for springs and `m v0/C` for dampers; 0 for knots.
    pub scale: f64,
    /// Whether the coordinate is the logarithm of the value: all but those near zero.
    pub logarithmic: bool,
    /// Largest value allowed; speeds and lengths of a curve stay inside it.
    pub limit: f64,
}

/// A spring or damper below this share of the scale of its kind is near zero: its logarithm means nothing.
const NEAR_ZERO: f64 = 0.01;
/// Springs and dampers are looked for within this factor.
const RANGE: f64 = 1e4;

impl FreeParameter {
    /// The same parameter described about another value: by its logarithm, or by its share of the scale near zero.
    pub fn described_at(&self, value: f64) -> Self {
        let logarithmic = value > NEAR_ZERO * self.scale;
        Self { value, unit: if logarithmic { value } else { self.scale }, logarithmic, ..*self }
    }

    /// The coordinate of a value.
    pub fn coordinate(&self, value: f64) -> f64 {
        if self.logarithmic { (value / self.unit).ln() } else { value / self.unit }
    }

    /// The value at a coordinate.
    pub fn at(&self, coordinate: f64) -> f64 {
        if self.logarithmic { self.unit * coordinate.exp() } else { self.unit * coordinate }
    }

    /// Smallest and largest coordinate.
    pub fn bounds(&self) -> (f64, f64) {
        if self.logarithmic {
            (-RANGE.ln(), (self.limit / self.unit).ln().min(RANGE.ln()))
        } else {
            (0.0, (self.limit / self.unit).min(RANGE))
        }
    }

    /// Derivative of the value by the coordinate.
    pub fn slope(&self, coordinate: f64) -> f64 {
        if self.logarithmic { self.at(coordinate) } else { self.unit }
    }
}

/// The springs, dampers and knots of a model that a displacement can tell, with coordinates of size one. Masses, and the end
/// knots of a nonlinear model, are given.
///
/// `crush_m` and `time_s` are those of the test; `with_unloading`: whether the window goes beyond the dynamic crush.
pub fn free_parameters(
    model: &Model,
    impact_speed_m_per_s: f64,
    crush_m: f64,
    with_unloading: bool,
) -> Vec<FreeParameter> {
    let rate = impact_speed_m_per_s / crush_m;
    let values = model.parameters();
    let mass: f64 = values.iter().filter(|(name, _)| name.ends_with("_kg")).map(|(_, value)| value).sum();
    let names = model.kind().parameter_names();
    names
        .iter()
        .filter(|name| !(name.ends_with("_kg") || **name == "crush_m" || **name == "v0_m_per_s"))
        .filter(|name| with_unloading || **name != "unloading_stiffness_n_per_m")
        .map(|&name| {
            let value = values[name];
            let knot = |last: &str| 0.999_999 * values.get(last).copied().unwrap_or(f64::INFINITY);
            let (scale, limit) = match name {
                _ if name.ends_with("_n_s_per_m") => (mass * rate, f64::INFINITY),
                _ if name.ends_with("_n_per_m") => (mass * rate * rate, f64::INFINITY),
                _ if name.ends_with("_m_per_s") => (0.0, knot("v0_m_per_s")),
                _ => (0.0, knot("crush_m")),
            };
            FreeParameter { name, value, unit: value, scale, logarithmic: true, limit }.described_at(value)
        })
        .collect()
}

/// A model of which some parameters are free, beside a record. Residuals are in units of the largest displacement.
#[derive(Debug, Clone)]
pub(crate) struct Problem<'a> {
    pub template: Model,
    pub free: Vec<FreeParameter>,
    pub observed: &'a Observed,
    /// Metres of one unit of residual.
    pub unit_m: f64,
}

impl<'a> Problem<'a> {
    pub fn new(template: Model, free: Vec<FreeParameter>, observed: &'a Observed) -> Self {
        Self { template, free, observed, unit_m: observed.scale_m() }
    }

    /// The model at a point, whatever its parameters are worth.
    pub fn model(&self, theta: &[f64]) -> Option<Model> {
        let mut values = self.template.parameters();
        for (parameter, coordinate) in self.free.iter().zip(theta) {
            *values.get_mut(parameter.name)? = parameter.at(*coordinate);
        }
        with_parameters(&self.template, &values)
    }

    /// The coordinates of the template.
    pub fn start(&self) -> Vec<f64> {
        self.free.iter().map(|p| p.coordinate(p.value)).collect()
    }
}

/// The same model with other values; `None` for values without meaning.
pub(crate) fn with_parameters(template: &Model, values: &std::collections::BTreeMap<String, f64>) -> Option<Model> {
    let kind: ModelKind = template.kind();
    let mut model = Model::from_parameters(kind, values).ok()?;
    if let (Model::Elastoplastic(new), Model::Elastoplastic(old)) = (&mut model, template) {
        new.release = old.release;
    }
    Some(model)
}

impl Response for Problem<'_> {
    fn rows(&self) -> usize {
        self.observed.displacement_m.len()
    }

    fn exact(&self) -> f64 {
        EXACT * EXACT * self.rows() as f64
    }

    fn residuals(&self, theta: &[f64], out: &mut [f64]) -> bool {
        let Some(misfit) = self.model(theta).and_then(|model| self.observed.misfit(&model)) else { return false };
        for (out, misfit) in out.iter_mut().zip(misfit) {
            *out = misfit / self.unit_m;
        }
        true
    }
}
