//! One curve against another: ISO/TS 18571, CORA, residuals, corridors, agreement of channels.

pub mod best_shift;
pub mod channel_agreement;
pub mod cora;
pub mod corridor;
pub mod corridor_rating;
pub mod iso18571;
pub mod residuals;
