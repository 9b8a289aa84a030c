//! Cars of known parameters, recorded as a laboratory does, through the programs: how often the intervals of fitted
//! parameters hold the truth, and how often the true model is chosen. May use `programs` and `records`.

mod car;
mod choice;
mod cover;
mod family;
mod record;
mod trial;

pub use choice::{Choices, DRAWN, choices_of};
pub use cover::{Cover, Miss};
pub use family::FAMILIES;
pub use trial::{CoverError, cover_of};
