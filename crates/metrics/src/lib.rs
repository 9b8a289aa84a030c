//! Crash metrics: pure functions of sampled motion, one definition or one group of definitions a file.
//!
//! Everything is SI, crush and impact speed are positive towards the barrier and a frontal pulse is a negative
//! acceleration (SAE J211-1). A number comes as a [`Metric`]: with its unit, the key of its definition in
//! [`definitions::CATALOGUE`] and the part of the record it belongs to. A metric that a record does not show is a
//! [`Metric`] without a value whose definition says why; it is never a number in disguise.
//!
//! - the pulse: [`crash_events`], [`pulse_metrics`], [`sliding_mean`], [`olc`], [`vpi`]; of a recorder
//!   [`maximum_delta_v`]
//! - the occupant: [`hic`], [`clip_contiguous`], [`clip_cumulative`], [`ride_down`]
//! - roadside hardware: [`asi`], [`thiv_phd`], [`oiv_ora`]
//! - reconstruction: [`CrushStiffness`], [`energy_equivalent_speed`]
//! - two curves: [`iso18571()`], [`cora()`], [`residuals()`]; several: [`Corridor`], [`agreement`], [`over_channels`]

mod curves;
mod energy;
mod error;
mod events;
mod metric;
mod occupant;
mod pulse;
mod roadside;
mod sums;

pub use curves::channel_agreement::{Agreement, ChannelMotion, LARGEST_CRUSH_GAP, agreement, over_channels};
pub use curves::cora::{Cora, CoraInterval, CoraOptions, cora};
pub use curves::corridor::{Corridor, CorridorOptions, CorridorResult, Excursion};
pub use curves::iso18571::rating::{Grade, Iso18571, Iso18571Options, iso18571};
pub use curves::residuals::{Residuals, fit_percent, residuals, rmse};
pub use energy::{
    CrushStiffness, DamageProfile, INITIAL_TO_M, KW400_FROM_M, KW400_TO_M, NO_DAMAGE_SPEED_M_PER_S, WallStiffness,
    average_stiffness, energy_equivalent_speed, wall_stiffness,
};
pub use error::MetricsError;
pub use events::collision::{MutualCrush, TwoVehicleImpact, collision, common_velocity};
pub use events::crash_events::{CrashEvents, DynamicCrush, Rebound, crash_events};
pub use events::plausibility::{
    EXCHANGES, Exchange, Impact, Plausibility, largest_restitution, number_typed, plausibility,
};
pub use events::separation::{acceleration_after_separation, restitution_of_two_bodies};
pub use events::time_zero::{
    EDR_INTERVAL_S, ThresholdRule, event_end_by_velocity_change, time_zero_by_threshold, time_zero_by_velocity_change,
};
pub use events::unstopped::{EventEnd, Unstopped, unstopped};
pub use metric::definitions::{self, Definition, Mark};
pub use metric::value::{Interval, IntervalBy, Metric, Window};
pub use occupant::clip::{CLIP_3MS_S, clip_contiguous, clip_cumulative};
pub use occupant::hic::{HIC15_WINDOW_S, HIC36_WINDOW_S, hic, hic_all_pairs, hic_d, hic_d_of};
pub use occupant::resultant::resultant;
pub use occupant::ride_down::{RideDown, ride_down};
pub use pulse::centroid::{centroid_time_by_moment, centroid_time_from_crush};
pub use pulse::mean::mean_deceleration;
pub use pulse::olc::{OlcOptions, olc};
pub use pulse::peak::{Peak, peak};
pub use pulse::pulse_metrics::{Pulse, pulse_metrics};
pub use pulse::recorder::maximum_delta_v;
pub use pulse::square_wave::{average_square_wave, equivalent_square_wave};
pub use pulse::vpi::{VpiOptions, vpi};
pub use roadside::asi::{AsiLimits, AsiMethod, asi};
pub use roadside::flail_space::{FlailSpace, oiv_ora, thiv_phd};
pub use sums::sliding_mean;
