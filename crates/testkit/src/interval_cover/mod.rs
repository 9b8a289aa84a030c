//! How often the intervals of fitted parameters hold the truth: cars of known parameters, recorded as a laboratory
//! does, through the programs. May use `random`.

mod car;
mod cover;
mod family;
mod record;
mod trial;

pub use cover::Cover;
pub use family::FAMILIES;
pub use trial::{CoverError, cover_of};
