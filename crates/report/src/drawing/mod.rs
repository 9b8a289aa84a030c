//! What figures are made of: traces, axes, colours, views, which curves are shown at first.
//! Uses `results`.

pub mod figure;
pub mod shown_at_first;
pub mod time_view;
