//! Record: a block of a waveform.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A block of samples of one waveform. Topic `/wave/<channel id>`.
///
/// Sample i of the block is sample `first + i` of the waveform and was taken at
/// `t0_ns / 1e9 + (first + i) * dt_s` seconds; `t0_ns` and `dt_s` are equal in all blocks of a waveform.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WaveBlockV1 {
    /// Time of sample 0 of the waveform, ns from the record's time origin.
    pub t0_ns: i64,
    /// Sampling interval, s.
    pub dt_s: f64,
    /// Index of the block's first sample.
    pub first: u64,
    /// Samples in the SI unit of the channel.
    pub samples: Vec<f64>,
}
