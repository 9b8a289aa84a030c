//! Bounded minimisation: Levenberg-Marquardt, variable projection, interior point, L-SHADE; and why each stopped.

pub mod interior_point;
pub mod l_shade;
pub mod levenberg_marquardt;
pub mod separable_covariance;
mod stop_reason;
pub mod variable_projection;

pub use stop_reason::StopReason;
pub use variable_projection::Stop;
