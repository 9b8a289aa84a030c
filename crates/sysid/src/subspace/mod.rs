//! Subspace identification (N4SID, MOESP, CVA), its horizon, and balanced truncation.

pub(crate) mod balanced_truncation;
pub(crate) mod horizon;
pub(crate) mod subspace;
pub(crate) mod weighting;
