//! Cars of known parameters, recorded as a laboratory does, through the programs: how often the intervals of fitted
//! parameters hold the truth, and how often the true model is chosen.

mod car;
mod choice;
mod cover;
mod family;
mod record;
mod trial;

use crumple_lumped::{LumpedError, Model};
use crumple_numerics::estimation::random::RandomNumbers;

pub use choice::{Choices, DRAWN, Drawn, choices_of};
pub use cover::{Cover, Miss};
pub use family::FAMILIES;
pub use trial::{CoverError, cover_of};

/// A car of one of [`DRAWN`] in a test as a laboratory records it.
pub(crate) struct MadeByFamily {
    pub model: Model,
    pub mass_kg: f64,
    pub impact_speed_m_per_s: f64,
    /// Whether the mass in front has a sensor, the channel `engine`.
    pub engine: bool,
    /// The record, as CSV.
    pub csv: String,
}

/// The car of a number. Errors: those of the model.
pub(crate) fn made(drawn: &Drawn, number: usize) -> Result<MadeByFamily, LumpedError> {
    let mut random = RandomNumbers::of_stream(drawn.name.len() as u64, number);
    let car = drawn.draw.car(&mut random)?;
    let csv = record::record(&car, false, &mut random)?;
    let car::Car { model, mass_kg, impact_speed_m_per_s, engine, .. } = car;
    Ok(MadeByFamily { model, mass_kg, impact_speed_m_per_s, engine, csv })
}
