//! A model of which some parameters are free, compared with the waves of a test, with conditions at dynamic crush.

use crumple_lumped::{Instants, Model, Motion, Nonlinear1, Place, Structure};
use crumple_numerics::estimation::minimise::levenberg_marquardt::{Bounds, Optimum, Response, descend};
use crumple_signal::{Displacement, Measurement, Signal};
use nalgebra::DMatrix;

use crate::coordinates::{Coordinates, moved_numbers};
use crate::error::{SolveError, positive};
use crate::fit::search::bounds;
use crate::record::observation::Observation;
use crate::record::sensor::FitQuantity;

/// Mass, speed, crush and window of a fit of a single mass to its displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SingleMassFitOptions {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Speed at contact, m/s: the last knot of the damper.
    pub impact_speed_m_per_s: f64,
    /// Dynamic crush, m: the last knot of the spring.
    pub crush_m: f64,
    /// Time of dynamic crush, s after contact.
    pub time_of_dynamic_crush_s: f64,
    /// Start of the window, s after contact.
    pub from_s: f64,
    /// End of the window; `None`: end of the record.
    pub to_s: Option<f64>,
    /// At most so many samples are used.
    pub samples: usize,
}

impl SingleMassFitOptions {
    /// Refuses a mass, speed, crush or time that is not positive.
    pub(crate) fn check(&self) -> Result<(), SolveError> {
        positive("mass_kg", self.mass_kg)?;
        positive("impact_speed_m_per_s", self.impact_speed_m_per_s)?;
        positive("crush_m", self.crush_m)?;
        positive("time_of_dynamic_crush_s", self.time_of_dynamic_crush_s)?;
        Ok(())
    }

    /// The samples of the window, for a search on the motion itself. Errors: a window that is not inside the record.
    pub(crate) fn observed(&self, displacement: &Signal<Displacement>) -> Result<Observation, SolveError> {
        let measurement = Measurement::of_samples(displacement);
        let to_s = self.to_s.unwrap_or(displacement.end_s());
        let (v0, window_s) = (self.impact_speed_m_per_s, (self.from_s, to_s));
        let observed = Observation::new(displacement, measurement, v0, window_s, self.samples)?;
        Ok(observed.limited(1))
    }

    /// Units of spring and damper in which a car is of size one: `m (v0/C)²`, N/m, and `m v0/C`, N s/m.
    pub(crate) fn units(&self) -> (f64, f64) {
        let rate = self.impact_speed_m_per_s / self.crush_m;
        (self.mass_kg * rate * rate, self.mass_kg * rate)
    }
}

/// The conditions with what they count in an augmented Lagrangian.
///
/// In a fit they are rows `sqrt(w) (c_j + y_j/w)`: `c` the two conditions, `w` the weight and `y` the multipliers.
/// Their square is the Lagrangian up to a constant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AtCrush {
    /// Time of dynamic crush, s.
    time_s: f64,
    /// Crush, m, and impact speed, m/s: the units of both.
    units: [f64; 2],
    /// Weight.
    pub weight: f64,
    /// Multipliers.
    pub multipliers: [f64; 2],
}

impl AtCrush {
    /// Those of a test, with weight one.
    pub fn new(options: &SingleMassFitOptions) -> Self {
        let units = [options.crush_m, options.impact_speed_m_per_s];
        Self { time_s: options.time_of_dynamic_crush_s, units, weight: 1.0, multipliers: [0.0; 2] }
    }

    /// `x(t_m)/C - 1` and `v(t_m)/v0` of the last mass, and the derivatives of both by the parameters at `places`.
    /// `None` without a response.
    pub fn conditions(&self, structure: &Structure, places: &[Place]) -> Option<([f64; 2], Vec<[f64; 2]>)> {
        let at = Instants { first_s: self.time_s, dt_s: self.time_s, samples: 1 };
        let response = structure.sensitivity(self.units[1], &at, places).ok()?;
        let in_units = |motions: &Vec<Motion>| {
            let motion = motions.last()?;
            Some([motion.displacement_m[0] / self.units[0], motion.velocity_m_per_s[0] / self.units[1]])
        };
        let [crush, speed] = in_units(&response.motions)?;
        Some(([crush - 1.0, speed], response.derivatives.iter().map(in_units).collect::<Option<_>>()?))
    }

    /// The rows of a fit, and their derivatives by the parameters at `places`.
    pub fn rows(&self, structure: &Structure, places: &[Place]) -> Option<([f64; 2], Vec<[f64; 2]>)> {
        let (conditions, derivatives) = self.conditions(structure, places)?;
        let root = self.weight.sqrt();
        let row = |j: usize| root * (conditions[j] + self.multipliers[j] / self.weight);
        Some(([row(0), row(1)], derivatives.iter().map(|by| by.map(|by| root * by)).collect()))
    }
}

impl SingleMassFitOptions {
    /// `x(t_m)/C - 1` and `v(t_m)/v0` of a model at the time of dynamic crush of the options: zero where the side
    /// conditions are met. `None` without a response.
    pub fn conditions_at_crush(&self, model: &Nonlinear1) -> Option<[f64; 2]> {
        let structure = Model::Nonlinear1(*model).structure().ok()?;
        Some(AtCrush::new(self).conditions(&structure, &[])?.0)
    }
}

/// Misfit, in parts of the largest value, that no accelerometer can tell from none: its gain is known to a hundredth.
const FINE: f64 = 1e-5;
/// Iterations of one descent at most.
const ITERATIONS: u32 = 200;
/// Relative decrease of the cost that is worth another step near a minimum: over 250 samples it moves a parameter by
/// `sqrt(250e-7)`, 0.5 % of its standard deviation.
const COST_TOLERANCE: f64 = 1e-7;
/// The same in 20 steps: of a misfit that is worth `N` samples, 1 % is `N/100` in twice the logarithm of the
/// likelihood, and a parameter moves by 0.4 of its standard deviation where `N` is 16. In a valley that the record
/// leaves open a descent creeps for hundreds of steps; the restarts across it find lower ground sooner.
pub(crate) const SLOW: f64 = 1e-2;

