//! Named waveforms of TDMS, TDM and LVM files as channels: identity, unit, time; what these formats share.

pub mod channel;
mod clock;
pub mod conversion;
pub mod date;
mod identity;
mod label;
mod one_axis;
mod units;
