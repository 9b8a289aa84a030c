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

pub use channels::channel::{Axis, Channel, ChannelStatus};
pub use description::body_part::{BodyPart, part_of};
pub use description::channel_selection::{is_pattern, resolve_channels};
pub use description::test_description::{ANOTHER_VEHICLE, PulseError, Source, TestDescription};
pub use notes::bearing::{About, Bearing, UnknownAbout, Weight};
pub use notes::note::{Note, Notes, Severity};
pub use samples::free_fall::{FreeFall, falls_before_event, free_fall, is_gravity};
pub use samples::pre_event::{PreEvent, PreEventWindow, pre_event};
pub use samples::recording_steps::{BeforeEvent, RecordingSteps};
pub use samples::signal::{Sampled, Signal, SignalError};
pub use units::gravity::STANDARD_GRAVITY_M_PER_S2;
pub use units::quantity::{Acceleration, Displacement, Force, Quantity, QuantityKind, Velocity};
pub use units::uncertain::{Distribution, Uncertain};
pub use units::{unit, value};
