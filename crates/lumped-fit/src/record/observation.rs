//! Waves of a test as measured, and the misfit of a model to them.
//!
//! A model is sampled, filtered and integrated as each wave was ([`Measurement`]) before it is compared, so the
//! misfit holds what the model does not describe and not what the measurement did. Residuals of wave i are weighted
//! with `w_i = s_1/s_i`, the noise level of the first wave over its own, which puts all of them into the unit of the
//! first.

use std::borrow::Cow;
use std::sync::Arc;

use crumple_lumped::{Instants, LumpedError, Model, Motion, Place, Structure};
use crumple_numerics::estimation::work::Work;
use crumple_signal::{Displacement, Measurement, Sampled, Signal};

use crate::error::SolveError;
use crate::record::measured_motion::{MeasureModel, derivatives, metered};
use crate::record::sensor::{FitQuantity, response_of};

/// The impact that a wave is of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impact {
    /// Speed at contact, m/s.
    pub speed_m_per_s: f64,
    /// Total mass, kg: what is more or less than the model's is the compartment's; `None`: that of the model.
    pub mass_kg: Option<f64>,
}

impl Impact {
    /// A structure with the mass of the impact; `None` where nothing is left for the compartment.
    pub fn structure<'a>(&self, structure: &'a Structure) -> Option<Cow<'a, Structure>> {
        let Some(mass_kg) = self.mass_kg else { return Some(Cow::Borrowed(structure)) };
        let mut masses = structure.masses_kg().to_vec();
        let others: f64 = masses.iter().rev().skip(1).sum();
        *masses.last_mut()? = mass_kg - others;
        Structure::new(masses, structure.connections().to_vec()).ok().map(Cow::Owned)
    }
}

/// A wave of a test and the samples of it that are compared.
#[derive(Debug, Clone, PartialEq)]
pub struct ObservedWave {
    /// Index of its mass from the barrier on; that after the last is the wall. `None`: the compartment.
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
    /// What the wave is known to at best, in its unit.
    pub resolution: f64,
    /// Factor of its misfit beside that of the first wave: noise level of the first over its own; 1 for the first.
    pub weight: f64,
    /// Its noise level where that is stated, in its unit; `None`: its root mean square misfit.
    pub noise: Option<f64>,
    /// The impact it is of, where waves of several tests stand side by side; `None`: that of the observation.
    pub impact: Option<Impact>,
    /// The wave as it was measured, window or not: where another time zero finds the motion at contact.
    pub(crate) record: Arc<WholeWave>,
    /// What responses to be compared with it may cost.
    pub(crate) work: Work,
}

/// Work that one fit of a model may cost, in samples of a wave. A sample takes some 10 ns, so 2.5 s of one processor.
/// On three fixtures, a car and a record of a sled all fits take less than a hundredth of it but those of the nonlinear
/// models and of a force-deflection curve.
pub(crate) const MOST_WORK: u64 = 250_000_000;

/// A wave on its own time axis, window or not.
#[derive(Debug, PartialEq)]
pub(crate) struct WholeWave {
    /// Time of the first sample, s after contact.
    first_s: f64,
    /// Sampling interval, s.
    dt_s: f64,
    /// All samples, in the unit of the wave.
    samples: Vec<f64>,
}

impl WholeWave {
    /// Value and slope `t_s` after contact, from the parabola through the three nearest samples: off by `dt^3/16` and
    /// `dt^2/4` times the largest third derivative. `None` before the first sample; the last parabola goes on after the
    /// last.
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

    /// The same with another time zero, `late_s` later, and with values moved by their time after the old one.
    pub fn moved(&self, late_s: f64, by: impl Fn(f64, f64) -> f64) -> Self {
        let time_s = |k: usize| self.first_s + k as f64 * self.dt_s;
        let samples = self.samples.iter().enumerate().map(|(k, x)| by(time_s(k), *x)).collect();
        Self { first_s: self.first_s - late_s, dt_s: self.dt_s, samples }
    }

    /// Samples `first`, `first + stride`, ... up to `last`, counted on the grid of `measurement`; the first index there
    /// is one of.
    pub fn picked(&self, measurement: &Measurement, first: f64, last: usize, stride: usize) -> (usize, Vec<f64>) {
        let offset = ((self.first_s - measurement.first_s) / measurement.dt_s).round().max(0.0) as usize;
        let first = (first.max(0.0) as usize).max(offset);
        let end = (last + 1).saturating_sub(offset).min(self.samples.len());
        (first, self.samples[(first - offset).min(end)..end].iter().copied().step_by(stride).collect())
    }
}

