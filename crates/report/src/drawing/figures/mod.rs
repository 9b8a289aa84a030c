//! What figures are made of: panels, axes, looks; and the SVG they become, on a page or as a file.

pub mod figure;
pub mod file;
pub mod look;
pub mod panel;
mod polyline;
pub mod sparkline;
mod ticks;
