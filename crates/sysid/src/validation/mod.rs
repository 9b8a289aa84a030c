//! What speaks for a model: its noise and intervals, choices by it, and what is wrong with a record.

pub(crate) mod bootstrap;
pub(crate) mod cancellation;
pub(crate) mod caveats;
pub(crate) mod input_hold;
pub(crate) mod model_choice;
pub(crate) mod model_selection;
pub(crate) mod noise_model;
pub(crate) mod record_checks;
