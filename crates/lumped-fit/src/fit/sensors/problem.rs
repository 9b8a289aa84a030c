//! Residuals of a model and several sensors, with analytic sensitivities. Filters are not known here: the motion
//! itself is compared.

use crumple_lumped::Instants;
use nalgebra::DMatrix;

use crate::FitQuantity;
use crate::free::parameterisation::{Parameterisation, places};
use crate::record::window::Window;
use crumple_estimation::minimise::levenberg_marquardt::Response;

/// A window of a sensor's record and the noise level that its residuals are divided by.
#[derive(Debug, Clone)]
pub(crate) struct SensorWindow {
    /// Index of its mass.
    pub mass: usize,
    /// What it measured.
    pub quantity: FitQuantity,
    /// The samples that are compared, in the unit of the quantity.
    pub window: Window,
    /// Noise level, unit of the quantity.
    pub noise: f64,
}

impl SensorWindow {
    /// The instants of its samples, s after contact.
    fn instants(&self) -> Instants {
        Instants { first_s: self.window.first_s, dt_s: self.window.dt_s, samples: self.window.samples.len() }
    }

    /// Root mean square of the record.
    pub fn size(&self) -> f64 {
        let square: f64 = self.window.samples.iter().map(|x| x * x).sum();
        (square / self.window.samples.len() as f64).sqrt()
    }
}

/// Residuals `(model - record)/noise` of every sensor, one after the other.
pub(crate) struct SensorProblem<'a, F> {
    /// The model with its free numbers.
    pub coordinates: &'a F,
    /// Speed of all masses at contact, m/s.
    pub impact_speed_m_per_s: f64,
    /// What it is compared with.
    pub sensors: &'a [SensorWindow],
}

impl<F: Parameterisation> SensorProblem<'_, F> {
    /// Root mean square error of each sensor, in its unit.
    pub fn rmse(&self, theta: &[f64]) -> Option<Vec<f64>> {
        let mut residuals = vec![0.0; self.rows()];
        if !self.residuals(theta, &mut residuals) {
            return None;
        }
        let mut remaining = &residuals[..];
        let rmse_of = |sensor: &SensorWindow| {
            let (residuals_of_sensor, others) = remaining.split_at(sensor.window.samples.len());
            remaining = others;
            sensor.noise
                * (residuals_of_sensor.iter().map(|r| r * r).sum::<f64>() / residuals_of_sensor.len() as f64).sqrt()
        };
        Some(self.sensors.iter().map(rmse_of).collect())
    }
}

impl<F: Parameterisation> Response for SensorProblem<'_, F> {
    /// One residual for each sample of each sensor.
    fn rows(&self) -> usize {
        self.sensors.iter().map(|sensor| sensor.window.samples.len()).sum()
    }

    /// `(model - record)/noise`, sensor after sensor, from one simulation for each sensor.
    fn residuals(&self, theta: &[f64], out: &mut [f64]) -> bool {
        let Some(model) = self.coordinates.model(theta) else { return false };
        let mut row = 0;
        for sensor in self.sensors {
            let response = self.coordinates.sensitivity(&model, self.impact_speed_m_per_s, &sensor.instants(), &[]);
            let Ok(response) = response else { return false };
            let Some(motion) = response.motions.get(sensor.mass) else { return false };
            for (x, s) in sensor.quantity.of(motion).iter().zip(&sensor.window.samples) {
                out[row] = (x - s) / sensor.noise;
                row += 1;
            }
        }
        row == out.len() && out.iter().all(|r| r.is_finite())
    }

    /// `d(model)/d(theta_j)/noise`, by the chain rule over the parameters that coordinate `j` moves.
    fn sensitivities(&self, theta: &[f64], out: &mut DMatrix<f64>) -> Option<bool> {
        let model = self.coordinates.model(theta)?;
        let derivatives = self.coordinates.derivatives_by_coordinate(theta)?;
        let places = places(&derivatives);
        let mut first = 0;
        for sensor in self.sensors {
            let at = sensor.instants();
            let response = self.coordinates.sensitivity(&model, self.impact_speed_m_per_s, &at, &places);
            let Ok(response) = response else { return Some(false) };
            for (j, by) in derivatives.iter().enumerate() {
                for k in 0..at.samples {
                    out[(first + k, j)] = 0.0;
                }
                for (place, factor) in by {
                    let Ok(p) = places.binary_search(place) else { continue };
                    let derivative = sensor.quantity.of(&response.derivatives[p][sensor.mass]);
                    for (k, d) in derivative.iter().enumerate() {
                        out[(first + k, j)] += factor * d / sensor.noise;
                    }
                }
            }
            first += at.samples;
        }
        Some(true)
    }
}
