//! How far predictions of other tests are off: cars that no family equals, tested once as a laboratory does, asked at
//! other speeds and masses through the programs. May use `programs` and `records`.

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

pub use kind::{KINDS, Kind};
pub use score::{Answer, Outcome, Prediction};
pub use table::tables;
pub use trial::outcomes;