/// The waves of a test that a model is compared with.
///
/// Misfits of several waves stand one after the other, each times its weight: all in the unit of the first wave.
/// Fields called `_m` are in that unit; it is a metre for a displacement.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// Speed at contact, m/s.
    pub impact_speed_m_per_s: f64,
    /// The waves; at least one.
    pub waves: Vec<ObservedWave>,
}

/// Root mean square error that no displacement is assumed to be free of, m.
///
/// The measurement is repeated on the model without error; what remains are digits and what no filter record tells,
/// such as anti-aliasing and the phase of the sampling. A tenth of a micrometre is the distance of 1e-8 s at contact
/// speed. Errors of the sensor itself are not in it: those are propagated.
pub const RESOLUTION_M: f64 = 1e-7;
/// The same where the steps between motion and record are not known: what CFC 60 does to the jump at contact.
pub const UNKNOWN_FILTER_M: f64 = 1e-5;
/// The crush of which that is a share: velocities and accelerations are assumed to be known to the same share of
/// their largest value.
const USUAL_CRUSH_M: f64 = 0.5;

/// Fewest samples of a record or wave that are compared.
pub(crate) const FEWEST: usize = 12;
/// Least noise level of a wave, as a share of its root mean square.
const LEAST_LEVEL: f64 = 1e-6;
/// The same of an accelerometer beside load cells, which have another gain: that of an accelerometer is known to 1 %,
/// and meeting it closer than that is worth nothing against the force.
const LEAST_LEVEL_BESIDE_FORCE: f64 = 0.01;

impl ObservedWave {
    /// At most `limit` samples from `from_s` to `to_s` after contact. `wave` is on the grid of the measurement, as far
    /// as it goes. Weight 1. Picking loses nothing of the comparison: a model's response is exact at any spacing.
    /// Errors: a window that leaves the record (which may begin up to one interval after `from_s`), or fewer than 12
    /// samples.
    pub fn new(
        wave: &Sampled,
        (mass, quantity): (Option<usize>, FitQuantity),
        measurement: Measurement,
        (from_s, to_s): (f64, f64),
        limit: usize,
    ) -> Result<Self, SolveError> {
        let dt = measurement.dt_s;
        let index = |t: f64| (t - measurement.first_s) / dt;
        // The record may start later than the acceleration: integrated from contact.
        let offset = index(wave.t0_s()).round().max(0.0) as usize;
        let first = (index(from_s) - 1e-6).ceil().max(0.0) as usize;
        let last_s = wave.end_s();
        let error = SolveError::Window { from_s, to_s, first_s: wave.t0_s(), last_s };
        // A record may begin up to one interval after contact.
        let late = wave.t0_s() > from_s + (1.0 + 1e-6) * dt;
        if !(from_s.is_finite() && to_s.is_finite() && 0.0 <= from_s && from_s < to_s) || late {
            return Err(error);
        }
        if to_s > last_s + 1e-6 * dt {
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
        let resolution_m = if measurement.is_exact() { UNKNOWN_FILTER_M } else { RESOLUTION_M };
        let resolution = match quantity {
            FitQuantity::Displacement => resolution_m,
            _ => resolution_m / USUAL_CRUSH_M * largest(&samples),
        };
        let first_s = wave.t0_s();
        let record = Arc::new(WholeWave { first_s, dt_s: wave.dt_s(), samples: all.to_vec() });
        let (weight, noise) = (1.0, None);
        let (impact, work) = (None, Work::default());
        Ok(Self {
            mass,
            quantity,
            measurement,
            first,
            stride,
            samples,
            resolution,
            weight,
            noise,
            impact,
            record,
            work,
        })
    }

    /// Index of the last sample on the grid of the measurement.
    pub fn last(&self) -> usize {
        self.first + self.stride * (self.samples.len() - 1)
    }

    /// Time of a sample that is compared, s after contact.
    pub fn time_s(&self, index: usize) -> f64 {
        self.measurement.time_s(self.first + index * self.stride)
    }

    /// Times of its first and its last sample that are compared, s after contact.
    pub fn window_s(&self) -> (f64, f64) {
        (self.time_s(0), self.time_s(self.samples.len() - 1))
    }

    /// The same window with every sample of the record.
    #[must_use]
    pub(crate) fn dense(&self) -> Self {
        let (first, samples) = self.record.picked(&self.measurement, self.first as f64, self.last(), 1);
        Self { first, stride: 1, samples, ..self.clone() }
    }

    /// Root mean square of the samples.
    pub fn size(&self) -> f64 {
        (self.samples.iter().map(|x| x * x).sum::<f64>() / self.samples.len() as f64).sqrt()
    }

    /// The instants of the samples, s after contact.
    pub(crate) fn instants(&self) -> Instants {
        let dt_s = self.measurement.dt_s * self.stride as f64;
        Instants { first_s: self.time_s(0).max(0.0), dt_s, samples: self.samples.len() }
    }

    /// The samples of a wave on the grid of the measurement that are compared.
    fn picked(&self, wave: &[f64]) -> Vec<f64> {
        wave.get(self.first..).unwrap_or_default().iter().step_by(self.stride).copied().collect()
    }

    /// What the measurement makes of the motion of the wave's mass, at the samples that are compared.
    pub(crate) fn response(&self, v0_m_per_s: f64, structure: &Structure) -> Result<Vec<f64>, LumpedError> {
        let what = (self.mass, self.quantity);
        if self.measurement.is_exact() {
            let respond = || response_of(what, structure, v0_m_per_s, &self.instants(), &[]);
            return Ok(self.of_motions(metered(&self.work, (self.samples.len(), 0), respond)?.motions));
        }
        let measured = || self.measurement.of_structure(what, v0_m_per_s, self.last(), structure);
        Ok(self.picked(&metered(&self.work, (self.last() + 1, 0), measured)?))
    }

    /// Its derivatives by the parameters at `places`.
    pub(crate) fn derivatives(
        &self,
        v0_m_per_s: f64,
        structure: &Structure,
        places: &[Place],
    ) -> Result<Vec<Vec<f64>>, LumpedError> {
        if self.measurement.is_exact() {
            return self.derivatives_of_motion(v0_m_per_s, structure, places);
        }
        let what = (self.mass, self.quantity);
        let all = derivatives((&self.measurement, &self.work), what, v0_m_per_s, self.last(), (structure, places))?;
        Ok(all.iter().map(|derivative| self.picked(derivative)).collect())
    }

    /// Those of the motion itself, whatever was done to it.
    pub(crate) fn derivatives_of_motion(
        &self,
        v0_m_per_s: f64,
        structure: &Structure,
        places: &[Place],
    ) -> Result<Vec<Vec<f64>>, LumpedError> {
        let what = (self.mass, self.quantity);
        let respond = || response_of(what, structure, v0_m_per_s, &self.instants(), places);
        let response = metered(&self.work, (self.samples.len(), places.len()), respond)?;
        Ok(response.derivatives.into_iter().map(|motions| self.of_motions(motions)).collect())
    }

    /// Its quantity in the motion of its mass; nothing where there is none.
    fn of_motions(&self, mut motions: Vec<Motion>) -> Vec<f64> {
        let Some(last) = motions.len().checked_sub(1) else { return Vec::new() };
        let mass = self.mass.filter(|mass| *mass < last).unwrap_or(last);
        self.quantity.taken_of(motions.swap_remove(mass))
    }
}

/// Largest magnitude, never zero.
fn largest(samples: &[f64]) -> f64 {
    samples.iter().fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()))
}

