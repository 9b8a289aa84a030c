//! Motions of a structure after an impact, with their derivatives.
//!
//! Two ways: where every force is linear for good, one matrix exponential (and its derivatives) for the step from
//! instant to instant; otherwise Taylor series from event to event. Both are right to rounding.

use crate::error::positive;
use crate::exact::linear_motion;
use crate::exact::linear_system::LinearSystem;
use crate::motion::mass_motion::Waves;
use crate::series::instants::Reader;
use crate::series::walk::walk;
use crate::structure::connected_masses::{Place, Structure};
use crate::{Drive, Instants, LumpedError, Motion, Sensitivity, Start};

impl Structure {
    /// The motion of every mass at these instants after the start, and its derivatives by the parameters at `places`,
    /// in their order. A number for a start is an impact speed, m/s.
    ///
    /// Analytic throughout: linear structures by the derivative of the matrix exponential, all others by the
    /// variational equation, solved by Taylor series along with the motion; forces are continuous at an event, so that
    /// nothing jumps there. An acceleration has a kink at an event, where one of the two one-sided derivatives is
    /// given. Errors: a place that is none, instants or a start that are not finite, a motion that leaves the range of
    /// numbers or needs more than 200,000 steps.
    pub fn sensitivity(
        &self,
        start: impl Into<Start>,
        at: &Instants,
        places: &[Place],
    ) -> Result<Sensitivity, LumpedError> {
        self.sensitivity_of(Waves::All, start, at, places)
    }

    /// The same of some waves: others may stay empty.
    pub fn sensitivity_of(
        &self,
        waves: Waves,
        start: impl Into<Start>,
        at: &Instants,
        places: &[Place],
    ) -> Result<Sensitivity, LumpedError> {
        let start = start.into();
        start.check(self.masses_kg().len())?;
        positive("dt_s", at.dt_s)?;
        self.check_places(places)?;
        let sensitivity = match LinearSystem::new(self).filter(|_| self.is_smooth_in(places)) {
            Some(system) => linear_motion::sensitivity(&system, &start, at, waves, places),
            None => self.by_series(waves, start, at, places)?,
        };
        let motions = || sensitivity.motions.iter().chain(sensitivity.derivatives.iter().flatten());
        match motions().filter_map(Motion::first_not_finite).min() {
            Some(k) => Err(LumpedError::ChainDiverges { time_s: at.first_s + k as f64 * at.dt_s }),
            None => Ok(sensitivity),
        }
    }

    /// The motion of every mass at these instants after the start. Errors: as [`sensitivity`](Self::sensitivity).
    pub fn motions_at(&self, start: impl Into<Start>, at: &Instants) -> Result<Vec<Motion>, LumpedError> {
        Ok(self.sensitivity(start, at, &[])?.motions)
    }

    /// Whether a change of these parameters leaves a linear structure linear: it does not where an element has knots
    /// whose values only happen to be equal.
    fn is_smooth_in(&self, places: &[Place]) -> bool {
        places.iter().all(|place| match place {
            Place::Element { connection, .. } => !self.connections()[*connection].element.law().has_branches(),
            _ => true,
        })
    }

    fn by_series(
        &self,
        waves: Waves,
        start: Start,
        at: &Instants,
        places: &[Place],
    ) -> Result<Sensitivity, LumpedError> {
        let zeros = || vec![Motion::zeros(at.samples, waves); self.masses_kg().len()];
        let mut motions = zeros();
        let mut derivatives: Vec<Vec<Motion>> = places.iter().map(|_| zeros()).collect();
        let mut reader = Reader::new(at);
        walk(self, &Drive::Start(start), at.dt_s, reader.end_s(), places, |step, changes| {
            let instants = reader.pass(step);
            if !instants.is_empty() {
                reader.fill_motions(step, &instants, &mut motions);
                let mut changed = Vec::with_capacity(3 * places.len());
                for (p, derivative) in derivatives.iter_mut().enumerate() {
                    for (mass, motion) in derivative.iter_mut().enumerate() {
                        let asked = motion.waves_mut().into_iter().enumerate().filter(|(_, wave)| !wave.is_empty());
                        let part =
                            |(k, wave)| (changes.series(mass, p, k), &mut Vec::as_mut_slice(wave)[instants.clone()]);
                        changed.extend(asked.map(part));
                    }
                }
                reader.fill_waves(step, &instants, changed);
            }
            reader.goes_on()
        })?;
        Ok(Sensitivity { motions, derivatives })
    }
}
