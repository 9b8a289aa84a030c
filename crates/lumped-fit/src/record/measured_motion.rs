//! What a measurement makes of the motion of a model, and of its derivatives.

use crumple_lumped::{Instants, LumpedError, Model, Place, Structure, steps_taken};
use crumple_numerics::estimation::work::Work;
use crumple_signal::{ABREAST, Measurement};
use rayon::prelude::*;

use crate::record::sensor::{FitQuantity, motion_of, response_of};

/// What a step of a motion costs, in samples of a wave that are read off it and filtered.
const STEP: u64 = 160;

/// A response and so many derivatives over these samples, which cost work.
pub(crate) fn metered<T>(work: &Work, (samples, derivatives): (usize, usize), respond: impl FnOnce() -> T) -> T {
    let before = steps_taken();
    let response = respond();
    work.spend((1 + derivatives as u64) * (STEP * (steps_taken() - before) + samples as u64));
    response
}

/// What a measurement makes of a model. Errors: the model's own.
pub trait MeasureModel {
    /// The displacement of a model's compartment, from the first sample of the record to sample `last`.
    fn displacement(&self, model: &Model, v0_m_per_s: f64, last: usize) -> Result<Vec<f64>, LumpedError> {
        self.motion(model, None, FitQuantity::Displacement, v0_m_per_s, last)
    }

    /// The same for any mass (by its index from the barrier on; `None`: the compartment, also for an index beyond it)
    /// and quantity.
    fn motion(
        &self,
        model: &Model,
        mass: Option<usize>,
        quantity: FitQuantity,
        v0_m_per_s: f64,
        last: usize,
    ) -> Result<Vec<f64>, LumpedError> {
        self.of_structure((mass, quantity), v0_m_per_s, last, &model.structure()?)
    }

    /// The same of any structure.
    fn of_structure(
        &self,
        what: (Option<usize>, FitQuantity),
        v0_m_per_s: f64,
        last: usize,
        structure: &Structure,
    ) -> Result<Vec<f64>, LumpedError>;
}

impl MeasureModel for Measurement {
    fn of_structure(
        &self,
        (mass, quantity): (Option<usize>, FitQuantity),
        v0_m_per_s: f64,
        last: usize,
        structure: &Structure,
    ) -> Result<Vec<f64>, LumpedError> {
        let respond = |quantity, at: Instants| response_of((mass, quantity), structure, v0_m_per_s, &at, &[]);
        let Some(samples) = self.instants(last) else {
            return Ok(self.record(&[], quantity.kind(), v0_m_per_s, last));
        };
        if self.is_exact() {
            let before = self.contact_index();
            let samples = (last + 1).saturating_sub(before);
            let at = Instants { first_s: self.time_s(before).max(0.0), dt_s: self.dt_s, samples };
            let motions = respond(quantity, at)?.motions;
            let mut seen = vec![if quantity == FitQuantity::Velocity { v0_m_per_s } else { 0.0 }; before];
            seen.extend(motion_of(&motions, mass).map_or(&[][..], |motion| quantity.of(motion)));
            return Ok(seen);
        }
        let at = Instants { first_s: 0.0, dt_s: self.dt_s, samples };
        let motions = respond(quantity.recorded(), at)?.motions;
        let acceleration = motion_of(&motions, mass).map_or(&[][..], |m| &m.acceleration_m_per_s2);
        Ok(self.record(acceleration, quantity.kind(), v0_m_per_s, last))
    }
}

/// Derivatives of that by the parameters at these places: a measurement is linear, so they are the derivatives of the
/// acceleration measured without an impact speed. Not of an exact one.
pub(crate) fn derivatives(
    (measurement, work): (&Measurement, &Work),
    (mass, quantity): (Option<usize>, FitQuantity),
    v0_m_per_s: f64,
    last: usize,
    (structure, places): (&Structure, &[Place]),
) -> Result<Vec<Vec<f64>>, LumpedError> {
    let Some(samples) = measurement.instants(last) else {
        return Ok(vec![measurement.record(&[], quantity.kind(), 0.0, last); places.len()]);
    };
    let at = Instants { first_s: 0.0, dt_s: measurement.dt_s, samples };
    let of_some = |places: &[Place]| -> Result<Vec<Vec<f64>>, LumpedError> {
        let what = (mass, quantity.recorded());
        let response = response_of(what, structure, v0_m_per_s, &at, places)?;
        let motions = response.derivatives.iter().map(|motions| motion_of(motions, mass));
        let accelerations: Vec<&[f64]> =
            motions.map(|motion| motion.map_or(&[][..], |motion| &motion.acceleration_m_per_s2)).collect();
        Ok(measurement.record_all(&accelerations, quantity.kind(), last))
    };
    // In parts of equal size, on as many threads as are idle.
    let parts = places.len().div_ceil(ABREAST).max(1);
    let size = places.len().div_ceil(parts).max(1);
    let metered_part = |places| metered(work, (last + 1, <[Place]>::len(places)), || of_some(places));
    let parts: Vec<Vec<Vec<f64>>> = places.par_chunks(size).map(metered_part).collect::<Result<_, _>>()?;
    Ok(parts.into_iter().flatten().collect())
}