impl Observation {
    /// At most `limit` samples from `from_s` to `to_s` after contact. `displacement` is on the grid of the measurement,
    /// as far as it goes. Errors: a window that leaves the record, or fewer than 12 samples.
    pub fn new(
        displacement: &Signal<Displacement>,
        measurement: Measurement,
        impact_speed_m_per_s: f64,
        window_s: (f64, f64),
        limit: usize,
    ) -> Result<Self, SolveError> {
        let what = (None, FitQuantity::Displacement);
        let wave = ObservedWave::new(displacement, what, measurement, window_s, limit)?;
        Ok(Self { impact_speed_m_per_s, waves: vec![wave] })
    }

    /// The work that responses to be compared with all of its waves may cost.
    pub(crate) fn set_work(&mut self, work: &Work) {
        self.waves.iter_mut().for_each(|wave| wave.work = work.clone());
    }

    /// The same waves for one fit, whose work is bounded to so many times that of an ordinary one at most.
    #[must_use]
    pub fn limited(mut self, times: usize) -> Self {
        self.set_work(&Work::limited(MOST_WORK.saturating_mul(times.max(1) as u64)));
        self
    }

    /// Whether one of the waves is the force on the wall.
    fn has_wall(&self) -> bool {
        self.waves.iter().any(|wave| wave.quantity == FitQuantity::Force)
    }

    /// Samples of all waves.
    pub fn rows(&self) -> usize {
        self.waves.iter().map(|wave| wave.samples.len()).sum()
    }

