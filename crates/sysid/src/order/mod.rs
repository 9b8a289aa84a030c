//! Models of many orders: their poles, and those that stay in the stabilisation diagram.

pub(crate) mod order_scan;
pub(crate) mod stabilization;
