//! A model seen through a measurement, beside the record: the common description of every fit that is judged.

use std::sync::Arc;

use crumple_lumped::{Model, ModelKind};
use crumple_signal::{Displacement, Sampled, Signal};

use nalgebra::DMatrix;

use crate::{FitQuantity, Measurement, SolveError};
use crumple_estimation::minimise::levenberg_marquardt::Response;

/// One wave of a record and where it is compared.
#[derive(Debug, Clone)]
pub struct SeenWave {
    /// Index of its mass from the barrier on; `None`: the compartment.
    pub mass: Option<usize>,
    /// What it says.
    pub quantity: FitQuantity,
    /// How it was measured.
    pub measurement: Measurement,
    /// First index of the window, on the grid of the measurement.
    pub first: usize,
    /// Distance of the samples compared.
    pub stride: usize,
    /// The wave at `first`, `first + stride`, ..., in its unit.
    pub samples: Vec<f64>,
    /// What the wave is known to at best, in its unit, see [`RESOLUTION_M`].
    pub resolution: f64,
    /// Factor of its misfit beside that of the first wave: noise level of the first over its own; 1 for the first.
    pub weight: f64,
    /// The wave as it was measured, window or not: where another time zero finds the motion at contact.
    pub(crate) record: Arc<WholeWave>,
}

/// A whole wave on its own axis.
#[derive(Debug, PartialEq)]
pub(crate) struct WholeWave {
    first_s: f64,
    dt_s: f64,
    samples: Vec<f64>,
}

impl WholeWave {
    /// Value and slope `t_s` after contact, from the parabola through the three nearest samples: off by `dt^3/16` and `dt^2/4`
    /// times the largest third derivative. `None` before the first sample; the last parabola goes on after the last.
    pub fn at(&self, t_s: f64) -> Option<(f64, f64)> {
        let place = (t_s - self.first_s) / self.dt_s;
        let last = self.samples.len().checked_sub(3)?;
        if !(place >= -1e-6 && place.is_finite()) {
            return None;
        }
        let k = ((place - 0.5).floor().max(0.0) as usize).min(last);
        let [a, b, c] = [self.samples[k], self.samples[k + 1], self.samples[k + 2]];
        let s = place - (k + 1) as f64;
        let (slope, bend) = (0.5 * (c - a), c - 2.0 * b + a);
        Some((b + s * slope + 0.5 * s * s * bend, (slope + s * bend) / self.dt_s))
    }

    /// Samples `first`, `first + stride`, ... up to `last`, counted on the grid of `measurement`; the first index there is one of.
    pub fn picked(&self, measurement: &Measurement, first: f64, last: usize, stride: usize) -> (usize, Vec<f64>) {
        let offset = ((self.first_s - measurement.first_s) / measurement.dt_s).round().max(0.0) as usize;
        let first = (first.max(0.0) as usize).max(offset);
        let end = (last + 1).saturating_sub(offset).min(self.samples.len());
        (first, self.samples[(first - offset).min(end)..end].iter().copied().step_by(stride).collect())
    }
}

/// A record and where it is compared.
///
/// Misfits of several waves stand one after the other, each times its weight: all in the unit of the first wave, which is
/// called a metre wherever it is a displacement.
#[derive(Debug, Clone)]
pub struct Observed {
    /// Speed at contact, m/s.
    pub impact_speed_m_per_s: f64,
    /// The waves; at least one.
    pub waves: Vec<SeenWave>,
}

/// Root mean square error that no displacement is believed to be free of, m.
///
/// A measurement that is repeated on the model has no error of its own; what remains is digits and what no filter
/// record tells (anti-aliasing, phase of the sampling). A tenth of a micrometre: at contact speed the distance of
/// 1e-8 s. It stands in for no error of the sensor: those are propagated.
pub const RESOLUTION_M: f64 = 1e-7;
/// The crush of which that is a share: a velocity and an acceleration are believed to the same share of their largest value.
const USUAL_CRUSH_M: f64 = 0.5;

/// A misfit below this share of the largest displacement is the exact model.
const EXACT: f64 = 1e-10;

/// Fewest samples judged.
pub(crate) const FEWEST: usize = 12;

