//! Named waveforms of TDMS, TDM and LVM files as channels: identity, unit, time; what these formats share.
//! May use the names of columns and of ISO 13499; the readers of the three formats use it.

pub mod channel;
mod clock;
pub mod conversion;
pub mod date;
mod identity;
mod label;
mod one_axis;
mod units;
