//! The floor of crash records: quantities, units, sampled signals, channels, the test description and notes; and the
//! one measurement chain, from a raw acceleration to the motion that stands in an artifact. No input or output.
//!
//! Inside Crumple every number is SI. A value typed by a person carries its unit
//! ([`value::Mass`], [`value::Speed`], ...); an array carries its quantity in its type
//! ([`Signal<Acceleration>`](Signal)).
//!
//! The chain: [`filter()`] removes the zero level, checks the sampling rate, runs a filter ([`Coefficients`] of a
//! class, [`TwoPassFilter`], [`Butterworth`]) and says in notes what a reader should know; [`keep_every`] and
//! [`resample`] change the rate; [`integrate`] makes the motion, [`integrate_without_drift`] one that meets a known
//! velocity. A [`Measurement`] does the same to the acceleration of a model. Axes and signs are those of SAE J211-1: x
//! points forward, a frontal pulse is a negative acceleration, the impact speed v0 is positive, and the displacement is
//! crush while the vehicle is in contact: `x'' = a`, `x'(0) = v0`, `x(0) = 0`. The impact speed comes from the test; an
//! accelerometer does not measure it. Every signal of a motion has the grid of the record; time zero is an offset on
//! its axis.
//!
//! ```
//! use crumple_signal::{Acceleration, FilterSettings, IntegrationRule, IntegrationSettings, IntegrationStart};
//! use crumple_signal::{Signal, filter, integrate};
//!
//! // 15 g for 80 ms, sampled at 10 kHz from 50 ms before contact on.
//! let pulse = |k: usize| if (500..1300).contains(&k) { -15.0 * 9.80665 } else { 0.0 };
//! let record = Signal::<Acceleration>::new(-0.05, 1e-4, (0..2000).map(pulse).collect())?;
//! let filtered = filter(&record, None, &FilterSettings::default())?;
//! let (rule, start) = (IntegrationRule::default(), IntegrationStart::default());
//! let (impact_speed_m_per_s, low_pass_filtered) = (11.0, true);
//! let settings = IntegrationSettings { rule, start, impact_speed_m_per_s, low_pass_filtered };
//! let motion = integrate(&filtered.samples.into(), &settings)?;
//! let crush = motion.displacement.samples().iter().copied().fold(0.0, f64::max);
//! // v0²/(2a) = 0.4113 m; CFC 60 rounds the edges of the pulse, which moves it by less than a millimetre.
//! assert!((crush - 0.4113_f64).abs() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Filters are linear and keep the grid: sample `k` before and after belong to the same instant `t0 + k·dt`. A
//! recursive filter has the coefficients `a0, a1, a2, b1, b2` in this order, with `+b1` and `+b2` as SAE J211-1 prints
//! them; many programs write the denominator as `1 + a1·z⁻¹ + a2·z⁻²`, their a1 and a2 are -b1 and -b2 here.
//! Definitions, and what an error of an input does to the crush: `docs/methods/cfc-filter.md`,
//! `docs/methods/integration.md`.

mod butterworth;
mod cfc;
mod channels;
mod description;
mod error;
mod filter;
pub mod iso13499;
mod measurement;
mod motion;
mod moving_start;
mod notes;
mod resampling;
mod samples;
mod summation;
mod units {
    //! Quantities, their units, values that a person types with a unit, and stated uncertainties.
    pub mod display;
    pub mod gravity;
    pub mod key_quantities;
    pub mod quantity;
    pub mod uncertain;
    pub mod unit;
    pub mod value;
}
mod zero_phase;

pub use butterworth::{Butterworth, Design, Phase, run_sections};
pub use cfc::{Cfc, CfcMode, Class, Coefficients, CorridorPoint, corridor};
pub use channels::{Axis, BARRIER, Channel, ChannelStatus};
pub use description::{
    ANOTHER_VEHICLE, BodyPart, Contact, KindOfTest, Overlap, PulseError, SIMULATED, Source, TestDescription, TestKind,
    VEHICLE_KG, criterion_of, is_mass_of_a_vehicle, is_pattern, part_of, resolve_channels,
};
pub use error::{FilterError, IntegrateError};
pub use filter::{Applied, FilterSettings, Filtered, REMARKS as FILTER_REMARKS, ZeroLevel, filter, filter_reporting};
pub use measurement::{ABREAST, BeforeEvent, Measurement};
pub use motion::{
    Drift, DriftShape, EndCondition, IntegrationSettings, IntegrationStart, KnownEnd, LateRecord, Motion, UsedStart,
    integrate, integrate_from, integrate_reporting, integrate_without_drift, without_drift,
};
pub use moving_start::{Moving, MovingStart, is_gravity, moves_before_contact, moving_start};
pub use notes::{About, ConcernContext, Kind, Note, Notes, Severity, Stated, UnknownAbout, Value, Weight};
pub use resampling::{Interpolation, Resampling, keep_every, kept, resample};
pub use samples::{PreEvent, PreEventWindow, Sampled, Signal, SignalError, coarse_step, pre_event, pre_event_within};
pub use summation::{
    IntegrationRule, REMARKS as DERIVATIVE_REMARKS, acceleration_of_velocity_change, derivative_note, integrate_twice,
    integrate_twice_into, printed_step_m_per_s,
};
pub use units::display::{self, Display};
pub use units::gravity::STANDARD_GRAVITY_M_PER_S2;
pub use units::quantity::{Acceleration, Displacement, Force, Quantity, QuantityKind, Velocity};
pub use units::uncertain::{Distribution, HALF_OF_90_PERCENT, Spread, Uncertain};
pub use units::{key_quantities, unit, value};
pub use zero_phase::{
    TwoPassFilter, filter_both_ways, filter_both_ways_into, phaseless_low_pass, samples_added, through_class,
};
