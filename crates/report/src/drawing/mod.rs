//! What figures are made of: panels, axes, looks, views, which curves are shown at first; and the SVG they become.
//! Uses `results` and `text`.

pub mod figure;
pub mod file;
pub mod look;
pub mod panel;
pub mod shown_at_first;
mod thinning;
mod ticks;
pub mod time_view;
