//! The vocabulary of crash records: quantities, units, sampled signals, channels, the test
//! description and notes. No input or output, no filters, no numerics beyond a time grid
//! and the zero level before the event.
//!
//! Inside Crumple every number is SI. A value typed by a person carries its unit
//! ([`value::Mass`], [`value::Speed`], ...); an array carries its quantity in its type
//! ([`Signal<Acceleration>`](Signal)).

mod channels;
mod description;
pub mod iso13499;
mod notes;
mod samples;
mod units;

pub use channels::{Axis, Channel, ChannelStatus};
pub use description::{
    ANOTHER_VEHICLE, BodyPart, PulseError, Source, TestDescription, is_pattern, part_of, resolve_channels,
};
pub use notes::{About, ConcernContext, Note, Notes, Severity, UnknownAbout, Weight};
pub use samples::{
    BeforeEvent, FreeFall, PreEvent, PreEventWindow, RecordingSteps, Sampled, Signal, SignalError, falls_before_event,
    free_fall, is_gravity, pre_event,
};
pub use units::gravity::STANDARD_GRAVITY_M_PER_S2;
pub use units::quantity::{Acceleration, Displacement, Force, Quantity, QuantityKind, Velocity};
pub use units::uncertain::{Distribution, Uncertain};
pub use units::{key_quantities, unit, value};
