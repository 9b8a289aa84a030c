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
//! Filters are linear and return as many samples as they are given: sample `k` before and after belong to the same
//! instant `t0 + k·dt`. Every recursive filter is a chain of second-order difference equations whose coefficients are
//! `a0, a1, a2, b1, b2` in this order, with `+b1` and `+b2` as SAE J211-1 prints them. Many programs write the
//! denominator as `1 + a1·z⁻¹ + a2·z⁻²`: their a1 and a2 are -b1 and -b2 here. Without phase means: the pass forward is
//! followed by the same pass backward in time. The gains multiply, the delays cancel, and events keep their times. The
//! price is that a jump is spread to both sides of its place: at CFC 60 a step has 1 % of its height 7 ms and 0.1 % of
//! it 11 ms before it.
//!
//! What an error of an input does to the crush C at the time t_m of dynamic crush, to first order:
//!
//! | input | effect on C | barrier test at 57 km/h |
//! |---|---|---|
//! | impact speed, 0.1 km/h | `t_m·δv0` | 2 mm |
//! | zero level, 0.05 g | `t_m²·δb/2`; started τ earlier `δb·(t_m²/2 + τ·t_m)` | 1.3 mm |
//! | gain, 1 % | `δg·(v0·t_m - C)` | 4 mm |
//! | time zero, 0.5 ms | `v0·δt` | 8 mm |
//!
//! The rule of summation is smaller than any of them: below 0.01 mm for the trapezoid at 10 kHz. Definitions and how
//! sure they are: `docs/methods/cfc-filter.md`, `docs/methods/integration.md`.

mod butterworth;
mod cfc;
mod channels;
mod description;
mod error;
mod filter;
pub mod iso13499;
mod measurement;
mod motion;
mod notes;
mod resampling;
mod samples;
mod summation;
mod units {
    //! Quantities, their units, values that a person types with a unit, and stated uncertainties.
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
pub use channels::{Axis, Channel, ChannelStatus};
pub use description::{
    ANOTHER_VEHICLE, BodyPart, PulseError, Source, TestDescription, is_pattern, part_of, resolve_channels,
};
pub use error::{FilterError, IntegrateError};
pub use filter::{Applied, FilterSettings, Filtered, ZeroLevel, filter, filter_reporting};
pub use measurement::{ABREAST, BeforeEvent, Measurement};
pub use motion::{
    Drift, DriftShape, EndCondition, IntegrationSettings, IntegrationStart, LateRecord, Motion, UsedStart, integrate,
    integrate_from, integrate_reporting, integrate_without_drift, without_drift,
};
pub use notes::{About, ConcernContext, Note, Notes, Severity, UnknownAbout, Weight};
pub use resampling::{Interpolation, Resampling, keep_every, kept, resample};
pub use samples::{
    FreeFall, PreEvent, PreEventWindow, Sampled, Signal, SignalError, falls_before_event, free_fall, is_gravity,
    pre_event,
};
pub use summation::{
    IntegrationRule, acceleration_of_velocity_change, derivative_note, integrate_twice, integrate_twice_into,
};
pub use units::gravity::STANDARD_GRAVITY_M_PER_S2;
pub use units::quantity::{Acceleration, Displacement, Force, Quantity, QuantityKind, Velocity};
pub use units::uncertain::{Distribution, Uncertain};
pub use units::{key_quantities, unit, value};
pub use zero_phase::{
    TwoPassFilter, filter_both_ways, filter_both_ways_into, phaseless_low_pass, samples_added, through_class,
};
