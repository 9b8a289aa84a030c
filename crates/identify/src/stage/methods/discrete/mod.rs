//! Methods with sampled models between waveforms: n4sid, moesp, cva, arx, output-error, okid, fir.

pub mod arx;
pub mod dispatch;
pub mod okid_fir;
pub mod output_error;
pub mod run;
pub mod subspace;
pub mod subspace_order;
