//! Why an estimator gives no model.
//! Uses no other room.

pub(crate) mod era;
pub(crate) mod identify;
