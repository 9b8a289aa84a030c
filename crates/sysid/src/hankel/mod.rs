//! Hankel matrices that are multiplied without being formed, their leading singular values, and the gap between these.

pub(crate) mod block_hankel;
pub(crate) mod golub_kahan;
pub(crate) mod shift_pair;
pub(crate) mod singular_value_gap;
pub(crate) mod svd;