/// Residuals `w (model - record)/u` at every sample of every wave, wave after wave: `w` the weight of the wave, `u`
/// the largest value of the first, so that they are of size one.
///
/// The model is sampled, filtered and integrated as each wave was; where that is not known, its motion is compared.
#[derive(Debug, Clone)]
pub(crate) struct Problem<'a> {
    /// The model with its free numbers.
    pub coordinates: &'a Coordinates,
    /// The waves it is compared with.
    pub observed: &'a Observation,
    /// One unit of residual, in the unit of the first wave.
    pub unit: f64,
    /// Residual below which the model is the record.
    pub exact: f64,
    /// Conditions at dynamic crush, two rows more.
    pub at_crush: Option<AtCrush>,
    /// Whether the sensitivities are those of the motion itself, though the residuals are as measured.
    pub on_motion: bool,
}

impl<'a> Problem<'a> {
    /// The comparison of a model with these waves. A descent ends where residuals are below `exact` at every sample;
    /// 0: never for that.
    pub fn new(coordinates: &'a Coordinates, observed: &'a Observation, exact: f64) -> Self {
        Self { coordinates, observed, unit: observed.scale_m(), exact, at_crush: None, on_motion: false }
    }

    /// Weighted misfit at every sample of every wave, in the unit of the first.
    pub fn misfit(&self, theta: &[f64]) -> Option<Vec<f64>> {
        self.observed.misfit_of(&self.coordinates.structure(theta)?)
    }

    /// Root mean square misfit of every wave, in its unit.
    pub fn rmse(&self, theta: &[f64]) -> Option<Vec<f64>> {
        Some(self.observed.rmse(&self.misfit(theta)?))
    }

    /// Bounds of a descent near a minimum.
    pub fn bounds(&self) -> Bounds {
        Bounds { slow: SLOW, ..bounds(self.coordinates, ITERATIONS, COST_TOLERANCE) }
    }

    /// The same with the sensitivities of the motion itself, which cost a tenth of those as measured: filter and sums
    /// change a displacement by some 1e-5 of it, and as little of its derivatives. For a descent that says whether a
    /// minimum is worth following, or is one of many. The same where the waves are not displacements or are not known
    /// as measured.
    pub fn on_motion(&self) -> Self {
        let are_displacements = self.observed.waves.iter().all(|wave| wave.quantity == FitQuantity::Displacement);
        Self { on_motion: are_displacements && self.observed.is_as_measured(), ..self.clone() }
    }

    /// The minimum near `start`, by one descent: for the end of a fit and many repetitions of it.
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
}

impl Response for Problem<'_> {
    /// One residual for each sample of each wave, and two for the conditions where they are set.
    fn rows(&self) -> usize {
        self.observed.rows() + if self.at_crush.is_some() { 2 } else { 0 }
    }

    /// Sum of squares of a residual that counts as none.
    fn fine(&self) -> f64 {
        if self.exact > 0.0 { FINE * FINE * self.rows() as f64 } else { 0.0 }
    }

    fn exact(&self) -> f64 {
        self.exact * self.exact * self.rows() as f64
    }

    /// `w (model - record)/u`.
    fn residuals(&self, theta: &[f64], out: &mut [f64]) -> bool {
        let Some(structure) = self.coordinates.structure(theta) else { return false };
        let Some(misfit) = self.observed.misfit_of(&structure) else { return false };
        let (of_waves, of_conditions) = out.split_at_mut(misfit.len());
        for (out, misfit) in of_waves.iter_mut().zip(misfit) {
            *out = misfit / self.unit;
        }
        if let Some(at_crush) = &self.at_crush {
            let Some((rows, _)) = at_crush.rows(&structure, &[]) else { return false };
            of_conditions.copy_from_slice(&rows);
        }
        out.iter().all(|x| x.is_finite())
    }

    /// `w/u d(model)/d(theta_j)`, by the chain rule over the parameters that coordinate `j` moves.
    fn sensitivities(&self, theta: &[f64], out: &mut DMatrix<f64>) -> bool {
        let Some(structure) = self.coordinates.structure(theta) else { return false };
        let derivatives = self.coordinates.derivatives(theta);
        let moved = moved_numbers(&derivatives);
        let places = self.coordinates.places(&moved);
        let Some(by_number) = self.observed.derivatives_of(&structure, &places, self.on_motion) else { return false };
        let first = self.observed.rows();
        for (by, mut column) in derivatives.iter().zip(out.column_iter_mut()) {
            let column = &mut column.as_mut_slice()[..first];
            column.fill(0.0);
            for (number, factor) in by {
                let Ok(p) = moved.binary_search(number) else { continue };
                let factor = factor / self.unit;
                column.iter_mut().zip(&by_number[p]).for_each(|(sum, derivative)| *sum += factor * derivative);
            }
        }
        if let Some(at_crush) = &self.at_crush {
            let Some((_, by_number)) = at_crush.rows(&structure, &places) else { return false };
            for (j, by) in derivatives.iter().enumerate() {
                for row in 0..2 {
                    let part = |(number, factor): &(usize, f64)| {
                        moved.binary_search(number).map_or(0.0, |p| factor * by_number[p][row])
                    };
                    out[(first + row, j)] = by.iter().map(part).sum();
                }
            }
        }
        out.columns(0, derivatives.len()).iter().all(|x| x.is_finite())
    }
}