    /// `w (model - record)` at every sample of every wave, in the unit of the first; `None` without a finite
    /// response.
    pub fn misfit(&self, model: &Model) -> Option<Vec<f64>> {
        self.misfit_of(&model.structure().ok()?)
    }

    /// The impact that one of its waves is of.
    pub fn impact_of(&self, wave: &ObservedWave) -> Impact {
        wave.impact.unwrap_or(Impact { speed_m_per_s: self.impact_speed_m_per_s, mass_kg: None })
    }

    /// The same of any structure; each wave is of its own impact.
    pub fn misfit_of(&self, structure: &Structure) -> Option<Vec<f64>> {
        let mut misfit = Vec::with_capacity(self.rows());
        for wave in &self.waves {
            let impact = self.impact_of(wave);
            let loaded = impact.structure(structure)?;
            let response = wave.response(impact.speed_m_per_s, &loaded).ok()?;
            misfit.extend(response.iter().zip(&wave.samples).map(|(model, record)| (model - record) * wave.weight));
        }
        (misfit.len() == self.rows() && misfit.iter().all(|r| r.is_finite())).then_some(misfit)
    }

    /// The derivatives of that by the parameters at `places`, with every weight; `on_motion`: of the motion itself,
    /// whatever was done to the waves. `None` without a finite response.
    pub(crate) fn derivatives_of(
        &self,
        structure: &Structure,
        places: &[Place],
        on_motion: bool,
    ) -> Option<Vec<Vec<f64>>> {
        let mut all = vec![Vec::with_capacity(self.rows()); places.len()];
        for wave in &self.waves {
            let impact = self.impact_of(wave);
            let loaded = impact.structure(structure)?;
            let of_wave = if on_motion {
                wave.derivatives_of_motion(impact.speed_m_per_s, &loaded, places)
            } else {
                wave.derivatives(impact.speed_m_per_s, &loaded, places)
            };
            for (all, of_wave) in all.iter_mut().zip(of_wave.ok()?) {
                all.extend(of_wave.iter().map(|derivative| derivative * wave.weight));
            }
        }
        all.iter().all(|derivative| derivative.len() == self.rows()).then_some(all)
    }

    /// Fit of the first wave, `100 (1 - |ŷ - y|/|y - ȳ|)` percent with the norms over its samples and ȳ their mean, of
    /// a misfit as [`Self::misfit_of`] gives it. `None` for a wave that is constant.
    pub fn fit_percent(&self, misfit: &[f64]) -> Option<f64> {
        let samples = &self.waves[0].samples;
        let mean = samples.iter().sum::<f64>() / samples.len() as f64;
        let norm = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>().sqrt();
        let size = norm(&mut samples.iter().map(|x| x - mean));
        let error = norm(&mut misfit.iter().take(samples.len()).map(|x| x / self.waves[0].weight));
        (size > 0.0).then(|| 100.0 * (1.0 - error / size))
    }

