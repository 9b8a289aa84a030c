//! How far predictions of other tests are off: cars that no family equals, tested once as a laboratory does, asked at
//! other speeds and masses through the programs.

mod car;
mod crush_curve;
mod drawing;
mod kind;
mod motion;
mod part;
mod rate_effect;
mod record;
mod score;
mod table;
mod trial;

use kind::TESTED_KM_PER_H;
pub use kind::{KINDS, Kind};
pub use score::{Answer, Outcome, Prediction};
pub use table::tables;
pub use trial::outcomes;

/// A car of a kind, that is asked what a test would show.
#[derive(Debug, Clone)]
pub struct MadeCar {
    car: car::Car,
    /// The speed of its own test, m/s.
    pub speed_m_per_s: f64,
}

/// The car of a number, with the record of its own test, as CSV.
pub(crate) fn made(kind: &Kind, number: usize) -> (String, MadeCar) {
    let (car, speed_m_per_s) = (kind.car(number), kind.speed_factor() * TESTED_KM_PER_H / 3.6);
    (record::record(&car, speed_m_per_s, 0), MadeCar { car, speed_m_per_s })
}

impl MadeCar {
    /// Crush, m, its time, s, restitution and peak behind CFC 60, m/s², of an impact at a speed, m/s, with the mass
    /// changed by a factor.
    pub fn impact(&self, speed_m_per_s: f64, mass_factor: f64) -> [f64; 4] {
        let truth = self.car.truth(speed_m_per_s, mass_factor);
        [truth.crush_m, truth.time_s, truth.restitution, truth.peak_m_per_s2]
    }

    /// Its mass, kg.
    pub fn mass_kg(&self) -> f64 {
        self.car.mass_kg()
    }
}
