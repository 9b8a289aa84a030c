//! What speaks for and against a model: bootstrap, comparison of models, notes for the reader.

pub(crate) mod bootstrap;
pub(crate) mod caveats;
pub(crate) mod model_selection;
pub(crate) mod residual_resampling;
