//! How sure a prediction is: directions of the parameters, the other models, everything else that is not known.

pub mod models;
pub mod prediction;
pub mod sources;
pub mod tested;