impl SeenWave {
    /// At most `limit` samples from `from_s` to `to_s` after contact. `wave` is on the grid of the measurement, as far as it goes.
    /// Weight 1. Errors: a window that leaves the record, or fewer than 12 samples.
    pub fn new(
        wave: &Sampled,
        (mass, quantity): (Option<usize>, FitQuantity),
        time_zero_s: f64,
        measurement: Measurement,
        (from_s, to_s): (f64, f64),
        limit: usize,
    ) -> Result<Self, SolveError> {
        let dt = measurement.dt_s;
        let index = |t: f64| (t - measurement.first_s) / dt;
        // The record may start later than the acceleration: integrated from contact.
        let offset = index(wave.t0_s() - time_zero_s).round().max(0.0) as usize;
        let first = (index(from_s) - 1e-6).ceil().max(0.0) as usize;
        let last_s = wave.end_s() - time_zero_s;
        let error = SolveError::Window { from_s, to_s, first_s: wave.t0_s() - time_zero_s, last_s };
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
        let all = wave.samples();
        let end = (last + 1 - offset).min(all.len());
        let samples: Vec<f64> = all[(first - offset).min(end)..end].iter().copied().step_by(stride).collect();
        let resolution = match quantity {
            FitQuantity::Displacement => RESOLUTION_M,
            _ => RESOLUTION_M / USUAL_CRUSH_M * largest(&samples),
        };
        let first_s = wave.t0_s() - time_zero_s;
        let record = Arc::new(WholeWave { first_s, dt_s: wave.dt_s(), samples: all.to_vec() });
        Ok(Self { mass, quantity, measurement, first, stride, samples, resolution, weight: 1.0, record })
    }

    /// Index of the last sample on the grid of the measurement.
    pub fn last(&self) -> usize {
        self.first + self.stride * (self.samples.len() - 1)
    }

    /// Time of a sample that is compared, s after contact.
    pub fn time_s(&self, index: usize) -> f64 {
        self.measurement.time_s(self.first + index * self.stride)
    }

    /// Root mean square of the samples.
    pub fn size(&self) -> f64 {
        (self.samples.iter().map(|x| x * x).sum::<f64>() / self.samples.len() as f64).sqrt()
    }
}

fn largest(samples: &[f64]) -> f64 {
    samples.iter().fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()))
}

impl Observed {
    /// At most `limit` samples from `from_s` to `to_s` after contact. `displacement` is on the grid of the measurement, as
    /// far as it goes. Errors: a window that leaves the record, or fewer than 12 samples.
    pub fn new(
        displacement: &Signal<Displacement>,
        time_zero_s: f64,
        measurement: Measurement,
        impact_speed_m_per_s: f64,
        window_s: (f64, f64),
        limit: usize,
    ) -> Result<Self, SolveError> {
        let what = (None, FitQuantity::Displacement);
        let wave = SeenWave::new(displacement, what, time_zero_s, measurement, window_s, limit)?;
        Ok(Self { impact_speed_m_per_s, waves: vec![wave] })
    }

    /// Samples of all waves.
    pub fn rows(&self) -> usize {
        self.waves.iter().map(|wave| wave.samples.len()).sum()
    }

    /// Model minus record at every sample of every wave, times its weight; `None` without a finite response.
    pub fn misfit(&self, model: &Model) -> Option<Vec<f64>> {
        let mut misfit = Vec::with_capacity(self.rows());
        for wave in &self.waves {
            let v0 = self.impact_speed_m_per_s;
            let x = wave.measurement.motion(model, wave.mass, wave.quantity, v0, wave.last()).ok()?;
            let picked = x.get(wave.first..)?.iter().step_by(wave.stride);
            misfit.extend(picked.zip(&wave.samples).map(|(model, record)| (model - record) * wave.weight));
        }
        (misfit.len() == self.rows() && misfit.iter().all(|r| r.is_finite())).then_some(misfit)
    }

