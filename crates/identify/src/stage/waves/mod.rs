//! The waveforms of a run: which ones, which window of them, how they are scaled.

pub mod input_output;
pub mod scaled;
pub mod source;
pub mod window;