    /// The part of each wave in rows that stand one wave after the other.
    pub fn split<'a>(&self, rows: &'a [f64]) -> Vec<&'a [f64]> {
        let mut remaining = rows;
        let rows_of = |wave: &ObservedWave| {
            let (of_wave, others) = remaining.split_at(wave.samples.len().min(remaining.len()));
            remaining = others;
            of_wave
        };
        self.waves.iter().map(rows_of).collect()
    }

    /// Root mean square misfit of every wave, in its unit.
    pub fn rmse(&self, misfit: &[f64]) -> Vec<f64> {
        let rmse_of = |(misfit_of_wave, wave): (&[f64], &ObservedWave)| {
            (misfit_of_wave.iter().map(|r| r * r).sum::<f64>() / misfit_of_wave.len() as f64).sqrt() / wave.weight
        };
        self.split(misfit).into_iter().zip(&self.waves).map(rmse_of).collect()
    }

    /// Samples and weighted resolution of every wave.
    pub(crate) fn blocks(&self) -> Vec<(usize, f64)> {
        self.waves.iter().map(|wave| (wave.samples.len(), wave.weight * wave.resolution)).collect()
    }

    /// Sum of squares of the resolution at every sample, in squared units of [`Self::scale_m`]: a misfit below it is
    /// no misfit.
    pub(crate) fn unresolved(&self) -> f64 {
        let unit = self.scale_m();
        self.blocks().iter().map(|(n, resolution)| *n as f64 * (resolution / unit).powi(2)).sum()
    }

    /// Largest value of the first wave, the unit of the residuals in a fit.
    pub fn scale_m(&self) -> f64 {
        self.waves.first().map_or(f64::MIN_POSITIVE, |wave| largest(&wave.samples))
    }

    /// The motion itself compared, as if nothing had been done to it: what searches do.
    #[must_use]
    pub fn exact(mut self) -> Self {
        for wave in &mut self.waves {
            wave.measurement = wave.measurement.exact();
        }
        self
    }

    /// Whether the steps between the motion and every wave are known and repeated on the model.
    pub fn is_as_measured(&self) -> bool {
        self.waves.iter().all(|wave| !wave.measurement.is_exact())
    }

    /// At most `limit` samples of every wave.
    #[must_use]
    pub(crate) fn thinned(mut self, limit: usize) -> Self {
        for wave in &mut self.waves {
            let stride = wave.samples.len().div_ceil(limit);
            wave.samples = wave.samples.iter().copied().step_by(stride).collect();
            wave.stride *= stride;
        }
        self
    }

    /// The noise level of each wave, in its unit: that stated, else its root mean square misfit, at least a millionth
    /// of the wave, and of an accelerometer a hundredth where the force on the wall stands beside it.
    pub fn noise_levels(&self, rmse: &[f64]) -> Vec<f64> {
        let least = |wave: &ObservedWave| {
            let beside_force = self.has_wall() && wave.quantity != FitQuantity::Force;
            wave.size() * if beside_force { LEAST_LEVEL_BESIDE_FORCE } else { LEAST_LEVEL }
        };
        let level_of = |(wave, rmse): (&ObservedWave, &f64)| {
            wave.noise.unwrap_or_else(|| rmse.max(least(wave))).max(f64::MIN_POSITIVE)
        };
        self.waves.iter().zip(rmse).map(level_of).collect()
    }

    /// Weighs the waves by the noise levels that follow from their root mean square misfits. Whether a weight changed
    /// by more than the share `worth` of itself.
    pub fn weigh(&mut self, rmse: &[f64], worth: f64) -> bool {
        let levels = self.noise_levels(rmse);
        let mut moved = false;
        for (wave, level) in self.waves.iter_mut().zip(&levels).skip(1) {
            let weight = levels[0] / level;
            moved |= (weight / wave.weight).ln().abs() > worth;
            wave.weight = weight;
        }
        moved
    }
}

#[cfg(test)]
mod tests {
    use crumple_lumped::Kelvin;
    use crumple_numerics::estimation::work::{NotDetermined, determined};

    use super::*;

    /// The value is the time in ms.
    fn picked(from_s: f64, to_s: f64) -> Result<ObservedWave, SolveError> {
        let samples = (0..2501).map(|k| f64::from(k) * 0.1 - 50.0).collect();
        let record = Sampled::new(-0.05, 1e-4, samples).unwrap();
        let measurement = Measurement::of_samples(&record);
        let what = (None, FitQuantity::Displacement);
        ObservedWave::new(&record, what, measurement, (from_s, to_s), 250)
    }

    #[test]
    fn picks_samples_of_the_window_only() {
        let wave = picked(0.0, 0.075).unwrap();
        let Instants { first_s, dt_s, samples } = wave.instants();
        // 751 samples, every fourth.
        assert_eq!((samples, dt_s), (188, 4e-4));
        assert!(wave.samples[0].abs() < 1e-9 && first_s.abs() < 1e-12);
        assert!((wave.samples[187] - 74.8).abs() < 1e-9 && (wave.time_s(187) - 0.0748).abs() < 1e-12);
    }

    #[test]
    fn responses_cost_their_samples_for_every_derivative_and_end_at_the_limit() {
        let wave = picked(0.0, 0.075).unwrap();
        let model = Model::Kelvin(Kelvin { mass_kg: 900.0, stiffness_n_per_m: 3e5, damping_n_s_per_m: 2e3 });
        let mut observed = Observation { impact_speed_m_per_s: 10.0, waves: vec![wave] };
        let mut tries = |limit| {
            observed.set_work(&Work::limited(limit));
            determined(|| observed.misfit(&model)).map(|misfit| misfit.map(|misfit| misfit.len()))
        };
        assert_eq!(tries(10_000), Ok(Some(188)));
        assert_eq!(tries(187), Err(NotDetermined::TooMuchWork));
    }

    #[test]
    fn refuses_a_window_outside_the_record() {
        let error = picked(0.0, 0.3).unwrap_err();
        assert!(matches!(error, SolveError::Window { last_s, .. } if (last_s - 0.2).abs() < 1e-12), "{error}");
        assert!(matches!(picked(0.0, 0.001), Err(SolveError::TooFewSamples { samples: 11, .. })));
        assert!(picked(0.02, 0.01).is_err() && picked(-0.01, 0.05).is_err());
    }
}
