//! The second-order difference equation that every recursive filter here runs.
//! May use nothing.

pub mod second_order;
