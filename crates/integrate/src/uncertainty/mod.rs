//! How far the uncertainty of the inputs moves motion, events and metrics: repetitions with perturbed inputs.

pub mod propagation;