    /// The part of each wave of what stands one after the other.
    pub fn split<'a>(&self, rows: &'a [f64]) -> Vec<&'a [f64]> {
        let mut rest = rows;
        let of = |wave: &SeenWave| {
            let (own, others) = rest.split_at(wave.samples.len().min(rest.len()));
            rest = others;
            own
        };
        self.waves.iter().map(of).collect()
    }

    /// Root mean square misfit of every wave, in its unit.
    pub fn rmse(&self, misfit: &[f64]) -> Vec<f64> {
        let of = |(own, wave): (&[f64], &SeenWave)| {
            (own.iter().map(|r| r * r).sum::<f64>() / own.len() as f64).sqrt() / wave.weight
        };
        self.split(misfit).into_iter().zip(&self.waves).map(of).collect()
    }

    /// Samples and weighted resolution of every wave.
    pub(crate) fn blocks(&self) -> Vec<(usize, f64)> {
        self.waves.iter().map(|wave| (wave.samples.len(), wave.weight * wave.resolution)).collect()
    }

    /// Sum of squares of what no wave is believed to be free of, in units of [`Self::scale_m`].
    pub(crate) fn unresolved(&self) -> f64 {
        let unit = self.scale_m();
        self.blocks().iter().map(|(n, resolution)| *n as f64 * (resolution / unit).powi(2)).sum()
    }

    /// Largest value of the first wave: a displacement in metres, unless it is another quantity.
    pub fn scale_m(&self) -> f64 {
        self.waves.first().map_or(f64::MIN_POSITIVE, |wave| largest(&wave.samples))
    }

    /// The same record taken as unfiltered and integrated from contact: how fits that know nothing of the filter see it.
    #[must_use]
    pub fn unfiltered(mut self) -> Self {
        for wave in &mut self.waves {
            wave.measurement = Measurement { filter: None, from_contact: true, ..wave.measurement };
        }
        self
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
    /// Smallest value allowed; 0 for all but masses.
    pub lowest: f64,
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
            ((self.lowest / self.unit).ln().max(-RANGE.ln()), (self.limit / self.unit).ln().min(RANGE.ln()))
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
            FreeParameter { name, value, unit: value, scale, logarithmic: true, limit, lowest: 0.0 }.described_at(value)
        })
        .collect()
}

/// The masses but the last of a model whose total is known, each between two shares of what the masses before it leave.
pub fn free_masses(model: &Model, (lower, upper): (f64, f64)) -> Vec<FreeParameter> {
    let masses = masses_of(model);
    let mut left: f64 = masses.iter().map(|(_, kg)| kg).sum();
    let (_, but_last) = masses.split_last().unwrap_or((&("", 0.0), &[]));
    but_last
        .iter()
        .map(|&(name, value)| {
            let (limit, lowest) = (upper * left, lower * left);
            left -= value;
            FreeParameter { name, value, unit: value, scale: 0.0, logarithmic: true, limit, lowest }
        })
        .collect()
}

/// Masses of a model from the barrier on.
pub(crate) fn masses_of(model: &Model) -> Vec<(&'static str, f64)> {
    let values = model.parameters();
    let names = model.kind().parameter_names().iter();
    names.filter(|name| name.ends_with("_kg")).map(|name| (*name, values[*name])).collect()
}

/// The last mass where masses are free: the rest of the total. Its name and its value.
pub(crate) fn rest_mass(model: &Model, free: &[FreeParameter]) -> Option<(&'static str, f64)> {
    free.iter().any(|p| p.name.ends_with("_kg")).then(|| masses_of(model).pop()).flatten()
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
        self.observed.rows()
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
            let found = wave.measurement.derivatives(&model, what, v0, wave.last(), &places).ok()?;
            for (j, (parameter, theta)) in self.free.iter().zip(theta).enumerate() {
                let scale = parameter.slope(*theta) * wave.weight / self.unit_m;
                let taken = rest.filter(|_| parameter.name.ends_with("_kg")).and_then(|_| found.last());
                for (k, row) in (row..row + wave.samples.len()).enumerate() {
                    let at = wave.first + k * wave.stride;
                    let own = found[j].get(at)? - taken.map_or(Some(0.0), |of| of.get(at).copied())?;
                    out[(row, j)] = scale * own;
                }
            }
            row += wave.samples.len();
        }
        out.columns(0, self.free.len()).iter().all(|x| x.is_finite()).then_some(true)
    }
}
