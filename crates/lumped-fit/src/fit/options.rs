//! Options of the fits of a single mass to its displacement.

use crumple_signal::{Displacement, Signal};

use crate::error::positive;
use crate::{Measurement, Observation, SolveError};

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
    /// Contact on the record's time axis, s.
    pub time_zero_s: f64,
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
        let measurement = Measurement::of_samples(displacement, self.time_zero_s);
        let to_s = self.to_s.unwrap_or(displacement.end_s() - self.time_zero_s);
        let (v0, window_s) = (self.impact_speed_m_per_s, (self.from_s, to_s));
        Observation::new(displacement, self.time_zero_s, measurement, v0, window_s, self.samples)
    }

    /// Units of spring and damper in which a car is of size one: `m (v0/C)²`, N/m, and `m v0/C`, N s/m.
    pub(crate) fn units(&self) -> (f64, f64) {
        let rate = self.impact_speed_m_per_s / self.crush_m;
        (self.mass_kg * rate * rate, self.mass_kg * rate)
    }
}
