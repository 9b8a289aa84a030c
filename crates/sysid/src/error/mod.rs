//! Why an estimator gives no model.

pub(crate) mod era;
pub(crate) mod identify;
