//! How far predictions of other tests are off: cars that no family equals, tested once as a laboratory does, asked at
//! other speeds and masses through the programs. May use `programs` and `random`.

mod car;
mod channel_class;
mod crush_curve;
mod kind;
mod motion;
mod record;
mod score;
mod table;
mod trial;

pub use kind::{KINDS, Kind};
pub use score::{Answer, Outcome, Prediction};
pub use table::tables;
pub use trial::outcomes;
