//! Crash metrics: pure functions of sampled motion, one definition or one group of definitions a file.
//!
//! Everything is SI, crush and impact speed are positive towards the barrier and a frontal pulse is a negative
//! acceleration (SAE J211-1). A number comes as a [`Metric`]: with its unit, the key of its definition in
//! [`definitions::CATALOGUE`] and the part of the record it belongs to. A metric that a record does not show is a
//! [`Metric`] without a value whose definition says why; it is never a number in disguise.
//!
//! - the pulse: [`crash_events`], [`impacts`](fn@impacts), [`pulse_metrics`], [`sliding_mean`], [`olc`], [`vpi`]; of a
//!   recorder [`maximum_delta_v`], [`impacts_of_table`], [`RecordedImpact`]
//! - its shape: [`simple_pulses`], [`best_simple_pulse`]; the sled pulses of standards: [`check_sled_pulse`]
//! - the occupant: [`hic`], [`bric`], [`nij`], [`clip_contiguous`], [`clip_cumulative`], [`ride_down`]
//! - roadside hardware: [`asi`], [`thiv_phd`], [`oiv_ora`]
//! - reconstruction: [`CrushStiffness`], [`energy_equivalent_speed`]; speed from damage [`ImpactLine`],
//!   [`damage_speed()`], [`collision_speed`]
//! - two curves: [`iso18571()`], [`cora()`], [`residuals()`]; several: [`agreement`], [`over_channels`]
//!
//! ```
//! use crumple_metrics::crash_events;
//! use crumple_signal::Signal;
//!
//! // 11 m/s, stopped by 150 m/s²: C = v0²/(2a).
//! let times = (0..900).map(|k| f64::from(k) * 1e-4);
//! let velocity = Signal::new(0.0, 1e-4, times.clone().map(|t| 11.0 - 150.0 * t).collect())?;
//! let displacement = Signal::new(0.0, 1e-4, times.map(|t| 11.0 * t - 75.0 * t * t).collect())?;
//! let crush = crash_events(&velocity, &displacement)?.crush.ok_or("it stops")?;
//! assert!((crush.displacement_m - 121.0 / 300.0).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod agreement;
mod best_shift;
mod contact;
mod cora;
mod crash_events;
mod damage_speed;
mod energy;
mod error;
mod hic;
mod impacts;
mod injury;
mod iso18571;
mod metric {
    //! What a metric is: value, unit, definition, window, interval; the catalogue of definitions.

    pub mod definitions;
    pub mod value;
}
mod occupant;
mod plausibility;
mod pulse;
mod recorder;
mod restrained_occupant;
mod roadside;
mod simple_pulse;
mod sled_pulse;
mod sums;
mod two_axes;
mod two_vehicles;
mod warping;

pub use agreement::{
    Agreement, ChannelMotion, LARGEST_CRUSH_GAP, Residuals, agreement, fit_percent, over_channels, residuals, rmse,
};
pub use contact::{
    Beginning, ContactEstimate, CutRise, Onset, SMOOTHING_S, contact_edge, edr_start, end_of_force, held_crossing,
    moving_mean, onset, threshold_crossing,
};
pub use cora::{Cora, CoraInterval, CoraOptions, cora};
pub use crash_events::{
    CrashEvents, DynamicCrush, EDR_CHANGE_M_PER_S, EDR_INTERVAL_S, EventEnd, Rebound, ThresholdRule, Unstopped,
    acceleration_after_separation, crash_events, crash_events_within, event_end_by_velocity_change,
    time_zero_by_threshold, time_zero_by_velocity_change, unstopped,
};
pub use damage_speed::{
    BarrierTest, CollidedVehicle, CollisionSpeed, CrushEnergy, DamageSpeed, DamagedVehicle, ImpactLine,
    ImpactLineError, LineScatter, collision_speed, crush_by_force, damage_speed, effective_mass_share,
};
pub use energy::{
    CrushStiffness, DamageProfile, INITIAL_TO_M, KW400_FROM_M, KW400_TO_M, NO_DAMAGE_SPEED_M_PER_S, WallStiffness,
    average_height_of_force, average_stiffness, energy_equivalent_speed, wall_stiffness,
};
pub use error::MetricsError;
pub use hic::{HIC15_WINDOW_S, HIC36_WINDOW_S, hic, hic_all_pairs, hic_d, hic_d_of};
pub use impacts::{PulseImpact, first_event, impacts};
pub use injury::{Dummy, Neck, bric, nij};
pub use iso18571::{Grade, Iso18571, Iso18571Options, iso18571};
pub use metric::definitions::{self, Definition, Mark};
pub use metric::value::{Interval, IntervalBy, Metric, Window};
pub use occupant::{CLIP_3MS_S, RideDown, clip_contiguous, clip_cumulative, resultant, ride_down};
pub use plausibility::{EXCHANGES, Exchange, Impact, Plausibility, largest_restitution, number_typed, plausibility};
pub use pulse::{
    Peak, Pulse, average_square_wave, centroid_time_by_moment, centroid_time_from_crush, equivalent_square_wave,
    mean_deceleration, peak, pulse_metrics, rise_time,
};
pub use recorder::{RecordedImpact, impacts_of_table, maximum_delta_v};
pub use restrained_occupant::{OlcOptions, VpiOptions, olc, vpi};
pub use roadside::{AsiLimits, AsiMethod, FlailSpace, asi, oiv_ora, thiv_phd};
pub use simple_pulse::{SimplePulse, Wave, best_simple_pulse, simple_pulses};
pub use sled_pulse::{Demand, Excursion, LeastPeak, Measured, SLED_PULSES, SledCheck, SledPulse, check_sled_pulse};
pub use sums::{cumulative, sliding_mean};
pub use two_axes::total_and_direction;
pub use two_vehicles::{MutualCrush, TwoVehicleImpact, collision, common_velocity};
