//! The second-order difference equation that every recursive filter here runs.

pub mod second_order;
