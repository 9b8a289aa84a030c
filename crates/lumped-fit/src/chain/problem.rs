//! Residuals of a chain compared with its waves, and its fit repeated near a minimum.

use crumple_lumped::{Chain, Instants};
use nalgebra::DMatrix;

use crate::chain::coordinates::ChainCoordinates;
use crate::fit::descents::bounds;
use crate::fit::sensors::problem::{SensorProblem, SensorWindow};
use crate::free::parameterisation::{Parameterisation, places};
use crate::record::window::Window;
use crate::{Observation, ObservedWave};
use crumple_estimation::minimise::levenberg_marquardt::{Bounds, Optimum, Response, descend};

/// Iterations, and the relative decrease of the cost below which a descent ends, where a fit is repeated near its
/// minimum.
const FOLLOWING: (u32, f64) = (200, 1e-7);

/// A chain of which some numbers are free, compared with waves.
///
/// Residuals are `w (model - record)/u` at every sample of every wave: `w` the weight of the wave and `u` the largest
/// value of the first, so that they are of size one. With known measurements the model is sampled, filtered and
/// integrated as each wave was; else its motion itself is compared.
pub(crate) struct ChainProblem<'a> {
    /// The chain with its free numbers.
    pub coordinates: &'a ChainCoordinates,
    /// The waves it is compared with, and their weights.
    pub waves: &'a Observation,
    /// The windows to compare with the motion itself; `None`: through the filters.
    direct: Option<Vec<SensorWindow>>,
    /// One unit of residual, in the unit of the first wave.
    pub unit: f64,
}

/// The windows of waves for a comparison with the motion itself; `unit` is the noise level of the first.
pub(crate) fn windows(waves: &Observation, masses: usize, unit: f64) -> Vec<SensorWindow> {
    let window_of = |wave: &ObservedWave| SensorWindow {
        mass: wave.mass.unwrap_or(masses - 1),
        quantity: wave.quantity,
        window: Window {
            first_s: wave.time_s(0),
            dt_s: wave.stride as f64 * wave.measurement.dt_s,
            samples: wave.samples.clone(),
        },
        noise: unit / wave.weight,
    };
    waves.waves.iter().map(window_of).collect()
}

impl<'a> ChainProblem<'a> {
    /// `through_filter`: whether the model is compared as measured.
    pub fn new(coordinates: &'a ChainCoordinates, waves: &'a Observation, through_filter: bool) -> Self {
        let unit = waves.scale_m();
        let direct = (!through_filter).then(|| windows(waves, coordinates.masses(), unit));
        Self { coordinates, waves, direct, unit }
    }

    /// Weighted misfit at every sample of every wave, in the unit of the first.
    pub fn misfit(&self, theta: &[f64]) -> Option<Vec<f64>> {
        let mut residuals = vec![0.0; self.rows()];
        self.residuals(theta, &mut residuals).then_some(())?;
        residuals.iter_mut().for_each(|r| *r *= self.unit);
        Some(residuals)
    }

    /// Root mean square misfit of every wave, in its unit.
    pub fn levels(&self, theta: &[f64]) -> Option<Vec<f64>> {
        Some(self.waves.rmse(&self.misfit(theta)?))
    }

    /// Bounds of a descent near a minimum.
    pub fn bounds(&self) -> Bounds {
        bounds(self.coordinates, FOLLOWING.0, FOLLOWING.1)
    }

    /// The minimum near `start`.
    pub fn follow(&self, start: &[f64]) -> Option<Optimum> {
        descend(self, start, &self.bounds())
    }

    /// The minimum near `others` with coordinate number `fixed` set to `coordinate`: the other coordinates and the
    /// sum of squares, in squared units of [`Self::unit`]. `None` without a finite response.
    pub fn follow_others(&self, fixed: usize, coordinate: f64, others: &[f64]) -> Option<(Vec<f64>, f64)> {
        let mut start = others.to_vec();
        start.insert(fixed, coordinate);
        let mut limits = self.bounds();
        (limits.lower[fixed], limits.upper[fixed]) = (coordinate, coordinate);
        let mut minimum = descend(self, &start, &limits)?;
        minimum.theta.remove(fixed);
        Some((minimum.theta, minimum.cost))
    }

    /// The same comparison without filters.
    fn plain<'b>(&'b self, sensors: &'b [SensorWindow]) -> SensorProblem<'b, ChainCoordinates> {
        SensorProblem { coordinates: self.coordinates, impact_speed_m_per_s: self.waves.impact_speed_m_per_s, sensors }
    }

    /// What each wave's measurement makes of the motion of its mass (first) and of its derivatives by the parameters
    /// at `places` (then, in their order), from the first sample of the record on. `None` without a response.
    fn measured(&self, chain: &Chain, places: &[usize]) -> Option<Vec<Vec<Vec<f64>>>> {
        let v0 = self.waves.impact_speed_m_per_s;
        let last = chain.masses_kg().len() - 1;
        let measured_wave = |wave: &ObservedWave| {
            let what = (wave.mass.unwrap_or(last), wave.quantity);
            let respond = |at: &Instants| self.coordinates.sensitivity(chain, v0, at, places);
            wave.measurement.of_motions(what, v0, wave.last(), respond).ok()
        };
        self.waves.waves.iter().map(measured_wave).collect()
    }
}

impl Response for ChainProblem<'_> {
    /// One residual for each sample of each wave.
    fn rows(&self) -> usize {
        self.waves.rows()
    }

    /// `w (model - record)/unit`, wave after wave.
    fn residuals(&self, theta: &[f64], out: &mut [f64]) -> bool {
        if let Some(sensors) = &self.direct {
            return self.plain(sensors).residuals(theta, out);
        }
        let Some(chain) = self.coordinates.model(theta) else { return false };
        let Some(measured) = self.measured(&chain, &[]) else { return false };
        let mut row = 0;
        for (wave, motions) in self.waves.waves.iter().zip(&measured) {
            let picked = motions[0].get(wave.first..).unwrap_or_default().iter().step_by(wave.stride);
            for (model, record) in picked.zip(&wave.samples) {
                out[row] = (model - record) * wave.weight / self.unit;
                row += 1;
            }
        }
        row == out.len() && out.iter().all(|r| r.is_finite())
    }

    /// Derivatives by the logarithms.
    fn sensitivities(&self, theta: &[f64], out: &mut DMatrix<f64>) -> Option<bool> {
        if let Some(sensors) = &self.direct {
            return self.plain(sensors).sensitivities(theta, out);
        }
        let derivatives = self.coordinates.derivatives_by_coordinate(theta)?;
        let places = places(&derivatives);
        let Some(measured) = self.coordinates.model(theta).and_then(|model| self.measured(&model, &places)) else {
            return Some(false);
        };
        let mut first = 0;
        for (wave, motions) in self.waves.waves.iter().zip(&measured) {
            for (j, by) in derivatives.iter().enumerate() {
                for k in 0..wave.samples.len() {
                    let at = wave.first + k * wave.stride;
                    let change: Option<f64> = by
                        .iter()
                        .map(|(place, factor)| {
                            let p = places.binary_search(place).ok()?;
                            Some(factor * motions.get(p + 1)?.get(at)?)
                        })
                        .sum();
                    let Some(change) = change else { return Some(false) };
                    out[(first + k, j)] = change * wave.weight / self.unit;
                }
            }
            first += wave.samples.len();
        }
        Some(true)
    }
}
