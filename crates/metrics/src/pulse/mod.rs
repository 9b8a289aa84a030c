//! What is read off a crash pulse and its motion: peak, mean, centroid, OLC, VPI, square waves, the list of all.

pub mod centroid;
pub mod mean;
pub mod olc;
pub mod peak;
pub mod pulse_metrics;
pub mod recorder;
pub mod square_wave;
pub mod vpi;
